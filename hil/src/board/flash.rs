//! The flash interface (RM0090 3.9): access control, erasing and programming.
//!
//! Erasing and programming stall whoever reads from flash, and here that is always the processor.

use super::Memory;
use super::flash_options::Options;
use super::power_cut::PowerCut;
use super::refusal::{Answer, Refusal, misuse};
use crate::time::{MICROSECOND, NEVER};

const ACR: u32 = 0x00;
const KEYR: u32 = 0x04;
const OPTKEYR: u32 = 0x08;
const SR: u32 = 0x0C;
const CR: u32 = 0x10;
const OPTCR: u32 = 0x14;

const ACR_LATENCY: u32 = 0x7;
const ACR_ICEN: u32 = 1 << 9;
const ACR_DCEN: u32 = 1 << 10;
const ACR_ICRST: u32 = 1 << 11;
const ACR_DCRST: u32 = 1 << 12;
const ACR_WRITABLE: u32 = 0x1F07;

const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

const SR_EOP: u32 = 1 << 0;
const SR_CLEARABLE: u32 = 0xF3;
const SR_ERRORS: u32 = 0xF2;
const SR_BSY: u32 = 1 << 16;

const CR_PG: u32 = 1 << 0;
const CR_SER: u32 = 1 << 1;
const CR_MER: u32 = 1 << 2;
const CR_STRT: u32 = 1 << 16;
const CR_EOPIE: u32 = 1 << 24;
const CR_ERRIE: u32 = 1 << 25;
const CR_LOCK: u32 = 1 << 31;
const CR_WRITABLE: u32 = 0x0300_037F;

/// Where the flash lies for the processor.
const BASE: u32 = 0x0800_0000;
/// Addresses of the twelve sectors of the 1 MiB part, and of its end (RM0090 table 5).
const SECTORS: [u32; 13] = [
    0x0800_0000,
    0x0800_4000,
    0x0800_8000,
    0x0800_C000,
    0x0801_0000,
    0x0802_0000,
    0x0804_0000,
    0x0806_0000,
    0x0808_0000,
    0x080A_0000,
    0x080C_0000,
    0x080E_0000,
    0x0810_0000,
];

const MILLISECOND: u64 = 1000 * MICROSECOND;
/// Typical times to erase by size in KiB, and by PSIZE of 8, 16 and 32 bits (datasheet table 40).
const ERASE_TIMES: [(u32, [u64; 3]); 3] = [
    (16, [400 * MILLISECOND, 300 * MILLISECOND, 250 * MILLISECOND]),
    (64, [1200 * MILLISECOND, 700 * MILLISECOND, 550 * MILLISECOND]),
    (128, [2000 * MILLISECOND, 1300 * MILLISECOND, 1000 * MILLISECOND]),
];
/// Typical time to program one unit of any size (datasheet table 40).
const PROGRAM_TIME: u64 = 16 * MICROSECOND;
/// Option bytes lie in a sector of their own, of the smallest size.
const OPTION_TIME: u64 = 250 * MILLISECOND;

/// What is being done while BSY is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operation {
    EraseSector(usize),
    /// A reset came during an erasure.
    AbandonErasure(usize),
    Program,
    ProgramOptions,
}

pub(super) const INTERRUPT: u32 = 4;

pub(super) struct Flash {
    access: u32,
    status: u32,
    control: u32,
    /// How many of the two keys were written.
    keys: usize,
    options: Options,
    operation: Option<Operation>,
    /// When the operation will be done, or was.
    done: u64,
    pub power: PowerCut,
}

impl Flash {
    pub(super) fn new() -> Self {
        Self {
            access: 0,
            status: 0,
            control: CR_LOCK,
            keys: 0,
            options: Options::new(),
            operation: None,
            done: 0,
            power: PowerCut::new(),
        }
    }

    /// A reset aborts what was going on: a sector is left half erased. Option bytes keep what was
    /// programmed.
    pub(super) fn reset(&mut self, now: u64) {
        let options = self.options.after_reset();
        let operation = match self.operation {
            Some(Operation::EraseSector(sector) | Operation::AbandonErasure(sector)) => {
                Some(Operation::AbandonErasure(sector))
            }
            _ => None,
        };
        *self = Self {
            options,
            operation,
            done: now,
            power: std::mem::replace(&mut self.power, PowerCut::new()),
            ..Self::new()
        };
    }

    pub(super) fn wait_states(&self) -> u32 {
        self.access & ACR_LATENCY
    }

    /// The brown-out level that is in force, as in `OPTCR.BOR_LEV`: 0 is level 3, 3 is off.
    pub(super) fn brown_out_level(&self) -> u32 {
        self.options.brown_out_level()
    }

    pub(super) fn stalled_until(&self) -> u64 {
        self.done
    }

    pub(super) fn next_event(&self) -> u64 {
        let done = if self.operation.is_some() {
            self.done
        } else {
            NEVER
        };
        done.min(self.power.next_event())
    }

    pub(super) fn interrupt(&self) -> bool {
        self.control & CR_EOPIE != 0 && self.status & SR_EOP != 0
            || self.control & CR_ERRIE != 0 && self.status & SR_ERRORS != 0
    }

