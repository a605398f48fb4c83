//! Parameters of a command, however it came: `None` where they are not set.
//!
//! Parameters that are not set come as NaN, in `COMMAND_INT` also as the largest integer.

use mavlink::dialects::common::{COMMAND_INT_DATA, COMMAND_LONG_DATA, MavFrame};
use windhover_autopilot::mission::action::{Altitude, Place};

use crate::request::Ground;
use crate::scale::{integer, set};

/// How an altitude counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Datum {
    SeaLevel,
    Home,
    /// As the client's idea of us has it.
    Implied,
    Unsupported,
}

/// Parameters of a command, `None` where they are not set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    plain: [Option<f32>; 4],
    /// Parameters 5 and 6 as numbers.
    five_six: [Option<f32>; 2],
    pub(super) ground: Option<Ground>,
    seven: Option<f32>,
    pub(super) datum: Datum,
}

impl Parameters {
    /// Those of a `COMMAND_LONG`; places are in degrees.
    pub fn long(data: &COMMAND_LONG_DATA) -> Self {
        let degrees = [data.param5, data.param6].map(set);
        let ground = match degrees {
            [Some(latitude), Some(longitude)] => ground(
                integer(f64::from(latitude) * 1e7),
                integer(f64::from(longitude) * 1e7),
            ),
            _ => None,
        };
        Self {
            plain: [data.param1, data.param2, data.param3, data.param4].map(set),
            five_six: degrees,
            ground,
            seven: set(data.param7),
            datum: Datum::Implied,
        }
    }

    /// Those of a `COMMAND_INT`; places are in 1e-7 degrees.
    pub fn int(data: &COMMAND_INT_DATA, frame: u8) -> Self {
        let is_set = data.x != i32::MAX && data.y != i32::MAX;
        Self {
            plain: [data.param1, data.param2, data.param3, data.param4].map(set),
            five_six: [data.x, data.y].map(|value| (value != i32::MAX).then_some(value as f32)),
            ground: ground(data.x, data.y).filter(|_| is_set),
            seven: set(data.z),
            datum: datum(frame),
        }
    }

    #[inline(never)]
    pub(super) fn get(&self, number: usize) -> Option<f32> {
        match number {
            5 => self.five_six[0],
            6 => self.five_six[1],
            7 => self.seven,
            _ => self.plain.get(number.wrapping_sub(1)).copied().flatten(),
        }
    }

    /// A parameter that counts or switches: 0 when it is not set.
    #[inline(never)]
    pub(super) fn number(&self, number: usize) -> f32 {
        self.get(number).unwrap_or_default()
    }

    pub(super) fn is(&self, number: usize, value: f32) -> bool {
        self.get(number) == Some(value)
    }

    /// The altitude; `implied` says how it counts where the command does not.
    #[inline(never)]
    pub(super) fn altitude(&self, implied: fn(f32) -> Altitude) -> Option<Altitude> {
        let altitude = self.seven?;
        match self.datum {
            Datum::SeaLevel => Some(Altitude::SeaLevel(altitude)),
            Datum::Home => Some(Altitude::Home(altitude)),
            Datum::Implied => Some(implied(altitude)),
            Datum::Unsupported => None,
        }
    }

    #[inline(never)]
    pub(super) fn place(&self) -> Option<Place> {
        let Ground { latitude, longitude } = self.ground?;
        let altitude = self.altitude(Altitude::SeaLevel)?;
        Some(Place {
            latitude,
            longitude,
            altitude,
        })
    }
}

/// A point on the map; (0, 0) is what clients send that have none.
fn ground(latitude: i32, longitude: i32) -> Option<Ground> {
    let on_earth = latitude.unsigned_abs() <= 900_000_000 && longitude.unsigned_abs() <= 1_800_000_000;
    let is_set = (latitude, longitude) != (0, 0);
    (on_earth && is_set).then_some(Ground { latitude, longitude })
}

pub(super) fn datum(frame: u8) -> Datum {
    const SEA_LEVEL: [u8; 2] = [
        MavFrame::MAV_FRAME_GLOBAL as u8,
        MavFrame::MAV_FRAME_GLOBAL_INT as u8,
    ];
    const HOME: [u8; 2] = [
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT as u8,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT as u8,
    ];
    match frame {
        frame if SEA_LEVEL.contains(&frame) => Datum::SeaLevel,
        frame if HOME.contains(&frame) => Datum::Home,
        frame if frame == MavFrame::MAV_FRAME_MISSION as u8 => Datum::Implied,
        _ => Datum::Unsupported,
    }
}
