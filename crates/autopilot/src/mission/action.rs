//! What a mission item means. Commands and parameters are MAVLink's (`common.xml`, `MAV_CMD`).

use core::fmt;

use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_parameters::{Decimal, Whole};

use super::item::MissionItem;

/// Numbers of the `MAV_CMD`s that are understood.
pub mod command {
    #![allow(missing_docs)]
    pub const NAV_WAYPOINT: u16 = 16;
    pub const NAV_LOITER_TIME: u16 = 19;
    pub const NAV_RETURN_TO_LAUNCH: u16 = 20;
    pub const NAV_LAND: u16 = 21;
    pub const NAV_TAKEOFF: u16 = 22;
    pub const NAV_DELAY: u16 = 93;
    pub const CONDITION_DELAY: u16 = 112;
    pub const DO_JUMP: u16 = 177;
    pub const DO_CHANGE_SPEED: u16 = 178;
    pub const DO_SET_ROI_LOCATION: u16 = 195;
    pub const DO_SET_ROI_NONE: u16 = 197;
    pub const DO_SET_ROI: u16 = 201;
    pub const DO_DIGICAM_CONTROL: u16 = 203;
    pub const DO_MOUNT_CONTROL: u16 = 205;
    pub const DO_SET_CAM_TRIGG_DIST: u16 = 206;
    pub const SET_CAMERA_MODE: u16 = 530;
    pub const SET_CAMERA_ZOOM: u16 = 531;
    pub const SET_CAMERA_FOCUS: u16 = 532;
    pub const DO_GIMBAL_MANAGER_PITCHYAW: u16 = 1000;
    pub const DO_GIMBAL_MANAGER_CONFIGURE: u16 = 1001;
    pub const IMAGE_START_CAPTURE: u16 = 2000;
    pub const IMAGE_STOP_CAPTURE: u16 = 2001;
    pub const VIDEO_START_CAPTURE: u16 = 2500;
    pub const VIDEO_STOP_CAPTURE: u16 = 2501;
}

/// A place as an item gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Latitude in 1e-7 degree.
    pub latitude: i32,
    /// Longitude in 1e-7 degree.
    pub longitude: i32,
    /// Altitude.
    pub altitude: Altitude,
}

/// An altitude in m, by what it counts from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Altitude {
    /// Mean sea level.
    SeaLevel(f32),
    /// Home.
    Home(f32),
}

impl Altitude {
    /// Metres above a home that lies at `home` mm above mean sea level.
    pub fn above_home(self, home: i32) -> f32 {
        match self {
            Self::SeaLevel(altitude) => altitude - home as f32 * 1e-3,
            Self::Home(altitude) => altitude,
        }
    }

    /// How far down that is in a local frame with `home` in it, m.
    pub fn down(self, frame: &LocalFrame, home: Vector3) -> f32 {
        match self {
            Self::Home(height) => home.z - height,
            Self::SeaLevel(_) => -self.above_home(frame.origin().altitude),
        }
    }
}

/// Where a latitude and a longitude, 1e-7 degree, are in a local frame, NED, m: at its origin's
/// height.
pub fn over_ground(latitude: i32, longitude: i32, frame: &LocalFrame) -> Vector3 {
    frame.to_local(GlobalPosition {
        latitude,
        longitude,
        altitude: frame.origin().altitude,
    })
}

impl Place {
    /// Where it is in a local frame, NED, m, but at its origin's height.
    pub fn over_ground(&self, frame: &LocalFrame) -> Vector3 {
        over_ground(self.latitude, self.longitude, frame)
    }

    /// Where it is in a local frame with `home` in it, NED, m.
    pub fn local(&self, frame: &LocalFrame, home: Vector3) -> Vector3 {
        let ground = self.over_ground(frame);
        Vector3::new(ground.x, ground.y, self.altitude.down(frame, home))
    }
}

