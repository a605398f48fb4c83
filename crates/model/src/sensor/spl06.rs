//! The SPL06-001's raw counts and its compensation formula (Goertek data sheet: how to calculate
//! compensated pressure and temperature values).
//!
//! A driver reads nine coefficients and two raw numbers, and computes pressure and temperature
//! from them; the model goes the other way.

/// The part's coefficients, as its memory holds them (data sheet: calibration coefficients).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coefficients {
    /// Of the temperature, in °C: half of it counts. 12 bits.
    pub c0: i16,
    /// Of the temperature, in °C per scaled count. 12 bits.
    pub c1: i16,
    /// Of the pressure, in Pa. 20 bits, as the next.
    pub c00: i32,
    /// Pa per scaled count.
    pub c10: i32,
    /// Pa per scaled count of the temperature. 16 bits, as the rest.
    pub c01: i16,
    /// Pa per scaled count of both.
    pub c11: i16,
    /// Pa per square.
    pub c20: i16,
    /// Pa per square, and scaled count of the temperature.
    pub c21: i16,
    /// Pa per cube.
    pub c30: i16,
}

impl Default for Coefficients {
    /// Of the size and sign that real parts hold; ours.
    fn default() -> Self {
        Self {
            c0: 204,
            c1: -261,
            c00: 80_469,
            c10: -54_769,
            c01: -2_803,
            c11: 1_226,
            c20: -10_787,
            c21: 183,
            c30: -1_603,
        }
    }
}

/// How many samples the part adds up for one result. Their number sets the scale factor of the
/// raw count (data sheet: compensation scale factors).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Oversampling {
    /// 1 sample.
    X1,
    /// 2 samples.
    X2,
    /// 4 samples.
    X4,
    /// 8 samples.
    X8,
    /// 16 samples.
    X16,
    /// 32 samples.
    X32,
    /// 64 samples.
    X64,
    /// 128 samples.
    X128,
}

impl Oversampling {
    /// kP or kT: raw counts of a scaled count of 1.
    pub const fn scale(self) -> i32 {
        match self {
            Self::X1 => 524_288,
            Self::X2 => 1_572_864,
            Self::X4 => 3_670_016,
            Self::X8 => 7_864_320,
            Self::X16 => 253_952,
            Self::X32 => 516_096,
            Self::X64 => 1_040_384,
            Self::X128 => 2_088_960,
        }
    }
}

/// One part's formula, with the scale factors that its configuration sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Formula {
    /// The part's coefficients.
    pub coefficients: Coefficients,
    /// Of the pressure: kP.
    pub pressure: Oversampling,
    /// Of the temperature: kT.
    pub temperature: Oversampling,
}

impl Default for Formula {
    /// Eight samples of pressure and one of temperature: 18.4 ms (data sheet: pressure configuration), so that
    /// 50 results a second are possible.
    fn default() -> Self {
        Self {
            coefficients: Coefficients::default(),
            pressure: Oversampling::X8,
            temperature: Oversampling::X1,
        }
    }
}

/// The ends of a raw count of 24 bits.
const RAW_LOW: i32 = -(1 << 23);
const RAW_HIGH: i32 = (1 << 23) - 1;

impl Formula {
    /// Temperature in °C of a raw count: ½ c0 + c1 T.
    pub fn temperature(&self, raw: i32) -> f64 {
        let c = &self.coefficients;
        0.5 * f64::from(c.c0) + f64::from(c.c1) * self.scaled_temperature(raw)
    }

    /// Pressure in Pa of two raw counts:
    /// c00 + P (c10 + P (c20 + P c30)) + T c01 + T P (c11 + P c21).
    pub fn pressure(&self, raw_pressure: i32, raw_temperature: i32) -> f64 {
        let scaled = f64::from(raw_pressure) / f64::from(self.pressure.scale());
        self.polynomial(scaled, self.scaled_temperature(raw_temperature))
            .0
    }

    /// The raw count that stands for a temperature in °C.
    pub fn raw_temperature(&self, celsius: f64) -> i32 {
        let c = &self.coefficients;
        let scaled = (celsius - 0.5 * f64::from(c.c0)) / f64::from(c.c1);
        super::count(scaled * f64::from(self.temperature.scale()), RAW_LOW, RAW_HIGH)
    }

    /// The raw count that stands for a pressure in Pa beside a raw count of the temperature: the
    /// formula inverted by Newton's method, held at the ends of 24 bits.
    pub fn raw_pressure(&self, pascal: f64, raw_temperature: i32) -> i32 {
        let temperature = self.scaled_temperature(raw_temperature);
        let mut scaled = 0.0;
        for _ in 0..8 {
            let (value, slope) = self.polynomial(scaled, temperature);
            scaled -= (value - pascal) / slope;
        }
        super::count(scaled * f64::from(self.pressure.scale()), RAW_LOW, RAW_HIGH)
    }

    /// Pa per raw count of the pressure, near `raw_pressure`: negative for the usual coefficients.
    pub fn pascal_per_count(&self, raw_pressure: i32, raw_temperature: i32) -> f64 {
        let scale = f64::from(self.pressure.scale());
        let temperature = self.scaled_temperature(raw_temperature);
        self.polynomial(f64::from(raw_pressure) / scale, temperature).1 / scale
    }

    fn scaled_temperature(&self, raw: i32) -> f64 {
        f64::from(raw) / f64::from(self.temperature.scale())
    }

    /// Pressure, and its slope, of two scaled counts.
    fn polynomial(&self, p: f64, t: f64) -> (f64, f64) {
        let c = &self.coefficients;
        let [c00, c10] = [c.c00, c.c10].map(f64::from);
        let [c01, c11, c20, c21, c30] = [c.c01, c.c11, c.c20, c.c21, c.c30].map(f64::from);
        let value = c00 + p * (c10 + p * (c20 + p * c30)) + t * c01 + t * p * (c11 + p * c21);
        let slope = c10 + p * (2.0 * c20 + p * 3.0 * c30) + t * (c11 + 2.0 * p * c21);
        (value, slope)
    }
}
