//! The checks that are cargo's own: format, lints, tests, documentation.

use std::process::Command;

use crate::process::{Outcome, cargo, root, run, target_directory};
use crate::toolchain::BOARD;

/// The core: what runs on the board and on the desktop alike.
const CORE: [&str; 11] = [
    "windhover-math",
    "windhover-parameters",
    "windhover-control",
    "windhover-estimator",
    "windhover-autopilot",
    "windhover-flight-log",
    "windhover-drivers",
    "windhover-storage",
    "windhover-ground-link",
    "windhover-vehicle-link",
    "windhover-fault-record",
];

/// What exists on the board only; its desktop `main` only says so.
const BOARD_ONLY: [&str; 2] = ["windhover-firmware", "windhover-no-panic"];

/// The board in the loop: it needs what [`crate::packages`] installs.
const HIL: &str = "windhover-hil";

/// Programs for the emulated board, apart from the workspace because they are linked otherwise.
const APART_BOARD: [&str; 2] = ["hil/torture", "hil/kernels"];

/// Apart from the workspace as well, for the desktop.
const APART_DESKTOP: [&str; 1] = ["fuzz"];

/// All code is formatted, that of the packages apart too.
pub fn fmt() -> Outcome {
    run(&mut cargo(["fmt", "--all", "--check"]))?;
    for folder in APART_BOARD.iter().chain(&APART_DESKTOP) {
        run(cargo(["fmt", "--check"]).current_dir(root().join(folder)))?;
    }
    Ok(())
}

/// No warning in the workspace, built for the desktop.
pub fn clippy() -> Outcome {
    run(&mut cargo([
        "clippy",
        "--locked",
        "--workspace",
        "--all-targets",
        "--",
        "--deny",
        "warnings",
    ]))
}

/// No warning in what is built for the board.
pub fn clippy_board() -> Outcome {
    let clippy = || cargo(["clippy", "--locked", "--target", BOARD]);
    let mut command = clippy();
    command.args(each("--package", CORE.iter().chain(&BOARD_ONLY)));
    run(command.args(["--", "--deny", "warnings"]))?;
    let target = target_directory()?.join("apart");
    for folder in APART_BOARD {
        let mut command = clippy();
        command
            .current_dir(root().join(folder))
            .env("CARGO_TARGET_DIR", &target);
        run(command.args(["--", "--deny", "warnings"]))?;
    }
    Ok(())
}

/// The tests of the workspace but those of the board and of `hil`.
pub fn workspace() -> Command {
    let mut command = cargo(["test", "--locked", "--workspace"]);
    command.args(each("--exclude", BOARD_ONLY.iter().chain([&HIL])));
    command
}

/// The flights of the desktop.
pub fn flights() -> Command {
    cargo(["test", "--locked", "--release", "--package", "windhover-tests"])
}

/// Ten million bytes of noise and a million valid frames for the ground link.
pub fn noise() -> Command {
    let mut command = cargo(["test", "--locked", "--release", "--test", "noise"]);
    command.args(["--package", "windhover-ground-link"]);
    command
}

/// In the dev profile, which checks more; the engine is optimised there as well, and is built
/// once for this, for clippy and for the documentation.
pub fn emulated_board() -> Command {
    cargo(["test", "--locked", "--package", HIL])
}

/// The documentation has no broken link.
pub fn doc() -> Outcome {
    let mut command = cargo(["doc", "--locked", "--workspace", "--no-deps"]);
    run(command.env("RUSTDOCFLAGS", "--deny warnings"))
}

/// The core builds for the board, each package alone.
pub fn build_board() -> Outcome {
    let mut command = cargo(["build", "--locked", "--release", "--target", BOARD]);
    run(command.args(each("--package", &CORE)))
}

fn each<'a>(
    option: &'a str,
    names: impl IntoIterator<Item = &'a &'static str>,
) -> impl Iterator<Item = &'a str> {
    names.into_iter().flat_map(move |name| [option, *name])
}
