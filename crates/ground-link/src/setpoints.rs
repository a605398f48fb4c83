//! Offboard setpoints and sticks that come by radio: typed, in SI units, NED and radians.
//!
//! They come many times a second and only the newest counts: each waits in a place of its own, not
//! in the queue of requests.

use mavlink::dialects::common::{
    MANUAL_CONTROL_DATA, MavFrame, RC_CHANNELS_OVERRIDE_DATA, SET_ATTITUDE_TARGET_DATA,
    SET_POSITION_TARGET_GLOBAL_INT_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use windhover_autopilot::mission::action::Altitude;
use windhover_math::{Quaternion, Vector3, saturate};

use crate::frame::Address;
use crate::request::Ground;
use crate::scale::set;
use crate::wire::Payload;

/// Where the two messages of position targets have their frame.
const FRAME: usize = 52;

/// The number of a stick that is not there.
const NO_STICK: i16 = i16::MAX;

/// What to follow; `None` leaves a quantity to the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setpoint {
    /// In a frame around home or the vehicle.
    Local {
        /// Which.
        frame: LocalFrame,
        /// m.
        position: [Option<f32>; 3],
        /// Everything else.
        motion: Motion,
    },
    /// On the map.
    Global {
        /// Where.
        ground: Option<Ground>,
        /// How high.
        altitude: Option<Altitude>,
        /// Everything else, NED.
        motion: Motion,
    },
    /// Attitude and thrust.
    Attitude {
        /// Body to world, norm 1.
        attitude: Option<Quaternion>,
        /// Body rates, FRD, rad/s.
        rate: [Option<f32>; 3],
        /// Share of the largest thrust, 0 to 1.
        thrust: Option<f32>,
    },
}

/// Velocity, acceleration and heading of a setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// m/s.
    pub velocity: [Option<f32>; 3],
    /// m/s².
    pub acceleration: [Option<f32>; 3],
    /// rad.
    pub heading: Option<f32>,
    /// rad/s.
    pub heading_rate: Option<f32>,
}

/// What a local setpoint's numbers count from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocalFrame {
    /// North, east, down from home.
    Ned,
    /// North, east, down from the vehicle.
    OffsetNed,
    /// Forward, right, down from the vehicle, level.
    Body,
}

/// A game pad: -1 to 1, but for the throttle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sticks {
    /// Forward is positive.
    pub pitch: Option<f32>,
    /// Right is positive.
    pub roll: Option<f32>,
    /// 0 to 1; its middle holds the height where a mode does so.
    pub throttle: Option<f32>,
    /// Clockwise is positive.
    pub yaw: Option<f32>,
    /// One bit a button.
    pub buttons: u16,
}

/// Channels of a remote control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channels {
    /// 1 to 18.
    pub channels: [Channel; 18],
}

/// One channel of [`Channels`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channel {
    /// As it was told last.
    #[default]
    Keep,
    /// Back to the receiver.
    Release,
    /// As if the receiver said so, µs.
    Pulse(u16),
}

/// `SET_POSITION_TARGET_LOCAL_NED`; `None` when it is for another, or in a frame not understood.
pub(crate) fn local(payload: Payload<'_>, own: Address) -> Option<Setpoint> {
    let data: SET_POSITION_TARGET_LOCAL_NED_DATA = payload.read_with(&[(FRAME, 1)])?;
    if !own.is_meant(data.target_system, data.target_component) {
        return None;
    }
    let mask = data.type_mask.bits();
    let frame = match payload.byte(FRAME) {
        1 => LocalFrame::Ned,
        7 => LocalFrame::OffsetNed,
        8 | 9 | 12 => LocalFrame::Body,
        _ => return None,
    };
    Some(Setpoint::Local {
        frame,
        position: masked([data.x, data.y, data.z], mask, 0),
        motion: motion(
            [data.vx, data.vy, data.vz],
            [data.afx, data.afy, data.afz],
            [data.yaw, data.yaw_rate],
            mask,
        ),
    })
}

/// `SET_POSITION_TARGET_GLOBAL_INT`.
pub(crate) fn global(payload: Payload<'_>, own: Address) -> Option<Setpoint> {
    let data: SET_POSITION_TARGET_GLOBAL_INT_DATA = payload.read_with(&[(FRAME, 5)])?;
    if !own.is_meant(data.target_system, data.target_component) {
        return None;
    }
    let mask = data.type_mask.bits();
    let datum = match payload.byte(FRAME) {
        frame if frame == MavFrame::MAV_FRAME_GLOBAL as u8 || frame == 5 => Altitude::SeaLevel,
        3 | 6 => Altitude::Home,
        _ => return None,
    };
    let on_map = mask & 0b11 == 0;
    Some(Setpoint::Global {
        ground: on_map.then_some(Ground {
            latitude: data.lat_int,
            longitude: data.lon_int,
        }),
        altitude: unmasked(data.alt, mask, 2).map(datum),
        motion: motion(
            [data.vx, data.vy, data.vz],
            [data.afx, data.afy, data.afz],
            [data.yaw, data.yaw_rate],
            mask,
        ),
    })
}

