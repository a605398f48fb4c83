//! The probes of the package `windhover-no-panic`: they link only while no panic can be reached.

use std::collections::BTreeSet;
use std::process::Command;

use crate::elf::Elf;
use crate::process::{Outcome, capture, cargo, run, target_directory};
use crate::toolchain::BOARD;

/// The function that the probe's panic handler calls and that nobody defines.
const MISSING: &str = "windhover_step_can_panic";

/// A program of the probe, and the functions under proof that must be in it.
struct Probe {
    program: &'static str,
    functions: &'static [&'static str],
}

const STEPS: Probe = Probe {
    program: "windhover-no-panic",
    functions: &["inner_step", "outer_step"],
};

const LINK: Probe = Probe {
    program: "windhover-link-probe",
    functions: &[
        "link_receive",
        "link_poll",
        "link_requests",
        "link_tell",
        "link_key",
    ],
};

const VEHICLE: Probe = Probe {
    program: "windhover-vehicle-probe",
    functions: &["told_outer", "vehicle_receive", "vehicle_step", "vehicle_poll"],
};

/// The probes link, and all that is under proof is in them.
pub fn links() -> Outcome {
    for probe in [STEPS, LINK, VEHICLE] {
        let elf = linked(&probe)?;
        for function in probe.functions {
            match elf.symbol(function) {
                Some(symbol) if symbol.size > 0 => println!("{function}: {} bytes, no panic", symbol.size),
                _ => return Err(format!("`{function}` is not in the probe: it proves nothing")),
            }
        }
    }
    Ok(())
}

/// The probe that holds the ground link and nothing else.
pub fn link() -> Result<Elf, String> {
    linked(&LINK)
}

fn linked(probe: &Probe) -> Result<Elf, String> {
    run(&mut build(probe))?;
    let path = target_directory()?.join(BOARD).join("no-panic");
    Elf::read(&path.join(probe.program))
}

/// With an `unwrap` in what is under proof the probes do not link, for the panic's sake and no
/// other.
pub fn fails_to_link() -> Outcome {
    for probe in [STEPS, LINK, VEHICLE] {
        let output = capture(build(&probe).args(["--features", "prove-it-fails"]))?;
        let words = String::from_utf8_lossy(&output.stderr);
        if output.status.success() {
            let program = probe.program;
            return Err(format!(
                "{program} linked with an `unwrap` in it: it proves nothing"
            ));
        }
        if undefined_symbols(&words) != BTreeSet::from([MISSING]) {
            return Err(format!(
                "the probe failed for another reason than `{MISSING}`:\n{words}"
            ));
        }
        println!("it does not link, as it should: undefined symbol {MISSING}");
    }
    Ok(())
}

fn build(probe: &Probe) -> Command {
    cargo([
        "build",
        "--locked",
        "--profile",
        "no-panic",
        "--target",
        BOARD,
        "--package",
        "windhover-no-panic",
        "--bin",
        probe.program,
    ])
}

/// The symbols that LLVM's linker misses.
fn undefined_symbols(words: &str) -> BTreeSet<&str> {
    let missing = |line: &'_ str| {
        line.find("undefined symbol: ")
            .map(|at| at + "undefined symbol: ".len())
    };
    words
        .lines()
        .filter_map(|line| Some(line[missing(line)?..].trim()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linker_names_what_it_misses() {
        let words = "error: linking with `rust-lld` failed: exit status: 1\n  \
            = note: rust-lld: error: undefined symbol: windhover_step_can_panic\n          \
            >>> referenced by probe.rs:34\n\n          \
            rust-lld: error: undefined symbol: sqrtf\n";
        assert_eq!(undefined_symbols(words), BTreeSet::from([MISSING, "sqrtf"]));
        assert!(undefined_symbols("error[E0425]: cannot find value").is_empty());
    }
}
