//! The plots of a report, as data for the drawing library.

mod path;
mod time;

use plotly::common::{Anchor, DashType, Font, Line, Marker, MarkerSymbol, Orientation};
use plotly::layout::{Legend, Margin};
use plotly::{Configuration, Layout, Plot};

pub(super) use path::{from_above, in_space};
pub(super) use time::all as over_time;

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

/// A plot, and how to speak of it.
pub(super) struct Drawing {
    /// Its name within the page.
    pub id: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What it shows, for those who do not see it.
    pub alt: &'static str,
    /// Height in pixels.
    pub height: usize,
    /// Whether its horizontal axis is the time.
    pub over_time: bool,
    pub plot: Plot,
}

/// How a line is drawn.
fn line(style: usize) -> Line {
    let dash = DASHES[style].clone();
    Line::new().color(COLOURS[style]).dash(dash).width(1.6)
}

/// How a photo is drawn.
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

/// Fits the page's width, and carries no advertisement.
fn configured(mut plot: Plot) -> Plot {
    let configuration = Configuration::new();
    plot.set_configuration(configuration.responsive(true).display_logo(false));
    plot
}
