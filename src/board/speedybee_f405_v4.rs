//! SpeedyBee F405 V4: STM32F405RG, 8 MHz crystal.
//!
//! Pins as in ArduPilot's `speedybeef4v4/hwdef.dat` and Betaflight's `SPEEDYBEEF405V4/config.h`.
//!
//! | pad | pin | timer |
//! |---|---|---|
//! | M1 | PB6 | TIM4 channel 1 |
//! | M2 | PB7 | TIM4 channel 2 |
//! | M3 | PB0 | TIM3 channel 3 |
//! | M4 | PB1 | TIM3 channel 4 |

use embassy_stm32::pac::gpio::vals::{Moder, Ot};
use embassy_stm32::pac::{GPIOB, RCC};

/// The board's name, as its maker writes it.
pub const NAME: &str = "SpeedyBee F405 V4";

/// Pads M1 to M4: their pin numbers on port B.
const MOTOR_PINS: [usize; 4] = [6, 7, 0, 1];

/// Drives the motor pins low: an electronic speed controller that sees no pulse does not turn.
///
/// It needs no clock setup and no driver, so it can be the first thing that runs, and it may be
/// called at any time. The level is set before the direction, so that no pin goes high meanwhile.
pub fn motors_off() {
    RCC.ahb1enr().modify(|enable| enable.set_gpioben(true));
    RCC.ahb1enr().read(); // errata: a port answers two cycles after its clock is enabled
    GPIOB.bsrr().write(|set| {
        for pin in MOTOR_PINS {
            set.set_br(pin, true);
        }
    });
    GPIOB.otyper().modify(|kind| {
        for pin in MOTOR_PINS {
            kind.set_ot(pin, Ot::PUSH_PULL);
        }
    });
    GPIOB.moder().modify(|mode| {
        for pin in MOTOR_PINS {
            mode.set_moder(pin, Moder::OUTPUT);
        }
    });
}
