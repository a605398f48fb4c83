//! What the gates say of the sensors.

use crate::gate::{INSISTENCE, Policy, Verdict};

/// What is judged as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Horizontal position of the satellite receiver.
    GnssPosition,
    /// Its height.
    GnssHeight,
    /// Its velocity.
    GnssVelocity,
    /// Barometric height.
    Barometer,
    /// Magnetic field.
    Compass,
    /// Heading, by whatever means.
    Heading,
    /// Standing still: no velocity, no rate.
    Rest,
    /// Standing still: only gravity.
    Gravity,
    /// Position, velocity and attitude from outside.
    Pose,
}

/// Number of [`Sensor`]s.
pub const SENSORS: usize = Sensor::ALL.len();

impl Sensor {
    /// All of them, in their order.
    pub const ALL: [Self; 9] = [
        Self::GnssPosition,
        Self::GnssHeight,
        Self::GnssVelocity,
        Self::Barometer,
        Self::Compass,
        Self::Heading,
        Self::Rest,
        Self::Gravity,
        Self::Pose,
    ];
}

/// How a sensor does. Ages are the time since its last accepted measurement, µs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Health {
    /// Nothing of it was ever accepted.
    Unseen,
    /// Its last measurement was accepted, not long ago.
    Good {
        /// Since then.
        age: u64,
    },
    /// Its last measurement was rejected, or is old.
    Degraded {
        /// Since the last accepted one.
        age: u64,
    },
    /// Nothing was accepted for so long that the filter does not rely on it.
    Lost {
        /// Since the last accepted one.
        age: u64,
    },
}

/// What happened to a sensor's measurements. Counts stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Monitor {
    /// Taken in.
    pub accepted: u32,
    /// Rejected by the gate.
    pub rejected: u32,
    /// Rejected since the last one that was not.
    pub consecutive: u32,
    /// Resets of the state to it.
    pub resets: u32,
    /// Refused at the border.
    pub refused: u32,
    /// When the last one was taken in, µs.
    last: Option<u64>,
}

impl Monitor {
    /// Since the last accepted measurement, µs.
    #[inline]
    pub fn age(&self, now: u64) -> Option<u64> {
        self.last.map(|last| now.saturating_sub(last))
    }

    /// Whether there was a first measurement, and none for longer than the time-out since.
    #[inline]
    pub(crate) fn is_late(&self, policy: &Policy, now: u64) -> bool {
        self.age(now).is_some_and(|age| age > policy.timeout)
    }

    /// Decides on a measurement of which the gates say `passes`, and counts it.
    #[inline]
    pub(crate) fn judge(&mut self, policy: &Policy, passes: bool, now: u64) -> Verdict {
        if passes {
            self.accepted = self.accepted.saturating_add(1);
            self.consecutive = 0;
            self.last = Some(now);
            return Verdict::Accepted;
        }
        self.reject();
        let needed = if self.is_late(policy, now) {
            INSISTENCE
        } else {
            policy.patience
        };
        if self.consecutive < needed {
            return Verdict::Rejected;
        }
        self.resets = self.resets.saturating_add(1);
        self.consecutive = 0;
        self.last = Some(now);
        Verdict::Reset
    }

    /// Counts a measurement that failed the gate.
    #[inline]
    pub(crate) fn reject(&mut self) {
        self.rejected = self.rejected.saturating_add(1);
        self.consecutive = self.consecutive.saturating_add(1);
    }

    /// How the sensor does at `now`, µs.
    pub fn health(&self, policy: &Policy, now: u64) -> Health {
        match self.age(now) {
            None => Health::Unseen,
            Some(age) if age > policy.timeout => Health::Lost { age },
            Some(age) if age > policy.stale || self.consecutive > 0 => Health::Degraded { age },
            Some(age) => Health::Good { age },
        }
    }
}
