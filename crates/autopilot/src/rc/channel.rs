//! From pulses to sticks and levers within ±1.

use core::ops::RangeInclusive;

use windhover_math::saturate;

use super::{RcFrame, RcParameters, Sticks};
use crate::calibration::rc::{Channels, RcCalibrationParameters};

/// Pulses that a receiver sends, µs; any other says that the channel is not there.
const PULSES: RangeInclusive<u16> = 800..=2200;

/// A frame with what its channels mean.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    pub frame: &'a RcFrame,
    pub rc: &'a RcParameters,
    pub calibration: &'a RcCalibrationParameters,
}

impl Reading<'_> {
    /// The four sticks; `None` unless all of them are there.
    pub fn sticks(&self) -> Option<Sticks> {
        Some(Sticks {
            roll: self.channel(self.rc.roll, centred)?,
            pitch: self.channel(self.rc.pitch, centred)?,
            yaw: self.channel(self.rc.yaw, centred)?,
            throttle: self.channel(self.rc.throttle, lever)?,
        })
    }

    /// A switch or a knob from −1 at one end to 1 at the other.
    pub fn lever(&self, channel: f32) -> Option<f32> {
        self.channel(channel, lever)
    }

    fn channel(&self, channel: f32, place: fn(f32, [f32; 3]) -> f32) -> Option<f32> {
        let channel = channel as u8;
        let pulse = self.frame.channels.get(usize::from(channel).checked_sub(1)?)?;
        if !PULSES.contains(pulse) {
            return None;
        }
        let value = place(f32::from(*pulse), self.calibration.travel(channel));
        if Channels(self.rc.reversed as u16).contains(channel) {
            Some(-value)
        } else {
            Some(value)
        }
    }
}

/// A stick that springs back: 0 at its middle, in proportion on either side. A side without a way,
/// as a throttle has that was left at its end, gives 0.
pub fn centred(pulse: f32, [min, trim, max]: [f32; 3]) -> f32 {
    let off = pulse - trim;
    let way = if off < 0.0 { trim - min } else { max - trim };
    if way > 0.0 { saturate(off / way, 1.0) } else { 0.0 }
}

/// What stays where it is put: in proportion from end to end. Where it was left during the
/// calibration means nothing. Without a way it stays at its lower end.
pub fn lever(pulse: f32, [min, _, max]: [f32; 3]) -> f32 {
    let way = max - min;
    if way > 0.0 {
        saturate(2.0 * (pulse - min) / way - 1.0, 1.0)
    } else {
        -1.0
    }
}
