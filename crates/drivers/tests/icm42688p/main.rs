//! The driver of the ICM-42688-P on the register model of the part, one test a statement.
//! Register values are those of the data sheet DS-000347 rev. 1.7.

mod bench;

use std::pin::pin;

use bench::{Driver, Handle, MS, Overrun, US, bench, poll_once, run};
use windhover_drivers::icm42688p::{
    Bank, CONFIGURE_ATTEMPTS, CONFIGURE_US, Error, OutputDataRate, Register, Sample,
};
use windhover_model::sensor::icm42688p::{DataLine, Measurement};

const RATES: [OutputDataRate; 4] = [
    OutputDataRate::Hz1000,
    OutputDataRate::Hz2000,
    OutputDataRate::Hz4000,
    OutputDataRate::Hz8000,
];

fn configure(desk: &Handle, driver: &mut Driver, rate: OutputDataRate) -> Result<(), Error<Overrun>> {
    run(driver.configure(rate, &mut desk.clone()))
}

/// A part that samples at this rate.
fn configured(rate: OutputDataRate) -> (Handle, Driver) {
    let (desk, mut driver) = bench();
    assert_eq!(configure(&desk, &mut driver, rate), Ok(()));
    (desk, driver)
}

#[test]
fn configuration_is_within_the_data_sheet() {
    for rate in RATES {
        let (desk, _) = configured(rate);
        assert_eq!(desk.0.borrow().part.misuse(), [], "{rate:?}");
    }
}

#[test]
fn registers_hold_what_the_data_sheet_wants() {
    // Per rate: code of the rate; the gyroscope's DELT, low byte of DELTSQR, BITSHIFT and high
    // bits of DELTSQR (section 5.3: 258, 536, 997 and 1962 Hz).
    let expected = [
        (OutputDataRate::Hz1000, 0x06, 6, 36, 0xA0),
        (OutputDataRate::Hz2000, 0x05, 12, 144, 0x80),
        (OutputDataRate::Hz4000, 0x04, 21, 0xB8, 0x61),
        (OutputDataRate::Hz8000, 0x03, 37, 0x60, 0x45),
    ];
    for (rate, code, delt, low, high) in expected {
        let (desk, _) = configured(rate);
        let part = &desk.0.borrow().part;
        let registers = [
            (0, 0x14, 0x03, "INT_CONFIG: INT1 pulsed, push-pull, active high"),
            (0, 0x4C, 0x33, "INTF_CONFIG0: big endian, no I2C"),
            (
                0,
                0x4D,
                0x51,
                "INTF_CONFIG1: AFSR off, PLL, the rest as after a reset",
            ),
            (0, 0x4E, 0x0F, "PWR_MGMT0: both sensors in low-noise mode"),
            (0, 0x4F, code, "GYRO_CONFIG0: ±2000 °/s"),
            (0, 0x50, code, "ACCEL_CONFIG0: ±16 g"),
            (0, 0x51, 0x16, "GYRO_CONFIG1: as after a reset"),
            (
                0,
                0x52,
                0x1F,
                "GYRO_ACCEL_CONFIG0: ODR/4, and low latency for the gyroscope",
            ),
            (0, 0x53, 0x0D, "ACCEL_CONFIG1: as after a reset, second order"),
            (0, 0x63, 0x00, "INT_CONFIG0: cleared by the status"),
            (
                0,
                0x64,
                0x60,
                "INT_CONFIG1: 8 µs, no rest, INT_ASYNC_RESET cleared",
            ),
            (0, 0x65, 0x08, "INT_SOURCE0: data ready on INT1, nothing else"),
            (1, 0x0B, 0xA0, "GYRO_CONFIG_STATIC2: both filters on"),
            (1, 0x0C, delt, "GYRO_CONFIG_STATIC3"),
            (1, 0x0D, low, "GYRO_CONFIG_STATIC4"),
            (1, 0x0E, high, "GYRO_CONFIG_STATIC5"),
            (2, 0x03, 0x0C, "ACCEL_CONFIG_STATIC2: 258 Hz, on"),
            (2, 0x04, 36, "ACCEL_CONFIG_STATIC3"),
            (2, 0x05, 0xA0, "ACCEL_CONFIG_STATIC4"),
        ];
        for (bank, address, value, name) in registers {
            assert_eq!(part.register(bank, address), value, "{rate:?}, {name}");
        }
    }
}

#[test]
fn int1_rises_at_the_rate_chosen() {
    for rate in RATES {
        let (desk, _) = configured(rate);
        let desk = &mut *desk.0.borrow_mut();
        desk.rises.clear();
        desk.wait(100 * MS);
        assert_eq!(desk.rises.len() as u32, rate.hz() / 10);
        let period = 1_000_000_000 / u64::from(rate.hz());
        assert!(desk.rises.windows(2).all(|pair| pair[1] - pair[0] == period));
    }
}

