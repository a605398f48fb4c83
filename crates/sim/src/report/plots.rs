//! The plots of a report, as data for the drawing library.

use plotly::common::{
    Anchor, DashType, Font, Line, Marker, MarkerSymbol, Mode, Orientation, Position, Title,
};
use plotly::layout::{
    Annotation, AspectMode, Axis, Camera, CameraCenter, DragMode3D, Eye, HoverMode, LayoutScene, Legend,
    Margin, Shape, ShapeLine, ShapeType,
};
use plotly::{Configuration, Layout, Plot, Scatter, Scatter3D};

use super::curve::{Curve, envelope, short, spaced};
use super::{Ned, Report, Sample};

/// Colours that stand out on white and on near-black, told apart by people who see no red or no
/// green; lines differ by their dashes too.
const COLOURS: [&str; 4] = ["#2b7bba", "#d9730d", "#2f9e6e", "#a05fc0"];
const DASHES: [DashType; 4] = [DashType::Solid, DashType::Dash, DashType::Dot, DashType::DashDot];

/// The colour of photos.
const PHOTO: &str = "#c0392b";

/// Pixels above, left of and right of the axes.
const TOP: usize = 22;
const LEFT: usize = 58;
const RIGHT: usize = 14;
/// Pixels below the axes: tick labels, title and a legend of two lines.
const BELOW: usize = 104;
/// Pixels from the axes down to the legend.
const TO_LEGEND: f64 = 60.0;

/// The most events that are drawn as lines.
const MOST_EVENTS: usize = 30;

/// A plot, and how to speak of it.
pub(super) struct Drawing {
    /// Its name within the page.
    pub id: &'static str,
    /// What it shows, for those who do not see it.
    pub alt: String,
    /// Height in pixels.
    pub height: usize,
    /// Whether its horizontal axis is the time.
    pub over_time: bool,
    pub plot: Plot,
}

/// Some lines over time with their own vertical axis.
struct Panel {
    title: &'static str,
    lines: Vec<TimeLine>,
    /// Where photos were taken.
    photos: Curve,
}

/// One line over time; its name and style are those of `styles` in [`over_time`].
struct TimeLine {
    style: usize,
    curve: Curve,
}

/// Path flown and path wanted, in space.
pub(super) fn path_in_space(report: &Report) -> Drawing {
    let flown: Vec<Ned> = report.samples.iter().map(|s| s.position).collect();
    let photos: Vec<Ned> = report.photos.iter().map(|p| p.position).collect();
    let trace = |points: &[Ned]| {
        let axis = |f: fn(&Ned) -> f32| points.iter().map(|p| short(f(p))).collect::<Vec<_>>();
        Scatter3D::new(axis(|p| p[1]), axis(|p| p[0]), axis(|p| -p[2]))
            .hover_template("%{y:.2f} m north<br>%{x:.2f} m east<br>%{z:.2f} m up")
    };
    let line = |style: usize, width: f64| {
        let dash = DASHES[style].clone();
        Line::new().color(COLOURS[style]).dash(dash).width(width)
    };
    let mut plot = Plot::new();
    plot.add_trace(
        trace(&spaced(&flown))
            .name("flown")
            .mode(Mode::Lines)
            .line(line(0, 4.0)),
    );
    plot.add_trace(
        trace(&report.path)
            .name("wanted")
            .mode(Mode::Lines)
            .line(line(1, 3.0)),
    );
    plot.add_trace(
        trace(&photos)
            .name("photo")
            .mode(Mode::Markers)
            .marker(photo_marker(5)),
    );
    let axis = |title: &str| Axis::new().title(Title::with_text(title)).n_ticks(5);
    let eye = Eye::new().x(-1.7).y(-1.7).z(1.1);
    let center = CameraCenter::new().z(-0.12);
    let scene = LayoutScene::new()
        .aspect_mode(AspectMode::Data)
        .drag_mode(DragMode3D::Turntable)
        .camera(Camera::new().eye(eye).center(center))
        .x_axis(axis("East (m)"))
        .y_axis(axis("North (m)"))
        .z_axis(axis("Up (m)"));
    let height = 520;
    let margin = Margin::new().left(0).right(0).top(0).bottom(40);
    let layout = base(height).scene(scene).margin(margin);
    let legend = legend(height, 0, 40, 8.0).x(0.5).x_anchor(Anchor::Center);
    plot.set_layout(layout.legend(legend));
    Drawing {
        id: "space",
        alt: "The path flown and the path wanted in space, with the photo stops".into(),
        height,
        over_time: false,
        plot: configured(plot),
    }
}

