//! The report of a flight: one HTML file that opens anywhere and loads nothing.
//!
//! Fill in a [`Report`], write what [`html`] returns. The plots are built by the crate `plotly`,
//! whose script stands in the file; a content security policy forbids the page to load anything.

mod curve;
mod page;
mod plots;

pub use page::html;

/// North, east and down in m (or m/s).
pub type Ned = [f32; 3];

/// Everything that a report shows. NaN anywhere is a gap, not an error.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The heading of the page, such as the mission's name.
    pub title: String,
    /// One sentence under it: how the flight ended.
    pub subtitle: String,
    /// Under which conditions was flown, name and value.
    pub conditions: Vec<(String, String)>,
    /// The figures of the flight.
    pub figures: Vec<Figure>,
    /// The path wanted, corner by corner.
    pub path: Vec<Ned>,
    /// The flight in the order of time, as densely as it is known; thinned out for drawing.
    pub samples: Vec<Sample>,
    /// The photos taken.
    pub photos: Vec<PhotoMark>,
    /// What happened on the way: pushes, faults, a divergence.
    pub events: Vec<Event>,
}

/// One figure of a flight.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// What it is.
    pub label: String,
    /// Its value, rounded as it is to be read.
    pub value: String,
    /// Its unit, or nothing.
    pub unit: String,
}

/// One instant of a flight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// Since the start, in s.
    pub time: f32,
    /// Position in m.
    pub position: Ned,
    /// Position wanted at this instant, in m.
    pub position_setpoint: Ned,
    /// Velocity in m/s.
    pub velocity: Ned,
    /// Roll, pitch and yaw in degrees.
    pub attitude: [f32; 3],
    /// Roll, pitch and yaw wanted, in degrees.
    pub attitude_setpoint: [f32; 3],
    /// Speed of each rotor in rad/s.
    pub rotor_speed: [f32; 4],
    /// Velocity of the air over the ground in m/s.
    pub wind: Ned,
}

/// One photo.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhotoMark {
    /// When, in s since the start.
    pub time: f32,
    /// Where, in m.
    pub position: Ned,
    /// Distance from the point that was to be photographed from, in m.
    pub position_error: f32,
    /// Speed in m/s.
    pub speed: f32,
    /// Angle between the vehicle's axis and the vertical, in degrees.
    pub tilt: f32,
}

/// Something that happened at a time.
#[derive(Clone, Debug, Default)]
pub struct Event {
    /// When, in s since the start.
    pub time: f32,
    /// What.
    pub text: String,
}
