//! The checksum of MAVLink frames: CRC-16/MCRF4XX.

/// What a checksum starts from.
pub const START: u16 = 0xffff;

/// Takes a checksum on by further bytes.
pub fn update(crc: u16, bytes: &[u8]) -> u16 {
    bytes.iter().fold(crc, |crc, byte| {
        let mixed = byte ^ crc as u8;
        let mixed = u16::from(mixed ^ mixed << 4);
        crc >> 8 ^ mixed << 8 ^ mixed << 3 ^ mixed >> 4
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value that catalogues of CRCs give for CRC-16/MCRF4XX.
    #[test]
    fn check_value() {
        assert_eq!(update(START, b"123456789"), 0x6f91);
        assert_eq!(update(update(START, b"1234"), b"56789"), 0x6f91);
    }
}
