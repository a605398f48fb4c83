//! What is wrong, and for how long: from what an outer step sees to the rows of the failsafes' table.
//!
//! [`Symptoms`] says which conditions hold now; [`Watch`] cuts time into "before" and "after" for
//! each row, fifty times a second; the [supervisor](crate::supervisor) decides what follows.

use windhover_math::{max, min};

use crate::battery::Charge;
use crate::estimation::Estimate;
use crate::inner::{Snapshot, Stop};
use crate::io::Increments;
use crate::mode::{Mode, Need, Needs};
use crate::parameters::Parameters;
use crate::schedule::OUTER_RATE;
use crate::supervisor::row::ROWS;
use crate::supervisor::{Row, RowSet};

/// Rows are looked at every so many outer periods.
const EVERY: u16 = 5;

/// Time between two looks, s.
const PERIOD: f32 = EVERY as f32 / OUTER_RATE as f32;

/// Time constant of the shares of bad samples and of saturated ticks, s.
const SHARE_TIME: f32 = 1.0;
/// Time constant of the tilt that wind takes, s.
const TILT_TIME: f32 = 2.0;
/// From such a share on inertial samples are not to be relied on.
const BAD_SAMPLES: f32 = 0.2;
/// From such a share of saturated ticks on a motor is at its limit.
const SATURATED: f32 = 0.8;
/// From such a share of the largest tilt on the wind takes all of it.
const WINDY: f32 = 0.93;
/// An interval between two outer steps that was longer was a silence, s.
const SILENCE: f32 = 0.1;

/// What an outer step sees, as far as it is watched.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The parameter table.
    pub parameters: &'a Parameters,
    /// The snapshot.
    pub snapshot: &'a Snapshot,
    /// What is believed.
    pub estimate: &'a Estimate,
    /// Time since the position was measured, s; `None` when that never happened.
    pub position_age: Option<f32>,
    /// A compass that was heard of before is not any more.
    pub compass_lost: bool,
    /// A barometer that was heard of before is not any more.
    pub barometer_lost: bool,
    /// The mode that flies, or that a failsafe has interrupted.
    pub mode: Mode,
    /// What that mode relies on.
    pub needs: Needs,
    /// Height above the place of arming, m.
    pub height: f32,
    /// The charge of the battery.
    pub charge: Charge,
    /// The battery does not last to return.
    pub range_short: bool,
    /// A remote control that was heard of before is not any more.
    pub rc_lost: bool,
    /// Time since a ground station was heard, s; `None` when none ever was.
    pub station_age: Option<f32>,
    /// Setpoints from outside are fresh.
    pub setpoint_fresh: bool,
    /// The fence is left, or cannot be kept any more.
    pub breach: bool,
}

/// What control asked for last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Cosine of the tilt.
    pub cos_tilt: f32,
    /// Whether it was all the thrust that there is.
    pub all_thrust: bool,
    /// Whether it was much less than the weight.
    pub light: bool,
}

impl Default for Wanted {
    fn default() -> Self {
        Self {
            cos_tilt: 1.0,
            all_thrust: false,
            light: true,
        }
    }
}

/// Which conditions hold, with what needs a memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symptoms {
    /// Share of inertial samples that were missing, invalid or at the end of their range.
    bad_samples: f32,
    /// Share of the time for which a motor, or all thrust, was at its limit.
    saturated: f32,
    /// Cosine of the tilt that control asks for.
    cos_tilt: f32,
    was_silent: bool,
}

impl Default for Symptoms {
    fn default() -> Self {
        Self {
            bad_samples: 0.0,
            saturated: 0.0,
            cos_tilt: 1.0,
            was_silent: false,
        }
    }
}

impl Symptoms {
    /// Takes in a step.
    #[inline]
    fn look(&mut self, snapshot: &Snapshot, wanted: &Wanted, on_sensors: bool) {
        let increments = &snapshot.increments;
        // An accelerometer that shows the same for long hangs, unless the world has no noise.
        let blind = if on_sensors { increments.blind } else { 0 };
        let bad = increments.missing.max(blind).max(increments.clipped);
        let saturated = if wanted.all_thrust {
            increments.ticks
        } else if wanted.light {
            // At the lower end of the thrust, torques are short of room: on the ground, as a rule.
            0
        } else {
            increments.saturated
        };
        if bad > 0 || saturated > 0 || self.bad_samples > 0.0 || self.saturated > 0.0 {
            self.count(increments, bad, saturated);
        }
        self.cos_tilt += (wanted.cos_tilt - self.cos_tilt) * share(increments, TILT_TIME);
        self.was_silent |= increments.duration > SILENCE;
    }