/// Path flown and path wanted, as a map.
pub(super) fn path_from_above(report: &Report) -> Drawing {
    let flown: Vec<Ned> = report.samples.iter().map(|s| s.position).collect();
    let photos: Vec<Ned> = report.photos.iter().map(|p| p.position).collect();
    let trace = |points: &[Ned]| {
        let axis = |f: fn(&Ned) -> f32| points.iter().map(|p| short(f(p))).collect::<Vec<_>>();
        Scatter::new(axis(|p| p[1]), axis(|p| p[0])).hover_template("%{y:.2f} m north<br>%{x:.2f} m east")
    };
    let mut plot = Plot::new();
    for (style, name, points) in [(0, "flown", spaced(&flown)), (1, "wanted", report.path.clone())] {
        let trace = trace(&points).name(name).mode(Mode::Lines);
        plot.add_trace(trace.line(line(style)));
    }
    let numbers = (1..=photos.len()).map(|n| n.to_string()).collect();
    plot.add_trace(
        trace(&photos)
            .name("photo")
            .mode(Mode::MarkersText)
            .text_array(numbers)
            .text_position(Position::TopRight)
            .marker(photo_marker(8)),
    );
    let height = 520;
    let north = Axis::new()
        .title(Title::with_text("North (m)"))
        .scale_anchor("x")
        .scale_ratio(1.0);
    let layout = base(height)
        .hover_mode(HoverMode::Closest)
        .x_axis(Axis::new().title(Title::with_text("East (m)")))
        .y_axis(north);
    plot.set_layout(layout);
    Drawing {
        id: "map",
        alt: "The path flown and the path wanted from above, with the photo stops numbered".into(),
        height,
        over_time: false,
        plot: configured(plot),
    }
}

/// The plots over time, in the order of the page.
pub(super) fn over_time_all(report: &Report) -> Vec<(&'static str, Drawing)> {
    let column = |style: usize, f: &dyn Fn(&Sample) -> f32| {
        let points = report.samples.iter().map(|s| (s.time, f(s)));
        let curve = envelope(points);
        TimeLine { style, curve }
    };
    // Flown and wanted, axis by axis; height is down turned over.
    let pair = |title, value: &dyn Fn(&Sample) -> f32, wanted: &dyn Fn(&Sample) -> f32| Panel {
        title,
        lines: vec![column(0, value), column(1, wanted)],
        photos: Curve::default(),
    };
    let position = |axis: usize, sign: f32, title| {
        let photos = report.photos.iter();
        Panel {
            photos: envelope(photos.map(|p| (p.time, sign * p.position[axis]))),
            ..pair(title, &move |s| sign * s.position[axis], &move |s| {
                sign * s.position_setpoint[axis]
            })
        }
    };
    let attitude = |axis: usize, title| {
        pair(title, &move |s| s.attitude[axis], &move |s| {
            s.attitude_setpoint[axis]
        })
    };
    let together = |title, lines: Vec<TimeLine>| {
        let photos = Curve::default();
        vec![Panel { title, lines, photos }]
    };
    let ned = |of: &dyn Fn(&Sample) -> Ned| (0..3).map(|i| column(i, &|s| of(s)[i])).collect();
    let error = |s: &Sample| core::array::from_fn(|i| s.position[i] - s.position_setpoint[i]);
    let ground_speed = |s: &Sample| libm::hypotf(s.velocity[0], s.velocity[1]);
    let flown = ["flown", "wanted"];
    let axes = ["north", "east", "down"];
    vec![
        (
            "Coordinates",
            over_time(
                report,
                "coordinates",
                "North, east and height over time, flown and wanted",
                &flown,
                vec![
                    position(0, 1.0, "North (m)"),
                    position(1, 1.0, "East (m)"),
                    position(2, -1.0, "Height (m)"),
                ],
            ),
        ),
        (
            "Position error",
            over_time(
                report,
                "error",
                "Flown less wanted position over time, north, east and down",
                &axes,
                together("Error (m)", ned(&error)),
            ),
        ),
        (
            "Speed",
            over_time(
                report,
                "speed",
                "Speed over ground and rate of climb over time",
                &["over ground", "climb"],
                together(
                    "Speed (m/s)",
                    vec![column(0, &ground_speed), column(1, &|s| -s.velocity[2])],
                ),
            ),
        ),
        (
            "Attitude",
            over_time(
                report,
                "attitude",
                "Roll, pitch and yaw over time, flown and wanted",
                &flown,
                vec![
                    attitude(0, "Roll (°)"),
                    attitude(1, "Pitch (°)"),
                    attitude(2, "Yaw (°)"),
                ],
            ),
        ),
        (
            "Rotor speeds",
            over_time(
                report,
                "rotors",
                "The speeds of the four rotors over time",
                &["rotor 1", "rotor 2", "rotor 3", "rotor 4"],
                together(
                    "Speed (rad/s)",
                    (0..4).map(|i| column(i, &|s| s.rotor_speed[i])).collect(),
                ),
            ),
        ),
        (
            "Wind",
            over_time(
                report,
                "wind",
                "The wind over time, as the velocity of the air: north, east and down",
                &axes,
                together("Air (m/s)", ned(&|s| s.wind)),
            ),
        ),
    ]
}

