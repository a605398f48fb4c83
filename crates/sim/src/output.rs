//! What a flight leaves behind: figures to read, and files.

use std::fmt::Write;
use std::path::PathBuf;

use windhover_sim::figures::{Axes, Figures};
use windhover_sim::flight::Flight;
use windhover_sim::report::{self, Figure, Report};

use crate::options::{Fly, Request};

/// Writes report.html and figures.json; where the report is.
pub fn write(fly: &Fly, request: &Request, flight: &Flight) -> Result<PathBuf, String> {
    let folder = fly.folder(&request.mission_name);
    let page = folder.join("report.html");
    let write = |path: &PathBuf, text: String| {
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
    };
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    write(&page, report::html(&report(request, flight)))?;
    write(&folder.join("figures.json"), json(&flight.figures) + "\n")?;
    Ok(page)
}

/// The figures as one JSON object.
pub fn json(figures: &Figures) -> String {
    // Figures are plain numbers and texts: this cannot fail.
    serde_json::to_string(figures).unwrap_or_default()
}

/// The figures as a table.
pub fn text(request: &Request, flight: &Flight, report: &std::path::Path) -> String {
    let mut text = String::new();
    for note in &request.mission.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let rows = rows(&flight.figures);
    let width = rows
        .iter()
        .map(|row| row.label.chars().count())
        .max()
        .unwrap_or(0);
    for Figure { label, value, unit } in rows {
        let _ = writeln!(text, "{label:width$}  {value} {unit}");
    }
    let _ = writeln!(text, "report: {}", report.display());
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
        row("cross-track RMSE", format!("{:.3}", f.cross_track_rmse_m), "m"),
        row("largest tilt", format!("{:.1}", f.tilt_max_deg), "°"),
        row(
            "rotors saturated",
            format!("{:.2}", f.saturated_fraction * 100.0),
            "% of the time",
        ),
        row("energy", format!("{:.0}", f.energy_j), "J"),
        row("speed", format!("{:.0}", f.speed_factor), "× real time"),
        row("motor hash", f.motor_hash.clone(), ""),
        row("seed", f.seed.to_string(), ""),
    ]);
    rows
}

fn report(request: &Request, flight: &Flight) -> Report {
    let setup = &request.setup;
    let name = request.mission_name.file_stem().unwrap_or("mission".as_ref());
    let wind = &setup.conditions.wind;
    let mut conditions = vec![
        ("Mission".to_string(), request.mission_name.display().to_string()),
        ("Vehicle".to_string(), setup.vehicle.name.clone()),
        ("Preset".to_string(), request.preset.clone()),
        ("Model".to_string(), request.model.clone()),
        (
            "Wind towards".to_string(),
            format!("{:.2} m/s north, {:.2} m/s east", wind.x, wind.y),
        ),
        ("Gusts".to_string(), format!("{} m/s", setup.conditions.gust)),
        (
            "Payload".to_string(),
            format!("{} kg", setup.conditions.payload.mass()),
        ),
    ];
    conditions.extend(
        request
            .mission
            .notes
            .iter()
            .map(|note| ("Note".to_string(), note.clone())),
    );
    Report {
        title: name.to_string_lossy().into_owned(),
        subtitle: flight.figures.ended.clone(),
        conditions,
        figures: rows(&flight.figures)
            .into_iter()
            .map(|row| Figure {
                label: row.label.trim().into(),
                ..row
            })
            .collect(),
        path: flight.path.clone(),
        samples: flight.samples.clone(),
        photos: flight.photos.clone(),
        events: flight.events.clone(),
    }
}
