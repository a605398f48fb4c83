//! The table of failsafes.

use windhover_autopilot::supervisor::Override;
use windhover_autopilot::supervisor::row::Watched;
use windhover_autopilot::{Parameters, Row};
use windhover_parameters::Declaration;

use super::{columns, markdown, row, value};

/// The page's head.
const HEAD: &str = "\
# Failsafes

What the vehicle watches while it is armed, and what it does by itself about it. The condition of a row
has to last for the time under *after*, and to be gone for the time under *ends after*. Of the rows that
are active the one acts that does most; of several that do the same, the first in the table. It is named
in the log, to the ground station, in the report and by `windhover fly`.

Actions in the order of severity: **warn**; **hold** (level at height and heading, where the position is
not known); **return** (to the nearest rally point or home, and land there); **land** here; **descend**
(level and down, without a position); **terminate** (motors off). A failsafe never makes a worse one
milder. An action that needs a position falls back to level flight, and then to a descent, where there is
none. On the ground, rows that are watched there disarm from *hold* on.

*Who may override*: an operator by choosing any mode, a pilot by choosing one that sticks fly (stabilize,
altitude, position), or nobody. Where a row *resumes*, the mode that was interrupted goes on when it is
over; elsewhere somebody has to choose it.

Parameters in brackets set what stands before them; the table shows their defaults, and
[parameters](parameters.md) tells their values. Some conditions have a time or a threshold of their own:
`COM_RC_LOSS_T`, `COM_POS_LOST_T`, `COM_OF_LOSS_T`, `FD_FAIL_TILT`, `FD_FAIL_HEIGHT` (which of the two
rows on tumbling it is), `BAT_LOW_THR`, `BAT_CRIT_THR`, `BAT_EMERGEN_THR`, `COM_RANGE_MARGIN`, and all of
`GF_`.

To try one on the desktop: `windhover fly --rc --fault rc-dropout@60 --set NAV_RCL_ACT=3`, or
`--battery 40 --set BAT_CRIT_THR=0.3`, or `--fault gnss-dropout@60`; `windhover faults` lists what can fail.

This page is written by `windhover failsafes --markdown` from the table that the supervisor works by.

";

/// Where a row's words stand.
const COLUMNS: [&str; 8] = [
    "name",
    "what the pilot is told",
    "after",
    "ends after",
    "watched",
    "action",
    "who may override",
    "resumes",
];

/// The table as text.
pub fn failsafes() -> String {
    let mut rows = vec![named()];
    rows.extend(Row::ALL.iter().map(|row| cells(row.watched(), "")));
    // The sentence is the longest: last.
    for row in &mut rows {
        row[1..].rotate_left(1);
    }
    columns(&rows)
}

/// The page `docs/failsafes.md`.
pub fn failsafes_page() -> String {
    let mut rows = vec![named()];
    rows.extend(Row::ALL.iter().map(|row| cells(row.watched(), "`")));
    format!("{HEAD}{}", markdown(&rows))
}

fn named() -> Vec<String> {
    row(COLUMNS)
}

fn cells(watched: &Watched, quote: &str) -> Vec<String> {
    let defaults = Parameters::default();
    let after = match (watched.after)(&defaults) {
        0.0 => "at once".into(),
        seconds => format!("{} s", value(seconds)),
    };
    let after = after + &set_by(|parameters| (watched.after)(parameters), quote);
    let action = (watched.action)(&defaults).name().to_string();
    let action = action + &set_by(|parameters| (watched.action)(parameters) as u8, quote);
    let clears = match watched.clears {
        0.0 => "at once".into(),
        seconds => format!("{} s", value(seconds)),
    };
    row([
        &format!("{quote}{}{quote}", watched.name),
        watched.text,
        &after,
        &clears,
        if watched.on_ground {
            "when armed"
        } else {
            "in flight"
        },
        &action,
        match watched.yields_to {
            Override::Operator => "operator",
            Override::Pilot => "pilot",
            Override::Nobody => "nobody",
        },
        if watched.resumes { "yes" } else { "no" },
    ])
}

/// The parameters that something depends on, found out by trying all.
fn set_by<T: PartialEq>(something: impl Fn(&Parameters) -> T, quote: &str) -> String {
    let usual = something(&Parameters::default());
    let depends = |index: usize, declaration: &Declaration| {
        const STEPS: u8 = 12;
        (0..=STEPS).any(|step| {
            let share = f32::from(step) / f32::from(STEPS);
            let mut parameters = Parameters::default();
            let tried = declaration.min + share * (declaration.max - declaration.min);
            parameters.set(index, tried).is_ok() && something(&parameters) != usual
        })
    };
    let all = Parameters::declarations().enumerate();
    let names = all.filter(|(index, declaration)| depends(*index, declaration));
    let names: Vec<String> = names
        .map(|(_, declaration)| format!("{quote}{}{quote}", declaration.name))
        .collect();
    if names.is_empty() {
        return String::new();
    }
    format!(" ({})", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_in_the_table_with_the_parameters_that_set_it() {
        let page = failsafes_page();
        for row in Row::ALL {
            assert!(page.contains(&format!("| `{}` |", row.watched().name)));
        }
        let line = |name: &str| {
            let text = failsafes();
            text.lines()
                .find(|line| line.starts_with(name))
                .unwrap()
                .to_string()
        };
        assert!(line("rc_lost ").contains("return (NAV_RCL_ACT)"));
        assert!(line("station_lost ").contains("10 s (COM_DL_LOSS_T)"));
        assert!(line("fence ").contains("hold (GF_ACTION)"));
        assert!(line("imu_missing ").contains("  terminate  "));
    }

    /// The names of parameters and faults that the head gives are such.
    #[test]
    fn the_head_names_what_there_is() {
        let code = HEAD.split('`').skip(1).step_by(2);
        let words = code.flat_map(|code| code.split([' ', '=']));
        let is_name = |word: &&str| {
            let is_of_names = |b: u8| b.is_ascii_uppercase() || b == b'_';
            word.contains('_') && !word.ends_with('_') && word.bytes().all(is_of_names)
        };
        for word in words.filter(is_name) {
            assert!(Parameters::find(word).is_some(), "{word}");
        }
        let faults = windhover_model::sensor::fault::SensorFault::all();
        for fault in ["rc-dropout", "gnss-dropout"] {
            assert!(
                HEAD.contains(fault) && faults.iter().any(|known| known.name == fault),
                "{fault}"
            );
        }
    }
}
