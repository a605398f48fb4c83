//! Exception entry and return, as Armv7-M has them (DDI 0403, B1.5), with one difference: the
//! frame always holds the floating-point registers too.
//!
//! The engine does not set CONTROL.FPCA when the first floating-point instruction of a context is
//! a conditional one that is skipped; S0 to S15 would be lost. So FPCA is set from reset on. That
//! costs 72 bytes of stack a level where silicon would push the short frame.

use super::bus::Bus;
use super::engine::{self, Registers};
use super::fault::Fault;
use super::nvic::NMI;
use super::scs::scr;
use super::stop::Lockup;
use super::{Machine, State};
use unicorn_engine::RegisterARM;

const INTEGERS: [RegisterARM; 6] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R12,
    RegisterARM::LR,
];
const FLOATS: [RegisterARM; 8] = [
    RegisterARM::D0,
    RegisterARM::D1,
    RegisterARM::D2,
    RegisterARM::D3,
    RegisterARM::D4,
    RegisterARM::D5,
    RegisterARM::D6,
    RegisterARM::D7,
];
const RETURN_ADDRESS: usize = 6;
const STATUS: usize = 7;
const FIRST_FLOAT: usize = 8;
const FLOAT_STATUS: usize = 24;
/// Words of a frame with and without floating-point registers.
const LONG_FRAME: usize = 26;
const SHORT_FRAME: usize = 8;

const FPCA: u32 = 1 << 2;
const SPSEL: u32 = 1 << 1;
const THUMB: u32 = 1 << 24;
const EXCEPTION: u32 = 0x1FF;
/// In a stacked status: the stack pointer was moved by a word to align it.
const REALIGNED: u32 = 1 << 9;

/// EXC_RETURN: to a thread, from the process stack, without floating-point registers.
const TO_THREAD: u32 = 1 << 3;
const FROM_PROCESS_STACK: u32 = 1 << 2;
const SHORT: u32 = 1 << 4;

/// Cycles, an estimate: twelve to enter, ten to leave, and one for each further word.
const ENTRY: u64 = 12 + 17;
const EXIT: u64 = 10 + 17;
const TAIL_CHAIN: u64 = 6;

