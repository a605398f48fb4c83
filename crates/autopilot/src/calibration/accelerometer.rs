//! The accelerometer: offset and scale of each axis, from its six sides put down in any order.
//!
//! A side counts when it was held down, within 25°, for two seconds without motion. Six
//! means lie on an ellipsoid whose axes are the sensor's: `scale · (mean − offset)` has the length of
//! gravity in all of them. Written as `a·x² + b·y² + c·z² + d·x + e·y + f·z = 1` that is linear in six
//! unknowns, so six sides give them in one solution, and a side need not lie level. (With sides that
//! do lie level it is the familiar half sum and half difference of opposite sides.)

mod fit;
mod sides;
#[cfg(test)]
mod tests;

use core::fmt;

use windhover_math::Vector3;
use windhover_parameters::Decimal;

pub use self::sides::{Side, Sides};
use super::rest::{Disturbance, Rest, Resting, Stillness, check_sample};
use super::{Axis, BadSample, Timer};
use crate::sensing::{CalibrationParameters, Inertial};

/// What is asked of an accelerometer's calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerometerLimits {
    /// What counts as holding still.
    pub stillness: Stillness,
    /// Largest offset of an axis that is believed, m/s².
    pub offset: f32,
    /// Largest difference of a scale from 1.
    pub scale: f32,
    /// Time limit for all sides together, s.
    pub timeout: f32,
}

impl Default for AccelerometerLimits {
    /// Hands may hold the vehicle: they tremble.
    fn default() -> Self {
        Self {
            stillness: Stillness {
                duration: 2.0,
                rate: 0.1,
                force: 0.4,
            },
            offset: 2.0,
            scale: 0.1,
            timeout: 180.0,
        }
    }
}

/// What corrects an accelerometer: `scale · (raw − offset)`, body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerometerCalibration {
    /// m/s².
    pub offset: Vector3,
    /// A factor for each axis.
    pub scale: Vector3,
}

impl AccelerometerCalibration {
    /// Puts offset and scale into the parameters.
    pub fn write(&self, parameters: &mut CalibrationParameters) {
        parameters.accel_x = self.offset.x;
        parameters.accel_y = self.offset.y;
        parameters.accel_z = self.offset.z;
        parameters.accel_scale_x = self.scale.x;
        parameters.accel_scale_y = self.scale.y;
        parameters.accel_scale_z = self.scale.z;
    }
}

/// What the human is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccelerometerInstruction {
    /// Put one of these sides down.
    PutDown(Sides),
    /// Hold still: this side is being taken.
    Hold(Side),
    /// It was moved while it was held: hold it again, or put down one of these.
    Moved(Disturbance, Sides),
    /// This side has been taken: put down one of these.
    AlreadyTaken(Side, Sides),
    /// No side is down: put down one of these, within 25°.
    Askew(Sides),
}

impl fmt::Display for AccelerometerInstruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PutDown(sides) => write!(f, "put down: {sides}"),
            Self::Hold(side) => write!(f, "hold still, {side} down"),
            Self::Moved(_, sides) => write!(f, "it was moved: hold still; missing: {sides}"),
            Self::AlreadyTaken(side, sides) => write!(f, "{side} is taken; missing: {sides}"),
            Self::Askew(sides) => write!(f, "no side is down; missing: {sides}"),
        }
    }
}

/// Why there is no calibration of the accelerometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AccelerometerRefusal {
    /// A sample is none.
    Sample(BadSample),
    /// Time ran out with these sides missing.
    Timeout(Sides),
    /// The sides do not lie on an ellipsoid around zero.
    NoFit,
    /// The offset of an axis, m/s², is larger than any.
    Offset(Axis, f32),
    /// The scale of an axis is too far from 1.
    Scale(Axis, f32),
}

impl fmt::Display for AccelerometerRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sample(bad) => bad.fmt(f),
            Self::Timeout(sides) => write!(f, "time ran out; sides missing: {sides}"),
            Self::NoFit => f.write_str("the six sides do not go together: start again"),
            Self::Offset(axis, offset) => {
                let offset = Decimal::rounded(*offset, 2);
                write!(
                    f,
                    "the accelerometer's {axis} is off by {offset} m/s², more than any good one"
                )
            }
            Self::Scale(axis, scale) => {
                let scale = Decimal::rounded(*scale, 3);
                write!(
                    f,
                    "the accelerometer's {axis} needs a factor of {scale}, too far from 1"
                )
            }
        }
    }
}