/// One plot over time: panels above each other with one time axis, and one legend for all.
fn over_time(report: &Report, id: &'static str, what: &str, names: &[&str], panels: Vec<Panel>) -> Drawing {
    const GAP: f64 = 0.05;
    let count = panels.len();
    let height = TOP + BELOW + if count == 1 { 220 } else { count * 150 };
    let share = (1.0 + GAP) / count as f64;
    let axis_name = |index: usize| match index {
        0 => "y".to_owned(),
        _ => format!("y{}", index + 1),
    };
    let mut time = Axis::new()
        .title(Title::with_text("Time (s)"))
        .anchor(axis_name(count - 1));
    if let [first, .., last] = report.samples.as_slice()
        && first.time < last.time
    {
        time = time.range(vec![short(first.time), short(last.time)]);
    }
    let mut layout = base(height).hover_mode(HoverMode::XUnified).x_axis(time);
    let mut plot = Plot::new();
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
        for TimeLine { style, curve } in panel.lines {
            let trace = Scatter::new(curve.x, curve.y)
                .name(names[style])
                .mode(Mode::Lines)
                .line(line(style))
                .y_axis(axis_name(index))
                .legend_group(names[style])
                .show_legend(index == 0);
            plot.add_trace(trace);
        }
        if !panel.photos.x.is_empty() {
            let trace = Scatter::new(panel.photos.x, panel.photos.y)
                .name("photo")
                .mode(Mode::Markers)
                .marker(photo_marker(7))
                .y_axis(axis_name(index))
                .legend_group("photo")
                .show_legend(index == 0);
            plot.add_trace(trace);
        }
    }
    plot.set_layout(with_events(layout, report));
    Drawing {
        id,
        alt: what.to_owned(),
        height,
        over_time: true,
        plot: configured(plot),
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

fn line(style: usize) -> Line {
    let dash = DASHES[style].clone();
    Line::new().color(COLOURS[style]).dash(dash).width(1.6)
}

fn photo_marker(size: usize) -> Marker {
    let marker = Marker::new().color(PHOTO).size(size);
    marker.symbol(MarkerSymbol::Diamond)
}

/// What every plot's layout has; colours of text and grid come from the page's style.
fn base(height: usize) -> Layout {
    let margin = Margin::new().left(LEFT).right(RIGHT).top(TOP).bottom(BELOW);
    Layout::new()
        .height(height)
        .margin(margin)
        .font(Font::new().size(12).family("system-ui, sans-serif"))
        .legend(legend(height, TOP, BELOW, TO_LEGEND))
}

/// A legend below the axes, `down` pixels.
fn legend(height: usize, top: usize, bottom: usize, down: f64) -> Legend {
    let axes = height.saturating_sub(top + bottom) as f64;
    Legend::new()
        .orientation(Orientation::Horizontal)
        .item_width(36)
        .x(0.0)
        .x_anchor(Anchor::Left)
        .y(-down / axes)
        .y_anchor(Anchor::Top)
}

fn configured(mut plot: Plot) -> Plot {
    let configuration = Configuration::new();
    plot.set_configuration(configuration.responsive(true).display_logo(false));
    plot
}
