//! Tests of what switches do.

use std::vec::Vec;

use super::*;
use crate::mode::Mode;
use crate::rc::switch::{is_on, position};

/// The middle of three positions and each of six, spread over the ends or in sixths, are where their
/// numbers say, with 15 µs of jitter.
#[test]
fn a_mode_switch_finds_its_positions() {
    let near = |middle: f32| [middle - 0.03, middle, middle + 0.03].map(position);
    assert_eq!([-1.0, 0.0, 1.0].map(near), [[1; 3], [4; 3], [6; 3]]);
    for number in 1..=6_u8 {
        let spread = -1.0 + 0.4 * f32::from(number - 1);
        let sixth = -1.0 + (f32::from(number) - 0.5) / 3.0;
        assert_eq!([near(spread), near(sixth)], [[number; 3]; 2]);
    }
}

const POSITIONS: [u16; 6] = [1000, 1200, 1400, 1600, 1800, 2000];

/// From every position to every other: the second frame changes the mode, once; a single frame does
/// not, and coming back does not either.
#[test]
fn a_mode_switch_acts_when_it_is_moved_and_stays() {
    for from in POSITIONS {
        for (to, number) in POSITIONS.into_iter().zip(1..) {
            let rc = RcParameters {
                mode_2: 1.0,
                mode_3: 4.0,
                mode_5: 8.0,
                ..Default::default()
            };
            let mut bench = Bench {
                rc,
                ..Default::default()
            };
            let selected = bench.rc.mode(number);
            assert!(selected.is_some());
            assert_eq!(bench.frames(&[with(6, from); 5]).mode, None, "at the start");
            assert_eq!(bench.frames(&[with(6, to)]).mode, None, "a single frame");
            assert_eq!(bench.frames(&[with(6, from); 5]).mode, None, "back");
            let first = bench.frames(&[with(6, to); 2]).mode;
            assert_eq!(first, selected.filter(|_| from != to));
            assert_eq!(bench.remote.mode_position(), Some(number));
            assert_eq!(bench.frames(&[with(6, to); 9]).mode, None, "more than once");
        }
    }
}

/// A receiver that comes back in flight must not throw the mission out because its switch stands
/// elsewhere than before; nor may another channel for the switch.
#[test]
fn a_switch_that_was_only_found_somewhere_does_nothing() {
    let mut bench = Bench::quiet();
    bench.step(&[], &[], GONE);
    assert_eq!(bench.remote.mode_position(), None);
    let elsewhere = frame([1500, 1500, 1000, 1500, 2000, 2000]);
    bench.in_air = true;
    assert_eq!(bench.frames(&[elsewhere; 9]), Events::default());
    assert_eq!(bench.remote.mode_position(), Some(6));
    bench.rc.mode_switch = 3.0;
    assert_eq!(bench.frames(&[elsewhere; 9]), Events::default());
    assert_eq!(bench.remote.mode_position(), Some(1));
}

#[test]
fn numbers_of_modes_are_px4s_and_the_rest_is_none() {
    let at = |number| {
        RcParameters {
            mode_1: number,
            ..Default::default()
        }
        .mode(1)
    };
    for (number, mode) in [
        (1.0, Mode::Altitude),
        (2.0, Mode::Position),
        (3.0, Mode::Mission),
        (4.0, Mode::Hold),
        (5.0, Mode::Return),
        (7.0, Mode::Offboard),
        (8.0, Mode::Stabilize),
        (10.0, Mode::Takeoff),
        (11.0, Mode::Land),
    ] {
        assert_eq!(at(number), Some(mode));
    }
    assert_eq!([-1.0, 0.0, 6.0, 9.0].map(at), [None; 4]);
    assert_eq!([0, 7].map(|n| RcParameters::default().mode(n)), [None; 2]);
}

