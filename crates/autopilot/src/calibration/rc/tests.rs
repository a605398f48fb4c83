//! Pilots and receivers.

extern crate std;

use std::string::ToString;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::calibration::testing::{Noise, any_duration, within_declarations};
use crate::calibration::{BadSample, Progress};

/// Frames 50 times a second.
const INTERVAL: f32 = 0.02;

/// Channels 1 to 4 are sticks, 5 a switch, 6 to 8 not wired. `rest`, the ends, and jitter of 2 µs.
struct Pilot {
    noise: Noise,
    /// Lower end, rest, upper end of each stick.
    sticks: [[f32; 3]; 4],
}

impl Pilot {
    fn new(seed: u64) -> Self {
        Self {
            noise: Noise::new(seed),
            sticks: [
                [1010.0, 1502.0, 1990.0],
                [1100.0, 1530.0, 1900.0],
                [988.0, 1000.0, 2012.0],
                [1200.0, 1480.0, 1800.0],
            ],
        }
    }

    /// The frame at this time: three seconds of rest, then the sticks go round until `stop`.
    fn frame(&mut self, time: f32, stop: f32) -> Vec<u16> {
        let moving = (3.0..stop).contains(&time);
        let (sin, cos) = windhover_math::sin_cos(windhover_math::wrap_pi(time));
        let mut frame: Vec<u16> = (self.sticks.iter().zip([sin, cos, sin, cos]))
            .map(|([low, rest, high], way)| {
                // Against the stops for a while at either end.
                let way = windhover_math::saturate(1.3 * way, 1.0);
                let middle = 0.5 * (low + high);
                let pulse = if moving {
                    middle + way * (high - middle)
                } else {
                    *rest
                };
                (pulse + self.noise.within(2.0)) as u16
            })
            .collect();
        frame.extend([if moving && sin > 0.0 { 1900 } else { 1050 }, 1500, 1500, 1500]);
        frame
    }
}

/// Runs to the end.
fn run(limits: RcLimits, mut give: impl FnMut(f32) -> Vec<u16>) -> (RcProgress, Vec<RcInstruction>) {
    let (mut machine, mut seen) = (RcCalibrator::new(limits), Vec::new());
    for step in 0..=(limits.timeout / INTERVAL) as usize + 1 {
        match machine.step(&give(step as f32 * INTERVAL), INTERVAL) {
            Progress::Going { share, instruction } => {
                assert!((0.0..=1.0).contains(&share));
                if seen.last() != Some(&instruction) {
                    assert!(instruction.to_string().len() > 10);
                    seen.push(instruction);
                }
            }
            end => {
                assert_eq!(machine.step(&[], f32::NAN), end, "an end stays");
                return (end, seen);
            }
        }
    }
    panic!("no end");
}

fn refused(progress: RcProgress) -> RcRefusal {
    match progress {
        Progress::Refused(reason) => {
            assert!(reason.to_string().len() > 20, "{reason}");
            reason
        }
        other => panic!("{other:?}"),
    }
}

/// If this failed, full stick would not be full command, or the middle would not be none.
#[test]
fn ends_and_middles_are_those_of_the_sticks() {
    for seed in 0..20 {
        let mut pilot = Pilot::new(seed);
        let (end, seen) = run(RcLimits::default(), |time| pilot.frame(time, 20.0));
        let Progress::Done(found) = end else {
            panic!("{end:?}");
        };
        for (channel, stick) in found.channels.iter().zip(&pilot.sticks) {
            let RcChannel { min, trim, max } = channel.unwrap();
            for (pulse, truth) in [min, trim, max].into_iter().zip(stick) {
                assert!((f32::from(pulse) - truth).abs() <= 3.0, "{channel:?} {stick:?}");
            }
        }
        let switch = RcChannel {
            min: 1050,
            trim: 1050,
            max: 1900,
        };
        assert_eq!(found.channels[4], Some(switch));
        assert_eq!(found.channels[5..], [None; 11], "not wired, or not there");
        assert_eq!(seen.first(), Some(&RcInstruction::Centre));
        assert_eq!(seen.get(1), Some(&RcInstruction::Move(Channels(0b1111))));
        assert_eq!(seen.last(), Some(&RcInstruction::LetGo));
    }
}

/// If this failed, the middle would lie at one end of the jitter.
#[test]
fn the_middle_is_that_of_the_jitter() {
    let (mut pilot, mut odd) = (Pilot::new(2), false);
    let (end, _) = run(RcLimits::default(), |time| {
        let mut frame = pilot.frame(time, 20.0);
        if time < 3.0 {
            odd = !odd;
            frame[0] = if odd { 1490 } else { 1506 };
        }
        frame
    });
    let Progress::Done(found) = end else {
        panic!("{end:?}");
    };
    assert_eq!(found.channels[0].unwrap().trim, 1498);
}

/// If this failed, a channel would be stored as another one, or out of its range; one that was not
/// calibrated must keep what it had.
#[test]
fn travels_are_written_to_their_channels() {
    let mut found = RcCalibration {
        channels: [None; CHANNELS],
    };
    found.channels[1] = Some(RcChannel {
        min: 800,
        trim: 1510,
        max: 2200,
    });
    found.channels[7] = Some(RcChannel {
        min: 1300,
        trim: 1300,
        max: 1700,
    });
    let mut parameters = RcCalibrationParameters::default();
    found.write(&mut parameters);
    within_declarations(&parameters);
    let expected = RcCalibrationParameters {
        min_2: 800.0,
        trim_2: 1510.0,
        max_2: 2200.0,
        min_8: 1300.0,
        trim_8: 1300.0,
        max_8: 1700.0,
        ..Default::default()
    };
    assert_eq!(parameters, expected);
}

