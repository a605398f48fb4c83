//! A sum that any single wrong bit changes: FNV-1a over 32 bits. It is for what is also guarded by
//! a CRC where it is stored, and it can be reckoned while compiling.

/// The sum of nothing.
pub const START: u32 = 0x811c_9dc5;

const PRIME: u32 = 0x0100_0193;

/// Takes a sum on by bytes.
pub const fn bytes(mut sum: u32, bytes: &[u8]) -> u32 {
    let mut rest = bytes;
    while let [first, others @ ..] = rest {
        sum = (sum ^ *first as u32).wrapping_mul(PRIME);
        rest = others;
    }
    sum
}

/// Takes a sum on by a word.
pub const fn word(sum: u32, word: u32) -> u32 {
    bytes(sum, &word.to_le_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the algorithm's authors (draft-eastlake-fnv).
    #[test]
    fn known_values() {
        assert_eq!(bytes(START, b""), 0x811c_9dc5);
        assert_eq!(bytes(START, b"a"), 0xe40c_292c);
        assert_eq!(bytes(START, b"foobar"), 0xbf9c_f968);
        assert_eq!(word(START, u32::from_le_bytes(*b"foob")), bytes(START, b"foob"));
    }
}
