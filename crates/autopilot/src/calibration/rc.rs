//! The transmitter: the ends and the middle of its channels.
//!
//! First the sticks rest in the middle until the channels hold still; then the pilot moves everything
//! to its ends. It is over when all that is required has travelled far enough and nothing has found a
//! new end for three seconds. A channel that is not required and does not travel is left out.

mod channels;
mod parameters;
#[cfg(test)]
mod tests;

use core::fmt;

pub use self::channels::{CHANNELS, Channels};
pub use self::parameters::RcCalibrationParameters;
use super::{BadSample, Timer};

/// What is asked of a calibration of the channels. Times of pulses are in µs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RcLimits {
    /// The channels that must travel.
    pub required: Channels,
    /// Those of them that spring back to their middle.
    pub centred: Channels,
    /// The lower end must lie here or below.
    pub low: u16,
    /// The upper end must lie here or above.
    pub high: u16,
    /// Largest difference of a middle from half-way between the ends, as a share of the way between
    /// them.
    pub off_centre: f32,
    /// How far a resting channel may move, and an end may still creep, µs.
    pub steady: u16,
    /// How long the channels must rest at first, and find no new end at last, s.
    pub rest: (f32, f32),
    /// Time limit, s.
    pub timeout: f32,
}

impl Default for RcLimits {
    /// Roll, pitch, throttle and yaw on channels 1 to 4; a throttle that does not spring back.
    fn default() -> Self {
        Self {
            required: Channels(0b1111),
            centred: Channels(0b1011),
            low: 1300,
            high: 1700,
            off_centre: 0.2,
            steady: 20,
            rest: (2.0, 3.0),
            timeout: 120.0,
        }
    }
}

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

/// What the pilot is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RcInstruction {
    /// Leave the sticks in the middle, throttle as well as it goes.
    Centre,
    /// Move all sticks and switches to their ends; these have not been there.
    Move(Channels),
    /// All have been there: let go.
    LetGo,
}

impl fmt::Display for RcInstruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Centre => f.write_str("leave all sticks in the middle"),
            Self::Move(missing) => write!(
                f,
                "move all sticks and switches to their ends; missing: channels {missing}"
            ),
            Self::LetGo => f.write_str("let go of the sticks"),
        }
    }
}

/// Why there is no calibration of the channels. Channels count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RcRefusal {
    /// The time of a sample is none.
    Sample(BadSample),
    /// This channel showed a pulse, µs, that is none.
    Pulse(u8, u16),
    /// This channel is required and is not there.
    Missing(u8),
    /// The number of channels changed, from and to.
    Changed(u8, u8),
    /// This channel did not rest in the middle.
    Restless(u8),
    /// This channel travelled only between these, µs.
    Travel(u8, u16, u16),
    /// The middle of this channel, µs, lies too far from half-way between its ends.
    OffCentre(u8, u16),
    /// New ends were found until time was up.
    NeverLetGo,
}

impl fmt::Display for RcRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sample(bad) => bad.fmt(f),
            Self::Pulse(channel, pulse) => write!(f, "channel {channel} shows {pulse} µs, which is no pulse"),
            Self::Missing(channel) => write!(f, "the receiver has no channel {channel}"),
            Self::Changed(from, to) => write!(f, "the receiver went from {from} to {to} channels"),
            Self::Restless(channel) => write!(f, "channel {channel} did not rest in the middle"),
            Self::Travel(channel, min, max) => {
                write!(f, "channel {channel} travelled only from {min} to {max} µs")
            }
            Self::OffCentre(channel, trim) => {
                write!(f, "channel {channel} rests at {trim} µs, far from its middle")
            }
            Self::NeverLetGo => f.write_str("the sticks were moved until time was up"),
        }
    }
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
