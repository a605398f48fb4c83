//! Where the engine calls back: blocks of instructions, registers, and what it cannot do itself.

use super::blocks::Blocks;
use super::bus::Bus;
use super::clock::{Cause, Clock};
use super::engine::{self, Core, Registers};
use super::system::{PRIVATE, Shared};
use std::rc::Rc;
use unicorn_engine::{RegisterARM, Unicorn, uc_error};

const PERIPHERALS: u32 = 0x4000_0000;
const PERIPHERALS_SIZE: u64 = 0x2000_0000;
const PRIVATE_SIZE: u64 = 0x10_0000;

const YIELD: u16 = 0xBF10;
const WFE: u16 = 0xBF20;
const SEV: u16 = 0xBF40;

/// Installs all of them.
pub(super) fn install<B: Bus + 'static>(
    core: &mut Core,
    system: &Shared<B>,
    clock: &Rc<Clock>,
    blocks: &Rc<Blocks>,
) -> Result<(), uc_error> {
    install_registers(core, system, clock, PERIPHERALS, PERIPHERALS_SIZE)?;
    install_registers(core, system, clock, PRIVATE, PRIVATE_SIZE)?;
    engine::set_rights(core, clock.clone())?;
    let (programmed, time) = (system.clone(), clock.clone());
    engine::watch_accesses(core, clock.clone(), move |core, address, size, value| {
        programmed.borrow_mut().program(core, &time, address, size, value)
    })?;
    install_blocks(core, clock.clone(), blocks.clone())?;
    install_exceptions(core, clock.clone())
}

fn install_registers<B: Bus + 'static>(
    core: &mut Core,
    system: &Shared<B>,
    clock: &Rc<Clock>,
    base: u32,
    size: u64,
) -> Result<(), uc_error> {
    let (system_read, clock_read) = (system.clone(), clock.clone());
    let (system_write, clock_write) = (system.clone(), clock.clone());
    core.mmio_map(
        base.into(),
        size,
        Some(move |core: &mut Unicorn<'_, ()>, offset: u64, size: usize| {
            let address = base + offset as u32;
            u64::from(
                system_read
                    .borrow_mut()
                    .read(core, &clock_read, address, size as u32),
            )
        }),
        Some(
            move |core: &mut Unicorn<'_, ()>, offset: u64, size: usize, value: u64| {
                let address = base + offset as u32;
                system_write
                    .borrow_mut()
                    .write(core, &clock_write, address, size as u32, value as u32);
            },
        ),
    )
}

/// The cost of a block becomes time when the next one begins: a register sees the time at which
/// its block began.
fn install_blocks(core: &mut Core, clock: Rc<Clock>, blocks: Rc<Blocks>) -> Result<(), uc_error> {
    core.add_block_hook(1, 0, move |core, address, size| {
        let address = address as u32;
        let now = clock.finish_block();
        if clock.must_stop(now, core) {
            return stop(core, &clock, Cause::Boundary);
        }
        let block = blocks.get(address, size, |address, code| {
            engine::load(core, address, code);
        });
        if block.marks != 0 {
            if clock.passed.get() != Some(address) {
                return stop(core, &clock, Cause::Mark(address));
            }
            clock.passed.set(None);
        }
        clock.begin_block(address, size, block.instructions.into(), block.cycles.into());
    })?;
    Ok(())
}

fn stop(core: &mut Unicorn<'_, ()>, clock: &Clock, cause: Cause) {
    clock.cause.set(cause);
    core.emu_stop().expect("a running engine can be stopped");
}

fn install_exceptions(core: &mut Core, clock: Rc<Clock>) -> Result<(), uc_error> {
    let invalid = clock.clone();
    core.add_insn_invalid_hook(move |core| {
        let cause = match hint(core, &invalid) {
            _ if core.get(RegisterARM::EPSR) & 1 << 24 == 0 => Cause::InvalidState,
            Some(YIELD) => return true,
            Some(WFE) if invalid.event.replace(false) => return true,
            Some(WFE) => Cause::WaitForEvent,
            _ => Cause::Undefined,
        };
        stop(core, &invalid, cause);
        true
    })?;
    core.add_intr_hook(move |core, number| {
        const SWI: u32 = 2;
        const BKPT: u32 = 7;
        const EXCEPTION_EXIT: u32 = 8;
        const INVSTATE: u32 = 18;
        let cause = match number {
            SWI => Cause::Supervisor,
            BKPT => Cause::Breakpoint,
            EXCEPTION_EXIT => Cause::ExceptionReturn,
            INVSTATE => Cause::InvalidState,
            _ => Cause::Undefined,
        };
        stop(core, &clock, cause);
    })?;
    Ok(())
}

/// The hint instruction that ended the block, if one did: the pc is already behind it.
fn hint(core: &Unicorn<'_, ()>, clock: &Clock) -> Option<u16> {
    let pc = core.get(RegisterARM::PC);
    let mut code = [0; 2];
    (pc == clock.block_end.get() && engine::load(core, pc.wrapping_sub(2), &mut code))
        .then(|| u16::from_le_bytes(code))
}

/// The engine takes SEV as no operation: its places in this part of the program are watched.
pub(super) fn watch_send_event(
    core: &mut Core,
    clock: &Rc<Clock>,
    address: u32,
    code: &[u8],
) -> Result<(), uc_error> {
    for (i, halfword) in code.chunks_exact(2).enumerate() {
        if u16::from_le_bytes([halfword[0], halfword[1]]) == SEV {
            let address = u64::from(address) + 2 * i as u64;
            let clock = clock.clone();
            core.add_code_hook(address, address, move |_, _, _| clock.event.set(true))?;
        }
    }
    Ok(())
}
