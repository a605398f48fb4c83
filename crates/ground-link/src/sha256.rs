//! SHA-256 (FIPS 180-4), written for few bytes of flash: the crate `sha2` unrolls its rounds, and
//! takes a sixth of all that this link may take. The tests hold it against that crate.

/// The first 32 bits of the fractional parts of the cube roots of the first 64 primes.
#[rustfmt::skip]
const K: [u32; 64] = [
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2,
];

/// Bytes that are taken at a time.
const BLOCK: usize = 64;

/// A hash under way.
pub(crate) struct Sha256 {
    state: [u32; 8],
    block: [u8; BLOCK],
    /// Bytes in the block.
    filled: usize,
    /// Bytes taken so far.
    length: u64,
}

impl Sha256 {
    /// Of nothing yet.
    pub fn new() -> Self {
        Self {
            state: [
                0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab,
                0x5be0cd19,
            ],
            block: [0; BLOCK],
            filled: 0,
            length: 0,
        }
    }

    /// Takes further bytes.
    #[inline(never)]
    pub fn update(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.push(*byte);
            self.length = self.length.wrapping_add(1);
        }
    }

    /// The first six bytes of the hash: what a signature has of it.
    pub fn first_six(mut self) -> [u8; 6] {
        let bits = self.length.wrapping_mul(8).to_be_bytes();
        self.push(0x80);
        while self.filled != BLOCK - bits.len() {
            self.push(0);
        }
        for byte in bits {
            self.push(byte);
        }
        let [first, second, ..] = self.state.map(u32::to_be_bytes);
        let ([a, b, c, d], [e, f, ..]) = (first, second);
        [a, b, c, d, e, f]
    }

    #[inline(never)]
    fn push(&mut self, byte: u8) {
        if let Some(place) = self.block.get_mut(self.filled) {
            *place = byte;
        }
        self.filled += 1;
        if self.filled >= BLOCK {
            self.filled = 0;
            self.compress();
        }
    }

    /// The 64 rounds over a block; of the message schedule only the last sixteen words are kept.
    fn compress(&mut self) {
        let mut words = [0; 16];
        for (word, bytes) in words.iter_mut().zip(self.block.chunks_exact(4)) {
            *word = bytes.iter().fold(0, |word, byte| word << 8 | u32::from(*byte));
        }
        let mut state = self.state;
        for (round, constant) in K.iter().enumerate() {
            let at = |back: usize| words.get((round + 16 - back) % 16).copied().unwrap_or_default();
            let mut word = at(16);
            if round >= 16 {
                let (old, new) = (at(15), at(2));
                let small = old.rotate_right(7) ^ old.rotate_right(18) ^ old >> 3;
                let large = new.rotate_right(17) ^ new.rotate_right(19) ^ new >> 10;
                word = word.wrapping_add(small).wrapping_add(at(7)).wrapping_add(large);
                if let Some(place) = words.get_mut(round % 16) {
                    *place = word;
                }
            }
            let [a, b, c, d, e, f, g, h] = state;
            let first = h
                .wrapping_add(e.rotate_right(6) ^ e.rotate_right(11) ^ e.rotate_right(25))
                .wrapping_add(e & f ^ !e & g)
                .wrapping_add(*constant)
                .wrapping_add(word);
            let second = (a.rotate_right(2) ^ a.rotate_right(13) ^ a.rotate_right(22))
                .wrapping_add(a & b ^ a & c ^ b & c);
            state = [
                first.wrapping_add(second),
                a,
                b,
                c,
                d.wrapping_add(first),
                e,
                f,
                g,
            ];
        }
        for (sum, word) in self.state.iter_mut().zip(state) {
            *sum = sum.wrapping_add(word);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use sha2::Digest;

    use super::*;

    fn ours(bytes: &[u8], cut: usize) -> [u8; 6] {
        let mut hash = Sha256::new();
        let (first, second) = bytes.split_at(cut.min(bytes.len()));
        hash.update(first);
        hash.update(second);
        hash.first_six()
    }

    /// The example of FIPS 180-4 and the hash of nothing.
    #[test]
    fn known_values() {
        assert_eq!(ours(b"abc", 1), [0xba, 0x78, 0x16, 0xbf, 0x8f, 0x01]);
        assert_eq!(ours(b"", 0), [0xe3, 0xb0, 0xc4, 0x42, 0x98, 0xfc]);
    }

    /// Every length around the edges of a block, where padding goes wrong first.
    #[test]
    fn every_length_is_hashed_as_the_crate_does() {
        let bytes: std::vec::Vec<u8> = (0..400).map(|n| (n * 7 + n / 64) as u8).collect();
        for length in 0..bytes.len() {
            let bytes = &bytes[..length];
            assert_eq!(
                ours(bytes, length / 3),
                sha2::Sha256::digest(bytes)[..6],
                "{length}"
            );
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_hashed_as_the_crate_does(bytes in prop::collection::vec(any::<u8>(), 0..300), cut in 0..300usize) {
            prop_assert_eq!(&ours(&bytes, cut)[..], &sha2::Sha256::digest(&bytes)[..6]);
        }
    }
}