/// What an item asks for. Angles in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Climb straight up to an altitude. Where the item puts the place is left to the legs after.
    Takeoff {
        /// To here.
        altitude: Altitude,
    },
    /// Fly to a place.
    Waypoint {
        /// The place.
        place: Place,
        /// Stay there so long, s; 0 passes by.
        hold: f32,
        /// Reached within this distance, m; `None` leaves it to a parameter.
        acceptance_radius: Option<f32>,
        /// Heading on the way there and at it; `None` leaves it to a parameter.
        heading: Option<f32>,
    },
    /// Fly to the place where the mission began, and land there.
    Return,
    /// Land at a place, or here.
    Land {
        /// Where, if not here.
        place: Option<Place>,
    },
    /// Wait, s.
    Delay(f32),
    /// Fly at this speed from here on, m/s; `None` goes back to the default.
    Speed(Option<f32>),
    /// One photo, at rest.
    Photo,
    /// Photos every so many seconds from here on, so many of them (0: until told to stop).
    PhotoByTime {
        /// Seconds between two.
        interval: f32,
        /// How many.
        count: u16,
    },
    /// A photo every so many metres from here on; 0 stops.
    PhotoByDistance {
        /// Metres between two.
        distance: f32,
        /// Whether one is taken at once.
        at_once: bool,
    },
    /// No more photos by time or distance.
    PhotoStop,
    /// Keep the nose at a place.
    LookAt(Place),
    /// Keep the nose where it belongs again.
    LookAhead,
    /// Go on at another item, so many times (`None`: for ever).
    Jump {
        /// Index of the item.
        to: u16,
        /// How often.
        times: Option<u16>,
    },
    /// For the payload: nothing to fly.
    PassOn,
}

impl Action {
    /// Whether the vehicle moves for it: such items make up the path.
    pub fn is_navigation(&self) -> bool {
        matches!(
            self,
            Self::Takeoff { .. } | Self::Waypoint { .. } | Self::Return | Self::Land { .. }
        )
    }

    /// Whether the vehicle has to be at rest for it.
    pub fn needs_rest(&self) -> bool {
        matches!(self, Self::Photo | Self::Delay(_))
    }
}

/// Why an item is refused: the field and what is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal {
    /// The field, in a human's words.
    pub field: &'static str,
    /// What is wrong.
    pub reason: Reason,
}

/// What is wrong with a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// The command is not flown by this vehicle.
    Command(u16),
    /// The frame is not understood.
    Frame(u8),
    /// The value is not a number.
    NotANumber,
    /// The value is outside a range.
    Range {
        /// The value.
        value: f32,
        /// Smallest that is flown.
        min: f32,
        /// Largest that is flown.
        max: f32,
    },
    /// The place is further from home than the vehicle may fly, m.
    Distance {
        /// How far it is.
        value: f32,
        /// How far it may be.
        max: f32,
    },
    /// There is nothing to fly to.
    NoWaypoint,
    /// The item is not in storage, though the mission should have it.
    Missing,
    /// There are more items than the vehicle stores.
    TooMany(usize),
    /// The jump leads out of the mission, or there are more jumps than can be counted.
    Jump,
    /// The way there is not inside the fence from end to end.
    Fence,
}

