//! Tests of the remote control.

mod switches;

extern crate std;

use proptest::prelude::*;
use windhover_parameters::Group;

use super::channel::{centred, lever};
use super::*;
use crate::calibration::rc::RcCalibrationParameters;

/// 100 frames a second.
const FRAME: u32 = 10_000;
/// Longer than the time-out.
const GONE: u32 = 600_000;
/// Sticks at rest, throttle low, arm switch off, mode switch at position 1.
const QUIET: [u16; 6] = [1500, 1500, 1000, 1500, 1000, 1000];

fn frame(channels: [u16; 6]) -> RcFrame {
    let mut frame = RcFrame::default();
    frame.channels[..6].copy_from_slice(&channels);
    frame
}

/// `QUIET` with one channel, counted from 1, elsewhere.
fn with(channel: usize, pulse: u16) -> RcFrame {
    let mut channels = QUIET;
    channels[channel - 1] = pulse;
    frame(channels)
}

#[derive(Default)]
struct Bench {
    remote: Remote,
    rc: RcParameters,
    calibration: RcCalibrationParameters,
    in_air: bool,
}

impl Bench {
    /// At rest, all switches known.
    fn quiet() -> Self {
        let mut bench = Self::default();
        assert_eq!(bench.frames(&[frame(QUIET); 2]), Events::default());
        bench
    }

    fn step(&mut self, frames: &[RcFrame], joystick: &[Sticks], dt_us: u32) -> Events {
        self.remote
            .step(frames, joystick, &self.rc, &self.calibration, !self.in_air, dt_us)
    }

    /// Frames one by one; what they did, together.
    fn frames(&mut self, frames: &[RcFrame]) -> Events {
        let mut all = Events::default();
        for frame in frames {
            let events = self.step(&[*frame], &[], FRAME);
            all = Events {
                mode: events.mode.or(all.mode),
                arm: events.arm.or(all.arm),
                refused: events.refused || all.refused,
                kill: events.kill,
            };
        }
        all
    }
}

/// Every pulse at every kind of travel, also senseless ones, lands within ±1, and a longer pulse never
/// gives less: otherwise a stick would turn back on its way.
#[test]
fn pulses_become_places_in_order() {
    let travels = [
        [1000.0, 1500.0, 2000.0],
        [1100.0, 1480.0, 1900.0],
        [988.0, 988.0, 2012.0],
        [1000.0, 2000.0, 2000.0],
        [1500.0, 1500.0, 1500.0],
        [1500.0, 800.0, 1500.0],
        [800.0, 2200.0, 1500.0],
    ];
    for travel in travels {
        for place in [centred, lever] {
            let mut before = -1.0;
            for pulse in 0..=u16::MAX {
                let value = place(f32::from(pulse), travel);
                assert!(
                    (before..=1.0).contains(&value),
                    "{travel:?}: {pulse} gives {value}"
                );
                before = value;
            }
        }
    }
    let [min, trim, max] = travels[1];
    assert_eq!(
        [min, trim, max].map(|pulse| centred(pulse, travels[1])),
        [-1.0, 0.0, 1.0]
    );
    assert_eq!(
        [min, 1500.0, max].map(|pulse| lever(pulse, travels[1])),
        [-1.0, 0.0, 1.0]
    );
}

/// Whatever is set: the middle is the middle, an end the end, left and right alike, more is not less,
/// and there is no jump at the edge of the dead band.
#[test]
fn shaping_keeps_ends_middle_and_order() {
    for step in 0..=100_u8 {
        let rc = RcParameters {
            dead_band: f32::from(step % 11) * 0.05,
            tilt_expo: f32::from(step) * 0.01,
            climb_expo: f32::from(step) * 0.01,
            ..Default::default()
        };
        let roll = |stick| {
            rc.shape(&Sticks {
                roll: stick,
                ..Default::default()
            })
            .roll
        };
        let mut before = 0.0;
        for place in 0..=2000_u16 {
            let stick = f32::from(place) / 2000.0;
            let value = roll(stick);
            assert!(
                (0.0..0.005).contains(&(value - before)),
                "{rc:?}: {stick} gives {value}"
            );
            assert!(stick > rc.dead_band || value == 0.0);
            assert_eq!(roll(-stick), -value);
            assert_eq!(rc.climb(stick), value);
            before = value;
        }
        assert!((before - 1.0).abs() < 1e-6 && before <= 1.0);
    }
}

/// A reversed channel would otherwise roll to the wrong side; only that one may turn.
#[test]
fn only_masked_channels_are_reversed() {
    let mut bench = Bench::default();
    bench.rc.reversed = 1.0 + 4.0;
    bench.frames(&[frame([2000, 2000, 2000, 2000, 1000, 1000])]);
    let expected = Sticks {
        roll: -1.0,
        pitch: 1.0,
        yaw: 1.0,
        throttle: -1.0,
    };
    assert_eq!(bench.remote.sticks(), Some(expected));
}

