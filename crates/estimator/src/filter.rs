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
//! refused at the [`crate::border`], and in each step one of the fifteen states, in turn, is held
//! within its bounds.

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

/// Largest gyro bias that is believed, rad/s.
pub const LARGEST_GYRO_BIAS: f32 = 0.5;
/// Largest accelerometer bias that is believed, m/s².
pub const LARGEST_ACCEL_BIAS: f32 = 5.0;

/// The filter: some 4.5 kB, of which 3.5 kB are its memory of the last 320 ms.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    pub(crate) state: State,
    pub(crate) covariance: Covariance,
    pub(crate) datum: Option<Datum>,
    history: History,
    pub(crate) densities: Added,
    monitors: [Monitor; SENSORS],
    time: u64,
    /// Which state is held within its bounds next.
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
        self.history.push(&moved, &self.state, time as u32);
        self.time = time;
        self.bound();
        Ok(())
    }

    /// Holds one of the states within its bounds.
    #[inline(always)]
    fn bound(&mut self) {
        self.turn = if self.turn + 1 < STATES { self.turn + 1 } else { 0 };
        let axis = match self.turn % 3 {
            0 => Axis::X,
            1 => Axis::Y,
            _ => Axis::Z,
        };
        let k = axis as usize;
        let (group, part, limit) = match self.turn / 3 {
            0 => (Group::Position, &mut self.state.position, LARGEST_POSITION),
            1 => (Group::Velocity, &mut self.state.velocity, LARGEST_VELOCITY),
            2 => return self.covariance.bound(Group::Attitude, axis),
            3 => (Group::GyroBias, &mut self.state.gyro_bias, LARGEST_GYRO_BIAS),
            _ => (Group::AccelBias, &mut self.state.accel_bias, LARGEST_ACCEL_BIAS),
        };
        part.as_mut_slice()
            .iter_mut()
            .skip(k)
            .take(1)
            .for_each(|x| *x = saturate(*x, limit));
        self.covariance.bound(group, axis);
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

    /// The moment at which something was measured; what is refused is counted.
    #[inline]
    pub(crate) fn past(&mut self, time: u64) -> Result<Past, Refusal> {
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
        let old = self.state;
        match verdict {
            Verdict::Accepted => fuse(self),
            Verdict::Reset => reset(self),
            Verdict::Rejected => {}
        }
        let step = match verdict {
            Verdict::Accepted if !late => None,
            Verdict::Rejected => None,
            Verdict::Accepted | Verdict::Reset => Some(Reset::between(&old, &self.state)),
        };
        Report { tests, verdict, step }
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

    /// The rotation vector in the world, rad, from the attitude `from` to `to`; for small ones.
    #[inline(always)]
    pub(crate) fn turn_between(from: Quaternion, to: Quaternion) -> [f32; 3] {
        let d = (to * from.conjugate()).shortest();
        [2.0 * d.x, 2.0 * d.y, 2.0 * d.z]
    }
}
