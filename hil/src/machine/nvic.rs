//! Exceptions of the Armv7-M processor: which are pending, enabled and active, and which is next.

use super::engine::Masks;

/// Interrupts of the STM32F405.
pub(super) const INTERRUPTS: usize = 82;
/// Exception number of interrupt 0.
pub(super) const FIRST_INTERRUPT: usize = 16;
/// One more than the highest exception number.
pub const EXCEPTIONS: usize = FIRST_INTERRUPT + INTERRUPTS;

pub(super) const NMI: usize = 2;
pub(super) const HARD_FAULT: usize = 3;
pub(super) const MEM_MANAGE: usize = 4;
pub(super) const BUS_FAULT: usize = 5;
pub(super) const USAGE_FAULT: usize = 6;
pub(super) const SV_CALL: usize = 11;
pub(super) const PEND_SV: usize = 14;
pub(super) const SYS_TICK: usize = 15;

/// Priority of a thread that nothing masks: below every exception. Lower is more urgent.
pub(super) const THREAD_PRIORITY: i16 = 256;

const fn bit(number: usize) -> u128 {
    1 << number
}

const ALL: u128 = bit(EXCEPTIONS) - 1;
const SYSTEM: u128 = bit(FIRST_INTERRUPT) - 1;

/// Sets of exceptions have bit n for exception number n.
#[derive(Clone, Debug)]
pub(super) struct Exceptions {
    pending: u128,
    enabled: u128,
    active: u128,
    lines: u128,
    priorities: [u8; EXCEPTIONS],
    group: u8,
    /// What may run next may have changed.
    pub changed: bool,
    /// Something became pending, for SEVONPEND.
    pub newly_pending: bool,
}

impl Exceptions {
    pub fn new() -> Self {
        Self {
            pending: 0,
            enabled: SYSTEM,
            active: 0,
            lines: 0,
            priorities: [0; EXCEPTIONS],
            group: 0,
            changed: false,
            newly_pending: false,
        }
    }

    /// The levels of the interrupt request lines. A rising edge makes an interrupt pending; a line
    /// that is still high when its handler returns does it again.
    pub fn set_lines(&mut self, interrupts: u128) {
        let lines = (interrupts << FIRST_INTERRUPT) & ALL;
        let rising = lines & !self.lines;
        self.lines = lines;
        if rising != 0 {
            self.pend_all(rising);
        }
    }

    fn pend_all(&mut self, exceptions: u128) {
        let new = exceptions & !self.pending;
        self.pending |= new;
        self.newly_pending |= new != 0;
        self.changed |= new & self.enabled != 0;
    }

    pub fn pend(&mut self, number: usize) {
        self.pend_all(bit(number));
    }

    pub fn unpend(&mut self, number: usize) {
        self.pending &= !bit(number);
    }

    pub fn is_pending(&self, number: usize) -> bool {
        self.pending & bit(number) != 0
    }

    pub fn is_active(&self, number: usize) -> bool {
        self.active & bit(number) != 0
    }

    /// How many exceptions are active: how deep handlers are nested.
    pub fn depth(&self) -> u32 {
        self.active.count_ones()
    }

    /// Whether an enabled interrupt is pending, `ICSR.ISRPENDING`.
    pub fn interrupt_pending(&self) -> bool {
        self.pending & self.enabled & !SYSTEM != 0
    }

    pub fn take(&mut self, number: usize) {
        self.unpend(number);
        self.active |= bit(number);
    }

    pub fn complete(&mut self, number: usize) {
        self.active &= !bit(number);
        self.pend_all(self.lines & bit(number));
        self.changed = true;
    }

    pub fn set_group(&mut self, group: u8) {
        self.group = group & 7;
        self.changed = true;
    }

    pub fn group(&self) -> u8 {
        self.group
    }

    /// Sets a priority; four bits exist.
    pub fn set_priority(&mut self, number: usize, priority: u8) {
        if let Some(entry) = self.priorities.get_mut(number) {
            *entry = priority & 0xF0;
            self.changed = true;
        }
    }

    pub fn priority(&self, number: usize) -> u8 {
        self.priorities.get(number).copied().unwrap_or(0)
    }

    fn group_priority(&self, priority: u8) -> i16 {
        i16::from(priority & !(((2_u16 << self.group) - 1) as u8))
    }

    /// What counts when one exception is to preempt another.
    pub fn preemption_priority(&self, number: usize) -> i16 {
        match number {
            NMI => -2,
            HARD_FAULT => -1,
            _ => self.group_priority(self.priority(number)),
        }
    }

    /// Priority at which the processor executes.
    pub fn execution_priority(&self, masks: Masks) -> i16 {
        let mut priority = members(self.active)
            .map(|number| self.preemption_priority(number))
            .fold(THREAD_PRIORITY, Ord::min);
        if masks.basepri != 0 {
            priority = priority.min(self.group_priority(masks.basepri));
        }
        if masks.primask {
            priority = priority.min(0);
        }
        if masks.faultmask {
            priority = priority.min(-1);
        }
        priority
    }

    /// The pending and enabled exception that comes first.
    pub fn first_pending(&self) -> Option<usize> {
        members(self.pending & self.enabled)
            .min_by_key(|&number| (self.preemption_priority(number), self.priority(number), number))
    }