/// The ways to arm by switch, and each way that must not: it would start the rotors in a pilot's hands.
#[test]
fn arming_asks_for_a_move_of_the_switch_and_resting_sticks() {
    let on = with(5, 2000);
    let refused = |events: Events| {
        events
            == Events {
                refused: true,
                ..Default::default()
            }
    };
    assert_eq!(Bench::quiet().frames(&[on; 2]).arm, Some(true));
    assert_eq!(Bench::quiet().frames(&[on, frame(QUIET), on]), Events::default());
    for (channel, pulse) in [(1, 1580), (2, 1420), (4, 1580), (3, 1060)] {
        let mut held = on;
        held.channels[channel - 1] = pulse;
        let mut bench = Bench::quiet();
        assert!(refused(bench.frames(&[held; 2])), "channel {channel} at {pulse}");
        // letting go is not enough: the switch must be moved again
        assert_eq!(bench.frames(&[on; 9]), Events::default());
        bench.frames(&[frame(QUIET); 2]);
        assert_eq!(bench.frames(&[on; 2]).arm, Some(true));
    }
    let mut found_on = Bench::default();
    assert!(refused(found_on.frames(&[on; 9])));
    assert_eq!(found_on.frames(&[on; 9]), Events::default());
}

/// In the air a switch that was thrown by mistake is thrown back, and the sticks are where they are.
#[test]
fn in_the_air_the_switch_arms_again_with_any_sticks() {
    let mut bench = Bench::quiet();
    bench.in_air = true;
    let flying = |switch| frame([1700, 1300, 1600, 1500, switch, 1000]);
    assert_eq!(bench.frames(&[flying(2000); 2]).arm, Some(true));
    assert_eq!(bench.frames(&[flying(1000); 2]).arm, Some(false));
    assert_eq!(bench.frames(&[flying(2000); 2]).arm, Some(true));
}

/// One broken frame must not stop the motors; a switch that is on must, as long as it is.
#[test]
fn kill_needs_two_frames_and_holds() {
    let mut bench = Bench::quiet();
    bench.rc.kill_switch = 7.0;
    let kill = |pulse| {
        let mut frame = frame(QUIET);
        frame.channels[6] = pulse;
        frame
    };
    bench.frames(&[kill(1000); 2]);
    assert!(!bench.frames(&[kill(2000)]).kill);
    assert!(!bench.frames(&[kill(1000); 2]).kill);
    assert!(bench.frames(&[kill(2000); 2]).kill);
    assert!(bench.step(&[], &[], FRAME).kill);
    assert!(!bench.frames(&[kill(1000); 2]).kill);
    // found on at the start it acts as well
    let mut bench = Bench::default();
    bench.rc.kill_switch = 7.0;
    assert!(bench.frames(&[kill(2000); 2]).kill);
    // and nobody holds it once the receiver is gone
    assert!(!bench.step(&[], &[], GONE).kill);
}

/// All sequences of seven frames with the switch on, off or between, and of losses: armed is only
/// who was off for two frames and then on for two, with no loss since. A second, plainer telling of
/// the rule is the judge.
#[test]
fn no_sequence_arms_that_should_not() {
    for number in 0..4_u32.pow(7) {
        let mut bench = Bench::default();
        let mut said: Vec<Option<bool>> = Vec::new();
        let mut settled = None;
        for place in 0..7 {
            let symbol = (number >> (2 * place)) & 3;
            let events = match symbol {
                3 => bench.step(&[], &[], GONE),
                switch => bench.step(&[with(5, [1000, 1700, 2000][switch as usize])], &[], FRAME),
            };
            if symbol == 3 {
                said.clear();
                settled = None;
            } else {
                said.push(is_on([-1.0, 0.4, 1.0][symbol as usize]));
            }
            let mut arm = None;
            if let [.., Some(a), Some(b)] = said[..]
                && a == b
            {
                arm = settled.filter(|before| *before != b).map(|_| b);
                settled = Some(b);
            }
            assert_eq!(events.arm, arm, "{number:o}, at {place}");
        }
    }
}
