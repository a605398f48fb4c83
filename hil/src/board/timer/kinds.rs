//! The fourteen timers and what each has (RM0090 chapters 17 to 20, table 62).

use super::super::map::Bus;

/// What differs from timer to timer.
pub(in super::super) struct Kind {
    pub name: &'static str,
    pub base: u32,
    pub bus: Bus,
    /// Its bit in the enable and reset registers of its bus.
    pub gate: u32,
    pub channels: usize,
    /// The highest count.
    pub top: u32,
    /// Whether outputs have complements and need the main output enable.
    pub advanced: bool,
    /// The interrupt of the update event.
    pub update_interrupt: u32,
    /// The interrupt of the compare events.
    pub compare_interrupt: u32,
}

const BITS_16: u32 = 0xFFFF;
const BITS_32: u32 = 0xFFFF_FFFF;

/// TIM1 to TIM14, in order.
pub(in super::super) const TIMERS: [Kind; 14] = [
    advanced("TIM1", 0x4001_0000, 0, 25, 27),
    general("TIM2", 0x4000_0000, (Bus::Apb1, 0), 4, BITS_32, 28),
    general("TIM3", 0x4000_0400, (Bus::Apb1, 1), 4, BITS_16, 29),
    general("TIM4", 0x4000_0800, (Bus::Apb1, 2), 4, BITS_16, 30),
    general("TIM5", 0x4000_0C00, (Bus::Apb1, 3), 4, BITS_32, 50),
    general("TIM6", 0x4000_1000, (Bus::Apb1, 4), 0, BITS_16, 54),
    general("TIM7", 0x4000_1400, (Bus::Apb1, 5), 0, BITS_16, 55),
    advanced("TIM8", 0x4001_0400, 1, 44, 46),
    general("TIM9", 0x4001_4000, (Bus::Apb2, 16), 2, BITS_16, 24),
    general("TIM10", 0x4001_4400, (Bus::Apb2, 17), 1, BITS_16, 25),
    general("TIM11", 0x4001_4800, (Bus::Apb2, 18), 1, BITS_16, 26),
    general("TIM12", 0x4000_1800, (Bus::Apb1, 6), 2, BITS_16, 43),
    general("TIM13", 0x4000_1C00, (Bus::Apb1, 7), 1, BITS_16, 44),
    general("TIM14", 0x4000_2000, (Bus::Apb1, 8), 1, BITS_16, 45),
];

const fn advanced(name: &'static str, base: u32, gate: u32, update: u32, compare: u32) -> Kind {
    Kind {
        name,
        base,
        bus: Bus::Apb2,
        gate,
        channels: 4,
        top: BITS_16,
        advanced: true,
        update_interrupt: update,
        compare_interrupt: compare,
    }
}

const fn general(
    name: &'static str,
    base: u32,
    (bus, gate): (Bus, u32),
    channels: usize,
    top: u32,
    interrupt: u32,
) -> Kind {
    Kind {
        name,
        base,
        bus,
        gate,
        channels,
        top,
        advanced: false,
        update_interrupt: interrupt,
        compare_interrupt: interrupt,
    }
}
