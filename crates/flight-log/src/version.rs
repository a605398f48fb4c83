//! Which version of this project writes a log.

/// The commit that it was built from, or `unknown`.
pub const COMMIT: &str = env!("WINDHOVER_COMMIT");

/// The release as PX4 writes it: 0xMMmmpptt.
pub const RELEASE: u32 = number(env!("CARGO_PKG_VERSION_MAJOR")) << 24
    | number(env!("CARGO_PKG_VERSION_MINOR")) << 16
    | number(env!("CARGO_PKG_VERSION_PATCH")) << 8;

const fn number(text: &str) -> u32 {
    let (digits, mut place, mut number) = (text.as_bytes(), 0, 0);
    while place < digits.len() {
        number = number * 10 + (digits[place] - b'0') as u32;
        place += 1;
    }
    number & 0xff
}
