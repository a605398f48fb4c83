//! What happens when the firmware cannot go on: motors off, a note for the next start, reset.
//!
//! The note lies in RAM that no start clears. Whoever starts next takes it out, once, and names
//! the cause in the log and over defmt.

use core::cell::UnsafeCell;
use core::fmt::{self, Write};
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use embassy_stm32::pac::RCC;
use heapless::String;
use windhover_autopilot::ParameterWrite;

use crate::board;

/// Says that a note is a note: no other bits are likely at power-on.
const MAGIC: u32 = 0x57_48_4e_31;

/// The longest text of a note.
const TEXT: usize = 120;

/// What the last run left behind.
#[derive(Clone, Copy)]
#[repr(C)]
struct Note {
    magic: u32,
    length: u32,
    text: [u8; TEXT],
    /// A parameter that the next start is to store: its index, or [`NO_PARAMETER`], and the bits
    /// of its value.
    parameter: [u32; 2],
    /// [`Note::sum`] of all that is before.
    check: u32,
}

const NO_PARAMETER: u32 = u32::MAX;

struct Place(UnsafeCell<MaybeUninit<Note>>);

// SAFETY: it is written by handlers that never return, and read once at the start before any
// interrupt is enabled; no two of them run at the same time.
unsafe impl Sync for Place {}

#[unsafe(link_section = ".uninit.NOTE")]
static NOTE: Place = Place(UnsafeCell::new(MaybeUninit::uninit()));

/// The text of a cause.
pub type Cause = String<TEXT>;

/// What the last run left behind, or the hardware says of it.
pub struct LastRun {
    /// Why the microcontroller started.
    pub cause: Cause,
    /// A parameter that is to be stored before anything else starts.
    pub store: Option<ParameterWrite>,
}

impl Note {
    fn new(text: &str, parameter: [u32; 2]) -> Self {
        let mut note = Self {
            magic: MAGIC,
            length: text.len().min(TEXT) as u32,
            text: [0; TEXT],
            parameter,
            check: 0,
        };
        for (to, from) in note.text.iter_mut().zip(text.bytes()) {
            *to = from;
        }
        note.check = note.sum();
        note
    }

    fn sum(&self) -> u32 {
        let words = self
            .text
            .chunks(4)
            .map(|word| word.iter().fold(0u32, |word, byte| word << 8 | u32::from(*byte)));
        words
            .chain(self.parameter)
            .fold(self.magic ^ self.length, |sum, word| sum.rotate_left(5) ^ word)
    }

    fn text(&self) -> Option<&str> {
        if self.magic != MAGIC || self.check != self.sum() {
            return None;
        }
        core::str::from_utf8(self.text.get(..self.length as usize)?).ok()
    }
}

/// Leaves a note, stops everything and starts anew.
fn give_up(text: &str) -> ! {
    start_anew(text, [NO_PARAMETER, 0])
}

fn start_anew(text: &str, parameter: [u32; 2]) -> ! {
    cortex_m::interrupt::disable();
    board::motors_off();
    // What fails on the way down must not hide why: a log that was interrupted half-way panics when
    // it is used again, and would do so for ever.
    static ON_THE_WAY: AtomicBool = AtomicBool::new(false);
    if !ON_THE_WAY.swap(true, Ordering::Relaxed) {
        let note = Note::new(text, parameter);
        // SAFETY: interrupts are off and nothing returns from here: no one else uses the place.
        unsafe { NOTE.0.get().write_volatile(MaybeUninit::new(note)) };
        defmt::error!("{=str}", text);
    }
    SCB::sys_reset()
}

