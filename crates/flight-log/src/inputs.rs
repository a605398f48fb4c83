//! What the outer step takes from its queues: each kind a topic, each item a record, bit for bit.
//!
//! A kind is declared once, below. Items carry the tick of the boundary at which they were frozen.

use windhover_autopilot::battery::BatterySample;
use windhover_autopilot::mission::PlanKind;
use windhover_autopilot::mission::action::{Altitude, Place};
use windhover_autopilot::mode::{Guidance, Mode, Target};
use windhover_autopilot::{
    BarometerSample, Command, CompassSample, ExternalEstimate, GnssSample, MissionCommit, MotorTest,
    OuterInputs, ParameterWrite, Queues, RcFrame, Station, Sticks, Urgent,
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
    guidance: Guidance(Guidance) = 16, "input_guidance" { uses: u8, position: Vector3, velocity: Vector3, heading: f32, heading_rate: f32 };
    rc: Rc(RcFrame) = 17, "input_rc" { channels: [u16; 16] };
    sticks: Sticks(Sticks) = 18, "input_sticks" { roll: f32, pitch: f32, yaw: f32, throttle: f32 };
    battery: Battery(BatterySample) = 19, "input_battery" { time: u64, voltage: u16, current: u16 };
    station: Station(Station) = 20, "input_station" { system: u8 };
    attitude: Attitude(AttitudeSetpoint) = 12, "input_attitude" { attitude: Quaternion, rate: Vector3, thrust: f32 };
}

/// A command as its record has it: what it does not have is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FlatCommand {
    /// 0 arm, 1 disarm, 2 force-arm, 3 mode, 4 takeoff, 5 go to, 6 start mission, 7 speed, 8 home,
    /// 9 look at, 10 photo, 11 commit a plan, 12 select an item (`count`), 13 test a motor (rotor
    /// `slot`, share of the full command `speed`, duration in s `heading`).
    pub command: u8,
    /// The mode, as [`Mode`] counts them; of a commit the kind of plan.
    pub mode: u8,
    /// Which of the numbers count: 1 the place, 2 an altitude above home, 4 above the sea, 8 the
    /// heading, 16 the speed.
    pub uses: u8,
    pub slot: u8,
    /// Items of a commit; the first item of a mission.
    pub count: u16,
    pub crc: u32,
    pub latitude: i32,
    pub longitude: i32,
    pub altitude: f32,
    pub heading: f32,
    pub speed: f32,
}

record!(FlatCommand {
    command: u8,
    mode: u8,
    uses: u8,
    slot: u8,
    count: u16,
    crc: u32,
    latitude: i32,
    longitude: i32,
    altitude: f32,
    heading: f32,
    speed: f32
});

const PLACE: u8 = 1;
const ABOVE_HOME: u8 = 2;
const ABOVE_SEA: u8 = 4;
const HEADING: u8 = 8;
const SPEED: u8 = 16;

impl FlatCommand {
    fn new(command: u8) -> Self {
        Self {
            command,
            ..Self::default()
        }
    }

    fn with_ground(mut self, ground: Option<(i32, i32)>) -> Self {
        if let Some((latitude, longitude)) = ground {
            (self.latitude, self.longitude) = (latitude, longitude);
            self.uses |= PLACE;
        }
        self
    }

    fn with_altitude(mut self, altitude: Option<Altitude>) -> Self {
        let (metres, uses) = match altitude {
            Some(Altitude::Home(metres)) => (metres, ABOVE_HOME),
            Some(Altitude::SeaLevel(metres)) => (metres, ABOVE_SEA),
            None => return self,
        };
        self.altitude = metres;
        self.uses |= uses;
        self
    }

    fn with_heading(mut self, heading: Option<f32>) -> Self {
        if let Some(heading) = heading {
            self.heading = heading;
            self.uses |= HEADING;
        }
        self
    }