/// A throttle that was left at its end during the calibration would be open at its middle.
#[test]
fn each_stick_has_its_own_travel_and_a_throttle_no_middle() {
    let mut bench = Bench::default();
    bench.calibration.trim_3 = 1000.0;
    bench.calibration.trim_2 = 1600.0;
    bench.frames(&[frame([1500, 1600, 1500, 1500, 1000, 1000])]);
    assert_eq!(bench.remote.sticks(), Some(Sticks::default()));
}

/// Half a frame would fly with a stick that nobody holds.
#[test]
fn a_frame_without_a_stick_is_none() {
    for channel in 1..=4 {
        for pulse in [0, 799, 2201, u16::MAX] {
            let mut bench = Bench::default();
            bench.frames(&[with(channel, pulse)]);
            assert_eq!((bench.remote.sticks(), bench.remote.rejected()), (None, 1));
        }
    }
    let mut bench = Bench::default();
    bench.rc.yaw = 0.0;
    bench.frames(&[frame(QUIET)]);
    assert_eq!((bench.remote.was_seen(), bench.remote.rejected()), (false, 1));
}

/// A value that is none from a ground station would travel into the controllers.
#[test]
fn impossible_sticks_stay_outside() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.001, -1.001] {
        let sticks = [
            Sticks {
                roll: bad,
                ..Default::default()
            },
            Sticks {
                pitch: bad,
                ..Default::default()
            },
            Sticks {
                yaw: bad,
                ..Default::default()
            },
            Sticks {
                throttle: bad,
                ..Default::default()
            },
        ];
        let mut bench = Bench::default();
        bench.step(&[], &sticks, FRAME);
        assert_eq!((bench.remote.sticks(), bench.remote.rejected()), (None, 4));
    }
}

/// Who holds the receiver's sticks is nearer than a ground station; when they are gone the ground
/// station's count, and without any the remote control is lost.
#[test]
fn a_receiver_comes_before_a_joystick_while_it_is_there() {
    let joystick = Sticks {
        roll: 1.0,
        ..Default::default()
    };
    let roll = |bench: &Bench| bench.remote.sticks().map(|sticks| sticks.roll);
    let mut bench = Bench::default();
    bench.step(&[], &[], GONE);
    assert!(!bench.remote.is_lost() && !bench.remote.was_seen() && !bench.remote.moved());
    bench.step(&[], &[joystick], FRAME);
    assert!(roll(&bench) == Some(1.0) && bench.remote.moved());
    bench.step(&[frame(QUIET)], &[joystick], FRAME);
    assert!(roll(&bench) == Some(0.0) && !bench.remote.moved());
    for _ in 0..50 {
        bench.step(&[], &[joystick], FRAME);
        assert_eq!(roll(&bench), Some(0.0));
    }
    bench.step(&[], &[joystick], FRAME);
    assert_eq!(roll(&bench), Some(1.0));
    bench.step(&[], &[], GONE);
    assert!(bench.remote.sticks().is_none() && bench.remote.is_lost() && bench.remote.was_seen());
    assert!(!bench.remote.moved());
    bench.step(&[frame(QUIET)], &[], FRAME);
    assert!(!bench.remote.is_lost());
}

/// A throttle stays where it is put: at its end it is no hand that takes over. The others are, on
/// either side, before dead band and expo.
#[test]
fn a_pilot_takes_over_beyond_a_third() {
    for (channel, pulse, moved) in [
        (1, 1670, true),
        (2, 1330, true),
        (4, 1670, true),
        (1, 1660, false),
        (2, 1340, false),
        (3, 2000, false),
    ] {
        let mut bench = Bench::default();
        bench.frames(&[with(channel, pulse)]);
        assert_eq!(bench.remote.moved(), moved, "channel {channel} at {pulse}");
    }
}

fn any_group<T: Group + Default + core::fmt::Debug>() -> impl Strategy<Value = T> {
    prop::collection::vec(0.0_f32..=1.0, T::DECLARATIONS.len()).prop_map(|shares| {
        let mut group = T::default();
        for (index, (declaration, share)) in T::DECLARATIONS.iter().zip(shares).enumerate() {
            let value = declaration.min + share * (declaration.max - declaration.min);
            *group.get_mut(index).unwrap() = value.clamp(declaration.min, declaration.max);
        }
        group
    })
}

proptest! {
    /// Any pulses at any parameters that can be set: what comes out are sticks.
    #[test]
    fn sticks_are_sticks(
        rc in any_group::<RcParameters>(),
        calibration in any_group::<RcCalibrationParameters>(),
        frames in prop::collection::vec(prop::array::uniform16(700_u16..2300), 1..20),
        joystick in prop::array::uniform4(-1.0_f32..=1.0),
        dt_us in any::<u32>(),
    ) {
        let mut remote = Remote::default();
        let [roll, pitch, yaw, throttle] = joystick;
        for channels in frames {
            let sticks = Sticks { roll, pitch, yaw, throttle };
            remote.step(&[RcFrame { channels }], &[sticks], &rc, &calibration, true, dt_us);
            prop_assert!(remote.sticks().is_some_and(|sticks| sticks.is_valid()));
            prop_assert!(rc.climb(throttle).abs() <= 1.0);
            prop_assert!(remote.mode_position().is_none_or(|n| (1..=6).contains(&n)));
        }
    }
}
