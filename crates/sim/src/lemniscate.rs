//! A figure of eight in the air, as peers fly it: how well a moving setpoint is followed.

use windhover_autopilot::{Command, InnerInput, Mode, MotorCommand, OuterResult, ScheduleRecord, Snapshot};
use windhover_control::TrajectorySetpoint;
use windhover_math::Vector3;
use windhover_math::geodesy::GlobalPosition;
use windhover_model::{Conditions, Truth};

use crate::closed_loop::{ClosedLoop, Recorder};
use crate::figures::ErrorSum;
use crate::flight::{Setup, SetupError};
use crate::stored::Stored;

/// Height above the ground of the middle of the figure, m.
const HEIGHT: f64 = 5.0;

/// How long the vehicle has for getting to the start of the figure, s.
const APPROACH: f64 = 8.0;

/// A lemniscate, 1 m to the north and south of its middle, 0.5 m to the east and west, 0.2 m up
/// and down: north = A sin ωt, east = B sin 2ωt, up = C sin 2ωt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lemniscate {
    /// Time of one round, s.
    pub period: f64,
    /// Constant acceleration that disturbs the vehicle, NED, m/s².
    pub disturbance: Vector3<f64>,
}

/// How it went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LemniscateFigures {
    /// Root mean square of the position error over the third to the sixth round, m.
    pub rmse: f64,
    /// Its largest value, m.
    pub largest: f64,
}

impl Lemniscate {
    /// The setpoint `t` seconds after the start; before it, at rest at its middle.
    pub fn setpoint(&self, t: f64) -> TrajectorySetpoint {
        let omega = 2.0 * core::f64::consts::PI / self.period;
        let axis = |amplitude: f64, times: f64| {
            let (sin, cos) = libm::sincos(omega * times * t);
            let rate = omega * times;
            [
                amplitude * sin,
                amplitude * rate * cos,
                -amplitude * rate * rate * sin,
                -amplitude * rate * rate * rate * cos,
            ]
        };
        let (north, east, down) = (axis(1.0, 1.0), axis(0.5, 2.0), axis(-0.2, 2.0));
        let vector = |n: usize| Vector3::new(north[n] as f32, east[n] as f32, down[n] as f32);
        let middle = Vector3::new(0.0, 0.0, -HEIGHT as f32);
        if t < 0.0 {
            return TrajectorySetpoint::at_rest(middle, 0.0);
        }
        TrajectorySetpoint {
            position: middle + vector(0),
            velocity: vector(1),
            acceleration: vector(2),
            jerk: vector(3),
            heading: 0.0,
            heading_rate: 0.0,
        }
    }

    /// Flies six rounds with perfect state in still air, from the ground.
    pub fn fly(&self, setup: &Setup) -> Result<LemniscateFigures, SetupError> {
        let conditions = Conditions {
            disturbance: self.disturbance,
            seed: setup.conditions.seed,
            ..Conditions::default()
        };
        let setup = Setup {
            conditions,
            ..setup.clone()
        };
        let outer = setup.outer(GlobalPosition::default())?;
        let mut flown = ClosedLoop::new(
            setup.world(),
            setup.inner_config(),
            outer,
            &Stored::default(),
            GlobalPosition::default(),
        );
        let mut error = Error {
            sum: ErrorSum::default(),
            from: APPROACH + 2.0 * self.period,
        };
        let rate = f64::from(setup.imu_rate);
        let ticks = ((APPROACH + 6.0 * self.period) * rate) as u64;
        for tick in 0..ticks {
            let time = tick as f64 / rate;
            if tick.is_multiple_of(u64::from(setup.inner_config().k())) {
                flown
                    .mailboxes
                    .queues
                    .setpoint
                    .push(self.setpoint(time - APPROACH));
            }
            match tick {
                0 => flown.mailboxes.queues.command.push(Command::Arm),
                100 => flown.mailboxes.queues.command.push(Command::Fly(Mode::Offboard)),
                _ => {}
            }
            flown.tick(&mut error);
        }
        let (rms, largest) = (error.sum.rms(), error.sum.largest());
        Ok(LemniscateFigures {
            rmse: rms.length(),
            largest: largest.length(),
        })
    }
}

struct Error {
    sum: ErrorSum,
    from: f64,
}

impl Recorder for Error {
    fn tick(&mut self, _: &Truth, _: &InnerInput, _: MotorCommand, _: Option<ScheduleRecord>) {}

    fn outer(&mut self, truth: &Truth, _: &Snapshot, result: &OuterResult) {
        if let Some(setpoint) = result.report.trajectory
            && truth.time >= self.from
        {
            self.sum.add(truth.position - setpoint.position.map(f64::from));
        }
    }
}
