//! Calibrations that a ground station asks for: samples go into the core's machines, what comes out
//! goes into the parameter table.
//!
//! What people are told follows PX4's lines, which ground stations show as progress: "[cal] …".

use core::fmt;

use windhover_autopilot::calibration::Progress;
use windhover_autopilot::calibration::accelerometer::{
    AccelerometerCalibrator, AccelerometerInstruction, Side,
};
use windhover_autopilot::calibration::compass::CompassCalibrator;
use windhover_autopilot::calibration::gyro::GyroCalibrator;
use windhover_autopilot::calibration::level::LevelCalibrator;
use windhover_autopilot::calibration::rc::RcCalibrator;
use windhover_autopilot::sensing::{BoardRotation, CalibrationParameters, SensingBorder};
use windhover_autopilot::{CompassFitting, Parameters};
use windhover_ground_link::{Calibration, Severity};

use crate::told::{SAMPLE_PERIOD, Told};

/// Progress is told in steps of so many percent.
const STEP: u8 = 10;

/// How the sensors sit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fitting {
    /// The inertial sensors.
    pub rotation: BoardRotation,
    /// The compass.
    pub compass: CompassFitting,
}

/// The machine that runs.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one, and no heap")]
enum Machine {
    Gyro(GyroCalibrator),
    Accelerometer(AccelerometerCalibrator),
    Level(LevelCalibrator),
    Compass(CompassCalibrator),
    Radio(RcCalibrator),
}

/// How a calibration goes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "made once in a calibration")]
pub enum Standing {
    /// It goes on; percent.
    Going(u8),
    /// These are to be the parameters.
    Done(Parameters),
    /// There is no result.
    Failed,
}

/// A calibration under way.
#[derive(Clone, Debug)]
pub struct Calibrating {
    machine: Machine,
    fitting: Fitting,
    percent: u8,
    /// The side that lies down, as far as that was told.
    side: Option<Side>,
    /// When the compass was last read, µs.
    compass_time: Option<u64>,
    /// When the remote control was last heard, µs.
    radio_time: Option<u64>,
}

impl Calibrating {
    /// Begins; `None` for what there is no machine for.
    pub fn begin(
        kind: Calibration,
        fitting: Fitting,
        say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
    ) -> Option<Self> {
        let machine = match kind {
            Calibration::Gyro => Machine::Gyro(GyroCalibrator::new(Default::default())),
            Calibration::Accelerometer => {
                Machine::Accelerometer(AccelerometerCalibrator::new(Default::default()))
            }
            Calibration::Level => Machine::Level(LevelCalibrator::new(Default::default())),
            Calibration::Compass => Machine::Compass(CompassCalibrator::new(Default::default())),
            Calibration::Radio => Machine::Radio(RcCalibrator::new(Default::default())),
            Calibration::Pressure | Calibration::AccelerometerOffset | Calibration::Cancel => return None,
        };
        let calibrating = Self {
            machine,
            fitting,
            percent: 0,
            side: None,
            compass_time: None,
            radio_time: None,
        };
        let name = calibrating.name();
        say(
            Severity::Info,
            format_args!("[cal] calibration started: 2 {name}"),
        );
        Some(calibrating)
    }

    /// How far it is.
    pub fn percent(&self) -> u8 {
        self.percent
    }

