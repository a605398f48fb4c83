//! The remote control with its memory: who holds the sticks, and which switch was moved.
//!
//! A receiver's sticks come before a ground station's while they are fresh. Switches are the
//! receiver's alone. A switch does something when it is moved, never because of where it was found:
//! at the start and after a loss its position is only taken note of. The kill switch is the
//! exception, it acts by its position.

use super::channel::Reading;
use super::switch::{Switch, is_on, position};
use super::{RcFrame, RcParameters, Sticks};
use crate::calibration::rc::RcCalibrationParameters;
use crate::mode::Mode;

/// The throttle is at its low end below this.
const THROTTLE_LOW: f32 = -0.9;
/// Sticks that are let go lie within the dead band and this.
const REST: f32 = 0.1;
/// Beyond this the pilot takes over.
const TAKES_OVER: f32 = 1.0 / 3.0;

/// What was done with switches during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// The mode switch was moved to a position that selects this mode.
    pub mode: Option<Mode>,
    /// The arm switch was moved: on, with all that is asked for, or off.
    pub arm: Option<bool>,
    /// The arm switch is on, and this does not count: the sticks were not at rest with the throttle low,
    /// or it was on from the beginning. Said once, and only on the ground.
    pub refused: bool,
    /// The kill switch is on. Not an edge: as long as it is on and the receiver is there.
    pub kill: bool,
}

/// Somebody's sticks, and how old they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Source {
    raw: Sticks,
    shaped: Sticks,
    /// µs since they came.
    age: u32,
    seen: bool,
    fresh: bool,
}

impl Source {
    fn pass(&mut self, dt_us: u32, limit: u32) {
        self.age = self.age.saturating_add(dt_us);
        self.fresh &= self.age <= limit;
    }

    fn take(&mut self, raw: Sticks, rc: &RcParameters) {
        *self = Self {
            raw,
            shaped: rc.shape(&raw),
            age: 0,
            seen: true,
            fresh: true,
        };
    }
}

/// The machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Remote {
    receiver: Source,
    joystick: Source,
    mode: Switch<u8>,
    arm: Switch<bool>,
    kill: Switch<bool>,
    rejected: u32,
}

impl Remote {
    /// Goes on by `dt_us` µs, and then takes in what came: frames of a receiver, and sticks of a
    /// ground station, each in order of arrival. `landed` is where arming has conditions.
    pub fn step(
        &mut self,
        frames: &[RcFrame],
        joystick: &[Sticks],
        rc: &RcParameters,
        calibration: &RcCalibrationParameters,
        landed: bool,
        dt_us: u32,
    ) -> Events {
        let mut events = Events::default();
        if frames.is_empty() && joystick.is_empty() && !self.was_seen() {
            return events;
        }
        self.pass(dt_us, (rc.loss_time * 1e6) as u32);
        for frame in frames {
            let reading = Reading {
                frame,
                rc,
                calibration,
            };
            self.take_frame(&reading, landed, &mut events);
        }
        for sticks in joystick {
            if sticks.is_valid() {
                self.joystick.take(*sticks, rc);
            } else {
                self.reject();
            }
        }
        events.kill = self.kill.position() == Some(true);
        events
    }

    /// The sticks of who holds them, shaped; `None` when all are older than `COM_RC_LOSS_T`.
    pub fn sticks(&self) -> Option<Sticks> {
        self.source().map(|source| source.shaped)
    }

    /// Whether there were sticks since the start and there are none now.
    pub fn is_lost(&self) -> bool {
        self.was_seen() && self.source().is_none()
    }

    /// Whether there were sticks since the start.
    pub fn was_seen(&self) -> bool {
        self.receiver.seen || self.joystick.seen
    }

    /// Whether the pilot takes over: roll, pitch or yaw beyond a third of its way.
    pub fn moved(&self) -> bool {
        self.source()
            .is_some_and(|source| !source.raw.rests_within(TAKES_OVER))
    }

    /// Position of the mode switch, 1 to 6, while the receiver is there and has one.
    pub fn mode_position(&self) -> Option<u8> {
        self.mode.position()
    }

    /// How many frames and sticks were none, since the start: a stick was missing or impossible.
    pub fn rejected(&self) -> u32 {
        self.rejected
    }

    /// Who holds the sticks.
    fn source(&self) -> Option<&Source> {
        if self.receiver.fresh {
            Some(&self.receiver)
        } else {
            Some(&self.joystick).filter(|source| source.fresh)
        }
    }

    fn reject(&mut self) {
        self.rejected = self.rejected.wrapping_add(1);
    }

    /// Time goes by. A lost receiver takes what is known of its switches along.
    fn pass(&mut self, dt_us: u32, limit: u32) {
        self.receiver.pass(dt_us, limit);
        self.joystick.pass(dt_us, limit);
        if !self.receiver.fresh {
            self.mode = Switch::default();
            self.arm = Switch::default();
            self.kill = Switch::default();
        }
    }

    fn take_frame(&mut self, reading: &Reading<'_>, landed: bool, events: &mut Events) {
        let Some(raw) = reading.sticks() else {
            self.reject();
            return;
        };
        let rc = reading.rc;
        self.receiver.take(raw, rc);
        let shown = reading.lever(rc.mode_switch).map(position);
        if let Some(change) = self.mode.step(rc.mode_switch, shown)
            && change.from.is_some()
        {
            events.mode = rc.mode(change.to);
        }
        let shown = reading.lever(rc.kill_switch).and_then(is_on);
        self.kill.step(rc.kill_switch, shown);
        let shown = reading.lever(rc.arm_switch).and_then(is_on);
        if let Some(change) = self.arm.step(rc.arm_switch, shown) {
            // in the air motors that are wanted are needed, wherever the sticks are
            let safe = !landed || (raw.throttle < THROTTLE_LOW && raw.rests_within(rc.dead_band + REST));
            match (change.from, change.to) {
                (Some(_), true) if safe => events.arm = Some(true),
                (_, true) => events.refused |= landed,
                (Some(_), false) => events.arm = Some(false),
                (None, false) => {}
            }
        }
    }
}
