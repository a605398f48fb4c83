//! Modes of flight, one file each: from what is believed and wanted to what control is to follow.
//!
//! A mode is entered with the motion that is commanded at that moment ([`Motion`]) and goes on from
//! it, so that no change of mode makes a jump. Each step gives a [`Demand`], and tells when the mode
//! is done and which one follows. Whether a mode may fly is asked of [`available`] before; who
//! decides is the [supervisor](crate::supervisor).

mod altitude;
mod course;
pub mod descend;
mod hold;
mod land;
mod lift;
mod mission;
mod needs;
mod offboard;
pub mod parameters;
mod position;
mod return_home;
mod stabilize;
mod takeoff;
mod tilt;

use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::geodesy::LocalFrame;
use windhover_math::{Quaternion, Vector3, scalar, wrap_pi};

use crate::estimation::Estimate;
use crate::estimation::handover::Handover;
use crate::fence::Rally;
use crate::mission::action::{Altitude, over_ground};
use crate::mission::route::Stored;
use crate::mission::{MissionEvents, MissionExecutor, MissionSource};
use crate::parameters::Parameters;
use crate::rc::Sticks;
use crate::trajectory::{Glide, GlideLimits, HeadingSlew};

pub use needs::{ModeSet, Need, Needs, available};
pub use offboard::{Guidance, Outside, Setpoints};
pub use parameters::ManualParameters;

/// A mode of flight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// Sticks to tilt, yaw rate and thrust.
    Stabilize,
    /// Sticks to tilt, yaw rate and climb; hands off, it stays level at its height and heading.
    Altitude,
    /// Sticks to velocity; hands off, it stays where it is.
    Position,
    /// Straight up to a height.
    Takeoff,
    /// Stays where it is, or goes where it is sent and stays there.
    #[default]
    Hold,
    /// Flies the stored mission.
    Mission,
    /// Back to the nearest rally point, or home, and lands there.
    Return,
    /// Straight down to the ground.
    Land,
    /// Follows setpoints from outside.
    Offboard,
    /// Level and down, with no need to know where it is: what is left when little is known.
    Descend,
}

impl Mode {
    /// All of them, in their order.
    pub const ALL: [Self; 10] = [
        Self::Stabilize,
        Self::Altitude,
        Self::Position,
        Self::Takeoff,
        Self::Hold,
        Self::Mission,
        Self::Return,
        Self::Land,
        Self::Offboard,
        Self::Descend,
    ];

    /// Whether sticks fly it.
    pub const fn is_manual(self) -> bool {
        matches!(self, Self::Stabilize | Self::Altitude | Self::Position)
    }

    /// Its name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stabilize => "stabilize",
            Self::Altitude => "altitude",
            Self::Position => "position",
            Self::Takeoff => "takeoff",
            Self::Hold => "hold",
            Self::Mission => "mission",
            Self::Return => "return",
            Self::Land => "land",
            Self::Offboard => "offboard",
            Self::Descend => "descend",
        }
    }
}

/// What modes see.
pub struct Around<'a, S: ?Sized> {
    /// The parameter table.
    pub parameters: &'a Parameters,
    /// What is believed of the vehicle.
    pub estimate: &'a Estimate,
    /// How far control leads the vehicle from the setpoint meanwhile: not at all, but after a step of
    /// the estimate.
    pub handover: &'a Handover,
    /// Acceleration that the rotors give over what the parameters say.
    pub thrust_scale: f32,
    /// The local frame, once there is one.
    pub frame: Option<&'a LocalFrame>,
    /// Home, NED, m from the origin.
    pub home: Vector3,
    /// Rally points.
    pub rally: &'a Rally,
    /// The stored plans.
    pub source: &'a S,
    /// The valid mission.
    pub stored: Option<Stored>,
    /// Whether the vehicle is on the ground.
    pub landed: bool,
    /// Size of the specific force, in the mean of a tenth of a second, m/s².
    pub force: f32,
    /// The accelerometer shows nothing: forces are reckoned from the thrust.
    pub blind: bool,
    /// A pilot's sticks, while they are heard.
    pub sticks: Option<Sticks>,
    /// Setpoints from outside.
    pub setpoints: &'a Setpoints,
    /// Time since the last step, µs.
    pub dt: u32,
    /// The same in s.
    pub seconds: f32,
}

