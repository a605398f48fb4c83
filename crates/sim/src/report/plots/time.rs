//! What changed over time: panels above each other on one time axis.

use plotly::common::{Anchor, DashType, Font, Mode, Title};
use plotly::layout::{Annotation, Axis, HoverMode, Shape, ShapeLine, ShapeType};
use plotly::{Layout, Plot, Scatter, Trace};

use super::super::curve::{rows, short, spaced};
use super::super::{Report, Sample};
use super::{BELOW, Drawing, TOP, base, configured, line, photo_marker};

/// The most events that are drawn as lines.
const MOST_EVENTS: usize = 30;

/// Names of the lines by style, where flight and setpoint are compared.
const FLOWN: [&str; 2] = ["flown", "wanted"];
/// Names of the lines by style, where axes are.
const AXES: [&str; 3] = ["north", "east", "down"];

/// Some lines with their own vertical axis.
struct Panel {
    title: &'static str,
    lines: Vec<Column>,
    /// Where photos were taken: time and value.
    photos: Vec<(f32, f32)>,
}

/// One value of every sample, and the number of its style, which also names it.
type Column = (usize, Vec<f32>);

/// The plots over time, in the order of the page.
pub(in super::super) fn all(report: &Report) -> Vec<Drawing> {
    vec![
        coordinates(report),
        error(report),
        speed(report),
        attitude(report),
        rotors(report),
        wind(report),
    ]
}

fn coordinates(report: &Report) -> Drawing {
    // Height is down turned over.
    let panel = |title, axis: usize, sign: f32| {
        let photos = report.photos.iter();
        let photos = photos.map(|p| (p.time, sign * p.position[axis]));
        let lines = vec![
            column(report, 0, |s| sign * s.position[axis]),
            column(report, 1, |s| sign * s.position_setpoint[axis]),
        ];
        Panel {
            photos: photos.collect(),
            ..Panel::new(title, lines)
        }
    };
    let panels = vec![
        panel("North (m)", 0, 1.0),
        panel("East (m)", 1, 1.0),
        panel("Height (m)", 2, -1.0),
    ];
    Drawing {
        id: "coordinates",
        title: "Coordinates",
        alt: "North, east and height over time, flown and wanted",
        ..stack(report, &FLOWN, panels)
    }
}

fn error(report: &Report) -> Drawing {
    let line = |axis: usize| {
        let error = |s: &Sample| s.position[axis] - s.position_setpoint[axis];
        column(report, axis, error)
    };
    let lines = (0..3).map(line).collect();
    Drawing {
        id: "error",
        title: "Position error",
        alt: "Flown less wanted position over time: north, east and down",
        ..stack(report, &AXES, vec![Panel::new("Error (m)", lines)])
    }
}

fn speed(report: &Report) -> Drawing {
    let over_ground = |s: &Sample| libm::hypotf(s.velocity[0], s.velocity[1]);
    let lines = vec![
        column(report, 0, over_ground),
        column(report, 1, |s| -s.velocity[2]),
    ];
    let names = ["over ground", "climb"];
    Drawing {
        id: "speed",
        title: "Speed",
        alt: "Speed over ground and rate of climb over time",
        ..stack(report, &names, vec![Panel::new("Speed (m/s)", lines)])
    }
}

fn attitude(report: &Report) -> Drawing {
    let panel = |title, axis: usize| {
        let lines = vec![
            column(report, 0, |s| s.attitude[axis]),
            column(report, 1, |s| s.attitude_setpoint[axis]),
        ];
        Panel::new(title, lines)
    };
    let panels = vec![panel("Roll (°)", 0), panel("Pitch (°)", 1), panel("Yaw (°)", 2)];
    Drawing {
        id: "attitude",
        title: "Attitude",
        alt: "Roll, pitch and yaw over time, flown and wanted",
        ..stack(report, &FLOWN, panels)
    }
}

fn rotors(report: &Report) -> Drawing {
    let line = |rotor: usize| column(report, rotor, |s| s.rotor_speed[rotor]);
    let panels = vec![
        Panel::new("Speed (rad/s)", vec![line(0), line(1)]),
        Panel::new("Speed (rad/s)", vec![line(2), line(3)]),
    ];
    let names = ["rotor 1", "rotor 2", "rotor 3", "rotor 4"];
    Drawing {
        id: "rotors",
        title: "Rotor speeds",
        alt: "The speeds of the four rotors over time",
        ..stack(report, &names, panels)
    }
}

fn wind(report: &Report) -> Drawing {
    let line = |axis: usize| column(report, axis, |s| s.wind[axis]);
    let lines = (0..3).map(line).collect();
    Drawing {
        id: "wind",
        title: "Wind",
        alt: "The wind over time, as velocity of the air towards north, east and down",
        ..stack(report, &AXES, vec![Panel::new("Air (m/s)", lines)])
    }
}

impl Panel {
    fn new(title: &'static str, lines: Vec<Column>) -> Self {
        let photos = Vec::new();
        Self { title, lines, photos }
    }
}

