//! The processor core: registers, memory and execution, by the crate `unicorn-engine`.

use super::clock::{Cause, Clock};
use std::rc::Rc;
use unicorn_engine::{
    Arch, ArmCpuModel, HookType, MemType, Mode, Prot, RegisterARM, TlbEntry, TlbType, Unicorn, uc_error,
};

/// Where flash begins.
pub(super) const FLASH: u32 = 0x0800_0000;
/// Bytes of flash.
pub(super) const FLASH_SIZE: u32 = 0x10_0000;
const CCM: u32 = 0x1000_0000;
const CCM_SIZE: u32 = 0x1_0000;
const SRAM: u32 = 0x2000_0000;
const SRAM_SIZE: u32 = 0x2_0000;
/// System memory: the factory's boot loader, and what is unique to the part.
const SYSTEM: u32 = 0x1FFF_0000;
const SYSTEM_SIZE: u32 = 0x1_0000;
const UNIQUE_ID: u32 = 0x1FFF_7A10;
const FLASH_KIBIBYTES: u32 = 0x1FFF_7A22;

/// The core as the engine has it.
pub(super) type Core = Unicorn<'static, ()>;

/// The three mask registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Masks {
    pub primask: bool,
    pub faultmask: bool,
    pub basepri: u8,
}

/// Registers by name.
pub(super) trait Registers {
    fn get(&self, register: RegisterARM) -> u32;
    fn set(&mut self, register: RegisterARM, value: u32);

    /// PRIMASK, FAULTMASK and BASEPRI.
    fn masks(&self) -> Masks {
        Masks {
            primask: self.get(RegisterARM::PRIMASK) & 1 != 0,
            faultmask: self.get(RegisterARM::FAULTMASK) & 1 != 0,
            basepri: self.get(RegisterARM::BASEPRI) as u8,
        }
    }
}

impl Registers for Unicorn<'_, ()> {
    fn get(&self, register: RegisterARM) -> u32 {
        self.reg_read(register).expect("a register that a Cortex-M4 has") as u32
    }

    fn set(&mut self, register: RegisterARM, value: u32) {
        self.reg_write(register, value.into())
            .expect("a register that a Cortex-M4 has");
    }
}

/// Where the engine keeps what the processor sees at an address: flash is also seen at 0.
pub(super) fn physical(address: u32) -> u32 {
    if address < FLASH_SIZE {
        address | FLASH
    } else {
        address
    }
}

fn within(address: u32, size: u32, start: u32, length: u32) -> bool {
    address >= start && u64::from(address) + u64::from(size) <= u64::from(start) + u64::from(length)
}

/// Whether these bytes are memory, of flash or RAM.
pub(super) fn is_memory(address: u32, size: u32) -> bool {
    is_ram(address, size)
        || within(physical(address), size, FLASH, FLASH_SIZE)
        || within(address, size, SYSTEM, SYSTEM_SIZE)
}

/// Whether these bytes are flash, at its own address.
pub(super) fn is_flash(address: u32, size: u32) -> bool {
    within(address, size, FLASH, FLASH_SIZE)
}

/// Whether these bytes are RAM.
pub(super) fn is_ram(address: u32, size: u32) -> bool {
    within(address, size, CCM, CCM_SIZE) || within(address, size, SRAM, SRAM_SIZE)
}

/// Whether instructions can be fetched from here. On silicon also from SRAM, never from CCM; here
/// only from flash: the engine is much faster when no store can change code, and the firmware has
/// no code in RAM.
pub(super) fn is_executable(address: u32) -> bool {
    within(physical(address), 2, FLASH, FLASH_SIZE)
}

/// Reads memory; what is no memory reads as nothing.
pub(super) fn load(core: &Unicorn<'_, ()>, address: u32, bytes: &mut [u8]) -> bool {
    let there = is_memory(address, bytes.len() as u32);
    if there {
        core.mem_read(physical(address).into(), bytes)
            .expect("this memory is mapped");
    }
    there
}

/// Writes memory, flash too.
pub(super) fn store(core: &mut Unicorn<'_, ()>, address: u32, bytes: &[u8]) -> bool {
    let there = is_memory(address, bytes.len() as u32);
    if there {
        core.mem_write(physical(address).into(), bytes)
            .expect("this memory is mapped");
    }
    there
}

/// Reads a word of memory.
pub(super) fn load_word(core: &Unicorn<'_, ()>, address: u32) -> Option<u32> {
    let mut bytes = [0; 4];
    load(core, address, &mut bytes).then(|| u32::from_le_bytes(bytes))
}

