//! A direction of the vehicle, of which the bearing in the world is known: 3 non-zeros.
//!
//! Turned into the world by the estimated attitude, the direction is d with bearing
//! α = atan2(d_e, d_n). An attitude error δθ adds δθ × d to it, so
//! δα = δθ_d − (d_d/h²)(d_n δθ_n + d_e δθ_e) with h² = d_n² + d_e²: the steeper the direction, the
//! more a tilt error passes for a heading error.
//!
//! Where the noise is in the direction (a compass), (d_n, d_e)/h is taken from the bearing that is
//! known: with the measured one, H would be noisy by the very noise of the innovation, and the
//! product of both does not average out. It turned a hovering vehicle by 1.5° in 40 s.

use windhover_math::{Quaternion, Vector3, atan2, sin_cos, sqrt, wrap_pi};

use crate::border::Refusal;
use crate::covariance::{Axis, Group};
use crate::filter::Filter;
use crate::gate::{Report, Test};
use crate::health::Sensor;

/// Share of a direction that must be horizontal.
const LEAST_HORIZONTAL: f32 = 0.1;

/// A heading that is known better than this is not set anew by a direction, rad.
const FIRM_HEADING: f32 = 0.3;

/// A direction of the body with its bearing.
pub(crate) struct Bearing {
    /// The direction, FRD, of any length.
    pub(crate) direction: Vector3,
    /// Its bearing in the world, rad.
    pub(crate) bearing: f32,
    /// Variance of the direction's end, across it, in the square of its unit.
    pub(crate) noise: f32,
    /// Variance of the bearing itself, rad².
    pub(crate) bearing_noise: f32,
    /// How many times the variance counts when it is taken in.
    pub(crate) repeats: f32,
    /// Whether it is the bearing that is without noise.
    pub(crate) is_bearing_exact: bool,
    /// The attitude when it was measured.
    pub(crate) attitude: Quaternion,
}

impl Filter {
    #[inline]
    pub(crate) fn fuse_bearing(&mut self, sensor: Sensor, measured: &Bearing) -> Result<Report<1>, Refusal> {
        let d = measured.attitude.rotate(measured.direction);
        let across = d.x * d.x + d.y * d.y;
        let whole = across + d.z * d.z;
        // Of a direction of length zero nothing is horizontal either.
        if across <= LEAST_HORIZONTAL * LEAST_HORIZONTAL * whole {
            return self.counted(sensor, Err(Refusal::Blind));
        }
        let inverse = 1.0 / across;
        let noise = measured.noise * inverse + measured.bearing_noise;
        let (innovation, h) = if measured.is_bearing_exact {
            let (sin, cos) = sin_cos(measured.bearing);
            let steep = -d.z * sqrt(inverse);
            // From the direction to its bearing: no difference of angles that would be wrapped.
            let (across, along) = (sin * d.x - cos * d.y, cos * d.x + sin * d.y);
            (atan2(across, along), [cos * steep, sin * steep, 1.0])
        } else {
            let steep = -d.z * inverse;
            let innovation = wrap_pi(measured.bearing - atan2(d.y, d.x));
            (innovation, [d.x * steep, d.y * steep, 1.0])
        };
        let tests = [Test {
            innovation,
            variance: self.covariance.direction_variance(h) + noise,
        }];
        // A heading that is known well is not given up for a direction that says something else
        // time and again: iron and currents are likelier than a turned vehicle.
        let [_, _, heading] = self.covariance.variances(Group::Attitude);
        if !tests.iter().all(Test::passes) && heading < FIRM_HEADING * FIRM_HEADING {
            return Ok(self.rejected(sensor, tests));
        }
        Ok(self.decide(
            sensor,
            tests,
            |filter| {
                let noise = noise * measured.repeats;
                filter
                    .covariance
                    .fuse_direction(&mut filter.state, h, innovation, noise);
            },
            |filter| {
                // What tilt adds to the bearing's variance stays in the heading's.
                let tilt = [h[0], h[1], 0.0];
                let variance = filter.covariance.direction_variance(tilt) + noise;
                filter.state.attitude =
                    (Quaternion::from_heading(innovation) * filter.state.attitude).renormalized();
                filter.covariance.decouple(Group::Attitude, Axis::Z, variance);
            },
        ))
    }
}
