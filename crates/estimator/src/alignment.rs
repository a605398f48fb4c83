//! The first attitude: standing still, level from gravity, heading from the compass, gyro bias from
//! the mean rate.
//!
//! For [`Stillness::duration`] seconds the means of rate, specific force and field are taken. Every
//! interval must lie near the mean so far and the force near gravity, or the alignment starts
//! again and says why: wind that rocks the vehicle passes, hands that carry it do not.
//!
//! The filter that comes out of it starts with wide tilt and heading and *then* takes in the mean
//! force and the mean field as measurements, by the same rows as later: so the covariance knows
//! that the tilt is wrong by just what the accelerometer's bias says.

use windhover_math::scalar::norm;
use windhover_math::{Euler, GRAVITY, Quaternion, Vector3, atan2, sqrt, wrap_pi};

use crate::border::Refusal;
use crate::filter::Filter;
use crate::measurement::MagneticField;
use crate::noise::NoiseParameters;
use crate::start::{Deviations, Start};
use crate::state::{InertialIncrements, State};

/// What counts as standing still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stillness {
    /// How long, s.
    pub duration: f32,
    /// Largest difference of an interval's rate from the mean, rad/s.
    pub rate: f32,
    /// Largest difference of an interval's specific force from the mean, m/s².
    pub force: f32,
    /// Largest difference of the mean force's size from gravity, m/s².
    pub gravity: f32,
    /// Largest bias of a gyro, rad/s.
    pub bias: f32,
}

impl Default for Stillness {
    fn default() -> Self {
        Self {
            duration: 2.0,
            rate: 0.1,
            force: 1.5,
            gravity: 0.6,
            bias: 0.2,
        }
    }
}

/// Why the alignment has started again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsettled {
    /// It turns, or the gyro's bias is larger than any.
    Turning,
    /// It is pushed or carried.
    Accelerating,
    /// The accelerometer does not show gravity.
    NoGravity,
    /// The samples are not numbers.
    Refused(Refusal),
}

/// How far the alignment is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// Going on; share of the time that it needs.
    Collecting(f32),
    /// It begins again.
    Restarted(Unsettled),
    /// Only a compass measurement is missing.
    NoField,
    /// There is enough: [`Alignment::finish`] gives the filter.
    Settled,
}

/// Means and spreads since the vehicle stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    stillness: Stillness,
    time: f32,
    intervals: f32,
    rate: Vector3,
    force: Vector3,
    /// Sums of squares about the mean.
    rate_spread: f32,
    force_spread: f32,
    fields: f32,
    field: Vector3,
    last_field: MagneticField,
}

/// Standard deviation of the accelerometer's bias after calibration, m/s²: 5 mg.
const ACCEL_BIAS: f32 = 0.08;
/// Best that a mean rate is believed, rad/s: the earth turns by 7.3e-5.
const LEAST_RATE_DEVIATION: f32 = 1e-4;
/// Best that a mean force is believed, m/s².
const LEAST_FORCE_DEVIATION: f32 = 0.005;

impl Alignment {
    /// Nothing known.
    pub fn new(stillness: Stillness) -> Self {
        Self {
            stillness,
            time: 0.0,
            intervals: 0.0,
            rate: Vector3::zeros(),
            force: Vector3::zeros(),
            rate_spread: 0.0,
            force_spread: 0.0,
            fields: 0.0,
            field: Vector3::zeros(),
            last_field: MagneticField {
                time: 0,
                field: Vector3::zeros(),
                deviation: 1.0,
                repeats: 1.0,
                declination: 0.0,
            },
        }
    }

    /// Takes in an interval.
    pub fn step(&mut self, increments: &InertialIncrements) -> Progress {
        if let Err(unsettled) = self.take_in(increments) {
            *self = Self::new(self.stillness);
            return Progress::Restarted(unsettled);
        }
        if self.time < self.stillness.duration {
            Progress::Collecting(self.time / self.stillness.duration)
        } else if self.fields < 1.0 {
            Progress::NoField
        } else {
            Progress::Settled
        }
    }