/// A core with its memory: flash erased, RAM with the pattern of [`scramble`].
pub(super) fn new() -> Result<Core, uc_error> {
    let mut core = Unicorn::new(Arch::ARM, Mode::THUMB)?;
    core.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)?;
    core.mem_map(FLASH.into(), FLASH_SIZE.into(), Prot::READ | Prot::EXEC)?;
    core.mem_map(CCM.into(), CCM_SIZE.into(), Prot::READ | Prot::WRITE)?;
    core.mem_map(SRAM.into(), SRAM_SIZE.into(), Prot::READ | Prot::WRITE)?;
    core.mem_map(SYSTEM.into(), SYSTEM_SIZE.into(), Prot::READ)?;
    core.mem_write(FLASH.into(), &vec![0xFF; FLASH_SIZE as usize])?;
    core.mem_write(UNIQUE_ID.into(), b"windhover-id")?;
    core.mem_write(
        FLASH_KIBIBYTES.into(),
        &((FLASH_SIZE / 1024) as u16).to_le_bytes(),
    )?;
    scramble(&mut core);
    Ok(core)
}

/// Fills RAM with noise, as power-on does: who reads before writing shall notice.
pub(super) fn scramble(core: &mut Core) {
    let mut state = 0x2545_F491_u32;
    for (start, size) in [(CCM, CCM_SIZE), (SRAM, SRAM_SIZE)] {
        let noise: Vec<u8> = (0..size)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            })
            .collect();
        store(core, start, &noise);
    }
}

/// Sets the rights of each page. Without this the engine takes all RAM as executable, and every
/// store into it as one that may change code.
pub(super) fn set_rights(core: &mut Core, clock: Rc<Clock>) -> Result<(), uc_error> {
    core.ctl_set_tlb_type(TlbType::VIRTUAL)?;
    core.add_tlb_hook(1, 0, move |core, address, access| {
        if access != MemType::FETCH {
            forget_conditions(core);
        }
        let address = address as u32;
        let executable = is_executable(address);
        if access == MemType::FETCH && !executable {
            clock.cause.set(Cause::Fetch(address));
        }
        Some(TlbEntry {
            paddr: physical(address).into(),
            perms: if executable {
                Prot::ALL
            } else {
                Prot::READ | Prot::WRITE
            },
        })
    })?;
    Ok(())
}

/// Before it asks about a data access, the engine writes down where it is in a block of conditional
/// instructions (IT), and takes that for the state at the next branch. While a block of
/// instructions runs, that state belongs to the engine's code and is to be none.
fn forget_conditions(core: &mut Unicorn<'_, ()>) {
    const CONDITIONS: u32 = 0x0600_FC00;
    const THUMB: u32 = 1 << 24;
    if core.get(RegisterARM::XPSR) & CONDITIONS != 0 {
        core.set(RegisterARM::EPSR, THUMB);
    }
}

/// Accesses to nowhere are noted; stores into flash go to `program`, which says whether they may.
pub(super) fn watch_accesses(
    core: &mut Core,
    clock: Rc<Clock>,
    mut program: impl FnMut(&mut Unicorn<'_, ()>, u32, u32, u32) -> bool + 'static,
) -> Result<(), uc_error> {
    let invalid = HookType::MEM_READ_UNMAPPED
        | HookType::MEM_WRITE_UNMAPPED
        | HookType::MEM_FETCH_UNMAPPED
        | HookType::MEM_READ_PROT
        | HookType::MEM_WRITE_PROT
        | HookType::MEM_FETCH_PROT;
    core.add_mem_hook(invalid, 1, 0, move |core, access, address, size, value| {
        let address = address as u32;
        match access {
            MemType::WRITE_PROT if within(address, size as u32, FLASH, FLASH_SIZE) => {
                forget_conditions(core);
                if program(core, address, size as u32, value as u32) {
                    return true;
                }
                clock.cause.set(Cause::Refused);
            }
            MemType::WRITE_PROT | MemType::WRITE_UNMAPPED => clock.cause.set(Cause::Store(address)),
            MemType::FETCH_PROT | MemType::FETCH_UNMAPPED => clock.cause.set(Cause::Fetch(address)),
            _ => clock.cause.set(Cause::Load(address)),
        }
        false
    })?;
    Ok(())
}

/// Puts the registers into their reset state and takes stack pointer and pc from the vector table.
pub(super) fn reset(core: &mut Core) {
    // In handler mode every register may be written.
    core.set(RegisterARM::IPSR, 3);
    for register in [
        RegisterARM::PRIMASK,
        RegisterARM::FAULTMASK,
        RegisterARM::BASEPRI,
        RegisterARM::FPSCR,
    ] {
        core.set(register, 0);
    }
    core.set(RegisterARM::CONTROL, 0);
    core.set(RegisterARM::IPSR, 0);
    // FPCA stays set for ever, see the module on exceptions.
    core.set(RegisterARM::CONTROL, 1 << 2);
    core.set(RegisterARM::SP, load_word(core, 0).unwrap_or(0) & !3);
    core.set(RegisterARM::LR, 0xFFFF_FFFF);
    let start = load_word(core, 4).unwrap_or(0);
    core.set(RegisterARM::EPSR, (start & 1) << 24);
    core.set(RegisterARM::PC, start);
    core.set(RegisterARM::APSR_NZCV, 0);
}
