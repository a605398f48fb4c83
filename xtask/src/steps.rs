//! The steps of `cargo xtask test`, and how they are run and summed up.

use std::fmt::Write;
use std::process::Command;
use std::time::Instant;

use crate::process::{Outcome, run};
use crate::{
    cargo_checks, count, firmware, fuzz, hash, nalgebra, no_panic, packages, python, size, toolchain,
};

/// With this variable set, tests fly their long flights too.
const LONG: &str = "WINDHOVER_LONG";

/// Property tests draw their cases from this seed, so that a run says the same about a tree
/// whenever it is made. `--long` and `cargo test` by itself draw new ones.
const CASES: (&str, &str) = ("PROPTEST_RNG_SEED", "20");

struct Step {
    name: &'static str,
    what: &'static str,
    run: Run,
}

enum Run {
    Check(fn() -> Outcome),
    /// Tests, which heed [`LONG`].
    Tests(fn() -> Command),
    /// What does more where it is told to take long.
    Longer(fn(bool) -> Outcome),
}

const STEPS: &[Step] = &[
    step("toolchain", "the board's target is installed", toolchain::install),
    step(
        "packages",
        "compilers and libraries that the emulated board is built with",
        packages::install,
    ),
    step("fmt", "the code is formatted", cargo_checks::fmt),
    step("clippy", "no warning on the desktop", cargo_checks::clippy),
    step(
        "clippy-board",
        "no warning on the board",
        cargo_checks::clippy_board,
    ),
    tests(
        "test",
        "unit tests and flights, dev profile",
        cargo_checks::workspace,
    ),
    tests("flights", "whole flights, release profile", cargo_checks::flights),
    tests(
        "noise",
        "the ground link stands millions of bytes and frames, release profile",
        cargo_checks::noise,
    ),
    step("hash", "every build flies the same bits", hash::is_equal),
    step(
        "pyulog",
        "an independent reader reads every log",
        python::reads_logs,
    ),
    step(
        "clients",
        "pymavlink, MAVSDK and MAVProxy upload to the simulated vehicle and fly it",
        python::fly,
    ),
    step(
        "fuzz",
        "what reads bytes from outside stands two minutes of fuzzing",
        fuzz::targets,
    ),
    step(
        "doc",
        "the documentation builds without a warning",
        cargo_checks::doc,
    ),
    step(
        "build-board",
        "the core builds for the board",
        cargo_checks::build_board,
    ),
    step(
        "no-panic",
        "no panic can be reached from the steps, their log and the ground link",
        no_panic::links,
    ),
    step(
        "no-panic-fails",
        "the proof notices an unwrap in a step and in the link",
        no_panic::fails_to_link,
    ),
    step("nalgebra", "nalgebra has no feature `std`", nalgebra::has_no_std),
    step(
        "firmware",
        "the firmware links, and its sections lie where they must",
        firmware::check,
    ),
    step(
        "size",
        "the firmware takes no more flash and RAM than it may",
        size::check,
    ),
    step(
        "link-size",
        "the ground link takes no more flash and RAM than it may",
        size::check_link,
    ),
    tests(
        "hil",
        "the emulated board, and the firmware's flights on it",
        cargo_checks::emulated_board,
    ),
    Step {
        name: "hil-clients",
        what: "pymavlink uploads to the flashed firmware on the emulated board, and flies it from flash",
        run: Run::Longer(python::fly_board),
    },
    step(
        "count",
        "the steps and the core's functions take no more instructions than they may",
        count::check,
    ),
];

const fn step(name: &'static str, what: &'static str, check: fn() -> Outcome) -> Step {
    let run = Run::Check(check);
    Step { name, what, run }
}

const fn tests(name: &'static str, what: &'static str, command: fn() -> Command) -> Step {
    let run = Run::Tests(command);
    Step { name, what, run }
}

impl Step {
    fn run(&self, long: bool) -> Outcome {
        match self.run {
            Run::Check(check) => check(),
            Run::Longer(check) => check(long),
            Run::Tests(command) if long => run(command().env(LONG, "1")),
            Run::Tests(command) => run(command().env(CASES.0, CASES.1)),
        }
    }
}

/// One line a step.
pub fn list() -> String {
    STEPS
        .iter()
        .map(|step| format!("{:15} {}\n", step.name, step.what))
        .collect()
}

/// Runs all steps, or those named, and reports on each. Whether all passed; an error if there is
/// no such step.
pub fn test(only: &[String], fail_fast: bool, long: bool) -> Result<bool, String> {
    let chosen = choose(only)?;
    let mut results = Vec::new();
    for step in chosen {
        println!("\n== {}: {}", step.name, step.what);
        let start = Instant::now();
        let outcome = step.run(long);
        let seconds = start.elapsed().as_secs_f64();
        match &outcome {
            Ok(()) => println!("== {}: passed in {seconds:.1} s", step.name),
            Err(message) => println!("{message}\n== {}: FAILED in {seconds:.1} s", step.name),
        }
        let passed = outcome.is_ok();
        results.push(Finished {
            name: step.name,
            passed,
            seconds,
        });
        if fail_fast && !passed {
            break;
        }
    }
    print!("\n{}", summary(&results));
    Ok(results.iter().all(|step| step.passed))
}

fn choose(only: &[String]) -> Result<Vec<&'static Step>, String> {
    let known = |name: &String| STEPS.iter().any(|step| step.name == name);
    if let Some(unknown) = only.iter().find(|name| !known(name)) {
        return Err(format!("there is no step `{unknown}`; the steps are\n{}", list()));
    }
    let wanted = |step: &&Step| only.is_empty() || only.iter().any(|name| name == step.name);
    Ok(STEPS.iter().filter(wanted).collect())
}

struct Finished {
    name: &'static str,
    passed: bool,
    seconds: f64,
}

/// A table of the steps, and a last line that counts them.
fn summary(results: &[Finished]) -> String {
    let mut text = String::new();
    for Finished {
        name,
        passed,
        seconds,
    } in results
    {
        let verdict = if *passed { "passed" } else { "FAILED" };
        writeln!(text, "{name:15} {verdict} {seconds:8.1} s").expect("a String takes all");
    }
    let passed = results.iter().filter(|step| step.passed).count();
    writeln!(text, "{passed} passed, {} failed", results.len() - passed).expect("a String takes all");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_listed() {
        for (index, step) in STEPS.iter().enumerate() {
            assert!(STEPS[..index].iter().all(|other| other.name != step.name));
            assert!(list().contains(step.what));
        }
    }

    #[test]
    fn chosen_steps_keep_the_order_of_the_table() {
        let names: Vec<_> = choose(&["doc".into(), "fmt".into()])
            .unwrap()
            .iter()
            .map(|s| s.name)
            .collect();
        assert_eq!(names, ["fmt", "doc"]);
        assert_eq!(choose(&[]).unwrap().len(), STEPS.len());
        assert!(choose(&["fly".into()]).is_err());
    }

    #[test]
    fn the_last_line_counts() {
        let finished = |name, passed| Finished {
            name,
            passed,
            seconds: 1.25,
        };
        let text = summary(&[
            finished("fmt", true),
            finished("doc", false),
            finished("test", true),
        ]);
        assert!(text.contains("doc             FAILED      1.2 s\n"));
        assert!(text.ends_with("\n2 passed, 1 failed\n"));
    }
}
