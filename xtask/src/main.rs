//! What CI and developers run: `cargo xtask help`.

mod arguments;
mod cargo_checks;
mod count;
mod elf;
mod firmware;
mod fuzz;
mod hash;
mod nalgebra;
mod no_panic;
mod packages;
mod process;
mod python;
mod size;
mod steps;
mod toolchain;

use std::env;
use std::process::ExitCode;

use arguments::Task;

fn main() -> ExitCode {
    let task = match arguments::parse(env::args().skip(1)) {
        Ok(task) => task,
        Err(message) => {
            eprintln!("{message}\n\n{}", arguments::HELP);
            return ExitCode::from(2);
        }
    };
    let outcome = match task {
        Task::Help => {
            print!("{}", arguments::HELP);
            Ok(())
        }
        Task::List => {
            print!("{}", steps::list());
            Ok(())
        }
        Task::Test {
            only,
            fail_fast,
            long,
        } => match steps::test(&only, fail_fast, long) {
            Ok(true) => Ok(()),
            Ok(false) => return ExitCode::FAILURE, // the summary is the last word
            Err(message) => Err(message),
        },
        Task::Bench(arguments) => bench(&arguments),
        Task::Count => count::check(),
        Task::Size => size::check(),
        Task::LinkSize => size::check_link(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn bench(arguments: &[String]) -> process::Outcome {
    let mut command = process::cargo(["bench", "--locked", "--package", "windhover-sim"]);
    if !arguments.is_empty() {
        command.arg("--").args(arguments);
    }
    process::run(&mut command)
}
