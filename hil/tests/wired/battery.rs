//! The battery's voltage and current, converted into a ring.

use windhover_hil::board::Pin;
use windhover_model::sensor::battery::{CURRENT_SCALE, VOLTAGE_SCALE};

use super::desk::{Desk, MS};

const ADC1: u32 = 0x4001_2000;
const STREAM_4: u32 = 0x4002_6400 + 0x10 + 4 * 0x18;
const RING: u32 = 0x2000_0100;

/// A ring of eight results of PC0 and PC1, as drivers set it up.
fn converting(faults: &[&str]) -> Desk {
    let mut desk = Desk::new(faults, |_| {});
    for pin in 0..2 {
        desk.switch(Pin::new('C', pin), 3, 0);
    }
    desk.write(ADC1 + 0x08, 1);
    desk.write(ADC1 + 0x0C, 0o77);
    desk.write(ADC1 + 0x2C, 1 << 20);
    desk.write(ADC1 + 0x34, 10 | 11 << 5);
    desk.write(ADC1 + 0x04, 1 << 8);
    desk.write(STREAM_4 + 0x04, 8);
    desk.write(STREAM_4 + 0x08, ADC1 + 0x4C);
    desk.write(STREAM_4 + 0x0C, RING);
    let control = 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8;
    desk.write(STREAM_4, control);
    desk.write(STREAM_4, control | 1);
    desk.write(ADC1 + 0x08, 1 | 1 << 1 | 1 << 8 | 1 << 9);
    desk.modify(ADC1 + 0x08, |cr2| cr2 | 1 << 30);
    desk
}

/// Volts and amperes of the last results.
fn battery(desk: &mut Desk) -> (f64, f64) {
    use windhover_hil::board::Memory;
    // Whoever looks for what is new in the ring asks how far the stream has come.
    desk.read(STREAM_4 + 0x04);
    let mut bytes = [0; 4];
    desk.memory.read(RING, &mut bytes);
    let counts = |n: usize| f64::from(u16::from_le_bytes([bytes[n], bytes[n + 1]]));
    (counts(0) / VOLTAGE_SCALE, counts(2) / CURRENT_SCALE)
}

#[test]
fn a_full_battery_at_rest_is_read() {
    let mut desk = converting(&[]);
    desk.wait(300 * MS);
    let (volts, amperes) = battery(&mut desk);
    assert!((16.3..17.3).contains(&volts), "four cells of 4.2 V: {volts} V");
    assert!((0.0..1.2).contains(&amperes), "5 W: {amperes} A");
}

#[test]
fn a_battery_whose_wires_are_off_reads_nothing() {
    let mut desk = converting(&["battery-unplugged@0.3"]);
    desk.wait(300 * MS);
    assert!(battery(&mut desk).0 > 16.0);
    desk.wait(10 * MS);
    assert_eq!(battery(&mut desk), (0.0, 0.0));
}