    fn take_in(&mut self, increments: &InertialIncrements) -> Result<(), Unsettled> {
        increments.check().map_err(Unsettled::Refused)?;
        let limits = &self.stillness;
        let rate = increments.mean_rate();
        let force = increments.velocity / increments.duration;
        if norm(rate) > limits.bias {
            return Err(Unsettled::Turning);
        }
        let (from_rate, from_force) = (rate - self.rate, force - self.force);
        if self.intervals > 0.0 {
            if norm(from_rate) > limits.rate {
                return Err(Unsettled::Turning);
            }
            if norm(from_force) > limits.force {
                return Err(Unsettled::Accelerating);
            }
        }
        // Welford's update of mean and spread. After a minute the mean stops getting better but
        // goes on following.
        self.intervals = if self.intervals < 15_000.0 {
            self.intervals + 1.0
        } else {
            self.intervals
        };
        let share = 1.0 / self.intervals;
        self.rate += from_rate * share;
        self.force += from_force * share;
        let kept = 1.0 - share;
        self.rate_spread += kept * from_rate.dot(&from_rate);
        self.force_spread += kept * from_force.dot(&from_force);
        self.time += increments.duration;
        if (norm(self.force) - GRAVITY).abs() > limits.gravity && self.intervals > 25.0 {
            return Err(Unsettled::NoGravity);
        }
        Ok(())
    }

    /// Takes in a compass measurement; one that is not a number is left out.
    pub fn take_in_field(&mut self, measured: &MagneticField) {
        if measured.check().is_err() {
            return;
        }
        self.fields = if self.fields < 1000.0 {
            self.fields + 1.0
        } else {
            self.fields
        };
        self.field += (measured.field - self.field) / self.fields;
        self.last_field = *measured;
    }

    /// The bearing of magnetic north becomes known, rad, east positive: it replaces that of the
    /// measurements so far.
    pub fn set_declination(&mut self, declination: f32) {
        self.last_field.declination = declination;
    }

    /// The attitude by the means so far.
    fn attitude(&self) -> Quaternion {
        let down = -self.force;
        let roll = atan2(down.y, down.z);
        let pitch = atan2(-down.x, sqrt(down.y * down.y + down.z * down.z));
        let level = Quaternion::from_euler(Euler {
            roll,
            pitch,
            yaw: 0.0,
        });
        let field = level.rotate(self.field);
        let yaw = wrap_pi(self.last_field.declination - atan2(field.y, field.x));
        Quaternion::from_euler(Euler { roll, pitch, yaw })
    }

    /// The mean field, FRD, once there was one.
    pub fn field(&self) -> Option<Vector3> {
        (self.fields >= 1.0).then_some(self.field)
    }

    /// The filter at `time`, µs, at this place (NED, m), known so well (m). Without a field the
    /// heading is as good as unknown.
    pub fn finish(
        &self,
        position: Vector3,
        position_deviation: Vector3,
        noise: &NoiseParameters,
        time: u64,
    ) -> Result<Filter, Refusal> {
        if self.intervals < 1.0 {
            return Err(Refusal::Blind);
        }
        // Of each component, by the spread of all three over 3 n intervals.
        let per_mean = 1.0 / (3.0 * self.intervals * self.intervals);
        let rate = sqrt(self.rate_spread * per_mean) + LEAST_RATE_DEVIATION;
        let force = sqrt(self.force_spread * per_mean) + LEAST_FORCE_DEVIATION;
        let start = Start {
            state: State {
                position,
                velocity: Vector3::zeros(),
                attitude: self.attitude(),
                gyro_bias: self.rate,
                accel_bias: Vector3::zeros(),
            },
            deviations: Deviations {
                position: position_deviation,
                velocity: 0.05,
                tilt: 0.3,
                heading: 3.0,
                gyro_bias: rate,
                accel_bias: ACCEL_BIAS,
            },
        };
        let mut filter = Filter::new(&start, noise, time)?;
        filter.fuse_gravity_force(self.force, force)?;
        if self.fields >= 1.0 {
            filter.fuse_compass(&MagneticField {
                time,
                field: self.field,
                repeats: 1.0,
                ..self.last_field
            })?;
        }
        Ok(filter)
    }
}

impl Default for Alignment {
    fn default() -> Self {
        Self::new(Stillness::default())
    }
}
