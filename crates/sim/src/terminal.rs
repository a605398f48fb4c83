//! What the programs share at the terminal: vehicles by name or file, a bar while they fly, lines, and
//! being stopped.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use windhover_model::Vehicle;

/// A vehicle by its name, or from a file. The error is one line that names the option or the file.
pub fn read_vehicle(name: &str) -> Result<Vehicle, String> {
    let is_file = name.ends_with(".toml") || name.contains(std::path::MAIN_SEPARATOR);
    if !is_file {
        return Vehicle::named(name).map_err(|e| format!("--vehicle: {e}"));
    }
    let text = std::fs::read_to_string(name).map_err(|e| format!("{name}: {e}"))?;
    Vehicle::from_toml(&text).map_err(|e| format!("{name}: {e}"))
}

/// A line on stdout at once, also into a pipe.
pub fn say(text: &str) {
    let mut out = std::io::stdout().lock();
    // Nobody reads any more: that is no reason to fall from the sky.
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}

/// Is set once the program is asked to end, by Ctrl-C or by a signal to terminate. The error is one
/// line.
pub fn until_interrupted() -> Result<Arc<AtomicBool>, String> {
    let stop = Arc::new(AtomicBool::new(false));
    let asked = Arc::clone(&stop);
    // A second one ends it at once, should the first not do.
    ctrlc::set_handler(move || {
        if asked.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .map_err(|e| format!("Ctrl-C cannot be heard: {e}"))?;
    Ok(stop)
}

/// A bar on stderr that is told the share of a flight that is done.
pub struct FlightBar(ProgressBar);

impl FlightBar {
    /// Steps of the whole bar.
    const LENGTH: f64 = 1000.0;

    /// A bar at its beginning; one that is not drawn where it is to be `quiet`.
    pub fn new(quiet: bool) -> Self {
        let target = if quiet {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(Self::LENGTH as u64), target);
        if let Ok(style) = ProgressStyle::with_template("flying {bar:40} {percent}%  {elapsed}") {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// So much is done, 0 to 1.
    pub fn show(&self, share: f64) {
        self.0.set_position((share * Self::LENGTH) as u64);
    }

    /// Takes the bar away.
    pub fn finish(self) {
        self.0.finish_and_clear();
    }
}
