//! The remote control's wire: what a receiver sends, as the model makes it, is read; nothing else.

mod crsf;
mod receiver;
mod sbus;

use proptest::prelude::*;

/// Any sixteen channels of 11 bits.
fn arb_channels() -> impl Strategy<Value = [u16; 16]> {
    any::<[u16; 16]>().prop_map(|channels| channels.map(|channel| channel & 0x7FF))
}

/// The pulses of channels in µs, by real numbers.
fn pulses(channels: &[u16; 16]) -> [u16; 16] {
    channels.map(|channel| (1500.5 + 0.625 * (f64::from(channel) - 992.0)).floor() as u16)
}
