//! Parameters of a command, however it came: `None` where they are not set.
//!
//! Parameters that are not set come as NaN, in `COMMAND_INT` also as the largest integer.

use windhover_autopilot::mission::action::{Altitude, Place};

use super::FRAME;
use crate::request::Ground;
use crate::scale::{Datum, E7, integer, set};
use crate::wire::Payload;

/// Parameters of a command, `None` where they are not set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    plain: [Option<f32>; 4],
    /// Parameters 5 and 6 as numbers.
    five_six: [Option<f32>; 2],
    /// Parameters 5 and 6 as a place, which may be none on Earth.
    pub(super) ground: Option<Ground>,
    seven: Option<f32>,
    pub(super) datum: Datum,
}

impl Parameters {
    /// Those of a `COMMAND_LONG`; places are in degrees.
    pub fn long(payload: Payload<'_>) -> Self {
        let [one, two, three, four, five, six, seven] = payload.floats(0).map(set);
        let place = five.zip(six).map(|(latitude, longitude)| Ground {
            latitude: integer(latitude, E7),
            longitude: integer(longitude, E7),
        });
        Self {
            plain: [one, two, three, four],
            five_six: [five, six],
            ground: place.and_then(given),
            seven,
            datum: Datum::Implied,
        }
    }

    /// Those of a `COMMAND_INT`; places are in 1e-7 degrees.
    pub fn int(payload: Payload<'_>) -> Self {
        let places = [16, 20].map(|at| payload.integer(at));
        let [latitude, longitude] = places;
        let is_set = !places.contains(&i32::MAX);
        let place = is_set.then_some(Ground { latitude, longitude });
        Self {
            plain: payload.floats(0).map(set),
            five_six: places.map(|value| (value != i32::MAX).then_some(value as f32)),
            ground: place.and_then(given),
            seven: set(payload.float(24)),
            datum: Datum::of(payload.byte(FRAME)),
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
            Datum::Implied => Some(implied(altitude)),
            datum => datum.altitude(altitude),
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

/// (0, 0) is what clients send that have no place.
fn given(place: Ground) -> Option<Ground> {
    let is_nowhere = (place.latitude, place.longitude) == (0, 0);
    (!is_nowhere).then_some(place)
}
