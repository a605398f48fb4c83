//! The core of the autopilot: everything that decides a motor command, in two steps.
//!
//! [`Inner`] runs at every sample: sensing border, attitude predictor, gyro filter, attitude
//! control, mixer. [`Outer`] runs 250 times a second on a frozen [`Snapshot`]: estimate, mission, position
//! control. [`schedule`] says when results pass from one to the other, so that firmware, desktop
//! and replay do exactly the same however long each step takes.
//!
//! Nothing here knows an executor, a clock or a static. Time, samples, commands and parameters
//! come in as data ([`io`], [`queue`]); motor commands and reports go out as data.
#![no_std]

pub mod aiding;
pub mod battery;
pub mod blocker;
pub mod calibration;
pub mod declination;
pub mod estimation;
pub mod fence;
pub mod gyro_filter;
pub mod inner;
pub mod io;
pub mod landing;
pub mod mission;
pub mod mode;
pub mod outer;
pub mod parameters;
pub mod plausible;
pub mod queue;
pub mod rc;
pub mod schedule;
pub mod sensing;
mod set;
pub mod supervisor;
pub mod trajectory;
pub mod watch;

pub use aiding::{BarometerSample, CompassFitting, CompassSample, GnssSample};
pub use battery::{Battery, BatteryParameters, BatterySample, Charge};
pub use blocker::{Blocker, Blockers};
pub use declination::declination;
pub use estimation::{Estimate, Known, OuterConfig};
pub use inner::{Inner, InnerConfig, InnerParameters, Mailboxes, MotorState, Snapshot, Stop, TickOutput};
pub use io::{Imu, ImuCounts, Increments, InnerInput, MotorCommand, ScheduleRecord, Urgent};
pub use mode::Mode;
pub use outer::{Outer, OuterReport, OuterResult, Refusals, Refused, Why};
pub use parameters::{Parameters, Preset};
pub use queue::{
    Command, ExternalEstimate, MissionCommit, MotorTest, OuterInputs, ParameterWrite, Queues, Station,
};
pub use rc::{RcFrame, RcParameters, Remote, Sticks};
pub use schedule::Schedule;
pub use supervisor::{Action, Phase, Row};