    /// Finishes what is due.
    pub(super) fn advance(&mut self, now: u64, memory: &mut dyn Memory) {
        self.power.advance(now);
        if self.done > now {
            return;
        }
        match self.operation.take() {
            None => return,
            Some(Operation::EraseSector(sector)) => erase(sector, memory),
            Some(Operation::AbandonErasure(sector)) => {
                return self
                    .power
                    .erase_partly(SECTORS[sector]..SECTORS[sector + 1], memory);
            }
            Some(Operation::Program) => {}
            Some(Operation::ProgramOptions) => self.options.finish(),
        }
        self.control &= !CR_STRT;
        if self.control & CR_EOPIE != 0 {
            self.status |= SR_EOP;
        }
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        let busy = if self.operation.is_some() { SR_BSY } else { 0 };
        match offset {
            ACR => Ok(self.access),
            SR => Ok(self.status | busy),
            CR => Ok(self.control),
            OPTCR => Ok(self.options.read()),
            KEYR | OPTKEYR => misuse("a key register can only be written"),
            _ => Err(Refusal::Unknown),
        }
    }

    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        match offset {
            ACR => self.write_access(value),
            KEYR => self.write_key(value),
            SR => {
                self.status &= !(value & SR_CLEARABLE);
                Ok(())
            }
            CR => self.write_control(now, value),
            OPTKEYR => self.options.write_key(value),
            OPTCR => {
                if self.options.write(value)? {
                    self.start(now, Operation::ProgramOptions, OPTION_TIME);
                }
                Ok(())
            }
            _ => Err(Refusal::Unknown),
        }
    }

    fn write_access(&mut self, value: u32) -> Answer<()> {
        let resets_enabled_cache = value & ACR_ICRST != 0 && self.access & ACR_ICEN != 0
            || value & ACR_DCRST != 0 && self.access & ACR_DCEN != 0;
        if resets_enabled_cache {
            return misuse("ACR resets a cache that is enabled");
        }
        self.access = value & ACR_WRITABLE;
        Ok(())
    }

    fn write_key(&mut self, value: u32) -> Answer<()> {
        if self.control & CR_LOCK == 0 || KEYS[self.keys] != value {
            return misuse(format!("{value:#010x} is not the key that KEYR expects now"));
        }
        self.keys += 1;
        if self.keys == KEYS.len() {
            self.keys = 0;
            self.control &= !CR_LOCK;
        }
        Ok(())
    }

    fn write_control(&mut self, now: u64, value: u32) -> Answer<()> {
        if self.control & CR_LOCK != 0 {
            return misuse("CR is written while it is locked");
        }
        if self.operation.is_some() {
            return misuse("CR is written while the flash is busy");
        }
        self.control = value & (CR_WRITABLE | CR_LOCK);
        if value & CR_STRT == 0 {
            return Ok(());
        }
        if value & CR_LOCK != 0 || value & (CR_PG | CR_SER | CR_MER) != CR_SER {
            return misuse("STRT needs SER, without PG, MER (mass erase is not modelled) and LOCK");
        }
        self.start_erase(now, value)
    }

    fn start_erase(&mut self, now: u64, value: u32) -> Answer<()> {
        let sector = ((value >> 3) & 0xF) as usize;
        if sector >= SECTORS.len() - 1 {
            return misuse(format!("there is no sector {sector}"));
        }
        self.options.check_writable(sector)?;
        let kibibytes = (SECTORS[sector + 1] - SECTORS[sector]) / 1024;
        let parallelism = self.parallelism()?;
        let time = ERASE_TIMES
            .iter()
            .find(|(size, _)| *size == kibibytes)
            .map_or(0, |(_, times)| times[parallelism]);
        self.control |= CR_STRT;
        self.start(now, Operation::EraseSector(sector), time);
        self.power.begin(self.done - time, time);
        Ok(())
    }

    fn start(&mut self, now: u64, operation: Operation, time: u64) {
        self.operation = Some(operation);
        self.done = self.done.max(now) + time;
    }

    /// PSIZE as the logarithm of its bytes.
    fn parallelism(&self) -> Answer<usize> {
        match (self.control >> 8) & 3 {
            3 => misuse("PSIZE of 64 bits needs an external programming voltage"),
            logarithm => Ok(logarithm as usize),
        }
    }

    /// A store of the processor into flash: what the place will hold. Bits can only be cleared.
    pub(super) fn program(
        &mut self,
        now: u64,
        address: u32,
        size: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Answer<u32> {
        if self.control & CR_LOCK != 0 {
            return misuse(format!("{address:#010x} is programmed while CR is locked"));
        }
        if self.control & (CR_PG | CR_SER | CR_MER) != CR_PG {
            return misuse(format!("{address:#010x} is programmed without PG alone (PGSERR)"));
        }
        if 1 << self.parallelism()? != size || !address.is_multiple_of(size) {
            return misuse(format!(
                "{address:#010x} is programmed by {size} bytes, which PSIZE does not say (PGPERR)"
            ));
        }
        let sector = SECTORS[1..].iter().position(|end| address < *end);
        match sector {
            Some(sector) if address >= BASE => self.options.check_writable(sector)?,
            _ => return misuse(format!("{address:#010x} is not in flash")),
        }
        let mut old = [0; 4];
        memory.read(address, &mut old[..size as usize]);
        self.start(now, Operation::Program, PROGRAM_TIME);
        let old = u32::from_le_bytes(old);
        Ok(if self.power.begin(self.done - PROGRAM_TIME, PROGRAM_TIME) {
            self.power.half_programmed(old, value)
        } else {
            old & value
        })
    }
}

fn erase(sector: usize, memory: &mut dyn Memory) {
    const ERASED: [u8; 0x4000] = [0xFF; 0x4000];
    for address in (SECTORS[sector]..SECTORS[sector + 1]).step_by(ERASED.len()) {
        memory.write(address, &ERASED);
    }
}
