//! What the outer step takes from its queues: each kind a topic, each item a record, bit for bit.
//!
//! A kind is declared once, below. Items carry the tick of the boundary at which they were frozen.

use windhover_autopilot::{
    BarometerSample, Command, CompassSample, ExternalEstimate, GnssSample, MissionCommit, OuterInputs,
    ParameterWrite, Queues, Urgent,
};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::geodesy::GlobalPosition;
use windhover_math::{Quaternion, Vector3};

use crate::record;
use crate::record::{Description, Field, Record, Topic};
use crate::wire::{Decoder, Encoder};

/// Declares the kinds: queue, variant, type, number and name of the topic, and the type's fields
/// where they are not declared elsewhere.
macro_rules! inputs {
    ($($queue:ident: $Kind:ident($Item:ty) = $id:literal, $name:literal $({ $($fields:tt)* })?;)*) => {
        $($(record!($Item { $($fields)* });)?)*

        $(impl Topic for $Item {
            const TOPIC: Description = Description {
                id: $id,
                name: $name,
                ticked: true,
                fields: <$Item as Record>::FIELDS,
            };
        })*

        /// All kinds.
        pub const TOPICS: &[Description] = &[$(<$Item as Topic>::TOPIC,)*];

        /// One item of one kind.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Input {
            $(
                #[doc = concat!("Topic `", $name, "`.")]
                $Kind($Item),
            )*
        }

        impl Input {
            /// Reads the fields of the topic with that number; `None` when they are not such.
            pub fn get(id: u16, from: &mut Decoder<'_>) -> Option<Self> {
                match id {
                    $($id => Record::get(from).map(Self::$Kind),)*
                    _ => None,
                }
            }

            /// Writes the fields; the topic's number.
            pub fn put(&self, out: &mut Encoder<'_>) -> u16 {
                match self {
                    $(Self::$Kind(item) => {
                        item.put(out);
                        <$Item as Topic>::TOPIC.id
                    })*
                }
            }

            /// Puts it into its queue.
            pub fn queue(self, queues: &mut Queues) {
                match self {
                    $(Self::$Kind(item) => queues.$queue.push(item),)*
                }
            }

            /// Puts it where the outer step finds it; `false` when there are too many.
            pub fn put_into(self, inputs: &mut OuterInputs) -> bool {
                match self {
                    $(Self::$Kind(item) => inputs.$queue.push(item).is_ok(),)*
                }
            }
        }

        /// Hands every item to a sink.
        pub trait Sink {
            /// One item.
            fn take<T: Topic>(&mut self, item: &T);

            /// All of them, in the order of the queues and of arrival.
            #[inline]
            fn take_all(&mut self, inputs: &OuterInputs) {
                $(for item in &inputs.$queue {
                    self.take(item);
                })*
            }
        }
    };
}

inputs! {
    external: External(ExternalEstimate) = 8, "input_external" { position: Vector3, velocity: Vector3, attitude: Quaternion };
    command: Command(Command) = 9, "input_command";
    parameter: Parameter(ParameterWrite) = 10, "input_parameter" { index: u16, value: f32 };
    setpoint: Setpoint(TrajectorySetpoint) = 11, "input_setpoint" { position: Vector3, velocity: Vector3, acceleration: Vector3, jerk: Vector3, heading: f32, heading_rate: f32 };
    barometer: Barometer(BarometerSample) = 13, "input_barometer" { time: u64, pressure: f32 };
    compass: Compass(CompassSample) = 14, "input_compass" { time: u64, counts: [i16; 3] };
    gnss: Gnss(GnssSample) = 15, "input_gnss" { time: u64, position: GlobalPosition, velocity: [i32; 3], horizontal_accuracy: u32, vertical_accuracy: u32, speed_accuracy: u32, fix: u8, satellites: u8 };
    attitude: Attitude(AttitudeSetpoint) = 12, "input_attitude" { attitude: Quaternion, rate: Vector3, thrust: f32 };
}

/// A command as its record has it; the last three are 0 for all but a commit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FlatCommand {
    /// 0 arm, 1 disarm, 2 start mission, 3 start offboard, 4 commit mission,
    /// 5 start attitude.
    pub command: u8,
    pub slot: u8,
    pub count: u16,
    pub crc: u32,
}

record!(FlatCommand {
    command: u8,
    slot: u8,
    count: u16,
    crc: u32
});

impl From<Command> for FlatCommand {
    fn from(command: Command) -> Self {
        let plain = |command| Self {
            command,
            ..Self::default()
        };
        match command {
            Command::Arm => plain(0),
            Command::Disarm => plain(1),
            Command::StartMission => plain(2),
            Command::StartOffboard => plain(3),
            Command::StartAttitude => plain(5),
            Command::CommitMission(MissionCommit { slot, count, crc }) => Self {
                command: 4,
                slot,
                count,
                crc,
            },
        }
    }
}

impl Record for Command {
    const FIELDS: &'static [Field] = FlatCommand::FIELDS;

    fn put(&self, out: &mut Encoder<'_>) {
        FlatCommand::from(*self).put(out);
    }

    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        let flat = FlatCommand::get(from)?;
        match flat.command {
            0 => Some(Self::Arm),
            1 => Some(Self::Disarm),
            2 => Some(Self::StartMission),
            3 => Some(Self::StartOffboard),
            4 => Some(Self::CommitMission(MissionCommit {
                slot: flat.slot,
                count: flat.count,
                crc: flat.crc,
            })),
            5 => Some(Self::StartAttitude),
            _ => None,
        }
    }
}

/// 1 kill, 2 disarm.
pub(crate) const fn urgent_code(urgent: Urgent) -> u8 {
    match urgent {
        Urgent::Kill => 1,
        Urgent::Disarm => 2,
    }
}

/// An urgent command, in the tick in which it acted.
impl Record for Urgent {
    const FIELDS: &'static [Field] = &[Field::of::<u8>("urgent")];

    fn put(&self, out: &mut Encoder<'_>) {
        out.bytes([urgent_code(*self)]);
    }

    fn get(from: &mut Decoder<'_>) -> Option<Self> {
        match from.bytes()? {
            [1] => Some(Self::Kill),
            [2] => Some(Self::Disarm),
            _ => None,
        }
    }
}

impl Topic for Urgent {
    const TOPIC: Description = Description {
        id: 7,
        name: "input_urgent",
        ticked: true,
        fields: Self::FIELDS,
    };
}
