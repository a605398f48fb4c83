//! Input queues of the outer step: bounded, in order of arrival, full means counted.
//!
//! Tasks of any priority put items in; at a boundary of the schedule the items of each queue up to
//! its bound are frozen into the snapshot, and the outer step sees nothing else. A new kind of
//! input is one line in `outer_inputs!`'s use below.

use heapless::{Deque, Vec};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{Quaternion, Vector3, scalar};

use crate::aiding::{BarometerSample, CompassSample, GnssSample};
use crate::battery::BatterySample;
use crate::mission::PlanKind;
use crate::mission::action::{Altitude, Place};
use crate::mode::{Guidance, Mode, Target};
use crate::rc::{RcFrame, Sticks};

/// A bounded queue that counts what it could not take.
#[derive(Clone, Debug)]
pub struct Queue<T, const CAPACITY: usize> {
    items: Deque<T, CAPACITY>,
    dropped: u32,
}

impl<T, const CAPACITY: usize> Default for Queue<T, CAPACITY> {
    fn default() -> Self {
        Self {
            items: Deque::new(),
            dropped: 0,
        }
    }
}

impl<T, const CAPACITY: usize> Queue<T, CAPACITY> {
    /// Puts an item at the end. A full queue does not take it, and counts it.
    pub fn push(&mut self, item: T) {
        if self.items.push_back(item).is_err() {
            self.dropped = self.dropped.wrapping_add(1);
        }
    }

    /// How many items were dropped since start.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// How many items wait.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether nothing waits.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Takes the oldest items, as many as fit.
    fn freeze<const BOUND: usize>(&mut self) -> Vec<T, BOUND> {
        let mut frozen = Vec::new();
        while !frozen.is_full() {
            match self.items.pop_front() {
                Some(item) => {
                    // Not full: there is room.
                    let _ = frozen.push(item);
                }
                None => break,
            }
        }
        frozen
    }
}

/// Declares the kinds of input: name, type, capacity of the queue, bound of one snapshot.
macro_rules! outer_inputs {
    ($($(#[$meta:meta])* $name:ident: $Item:ty, $capacity:literal, $bound:literal;)*) => {
        /// The queues that feed the outer step.
        #[derive(Clone, Debug, Default)]
        pub struct Queues {
            $($(#[$meta])* pub $name: Queue<$Item, $capacity>,)*
        }

        /// What one outer step consumes from the queues, each kind in order of arrival.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct OuterInputs {
            $($(#[$meta])* pub $name: Vec<$Item, $bound>,)*
        }

        impl Queues {
            /// Freezes what has arrived, up to the bounds; the rest stays.
            pub fn freeze(&mut self) -> OuterInputs {
                OuterInputs { $($name: self.$name.freeze(),)* }
            }

            /// Puts recorded inputs back, for replay.
            pub fn refill(&mut self, inputs: &OuterInputs) {
                $(for item in &inputs.$name { self.$name.push(*item); })*
            }

            /// How many items were dropped since start, over all queues.
            pub fn dropped(&self) -> u32 {
                0u32$(.wrapping_add(self.$name.dropped()))*
            }
        }
    };
}

outer_inputs! {
    /// Estimates from outside: the truth of a model, or motion capture.
    external: ExternalEstimate, 4, 4;
    /// What the operator wants.
    command: Command, 8, 4;
    /// Writes to the parameter table.
    parameter: ParameterWrite, 8, 4;
    /// Trajectory setpoints from outside.
    setpoint: TrajectorySetpoint, 2, 2;
    /// Attitude and thrust from outside.
    attitude: AttitudeSetpoint, 2, 2;
    /// The barometer.
    barometer: BarometerSample, 4, 2;
    /// The compass.
    compass: CompassSample, 4, 2;
    /// The satellite receiver.
    gnss: GnssSample, 2, 1;
    /// Places and velocities from outside.
    guidance: Guidance, 2, 2;
    /// The remote control's receiver.
    rc: RcFrame, 2, 2;
    /// Sticks that come by a ground station.
    sticks: Sticks, 2, 2;
    /// The battery's sensors.
    battery: BatterySample, 2, 1;
    /// Ground stations that are heard.
    station: Station, 4, 2;
}

/// Position, velocity and attitude as somebody outside knows them, at the time of the snapshot.
///
/// For the models of equations (1) and (8), whose state holds rates of Euler angles, the body
/// rate W(φ, θ)·(φ̇, θ̇, ψ̇) reaches the core through the gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExternalEstimate {
    /// Position, NED, m from home.
    pub position: Vector3,
    /// Velocity, NED, m/s.
    pub velocity: Vector3,
    /// Attitude, body to world, norm 1.
    pub attitude: Quaternion,
}

impl ExternalEstimate {
    /// Whether it may come in: all finite, and the quaternion a rotation.
    pub fn is_valid(&self) -> bool {
        let norm = self.attitude.dot(self.attitude);
        scalar::is_finite(self.position) && scalar::is_finite(self.velocity) && norm > 0.98 && norm < 1.02
    }
}

/// What the operator wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Let the motors turn, if nothing speaks against it.
    Arm,
    /// Let the motors turn, whatever speaks against it.
    ForceArm,
    /// Stop the motors of a vehicle on the ground.
    Disarm,
    /// Fly in this mode: at once, or as soon as the vehicle is armed.
    Fly(Mode),
    /// Take off to an altitude (`None` leaves it to a parameter) with a heading (rad, `None` keeps it).
    Takeoff(Option<Altitude>, Option<f32>),
    /// Go there and stay.
    GoTo(Target),
    /// Fly the stored mission, from the item with this index on.
    StartMission(u16),
    /// The mission goes on with the item with this index: now where it flies, else when it is started.
    SelectItem(u16),
    /// Ground speed of the mission from the next leg on, m/s; `None` goes back to the parameter's.
    SetSpeed(Option<f32>),
    /// Home is there; `None` is where the vehicle is.
    SetHome(Option<Place>),
    /// On hold and in the mission there is, the nose points at a place; `None` ahead again.
    LookAt(Option<Place>),
    /// Take a photo now.
    TakePhoto,
    /// A plan was committed to storage: from now on it is this one.
    Commit(PlanKind, MissionCommit),
    /// Turn one motor of a disarmed vehicle, for a short time.
    TestMotor(MotorTest),
}

/// One motor that is to be turned while the vehicle is disarmed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorTest {
    /// The rotor, in the core's order.
    pub rotor: u8,
    /// Share of the full command, 0 to 1; 0 ends a test.
    pub share: f32,
    /// For so long, s; at most [`MotorTest::LONGEST`].
    pub duration: f32,
}

impl MotorTest {
    /// The longest test, s.
    pub const LONGEST: f32 = 10.0;

    /// Whether there is such a rotor, share and time.
    pub fn is_valid(&self) -> bool {
        self.rotor < 4 && (0.0..=1.0).contains(&self.share) && (0.0..=Self::LONGEST).contains(&self.duration)
    }
}

/// Which stored plan is the valid one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MissionCommit {
    /// The storage slot that holds it.
    pub slot: u8,
    /// How many items it has; 0 clears it.
    pub count: u16,
    /// CRC-32 over its items, as the log names it.
    pub crc: u32,
}

/// A ground station's heartbeat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Station {
    /// Its system number.
    pub system: u8,
}

