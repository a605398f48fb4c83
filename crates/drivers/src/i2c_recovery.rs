//! A bus whose data line is held low is freed by clocking (I2C-bus specification UM10204, 3.1.16:
//! bus clear).
//!
//! A part that was left in the middle of a byte, by a reset of the processor or a disturbed clock,
//! goes on driving the data line until it has been clocked through that byte. Then a stop condition
//! ends the transfer for all parts.

use core::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{InputPin, OutputPin};

/// Clocks until the longest byte with its acknowledgement is through.
pub const CLOCKS: u32 = 9;

/// Half a period of the clock, in µs: 100 kHz, which every part follows.
const HALF_US: u32 = 5;

/// The longest that [`recover`] waits in all, in µs.
pub const RECOVER_US: u32 = (2 * CLOCKS + 3) * HALF_US;

/// A line that stays low whatever the clock does: a short circuit, or a part that is broken or
/// without power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Held {
    /// SCL. Clocking is not possible.
    Clock,
    /// SDA, after all clocks.
    Data,
}

/// Clocks until the data line is free, at most [`CLOCKS`] times, and sends a stop. Both pins are to
/// be open drain; they are left released.
///
/// # Errors
/// A line that is still held.
pub fn recover<C, D>(clock: &mut C, data: &mut D, delay: &mut impl DelayNs) -> Result<(), Held>
where
    C: InputPin<Error = Infallible> + OutputPin,
    D: InputPin<Error = Infallible> + OutputPin,
{
    let Ok(()) = data.set_high();
    let Ok(()) = clock.set_high();
    delay.delay_us(HALF_US);
    for _ in 0..CLOCKS {
        if is_low(clock) {
            return Err(Held::Clock);
        }
        let Ok(()) = clock.set_low();
        delay.delay_us(HALF_US);
        // While the clock is low, parts say their next bit. Free now is free until the stop.
        let is_free = !is_low(data);
        if is_free {
            let Ok(()) = data.set_low();
            delay.delay_us(HALF_US);
        }
        let Ok(()) = clock.set_high();
        delay.delay_us(HALF_US);
        if is_free {
            return stop(clock, data, delay);
        }
    }
    Err(Held::Data)
}

/// A stop: data, which is low, rises while the clock is high.
fn stop<C, D>(clock: &mut C, data: &mut D, delay: &mut impl DelayNs) -> Result<(), Held>
where
    C: InputPin<Error = Infallible>,
    D: InputPin<Error = Infallible> + OutputPin,
{
    let Ok(()) = data.set_high();
    delay.delay_us(HALF_US);
    match (is_low(clock), is_low(data)) {
        (true, _) => Err(Held::Clock),
        (_, true) => Err(Held::Data),
        _ => Ok(()),
    }
}

fn is_low(pin: &mut impl InputPin<Error = Infallible>) -> bool {
    let Ok(low) = pin.is_low();
    low
}