impl<B: Bus + 'static> Machine<B> {
    /// Takes an exception: pushes the frame and begins the handler. If the frame cannot be
    /// pushed, the fault of that goes first where it is the more urgent of the two.
    pub(super) fn enter(&mut self, number: usize) {
        self.account();
        let priority = self.execution_priority();
        let (pushed, exc_return) = self.push_frame();
        let mut number = number;
        if !pushed {
            let mut system = self.system.borrow_mut();
            if let Some(derived) = Fault::Stacking.note(&mut system.control, priority)
                && derived != number
            {
                let exceptions = &mut system.control.exceptions;
                exceptions.pend(derived);
                if exceptions.preemption_priority(derived) < exceptions.preemption_priority(number) {
                    number = derived;
                }
            }
        }
        self.begin_level();
        self.clock.spend(ENTRY);
        self.begin_handler(number, exc_return);
    }

    /// Pushes the frame of the running context, as far as the stack pointer is in RAM; whether that
    /// was the whole frame, and the EXC_RETURN that will pop it.
    fn push_frame(&mut self) -> (bool, u32) {
        let status = self.core.get(RegisterARM::XPSR);
        let control = self.core.get(RegisterARM::CONTROL);
        let sp = self.core.get(RegisterARM::SP);
        let bottom = sp.wrapping_sub(4 * LONG_FRAME as u32) & !7;
        let mut frame = [0; LONG_FRAME];
        for (word, register) in frame.iter_mut().zip(INTEGERS) {
            *word = self.core.get(register);
        }
        frame[RETURN_ADDRESS] = self.core.get(RegisterARM::PC) & !1;
        frame[STATUS] = status & !REALIGNED | if sp & 4 != 0 { REALIGNED } else { 0 };
        for (pair, register) in frame[FIRST_FLOAT..FLOAT_STATUS].chunks_exact_mut(2).zip(FLOATS) {
            let double = self.core.reg_read(register).expect("a Cortex-M4F has it");
            pair.copy_from_slice(&[double as u32, (double >> 32) as u32]);
        }
        frame[FLOAT_STATUS] = self.core.get(RegisterARM::FPSCR);
        let pushed = frame.iter().enumerate().fold(true, |whole, (i, word)| {
            let address = bottom.wrapping_add(4 * i as u32);
            let there = engine::is_ram(address, 4);
            there && engine::store(&mut self.core, address, &word.to_le_bytes()) && whole
        });
        self.core.set(RegisterARM::SP, bottom);
        self.system.borrow_mut().control.fpcar = bottom.wrapping_add(4 * FIRST_FLOAT as u32);
        let exc_return = match (status & EXCEPTION, control & SPSEL) {
            (0, 0) => 0xFFFF_FFE9,
            (0, _) => 0xFFFF_FFED,
            _ => 0xFFFF_FFE1,
        };
        (pushed, exc_return)
    }

    /// Begins a handler; the frame is on the stack already.
    fn begin_handler(&mut self, number: usize, exc_return: u32) {
        let Some((number, vector)) = self.vector(number) else {
            return self.lock_up();
        };
        let fpdscr = {
            let control = &mut self.system.borrow_mut().control;
            control.exceptions.take(number);
            control.fpdscr
        };
        self.current = number;
        let control = self.core.get(RegisterARM::CONTROL);
        self.core.set(RegisterARM::CONTROL, control | FPCA);
        self.core.set(RegisterARM::FPSCR, fpdscr);
        self.core.set(RegisterARM::IPSR, number as u32);
        self.core
            .set(RegisterARM::EPSR, if vector & 1 != 0 { THUMB } else { 0 });
        self.core.set(RegisterARM::LR, exc_return);
        self.core.set(RegisterARM::PC, vector);
        self.rebuild_flags();
        self.clock.event.set(true);
        self.state = State::Running;
        self.trace.note(self.clock.now.get(), number, vector);
    }

    /// The engine translates by flags that it keeps beside the registers, and only this write
    /// brings up to date.
    fn rebuild_flags(&mut self) {
        let status = self.core.get(RegisterARM::XPSR);
        self.core.set(RegisterARM::APSR_NZCV, status);
    }

    /// The vector of an exception, or HardFault's where that cannot be read.
    fn vector(&mut self, number: usize) -> Option<(usize, u32)> {
        let table = self.system.borrow().control.vtor;
        let read = |number: usize| engine::load_word(&self.core, table.wrapping_add(4 * number as u32));
        if let Some(vector) = read(number) {
            return Some((number, vector));
        }
        let mut system = self.system.borrow_mut();
        let priority = system.control.exceptions.preemption_priority(number);
        let number = Fault::Vector.note(&mut system.control, priority)?;
        read(number).map(|vector| (number, vector))
    }

    /// A handler branched to EXC_RETURN.
    pub(super) fn leave(&mut self) {
        let exc_return = self.core.get(RegisterARM::PC) | 1;
        let number = self.current;
        let valid = self.is_valid_return(exc_return);
        self.system.borrow_mut().control.exceptions.complete(number);
        if number != NMI {
            self.core.set(RegisterARM::FAULTMASK, 0);
        }
        let priority = self.execution_priority();
        let next = self
            .system
            .borrow()
            .control
            .exceptions
            .preempting(priority)
            .filter(|_| valid);
        self.clock.spend(if next.is_some() { TAIL_CHAIN } else { EXIT });
        self.account();
        self.end_level();
        if !valid {
            return self.fault_on_return(Fault::InvalidReturn, exc_return | 0xF000_0000);
        }
        if let Some(next) = next {
            self.begin_level();
            return self.begin_handler(next, exc_return);
        }
        if let Err(fault) = self.pop_frame(exc_return) {
            return self.fault_on_return(fault, exc_return);
        }
        self.clock.event.set(true);
        let sleeps = self.system.borrow().control.scr & scr::SLEEP_ON_EXIT != 0;
        if self.current == 0 && sleeps {
            self.state = State::AsleepForInterrupt;
        }
        self.trace
            .note(self.clock.now.get(), self.current, self.core.get(RegisterARM::PC));
    }

    fn is_valid_return(&self, exc_return: u32) -> bool {
        const NON_BASE_THREAD: u32 = 1;
        let control = &self.system.borrow().control;
        let fits = match exc_return {
            0xFFFF_FFE1 | 0xFFFF_FFF1 => control.exceptions.depth() > 1,
            0xFFFF_FFE9 | 0xFFFF_FFF9 | 0xFFFF_FFED | 0xFFFF_FFFD => {
                control.exceptions.depth() == 1 || control.ccr & NON_BASE_THREAD != 0
            }
            _ => false,
        };
        fits && control.exceptions.is_active(self.current)
    }

    /// A return that fails: the fault's handler begins as if tail-chained.
    fn fault_on_return(&mut self, fault: Fault, exc_return: u32) {
        let priority = self.execution_priority();
        let number = fault.note(&mut self.system.borrow_mut().control, priority);
        self.begin_level();
        match number {
            Some(number) => self.begin_handler(number, exc_return),
            None => self.lock_up(),
        }
    }

    fn pop_frame(&mut self, exc_return: u32) -> Result<(), Fault> {
        let process = exc_return & FROM_PROCESS_STACK != 0;
        let words = if exc_return & SHORT != 0 {
            SHORT_FRAME
        } else {
            LONG_FRAME
        };
        let sp = self.core.get(if process {
            RegisterARM::PSP
        } else {
            RegisterARM::MSP
        });
        let mut frame = [0; LONG_FRAME];
        for (i, word) in frame[..words].iter_mut().enumerate() {
            let address = sp.wrapping_add(4 * i as u32);
            *word = engine::load_word(&self.core, address).ok_or(Fault::Unstacking)?;
        }
        let status = frame[STATUS];
        if (exc_return & TO_THREAD != 0) != (status & EXCEPTION == 0) {
            return Err(Fault::InvalidReturn);
        }
        self.core.set(RegisterARM::IPSR, status & EXCEPTION);
        let thread_on_process_stack = process && exc_return & TO_THREAD != 0;
        let control = self.core.get(RegisterARM::CONTROL) & !SPSEL | FPCA;
        self.core.set(
            RegisterARM::CONTROL,
            control | if thread_on_process_stack { SPSEL } else { 0 },
        );
        if words == LONG_FRAME {
            for (pair, register) in frame[FIRST_FLOAT..FLOAT_STATUS].chunks_exact(2).zip(FLOATS) {
                let double = u64::from(pair[0]) | u64::from(pair[1]) << 32;
                self.core
                    .reg_write(register, double)
                    .expect("a Cortex-M4F has it");
            }
            self.core.set(RegisterARM::FPSCR, frame[FLOAT_STATUS]);
        }
        for (&word, register) in frame.iter().zip(INTEGERS) {
            self.core.set(register, word);
        }
        let realigned = if status & REALIGNED != 0 { 4 } else { 0 };
        self.core
            .set(RegisterARM::SP, sp.wrapping_add(4 * words as u32) | realigned);
        self.core.set(RegisterARM::XPSR_NZCVQG, status);
        self.core.set(
            RegisterARM::PC,
            frame[RETURN_ADDRESS] | u32::from(status & THUMB != 0),
        );
        self.core.set(RegisterARM::APSR_NZCV, status);
        self.current = (status & EXCEPTION) as usize;
        Ok(())
    }

    /// An instruction failed: its fault becomes pending, and is at once the most urgent.
    pub(super) fn fault(&mut self, fault: Fault) {
        let priority = self.execution_priority();
        let number = fault.note(&mut self.system.borrow_mut().control, priority);
        match number {
            Some(number) => self.system.borrow_mut().control.exceptions.pend(number),
            None => self.lock_up(),
        }
    }

    fn lock_up(&mut self) {
        self.account();
        let place = self.place(self.core.get(RegisterARM::PC));
        self.lockups.push(Lockup { place });
        self.state = State::Lockup;
    }

    pub(super) fn execution_priority(&self) -> i16 {
        self.system
            .borrow()
            .control
            .exceptions
            .execution_priority(self.core.masks())
    }
}