impl<S: ?Sized> Around<'_, S> {
    /// The motion of a vehicle that stands where it is believed to stand.
    pub fn at_rest(&self) -> Motion {
        Motion::at_rest(self.estimate, self.handover)
    }

    /// How far down an altitude is, m from the origin.
    pub fn down(&self, altitude: Altitude) -> f32 {
        match (altitude, self.frame) {
            (_, Some(frame)) => altitude.down(frame, self.home),
            (Altitude::Home(height), None) => self.home.z - height,
            // Nobody knows how high the sea is: stay.
            (Altitude::SeaLevel(_), None) => self.estimate.position.z,
        }
    }

    /// Where a place on the ground is, NED, m; its height is none.
    fn ground(&self, latitude: i32, longitude: i32) -> Option<Vector3> {
        self.frame.map(|frame| over_ground(latitude, longitude, frame))
    }

    /// How fast the path may run on from `setpoint`, m from the origin: slower while the vehicle is
    /// behind it.
    fn rate(&self, setpoint: Vector3) -> f32 {
        let behind = scalar::norm(setpoint + self.handover.position - self.estimate.position);
        self.parameters.mission.rate(behind)
    }
}

impl GlideLimits {
    /// Those of sticks and braking.
    pub fn of(parameters: &ManualParameters) -> Self {
        Self {
            acceleration: parameters.acceleration,
            vertical_acceleration: parameters.vertical_acceleration,
            jerk: parameters.jerk,
        }
    }
}

/// The motion that is commanded: what the next mode begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Position and its derivatives.
    pub glide: Glide,
    /// Heading.
    pub heading: HeadingSlew,
    /// Attitude, body to world.
    pub attitude: Quaternion,
}

impl Motion {
    /// Standing at the estimate, upright: where control would lead it from there is taken off.
    pub fn at_rest(estimate: &Estimate, handover: &Handover) -> Self {
        let heading = wrap_pi(estimate.attitude.heading() - handover.heading);
        Self {
            glide: Glide::at(estimate.position - handover.position),
            heading: HeadingSlew { heading, rate: 0.0 },
            attitude: Quaternion::from_heading(heading),
        }
    }

    /// Moving as the estimate does, and as control sees that.
    pub fn of(estimate: &Estimate, handover: &Handover) -> Self {
        let rest = Self::at_rest(estimate, handover);
        Self {
            glide: Glide {
                velocity: estimate.velocity - handover.velocity,
                ..rest.glide
            },
            attitude: estimate.attitude,
            ..rest
        }
    }
}

/// What control is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Stay on the ground with idling motors.
    Rest,
    /// Follow this point.
    Follow(TrajectorySetpoint),
    /// Keep this attitude, and follow the height of this point.
    Tilt {
        /// Body to world.
        attitude: Quaternion,
        /// Rate of the heading, rad/s.
        heading_rate: f32,
        /// Its down counts, and nothing else.
        point: TrajectorySetpoint,
    },
    /// This attitude and thrust.
    Attitude(AttitudeSetpoint),
}

/// What a step of a mode gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// What control is to do.
    pub demand: Demand,
    /// The mode is done, and this one follows.
    pub next: Option<Mode>,
    /// The ground holds a vehicle that comes down.
    pub contact: bool,
    /// Where the leg that is being flown leads, NED, m.
    pub leg_end: Option<Vector3>,
    /// Share of the thrust that control finds that is given, 0 to 1.
    pub thrust_share: f32,
}

impl Default for Step {
    fn default() -> Self {
        Self::rest()
    }
}

impl Step {
    /// Of a vehicle that stands.
    pub fn rest() -> Self {
        Self::of(Demand::Rest)
    }

    fn of(demand: Demand) -> Self {
        Self {
            demand,
            next: None,
            contact: false,
            leg_end: None,
            thrust_share: 1.0,
        }
    }
}

