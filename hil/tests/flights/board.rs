//! How the firmware sets the board up.

use windhover_hil::board::Memory;
use windhover_hil::flight::Flight;
use windhover_hil::machine::Bus;
use windhover_hil::time::{MICROSECOND, SECOND};

use crate::{firmware, fly, plan};

/// No access to registers needs memory.
struct NoMemory;

impl Memory for NoMemory {
    fn read(&mut self, address: u32, _: &mut [u8]) {
        panic!("{address:#x} is read");
    }
    fn write(&mut self, address: u32, _: &[u8]) {
        panic!("{address:#x} is written");
    }
}

fn register(flight: &Flight, address: u32) -> u32 {
    let now = flight.machine.now();
    let value = flight.machine.bus().read(now, address, 4, &mut NoMemory);
    value.expect("the register is there, and clocked")
}

/// Within 10 us of power-on, with memory not yet set up, the pads of all motors are outputs, and
/// low.
#[test]
fn motor_pins_are_low_before_anything_else() {
    const GPIOB: u32 = 0x4002_0400;
    const PADS: [u32; 4] = [6, 7, 0, 1];
    let mut flight = Flight::new(firmware(), &plan(1.0)).expect("the firmware runs");
    flight.run(10 * MICROSECOND).expect("nothing that it must not do");
    let (mode, output) = (register(&flight, GPIOB), register(&flight, GPIOB + 0x14));
    for pad in PADS {
        assert_eq!(mode >> (2 * pad) & 3, 1, "PB{pad} is an output");
        assert_eq!(output >> pad & 1, 0, "PB{pad} is low");
    }
}

/// Level 3 is written once and stays through a loss of power.
#[test]
fn brown_out_is_at_level_3() {
    let mut flight = Flight::new(firmware(), &plan(1.0)).expect("the firmware runs");
    assert_eq!(flight.machine.bus().brown_out_level(), 3, "off as delivered");
    flight.run(SECOND).expect("nothing that it must not do");
    assert_eq!(flight.machine.bus().brown_out_level(), 0);
    flight.machine.power_cycle();
    assert_eq!(flight.machine.bus().brown_out_level(), 0);
}

/// Pulses at each end of the range, and at a bench's 50 Hz: both timers run at the rate that was
/// asked for, and the vehicle flies on it.
#[test]
fn pulses_come_at_the_rate_of_the_parameter() {
    const TIMERS: [u32; 2] = [0x4000_0400, 0x4000_0800];
    const CLOCK: f64 = 84e6;
    for rate in [50.0f32, 400.0, 490.0] {
        let plan = plan(5.0).with_parameter("MOT_PWM_RATE", rate).expect("a rate");
        let (flight, figures) = fly(&plan);
        for timer in TIMERS {
            let (prescaler, reload) = (register(&flight, timer + 0x28), register(&flight, timer + 0x2C));
            let is = CLOCK / (f64::from(prescaler + 1) * f64::from(reload + 1));
            assert!((is / f64::from(rate) - 1.0).abs() < 1e-3, "{rate} Hz: {is} Hz");
        }
        assert!(figures.replays(), "{rate} Hz: {:?}", figures.replay);
        assert!(
            figures.outcome.height > 3.0 && figures.outcome.stopped,
            "{rate} Hz: {:?}",
            figures.outcome
        );
    }
}
