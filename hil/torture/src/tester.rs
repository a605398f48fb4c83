//! The only peripheral: the test on the other side of the bus.

/// Interrupts that the tester raises.
pub const LINES: usize = 8;

const BASE: usize = 0x4000_0000;
const SCENARIO: usize = BASE;
/// A random number is read here.
pub const NOISE: usize = BASE + 0x04;
const ACKNOWLEDGE: usize = BASE + 0x08;
/// A storm of interrupts is begun here, or ended by 0.
pub const STORM: usize = BASE + 0x0C;
const REPORT: usize = BASE + 0x10;
const RAISE: usize = BASE + 0x14;
const FINISH: usize = BASE + 0x18;
const RAISE_LATER: usize = BASE + 0x1C;
const FLASH_BUSY: usize = BASE + 0x20;
const FLASH_UNLOCK: usize = BASE + 0x24;

fn read(register: usize) -> u32 {
    // SAFETY: the tester's registers are always there.
    unsafe { (register as *const u32).read_volatile() }
}

fn write(register: usize, value: u32) {
    // SAFETY: as above.
    unsafe { (register as *mut u32).write_volatile(value) }
}

/// What this run is to do.
pub fn scenario() -> u32 {
    read(SCENARIO)
}

/// A random number from the test's seed.
pub fn noise() -> u32 {
    read(NOISE)
}

/// Lowers the request line of an interrupt.
pub fn acknowledge(line: usize) {
    write(ACKNOWLEDGE, line as u32);
}

/// Raises lines at random, about so many ticks apart; 0 ends it.
pub fn storm(ticks: u32) {
    write(STORM, ticks);
}

/// Tells the test a number.
pub fn report(value: u32) {
    write(REPORT, value);
}

/// Raises a line at once; where nothing masks it, its handler has run when this returns.
pub fn raise(line: usize) {
    write(RAISE, line as u32);
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Raises a line in ten microseconds.
pub fn raise_later(line: usize) {
    write(RAISE_LATER, line as u32);
}

/// Flash is busy for so many ticks.
pub fn make_flash_busy(ticks: u32) {
    write(FLASH_BUSY, ticks);
}

/// Stores into flash are allowed from now on.
pub fn unlock_flash() {
    write(FLASH_UNLOCK, 1);
}

/// Ends the run.
pub fn finish() -> ! {
    write(FINISH, 1);
    loop {
        cortex_m::asm::wfi();
    }
}
