//! From raw counts to pressure (data sheet: how to calculate compensated pressure values).

/// The part's coefficients, of which pressure needs these (data sheet: calibration coefficients).
/// Names are the data sheet's; units Pa, Pa per scaled count, and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Coefficients {
    c00: i32,
    c10: i32,
    c01: i16,
    c11: i16,
    c20: i16,
    c21: i16,
    c30: i16,
}

/// Bytes of all coefficients.
pub(super) const COEFFICIENT_BYTES: usize = 18;

/// kP of 16 samples (data sheet: compensation scale factors).
const PRESSURE_SCALE: f32 = 253_952.0;

/// kT of 4 samples.
const TEMPERATURE_SCALE: f32 = 3_670_016.0;

impl Coefficients {
    /// From memory. The first three bytes are c0 and c1, of the temperature in °C.
    pub fn unpack(bytes: &[u8; COEFFICIENT_BYTES]) -> Self {
        let [_, _, _, a, b, c, d, e, rest @ ..] = *bytes;
        let [f, g, h, i, j, k, l, m, n, o] = rest;
        Self {
            // 20 bits each: shifted down from the top of 32, so that the sign comes along.
            c00: i32::from_be_bytes([a, b, c, 0]) >> 12,
            c10: i32::from_be_bytes([c << 4 | d >> 4, d << 4 | e >> 4, e << 4, 0]) >> 12,
            c01: i16::from_be_bytes([f, g]),
            c11: i16::from_be_bytes([h, i]),
            c20: i16::from_be_bytes([j, k]),
            c21: i16::from_be_bytes([l, m]),
            c30: i16::from_be_bytes([n, o]),
        }
    }

    /// Pressure in Pa of raw counts of 24 bits, measured with the oversampling of the
    /// configuration. Finite for all inputs.
    pub fn pressure(&self, raw_pressure: i32, raw_temperature: i32) -> f32 {
        let p = raw_pressure as f32 / PRESSURE_SCALE;
        let t = raw_temperature as f32 / TEMPERATURE_SCALE;
        let [c00, c10] = [self.c00, self.c10].map(|c| c as f32);
        let [c01, c11, c20, c21, c30] = [self.c01, self.c11, self.c20, self.c21, self.c30].map(f32::from);
        c00 + p * (c10 + p * (c20 + p * c30)) + t * (c01 + p * (c11 + p * c21))
    }
}

/// A raw count of 24 bits with its sign.
pub(super) fn raw(bytes: [u8; 3]) -> i32 {
    let [high, middle, low] = bytes;
    i32::from_be_bytes([high, middle, low, 0]) >> 8
}