/// If this failed, a broken pot or a wrong dual rate would be flown with.
#[test]
fn a_stick_that_does_not_travel_is_named() {
    let mut pilot = Pilot::new(1);
    pilot.sticks[1] = [1350.0, 1500.0, 1900.0];
    let (end, seen) = run(RcLimits::default(), |time| pilot.frame(time, 20.0));
    let RcRefusal::Travel(2, min, max) = refused(end) else {
        panic!("{end:?}");
    };
    assert!(
        (1346..1354).contains(&min) && (1896..1904).contains(&max),
        "{end:?}"
    );
    assert_eq!(seen.last(), Some(&RcInstruction::Move(Channels(0b10))));
}

/// If this failed, a stick that hung aside would turn the vehicle with hands off; the throttle may
/// rest anywhere.
#[test]
fn a_stick_that_rests_aside_is_named() {
    let mut pilot = Pilot::new(1);
    pilot.sticks[3] = [1000.0, 1750.0, 2000.0];
    let (end, _) = run(RcLimits::default(), |time| pilot.frame(time, 20.0));
    assert!(
        matches!(refused(end), RcRefusal::OffCentre(4, 1747..1753)),
        "{end:?}"
    );
}

/// If this failed, the middle would be taken from a moving stick.
#[test]
fn a_stick_that_never_rests_is_named() {
    let mut pilot = Pilot::new(1);
    let (end, seen) = run(RcLimits::default(), |time| {
        let mut frame = pilot.frame(0.0, 0.0);
        frame[2] = if time.rem_euclid(3.0) < 1.5 { 1400 } else { 1450 };
        frame
    });
    assert_eq!(refused(end), RcRefusal::Restless(3));
    assert_eq!(seen, [RcInstruction::Centre]);
}

/// If this failed, it could go on for ever with ends that creep.
#[test]
fn ends_that_creep_are_refused_when_time_is_up() {
    let mut pilot = Pilot::new(1);
    let (end, _) = run(RcLimits::default(), |time| {
        let mut frame = pilot.frame(time, 20.0);
        frame[5] = 1500 + time as u16;
        frame
    });
    assert!(
        matches!(end, Progress::Done(_)),
        "a microsecond a second is drift: {end:?}"
    );
    let (end, _) = run(RcLimits::default(), |time| {
        let mut frame = pilot.frame(time, 20.0);
        frame[5] = 900 + (10.0 * time) as u16;
        frame
    });
    assert_eq!(refused(end), RcRefusal::NeverLetGo);
}

/// If this failed, frames of a receiver that is not bound, lost or set up otherwise would count.
#[test]
fn frames_that_are_none_are_refused_with_the_channel() {
    let limits = RcLimits::default();
    let (end, _) = run(limits, |_| [1500; 3].to_vec());
    assert_eq!(refused(end), RcRefusal::Missing(4));
    let (end, _) = run(limits, |time| {
        [1500; 9][..if time < 1.0 { 8 } else { 9 }].to_vec()
    });
    assert_eq!(refused(end), RcRefusal::Changed(8, 9));
    for pulse in [0, 799, 2201, u16::MAX] {
        let (end, _) = run(limits, |_| [1500, 1500, 1500, 1500, 1500, pulse].to_vec());
        assert_eq!(refused(end), RcRefusal::Pulse(6, pulse));
    }
    let progress = RcCalibrator::default().step(&[1500; 8], f32::NAN);
    assert_eq!(refused(progress), RcRefusal::Sample(BadSample::Duration));
    let (end, _) = run(limits, |_| [1500; 30].to_vec());
    assert!(
        matches!(refused(end), RcRefusal::Travel(1, 1500, 1500)),
        "{end:?}"
    );
}

/// If this failed, a set would not say which channels are in it.
#[test]
fn sets_of_channels_count_from_one() {
    let set = Channels::default().with(1).with(16).with(0).with(17).with(255);
    assert_eq!(set, Channels(0x8001));
    assert_eq!((set.to_string().as_str(), set.count()), ("1, 16", 2));
    assert!(set.contains(16) && !set.contains(0) && !set.contains(2) && !set.contains(200));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// If this failed, some receiver could keep the machine running, or make a travel out of order or
    /// out of the range of the parameters.
    #[test]
    fn it_ends_in_time_whatever_it_is_fed(
        wild in any::<bool>(),
        count in 0_usize..20,
        inputs in prop::collection::vec((prop::array::uniform20(any::<u16>()), any_duration()), 102),
    ) {
        let mut machine = RcCalibrator::new(RcLimits {
            timeout: 20.0,
            rest: (0.1, 0.1),
            steady: 2000,
            ..Default::default()
        });
        let mut last = None;
        for (mut frame, duration) in inputs {
            if !wild {
                frame = frame.map(|pulse| 800 + pulse % 1401);
            }
            let frame = frame.get(..count).unwrap_or(&[]);
            last = Some(machine.step(frame, if wild { duration } else { 0.2 }));
        }
        match last {
            Some(Progress::Done(found)) => {
                let mut parameters = RcCalibrationParameters::default();
                found.write(&mut parameters);
                within_declarations(&parameters);
                for RcChannel { min, trim, max } in found.channels.into_iter().flatten() {
                    prop_assert!(min <= trim && trim <= max);
                }
            }
            Some(Progress::Refused(_)) => {}
            other => prop_assert!(false, "{other:?}"),
        }
    }
}
