//! Calls each function that has a bound: those of `windhover-math` over their arguments, the
//! filter's over a flight, the outer step in a mission; the emulated board counts the instructions
//! of each call. Then it sleeps for ever.
#![no_std]
#![no_main]

mod filter;
mod functions;
mod mission;

use core::panic::PanicInfo;

use cortex_m_rt::entry;

/// What cannot happen stops the run as a fault.
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    cortex_m::asm::udf()
}

#[entry]
fn main() -> ! {
    functions::call();
    filter::fly();
    mission::fly();
    loop {
        cortex_m::asm::wfi();
    }
}

/// What is counted has to do what it is counted for.
fn require(holds: bool) {
    if !holds {
        cortex_m::asm::udf()
    }
}