/// Where hold is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Target {
    /// Latitude and longitude in 1e-7 degree; `None` is where the vehicle is.
    pub ground: Option<(i32, i32)>,
    /// `None` is the present one.
    pub altitude: Option<Altitude>,
    /// rad; `None` keeps it.
    pub heading: Option<f32>,
    /// Ground speed, m/s; `None` leaves it to a parameter.
    pub speed: Option<f32>,
}

/// The memory of the mode that flies.
#[derive(Clone, Debug)]
enum Active {
    Stabilize(stabilize::Stabilize),
    Altitude(altitude::AltitudeHold),
    Position(position::PositionHold),
    Takeoff(takeoff::Takeoff),
    Hold(hold::Hold),
    Mission(mission::Mission),
    Return(return_home::Return),
    Land(land::Land),
    Offboard(offboard::Offboard),
    Descend(descend::Descend),
}

/// The modes with their memory.
#[derive(Clone, Debug, Default)]
pub struct Modes {
    active: Option<(Mode, Active)>,
    /// What the last step gave.
    step: Step,
    /// The attitude at that step.
    attitude: Quaternion,
    /// What was commanded last, where that does not follow from the step.
    motion: Option<Motion>,
    /// The mission as far as it has come, also while another mode flies.
    mission: Option<MissionExecutor>,
    /// Where hold is sent when it is entered.
    pub target: Option<Target>,
    /// Ground speed to where hold is sent, m/s, until the flight is over; `None` leaves it to a parameter.
    pub speed: Option<f32>,
    /// What hold looks at, NED, m, until the flight is over; a mission looks for itself.
    pub look_at: Option<Vector3>,
    /// Where takeoff leads; `None` leaves it to a parameter.
    pub takeoff: (Option<Altitude>, Option<f32>),
    /// The item that a mission starts with.
    pub first_item: u16,
}

impl Modes {
    /// How far the mission has come, where one has been started and is not over.
    pub fn mission(&self) -> Option<&MissionExecutor> {
        self.mission.as_ref()
    }

    /// The same, to be changed.
    pub fn mission_mut(&mut self) -> Option<&mut MissionExecutor> {
        self.mission.as_mut()
    }

    /// The next start of a mission is one from its beginning, or from `first_item`.
    pub fn forget_mission(&mut self) {
        self.mission = None;
    }

    /// The mode is entered anew at the next step, from the motion there is.
    pub fn reenter(&mut self) {
        self.active = None;
    }

    /// Nothing flies.
    pub fn rest(&mut self) {
        *self = Self::default();
    }

    /// What the last step gave.
    pub fn last(&self) -> &Step {
        &self.step
    }

    /// The vehicle stands meanwhile; the next step goes on from the motion there was.
    pub fn pause(&mut self) {
        self.motion = self.commanded();
        self.step = Step::rest();
    }

    /// One step of `mode`, which is entered if it was another one so far; [`Self::last`] has what it
    /// gives.
    pub fn step<S: MissionSource + ?Sized>(
        &mut self,
        mode: Mode,
        around: &Around<'_, S>,
        events: &mut MissionEvents,
    ) {
        if self.active.as_ref().is_none_or(|(active, _)| *active != mode) {
            self.active = Some((mode, self.enter(mode, around)));
        }
        let Some((_, active)) = &mut self.active else {
            return;
        };
        let (step, mission) = (&mut self.step, &mut self.mission);
        match active {
            Active::Stabilize(mode) => *step = mode.step(around),
            Active::Altitude(mode) => *step = mode.step(around),
            Active::Position(mode) => *step = mode.step(around),
            Active::Takeoff(mode) => *step = mode.step(around),
            Active::Hold(mode) => *step = mode.step(around, self.look_at),
            Active::Mission(mode) => mode.step(around, mission, self.first_item, events, step),
            Active::Return(mode) => *step = mode.step(around),
            Active::Land(mode) => *step = mode.step(around),
            Active::Offboard(mode) => *step = mode.step(around),
            Active::Descend(mode) => *step = mode.step(around),
        }
        if mode == Mode::Mission && self.step.next.is_some() {
            (self.mission, self.first_item) = (None, 0);
        }
        self.remember(around.estimate, around.handover);
    }

