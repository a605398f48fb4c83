//! What the linker sees around the steps: an entry that calls them, and the panic handler.

// Linking is the purpose here: a name for the entry, a symbol that does not exist, and volatile
// access, so that nothing is known about the input and nothing of the output is left out.
#![allow(unsafe_code)]

use core::panic::PanicInfo;

use crate::steps::{INPUTS, OUTPUTS, inner_step, outer_step};

static mut INPUT: [f32; INPUTS] = [0.0; INPUTS];
static mut OUTPUT: [f32; OUTPUTS] = [0.0; OUTPUTS];

/// The entry: both steps once, from memory to memory.
#[unsafe(no_mangle)]
extern "C" fn reset() -> ! {
    for step in [inner_step, outer_step] {
        // SAFETY: the statics are touched nowhere else, and here through raw pointers only.
        unsafe {
            let output = step(&(&raw const INPUT).read_volatile());
            (&raw mut OUTPUT).write_volatile(output);
        }
    }
    loop {
        core::hint::spin_loop();
    }
}

unsafe extern "C" {
    /// Defined nowhere: the linker names it when a step can panic.
    safe fn windhover_step_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    windhover_step_can_panic()
}
