//! What a flight leaves behind: figures to read, and files.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use windhover_flight_log::reader::Log;
use windhover_sim::figures::{Axes, Figures};
use windhover_sim::flight::{Flight, Setup};
use windhover_sim::flight_log::FlightLog;
use windhover_sim::flight_report;
use windhover_sim::report::{self, Event, Figure, Report};

use crate::options::{Fly, Request, Words};

/// What a flight left on disk.
pub struct Files {
    /// The log.
    pub log: PathBuf,
    /// The report, made from the log.
    pub report: PathBuf,
    /// What happened on the way, as the report tells it.
    pub events: Vec<Event>,
}

/// Writes flight.ulg, report.html and figures.json.
pub fn write(fly: &Fly, request: &Request, flight: &Flight, log: FlightLog) -> Result<Files, String> {
    let folder = fly.folder(&request.mission_name);
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let log_name = folder.join("flight.ulg");
    let report_name = folder.join("report.html");
    let mut rows = rows(&flight.figures);
    rows.push(row("ended", flight.figures.ended.clone(), ""));
    let bytes = log.finish(&rows, &flight.events);
    save(&log_name, &bytes)?;
    let name = request.mission_name.file_stem().unwrap_or("mission".as_ref());
    let report = report_of(&bytes, &name.to_string_lossy(), &log_name)?;
    save(&report_name, report::html(&report).as_bytes())?;
    save(
        &folder.join("figures.json"),
        (json(&flight.figures) + "\n").as_bytes(),
    )?;
    Ok(Files {
        log: log_name,
        report: report_name,
        events: report.events,
    })
}

/// Writes the report of a log beside it, or where `out` says; where that is.
pub fn report(log: &Path, out: Option<&Path>) -> Result<PathBuf, String> {
    let bytes = read(log)?;
    let title = log.file_stem().unwrap_or("flight".as_ref()).to_string_lossy();
    let to = out.map_or_else(|| log.with_extension("html"), Path::to_path_buf);
    save(&to, report::html(&report_of(&bytes, &title, log)?).as_bytes())?;
    Ok(to)
}

