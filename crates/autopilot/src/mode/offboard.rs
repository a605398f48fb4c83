//! Offboard: follows setpoints from outside, for as long as they keep coming.

use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{Vector3, max, min, scalar, wrap_pi};

use super::{Around, Demand, Motion, Step};
use crate::queue::OuterInputs;
use crate::trajectory::{Glide, GlideLimits, HeadingSlew};

/// A place, a velocity or both to follow, axis by axis: what a ground station or a companion
/// computer sends. The vehicle goes there within its own limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guidance {
    /// Which of the quantities count: a sum of the constants.
    pub uses: u8,
    /// NED, m from the origin.
    pub position: Vector3,
    /// NED, m/s.
    pub velocity: Vector3,
    /// rad.
    pub heading: f32,
    /// rad/s.
    pub heading_rate: f32,
}

impl Guidance {
    /// North and east of the position count.
    pub const PLACE: u8 = 1;
    /// Down of the position counts.
    pub const HEIGHT: u8 = 2;
    /// North and east of the velocity count.
    pub const VELOCITY: u8 = 4;
    /// Down of the velocity counts.
    pub const CLIMB: u8 = 8;
    /// The heading counts.
    pub const HEADING: u8 = 16;
    /// Its rate counts.
    pub const HEADING_RATE: u8 = 32;

    /// Whether a quantity counts.
    pub const fn has(&self, quantity: u8) -> bool {
        self.uses & quantity != 0
    }

    /// Whether it may come in: all that counts is finite, and something counts.
    pub fn is_valid(&self) -> bool {
        let flat = |v: Vector3| Vector3::new(v.x, v.y, 0.0);
        let upright = |v: Vector3| Vector3::new(0.0, 0.0, v.z);
        let good = |uses: u8, v: Vector3| !self.has(uses) || scalar::is_finite(v);
        self.uses != 0
            && good(Self::PLACE, flat(self.position))
            && good(Self::HEIGHT, upright(self.position))
            && good(Self::VELOCITY, flat(self.velocity))
            && good(Self::CLIMB, upright(self.velocity))
            && (!self.has(Self::HEADING) || self.heading.is_finite())
            && (!self.has(Self::HEADING_RATE) || self.heading_rate.is_finite())
    }
}

/// What somebody outside wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outside {
    /// This point of a trajectory, exactly.
    Trajectory(TrajectorySetpoint),
    /// To go there, or so fast.
    Guidance(Guidance),
    /// This attitude and thrust; no position is needed.
    Attitude(AttitudeSetpoint),
}

/// The newest setpoint from outside, and how old it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Setpoints {
    newest: Option<Outside>,
    /// µs.
    age: u32,
}

impl Setpoints {
    /// Takes in what has come; what is no setpoint stays outside. Of several kinds at once the first
    /// in the order of [`Outside`] counts.
    pub fn take(&mut self, inputs: &OuterInputs, dt: u32) {
        self.age = self.age.saturating_add(dt);
        if inputs.attitude.is_empty() && inputs.guidance.is_empty() && inputs.setpoint.is_empty() {
            return;
        }
        let attitude = inputs.attitude.iter().rev().find(|setpoint| setpoint.is_valid());
        let guidance = inputs.guidance.iter().rev().find(|setpoint| setpoint.is_valid());
        let point = inputs.setpoint.iter().rev().find(|setpoint| setpoint.is_finite());
        let attitude = attitude.map(|setpoint| Outside::Attitude(*setpoint));
        let guidance = guidance.map(|setpoint| Outside::Guidance(*setpoint));
        let point = point.map(|setpoint| Outside::Trajectory(*setpoint));
        if let Some(newest) = point.or(guidance).or(attitude) {
            self.newest = Some(newest);
            self.age = 0;
        }
    }

    /// The newest, however old.
    pub fn newest(&self) -> Option<&Outside> {
        self.newest.as_ref()
    }

    /// The newest, if it is not older than `most` seconds.
    pub fn fresh(&self, most: f32) -> Option<&Outside> {
        self.newest.as_ref().filter(|_| self.age as f32 * 1e-6 <= most)
    }
}

/// The mode's memory.
#[derive(Clone, Debug)]
pub struct Offboard {
    glide: Glide,
    heading: HeadingSlew,
}

impl Offboard {
    /// From the present motion on.
    pub fn enter(motion: &Motion) -> Self {
        Self {
            glide: motion.glide,
            heading: motion.heading,
        }
    }

    /// One step. What has just become too old is followed until the supervisor has had its say.
    pub fn step<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        match around.setpoints.newest {
            Some(Outside::Trajectory(point)) => {
                self.glide = Glide {
                    position: point.position,
                    velocity: point.velocity,
                    acceleration: point.acceleration,
                };
                self.heading = HeadingSlew {
                    heading: point.heading,
                    rate: point.heading_rate,
                };
                Step::of(Demand::Follow(point))
            }
            Some(Outside::Attitude(setpoint)) => Step::of(Demand::Attitude(setpoint)),
            Some(Outside::Guidance(guidance)) => self.guide(&guidance, around),
            None => Step::of(Demand::Rest),
        }
    }

    fn guide<S: ?Sized>(&mut self, guidance: &Guidance, around: &Around<'_, S>) -> Step {
        let p = &around.parameters.manual;
        let limits = GlideLimits::of(p);
        let towards = self
            .glide
            .towards(guidance.position, &limits, p.velocity, p.climb, p.descend);
        let own = |uses: u8, value: f32| if guidance.has(uses) { value } else { 0.0 };
        let (to_place, to_height) = (Guidance::PLACE, Guidance::HEIGHT);
        let wanted = Vector3::new(
            own(to_place, towards.x) + own(Guidance::VELOCITY, guidance.velocity.x),
            own(to_place, towards.y) + own(Guidance::VELOCITY, guidance.velocity.y),
            own(to_height, towards.z) + own(Guidance::CLIMB, guidance.velocity.z),
        );
        let flat = scalar::limit_norm(Vector3::new(wanted.x, wanted.y, 0.0), p.velocity);
        let wanted = Vector3::new(flat.x, flat.y, max(-p.climb, min(wanted.z, p.descend)));
        if around.landed && wanted.z >= 0.0 {
            *self = Self::enter(&around.at_rest());
            return Step::of(Demand::Rest);
        }
        let rate = around.rate(self.glide.position);
        let jerk = self.glide.step(wanted, &limits, rate, around.seconds);
        self.turn(guidance, around);
        let heading = (self.heading.heading, self.heading.rate);
        Step::of(Demand::Follow(self.glide.setpoint(jerk, rate, heading)))
    }

    fn turn<S: ?Sized>(&mut self, guidance: &Guidance, around: &Around<'_, S>) {
        let p = &around.parameters.mission;
        let target = if guidance.has(Guidance::HEADING) {
            wrap_pi(guidance.heading)
        } else if guidance.has(Guidance::HEADING_RATE) {
            let rate = scalar::saturate(guidance.heading_rate, p.yaw_rate);
            // Half a second ahead: that is where the slew turns at this rate.
            wrap_pi(self.heading.heading + rate * 0.5)
        } else {
            self.heading.heading
        };
        self.heading
            .step(target, p.yaw_rate, p.yaw_acceleration, around.seconds);
    }
}