/// Where the calibration of the accelerometer is.
pub type AccelerometerProgress =
    super::Progress<AccelerometerInstruction, AccelerometerCalibration, AccelerometerRefusal>;

/// The machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerometerCalibrator {
    limits: AccelerometerLimits,
    timer: Timer,
    rest: Rest,
    taken: Sides,
    /// Mean forces, in the order of [`Side::ALL`].
    means: [Vector3; 6],
    instruction: AccelerometerInstruction,
    end: Option<Result<AccelerometerCalibration, AccelerometerRefusal>>,
}

impl AccelerometerCalibrator {
    /// At the beginning.
    pub fn new(limits: AccelerometerLimits) -> Self {
        Self {
            limits,
            timer: Timer::new(limits.timeout),
            rest: Rest::new(limits.stillness),
            taken: Sides::default(),
            means: [Vector3::zeros(); 6],
            instruction: AccelerometerInstruction::PutDown(Sides::default().others()),
            end: None,
        }
    }

    /// The sides that are done.
    pub fn taken(&self) -> Sides {
        self.taken
    }

    /// Takes in an uncalibrated sample that stands for `duration` seconds.
    pub fn step(&mut self, sample: &Inertial, duration: f32) -> AccelerometerProgress {
        if self.end.is_none() {
            self.end = self.take_in(sample, duration).transpose();
        }
        AccelerometerProgress::of(self.end, self.share(), self.instruction)
    }

    fn share(&self) -> f32 {
        let held = match self.instruction {
            AccelerometerInstruction::Hold(_) => self.rest.share(),
            _ => 0.0,
        };
        let share = (f32::from(self.taken.count()) + held) / 6.0;
        windhover_math::min(share, 1.0)
    }

    fn take_in(
        &mut self,
        sample: &Inertial,
        duration: f32,
    ) -> Result<Option<AccelerometerCalibration>, AccelerometerRefusal> {
        check_sample(sample).map_err(AccelerometerRefusal::Sample)?;
        let late = self
            .timer
            .advance(duration)
            .map_err(AccelerometerRefusal::Sample)?;
        let resting = self.rest.take_in(sample, duration);
        self.look(resting);
        if self.taken.others().count() == 0 {
            return self.finish().map(Some);
        }
        if late {
            return Err(AccelerometerRefusal::Timeout(self.taken.others()));
        }
        Ok(None)
    }

    /// Says what to do, and takes a side that was held for long enough.
    fn look(&mut self, resting: Resting) {
        use AccelerometerInstruction::*;
        let missing = self.taken.others();
        let mean = self.rest.mean().specific_force;
        let side = Side::down(mean);
        self.instruction = match (resting, side, self.instruction) {
            (Resting::Disturbed(disturbance), _, Hold(_)) => Moved(disturbance, missing),
            (Resting::Disturbed(_), ..) => PutDown(missing),
            // Nothing to see before the first block.
            _ if mean == Vector3::zeros() => return,
            (_, None, _) => Askew(missing),
            (_, Some(side), _) if self.taken.contains(side) => AlreadyTaken(side, missing),
            (Resting::Collecting, Some(side), _) => Hold(side),
            (Resting::Still, Some(side), _) => {
                if let Some(place) = self.means.get_mut(side as usize) {
                    *place = mean;
                }
                self.taken = self.taken.with(side);
                PutDown(self.taken.others())
            }
        };
        if resting == Resting::Still {
            self.rest.restart();
        }
    }

    fn finish(&self) -> Result<AccelerometerCalibration, AccelerometerRefusal> {
        let found = fit::ellipsoid(&self.means).ok_or(AccelerometerRefusal::NoFit)?;
        if let Some((axis, offset)) = Axis::beyond(found.offset, self.limits.offset) {
            return Err(AccelerometerRefusal::Offset(axis, offset));
        }
        if let Some((axis, excess)) = Axis::beyond(found.scale.add_scalar(-1.0), self.limits.scale) {
            return Err(AccelerometerRefusal::Scale(axis, 1.0 + excess));
        }
        Ok(found)
    }
}

impl Default for AccelerometerCalibrator {
    fn default() -> Self {
        Self::new(AccelerometerLimits::default())
    }
}