#[test]
fn a_sample_is_there_when_configuration_ends() {
    let (_, mut driver) = configured(OutputDataRate::Hz1000);
    assert!(run(driver.read()).is_ok());
}

#[test]
fn a_sample_has_signs_and_byte_order() {
    let (_, mut driver) = configured(OutputDataRate::Hz1000);
    let expected = Sample {
        accel: [1, -2, 2048],
        gyro: [-4, 500, -32_767],
        temperature: 1325,
    };
    assert_eq!(run(driver.read()), Ok(expected));
    assert!((expected.celsius() - 35.0).abs() < 0.01);
}

#[test]
fn a_sample_is_one_transfer_of_15_bytes() {
    let (desk, mut driver) = configured(OutputDataRate::Hz1000);
    for _ in 0..3 {
        desk.0.borrow_mut().transfers.clear();
        assert!(run(driver.read()).is_ok());
        assert_eq!(desk.0.borrow().transfers, [15]);
    }
}

#[test]
fn a_part_without_a_sample_is_not_ready() {
    let (desk, mut driver) = bench();
    desk.0.borrow_mut().wait(2 * MS);
    assert_eq!(run(driver.read()), Err(Error::NotReady));
}

#[test]
fn an_absent_part_is_named_within_the_bound() {
    let (desk, mut driver) = bench();
    desk.0.borrow_mut().part.unplug(0);
    let result = configure(&desk, &mut driver, OutputDataRate::Hz1000);
    assert_eq!(result, Err(Error::Absent { who_am_i: 0xFF }));
    let desk = desk.0.borrow();
    assert!(desk.now < 11 * MS, "{} ns", desk.now);
    assert_eq!(desk.transfers.len(), 4 * CONFIGURE_ATTEMPTS);
}

#[test]
fn a_line_stuck_low_is_named_at_the_start() {
    let (desk, mut driver) = bench();
    desk.0.borrow_mut().part.set_data_line(DataLine::StuckLow);
    let result = configure(&desk, &mut driver, OutputDataRate::Hz1000);
    assert_eq!(result, Err(Error::Absent { who_am_i: 0x00 }));
}

#[test]
fn another_part_is_named() {
    let (desk, mut driver) = bench();
    // Any byte that is not the identity: here the reset value of another register.
    desk.0.borrow_mut().wait(2 * MS);
    desk.0.borrow_mut().transaction([0x80 | 0x4D, 0]);
    desk.0.borrow_mut().part.set_data_line(DataLine::Repeats);
    let result = configure(&desk, &mut driver, OutputDataRate::Hz1000);
    assert_eq!(result, Err(Error::WrongPart { who_am_i: 0x91 }));
}

#[test]
fn a_register_that_does_not_take_its_value_is_named() {
    let (desk, mut driver) = bench();
    desk.0.borrow_mut().loses = Some(0x52);
    let result = configure(&desk, &mut driver, OutputDataRate::Hz4000);
    let expected = Error::Mismatch {
        register: Register {
            bank: Bank::Zero,
            address: 0x52,
        },
        wrote: 0x1F,
        read: 0x11,
    };
    assert_eq!(result, Err(expected));
    assert_eq!(
        expected.to_string(),
        "register 0x52 of bank 0 holds 0x11, not 0x1f"
    );
    let spent = desk.0.borrow().now / US;
    let transfers = desk.0.borrow().transfers.len() as u64;
    assert!(transfers < 400 && spent <= u64::from(CONFIGURE_US) + transfers * 16);
}

#[test]
fn one_failure_of_the_bus_is_survived_by_configuration() {
    let (desk, mut driver) = bench();
    for failing in 0..60 {
        desk.0.borrow_mut().fails_after = Some(failing);
        assert_eq!(
            configure(&desk, &mut driver, OutputDataRate::Hz1000),
            Ok(()),
            "{failing}"
        );
    }
}

#[test]
fn bus_errors_are_passed_on() {
    let (desk, mut driver) = configured(OutputDataRate::Hz1000);
    desk.0.borrow_mut().fails_after = Some(0);
    assert_eq!(run(driver.read()), Err(Error::Bus(Overrun)));
    assert!(!desk.0.borrow().selected);
    desk.0.borrow_mut().fails_after = Some(0);
    assert_eq!(run(driver.verify()), Err(Error::Bus(Overrun)));
    assert!(run(driver.read()).is_ok());
}