    /// What is calibrated, as ground stations know it.
    fn name(&self) -> &'static str {
        match self.machine {
            Machine::Gyro(_) => "gyro",
            Machine::Accelerometer(_) => "accel",
            Machine::Level(_) => "level",
            Machine::Compass(_) => "mag",
            Machine::Radio(_) => "rc",
        }
    }

    /// Takes in the samples since the last time. `parameters` are as they are now.
    pub fn step(
        &mut self,
        told: &Told,
        parameters: &Parameters,
        say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
    ) -> Standing {
        let standing = match &mut self.machine {
            Machine::Compass(_) => self.compass(told, parameters, say),
            Machine::Radio(_) => self.radio(told, parameters, say),
            _ => self.inertial(told, parameters, say),
        };
        match standing {
            Standing::Going(percent) if percent / STEP != self.percent / STEP => {
                self.percent = percent;
                say(Severity::Info, format_args!("[cal] progress <{percent}>"));
            }
            Standing::Done(_) => say(
                Severity::Info,
                format_args!("[cal] calibration done: {}", self.name()),
            ),
            _ => {}
        }
        standing
    }

    fn inertial(
        &mut self,
        told: &Told,
        parameters: &Parameters,
        say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
    ) -> Standing {
        let mut calibration = CalibrationParameters::default();
        if matches!(self.machine, Machine::Level(_)) {
            // As calibrated, but for what is to be found.
            calibration = CalibrationParameters {
                level_roll: 0.0,
                level_pitch: 0.0,
                ..parameters.calibration
            };
        }
        let border = SensingBorder::new(&self.fitting.rotation, &calibration);
        let mut new = *parameters;
        let mut standing = Standing::Going(self.percent);
        for counts in told.samples() {
            let sample = border.convert(counts);
            standing = match &mut self.machine {
                Machine::Gyro(machine) => settle(machine.step(&sample, SAMPLE_PERIOD), say, |found| {
                    found.write(&mut new.calibration);
                    new.calibration.gyro_id = 1.0;
                    new
                }),
                Machine::Level(machine) => settle(machine.step(&sample, SAMPLE_PERIOD), say, |found| {
                    found.write(&mut new.calibration);
                    new
                }),
                Machine::Accelerometer(machine) => {
                    let progress = machine.step(&sample, SAMPLE_PERIOD);
                    if let Progress::Going { instruction, .. } = &progress {
                        tell_side(&mut self.side, instruction, say);
                    }
                    settle(progress, say, |found| {
                        found.write(&mut new.calibration);
                        new.calibration.accel_id = 1.0;
                        new
                    })
                }
                Machine::Compass(_) | Machine::Radio(_) => return standing,
            };
            if !matches!(standing, Standing::Going(_)) {
                break;
            }
        }
        standing
    }

    fn compass(
        &mut self,
        told: &Told,
        parameters: &Parameters,
        say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
    ) -> Standing {
        let Machine::Compass(machine) = &mut self.machine else {
            return Standing::Failed;
        };
        let mut new = *parameters;
        let mut standing = Standing::Going(self.percent);
        for sample in told.compass() {
            let since = self.compass_time.replace(sample.time);
            let Some(since) = since.filter(|since| *since < sample.time) else {
                continue;
            };
            let duration = (sample.time - since).min(500_000) as f32 * 1e-6;
            let field = self.fitting.compass.field(sample.counts);
            standing = settle(machine.step(field, duration), say, |found| {
                found.write(&mut new.calibration);
                new.calibration.compass_id = 1.0;
                new
            });
            if !matches!(standing, Standing::Going(_)) {
                break;
            }
        }
        standing
    }

    fn radio(
        &mut self,
        told: &Told,
        parameters: &Parameters,
        say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
    ) -> Standing {
        let Machine::Radio(machine) = &mut self.machine else {
            return Standing::Failed;
        };
        let Some((time, frame)) = told.radio().filter(|(time, _)| Some(*time) != self.radio_time) else {
            return Standing::Going(self.percent);
        };
        let Some(since) = self.radio_time.replace(time).filter(|since| *since < time) else {
            return Standing::Going(self.percent);
        };
        let duration = (time - since).min(500_000) as f32 * 1e-6;
        let mut new = *parameters;
        settle(machine.step(&frame.channels, duration), say, |found| {
            found.write(&mut new.rc_calibration);
            new
        })
    }
}

/// What a machine says, in percent or as new parameters.
fn settle<I, O, R: fmt::Display>(
    progress: Progress<I, O, R>,
    say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
    write: impl FnOnce(O) -> Parameters,
) -> Standing {
    match progress {
        Progress::Going { share, .. } => Standing::Going((share * 100.0) as u8),
        Progress::Done(found) => Standing::Done(write(found)),
        Progress::Refused(reason) => {
            say(
                Severity::Error,
                format_args!("[cal] calibration failed: {reason}"),
            );
            Standing::Failed
        }
    }
}

/// Tells when another side lies down, and when it is done.
fn tell_side(
    side: &mut Option<Side>,
    instruction: &AccelerometerInstruction,
    say: &mut dyn FnMut(Severity, fmt::Arguments<'_>),
) {
    let now = match instruction {
        AccelerometerInstruction::Hold(side) => Some(*side),
        AccelerometerInstruction::Moved(..) => return,
        _ => None,
    };
    if now == *side {
        return;
    }
    if let Some(done) = side.take()
        && matches!(
            instruction,
            AccelerometerInstruction::PutDown(_) | AccelerometerInstruction::AlreadyTaken(..)
        )
    {
        let name = side_name(done);
        say(
            Severity::Info,
            format_args!("[cal] {name} side done, rotate to a different side"),
        );
    }
    if let Some(begun) = now {
        let name = side_name(begun);
        say(Severity::Info, format_args!("[cal] {name} orientation detected"));
    }
    *side = now;
}

/// PX4's name of the side that is down.
fn side_name(side: Side) -> &'static str {
    match side {
        Side::Front => "front",
        Side::Back => "back",
        Side::Right => "right",
        Side::Left => "left",
        Side::Bottom => "down",
        Side::Top => "up",
    }
}