/// A file, whole.
pub fn read(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn save(path: &Path, bytes: &[u8]) -> Result<(), String> {
    std::fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}

fn report_of(bytes: &[u8], title: &str, name: &Path) -> Result<Report, String> {
    let log = Log::open(bytes).map_err(|e| format!("{}: {e}", name.display()))?;
    Ok(flight_report::report(&log, title))
}

/// The conditions of a flight, for people.
pub fn conditions(request: &Request) -> Vec<(String, String)> {
    let mission = request.mission_name.display().to_string();
    let mut all = vec![("Mission".to_owned(), mission)];
    all.extend(world(&request.setup, &request.words));
    let notes = request.mission.notes.iter();
    all.extend(notes.map(|note| ("Note".to_owned(), note.clone())));
    all
}

/// The vehicle and its world, for people.
pub fn world(setup: &Setup, words: &Words) -> Vec<(String, String)> {
    let wind = &setup.conditions.wind;
    let mut conditions = vec![
        ("Vehicle", setup.vehicle.name.clone()),
        ("Preset", words.preset.clone()),
        ("Model", words.model.clone()),
        ("Flown on", flown_on(setup)),
        (
            "Wind towards",
            format!("{:.2} m/s north, {:.2} m/s east", wind.x, wind.y),
        ),
        ("Gusts", format!("{} m/s", setup.conditions.gust)),
        ("Payload", format!("{} kg", setup.conditions.payload.mass())),
        ("Seed", setup.conditions.seed.to_string()),
    ];
    conditions.extend(setup.sensors.iter().flat_map(|sensors| {
        let remote = sensors
            .remote
            .then(|| ("Remote control", "sticks at rest".into()));
        let charge = sensors
            .charge
            .map(|charge| ("Battery", format!("{:.0} %", charge * 100.0)));
        [remote, charge].into_iter().flatten()
    }));
    conditions.extend(words.set.iter().map(|set| ("Set", set.clone())));
    conditions
        .into_iter()
        .map(|(name, value)| (name.to_string(), value))
        .collect()
}

fn flown_on(setup: &Setup) -> String {
    match &setup.sensors {
        None => "the truth".into(),
        Some(sensors) => format!(
            "sensors, receiver {}",
            format!("{:?}", sensors.receiver).to_lowercase()
        ),
    }
}

/// The figures as one JSON object.
pub fn json(figures: &Figures) -> String {
    // Figures are plain numbers and texts: this cannot fail.
    serde_json::to_string(figures).unwrap_or_default()
}

/// The figures as a table.
pub fn text(request: &Request, flight: &Flight, files: &Files) -> String {
    let mut text = String::new();
    for note in &request.mission.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text.push_str(&events(files));
    let rows = rows(&flight.figures);
    let width = rows
        .iter()
        .map(|row| row.label.chars().count())
        .max()
        .unwrap_or(0);
    for Figure { label, value, unit } in rows {
        let _ = writeln!(text, "{label:width$}  {value} {unit}");
    }
    let _ = writeln!(text, "log: {}", files.log.display());
    let _ = writeln!(text, "report: {}", files.report.display());
    text
}

/// What happened on the way, a line each.
fn events(files: &Files) -> String {
    const MOST: usize = 40;
    let all = &files.events;
    let mut text = String::new();
    for event in all.iter().take(MOST) {
        let _ = writeln!(text, "{:7.1} s  {}", event.time, event.text);
    }
    if all.len() > MOST {
        let _ = writeln!(
            text,
            "{:9}  and {} more: {}",
            "",
            all.len() - MOST,
            files.report.display()
        );
    }
    text.push('\n');
    text
}

fn axes(axes: &Axes) -> String {
    format!("{:.3} / {:.3} / {:.3}", axes.north, axes.east, axes.down)
}

fn row(label: &str, value: String, unit: &str) -> Figure {
    Figure {
        label: label.into(),
        value,
        unit: unit.into(),
    }
}

/// How far off the vehicle believed itself to be, where it flew on sensors.
fn beliefs(f: &Figures) -> impl Iterator<Item = Figure> {
    let position = |label, value: &Option<Axes>| value.as_ref().map(|value| row(label, axes(value), "m"));
    let angle = |label, value: Option<f64>| value.map(|value| row(label, format!("{value:.2}"), "°"));
    [
        position("  receiver's error", &f.gnss_rmse_m),
        position("  estimate's error", &f.estimate_rmse_m),
        angle("  roll and pitch error", f.attitude_rmse_deg),
        angle("  heading error", f.heading_rmse_deg),
    ]
    .into_iter()
    .flatten()
}

fn rows(f: &Figures) -> Vec<Figure> {
    let worst = |value: fn(&windhover_sim::figures::Photo) -> f64| {
        f.photos
            .iter()
            .filter(|photo| photo.stop)
            .map(value)
            .fold(0.0, windhover_math::max)
    };
    let mut rows = vec![
        row(
            "completed",
            if f.completed {
                "yes".into()
            } else {
                format!("no: {}", f.ended)
            },
            "",
        ),
        row("duration", format!("{:.1}", f.duration_s), "s"),
        row("waypoints reached", f.waypoints_reached.to_string(), ""),
        row("photos", f.photos.len().to_string(), ""),
    ];
    if f.photos.iter().any(|photo| photo.stop) {
        rows.push(row(
            "  worst position error",
            format!("{:.3}", worst(|p| p.position_error_m)),
            "m",
        ));
        rows.push(row(
            "  worst speed",
            format!("{:.3}", worst(|p| p.speed_m_s)),
            "m/s",
        ));
        rows.push(row("  worst tilt", format!("{:.1}", worst(|p| p.tilt_deg)), "°"));
    }
    rows.extend([
        row("RMSE north / east / down", axes(&f.rmse_m), "m"),
        row("largest error", axes(&f.max_error_m), "m"),
    ]);
    rows.extend(beliefs(f));
    rows.extend([
        row("cross-track RMSE", format!("{:.3}", f.cross_track_rmse_m), "m"),
        row("largest tilt", format!("{:.1}", f.tilt_max_deg), "°"),
        row(
            "rotors saturated",
            format!("{:.2}", f.saturated_fraction * 100.0),
            "% of the time",
        ),
        row("energy", format!("{:.0}", f.energy_j), "J"),
        row("speed", format!("{:.0}", f.speed_factor), "× real time"),
        row(
            "log",
            format!("{:.1}", f.log_bytes_per_s / 1000.0),
            "kB/s on a board",
        ),
        row("motor hash", f.motor_hash.clone(), ""),
        row("seed", f.seed.to_string(), ""),
    ]);
    rows
}