    /// Takes in so many ticks at which something was wrong, while there are any or their shares fade.
    #[inline(never)]
    fn count(&mut self, increments: &Increments, bad: u16, saturated: u16) {
        let ticks = f32::from(increments.ticks.max(1));
        let share = share(increments, SHARE_TIME);
        self.bad_samples += (min(f32::from(bad) / ticks, 1.0) - self.bad_samples) * share;
        self.saturated += (f32::from(saturated) / ticks - self.saturated) * share;
    }

    /// The rows whose condition holds.
    fn rows(&mut self, seen: &Seen<'_>) -> RowSet {
        let p = &seen.parameters.safety;
        let known = &seen.estimate.known;
        let position = is_position_known(seen.estimate, seen.position_age, seen.parameters);
        let tumbles = seen.estimate.attitude.cos_tilt() < windhover_math::cos(p.tumble_tilt);
        let low = !known.height || seen.height < p.tumble_height;
        let limit = windhover_math::cos(WINDY * seen.parameters.position.tilt_max);
        let older = |age: Option<f32>, most: f32| age.is_some_and(|age| age > most);
        let (needs_height, needs_position) = (
            seen.needs.contains(Need::Height),
            seen.needs.contains(Need::Position),
        );
        let silent = core::mem::take(&mut self.was_silent);
        RowSet::default()
            .with(Row::TumbleLow, tumbles && low && known.attitude)
            .with(Row::TumbleHigh, tumbles && !low && known.attitude)
            .with(Row::AttitudeUnknown, !known.attitude)
            .with(Row::HeightUnknown, !known.height && needs_height)
            .with(Row::PositionLost, !position && needs_position)
            .with(Row::PositionGone, !position && needs_position)
            .with(Row::GnssLost, older(seen.position_age, 0.5))
            .with(Row::ImuUnreliable, self.bad_samples > BAD_SAMPLES)
            .with(Row::BatteryEmergency, seen.charge >= Charge::Emergency)
            .with(Row::BatteryCritical, seen.charge >= Charge::Critical)
            .with(Row::BatteryLow, seen.charge >= Charge::Low)
            .with(Row::RangeShort, seen.range_short)
            .with(Row::MotorSaturated, self.saturated > SATURATED)
            .with(Row::WindTooStrong, self.cos_tilt < limit && needs_position)
            .with(Row::RcLost, seen.rc_lost)
            .with(Row::StationLost, older(seen.station_age, 1.5))
            .with(Row::CompassFault, seen.compass_lost && needs_position)
            .with(Row::BarometerFault, seen.barometer_lost && needs_height)
            .with(Row::Fence, seen.breach)
            .with(
                Row::OffboardLost,
                seen.mode == Mode::Offboard && !seen.setpoint_fresh,
            )
            .with(Row::OuterSilent, silent)
    }
}

/// How far a mean over `time` s follows an interval.
fn share(increments: &Increments, time: f32) -> f32 {
    min(increments.duration / time, 1.0)
}

/// Whether a position can be relied on: as declared, and measured not too long ago.
pub fn is_position_known(estimate: &Estimate, age: Option<f32>, parameters: &Parameters) -> bool {
    let measured = age.is_none_or(|age| age <= parameters.safety.position_lost);
    estimate.known.position && measured
}

/// The timers of the rows.
#[derive(Clone, Copy, Debug)]
pub struct Watch {
    symptoms: Symptoms,
    /// For how long each condition has held, or has been gone, in looks; counted while its row is not
    /// yet as the condition is.
    held: [u16; ROWS],
    /// The conditions that held at the last look.
    last: RowSet,
    active: RowSet,
    /// Outer periods since the last look that was due.
    periods: u16,
    /// Times of a look that are not counted yet: several after a late outer step.
    looks: u16,
}

impl Default for Watch {
    fn default() -> Self {
        Self {
            symptoms: Symptoms::default(),
            held: [0; ROWS],
            last: RowSet::default(),
            active: RowSet::default(),
            periods: 0,
            looks: 0,
        }
    }
}

