//! Filter sections of second order for body rates, three axes at once.
//!
//! What they remember are past signals, not sums that depend on coefficients. So coefficients may
//! change at any sample: at rest the output stays where it is, exactly, and otherwise it moves on
//! from there.

use core::f32::consts::{PI, SQRT_2};

use windhover_math::{Vector3, cos, min, sin_cos};

/// The last two values of a signal, rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Past {
    /// The last one.
    pub one: Vector3,
    /// The one before.
    pub two: Vector3,
}

impl Past {
    /// As if it had always been `value`.
    pub fn settled(value: Vector3) -> Self {
        Self {
            one: value,
            two: value,
        }
    }

    /// A new value comes in.
    #[inline(always)]
    pub fn push(&mut self, value: Vector3) {
        self.two = self.one;
        self.one = value;
    }
}

/// A Butterworth low-pass filter of second order by the bilinear transform, exact at its cutoff.
///
/// With K = tan(π·cutoff/rate): H(z) = b·(1 + z⁻¹)² / (1 + a₁z⁻¹ + a₂z⁻²),
/// b = K²/(1 + √2·K + K²), a₂ = (1 − √2·K + K²)/(1 + √2·K + K²), and a₁ = 4b − 1 − a₂, so that
/// the gain at rest is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LowPass {
    b: f32,
    a2: f32,
}

impl LowPass {
    /// With its −3 dB point at `cutoff`, as a share (above 0, below 0.5) of the sample rate.
    pub fn new(cutoff: f32) -> Self {
        let (sin, cos) = sin_cos(PI * cutoff);
        // sin² and cos² stand for K² and 1.
        let (near, far) = (SQRT_2 * sin * cos, sin * sin + cos * cos);
        let inverse = 1.0 / (far + near);
        Self {
            b: sin * sin * inverse,
            a2: (far - near) * inverse,
        }
    }

    /// The output for the input `now`, with the past of input and output.
    #[inline(always)]
    pub fn apply(&self, now: Vector3, input: &Past, output: &Past) -> Vector3 {
        let (newer, older) = (input.one - output.one * 2.0, now + input.two);
        output.one + (output.one - output.two) * self.a2 + (older + newer * 2.0) * self.b
    }
}

/// The width of notches, and what follows from it.
///
/// β = 1/(1 + tan(π·width/rate)): a notch has −3 dB at two frequencies that far apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Width {
    /// 1 − β.
    gain: f32,
    /// −2β.
    a1_per_cos: f32,
    /// 2β − 1.
    a2: f32,
}

impl Width {
    /// `width` is a share of the sample rate, above 0; more than a quarter counts as a quarter.
    pub fn new(width: f32) -> Self {
        let (sin, cos) = sin_cos(PI * min(width, 0.25));
        let beta = cos / (cos + sin);
        Self {
            gain: 1.0 - beta,
            a1_per_cos: -2.0 * beta,
            a2: 2.0 * beta - 1.0,
        }
    }

    /// The notch at `angle`, rad a sample (inside 0 to π), with a `weight` of 0 to 1: so much of
    /// its tone is taken out.
    #[inline(always)]
    pub fn notch(&self, angle: f32, weight: f32) -> Notch {
        Notch {
            gain: weight * self.gain,
            a1: self.a1_per_cos * cos(angle),
        }
    }
}

/// A notch: the signal less its tone, which is what a band-pass filter lets through.
///
/// The tone is w·(1 − β)·(1 − z⁻²) / (1 − 2β·cos(θ)·z⁻¹ + (2β − 1)·z⁻²) of the signal: all of it at
/// the angle θ, and nothing of what rests. With the weight w = 1 the signal less its tone is
/// β·(1 − 2cos(θ)·z⁻¹ + z⁻²) over the same denominator, the usual notch; with w = 0 it is the
/// signal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Notch {
    gain: f32,
    a1: f32,
}

impl Notch {
    /// Takes the tone out of the signal `now` and of the one `two` samples ago, with the tone's
    /// past, which moves on.
    #[inline(always)]
    pub fn take_out(&self, width: &Width, now: &mut Vector3, two: &mut Vector3, past: &mut Past) {
        let tone = (*now - *two) * self.gain - past.one * self.a1 - past.two * width.a2;
        *now -= tone;
        *two -= past.two;
        past.push(tone);
    }
}

#[cfg(test)]
impl LowPass {
    /// The coefficients a₁ and a₂.
    pub fn denominator(&self) -> (f64, f64) {
        let (b, a2) = (f64::from(self.b), f64::from(self.a2));
        (4.0 * b - 1.0 - a2, a2)
    }
}

#[cfg(test)]
impl Notch {
    /// The coefficients a₁ and a₂.
    pub fn denominator(&self, width: &Width) -> (f64, f64) {
        (f64::from(self.a1), f64::from(width.a2))
    }

    /// How much of its tone is taken out.
    pub fn weight(&self, width: &Width) -> f32 {
        self.gain / width.gain
    }
}
