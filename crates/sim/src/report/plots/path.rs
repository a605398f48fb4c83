//! The path flown and the path wanted, in space and as a map.

use plotly::common::{Anchor, Mode, Position, Title};
use plotly::layout::{
    AspectMode, Axis, Camera, CameraCenter, DragMode3D, Eye, HoverMode, LayoutScene, Margin,
};
use plotly::{Plot, Scatter, Scatter3D};

use super::super::curve::{short, spaced};
use super::super::{Ned, Report};
use super::{Drawing, base, configured, legend, line, photo_marker};

/// Path flown and path wanted, in space.
pub(in super::super) fn in_space(report: &Report) -> Drawing {
    let flown: Vec<Ned> = report.samples.iter().map(|s| s.position).collect();
    let photos: Vec<Ned> = report.photos.iter().map(|p| p.position).collect();
    let trace = |points: &[Ned]| {
        let axis = |f: fn(&Ned) -> f32| points.iter().map(|p| short(f(p))).collect::<Vec<_>>();
        Scatter3D::new(axis(|p| p[1]), axis(|p| p[0]), axis(|p| -p[2]))
            .hover_template("%{y:.2f} m north<br>%{x:.2f} m east<br>%{z:.2f} m up")
    };
    let line = |style| line(style).width(4.0);
    let mut plot = Plot::new();
    for (style, name, points) in [(0, "flown", &flown), (1, "wanted", &report.path)] {
        let trace = trace(&spaced(points)).name(name).mode(Mode::Lines);
        plot.add_trace(trace.line(line(style)));
    }
    let photos = trace(&photos).name("photo").mode(Mode::Markers);
    plot.add_trace(photos.marker(photo_marker(5)));
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
        title: "Path in space",
        alt: "The path flown and the path wanted in space, with the photo stops",
        height,
        over_time: false,
        plot: configured(plot),
    }
}

/// Path flown and path wanted, as a map.
pub(in super::super) fn from_above(report: &Report) -> Drawing {
    let flown: Vec<Ned> = report.samples.iter().map(|s| s.position).collect();
    let photos: Vec<Ned> = report.photos.iter().map(|p| p.position).collect();
    let trace = |points: &[Ned]| {
        let axis = |f: fn(&Ned) -> f32| points.iter().map(|p| short(f(p))).collect::<Vec<_>>();
        Scatter::new(axis(|p| p[1]), axis(|p| p[0])).hover_template("%{y:.2f} m north<br>%{x:.2f} m east")
    };
    let mut plot = Plot::new();
    for (style, name, points) in [(0, "flown", &flown), (1, "wanted", &report.path)] {
        let trace = trace(&spaced(points)).name(name).mode(Mode::Lines);
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
        title: "Path from above",
        alt: "The path flown and the path wanted from above, with the photo stops numbered",
        height,
        over_time: false,
        plot: configured(plot),
    }
}