/// `SET_ATTITUDE_TARGET`.
pub(crate) fn attitude(payload: Payload<'_>, own: Address) -> Option<Setpoint> {
    let data: SET_ATTITUDE_TARGET_DATA = payload.read()?;
    if !own.is_meant(data.target_system, data.target_component) {
        return None;
    }
    let mask = u16::from(data.type_mask.bits());
    let [w, x, y, z] = data.q;
    let attitude = Quaternion::new(w, x, y, z);
    let norm = attitude.dot(attitude);
    let is_rotation = norm > 0.8 && norm < 1.2;
    Some(Setpoint::Attitude {
        attitude: (mask & 1 << 7 == 0 && is_rotation).then(|| attitude.normalized()),
        rate: masked(
            [data.body_roll_rate, data.body_pitch_rate, data.body_yaw_rate],
            mask,
            0,
        ),
        thrust: unmasked(data.thrust, mask, 6).map(|thrust| thrust.clamp(0.0, 1.0)),
    })
}

/// `MANUAL_CONTROL`.
pub(crate) fn sticks(payload: Payload<'_>, own: Address) -> Option<Sticks> {
    let data: MANUAL_CONTROL_DATA = payload.read()?;
    if data.target != own.system {
        return None;
    }
    let stick = |value: i16| (value != NO_STICK).then(|| saturate(f32::from(value) * 1e-3, 1.0));
    Some(Sticks {
        pitch: stick(data.x),
        roll: stick(data.y),
        throttle: stick(data.z).map(|throttle| throttle.clamp(0.0, 1.0)),
        yaw: stick(data.r),
        buttons: data.buttons,
    })
}

/// `RC_CHANNELS_OVERRIDE`.
pub(crate) fn channels(payload: Payload<'_>, own: Address) -> Option<Channels> {
    let data: RC_CHANNELS_OVERRIDE_DATA = payload.read()?;
    if !own.is_meant(data.target_system, data.target_component) {
        return None;
    }
    // Up to channel 8 nothing is 65535 and 0 gives back; beyond, 0 is nothing too.
    let low = |value| match value {
        u16::MAX => Channel::Keep,
        0 => Channel::Release,
        pulse => Channel::Pulse(pulse),
    };
    let high = |value| match value {
        u16::MAX | 0 => Channel::Keep,
        0xfffe => Channel::Release,
        pulse => Channel::Pulse(pulse),
    };
    let d = &data;
    let [a, b, c, e, f, g, h, i] = [
        d.chan1_raw,
        d.chan2_raw,
        d.chan3_raw,
        d.chan4_raw,
        d.chan5_raw,
        d.chan6_raw,
        d.chan7_raw,
        d.chan8_raw,
    ]
    .map(low);
    let [j, k, l, m, n, o, p, q, r, s] = [
        d.chan9_raw,
        d.chan10_raw,
        d.chan11_raw,
        d.chan12_raw,
        d.chan13_raw,
        d.chan14_raw,
        d.chan15_raw,
        d.chan16_raw,
        d.chan17_raw,
        d.chan18_raw,
    ]
    .map(high);
    Some(Channels {
        channels: [a, b, c, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s],
    })
}

/// Velocity, acceleration and heading, as far as the mask does not leave them out.
#[inline(never)]
fn motion(velocity: [f32; 3], acceleration: [f32; 3], [heading, rate]: [f32; 2], mask: u16) -> Motion {
    Motion {
        velocity: masked(velocity, mask, 3),
        acceleration: masked(acceleration, forceless(mask), 6),
        heading: unmasked(heading, mask, 10),
        heading_rate: unmasked(rate, mask, 11),
    }
}

/// A number whose bit is not set in the mask of what to ignore, and that is one.
fn unmasked(value: f32, mask: u16, bit: u32) -> Option<f32> {
    (mask & 1 << bit == 0).then_some(value).and_then(set)
}

/// Three numbers with three bits in a row.
#[inline(never)]
fn masked([x, y, z]: [f32; 3], mask: u16, bit: u32) -> [Option<f32>; 3] {
    [
        unmasked(x, mask, bit),
        unmasked(y, mask, bit + 1),
        unmasked(z, mask, bit + 2),
    ]
}

/// With bit 9 the accelerations are forces: those are not followed.
fn forceless(mask: u16) -> u16 {
    if mask & 1 << 9 == 0 {
        mask
    } else {
        mask | 0b111 << 6
    }
}

impl Setpoint {
    /// The velocity, where all three are given.
    pub fn velocity(&self) -> Option<Vector3> {
        match self {
            Self::Local { motion, .. } | Self::Global { motion, .. } => match motion.velocity {
                [Some(x), Some(y), Some(z)] => Some(Vector3::new(x, y, z)),
                _ => None,
            },
            Self::Attitude { .. } => None,
        }
    }
}
