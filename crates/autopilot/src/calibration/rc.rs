//! The transmitter: the ends and the middle of its channels.
//!
//! First the sticks rest in the middle until the channels hold still; then the pilot moves everything
//! to its ends. It is over when all that is required has travelled far enough and nothing has found a
//! new end for three seconds. A channel that is not required and does not travel is left out.

mod channels;
mod limits;
mod parameters;
#[cfg(test)]
mod tests;

pub use self::channels::{CHANNELS, Channels};
pub use self::limits::{RcInstruction, RcLimits, RcRefusal};
pub use self::parameters::RcCalibrationParameters;
use super::Timer;

/// Shortest and longest pulse of a channel, µs.
const PULSES: core::ops::RangeInclusive<u16> = 800..=2200;

/// The travel of a channel, µs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RcChannel {
    /// Lower end.
    pub min: u16,
    /// Where it rests: the middle of a stick, or where a switch or the throttle was left.
    pub trim: u16,
    /// Upper end.
    pub max: u16,
}

/// Before the first sample.
const NOWHERE: RcChannel = RcChannel {
    min: 0,
    trim: 0,
    max: 0,
};

/// The travels that were found; channel 1 comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RcCalibration {
    /// `None` for a channel that is not there or did not travel.
    pub channels: [Option<RcChannel>; CHANNELS],
}

/// Where the calibration of the channels is.
pub type RcProgress = super::Progress<RcInstruction, RcCalibration, RcRefusal>;

/// What the machine is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Centre,
    Extents,
}

/// The machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcCalibrator {
    limits: RcLimits,
    timer: Timer,
    stage: Stage,
    /// How many channels there are, once one sample has come.
    count: Option<u8>,
    ranges: [RcChannel; CHANNELS],
    /// Since when the channels rest, or nothing has found a new end, s.
    quiet: f32,
    /// The ranges then.
    quiet_ranges: [RcChannel; CHANNELS],
    /// The channel that moved last while all should rest; from 1.
    restless: u8,
    end: Option<Result<RcCalibration, RcRefusal>>,
}

impl RcCalibrator {
    /// At the beginning.
    pub fn new(limits: RcLimits) -> Self {
        Self {
            limits,
            timer: Timer::new(limits.timeout),
            stage: Stage::Centre,
            count: None,
            ranges: [NOWHERE; CHANNELS],
            quiet: 0.0,
            quiet_ranges: [NOWHERE; CHANNELS],
            restless: 1,
            end: None,
        }
    }

    /// Takes in the pulses of all channels, µs, that stand for `duration` seconds. Channels beyond
    /// the sixteenth are left out.
    pub fn step(&mut self, pulses: &[u16], duration: f32) -> RcProgress {
        if self.end.is_none() {
            self.end = self.take_in(pulses, duration).transpose();
        }
        let (share, instruction) = self.report();
        RcProgress::of(self.end, share, instruction)
    }

    fn report(&self) -> (f32, RcInstruction) {
        if self.stage == Stage::Centre {
            return (0.0, RcInstruction::Centre);
        }
        let missing = self.untravelled();
        let required = windhover_math::max(self.limits.required.count(), 1);
        let travelled = f32::from(required.saturating_sub(missing.count())) / f32::from(required);
        let share = 0.2 + 0.7 * travelled;
        if missing.count() == 0 {
            (share, RcInstruction::LetGo)
        } else {
            (share, RcInstruction::Move(missing))
        }
    }

    fn take_in(&mut self, pulses: &[u16], duration: f32) -> Result<Option<RcCalibration>, RcRefusal> {
        let late = self.timer.advance(duration).map_err(RcRefusal::Sample)?;
        self.check(pulses)?;
        self.quiet += duration;
        match self.stage {
            Stage::Centre => self.centre(pulses),
            Stage::Extents => {
                self.extend(pulses);
                if self.untravelled().count() == 0 && self.quiet >= self.limits.rest.1 {
                    return self.finish().map(Some);
                }
            }
        }
        if late {
            Err(self.refusal_for_time())
        } else {
            Ok(None)
        }
    }

