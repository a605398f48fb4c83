//! The error-state Kalman filter of the outer loop.
//!
//! It follows Solà, *Quaternion kinematics for the error-state Kalman filter* (2017), with the
//! attitude error in the world (section 7). The nominal [`State`] moves by the inertial sensors'
//! increments; the [`Covariance`] of its errors moves along; each measurement corrects both, one
//! scalar at a time, against the state at the measurement's own time (see
//! [`crate::history`]). Measurements are methods, one file each in [`crate::measurement`].
//!
//! Wind is no state: without an airspeed sensor it is only seen through drag, by a vehicle model
//! that the filter does not have; the disturbance observer of the controller does that work.
//!
//! Nothing in it can panic, and no input can make the state anything but finite: inputs are
//! refused at the [`crate::border`], and in every second step one of the fifteen states, in
//! turn, is held within its bounds.

use windhover_math::{Quaternion, saturate};

use crate::accuracy::Accuracy;
use crate::border::{LARGEST_POSITION, LARGEST_VELOCITY, Refusal, deviation, number};
use crate::covariance::{Added, Axis, Covariance, Group, Reference, STATES};
use crate::gate::{Policy, Report, Test, Verdict};
use crate::health::{Health, Monitor, SENSORS, Sensor};
use crate::history::{History, Past};
use crate::measurement::barometer::Datum;
use crate::noise::NoiseParameters;
use crate::reset::Reset;
use crate::start::{Deviations, Start};
use crate::state::{InertialIncrements, State};

/// A velocity is at most so late, s.
const LONGEST_LAG: f32 = 0.3;

/// Density of the noise of a specific force that is reckoned from the rotors, m/s²/√Hz: wind of
/// some m/s² that stays for some seconds.
const RECKONED_FORCE: f32 = 3.0;

/// Largest gyro bias that is believed, rad/s.
pub const LARGEST_GYRO_BIAS: f32 = 0.5;
/// Largest accelerometer bias that is believed, m/s².
pub const LARGEST_ACCEL_BIAS: f32 = 5.0;

/// The filter: 3 kB, of which 1.8 kB are its memory of the last 320 ms.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    pub(crate) state: State,
    pub(crate) covariance: Covariance,
    pub(crate) datum: Option<Datum>,
    history: History,
    pub(crate) densities: Added,
    monitors: [Monitor; SENSORS],
    time: u64,
    /// Counts the steps, up to twice the number of states: in odd ones a state is held.
    turn: usize,
}

impl Filter {
    /// Begins at `time`, µs.
    pub fn new(start: &Start, noise: &NoiseParameters, time: u64) -> Result<Self, Refusal> {
        start.check()?;
        let mut state = start.state;
        state.attitude = state.attitude.normalized();
        Ok(Self {
            state,
            covariance: start.covariance(),
            datum: None,
            history: History::new(&state, time as u32),
            densities: noise.densities(),
            monitors: [Monitor::default(); SENSORS],
            time,
            turn: 0,
        })
    }

    /// Goes on with the state and covariance of another filter, at `time`, µs.
    pub fn resume(
        state: &State,
        covariance: &Covariance,
        noise: &NoiseParameters,
        time: u64,
    ) -> Result<Self, Refusal> {
        let start = Start {
            state: *state,
            deviations: Deviations::default(),
        };
        if !covariance.is_sound() {
            return Err(Refusal::NotFinite);
        }
        Ok(Self {
            covariance: *covariance,
            ..Self::new(&start, noise, time)?
        })
    }

    /// Carries state and covariance over an interval that ends at `time`, µs. A refused interval
    /// changes nothing.
    #[inline]
    pub fn predict(&mut self, increments: &InertialIncrements, time: u64) -> Result<(), Refusal> {
        increments.check()?;
        if time <= self.time {
            return Err(Refusal::TooOld);
        }
        let moved = self.state.propagate(increments);
        let added = Added::over(&self.densities, increments.duration);
        self.covariance.predict(&moved.transition, &added);
        self.time = time;
        self.history.advance(&moved, time as u32);
        // Every second time each: none is urgent, and so the longest step is shorter.
        self.turn = if self.turn + 1 < 2 * STATES {
            self.turn + 1
        } else {
            0
        };
        if self.turn & 1 == 0 {
            self.history.keep();
        } else {
            self.state.attitude = self.state.attitude.renormalized();
            if !self.history.renew(&self.state) {
                self.bound();
            }
        }
        Ok(())
    }

