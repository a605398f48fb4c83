//! What people look at: topics under PX4's names and in PX4's units where PX4 has such a topic, so
//! that PlotJuggler and Flight Review show a flight, and ours beside them.
//!
//! Nothing here is needed for replay; the group for the desktop holds what only a model knows.

mod from_core;

use windhover_math::{Quaternion, Vector3};

use crate::record;
use crate::record::{Description, Record, Topic};
use crate::wire::Decoder;

pub use from_core::{known_code, motor_state_code, refusal_code, why_code};

/// Declares views: struct, number and name of the topic, fields.
macro_rules! views {
    ($(
        $(#[$meta:meta])*
        $View:ident = $id:literal, $name:literal { $($(#[$field_meta:meta])* $field:ident: $Value:ty,)* }
    )*) => {
        $(
            $(#[$meta])*
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct $View {
                $($(#[$field_meta])* pub $field: $Value,)*
            }

            record!($View { $($field: $Value),* });

            impl Topic for $View {
                const TOPIC: Description = Description {
                    id: $id,
                    name: $name,
                    ticked: false,
                    fields: <$View as Record>::FIELDS,
                };
            }
        )*

        /// All views.
        pub const TOPICS: &[Description] = &[$(<$View as Topic>::TOPIC,)*];

        /// A record of any view.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum View {
            $(
                #[doc = concat!("Topic `", $name, "`.")]
                $View($View),
            )*
        }

        impl View {
            /// Reads the fields of the topic with that number; `None` when they are not such.
            pub fn get(id: u16, from: &mut Decoder<'_>) -> Option<Self> {
                match id {
                    $($id => Record::get(from).map(Self::$View),)*
                    _ => None,
                }
            }

            /// The topic, and the record as bytes, written into `buffer`.
            pub fn put<'a>(&self, buffer: &'a mut [u8]) -> (Description, &'a [u8]) {
                let mut out = crate::wire::Encoder::new(buffer);
                let topic = match self {
                    $(Self::$View(view) => {
                        view.put(&mut out);
                        <$View as Topic>::TOPIC
                    })*
                };
                let length = out.finish().unwrap_or(0);
                (topic, buffer.get(..length).unwrap_or_default())
            }
        }
    };
}

views! {
    /// Attitude as estimated.
    VehicleAttitude = 32, "vehicle_attitude" {
        /// Body (FRD) to world (NED).
        q: Quaternion,
    }
    /// Attitude and thrust that position control demands.
    VehicleAttitudeSetpoint = 33, "vehicle_attitude_setpoint" {
        /// Body (FRD) to world (NED).
        q_d: Quaternion,
        /// Thrust in body axes as a share of the largest, −1 to 1.
        thrust_body: Vector3,
    }
    /// Position and velocity as estimated, NED, m and m/s from home.
    VehicleLocalPosition = 34, "vehicle_local_position" {
        /// North, m.
        x: f32,
        /// East, m.
        y: f32,
        /// Down, m.
        z: f32,
        /// North, m/s.
        vx: f32,
        /// East, m/s.
        vy: f32,
        /// Down, m/s.
        vz: f32,
        /// Heading, rad.
        heading: f32,
        /// Whether x and y are known.
        xy_valid: bool,
        /// Whether z is known.
        z_valid: bool,
        /// Whether vx and vy are known.
        v_xy_valid: bool,
        /// Whether vz is known.
        v_z_valid: bool,
    }
    /// The point of the path that position control follows.
    VehicleLocalPositionSetpoint = 35, "vehicle_local_position_setpoint" {
        /// North, m.
        x: f32,
        /// East, m.
        y: f32,
        /// Down, m.
        z: f32,
        /// North, m/s.
        vx: f32,
        /// East, m/s.
        vy: f32,
        /// Down, m/s.
        vz: f32,
        /// NED, m/s².
        acceleration: Vector3,
        /// Heading, rad.
        yaw: f32,
        /// Its rate, rad/s.
        yawspeed: f32,
    }
    /// Motor commands.
    ActuatorMotors = 36, "actuator_motors" {
        /// Rotor speed as a share of the largest, in the core's rotor order.
        control: [f32; 4],
    }
    /// A sample of the inertial sensors in SI units, body axes (FRD), calibrated.
    SensorCombined = 37, "sensor_combined" {
        /// Body rate, rad/s.
        gyro_rad: Vector3,
        /// Specific force, m/s².
        accelerometer_m_s2: Vector3,
    }
    /// The state in PX4's numbers.
    VehicleStatus = 38, "vehicle_status" {
        /// 1 disarmed, 2 armed.
        arming_state: u8,
        /// The mode: 1 altitude, 2 position, 3 mission, 4 hold, 5 return, 12 descend, 14 offboard,
        /// 15 stabilize, 17 takeoff, 18 land.
        nav_state: u8,
        /// 1: rotary wing.
        vehicle_type: u8,
        /// Whether a failsafe acts.
        failsafe: bool,
    }
    /// Whether the vehicle is on the ground.
    VehicleLandDetected = 39, "vehicle_land_detected" {
        /// Whether it is.
        landed: bool,
    }
    /// The state in our numbers; on change and once a second.
    FlightPhase = 40, "phase" {
        /// 0 disarmed, 1 armed, 2 flying, 3 landed.
        phase: u8,
        /// As `Mode` counts them: 0 stabilize, 1 altitude, 2 position, 3 takeoff, 4 hold,
        /// 5 mission, 6 return, 7 land, 8 offboard, 9 descend.
        mode: u8,
        /// The row of the failsafes' table that acts, from 1; 0 none.
        failsafe: u8,
        /// The rows whose condition has lasted, a bit each.
        active: u32,
        /// What speaks against arming, a bit each.
        blockers: u32,
        /// 0 disarmed, 1 idle, 2 run.
        motors: u8,
        /// Why the inner step keeps the motors stopped: 0 it does not, 1 kill, 2 disarm,
        /// 3 no samples.
        stop: u8,
    }
    /// Something that happened in the mission.
    Mission = 41, "mission_event" {
        /// 1 reached, 2 missed, 3 photo, 4 landed, 5 finished.
        kind: u8,
        /// Index of the item, for the first three.
        item: u16,
        /// Photo: whether position and speed had settled.
        settled: bool,
        /// Photo: whether the vehicle stopped for it.
        has_target: bool,
        /// Photo: where it was to be taken, NED, m.
        target: Vector3,
    }
    /// The leg that is being flown; on change.
    Leg = 42, "leg" {
        /// Where it leads, NED, m.
        destination: Vector3,
    }
    /// Something that was asked for and not done.
    Refusal = 43, "refusal" {
        /// 0 a command, 1 a parameter.
        kind: u8,
        /// Command: as in `input_command`.
        command: u8,
        /// Command: 1 blockers, 2 in flight, 3 on the ground, 4 a failsafe, 5 an item of the
        /// mission, 6 one of the fence, 7 not a number, 8 the place, 9 armed. Parameter: 1 unknown,
        /// 2 out of range, 3 inconsistent.
        reason: u8,
        /// Parameter: its index. Command: the item, or the row of the failsafes' table, from 0
        /// (where `phase` counts rows from 1).
        index: u16,
        /// Command: what speaks against it, a bit each.
        blockers: u32,
        /// Parameter: the value.
        value: f32,
    }
    /// Acceleration by wind and payload as observed.
    Disturbance = 44, "disturbance" {
        /// NED, m/s².
        acceleration: Vector3,
        /// Acceleration that the rotors give over what the parameters say.
        thrust_scale: f32,
    }
    /// Sums since the start of the log; once a second.
    TickCounts = 45, "tick_counts" {
        /// Ticks.
        ticks: u32,
        /// Ticks without a sample.
        missing: u32,
        /// Ticks at which a rotor limit changed the demand.
        saturated: u32,
        /// Messages for people that found no room.
        dropped_outputs: u32,
        /// Boundaries at which the outer step was still at work.
        missed: u32,
    }
    /// How the board does; once a second, boards only.
    BoardHealth = 46, "board_health" {
        /// Share of the processor's time in which it did not sleep.
        load: f32,
        /// Share of the processor's time in the inner loop, from data-ready to the next wait.
        load_inner: f32,
        /// Share of the processor's time in the outer loop, interruptions included.
        load_outer: f32,
        /// The deepest that the stack has been since start, bytes.
        stack_used: u32,
        /// Size of the stack, bytes.
        stack_size: u32,
        /// The longest time from data-ready to the motors' compare registers, µs.
        latency_max: u32,
        /// Bursts from the inertial sensors that failed since start.
        imu_errors: u32,
        /// Bytes that waited for the log's port at most.
        log_waiting_max: u32,
    }
    /// The battery; once a second.
    BatteryStatus = 48, "battery_status" {
        /// V; 0 while the sensor is silent.
        voltage_v: f32,
        /// A.
        current_a: f32,
        /// Share that is left, 0 to 1; −1 while it is not known.
        remaining: f32,
        /// Charge drawn, mAh.
        discharged_mah: f32,
        /// 0 unknown, 1 enough, 2 low, 3 critical, 4 emergency.
        charge: u8,
    }
    /// What the filter claims of itself; once a second.
    EstimatorStatus = 47, "estimator_state" {
        /// What is known, in bits: 1 attitude, 2 heading, 4 height, 8 position.
        known: u8,
        /// Declared standard deviation of the horizontal position, both axes together, m.
        horizontal: f32,
        /// Of the height, m.
        vertical: f32,
        /// Of the velocity, three axes together, m/s.
        velocity: f32,
        /// Of roll and pitch together, rad.
        tilt: f32,
        /// Of the heading, rad.
        heading: f32,
        /// Gyro bias, FRD, rad/s.
        gyro_bias: Vector3,
        /// Accelerometer bias, FRD, m/s².
        accel_bias: Vector3,
        /// Of GNSS position, height, velocity, barometer, compass, heading, rest, gravity, pose:
        /// 0 unseen, 1 good, 2 degraded, 3 lost.
        sensors: [u8; 9],
        /// Measurements that the gates rejected since start.
        rejected: u32,
        /// Measurements that were refused as impossible since start.
        refused: u32,
        /// How often the estimate was set to a measurement since start.
        resets: u32,
        /// How often the inertial sensors were doubted since start.
        doubts: u32,
        /// What the setpoint is shifted by, NED, m.
        handover: Vector3,
    }
    /// Inputs are missing from the tick `from` to before `until`.
    Gap = 6, "gap" {
        /// The first tick that is missing.
        from: u32,
        /// The first tick that is there again.
        until: u32,
    }
    /// What the model knows; desktop only.
    Truth = 64, "truth" {
        /// NED, m.
        position: [f64; 3],
        /// NED, m/s.
        velocity: [f64; 3],
        /// Body to world.
        q: [f64; 4],
        /// FRD, rad/s.
        body_rate: [f32; 3],
        /// rad/s, in the core's rotor order.
        rotor_speed: [f32; 4],
        /// Velocity of the air, NED, m/s.
        wind: [f32; 3],
        /// Electrical power, W.
        power: f32,
        /// Electrical energy since the start, J.
        energy: f64,
    }
}