/// A write to the parameter table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterWrite {
    /// Index in the table.
    pub index: u16,
    /// The new value, in the table's unit.
    pub value: f32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_queue_keeps_the_oldest_and_counts_the_rest() {
        let mut queue = Queue::<u8, 3>::default();
        for item in 0..5 {
            queue.push(item);
        }
        assert_eq!(queue.dropped(), 2);
        assert_eq!(queue.freeze::<2>(), [0, 1]);
        assert_eq!(queue.freeze::<2>(), [2]);
        assert!(queue.is_empty());
    }

    #[test]
    fn refilled_queues_freeze_to_the_same_inputs() {
        let mut queues = Queues::default();
        for command in [Command::Arm, Command::StartMission(0), Command::Disarm] {
            queues.command.push(command);
        }
        queues.parameter.push(ParameterWrite { index: 3, value: 0.5 });
        let inputs = queues.freeze();
        let mut again = Queues::default();
        again.refill(&inputs);
        assert_eq!(again.freeze(), inputs);
    }

    #[test]
    fn an_estimate_that_is_no_number_stays_outside() {
        let good = ExternalEstimate {
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            attitude: Quaternion::IDENTITY,
        };
        assert!(good.is_valid());
        assert!(
            !ExternalEstimate {
                position: Vector3::new(f32::NAN, 0.0, 0.0),
                ..good
            }
            .is_valid()
        );
        assert!(
            !ExternalEstimate {
                velocity: Vector3::new(0.0, f32::INFINITY, 0.0),
                ..good
            }
            .is_valid()
        );
        assert!(
            !ExternalEstimate {
                attitude: Quaternion::new(0.0, 0.0, 0.0, 0.0),
                ..good
            }
            .is_valid()
        );
        assert!(
            !ExternalEstimate {
                attitude: Quaternion::new(f32::NAN, 0.0, 0.0, 0.0),
                ..good
            }
            .is_valid()
        );
    }
}
