//! Offboard setpoints and sticks that come by radio: typed, in SI units, NED and radians.
//!
//! They come many times a second and only the newest counts: each waits in a place of its own, not
//! in the queue of requests.

use windhover_autopilot::mission::action::Altitude;
use windhover_math::{Quaternion, saturate};

use crate::frame::Address;
use crate::request::{Ground, Request};
use crate::scale::{Datum, set};
use crate::wire::Payload;

/// Where the two messages of position targets have their position, motion, mask, target and frame.
const POSITION: usize = 4;
const MOTION: usize = 16;
const MASK: usize = 48;
const TARGET: usize = 50;
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
pub(crate) fn local(payload: Payload<'_>, own: Address) -> Option<Request> {
    if !payload.is_for(own, TARGET) {
        return None;
    }
    let frame = match payload.byte(FRAME) {
        1 => LocalFrame::Ned,
        7 => LocalFrame::OffsetNed,
        8 | 9 | 12 => LocalFrame::Body,
        _ => return None,
    };
    Some(Request::Offboard(Setpoint::Local {
        frame,
        position: masked(payload.floats(POSITION), payload.word(MASK), 0),
        motion: motion(payload),
    }))
}

/// `SET_POSITION_TARGET_GLOBAL_INT`; `None` also when it is not on Earth.
pub(crate) fn global(payload: Payload<'_>, own: Address) -> Option<Request> {
    if !payload.is_for(own, TARGET) {
        return None;
    }
    let mask = payload.word(MASK);
    let datum = Datum::of(payload.byte(FRAME));
    if !matches!(datum, Datum::SeaLevel | Datum::Home) {
        return None;
    }
    let on_map = mask & 0b11 == 0;
    let ground = Ground {
        latitude: payload.integer(POSITION),
        longitude: payload.integer(POSITION + 4),
    };
    if on_map && !ground.is_on_earth() {
        return None;
    }
    Some(Request::Offboard(Setpoint::Global {
        ground: on_map.then_some(ground),
        altitude: unmasked(payload.float(POSITION + 8), mask, 2).and_then(|metres| datum.altitude(metres)),
        motion: motion(payload),
    }))
}

/// `SET_ATTITUDE_TARGET`.
pub(crate) fn attitude(payload: Payload<'_>, own: Address) -> Option<Request> {
    if !payload.is_for(own, 36) {
        return None;
    }
    let mask = u16::from(payload.byte(38));
    let [w, x, y, z] = payload.floats(4);
    let attitude = Quaternion::new(w, x, y, z);
    let norm = attitude.dot(attitude);
    let is_rotation = norm > 0.8 && norm < 1.2;
    Some(Request::Offboard(Setpoint::Attitude {
        attitude: (mask & 1 << 7 == 0 && is_rotation).then(|| attitude.normalized()),
        rate: masked(payload.floats(20), mask, 0),
        thrust: unmasked(payload.float(32), mask, 6).map(|thrust| thrust.clamp(0.0, 1.0)),
    }))
}

/// `MANUAL_CONTROL`.
pub(crate) fn sticks(payload: Payload<'_>, own: Address) -> Option<Request> {
    if payload.byte(10) != own.system {
        return None;
    }
    let [pitch, roll, throttle, yaw] = [0, 2, 4, 6].map(|at| {
        let value = payload.short(at);
        (value != NO_STICK).then(|| saturate(f32::from(value) * 1e-3, 1.0))
    });
    Some(Request::Sticks(Sticks {
        pitch,
        roll,
        throttle: throttle.map(|throttle| throttle.clamp(0.0, 1.0)),
        yaw,
        buttons: payload.word(8),
    }))
}

/// `RC_CHANNELS_OVERRIDE`: up to channel 8 nothing is 65535 and 0 gives back; beyond, which comes
/// behind the target, 0 is nothing too and 65534 gives back.
pub(crate) fn channels(payload: Payload<'_>, own: Address) -> Option<Request> {
    if !payload.is_for(own, 16) {
        return None;
    }
    let channels = core::array::from_fn(|number| {
        let (at, keep, release) = match number {
            0..8 => (2 * number, u16::MAX, 0),
            _ => (2 * number + 2, 0, u16::MAX - 1),
        };
        match payload.word(at) {
            u16::MAX => Channel::Keep,
            value if value == keep => Channel::Keep,
            value if value == release => Channel::Release,
            pulse => Channel::Pulse(pulse),
        }
    });
    Some(Request::Channels(Channels { channels }))
}

/// Velocity, acceleration and heading, as far as the mask does not leave them out.
#[inline(never)]
fn motion(payload: Payload<'_>) -> Motion {
    let mask = payload.word(MASK);
    Motion {
        velocity: masked(payload.floats(MOTION), mask, 3),
        acceleration: masked(payload.floats(MOTION + 12), forceless(mask), 6),
        heading: unmasked(payload.float(MOTION + 24), mask, 10),
        heading_rate: unmasked(payload.float(MOTION + 28), mask, 11),
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