    /// The pending exception that preempts execution at this priority.
    pub fn preempting(&self, priority: i16) -> Option<usize> {
        self.first_pending()
            .filter(|&number| self.preemption_priority(number) < priority)
    }

    /// 32 interrupts of a register of the NVIC from the given one on.
    pub fn read(&self, set: Set, first: usize) -> u32 {
        let set = match set {
            Set::Enabled => self.enabled,
            Set::Pending => self.pending,
            Set::Active => self.active,
        };
        ((set & ALL) >> (FIRST_INTERRUPT + first)) as u32
    }

    /// Writes ones to a set or clear register of the NVIC.
    pub fn write(&mut self, set: Set, first: usize, ones: u32, on: bool) {
        let ones = (u128::from(ones) << (FIRST_INTERRUPT + first)) & ALL;
        match (set, on) {
            (Set::Enabled, true) => {
                self.enabled |= ones;
                self.changed = true;
            }
            (Set::Enabled, false) => self.enabled &= !ones,
            (Set::Pending, true) => self.pend_all(ones),
            // A line that is high keeps its interrupt pending.
            (Set::Pending, false) => self.pending &= !(ones & !(self.lines & !self.active)),
            (Set::Active, _) => {}
        }
    }
}

/// The sets of interrupts that the NVIC shows.
#[derive(Clone, Copy, Debug)]
pub(super) enum Set {
    Enabled,
    Pending,
    Active,
}

fn members(mut set: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let number = (set != 0).then(|| set.trailing_zeros() as usize);
        set &= set.wrapping_sub(1);
        number
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: Masks = Masks {
        primask: false,
        faultmask: false,
        basepri: 0,
    };

    fn with(interrupts: &[(usize, u8)]) -> Exceptions {
        let mut exceptions = Exceptions::new();
        for &(interrupt, priority) in interrupts {
            exceptions.set_priority(FIRST_INTERRUPT + interrupt, priority);
            exceptions.write(Set::Enabled, interrupt / 32 * 32, 1 << (interrupt % 32), true);
        }
        exceptions
    }

    #[test]
    fn the_more_urgent_of_two_pending_interrupts_comes_first() {
        let mut exceptions = with(&[(3, 0x40), (70, 0x30)]);
        exceptions.set_lines(1 << 3 | 1 << 70);
        assert_eq!(exceptions.preempting(THREAD_PRIORITY), Some(86));
    }

    #[test]
    fn of_equal_priorities_the_lower_number_comes_first() {
        let mut exceptions = with(&[(3, 0x40), (70, 0x40)]);
        exceptions.set_lines(1 << 3 | 1 << 70);
        assert_eq!(exceptions.preempting(THREAD_PRIORITY), Some(19));
    }

    #[test]
    fn only_four_bits_of_a_priority_exist() {
        let mut exceptions = Exceptions::new();
        exceptions.set_priority(20, 0xFF);
        assert_eq!(exceptions.priority(20), 0xF0);
    }

    #[test]
    fn subpriority_orders_but_does_not_preempt() {
        let mut exceptions = with(&[(1, 0x40), (2, 0x50)]);
        exceptions.set_group(5);
        exceptions.set_lines(0b110);
        assert_eq!(exceptions.preempting(THREAD_PRIORITY), Some(17));
        exceptions.take(18);
        assert_eq!(exceptions.preempting(exceptions.execution_priority(OPEN)), None);
    }

    #[test]
    fn a_line_that_stays_high_is_pending_again_after_its_handler() {
        let mut exceptions = with(&[(5, 0)]);
        exceptions.set_lines(1 << 5);
        exceptions.take(21);
        assert!(!exceptions.is_pending(21));
        exceptions.complete(21);
        assert!(exceptions.is_pending(21));
    }

    #[test]
    fn a_line_that_fell_leaves_its_interrupt_pending_once() {
        let mut exceptions = with(&[(5, 0)]);
        exceptions.set_lines(1 << 5);
        exceptions.set_lines(0);
        assert!(exceptions.is_pending(21));
        exceptions.take(21);
        exceptions.complete(21);
        assert!(!exceptions.is_pending(21));
    }

    #[test]
    fn clearing_pending_does_nothing_while_the_line_is_high() {
        let mut exceptions = with(&[(5, 0)]);
        exceptions.set_lines(1 << 5);
        exceptions.write(Set::Pending, 0, 1 << 5, false);
        assert!(exceptions.is_pending(21));
        exceptions.set_lines(0);
        exceptions.write(Set::Pending, 0, 1 << 5, false);
        assert!(!exceptions.is_pending(21));
    }

    #[test]
    fn masks_raise_the_priority_of_execution() {
        let exceptions = Exceptions::new();
        let at = |masks| exceptions.execution_priority(masks);
        assert_eq!(at(OPEN), THREAD_PRIORITY);
        assert_eq!(
            at(Masks {
                basepri: 0x50,
                ..OPEN
            }),
            0x50
        );
        assert_eq!(
            at(Masks {
                primask: true,
                ..OPEN
            }),
            0
        );
        assert_eq!(
            at(Masks {
                faultmask: true,
                ..OPEN
            }),
            -1
        );
    }
}
