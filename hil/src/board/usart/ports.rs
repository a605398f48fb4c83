//! The serial ports and what each has (RM0090 tables 1 and 62).

use super::super::map::Bus;
use super::super::wiring::Usart as Name;

/// What differs from port to port.
pub(in super::super) struct Port {
    pub name: &'static str,
    /// Its name for the wiring.
    pub number: Name,
    pub base: u32,
    pub interrupt: u32,
    pub bus: Bus,
    /// Its bit in the enable and reset registers of its bus.
    pub gate: u32,
}

/// The serial ports.
pub(in super::super) const PORTS: [Port; 4] = [
    port("USART1", 1, 0x4001_1000, 37, Bus::Apb2, 4),
    port("USART2", 2, 0x4000_4400, 38, Bus::Apb1, 17),
    port("USART3", 3, 0x4000_4800, 39, Bus::Apb1, 18),
    port("USART6", 6, 0x4001_1400, 71, Bus::Apb2, 5),
];

const fn port(name: &'static str, number: u8, base: u32, interrupt: u32, bus: Bus, gate: u32) -> Port {
    Port {
        name,
        number: Name(number),
        base,
        interrupt,
        bus,
        gate,
    }
}
