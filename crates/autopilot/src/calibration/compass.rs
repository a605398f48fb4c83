//! The compass: hard and soft iron, from turning the vehicle every way.
//!
//! The field of the earth has one length; iron in the vehicle moves its tip from a sphere to an
//! ellipsoid. The machine has two parts:
//!
//! 1. *Collecting*, until the directions about the centre of a sphere through the samples reach into
//!    nearly all of 24 equal cells (`cells`). A sample must agree with those around it in time, and
//!    lie at a distance from all that are kept (`store`): dwelling weighs nothing, and lone outliers
//!    do not come in.
//! 2. *Fitting*, one pass over the kept samples a step: the quadric by weighted least squares, each
//!    sample weighed by how near it lay to the quadric before (`fit`). Outliers that did come in lose
//!    their weight.
//!
//! The samples are kept (1.9 kB) and the normal equations made anew in each pass: sums made on the
//! fly cannot take an outlier back that only later shows as one, nor be centred once the centre is
//! known, and without centring single precision does not reach.
//!
//! Fields are in µT, body axes. The parameters are in µT as well; PX4 has its offsets in gauss, hence
//! the names of our own for these. What corrects is [`CompassCorrection`].

mod cells;
mod correction;
mod fit;
mod limits;
mod store;
#[cfg(test)]
mod tests;

use windhover_math::Vector3;

pub use self::cells::Cells;
pub use self::correction::{CompassCalibration, CompassCorrection};
use self::fit::{Quality, Shell};
pub use self::limits::{CompassInstruction, CompassLimits, CompassRefusal};
use self::store::Store;
use super::{Axis, Timer, check};

/// Where the calibration of the compass is.
pub type CompassProgress = super::Progress<CompassInstruction, CompassCalibration, CompassRefusal>;

/// More than any compass shows, µT (±50 gauss).
const LARGEST_FIELD: f32 = 5000.0;
/// Passes of the fit. The weights settle in five or six.
const PASSES: u8 = 12;
/// Fewer samples than these say nothing about coverage.
const LEAST_SAMPLES: usize = 24;

/// What the machine is at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Collecting,
    /// So many passes are done, with this result.
    Fitting(u8, Shell),
}

/// The machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassCalibrator {
    limits: CompassLimits,
    timer: Timer,
    store: Store,
    cells: Cells,
    stage: Stage,
    end: Option<Result<CompassCalibration, CompassRefusal>>,
}

impl CompassCalibrator {
    /// At the beginning.
    pub fn new(limits: CompassLimits) -> Self {
        Self {
            limits,
            timer: Timer::new(limits.timeout),
            store: Store::new(),
            cells: Cells::default(),
            stage: Stage::Collecting,
            end: None,
        }
    }

    /// Takes in an uncalibrated field, µT, body axes, that stands for `duration` seconds.
    pub fn step(&mut self, field: Vector3, duration: f32) -> CompassProgress {
        if self.end.is_none() {
            self.end = self.take_in(field, duration).transpose();
        }
        let (share, instruction) = self.report();
        CompassProgress::of(self.end, share, instruction)
    }

    fn report(&self) -> (f32, CompassInstruction) {
        match self.stage {
            Stage::Fitting(passes, _) => {
                let share = 0.9 + 0.1 * f32::from(passes) / f32::from(PASSES);
                (share, CompassInstruction::Wait)
            }
            Stage::Collecting => {
                let needed = windhover_math::max(self.limits.cells, 1);
                let share = f32::from(self.cells.count()) / f32::from(needed);
                let missing = self.cells.others();
                let instruction = if self.store.is_too_fast() {
                    CompassInstruction::TurnSlower(missing)
                } else {
                    CompassInstruction::Turn(missing)
                };
                (0.9 * windhover_math::min(share, 1.0), instruction)
            }
        }
    }

    fn take_in(
        &mut self,
        field: Vector3,
        duration: f32,
    ) -> Result<Option<CompassCalibration>, CompassRefusal> {
        check(field, LARGEST_FIELD).map_err(CompassRefusal::Sample)?;
        let late = self.timer.advance(duration).map_err(CompassRefusal::Sample)?;
        match self.stage {
            Stage::Collecting => {
                self.collect(field);
                if late && self.stage == Stage::Collecting {
                    return Err(self.refusal_for_time());
                }
                Ok(None)
            }
            // A few steps more: the time limit is for the human.
            Stage::Fitting(passes, shell) if passes < PASSES => {
                let weights = shell.weights(self.store.samples());
                let next = fit::quadric(self.store.samples(), &weights, &shell);
                let next = next.ok_or(CompassRefusal::NoEllipsoid)?;
                self.stage = Stage::Fitting(passes + 1, next);
                Ok(None)
            }
            Stage::Fitting(_, shell) => self.judge(&shell).map(Some),
        }
    }

    fn collect(&mut self, field: Vector3) {
        if !self.store.offer(field) || self.store.samples().len() < LEAST_SAMPLES {
            return;
        }
        let sphere = fit::sphere(self.store.samples());
        self.cells = Cells::covered(self.store.samples(), sphere.centre);
        if self.cells.count() >= self.limits.cells {
            self.stage = Stage::Fitting(0, sphere);
        }
    }

    fn refusal_for_time(&self) -> CompassRefusal {
        if self.store.samples().len() < LEAST_SAMPLES {
            CompassRefusal::Timeout
        } else {
            CompassRefusal::Coverage(self.cells)
        }
    }

    fn judge(&self, shell: &Shell) -> Result<CompassCalibration, CompassRefusal> {
        let limits = &self.limits;
        let (correction, strength, ratio) = shell.correction();
        let Quality { spread, residual } = shell.quality(self.store.samples());
        if let Some((axis, offset)) = Axis::beyond(correction.offset, limits.offset) {
            return Err(CompassRefusal::Offset(axis, offset));
        }
        // What is not a number lies in no range.
        if !(0.0..=limits.spread).contains(&spread) {
            return Err(CompassRefusal::Residual(spread));
        }
        if !(1.0..=limits.ratio).contains(&ratio) {
            return Err(CompassRefusal::Ratio(ratio));
        }
        if !limits.strengths().contains(&strength) {
            return Err(CompassRefusal::Strength(strength));
        }
        Ok(CompassCalibration {
            correction,
            strength,
            residual,
        })
    }
}

impl Default for CompassCalibrator {
    fn default() -> Self {
        Self::new(CompassLimits::default())
    }
}