    fn with_speed(mut self, speed: Option<f32>) -> Self {
        if let Some(speed) = speed {
            self.speed = speed;
            self.uses |= SPEED;
        }
        self
    }

    fn with_place(self, place: Option<Place>) -> Self {
        let ground = place.map(|place| (place.latitude, place.longitude));
        self.with_ground(ground)
            .with_altitude(place.map(|place| place.altitude))
    }

    fn has(&self, uses: u8) -> bool {
        self.uses & uses != 0
    }

    fn ground(&self) -> Option<(i32, i32)> {
        self.has(PLACE).then_some((self.latitude, self.longitude))
    }

    fn altitude(&self) -> Option<Altitude> {
        if self.has(ABOVE_HOME) {
            Some(Altitude::Home(self.altitude))
        } else {
            self.has(ABOVE_SEA).then_some(Altitude::SeaLevel(self.altitude))
        }
    }

    fn heading(&self) -> Option<f32> {
        self.has(HEADING).then_some(self.heading)
    }

    fn speed(&self) -> Option<f32> {
        self.has(SPEED).then_some(self.speed)
    }

    fn place(&self) -> Option<Place> {
        let (latitude, longitude) = self.ground()?;
        Some(Place {
            latitude,
            longitude,
            altitude: self.altitude()?,
        })
    }
}

impl From<Command> for FlatCommand {
    fn from(command: Command) -> Self {
        match command {
            Command::Arm => Self::new(0),
            Command::Disarm => Self::new(1),
            Command::ForceArm => Self::new(2),
            Command::Fly(mode) => Self {
                mode: mode as u8,
                ..Self::new(3)
            },
            Command::Takeoff(altitude, heading) => Self::new(4).with_altitude(altitude).with_heading(heading),
            Command::GoTo(Target {
                ground,
                altitude,
                heading,
                speed,
            }) => Self::new(5)
                .with_ground(ground)
                .with_altitude(altitude)
                .with_heading(heading)
                .with_speed(speed),
            Command::StartMission(count) => Self {
                count,
                ..Self::new(6)
            },
            Command::SetSpeed(speed) => Self::new(7).with_speed(speed),
            Command::SetHome(place) => Self::new(8).with_place(place),
            Command::LookAt(place) => Self::new(9).with_place(place),
            Command::TakePhoto => Self::new(10),
            Command::Commit(kind, MissionCommit { slot, count, crc }) => Self {
                mode: kind.code(),
                slot,
                count,
                crc,
                ..Self::new(11)
            },
            Command::SelectItem(count) => Self {
                count,
                ..Self::new(12)
            },
            Command::TestMotor(MotorTest {
                rotor,
                share,
                duration,
            }) => Self {
                slot: rotor,
                ..Self::new(13).with_speed(Some(share)).with_heading(Some(duration))
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
        Some(match flat.command {
            0 => Self::Arm,
            1 => Self::Disarm,
            2 => Self::ForceArm,
            3 => Self::Fly(*Mode::ALL.get(usize::from(flat.mode))?),
            4 => Self::Takeoff(flat.altitude(), flat.heading()),
            5 => Self::GoTo(Target {
                ground: flat.ground(),
                altitude: flat.altitude(),
                heading: flat.heading(),
                speed: flat.speed(),
            }),
            6 => Self::StartMission(flat.count),
            7 => Self::SetSpeed(flat.speed()),
            8 => Self::SetHome(flat.place()),
            9 => Self::LookAt(flat.place()),
            10 => Self::TakePhoto,
            11 => Self::Commit(
                PlanKind::from_code(flat.mode)?,
                MissionCommit {
                    slot: flat.slot,
                    count: flat.count,
                    crc: flat.crc,
                },
            ),
            12 => Self::SelectItem(flat.count),
            13 => Self::TestMotor(MotorTest {
                rotor: flat.slot,
                share: flat.speed()?,
                duration: flat.heading()?,
            }),
            _ => return None,
        })
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
