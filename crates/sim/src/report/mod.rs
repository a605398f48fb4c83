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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Event {
    /// When, in s since the start.
    pub time: f32,
    /// What.
    pub text: String,
}

/// Events closer together than this are told as one, s: what a failsafe does comes with it.
const TOGETHER: f32 = 0.05;

/// Puts events in their order, and makes one of those that happened together. Of several modes at
/// once only the last one counts.
pub fn ordered(mut events: Vec<Event>) -> Vec<Event> {
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut told: Vec<(f32, Vec<String>)> = Vec::new();
    for Event { time, text } in events {
        match told.last_mut() {
            Some((first, texts)) if time - *first < TOGETHER => {
                let is_mode = |text: &String| text.starts_with("mode ");
                texts.retain(|before| !(is_mode(before) && is_mode(&text)));
                texts.push(text);
            }
            _ => told.push((time, vec![text])),
        }
    }
    let joined = told.into_iter().map(|(time, texts)| Event {
        time,
        text: texts.join("; "),
    });
    joined.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_happens_together_is_one_event_in_its_order() {
        let event = |time: f32, text: &str| Event {
            time,
            text: text.into(),
        };
        let told = ordered(vec![
            event(60.0, "failsafe"),
            event(3.0, "armed"),
            event(8.0, "mode hold"),
            event(8.01, "mode mission"),
            event(60.0, "mode return"),
            event(60.1, "landed"),
        ]);
        let expected = [
            event(3.0, "armed"),
            event(8.0, "mode mission"),
            event(60.0, "failsafe; mode return"),
            event(60.1, "landed"),
        ];
        assert_eq!(told, expected);
        assert_eq!(ordered(vec![event(f32::NAN, "a"), event(f32::NAN, "b")]).len(), 2);
    }
}