fn column(report: &Report, style: usize, value: impl Fn(&Sample) -> f32) -> Column {
    (style, report.samples.iter().map(value).collect())
}

/// Panels above each other with one time axis, and one legend for all.
fn stack(report: &Report, names: &[&str], panels: Vec<Panel>) -> Drawing {
    const GAP: f64 = 0.05;
    let count = panels.len();
    let axes = if count == 1 { 220 } else { count * 150 };
    let height = TOP + axes + BELOW;
    let share = (1.0 + GAP) / count as f64;
    let time = time_axis(report).anchor(axis_name(count - 1));
    let mut layout = base(height).hover_mode(HoverMode::XUnified).x_axis(time);
    let mut plot = Plot::new();
    let mut in_legend = Vec::new();
    for (index, panel) in panels.into_iter().enumerate() {
        let top = 1.0 - share * index as f64;
        let bottom = (top - share + GAP).clamp(0.0, 1.0);
        let axis = Axis::new()
            .title(Title::with_text(panel.title))
            .hover_format(".2f")
            .domain(&[bottom, top.clamp(0.0, 1.0)]);
        layout = match index {
            0 => layout.y_axis(axis),
            1 => layout.y_axis2(axis),
            _ => layout.y_axis3(axis),
        };
        for trace in traces(report, &panel, index, names, &mut in_legend) {
            plot.add_trace(trace);
        }
    }
    plot.set_layout(with_events(layout, report));
    Drawing {
        id: "",
        title: "",
        alt: "",
        height,
        over_time: true,
        plot: configured(plot),
    }
}

/// The lines and photos of a panel; each name stands in the legend once.
fn traces(
    report: &Report,
    panel: &Panel,
    index: usize,
    names: &[&str],
    in_legend: &mut Vec<String>,
) -> Vec<Box<dyn Trace>> {
    let mut trace = |points: &[(f32, f32)], name: &str| {
        let new = !in_legend.iter().any(|seen| seen == name);
        in_legend.push(name.to_owned());
        let x = points.iter().map(|p| short(p.0)).collect();
        let y = points.iter().map(|p| short(p.1)).collect();
        Scatter::new(x, y)
            .name(name)
            .hover_template(hover(panel.title, name))
            .y_axis(axis_name(index))
            .legend_group(name)
            .show_legend(new)
    };
    let mut traces: Vec<Box<dyn Trace>> = Vec::new();
    let columns: Vec<&[f32]> = panel.lines.iter().map(|(_, c)| c.as_slice()).collect();
    let rows = rows(&columns);
    for (style, column) in &panel.lines {
        let point = |row: &usize| (report.samples[*row].time, column[*row]);
        let points: Vec<_> = rows.iter().map(point).collect();
        let trace = trace(&points, names[*style]).mode(Mode::Lines);
        traces.push(trace.line(line(*style)));
    }
    if !panel.photos.is_empty() {
        let trace = trace(&spaced(&panel.photos), "photo").mode(Mode::Markers);
        traces.push(trace.marker(photo_marker(7)));
    }
    traces
}

/// What is shown of a point under the pointer: "North flown 12.34 m".
fn hover(title: &str, name: &str) -> String {
    let (quantity, unit) = title.split_once(" (").unwrap_or((title, ""));
    let unit = unit.trim_end_matches(')');
    format!("{quantity} {name} %{{y:.2f}} {unit}<extra></extra>")
}

/// The time axis, the same for every plot.
fn time_axis(report: &Report) -> Axis {
    let axis = Axis::new()
        .title(Title::with_text("Time (s)"))
        .hover_format(".2f");
    match report.samples.as_slice() {
        [first, .., last] if first.time < last.time => axis.range(vec![short(first.time), short(last.time)]),
        _ => axis,
    }
}

/// The name of the n-th vertical axis, from 0.
fn axis_name(index: usize) -> String {
    match index {
        0 => "y".into(),
        _ => format!("y{}", index + 1),
    }
}

/// A dotted line for each event, numbered as in the list of events.
fn with_events(layout: Layout, report: &Report) -> Layout {
    let drawn = report.events.iter().enumerate();
    let drawn = drawn.filter(|(_, e)| e.time.is_finite()).take(MOST_EVENTS);
    let (mut shapes, mut numbers) = (Vec::new(), Vec::new());
    for (index, event) in drawn {
        let time = short(event.time);
        let dotted = ShapeLine::new().dash(DashType::Dot).width(1.0);
        shapes.push(
            Shape::new()
                .shape_type(ShapeType::Line)
                .x_ref("x")
                .y_ref("paper")
                .x0(time)
                .x1(time)
                .y0(0)
                .y1(1)
                .opacity(0.7)
                .line(dotted.color("#888888")),
        );
        numbers.push(
            Annotation::new()
                .x_ref("x")
                .y_ref("paper")
                .x(time)
                .y(1)
                .y_anchor(Anchor::Bottom)
                .show_arrow(false)
                .font(Font::new().size(11))
                .text((index + 1).to_string()),
        );
    }
    layout.shapes(shapes).annotations(numbers)
}