    /// What was commanded last.
    fn commanded(&self) -> Option<Motion> {
        match &self.step.demand {
            Demand::Follow(point) => Some(Motion {
                glide: Glide {
                    position: point.position,
                    velocity: point.velocity,
                    acceleration: point.acceleration,
                },
                heading: HeadingSlew {
                    heading: point.heading,
                    rate: point.heading_rate,
                },
                attitude: self.attitude,
            }),
            _ => self.motion,
        }
    }

    /// Keeps for the next mode what the step itself does not say.
    fn remember(&mut self, estimate: &Estimate, handover: &Handover) {
        self.attitude = estimate.attitude;
        self.motion = match &self.step.demand {
            Demand::Rest | Demand::Follow(_) => None,
            Demand::Tilt {
                attitude,
                heading_rate,
                point,
            } => {
                let mut motion = Motion::of(estimate, handover);
                motion.glide.position.z = point.position.z;
                motion.glide.velocity.z = point.velocity.z;
                motion.glide.acceleration.z = point.acceleration.z;
                motion.attitude = *attitude;
                motion.heading = HeadingSlew {
                    heading: attitude.heading(),
                    rate: *heading_rate,
                };
                Some(motion)
            }
            Demand::Attitude(setpoint) => Some(Motion {
                attitude: setpoint.attitude,
                ..Motion::of(estimate, handover)
            }),
        };
    }

    fn enter<S: MissionSource + ?Sized>(&mut self, mode: Mode, around: &Around<'_, S>) -> Active {
        let motion = self.commanded().unwrap_or_else(|| around.at_rest());
        // For this mode, or for none: no later hold goes there.
        let target = self.target.take();
        match mode {
            Mode::Stabilize => Active::Stabilize(stabilize::Stabilize::enter(&motion)),
            Mode::Altitude => Active::Altitude(altitude::AltitudeHold::enter(&motion)),
            Mode::Position => Active::Position(position::PositionHold::enter(&motion)),
            Mode::Takeoff => {
                let (altitude, heading) = core::mem::take(&mut self.takeoff);
                Active::Takeoff(takeoff::Takeoff::enter(&motion, around, altitude, heading))
            }
            Mode::Hold => Active::Hold(hold::Hold::enter(&motion, around, target.as_ref())),
            Mode::Mission => Active::Mission(mission::Mission::enter(&motion, around, self.mission.as_ref())),
            Mode::Return => Active::Return(return_home::Return::enter(&motion, around)),
            Mode::Land => Active::Land(land::Land::enter(&motion)),
            Mode::Offboard => Active::Offboard(offboard::Offboard::enter(&motion)),
            Mode::Descend => Active::Descend(descend::Descend::enter(&motion)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this failed, a mode that is entered from level flight would begin with a leap, as far as the
    /// estimate has stepped.
    #[test]
    fn a_motion_begins_where_control_leads_the_vehicle() {
        let estimate = Estimate {
            position: Vector3::new(10.0, -20.0, -30.0),
            velocity: Vector3::new(1.0, 2.0, -0.5),
            attitude: Quaternion::from_heading(3.0),
            ..Estimate::default()
        };
        let handover = Handover {
            position: Vector3::new(8.0, 1.0, -2.0),
            velocity: Vector3::new(0.3, 0.0, 0.0),
            heading: -0.4,
        };
        for motion in [
            Motion::of(&estimate, &handover),
            Motion::at_rest(&estimate, &handover),
        ] {
            let heading = (motion.heading.heading, 0.0);
            let led = handover.shifted(&motion.glide.setpoint(Vector3::zeros(), 1.0, heading));
            assert!((led.position - estimate.position).amax() < 1e-5);
            assert!(wrap_pi(led.heading - 3.0).abs() < 1e-5);
        }
        let motion = Motion::of(&estimate, &handover);
        assert_eq!(motion.glide.velocity, Vector3::new(0.7, 2.0, -0.5));
    }
}