/// Written piece by piece, since it goes by radio too: the standard way takes more flash.
impl fmt::Display for Refusal {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.field)?;
        f.write_str(": ")?;
        let end = match self.reason {
            Reason::Command(command) => {
                Whole(command.into()).fmt(f)?;
                " is not flown by this vehicle"
            }
            Reason::Frame(frame) => {
                Whole(frame.into()).fmt(f)?;
                " is not understood; use 0, 3, 5 or 6"
            }
            Reason::NotANumber => "not a number",
            Reason::Range { value, min, max } => {
                Decimal::new(value).fmt(f)?;
                f.write_str(" is outside ")?;
                Decimal::new(min).fmt(f)?;
                f.write_str(" to ")?;
                return Decimal::new(max).fmt(f);
            }
            Reason::Distance { value, max } => {
                Decimal::rounded(value, 0).fmt(f)?;
                f.write_str(" m from home, the limit is ")?;
                Decimal::rounded(max, 0).fmt(f)?;
                " m"
            }
            Reason::NoWaypoint => "nothing to fly to; add a waypoint",
            Reason::Missing => "the item is missing",
            Reason::TooMany(count) => {
                Whole(count as u32).fmt(f)?;
                f.write_str(" items, the vehicle stores ")?;
                return Whole(super::item::MAX_ITEMS as u32).fmt(f);
            }
            Reason::Jump => "leads out of the mission, or is one jump too many",
            Reason::Fence => "leg leaves the geofence; move it or the fence",
        };
        f.write_str(end)
    }
}

/// What `item` asks for, or why it is not flown.
pub fn interpret(item: &MissionItem) -> Result<Action, Refusal> {
    let [p1, p2, p3, p4] = item.params;
    Ok(match item.command {
        command::NAV_TAKEOFF => Action::Takeoff {
            altitude: altitude(item)?,
        },
        command::NAV_WAYPOINT => Action::Waypoint {
            place: place(item)?,
            hold: range("hold time", unset_is_zero(p1), 0.0, 3600.0)?,
            acceptance_radius: optional("acceptance radius", positive(p2), 0.05, 1000.0)?,
            heading: heading(p4)?,
        },
        command::NAV_LOITER_TIME => Action::Waypoint {
            place: place(item)?,
            hold: range("loiter time", unset_is_zero(p1), 0.0, 3600.0)?,
            acceptance_radius: None,
            heading: None,
        },
        command::NAV_RETURN_TO_LAUNCH => Action::Return,
        command::NAV_LAND => Action::Land {
            place: landing(item)?,
        },
        command::NAV_DELAY => Action::Delay(delay(p1)?),
        command::CONDITION_DELAY => Action::Delay(range("delay", p1, 0.0, 3600.0)?),
        command::DO_JUMP => jump(p1, p2)?,
        command::DO_CHANGE_SPEED => Action::Speed(speed(p2)?),
        command::DO_SET_ROI_LOCATION => Action::LookAt(place(item)?),
        command::DO_SET_ROI if p1 == 3.0 => Action::LookAt(place(item)?),
        command::DO_SET_ROI if unset_is_zero(p1) == 0.0 => Action::LookAhead,
        command::DO_SET_ROI => {
            return Err(refuse(
                "region of interest mode",
                Reason::Range {
                    value: p1,
                    min: 3.0,
                    max: 3.0,
                },
            ));
        }
        command::DO_SET_ROI_NONE => Action::LookAhead,
        command::DO_DIGICAM_CONTROL => Action::Photo,
        command::DO_SET_CAM_TRIGG_DIST => Action::PhotoByDistance {
            distance: range("trigger distance", unset_is_zero(p1), 0.0, 10_000.0)?,
            at_once: p3 == 1.0,
        },
        command::IMAGE_START_CAPTURE => photos(p2, p3)?,
        command::IMAGE_STOP_CAPTURE => Action::PhotoStop,
        command::DO_MOUNT_CONTROL
        | command::SET_CAMERA_MODE
        | command::SET_CAMERA_ZOOM
        | command::SET_CAMERA_FOCUS
        | command::DO_GIMBAL_MANAGER_PITCHYAW
        | command::DO_GIMBAL_MANAGER_CONFIGURE
        | command::VIDEO_START_CAPTURE
        | command::VIDEO_STOP_CAPTURE => Action::PassOn,
        other => return Err(refuse("command", Reason::Command(other))),
    })
}

fn refuse(field: &'static str, reason: Reason) -> Refusal {
    Refusal { field, reason }
}

fn unset_is_zero(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value }
}

