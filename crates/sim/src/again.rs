//! `windhover replay`: a log's inputs through the core again.

use std::time::Instant;

use windhover_autopilot::Parameters;
use windhover_flight_log::reader::Log;
use windhover_sim::replay::{self, Change};

use crate::options::{Replay, Setting};
use crate::output;

/// Replays a log and says how that went; whether every output was equal.
pub fn replay(asked: &Replay) -> Result<bool, String> {
    let name = asked.log.display();
    let bytes = output::read(&asked.log)?;
    let log = Log::open(&bytes).map_err(|e| format!("{name}: {e}"))?;
    if !asked.with.is_empty() {
        let change = replay::with_parameters(&log, |parameters| apply(asked, parameters));
        print!("{}", tell(asked, &change.map_err(|e| format!("{name}: {e}"))?));
        return Ok(true);
    }
    let start = Instant::now();
    let outcome = replay::replay(&log).map_err(|e| format!("{name}: {e}"))?;
    let speed = outcome.seconds / windhover_math::max(start.elapsed().as_secs_f64(), 1e-9);
    if let Some(difference) = &outcome.difference {
        println!("differs: {difference}");
        return Ok(false);
    }
    let (seconds, ticks, compared) = (outcome.seconds, outcome.ticks, outcome.compared);
    println!("equal: {seconds:.3} s, {ticks} ticks, {compared} motor commands; {speed:.0} x real time");
    if let Some(tick) = outcome.missing_from {
        println!("inputs missing from tick {tick}: replay ends there");
    }
    if let Some(cut) = &outcome.cut {
        println!("{cut}: replay ends there");
    }
    Ok(true)
}

fn apply(asked: &Replay, parameters: &mut Parameters) {
    for setting in &asked.with {
        // Checked when the command line was read.
        let _ = parameters.set(setting.index, setting.value);
    }
}

fn tell(asked: &Replay, change: &Change) -> String {
    let settings: Vec<String> = asked.with.iter().map(Setting::to_string).collect();
    let percent = |share: f64| share * 100.0;
    let changed = change.changed as f64 / windhover_math::max(change.commands, 1) as f64;
    format!(
        "with {}, open loop (the vehicle moves as it did):\n\
         rotor commands that differ  {:.1} % of {}\n\
         RMS difference              {:.3} % of full command\n\
         largest difference          {:.3} % of full command, at {:.3} s\n",
        settings.join(", "),
        percent(changed),
        change.commands,
        percent(change.rms),
        percent(change.largest),
        change.largest_time,
    )
}
