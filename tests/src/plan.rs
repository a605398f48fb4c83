//! Missions written in metres from home.

use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::mission::action::command;
use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_sim::mission_file::MissionFile;

/// Where our missions begin.
pub const HOME: GlobalPosition = GlobalPosition {
    latitude: 473_977_419,
    longitude: 85_455_938,
    altitude: 488_000,
};

/// Unset, as MAVLink writes it.
pub const UNSET: f32 = f32::NAN;

/// An item without a place.
pub fn item(command: u16, params: [f32; 4]) -> MissionItem {
    MissionItem {
        command,
        frame: 2,
        autocontinue: true,
        params,
        x: 0,
        y: 0,
        z: 0.0,
    }
}

/// An item at a place: metres north and east of home, and above it.
pub fn item_at(command: u16, params: [f32; 4], north: f32, east: f32, height: f32) -> MissionItem {
    let place = LocalFrame::new(HOME).to_global(Vector3::new(north, east, 0.0));
    MissionItem {
        frame: 3,
        x: place.latitude,
        y: place.longitude,
        z: height,
        ..item(command, params)
    }
}

/// A mission as it grows, item by item.
#[derive(Clone, Debug, Default)]
pub struct Plan(Vec<MissionItem>);

impl Plan {
    /// No item yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds any item.
    pub fn with(mut self, item: MissionItem) -> Self {
        self.0.push(item);
        self
    }

    /// Adds an item without a place.
    pub fn then(self, command: u16, params: [f32; 4]) -> Self {
        self.with(item(command, params))
    }

    /// Climb to `height`.
    pub fn takeoff(self, height: f32) -> Self {
        self.with(item_at(
            command::NAV_TAKEOFF,
            [0.0, 0.0, 0.0, UNSET],
            0.0,
            0.0,
            height,
        ))
    }

    /// A waypoint with hold time (s) and acceptance radius (m, 0: the default).
    pub fn waypoint(self, hold: f32, radius: f32, north: f32, east: f32, height: f32) -> Self {
        let params = [hold, radius, 0.0, UNSET];
        self.with(item_at(command::NAV_WAYPOINT, params, north, east, height))
    }

    /// One photo at rest.
    pub fn photo(self) -> Self {
        self.then(command::IMAGE_START_CAPTURE, [0.0, 0.0, 1.0, 0.0])
    }

    /// From here on at this speed, m/s.
    pub fn speed(self, speed: f32) -> Self {
        self.then(command::DO_CHANGE_SPEED, [1.0, speed, -1.0, 0.0])
    }

    /// Home, and down.
    pub fn home(self) -> Self {
        self.then(command::NAV_RETURN_TO_LAUNCH, [0.0; 4])
    }

    /// Down, where it is.
    pub fn land(self) -> Self {
        self.then(command::NAV_LAND, [0.0; 4])
    }

    /// The mission.
    pub fn file(self) -> MissionFile {
        let mut file = MissionFile::default();
        file.items = self.0;
        file.home = Some((HOME.latitude, HOME.longitude, HOME.altitude));
        file
    }
}

/// A short mission with everything in it: a stop with a photo, a corner that is cut, a climb, and
/// a landing. About half a minute.
pub fn short() -> MissionFile {
    Plan::new()
        .takeoff(4.0)
        .waypoint(0.0, 0.5, 6.0, 0.0, 5.0)
        .photo()
        .waypoint(0.0, 2.0, 6.0, 8.0, 6.0)
        .waypoint(1.0, 0.5, -2.0, 8.0, 5.0)
        .land()
        .file()
}