    /// The border: pulses that are none, channels that are not there.
    fn check(&mut self, pulses: &[u16]) -> Result<(), RcRefusal> {
        let count = windhover_math::min(pulses.len(), CHANNELS) as u8;
        if let Some(channel) = self.limits.required.iter().find(|channel| *channel > count) {
            return Err(RcRefusal::Missing(channel));
        }
        if let Some(before) = self.count
            && before != count
        {
            return Err(RcRefusal::Changed(before, count));
        }
        for (channel, pulse) in (1..=count).zip(pulses) {
            if !PULSES.contains(pulse) {
                return Err(RcRefusal::Pulse(channel, *pulse));
            }
        }
        if self.count.is_none() {
            self.count = Some(count);
            self.rest_at(pulses);
        }
        Ok(())
    }

    /// The channels rest here, as far as is known.
    fn rest_at(&mut self, pulses: &[u16]) {
        for (range, &pulse) in self.ranges.iter_mut().zip(pulses) {
            *range = RcChannel {
                min: pulse,
                trim: pulse,
                max: pulse,
            };
        }
        self.start_quiet();
    }

    /// Widens the ranges; the first channel of these that has become wider than at the last quiet by
    /// more than a jitter.
    fn widen(&mut self, pulses: &[u16], among: Channels) -> Option<u8> {
        let jitter = self.limits.steady;
        let mut found = None;
        let ranges = self.ranges.iter_mut().zip(&self.quiet_ranges);
        for ((channel, (range, before)), &pulse) in (1..).zip(ranges).zip(pulses) {
            range.min = windhover_math::min(pulse, range.min);
            range.max = windhover_math::max(pulse, range.max);
            let growth = (range.max - range.min).saturating_sub(before.max - before.min);
            if found.is_none() && among.contains(channel) && growth > jitter {
                found = Some(channel);
            }
        }
        found
    }

    fn centre(&mut self, pulses: &[u16]) {
        if let Some(channel) = self.widen(pulses, self.limits.required) {
            self.restless = channel;
            self.rest_at(pulses);
        } else if self.quiet >= self.limits.rest.0 {
            for range in &mut self.ranges {
                range.trim = range.min.midpoint(range.max);
            }
            self.start_quiet();
            self.stage = Stage::Extents;
        }
    }

    fn extend(&mut self, pulses: &[u16]) {
        if self.widen(pulses, Channels(u16::MAX)).is_some() {
            self.start_quiet();
        }
    }

    fn start_quiet(&mut self) {
        self.quiet = 0.0;
        self.quiet_ranges = self.ranges;
    }

    /// Whether a range reaches both ends.
    fn travels(&self, range: &RcChannel) -> bool {
        range.min <= self.limits.low && range.max >= self.limits.high
    }

    /// The required channels that have not been at both ends.
    fn untravelled(&self) -> Channels {
        let ranges = (1..).zip(&self.ranges);
        let short = ranges.filter(|(_, range)| !self.travels(range));
        let all = short.fold(Channels(0), |set, (channel, _)| set.with(channel));
        Channels(all.0 & self.limits.required.0)
    }

    fn range(&self, channel: u8) -> Option<&RcChannel> {
        self.ranges.get(usize::from(channel).checked_sub(1)?)
    }

    fn refusal_for_time(&self) -> RcRefusal {
        if self.stage == Stage::Centre {
            return RcRefusal::Restless(self.restless);
        }
        let first = self.untravelled().iter().next();
        match first.and_then(|channel| Some((channel, self.range(channel)?))) {
            Some((channel, range)) => RcRefusal::Travel(channel, range.min, range.max),
            None => RcRefusal::NeverLetGo,
        }
    }

    fn finish(&self) -> Result<RcCalibration, RcRefusal> {
        for channel in Channels(self.limits.centred.0 & self.limits.required.0).iter() {
            if let Some(range) = self.range(channel) {
                let way = f32::from(range.max) - f32::from(range.min);
                let off = f32::from(range.trim) - 0.5 * (f32::from(range.max) + f32::from(range.min));
                if off.abs() > self.limits.off_centre * way {
                    return Err(RcRefusal::OffCentre(channel, range.trim));
                }
            }
        }
        let channels = self.ranges.map(|range| self.travels(&range).then_some(range));
        Ok(RcCalibration { channels })
    }
}

impl Default for RcCalibrator {
    fn default() -> Self {
        Self::new(RcLimits::default())
    }
}
