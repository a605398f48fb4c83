//! The RC receiver.

use proptest::prelude::*;
use windhover_model::sensor::rc::{CHANNELS, HIGH, LOW, MIDDLE, Rc, RcErrors, SCALE};

use crate::assert_deviation;

#[test]
fn sticks_become_the_protocols_integers() {
    let mut rc = Rc::new(&RcErrors::ideal(), 1);
    let mut sticks = [0.0; CHANNELS];
    sticks[..5].copy_from_slice(&[-1.0, 1.0, 0.5, -9.0, 9.0]);
    let frame = rc.measure(&sticks).unwrap();
    assert_eq!(frame[..6], [LOW, HIGH, 1402, LOW, HIGH, MIDDLE]);
}

proptest! {
    #[test]
    fn sticks_come_back(stick in -1.0_f64..1.0) {
        let frame = Rc::new(&RcErrors::ideal(), 1).measure(&[stick; CHANNELS]).unwrap();
        for channel in frame {
            let found = (f64::from(channel) - f64::from(MIDDLE)) / SCALE;
            prop_assert!((found - stick).abs() <= 0.7 / SCALE);
        }
    }
}

#[test]
fn frames_are_lost_and_noisy_as_declared() {
    let mut rc = Rc::new(&RcErrors::default(), 1);
    let frames: Vec<_> = (0..20_000).filter_map(|_| rc.measure(&[0.1; CHANNELS])).collect();
    // 200 of 20 000, within four standard errors of 14.
    let lost = 20_000 - frames.len();
    assert!((144..=256).contains(&lost), "{lost}");
    let noisy: Vec<f64> = frames.iter().map(|frame| f64::from(frame[3])).collect();
    assert_deviation(&noisy, (0.25_f64 + 1.0 / 12.0).sqrt());
}

#[test]
fn a_link_that_is_down_is_silent_and_changes_nothing_after() {
    let run = |broken: bool| {
        let mut rc = Rc::new(&RcErrors::default(), 2);
        let mut frames = vec![];
        for n in 0..300 {
            rc.connect(!(broken && (100..200).contains(&n)));
            frames.push(rc.measure(&[0.3; CHANNELS]));
        }
        frames
    };
    let (whole, broken) = (run(false), run(true));
    assert!(broken[100..200].iter().all(Option::is_none));
    assert_eq!(whole[..100], broken[..100]);
    assert_eq!(whole[200..], broken[200..]);
}
