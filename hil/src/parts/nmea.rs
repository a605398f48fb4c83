//! Sentences that a receiver sends before it is configured: for a driver, bytes that are not its
//! own. They are well-formed, and say that there is no position (NMEA 0183).

/// Sentences by their number in u-blox's class 0xF0, with what each says.
pub const SENTENCES: [(u8, &str); 6] = [
    (0x00, "GNGGA,120000.00,,,,,0,00,99.99,,,,,,"),
    (0x01, "GNGLL,,,,,120000.00,V,N"),
    (0x02, "GNGSA,A,1,,,,,,,,,,,,,99.99,99.99,99.99,1"),
    (0x03, "GPGSV,1,1,00,1"),
    (0x04, "GNRMC,120000.00,V,,,,,,,070126,,,N,V"),
    (0x05, "GNVTG,,,,,,,,,N"),
];

/// A sentence as it goes out.
pub fn line(sentence: &str) -> Vec<u8> {
    let sum = sentence.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${sentence}*{sum:02X}\r\n").into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_with_its_sum() {
        // An example that manuals print.
        assert_eq!(
            line("GPGLL,5057.970,N,00146.110,E,142451,A"),
            b"$GPGLL,5057.970,N,00146.110,E,142451,A*27\r\n"
        );
    }
}
