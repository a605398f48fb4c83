//! Places, by number, for what is remembered of each peripheral that has events or interrupts.

use super::map::Unit;
use super::timer::kinds::TIMERS;
use super::usart::PORTS;

/// How many there are.
pub(super) const SLOTS: usize = 27;

/// The peripherals that have events or interrupts, each at its place in [`Chip::next_events`].
pub(super) const UNITS: [Unit; SLOTS] = units();

const fn units() -> [Unit; SLOTS] {
    let mut units = [Unit::Iwdg; SLOTS];
    let mut timer = 0;
    while timer < TIMERS.len() {
        units[timer] = Unit::Timer(timer);
        timer += 1;
    }
    let mut port = 0;
    while port < PORTS.len() {
        units[TIMERS.len() + port] = Unit::Usart(port);
        port += 1;
    }
    units[18] = Unit::Spi1;
    units[19] = Unit::Dma(0);
    units[20] = Unit::Dma(1);
    units[21] = Unit::Exti;
    units[22] = Unit::Rcc;
    units[23] = Unit::Flash;
    units[25] = Unit::I2c1;
    units[26] = Unit::Adc1;
    units
}

/// The bit of a peripheral in a set of them: zero for those with neither events nor interrupts.
pub(super) fn slot(unit: Unit) -> u32 {
    slot_index(unit).map_or(0, |index| 1 << index)
}

/// The place of a peripheral.
fn slot_index(unit: Unit) -> Option<usize> {
    Some(match unit {
        Unit::Timer(index) => index,
        Unit::Usart(index) => 14 + index,
        Unit::Spi1 => 18,
        Unit::Dma(index) => 19 + index,
        Unit::Exti => 21,
        Unit::Rcc => 22,
        Unit::Flash => 23,
        Unit::Iwdg => 24,
        Unit::I2c1 => 25,
        Unit::Adc1 => 26,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_place_belongs_to_the_peripheral_that_has_it() {
        for (index, unit) in UNITS.into_iter().enumerate() {
            assert_eq!(slot_index(unit), Some(index), "{unit:?}");
        }
    }
}
