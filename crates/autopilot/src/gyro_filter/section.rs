//! Filter sections of second order for body rates, three axes at once.
//!
//! Both are written in direct form I: the memory is the last two inputs and outputs, not sums
//! that depend on coefficients. So coefficients may change at any sample: at rest the output stays
//! where it is, exactly, and otherwise it moves on from there. A section's output is the next
//! one's input, which makes one pair of old values per point of a chain.

use core::f32::consts::{PI, SQRT_2};

use windhover_math::{Vector3, min, sin_cos};

/// The last two values at one point of a chain of sections, rad/s.
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

/// The width of a notch, and what follows from it.
///
/// β = 1/(1 + tan(π·bandwidth/rate)): the gain is −3 dB or less over exactly the bandwidth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Width {
    beta: f32,
}

impl Width {
    /// Between the −3 dB points lies `bandwidth`, as a share of the sample rate (at most a
    /// quarter of it).
    pub fn new(bandwidth: f32) -> Self {
        let (sin, cos) = sin_cos(PI * min(bandwidth, 0.25));
        Self {
            beta: cos / (cos + sin),
        }
    }

    /// The notch of this width at `angle`, rad a sample (0 to π). Of its output `weight` (0 to 1)
    /// counts, of its input the rest: 0 lets all through.
    #[inline(always)]
    pub fn notch(&self, angle: f32, weight: f32) -> Notch {
        Notch {
            depth: weight * (1.0 - self.beta),
            a1: -2.0 * self.beta * windhover_math::cos(angle),
            a2: 2.0 * self.beta - 1.0,
        }
    }
}

/// A notch that may be less than full.
///
/// The full one is H(z) = β·(1 − 2cos(θ)z⁻¹ + z⁻²) / (1 + a₁z⁻¹ + a₂z⁻²) with a₁ = −2β·cos(θ)
/// and a₂ = 2β − 1; input and output mixed by the weight differ from it only in the outer two
/// terms above, which are 1 − d and a₂ + d with d = weight·(1 − β).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Notch {
    depth: f32,
    a1: f32,
    a2: f32,
}

impl Notch {
    /// The output for the input `now`, with the past of input and output.
    #[inline(always)]
    pub fn apply(&self, now: Vector3, input: &Past, output: &Past) -> Vector3 {
        let (newer, older) = (input.one - output.one, input.two - output.two);
        now + (input.two - now) * self.depth + newer * self.a1 + older * self.a2
    }
}