    /// Holds one of the states within its bounds.
    #[inline(always)]
    fn bound(&mut self) {
        use Axis::{X, Y, Z};
        use Group::{AccelBias, Attitude, GyroBias, Position, Velocity};
        // Written out, so that each of them is two comparisons with constants.
        match self.turn {
            1 => self.hold(Position, X, self.state.position.x, LARGEST_POSITION),
            3 => self.hold(Position, Y, self.state.position.y, LARGEST_POSITION),
            5 => self.hold(Position, Z, self.state.position.z, LARGEST_POSITION),
            7 => self.hold(Velocity, X, self.state.velocity.x, LARGEST_VELOCITY),
            9 => self.hold(Velocity, Y, self.state.velocity.y, LARGEST_VELOCITY),
            11 => self.hold(Velocity, Z, self.state.velocity.z, LARGEST_VELOCITY),
            13 => self.hold(Attitude, X, 0.0, 1.0),
            15 => self.hold(Attitude, Y, 0.0, 1.0),
            17 => self.hold(Attitude, Z, 0.0, 1.0),
            19 => self.hold(GyroBias, X, self.state.gyro_bias.x, LARGEST_GYRO_BIAS),
            21 => self.hold(GyroBias, Y, self.state.gyro_bias.y, LARGEST_GYRO_BIAS),
            23 => self.hold(GyroBias, Z, self.state.gyro_bias.z, LARGEST_GYRO_BIAS),
            25 => self.hold(AccelBias, X, self.state.accel_bias.x, LARGEST_ACCEL_BIAS),
            27 => self.hold(AccelBias, Y, self.state.accel_bias.y, LARGEST_ACCEL_BIAS),
            _ => self.hold(AccelBias, Z, self.state.accel_bias.z, LARGEST_ACCEL_BIAS),
        }
    }

    #[inline(always)]
    fn hold(&mut self, group: Group, axis: Axis, value: f32, limit: f32) {
        if !(value.abs() <= limit && self.covariance.is_bounded(group, axis)) {
            self.put_right(group, axis);
        }
    }

    /// Out of the way of the usual step.
    #[cold]
    #[inline(never)]
    fn put_right(&mut self, group: Group, axis: Axis) {
        let (part, limit) = match group {
            Group::Position => (&mut self.state.position, LARGEST_POSITION),
            Group::Velocity => (&mut self.state.velocity, LARGEST_VELOCITY),
            Group::Attitude => return self.covariance.bound(group, axis),
            Group::GyroBias => (&mut self.state.gyro_bias, LARGEST_GYRO_BIAS),
            Group::AccelBias => (&mut self.state.accel_bias, LARGEST_ACCEL_BIAS),
        };
        match axis {
            Axis::X => part.x = saturate(part.x, limit),
            Axis::Y => part.y = saturate(part.y, limit),
            Axis::Z => part.z = saturate(part.z, limit),
        }
        self.covariance.bound(group, axis);
    }

    /// Whether the intervals to come hold a measured specific force, or one that is reckoned from
    /// the rotors and lacks the wind: then velocities tell nothing of the tilt.
    #[inline]
    pub fn trust_force(&mut self, noise: &NoiseParameters, is_measured: bool) {
        const RECKONED: f32 = RECKONED_FORCE * RECKONED_FORCE;
        if is_measured {
            // As the parameters are now: they may change in flight.
            self.densities = noise.densities();
        } else if self.densities.velocity != RECKONED {
            self.densities.velocity = RECKONED;
            // A late velocity has the noise of its lag taken off: it must have been added before.
            for axis in Axis::ALL {
                self.covariance
                    .widen(Group::Velocity, axis, RECKONED * LONGEST_LAG);
            }
        }
    }

    /// What the filter believes now.
    #[inline]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// How far it may be off.
    #[inline]
    pub fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// Time of the state, µs.
    #[inline]
    pub fn time(&self) -> u64 {
        self.time
    }

    /// What the filter claims of itself.
    pub fn accuracy(&self) -> Accuracy {
        Accuracy::of(&self.covariance, self.datum.map_or(0.0, |datum| datum.variance))
    }

    /// What happened to a sensor's measurements.
    pub fn monitor(&self, sensor: Sensor) -> Monitor {
        self.monitors[sensor as usize]
    }

    /// How a sensor does.
    pub fn health(&self, sensor: Sensor) -> Health {
        self.monitor(sensor).health(&Policy::of(sensor), self.time)
    }

