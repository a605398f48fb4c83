//! Faults by name.

use proptest::prelude::*;
use windhover_model::sensor::fault::{FaultKind, FaultSensor, SensorFault};

use crate::injection::fault;

#[test]
fn faults_are_listed_with_a_line_each() {
    let all = SensorFault::all();
    assert_eq!(all.len(), 2 + 7 * 6);
    for name in &all {
        let parsed = fault(&format!("{}@1", name.name));
        assert_eq!(
            (parsed.name(), parsed.text()),
            (name.name.clone(), name.text.clone())
        );
        assert!(!name.text.is_empty() && !name.text.contains('\n'));
    }
    let mut names: Vec<_> = all.iter().map(|n| &n.name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), all.len());
    for name in [
        "gnss-dropout",
        "baro-freeze",
        "gyro-bias-step",
        "compass-wrong-scale",
    ] {
        assert!(all.iter().any(|n| n.name == name), "{name}");
    }
}

#[test]
fn a_fault_is_read_with_its_times() {
    let read = fault("gnss-dropout@40,30");
    assert_eq!((read.sensor, read.kind), (FaultSensor::Gnss, FaultKind::Dropout));
    assert_eq!((read.start, read.duration), (40.0, 30.0));
    assert_eq!(read.window(), (40_000_000, 70_000_000));
    assert_eq!(fault("baro-freeze@0.5").window(), (500_000, u64::MAX));
}

#[test]
fn a_fault_that_cannot_be_is_refused_with_the_reason() {
    let refused = |text: &str| text.parse::<SensorFault>().unwrap_err().to_string();
    assert_eq!(
        refused("gnss-dropout"),
        "fault gnss-dropout: must be NAME@T or NAME@T,FOR with times in s, as in gnss-dropout@40,30"
    );
    assert_eq!(
        refused("gps-dropout@4"),
        "no fault is named gps-dropout: `windhover faults` lists them"
    );
    assert_eq!(
        refused("imu-noise@4"),
        "no fault is named imu-noise: `windhover faults` lists them"
    );
    assert_eq!(
        refused("rc-dropout@-1"),
        "fault rc-dropout: T is -1: must be 0 to 1000000 s"
    );
    assert_eq!(
        refused("rc-dropout@nan"),
        "fault rc-dropout: T is nan: must be 0 to 1000000 s"
    );
    assert_eq!(
        refused("rc-dropout@1,0"),
        "fault rc-dropout: FOR is 0: must be above 0, to 1000000 s"
    );
    assert_eq!(
        refused("rc-dropout@1,2,3"),
        "fault rc-dropout: FOR is 2,3: must be above 0, to 1000000 s"
    );
}

proptest! {
    #[test]
    fn faults_are_written_as_they_are_read(n in 0..44_usize, start in 0.0_f64..1e6, duration in 1e-6_f64..1e6) {
        let name = &SensorFault::all()[n].name;
        for text in [format!("{name}@{start}"), format!("{name}@{start},{duration}")] {
            prop_assert_eq!(fault(&text).to_string(), text);
        }
    }

    #[test]
    fn any_text_is_read_or_refused(text: String) {
        let _ = text.parse::<SensorFault>();
    }
}
