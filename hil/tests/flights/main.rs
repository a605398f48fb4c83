//! Flights of the firmware, as it is flashed, on the emulated board: it holds attitudes, its log
//! replays equal, and what goes wrong ends as it should.
//!
//! Long versions run where `WINDHOVER_LONG` is set (`cargo xtask test --long`).

mod board;
mod faults;
mod ground;
mod journal;
mod monitoring;
mod power;
mod replays;
mod rows;
mod start;
mod station;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, OnceLock};

use windhover_hil::elf::Elf;
use windhover_hil::figures::Figures;
use windhover_hil::flight::{Flight, Plan};
use windhover_hil::rig;
use windhover_hil::time::SECOND;
use windhover_model::Vehicle;
use windhover_model::sensor::gnss::GnssSite;
use windhover_sim::sensors::Sensors;

/// The firmware, built as it is flashed.
fn firmware() -> Arc<Elf> {
    static FIRMWARE: OnceLock<Arc<Elf>> = OnceLock::new();
    let elf = FIRMWARE.get_or_init(|| {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .expect("hil lies in the workspace");
        let target = root.join("target");
        let built = Command::new(env!("CARGO"))
            .args(["firmware", "--locked"])
            .current_dir(root)
            .env("CARGO_TARGET_DIR", &target)
            .status();
        assert!(
            built.is_ok_and(|status| status.success()),
            "cargo firmware failed"
        );
        let file: PathBuf = target.join("thumbv7em-none-eabihf/firmware/windhover-firmware");
        Arc::new(Elf::load(&file).expect("cargo firmware wrote it"))
    });
    elf.clone()
}

/// Whether the long versions are asked for.
fn is_long() -> bool {
    std::env::var_os("WINDHOVER_LONG").is_some()
}

/// A flight of `seconds` in calm air, of which no samples are kept.
fn plan(seconds: f64) -> Plan {
    let mut plan = Plan::calm(Vehicle::named("os4").expect("a built-in vehicle"), seconds);
    plan.rig = rig::Setup {
        record_every: 0,
        ..plan.rig
    };
    plan
}

/// What the sensors are calibrated against is fitted at the factory, so to speak.
const CALIBRATED: [&str; 3] = ["CAL_GYRO0_ID", "CAL_ACC0_ID", "CAL_MAG0_ID"];

/// A board with all sensors, in calm air.
fn on_sensors(rate: u32, seed: u64) -> Plan {
    let mut plan = plan(1.0);
    let suite = Sensors::default().suite(&plan.vehicle, GnssSite::default().home, rate, seed);
    plan.rig.sensors = Some(suite);
    plan
}

/// Flies a plan to its end, and prints its figures.
fn fly(plan: &Plan) -> (Flight, Figures) {
    fly_after(plan, |_| {})
}

/// As [`fly`], after something else was done to the board.
fn fly_after(plan: &Plan, before: impl FnOnce(&mut Flight)) -> (Flight, Figures) {
    let mut flight = Flight::new(firmware(), plan).expect("the firmware runs");
    let begin = std::time::Instant::now();
    before(&mut flight);
    let outcome = flight.fly(|_| {});
    let outcome = outcome.unwrap_or_else(|stop| panic!("the firmware did what it must not: {stop}"));
    let log = flight.flight_log();
    let figures = Figures::new(&mut flight, outcome, &log, begin.elapsed().as_secs_f64());
    println!("{}", figures.text());
    assert_eq!(
        flight.machine.bus().wiring.imu_misuse(),
        [],
        "against the data sheet"
    );
    (flight, figures)
}

/// From when on all motors are off for good, in s since power-on; `None` while one turns.
fn off_since(flight: &Flight) -> Option<f64> {
    let bus = flight.machine.bus();
    let mut last = [None; 4];
    for change in &bus.wiring.record().pulses {
        let off = change.high.is_none_or(|high| high <= SECOND / 1000);
        let since = &mut last[change.rotor];
        *since = match (off, *since) {
            (true, None) => Some(change.time),
            (true, since) => since,
            (false, _) => None,
        };
    }
    let latest = last
        .into_iter()
        .try_fold(0, |latest, since| since.map(|since| latest.max(since)));
    latest.map(|ticks| ticks as f64 / SECOND as f64)
}
