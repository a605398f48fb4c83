//! Counts instructions of the firmware's steps in a flight, and of the core's functions by
//! themselves; `cargo xtask count` builds both programs and hands them over. Ends with 1
//! when a bound is missed, and with 2 when it could not count.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use windhover_hil::count::table::Table;
use windhover_hil::count::{kernels, ticks};
use windhover_hil::elf::Elf;
use windhover_hil::flight::Plan;
use windhover_model::Vehicle;

/// How long the firmware flies, in s.
const SECONDS: f64 = 12.0;

fn main() -> ExitCode {
    match table() {
        Ok(table) => {
            print!("\n{table}");
            let missed = table.missed();
            for name in &missed {
                println!("{name}: the bound is missed");
            }
            ExitCode::from(u8::from(!missed.is_empty()))
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn table() -> Result<Table, Box<dyn std::error::Error>> {
    let mut files = std::env::args().skip(1);
    let (Some(firmware), Some(functions)) = (files.next(), files.next()) else {
        return Err("two programs are wanted: the firmware, and hil/kernels".into());
    };
    let mut plan = Plan::calm(Vehicle::named("os4")?, SECONDS);
    plan.rig.record_every = 0;
    let ticks = ticks::count(Arc::new(Elf::load(Path::new(&firmware))?), &plan)?;
    let kernels = kernels::count(Arc::new(Elf::load(Path::new(&functions))?))?;
    Ok(Table::new(&ticks, &kernels))
}
