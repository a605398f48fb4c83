//! The firmware. On the board: motors off, then a word about what will come.
//! On a desktop: a word about how to build it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;

#[cfg(target_os = "none")]
use {defmt_rtt as _, panic_probe as _};

/// The firmware's start: the motor pins are safe before anything else runs.
#[cfg(target_os = "none")]
#[embassy_executor::main]
async fn main(_spawner: embassy_executor::Spawner) {
    board::motors_off();
    let _peripherals = embassy_stm32::init(Default::default());
    defmt::info!("windhover on {=str}: motors off", board::NAME);
    defmt::info!("it does not fly yet: sensors, control loops and motor outputs are to come");
}

/// A desktop has no motors: says how to build for a board, and fails because it did not.
#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    eprintln!("This is the firmware; it runs on a flight board.");
    eprintln!("  cargo firmware       builds it: rustup target add thumbv7em-none-eabihf, once");
    eprintln!("  cargo flash-board    builds it and flashes it by probe-rs");
    eprintln!("To fly on the desktop: cargo run --release");
    std::process::ExitCode::FAILURE
}
