//! The probe of the package `windhover-no-panic`: it links only while no panic can be reached.

use std::collections::BTreeSet;
use std::process::Command;

use crate::elf::Elf;
use crate::process::{Outcome, capture, cargo, run, target_directory};
use crate::toolchain::BOARD;

/// The function that the probe's panic handler calls and that nobody defines.
const MISSING: &str = "windhover_step_can_panic";

/// The functions under proof.
const STEPS: [&str; 2] = ["inner_step", "outer_step"];

/// The probe links, and both steps are in it.
pub fn links() -> Outcome {
    run(&mut build())?;
    let path = target_directory()?
        .join(BOARD)
        .join("no-panic/windhover-no-panic");
    let elf = Elf::read(&path)?;
    for step in STEPS {
        match elf.symbol(step) {
            Some(symbol) if symbol.size > 0 => println!("{step}: {} bytes, no panic", symbol.size),
            _ => return Err(format!("`{step}` is not in the probe: it proves nothing")),
        }
    }
    Ok(())
}

/// With an `unwrap` in a step the probe does not link, for the panic's sake and no other.
pub fn fails_to_link() -> Outcome {
    let output = capture(build().args(["--features", "prove-it-fails"]))?;
    let words = String::from_utf8_lossy(&output.stderr);
    if output.status.success() {
        return Err("the probe linked with an `unwrap` in a step: it proves nothing".into());
    }
    if undefined_symbols(&words) != BTreeSet::from([MISSING]) {
        return Err(format!(
            "the probe failed for another reason than `{MISSING}`:\n{words}"
        ));
    }
    println!("it does not link, as it should: undefined symbol {MISSING}");
    Ok(())
}

fn build() -> Command {
    cargo([
        "build",
        "--locked",
        "--profile",
        "no-panic",
        "--target",
        BOARD,
        "--package",
        "windhover-no-panic",
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
