//! Position, velocity and attitude from outside, as motion capture or a reference estimate gives
//! them: nine direct scalars, judged together.

use windhover_math::{Quaternion, Vector3};

use crate::border::{LARGEST_POSITION, LARGEST_VELOCITY, Refusal, deviation, rotation, vector};
use crate::covariance::{Axis, Group, Reference};
use crate::filter::Filter;
use crate::gate::Report;
use crate::health::Sensor;
use crate::history::Past;

/// A pose from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExternalPose {
    /// When it held, µs.
    pub time: u64,
    /// NED from the origin, m.
    pub position: Vector3,
    /// NED, m/s.
    pub velocity: Vector3,
    /// Body to world.
    pub attitude: Quaternion,
    /// Standard deviation of each component of the position, m.
    pub position_deviation: f32,
    /// Standard deviation of each component of the velocity, m/s.
    pub velocity_deviation: f32,
    /// Standard deviation about each axis, rad.
    pub attitude_deviation: f32,
}

/// Variances of the three parts.
#[derive(Clone, Copy)]
struct Noise {
    position: f32,
    velocity: f32,
    attitude: f32,
}

/// The rotation vector in the world, rad, from one attitude to the other; for small ones.
fn turn_between(from: Quaternion, to: Quaternion) -> [f32; 3] {
    let d = (to * from.conjugate()).shortest();
    [2.0 * d.x, 2.0 * d.y, 2.0 * d.z]
}

impl Filter {
    /// Takes it in.
    pub fn fuse_pose(&mut self, measured: &ExternalPose) -> Result<Report<9>, Refusal> {
        let past = self.pose_border(measured);
        let past = self.counted(Sensor::Pose, past)?;
        let noise = Noise {
            position: measured.position_deviation * measured.position_deviation,
            velocity: measured.velocity_deviation * measured.velocity_deviation,
            attitude: measured.attitude_deviation * measured.attitude_deviation,
        };
        let at = Reference::Position { lag: past.lag };
        let p = measured.position - past.position(&self.state);
        let v = measured.velocity - past.velocity(&self.state);
        let a = turn_between(past.attitude(&self.state), measured.attitude);
        let tests = [
            self.test_direct(at, Axis::X, p.x, noise.position),
            self.test_direct(at, Axis::Y, p.y, noise.position),
            self.test_direct(at, Axis::Z, p.z, noise.position),
            self.test_direct(Reference::Velocity, Axis::X, v.x, noise.velocity),
            self.test_direct(Reference::Velocity, Axis::Y, v.y, noise.velocity),
            self.test_direct(Reference::Velocity, Axis::Z, v.z, noise.velocity),
            self.test_direct(Reference::Attitude, Axis::X, a[0], noise.attitude),
            self.test_direct(Reference::Attitude, Axis::Y, a[1], noise.attitude),
            self.test_direct(Reference::Attitude, Axis::Z, a[2], noise.attitude),
        ];
        Ok(self.decide(
            Sensor::Pose,
            tests,
            |filter| filter.take_in_pose(measured, &past, noise),
            |filter| filter.adopt_pose(measured, &past, noise),
        ))
    }

    fn pose_border(&self, measured: &ExternalPose) -> Result<Past, Refusal> {
        vector(measured.position, LARGEST_POSITION)?;
        vector(measured.velocity, LARGEST_VELOCITY)?;
        rotation(measured.attitude)?;
        deviation(measured.position_deviation)?;
        deviation(measured.velocity_deviation)?;
        deviation(measured.attitude_deviation)?;
        self.past(measured.time)
    }

    fn take_in_pose(&mut self, measured: &ExternalPose, past: &Past, noise: Noise) {
        let at = Reference::Position { lag: past.lag };
        let wrong = |filter: &Self| measured.position - past.position(&filter.state);
        let w = wrong(self);
        self.fuse_direct(at, Axis::X, w.x, noise.position);
        let w = wrong(self);
        self.fuse_direct(at, Axis::Y, w.y, noise.position);
        let w = wrong(self);
        self.fuse_direct(at, Axis::Z, w.z, noise.position);
        self.fuse_velocity(measured.velocity, past, noise.velocity);
        let wrong = |filter: &Self| turn_between(past.attitude(&filter.state), measured.attitude);
        let w = wrong(self);
        self.fuse_direct(Reference::Attitude, Axis::X, w[0], noise.attitude);
        let w = wrong(self);
        self.fuse_direct(Reference::Attitude, Axis::Y, w[1], noise.attitude);
        let w = wrong(self);
        self.fuse_direct(Reference::Attitude, Axis::Z, w[2], noise.attitude);
    }

    /// Sets all nine states to the pose.
    fn adopt_pose(&mut self, measured: &ExternalPose, past: &Past, noise: Noise) {
        let turn = (measured.attitude * past.attitude(&self.state).conjugate()).normalized();
        self.state.attitude = (turn * self.state.attitude).normalized();
        let wrong = measured.velocity - past.velocity(&self.state);
        self.state.velocity += wrong;
        let wrong = measured.position - past.position(&self.state);
        self.state.position += wrong;
        self.shift_datum(wrong.z);
        for axis in Axis::ALL {
            self.covariance.decouple(Group::Velocity, axis, noise.velocity);
            self.forget_position(axis, noise.position, past.lag);
            self.covariance.decouple(Group::Attitude, axis, noise.attitude);
        }
    }
}