/// Why the microcontroller started: the last run's note, or the hardware's flags. To be called
/// once, before interrupts use the place; takes the note and clears the flags.
pub fn take_last_run() -> LastRun {
    // SAFETY: runs once at the start, when no fault handler is active. The bits may be anything,
    // and any bits are a valid `Note`, which is all integers; its check says whether it is one.
    let note = unsafe {
        let note = NOTE.0.get().read_volatile().assume_init();
        NOTE.0.get().write_volatile(MaybeUninit::zeroed());
        note
    };
    let flags = RCC.csr().read();
    RCC.csr().modify(|csr| csr.set_rmvf(true));
    let by_hardware = if flags.wdgrstf() {
        "watchdog: the control loops stood still for 250 ms"
    } else if flags.porrstf() {
        "power-on"
    } else if flags.borrstf() {
        "brown-out: the supply fell below 2.7 V"
    } else if flags.sftrstf() {
        "restart by software"
    } else {
        "reset pin"
    };
    let (text, parameter) = match note.text() {
        Some(text) if flags.sftrstf() => (text, note.parameter),
        _ => (by_hardware, [NO_PARAMETER, 0]),
    };
    let mut cause = Cause::new();
    let _ = cause.push_str(text);
    let [index, value] = parameter;
    let store = u16::try_from(index).ok().map(|index| ParameterWrite {
        index,
        value: f32::from_bits(value),
    });
    LastRun { cause, store }
}

/// Starts anew on purpose, as after power-on.
pub fn restart() -> ! {
    give_up("restart by command")
}

/// Starts anew to store a parameter: while flash is written the processor stands still, which
/// neither the watchdog nor the time driver would survive, so it is done before they start.
pub fn restart_to_store(write: &ParameterWrite) -> ! {
    start_anew(
        "restart to store a parameter",
        [u32::from(write.index), write.value.to_bits()],
    )
}

/// Text as far as it fits.
struct Cut<'a>(&'a mut Cause);

impl Write for Cut<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = self.0.capacity() - self.0.len();
        let cut = text.floor_char_boundary(room);
        self.0
            .push_str(text.get(..cut).unwrap_or_default())
            .map_err(|_| fmt::Error)
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::motors_off();
    let mut text = Cause::new();
    // What does not fit is cut: the place comes first.
    let _ = match info.location() {
        Some(at) => write!(
            Cut(&mut text),
            "panic at {}:{}: {}",
            at.file(),
            at.line(),
            info.message()
        ),
        None => write!(Cut(&mut text), "panic: {}", info.message()),
    };
    give_up(&text)
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

/// Names the fault. `stack` is the stack pointer at the fault: the frame lies there, if it could
/// be stacked.
extern "C" fn hard_fault(stack: u32) -> ! {
    cortex_m::interrupt::disable();
    board::motors_off();
    // SAFETY: the fault status registers may be read at any time, without side effects.
    let (cfsr, hfsr, bfar) = unsafe {
        let scb = &*SCB::PTR;
        (scb.cfsr.read(), scb.hfsr.read(), scb.bfar.read())
    };
    let what = match cfsr {
        cfsr if cfsr & STACKING != 0
            || !board::STACK.contains(&stack.wrapping_add(FRAME - 1))
            || !board::STACK.contains(&stack) =>
        {
            "stack overflow"
        }
        cfsr if cfsr & 0xffff_0000 != 0 => "usage fault",
        cfsr if cfsr & 0x0000_ff00 != 0 => "bus fault",
        cfsr if cfsr & 0x0000_00ff != 0 => "memory fault",
        _ => "hard fault",
    };
    let pc = if what == "stack overflow" {
        0
    } else {
        // SAFETY: the frame of eight words lies in the stack, as was just checked.
        unsafe { ((stack + 24) as *const u32).read_volatile() }
    };
    let mut text = Cause::new();
    let _ = write!(
        Cut(&mut text),
        "{what} at {pc:#010x}, cfsr {cfsr:#010x}, hfsr {hfsr:#010x}, bfar {bfar:#010x}"
    );
    give_up(&text)
}

/// CFSR: MSTKERR and STKERR, no frame could be stacked (Armv7-M, B3.2.15).
const STACKING: u32 = 1 << 4 | 1 << 12;

/// Bytes of a basic frame.
const FRAME: u32 = 32;
