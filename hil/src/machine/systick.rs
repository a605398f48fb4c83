//! SysTick: a counter of 24 bits that counts down, in cycles of the free-running clock.

use crate::time::NEVER;

const ENABLE: u32 = 1;
const TICKINT: u32 = 1 << 1;
const CLKSOURCE: u32 = 1 << 2;
const COUNTFLAG: u32 = 1 << 16;
const BITS: u32 = 0x00FF_FFFF;

/// Its registers, and when it reaches zero.
#[derive(Clone, Debug, Default)]
pub(super) struct SysTick {
    control: u32,
    reload: u32,
    counted_to_zero: bool,
    /// Value while it stands.
    held: u32,
    /// Cycle at which it next reaches zero, while it runs.
    zero: u64,
}

impl SysTick {
    fn running(&self) -> bool {
        self.control & ENABLE != 0
    }

    /// Cycles of the free-running clock in one count.
    fn divider(&self) -> u64 {
        if self.control & CLKSOURCE != 0 { 1 } else { 8 }
    }

    fn period(&self) -> u64 {
        (u64::from(self.reload) + 1) * self.divider()
    }

    /// Brings it to the present; true if it demands its exception.
    pub fn advance(&mut self, cycle: u64) -> bool {
        if !self.running() || self.reload == 0 || cycle < self.zero {
            return false;
        }
        let periods = (cycle - self.zero) / self.period() + 1;
        self.zero += periods * self.period();
        self.counted_to_zero = true;
        self.control & TICKINT != 0
    }

    /// Cycle at which it will demand its exception.
    pub fn next(&self) -> u64 {
        if self.running() && self.reload != 0 && self.control & TICKINT != 0 {
            self.zero
        } else {
            NEVER
        }
    }

    fn value(&self, cycle: u64) -> u32 {
        if !self.running() {
            return self.held;
        }
        let left = self.zero.saturating_sub(cycle).div_ceil(self.divider()) as u32;
        if left > self.reload { 0 } else { left }
    }

    /// From this value it counts on.
    fn start(&mut self, cycle: u64, value: u32) {
        let counts = if value == 0 { self.reload + 1 } else { value };
        self.zero = cycle + u64::from(counts) * self.divider();
    }

    /// `SYST_CSR`; reading clears COUNTFLAG.
    pub fn read_control(&mut self) -> u32 {
        self.control
            | if std::mem::take(&mut self.counted_to_zero) {
                COUNTFLAG
            } else {
                0
            }
    }

    pub fn write_control(&mut self, cycle: u64, value: u32) {
        let counted = self.value(cycle);
        self.control = value & (ENABLE | TICKINT | CLKSOURCE);
        self.held = counted;
        self.start(cycle, counted);
    }

    pub fn read_reload(&self) -> u32 {
        self.reload
    }

    pub fn write_reload(&mut self, value: u32) {
        self.reload = value & BITS;
    }

    pub fn read_value(&self, cycle: u64) -> u32 {
        self.value(cycle)
    }

    /// Any write clears the counter and COUNTFLAG.
    pub fn write_value(&mut self, cycle: u64) {
        self.held = 0;
        self.counted_to_zero = false;
        self.start(cycle, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn running(reload: u32) -> SysTick {
        let mut systick = SysTick::default();
        systick.write_reload(reload);
        systick.write_value(0);
        systick.write_control(0, ENABLE | TICKINT | CLKSOURCE);
        systick
    }

    #[test]
    fn demands_its_exception_once_in_a_period() {
        let mut systick = running(99);
        assert!(!systick.advance(99));
        assert!(systick.advance(100));
        assert!(!systick.advance(199));
        assert!(systick.advance(200));
    }

    #[test]
    fn counts_down() {
        let systick = running(99);
        assert_eq!(systick.read_value(1), 99);
        assert_eq!(systick.read_value(2), 98);
        assert_eq!(systick.read_value(99), 1);
        assert_eq!(systick.read_value(100), 0);
    }

    #[test]
    fn the_count_flag_is_cleared_by_reading() {
        let mut systick = running(9);
        systick.advance(10);
        assert_ne!(systick.read_control() & COUNTFLAG, 0);
        assert_eq!(systick.read_control() & COUNTFLAG, 0);
    }

    #[test]
    fn with_the_external_clock_it_is_eight_times_slower() {
        let mut systick = running(9);
        systick.write_control(0, ENABLE | TICKINT);
        assert!(!systick.advance(79));
        assert!(systick.advance(80));
    }
}
