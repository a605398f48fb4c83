//! What happens when the firmware cannot go on: motors off, a record for the next start, reset.
//!
//! The record lies in RAM that no start clears, beside a count of how far the run has come, which
//! speaks where the watchdog lets no handler run. Whoever starts next takes both out, once, and names
//! the cause over defmt, in the log and to ground stations.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::peripheral::{NVIC, SCB};
use embassy_stm32::pac::RCC;
use static_cell::StaticCell;
use windhover_fault_record::{
    Cause, Fault, Flags, Frame, Packed, Progress, Reason, Record, Task, Text, most_urgent,
};

use crate::board;

struct Place(UnsafeCell<MaybeUninit<Packed>>);

// SAFETY: it is written by handlers that never return, and read once at the start before any
// interrupt is enabled; no two of them run at the same time.
unsafe impl Sync for Place {}

#[unsafe(link_section = ".uninit.RECORD")]
static RECORD: Place = Place(UnsafeCell::new(MaybeUninit::uninit()));

/// Counts of a run's progress; each has one writer.
pub struct Counts {
    /// Ticks of the inner loop.
    pub tick: AtomicU32,
    /// What `tick` was when the last outer step ended.
    pub outer: AtomicU32,
    /// Bytes of the log that were handed to its port.
    pub log: AtomicU32,
}

/// How far this run has come. Cleared by no reset, but by [`take_last_run`].
#[unsafe(link_section = ".uninit.PROGRESS")]
pub static PROGRESS: Counts = Counts {
    tick: AtomicU32::new(0),
    outer: AtomicU32::new(0),
    log: AtomicU32::new(0),
};

impl Counts {
    fn progress(&self) -> Progress {
        // SAFETY: a word that is always there, of which any bits are a number. Volatile: what it holds
        // at the start is not what the compiler knows of.
        let value = |count: &AtomicU32| unsafe { count.as_ptr().read_volatile() };
        Progress {
            tick: value(&self.tick),
            outer: value(&self.outer),
            log: value(&self.log),
        }
    }

    fn clear(&self) {
        for count in [&self.tick, &self.outer, &self.log] {
            count.store(0, Ordering::Relaxed);
        }
    }
}

/// What the last run left behind, and the hardware says of it.
pub struct LastRun {
    /// Why the microcontroller started.
    pub cause: &'static str,
    /// Whether that is to be told to ground stations.
    pub is_trouble: bool,
}

/// Leaves a record, stops everything and starts anew.
fn give_up(reason: Reason) -> ! {
    cortex_m::interrupt::disable();
    board::motors_off();
    // What fails on the way down must not hide why: a log that was interrupted half-way panics when
    // it is used again, and would do so for ever.
    static ON_THE_WAY: AtomicBool = AtomicBool::new(false);
    if !ON_THE_WAY.swap(true, Ordering::Relaxed) {
        let record = Record {
            reason,
            task: running(),
            progress: PROGRESS.progress(),
        };
        let packed = Packed::new(&record);
        // SAFETY: interrupts are off and nothing returns from here: no one else uses the place.
        unsafe { RECORD.0.get().write_volatile(MaybeUninit::new(packed)) };
        defmt::error!("{=str}", Text::new(format_args!("{record}")).as_str());
    }
    SCB::sys_reset()
}

/// Words that say which of the microcontroller's 82 interrupts are active; there are no more.
const ACTIVE_WORDS: usize = 82usize.div_ceil(32);

/// What runs.
fn running() -> Task {
    // SAFETY: which interrupts are active, and how urgent they are, may be read at any time.
    let nvic = unsafe { &*NVIC::PTR };
    let mut active = [0; ACTIVE_WORDS];
    for (to, from) in active.iter_mut().zip(&nvic.iabr) {
        *to = from.read();
    }
    let priority = |number: u16| nvic.ipr.get(usize::from(number)).map_or(0, |it| it.read());
    match most_urgent(&active, &priority) {
        None => Task::Thread,
        Some(board::INNER_INTERRUPT) => Task::Inner,
        Some(board::OUTER_INTERRUPT) => Task::Outer,
        Some(board::LOG_INTERRUPT) => Task::Log,
        Some(number) => Task::Interrupt(number),
    }
}