fn positive(value: f32) -> Option<f32> {
    // Unset, and the zero that stands for it; anything else has to be in range.
    (!value.is_nan() && value != 0.0).then_some(value)
}

fn range(field: &'static str, value: f32, min: f32, max: f32) -> Result<f32, Refusal> {
    if value.is_nan() {
        Err(refuse(field, Reason::NotANumber))
    } else if value < min || value > max {
        Err(refuse(field, Reason::Range { value, min, max }))
    } else {
        Ok(value)
    }
}

fn optional(field: &'static str, value: Option<f32>, min: f32, max: f32) -> Result<Option<f32>, Refusal> {
    value.map(|value| range(field, value, min, max)).transpose()
}

fn heading(degrees: f32) -> Result<Option<f32>, Refusal> {
    let degrees = optional("heading", (!degrees.is_nan()).then_some(degrees), -360.0, 360.0)?;
    Ok(degrees.map(|degrees| windhover_math::wrap_pi(degrees * (core::f32::consts::PI / 180.0))))
}

fn altitude(item: &MissionItem) -> Result<Altitude, Refusal> {
    // The core's own bound on numbers; how high the vehicle may fly is checked against a parameter.
    let metres = range("altitude", item.z, -100_000.0, 100_000.0)?;
    match item.frame {
        0 | 5 => Ok(Altitude::SeaLevel(metres)),
        3 | 6 => Ok(Altitude::Home(metres)),
        frame => Err(refuse("frame", Reason::Frame(frame))),
    }
}

/// The place of an item that has one.
pub(crate) fn place(item: &MissionItem) -> Result<Place, Refusal> {
    let altitude = altitude(item)?;
    degrees("latitude", item.x, 90)?;
    degrees("longitude", item.y, 180)?;
    Ok(Place {
        latitude: item.x,
        longitude: item.y,
        altitude,
    })
}

fn degrees(field: &'static str, value: i32, most: i32) -> Result<(), Refusal> {
    if (-most * 10_000_000..=most * 10_000_000).contains(&value) {
        return Ok(());
    }
    let (value, max) = (value as f32 * 1e-7, most as f32);
    Err(refuse(
        field,
        Reason::Range {
            value,
            min: -max,
            max,
        },
    ))
}

/// A landing place; both coordinates 0 or unset say "here".
fn landing(item: &MissionItem) -> Result<Option<Place>, Refusal> {
    let here = item.x == 0 && item.y == 0;
    if here {
        return Ok(None);
    }
    let grounded = MissionItem {
        z: unset_is_zero(item.z),
        ..*item
    };
    place(&grounded).map(Some)
}

fn delay(seconds: f32) -> Result<f32, Refusal> {
    // −1 asks for a time of day instead.
    range("delay", seconds, 0.0, 3600.0)
}

fn speed(value: f32) -> Result<Option<f32>, Refusal> {
    if value == -2.0 || value == -1.0 || value.is_nan() {
        return Ok(None);
    }
    range("speed", value, 0.1, 20.0).map(Some)
}

fn photos(interval: f32, count: f32) -> Result<Action, Refusal> {
    let count = unset_is_zero(count);
    // A part of a photo is not none, which goes on without an end.
    let least = if count == 0.0 { 0.0 } else { 1.0 };
    let count = range("number of photos", count, least, 65_535.0)? as u16;
    if count == 1 {
        return Ok(Action::Photo);
    }
    Ok(Action::PhotoByTime {
        interval: range("photo interval", unset_is_zero(interval), 0.1, 3600.0)?,
        count,
    })
}

fn jump(to: f32, times: f32) -> Result<Action, Refusal> {
    let to = range("jump target", to, 0.0, (super::item::MAX_ITEMS - 1) as f32)? as u16;
    let times = range("jump repeats", times, -1.0, 65_535.0)?;
    Ok(Action::Jump {
        to,
        times: (times >= 0.0).then_some(times as u16),
    })
}