    /// Forgets the attitude in flight, after a shock or clipping: tilt and heading are kept as
    /// they are, but with these standard deviations (rad) and without their correlations. The
    /// next velocities of the receiver level the vehicle again (its acceleration against the
    /// specific force), the next compass measurement gives its heading.
    pub fn realign(&mut self, tilt: f32, heading: f32) -> Result<(), Refusal> {
        for angle in [tilt, heading] {
            deviation(angle)?;
            number(angle, core::f32::consts::PI)?;
        }
        self.covariance.decouple(Group::Attitude, Axis::X, tilt * tilt);
        self.covariance.decouple(Group::Attitude, Axis::Y, tilt * tilt);
        self.covariance
            .decouple(Group::Attitude, Axis::Z, heading * heading);
        Ok(())
    }

    /// What was taken for north has a bearing of `angle`, rad, east positive: all that is believed
    /// in the world's axes, and of the past, turns by it about down. What is known of it is known as
    /// well as before.
    #[cold]
    #[inline(never)]
    pub fn turn(&mut self, angle: f32) -> Result<(), Refusal> {
        number(angle, core::f32::consts::PI)?;
        let turn = Quaternion::from_heading(angle);
        self.state.position = turn.rotate(self.state.position);
        self.state.velocity = turn.rotate(self.state.velocity);
        self.state.attitude = (turn * self.state.attitude).renormalized();
        self.covariance.turn(angle);
        self.history.turn(turn);
        Ok(())
    }

    /// The moment at which something was measured.
    #[inline(always)]
    pub(crate) fn past(&self, time: u64) -> Result<Past, Refusal> {
        if time == self.time {
            return Ok(Past::NOW);
        }
        self.past_at(time)
    }

    #[inline(never)]
    fn past_at(&self, time: u64) -> Result<Past, Refusal> {
        let age = self.time.wrapping_sub(time) as i64;
        if age < 0 {
            return Err(Refusal::Ahead);
        }
        if age > i64::from(i32::MAX) {
            return Err(Refusal::TooOld);
        }
        Ok(self.history.at(time as u32)?)
    }

    /// Counts a refusal and passes it on.
    #[inline]
    pub(crate) fn counted<T>(&mut self, sensor: Sensor, result: Result<T, Refusal>) -> Result<T, Refusal> {
        if result.is_err() {
            let monitor = &mut self.monitors[sensor as usize];
            monitor.refused = monitor.refused.saturating_add(1);
        }
        result
    }

    /// Judges a measurement by its tests, and does what follows: `fuse` takes it in, `reset` sets
    /// the state to it.
    #[inline(always)]
    pub(crate) fn decide<const N: usize>(
        &mut self,
        sensor: Sensor,
        tests: [Test; N],
        fuse: impl FnOnce(&mut Self),
        reset: impl FnOnce(&mut Self),
    ) -> Report<N> {
        let policy = Policy::of(sensor);
        let monitor = &mut self.monitors[sensor as usize];
        let late = monitor.is_late(&policy, self.time);
        let verdict = monitor.judge(&policy, tests.iter().all(Test::passes), self.time);
        let steps = late || verdict == Verdict::Reset;
        let old = steps.then_some(self.state);
        match verdict {
            Verdict::Accepted => fuse(self),
            Verdict::Reset => reset(self),
            Verdict::Rejected => {
                return Report {
                    tests,
                    verdict,
                    step: None,
                };
            }
        }
        let step = old.map(|old| Reset::between(&old, &self.state));
        Report { tests, verdict, step }
    }

    /// A measurement that failed the gate of a sensor that is never given in to.
    #[cold]
    pub(crate) fn rejected<const N: usize>(&mut self, sensor: Sensor, tests: [Test; N]) -> Report<N> {
        self.monitors[sensor as usize].reject();
        Report {
            tests,
            verdict: Verdict::Rejected,
            step: None,
        }
    }

    /// One scalar that measures a state directly: how it compares.
    #[inline(always)]
    pub(crate) fn test_direct(&self, reference: Reference, axis: Axis, innovation: f32, noise: f32) -> Test {
        Test {
            innovation,
            variance: self.covariance.variance(reference, axis) + noise,
        }
    }

    /// Takes it in.
    #[inline(always)]
    pub(crate) fn fuse_direct(&mut self, reference: Reference, axis: Axis, innovation: f32, noise: f32) {
        self.covariance
            .fuse_direct(&mut self.state, reference, axis, innovation, noise);
    }
}

const _: () = assert!(core::mem::size_of::<Filter>() <= 3 * 1024);