/// Why the microcontroller started. To be called once, before interrupts use the places; takes the
/// record, begins the counts and clears the hardware's flags.
///
/// A function of its own: `main`, which never ends, keeps nothing of it on the stack.
#[inline(never)]
pub fn take_last_run() -> LastRun {
    static TEXT: StaticCell<Text> = StaticCell::new();
    // SAFETY: runs once at the start, when no fault handler is active. The bits may be anything,
    // and any bits are a valid `Packed`, which is all integers; its check says whether it is one.
    let packed = unsafe {
        let packed = RECORD.0.get().read_volatile().assume_init();
        RECORD.0.get().write_volatile(MaybeUninit::new(Packed::NONE));
        packed
    };
    let progress = PROGRESS.progress();
    PROGRESS.clear();
    let flags = RCC.csr().read();
    RCC.csr().modify(|csr| csr.set_rmvf(true));
    let flags = Flags {
        watchdog: flags.wdgrstf(),
        power_on: flags.porrstf(),
        brown_out: flags.borrstf(),
        software: flags.sftrstf(),
    };
    let cause = Cause::new(flags, packed.unpack(), progress);
    LastRun {
        cause: TEXT.init_with(|| Text::new(format_args!("{cause}"))).as_str(),
        is_trouble: cause.is_trouble(),
    }
}

/// Starts anew on purpose, as after power-on.
pub fn restart() -> ! {
    give_up(Reason::Restart)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::motors_off();
    // What does not fit is cut: the place comes first.
    let message = info.message();
    give_up(Reason::Panic(match info.location() {
        Some(at) => Text::message(format_args!("at {}:{}: {message}", at.file(), at.line())),
        None => Text::message(format_args!("{message}")),
    }))
}

// Takes the motors off before anything else: before memory is set up, before clocks. It is sound
// since `motors_off` writes registers alone, and what is cleared then nobody uses yet.
core::arch::global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "b {motors_off}",
    motors_off = sym before_memory,
);

extern "C" fn before_memory() {
    board::motors_off();
    board::clear_core_coupled();
}

/// The processor's HardFault vector. The stack may be what failed: it is taken from its top again
/// before anything is pushed.
// SAFETY: the name is the vector table's; the function touches registers only and does not return.
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
#[unsafe(link_section = ".HardFault.windhover")]
unsafe extern "C" fn hard_fault_vector() -> ! {
    core::arch::naked_asm!(
        "mov r0, sp",
        "ldr r1, =_stack_start",
        "mov sp, r1",
        "b {handler}",
        handler = sym hard_fault,
    )
}

/// Takes the registers. `stack` is the stack pointer at the fault: the frame lies there, if it could
/// be stacked.
extern "C" fn hard_fault(stack: u32) -> ! {
    cortex_m::interrupt::disable();
    board::motors_off();
    // SAFETY: the fault status registers may be read at any time, without side effects.
    let (cfsr, hfsr, address) = unsafe {
        let scb = &*SCB::PTR;
        let by_bus = scb.cfsr.read() & BUS_ADDRESS != 0;
        let address = if by_bus { &scb.bfar } else { &scb.mmfar };
        (scb.cfsr.read(), scb.hfsr.read(), address.read())
    };
    let lies_in_stack =
        board::STACK.contains(&stack) && board::STACK.contains(&stack.wrapping_add(FRAME - 1));
    let frame = (Fault::is_stacked(cfsr) && lies_in_stack).then(|| {
        // SAFETY: the frame of eight words lies in the stack, as was just checked, and the processor
        // aligns it.
        let [r0, r1, r2, r3, r12, lr, pc, xpsr] = unsafe { (stack as *const [u32; 8]).read_volatile() };
        Frame {
            r: [r0, r1, r2, r3],
            r12,
            lr,
            pc,
            xpsr,
        }
    });
    give_up(Reason::Fault(Fault {
        frame,
        cfsr,
        hfsr,
        address,
    }))
}

/// CFSR: BFARVALID (Armv7-M, B3.2.15).
const BUS_ADDRESS: u32 = 1 << 15;

/// Bytes of a basic frame.
const FRAME: u32 = 32;
