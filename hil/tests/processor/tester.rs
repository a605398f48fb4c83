//! The other side of the bus: it tells the program what to do, raises interrupts at random, and
//! keeps what the program reports.

use crate::scenario::Scenario;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{Arc, OnceLock};
use windhover_hil::board::{Memory, ResetCause};
use windhover_hil::elf::Elf;
use windhover_hil::machine::{Bus, Machine, Options, Stop};
use windhover_hil::time::{MICROSECOND, NEVER, SECOND};
use windhover_hil::violation::Violation;

const LINES: u64 = 8;

/// The only peripheral.
pub struct Tester {
    scenario: Scenario,
    random: u64,
    lines: u128,
    storm: u64,
    next_raise: u64,
    later: Option<(u64, u32)>,
    watchdog: u64,
    reset_wanted: Option<ResetCause>,
    flash_busy_until: u64,
    flash_unlocked: bool,
    pub reports: Vec<u32>,
    pub finished: bool,
    pub resets: Vec<ResetCause>,
}

impl Tester {
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        Self {
            scenario,
            random: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1,
            lines: 0,
            storm: 0,
            next_raise: NEVER,
            later: None,
            watchdog: NEVER,
            reset_wanted: None,
            flash_busy_until: 0,
            flash_unlocked: false,
            reports: Vec::new(),
            finished: false,
            resets: Vec::new(),
        }
    }

    /// A watchdog that nobody feeds.
    pub fn bite_at(&mut self, time: u64) {
        self.watchdog = time;
    }

    fn noise(&mut self) -> u32 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 32) as u32
    }

    fn plan_raise(&mut self, now: u64) {
        self.next_raise = match self.storm {
            0 => NEVER,
            ticks => now + ticks / 2 + u64::from(self.noise()) % ticks,
        };
    }
}

impl Bus for Tester {
    fn reset(&mut self, _: u64, cause: ResetCause) {
        self.resets.push(cause);
        self.lines = 0;
        self.watchdog = NEVER;
    }

    fn read(&mut self, _: u64, address: u32, _: u32, _: &mut dyn Memory) -> Result<u32, Violation> {
        match address {
            0x4000_0000 => Ok(self.scenario as u32),
            0x4000_0004 => Ok(self.noise()),
            _ => Err(unknown(address, "read")),
        }
    }

    fn write(
        &mut self,
        now: u64,
        address: u32,
        _: u32,
        value: u32,
        _: &mut dyn Memory,
    ) -> Result<(), Violation> {
        match address {
            0x4000_0008 => self.lines &= !(1 << value),
            0x4000_000C => {
                self.storm = value.into();
                self.plan_raise(now);
                if value == 0 {
                    self.lines = 0;
                }
            }
            0x4000_0010 => self.reports.push(value),
            0x4000_0014 => self.lines |= 1 << value,
            0x4000_0018 => self.finished = true,
            0x4000_001C => self.later = Some((now + 10 * MICROSECOND, value)),
            0x4000_0020 => self.flash_busy_until = now + u64::from(value),
            0x4000_0024 => self.flash_unlocked = true,
            _ => return Err(unknown(address, "write")),
        }
        Ok(())
    }

    fn advance(&mut self, now: u64, _: &mut dyn Memory) -> Result<(), Violation> {
        if now >= self.next_raise {
            let line = u64::from(self.noise()) % LINES;
            self.lines |= 1 << line;
            self.plan_raise(now);
        }
        if let Some((_, line)) = self.later.take_if(|(then, _)| now >= *then) {
            self.lines |= 1 << line;
        }
        if now >= self.watchdog {
            self.reset_wanted = Some(ResetCause::IndependentWatchdog);
        }
        Ok(())
    }

    fn next_event(&self) -> u64 {
        let later = self.later.map_or(NEVER, |(then, _)| then);
        self.next_raise.min(later).min(self.watchdog)
    }

    fn interrupts(&self) -> u128 {
        self.lines
    }

    fn ticks_per_cycle(&self) -> u64 {
        2
    }

    fn take_reset(&mut self) -> Option<ResetCause> {
        self.reset_wanted.take()
    }

    fn store_to_flash(
        &mut self,
        _: u64,
        address: u32,
        _: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Result<u32, Violation> {
        if self.flash_unlocked {
            let mut old = [0; 4];
            memory.read(address, &mut old);
            return Ok(value & u32::from_le_bytes(old) & 0xFFFF_FF00);
        }
        Err(Violation::Misuse {
            peripheral: "flash",
            what: format!("store to {address:#010x} while locked"),
        })
    }

    fn stalled_until(&self) -> u64 {
        self.flash_busy_until
    }
}

fn unknown(address: u32, access: &'static str) -> Violation {
    Violation::UnknownRegister {
        peripheral: "tester",
        address,
        access,
    }
}

/// The program, built once.
fn program() -> Arc<Elf> {
    static PROGRAM: OnceLock<Arc<Elf>> = OnceLock::new();
    PROGRAM.get_or_init(build).clone()
}

fn build() -> Arc<Elf> {
    let package = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("torture");
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("torture");
    let status = Command::new(env!("CARGO"))
        .args([
            "build",
            "--quiet",
            "--locked",
            "--release",
            "--target",
            "thumbv7em-none-eabihf",
        ])
        .arg("--target-dir")
        .arg(&target)
        .current_dir(&package)
        .status()
        .expect("cargo runs");
    assert!(status.success(), "the program builds");
    let elf = target.join("thumbv7em-none-eabihf/release/windhover-torture");
    Arc::new(Elf::load(&elf).expect("the program is an ELF file"))
}

/// A machine about to run a scenario.
pub fn machine(scenario: Scenario, seed: u64) -> Machine<Tester> {
    machine_with(scenario, seed, Options::default())
}

/// A machine set up in another way.
pub fn machine_with(scenario: Scenario, seed: u64, options: Options) -> Machine<Tester> {
    Machine::new(Tester::new(scenario, seed), program(), options).expect("the program fits")
}

/// Runs until the program says that it is finished.
pub fn finish(machine: &mut Machine<Tester>) -> Result<Vec<u32>, Stop> {
    let limit = machine.now() + 60 * SECOND;
    while !machine.bus().finished {
        assert!(
            machine.now() < limit,
            "not finished; reports so far: {:x?}",
            machine.bus().reports
        );
        let until = machine.now() + SECOND / 1000;
        machine.run(until)?;
    }
    Ok(machine.bus().reports.clone())
}

/// What the program reports in a scenario.
pub fn reports(scenario: Scenario, seed: u64) -> Vec<u32> {
    finish(&mut machine(scenario, seed)).expect("the run is finished")
}

/// Why a scenario's run stops.
pub fn stop(scenario: Scenario) -> Stop {
    finish(&mut machine(scenario, 1)).expect_err("the run stops")
}
