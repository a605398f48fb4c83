//! The table of parameters.

use windhover_autopilot::Parameters;
use windhover_parameters::{Declaration, Section};

use super::{columns, markdown, row, value};

/// The page's head: how it is made, and how a parameter is set.
const HEAD: &str = "\
# Parameters

Every number that a user may set. A write outside the range is refused with the range; nothing but a
write changes a parameter. Names are PX4's where meaning and unit agree. Angles are in rad.

A parameter is set

- by a ground station, on the vehicle: its parameter editor lists them all; what is changed in flight
  acts without a jump, unless the text says that it acts at the next start;
- in a vehicle file, under `[parameters]`: `MPC_XY_CRUISE = 3.0` (see [vehicles](../vehicles));
- for one flight on the desktop: `windhover fly --set MPC_XY_CRUISE=3`, repeatable, over the vehicle file.

`windhover replay FLIGHT.ulg --with MPC_XY_CRUISE=3` tells how motor commands would have differed.
Defaults are those of the core, with the preset `windhover`; vehicle files and the preset `paper` set
others. A flight's log holds the values it was flown with.

This page is written by `windhover parameters --markdown` from the declarations in the code.
";

/// The table as text: everything, or the parameters in whose names one of the `words` stands. The
/// error is one line about a word that stands in none.
pub fn parameters(words: &[String]) -> Result<String, String> {
    let words: Vec<String> = words.iter().map(|word| word.to_uppercase()).collect();
    let stands = |word: &String| Parameters::declarations().any(|d| d.name.contains(word.as_str()));
    if let Some(word) = words.iter().find(|word| !stands(word)) {
        return Err(unknown(word));
    }
    let is_wanted = |declaration: &&Declaration| {
        words.is_empty() || words.iter().any(|word| declaration.name.contains(word.as_str()))
    };
    let mut rows = vec![row(["name", "default", "range", "unit", "meaning"])];
    rows.extend(Parameters::declarations().filter(is_wanted).map(cells));
    Ok(columns(&rows))
}

/// One line for somebody who named a parameter that there is not.
pub fn unknown(name: &str) -> String {
    format!("there is no parameter {name}; `windhover parameters` lists them")
}

/// The page `docs/parameters.md`.
pub fn parameters_page() -> String {
    let mut page = String::from(HEAD);
    for section in Parameters::GROUPS {
        page.push_str(&chapter(section));
    }
    page
}

fn chapter(section: &Section) -> String {
    let mut rows = vec![row(["name", "default", "range", "unit", "meaning"])];
    rows.extend(section.declarations.iter().map(|declaration| {
        let mut cells = cells(declaration);
        cells[0] = format!("`{}`", cells[0]);
        cells[3] = cells[3].replace("^2", "²").replace("^3", "³");
        cells
    }));
    let lines = section.documentation.iter().map(|line| line.trim());
    let text = lines.collect::<Vec<_>>().join("\n");
    format!("\n## {}\n\n{text}\n\n{}", title(section.name), markdown(&rows))
}

/// `rc_calibration` is "RC calibration".
fn title(name: &str) -> String {
    let words = name.replace('_', " ");
    match words.strip_prefix("rc") {
        Some(rest) => format!("RC{rest}"),
        None => words[..1].to_uppercase() + &words[1..],
    }
}

fn cells(declaration: &Declaration) -> Vec<String> {
    let Declaration {
        name,
        unit,
        min,
        max,
        default,
        text,
    } = *declaration;
    let range = format!("{} to {}", value(min), value(max));
    row([name, &value(default), &range, unit, text])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_select_parameters() {
        let all = parameters(&[]).unwrap();
        assert_eq!(all.lines().count(), Parameters::COUNT + 1);
        let some = parameters(&["gf_".into(), "NAV_RCL_ACT".into()]).unwrap();
        assert_eq!(some.lines().count(), 7, "{some}");
        let error = parameters(&["gf_".into(), "SPEEDY".into()]).unwrap_err();
        assert!(error.starts_with("there is no parameter SPEEDY"), "{error}");
    }

    #[test]
    fn every_parameter_and_section_is_on_the_page() {
        let page = parameters_page();
        for declaration in Parameters::declarations() {
            assert!(page.contains(&format!("| `{}` |", declaration.name)));
        }
        assert_eq!(page.matches("\n## ").count(), Parameters::GROUPS.len());
        assert!(page.contains("\n## RC calibration\n") && page.contains("\n## Vehicle\n"));
        assert!(
            Parameters::GROUPS
                .iter()
                .all(|group| !group.documentation.is_empty())
        );
    }
}