#[test]
fn a_stuck_line_is_named_in_flight() {
    let (desk, mut driver) = configured(OutputDataRate::Hz1000);
    let lines = [
        (DataLine::StuckHigh, 0xFF),
        (DataLine::StuckLow, 0x00),
        (DataLine::Repeats, 0x00),
    ];
    for (line, byte) in lines {
        desk.0.borrow_mut().part.set_data_line(line);
        assert_eq!(run(driver.read()), Err(Error::Stuck { byte }));
    }
    desk.0.borrow_mut().part.set_data_line(DataLine::Connected);
    assert!(run(driver.read()).is_ok());
}

#[test]
fn a_part_that_is_unplugged_in_flight_is_named() {
    let (desk, mut driver) = configured(OutputDataRate::Hz1000);
    let now = desk.0.borrow().now;
    desk.0.borrow_mut().part.unplug(now);
    assert_eq!(run(driver.read()), Err(Error::Stuck { byte: 0xFF }));
    desk.0.borrow_mut().part.plug(now);
    let result = configure(&desk, &mut driver, OutputDataRate::Hz1000);
    assert_eq!(result, Ok(()));
    assert!(run(driver.read()).is_ok());
}

#[test]
fn verification_goes_on_for_ever_while_all_is_well() {
    let (_, mut driver) = configured(OutputDataRate::Hz8000);
    for _ in 0..100 {
        assert_eq!(run(driver.verify()), Ok(()));
        assert!(run(driver.read()).is_ok());
    }
}

#[test]
fn a_reset_in_flight_shows_within_three_calls() {
    for rate in RATES {
        let (desk, mut driver) = configured(rate);
        for _ in 0..17 {
            assert_eq!(run(driver.verify()), Ok(()));
            let now = desk.0.borrow().now;
            desk.0.borrow_mut().part.reset(now);
            desk.0.borrow_mut().wait(MS);
            let found = (0..3).any(|_| matches!(run(driver.verify()), Err(Error::Mismatch { .. })));
            assert!(found, "{rate:?}");
            // Whatever was verified last, the burst is of bank 0.
            assert_eq!(run(driver.read()), Err(Error::NotReady));
            assert_eq!(configure(&desk, &mut driver, rate), Ok(()));
            for _ in 0..3 {
                assert_eq!(run(driver.verify()), Ok(()));
            }
        }
    }
}

#[test]
fn every_register_is_verified_within_17_calls() {
    let addresses = [
        0x14, 0x4C, 0x4D, 0x4E, 0x4F, 0x50, 0x52, 0x63, 0x64, 0x65, // bank 0
        0x0B, 0x0C, 0x0D, 0x0E, // bank 1
        0x03, 0x04, 0x05, // bank 2
    ];
    let (desk, mut driver) = configured(OutputDataRate::Hz1000);
    for (i, address) in addresses.into_iter().enumerate() {
        let bank = if i < 10 {
            0
        } else if i < 14 {
            1
        } else {
            2
        };
        let poke = |value: u8| {
            let desk = &mut *desk.0.borrow_mut();
            for bytes in [[0x76, bank], [address, value], [0x76, 0]] {
                desk.transaction(bytes);
            }
            desk.wait(MS);
        };
        let right = desk.0.borrow().part.register(bank, address);
        poke(!right);
        let named = (0..17).any(|_| {
            matches!(run(driver.verify()), Err(Error::Mismatch { register, .. })
                if register.address == address && register.bank as u8 == bank)
        });
        assert!(named, "{address:#04x} of bank {bank}");
        poke(right);
    }
}

#[test]
fn a_call_can_be_dropped_half_way() {
    let (desk, mut driver) = configured(OutputDataRate::Hz1000);
    // Each setting is verified in up to three transfers: the call is dropped in each, when none,
    // one or both of its bytes have gone.
    let mut dropped = 0;
    for i in 0..17 * 9 {
        desk.0.borrow_mut().hangs_after = Some((i / 3 % 3, i % 3));
        {
            let mut verify = pin!(driver.verify());
            dropped += usize::from(poll_once(verify.as_mut()).is_none());
        }
        desk.0.borrow_mut().hangs_after = None;
        assert!(!desk.0.borrow().selected, "{i}");
        assert!(run(driver.read()).is_ok(), "{i}");
    }
    assert_eq!(dropped, 10 * 3 + 7 * 9);
}

#[test]
fn a_saturated_sample_is_still_a_sample() {
    let (desk, mut driver) = configured(OutputDataRate::Hz1000);
    desk.0.borrow_mut().measured = Measurement {
        accel: [i16::MIN, i16::MAX, 0],
        gyro: [i16::MIN; 3],
        temperature: 0,
    };
    desk.0.borrow_mut().wait(MS);
    let sample = run(driver.read()).unwrap();
    assert_eq!(sample.gyro, [-i16::MAX; 3]);
}
