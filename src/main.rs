//! The firmware's task graph at a glance; on a desktop, a word about how to build it.
//!
//! | priority | runs | waits for |
//! |---|---|---|
//! | interrupts | drivers | DMA, timers, data-ready |
//! | inner executor | `inner_loop`: sample to motors | data-ready, at most 1.5 periods |
//! | log executor | `log_stream`: ring to port | time, DMA |
//! | outer executor | `outer_loop`: snapshot to result | a snapshot |
//! | thread | `ground_link`, `gnss`, `remote`, `slow_sensors`, `health` | bytes, time |
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "registers and interrupts that no driver has")]
mod board;
#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "fault handlers")]
mod fault;
#[cfg(target_os = "none")]
mod shared;
#[cfg(target_os = "none")]
mod shelf;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod task;

/// The order matters: motors are off since before `main`; the cause of the start is known before
/// anything can fail anew; the log begins before the first tick; the watchdog runs before the
/// tasks do.
#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use defmt_rtt as _;

    /// Without a completed outer step and inner ticks for so long, the watchdog resets, µs.
    const WATCHDOG: u32 = 250_000;

    let last = fault::take_last_run();
    let board = board::take();
    defmt::info!("windhover on {=str}, started by: {=str}", board::NAME, last.cause);
    let start::Core {
        outer,
        inner,
        config,
        logging,
        start,
        ground,
        stored,
    } = start::core(board.storage, last);
    let motors = board::Motors::new(board.motors, start.parameters.board.pwm_rate as u32);
    let state = task::InnerLoop::new(config, inner, motors);
    let watchdog = board::watch(board.watchdog, WATCHDOG);

    board::on_every_priority(|inner, log, outer_spawner, thread| {
        inner.spawn(task::inner_loop(state, board.imu, config).expect("spawned once"));
        outer_spawner.spawn(task::outer_loop(outer, logging, watchdog).expect("spawned once"));
        log.spawn(task::log_stream(board.log, start).expect("spawned once"));
        let (receiver, sender) = board.ground_link;
        thread.spawn(task::ground_link(receiver, ground, stored).expect("spawned once"));
        thread.spawn(task::ground_sender(sender).expect("spawned once"));
        let (receiver, sender) = board.gnss;
        thread.spawn(task::gnss(receiver, sender).expect("spawned once"));
        thread.spawn(task::remote(board.remote).expect("spawned once"));
        thread.spawn(task::slow_sensors(board.sensor_bus, board.battery).expect("spawned once"));
        thread.spawn(task::health(board.light).expect("spawned once"));
    })
}

/// A desktop has no motors: says how to build for a board, and fails because it did not.
#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    eprintln!("This is the firmware; it runs on a flight board.");
    eprintln!("  cargo firmware       builds it: rustup target add thumbv7em-none-eabihf, once");
    eprintln!("  cargo flash-board    builds it and flashes it by probe-rs");
    eprintln!("  cargo hil            runs it on an emulated board");
    eprintln!("To fly on the desktop: cargo run --release");
    std::process::ExitCode::FAILURE
}
