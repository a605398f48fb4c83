//! Instructions of the firmware's steps and of the core's functions, counted on the emulated board.

use crate::firmware;
use crate::process::{Outcome, cargo, root, run, target_directory};
use crate::toolchain::BOARD;

/// Prints the counts; a bound that is missed fails.
pub fn check() -> Outcome {
    let firmware = firmware::build()?;
    let target = target_directory()?.join("kernels");
    let mut build = cargo(["build", "--locked", "--release", "--target", BOARD]);
    build
        .current_dir(root().join("hil").join("kernels"))
        .env("CARGO_TARGET_DIR", &target);
    run(&mut build)?;
    let functions = target.join(BOARD).join("release/windhover-kernels");
    // In the dev profile, as hil's tests: the engine is optimised there too, and is built once.
    let mut count = cargo(["run", "--locked", "--quiet", "--package", "windhover-hil"]);
    count.args(["--example", "count", "--"]);
    run(count.arg(firmware).arg(functions))
}