impl Watch {
    /// The rows whose condition has lasted.
    pub fn active(&self) -> RowSet {
        self.active
    }

    /// Takes in a step of a vehicle on its own sensors, or one that is told from outside where it is;
    /// whether it is time to look at the rows.
    #[inline]
    pub fn step(&mut self, snapshot: &Snapshot, wanted: &Wanted, on_sensors: bool) -> bool {
        self.symptoms.look(snapshot, wanted, on_sensors);
        // A step that comes late stands for all the periods that it took.
        let passed = (snapshot.increments.duration * OUTER_RATE as f32 + 0.5) as u16;
        self.periods = self.periods.saturating_add(passed.max(1));
        let looks = self.periods / EVERY;
        self.periods -= looks * EVERY;
        self.looks = self.looks.saturating_add(looks);
        looks > 0
    }

    /// Looks at the rows, when it is due or before; those that have become active.
    pub fn look(&mut self, seen: &Seen<'_>) -> RowSet {
        let looks = core::mem::take(&mut self.looks);
        let now = self.symptoms.rows(seen);
        let before = self.active;
        let changed = now.xor(self.last);
        // All others are as their conditions are: there is nothing to be timed.
        for row in now.xor(before).iter() {
            let Some(held) = self.held.get_mut(row as usize) else {
                continue;
            };
            *held = if changed.contains(row) {
                0
            } else {
                held.saturating_add(looks)
            };
            let watched = row.watched();
            let time = if now.contains(row) {
                (watched.after)(seen.parameters)
            } else {
                watched.clears
            };
            if f32::from(*held) * PERIOD >= time {
                self.active = self.active.xor(RowSet::of(row));
            }
        }
        self.last = now;
        self.active.without(before)
    }

    /// A flight begins: what is over is over, without waiting for how long it has been.
    pub fn settle(&mut self) -> RowSet {
        self.active = self.active.and(self.last);
        self.active
    }

    /// The one row that does not wait for a look.
    pub fn with_stop(active: RowSet, stopped: Option<Stop>) -> RowSet {
        active.with(Row::ImuMissing, stopped == Some(Stop::ImuMissing))
    }
}

/// Time to return and land from `distance` m away and `height` m above home, s, as the parameters
/// fly it.
pub fn time_to_return(distance: f32, height: f32, parameters: &Parameters) -> f32 {
    let p = &parameters.mission;
    let top = if distance < p.acceptance_radius {
        height
    } else {
        max(height, p.return_altitude)
    };
    let climb = max(top - height, 0.0) / p.climb_speed;
    let slow = min(top, parameters.manual.land_fast_height);
    climb
        + distance / p.cruise_speed
        + max(top - slow, 0.0) / max(p.descend_speed, p.land_speed)
        + slow / p.land_speed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this failed, what is over would stay for many times as long behind outer steps that come late,
    /// and what is wrong would be found as late.
    #[test]
    fn a_row_is_over_by_time_however_late_steps_come() {
        let parameters = Parameters::default();
        let mut estimate = Estimate::default();
        for periods in [1u16, 4, 15] {
            let mut watch = Watch::default();
            let mut snapshot = Snapshot {
                tick: 0,
                time: 0,
                increments: Increments::default(),
                stopped: None,
                inputs: Default::default(),
            };
            snapshot.increments.duration = f32::from(periods) * 0.004;
            let mut time = 0.0;
            while time < 0.1 || watch.active().contains(Row::AttitudeUnknown) {
                estimate.known.attitude = time > 0.1;
                time += snapshot.increments.duration;
                assert!(time < 10.0, "{periods}");
                if watch.step(&snapshot, &Wanted::default(), true) {
                    watch.look(&Seen {
                        parameters: &parameters,
                        snapshot: &snapshot,
                        estimate: &estimate,
                        position_age: None,
                        compass_lost: false,
                        barometer_lost: false,
                        mode: Mode::Hold,
                        needs: Mode::Hold.needs(false),
                        height: 0.0,
                        charge: Charge::default(),
                        range_short: false,
                        rc_lost: false,
                        station_age: None,
                        setpoint_fresh: false,
                        breach: false,
                    });
                }
            }
            assert!((2.08..2.3).contains(&time), "{periods}: over after {time} s");
        }
    }
}
