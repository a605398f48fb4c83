//! What the other steps need beside the pinned compiler: the board's target.

use std::path::PathBuf;
use std::process::Command;

use crate::process::{Outcome, read, run};

/// The Cortex-M4F of the flight boards.
pub const BOARD: &str = "thumbv7em-none-eabihf";

/// Installs by rustup what is missing; says what to install when there is no rustup.
pub fn install() -> Outcome {
    let library = PathBuf::from(rustc(&["--print", "target-libdir", "--target", BOARD])?);
    if !library.is_dir() {
        rustup(&["target", "add", BOARD])?;
    }
    Ok(())
}

fn rustc(arguments: &[&str]) -> Result<String, String> {
    let words = read(
        Command::new("rustc")
            .current_dir(crate::process::root())
            .args(arguments),
    )?;
    Ok(words.trim_end().into())
}

fn rustup(arguments: &[&str]) -> Outcome {
    let mut command = Command::new("rustup");
    command.current_dir(crate::process::root()).args(arguments);
    run(&mut command).map_err(|error| {
        format!("{error}\nThe compiler lacks the target {BOARD}. With rustup:\n  rustup target add {BOARD}")
    })
}
