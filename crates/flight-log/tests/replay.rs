//! A log gives back what went in, and the core fed with it gives what came out.

mod common;

use common::{Flown, Plot, fly};
use windhover_autopilot::mission::{MissionSource, PlanKind};
use windhover_autopilot::{Inner, Mailboxes, Outer, OuterConfig, OuterInputs};
use windhover_flight_log::reader::{CoreSetup, Log, Period, Reason, Step, difference};
use windhover_flight_log::views::VehicleAttitude;
use windhover_flight_log::{LoggerConfig, View, period_hash, result_hash};

fn periods(log: &Log<'_>) -> Vec<Period> {
    let mut steps = log.periods();
    let periods = steps
        .by_ref()
        .map(|step| match step {
            Step::Period(period) => *period,
            Step::Gap { from, .. } => panic!("gap at {from}"),
        })
        .collect();
    assert_eq!(steps.end().unwrap().reason, Reason::Complete);
    periods
}

fn plots() -> impl Iterator<Item = Plot> {
    let rates = [250, 500, 1000, 4000];
    rates.into_iter().flat_map(|rate| {
        let disrupted = (1..6).map(move |seed| Plot::disrupted(seed, rate, 3 * rate as usize + 3));
        disrupted.chain([Plot::calm(rate, 2 * rate as usize)])
    })
}

#[test]
fn every_input_and_output_comes_back() {
    for plot in plots() {
        let Flown {
            log,
            inputs,
            motors,
            records,
            frozen,
            dropped_inputs,
            dropped_outputs,
            ..
        } = fly::<16384>(plot);
        assert_eq!((dropped_inputs, dropped_outputs), (0, 0));
        let log = Log::open(&log).unwrap();
        let periods = periods(&log);
        let read: Vec<_> = periods
            .iter()
            .flat_map(|period| period.ticks.iter().copied())
            .collect();
        assert!(read == inputs);
        let read: Vec<_> = periods
            .iter()
            .flat_map(|period| period.outputs().unwrap().0.to_vec())
            .collect();
        assert!(read == motors);
        let read: Vec<_> = periods.iter().map(|period| period.record).collect();
        assert!(read == records);
        let read: Vec<OuterInputs> = periods
            .iter()
            .filter_map(|period| period.inputs.clone())
            .collect();
        assert!(read == frozen);
    }
}

#[test]
fn the_core_repeats_the_flight() {
    for plot in plots() {
        let flown = fly::<16384>(plot);
        let log = Log::open(&flown.log).unwrap();
        let setup = CoreSetup::new(&log).unwrap();
        assert_eq!(setup.parameters, common::parameters());
        assert_eq!(setup.outer, common::outer_config());
        let mut outer = Outer::new(setup.parameters, &setup.outer).unwrap();
        let mut inner = Inner::new(setup.inner, outer.inner_parameters());
        let thrust_max = LoggerConfig::new(setup.inner, &setup.parameters).thrust_max;
        let (mut mailboxes, mut result) = (Mailboxes::default(), None);
        let mut compared = 0;
        for period in periods(&log) {
            if period.record.adopted {
                mailboxes.result = result.take();
            }
            if let Some(inputs) = &period.inputs {
                mailboxes.queues.refill(inputs);
            }
            let adopted = mailboxes.result.as_ref().map(result_hash);
            let mut motors = Vec::new();
            for input in &period.ticks {
                let output = inner.tick(input, &mut mailboxes);
                motors.push(output.motors);
                if let Some(snapshot) = mailboxes.snapshot.take() {
                    let step = outer.step(&snapshot, &setup.plans);
                    for (time, view) in &period.views {
                        if let Some(again) = view.again(&snapshot, &step, thrust_max) {
                            assert_eq!(*time, snapshot.time);
                            assert_eq!(difference(view, &again), None);
                            compared += 1;
                        }
                    }
                    result = Some(step);
                }
            }
            let hash = period_hash(adopted, &motors);
            assert_eq!(
                period.outputs(),
                Some((motors.as_slice(), hash)),
                "{:?}",
                period.record
            );
        }
        assert!(compared > 100, "{compared} views compared");
    }
}

#[test]
fn a_declination_that_was_not_given_is_not_written_and_nothing_else_is_lost() {
    let outer = OuterConfig {
        declination: None,
        ..common::outer_config()
    };
    let bytes = common::header_with(&outer, 1000, &common::mission());
    let log = Log::open(&bytes).unwrap();
    assert!(log.info("declination").is_none());
    assert_eq!(log.value::<u32>("sim_seed"), Some(1));
    assert_eq!(CoreSetup::new(&log).unwrap().outer, outer);
    let given = common::header_bytes(1000, &common::mission());
    let setup = CoreSetup::new(&Log::open(&given).unwrap()).unwrap();
    assert_eq!(setup.outer, common::outer_config());
}

#[test]
fn the_header_says_it_all() {
    let bytes = common::header_bytes(4000, &common::mission());
    let log = Log::open(&bytes).unwrap();
    assert_eq!(log.end().unwrap().reason, Reason::Complete);
    assert_eq!(log.text("sys_name"), Some("Windhover"));
    assert_eq!(log.text("ver_sw").map(str::len), Some(40));
    assert_eq!(log.text("reset_cause"), Some("power"));
    assert_eq!(log.value::<f32>("declination"), Some(0.05));
    assert_eq!(log.value::<u32>("sim_seed"), Some(1));
    assert_eq!(log.value::<i32>("sim_seed"), None);
    assert_eq!(log.k(), Some(16));
    let setup = CoreSetup::new(&log).unwrap();
    assert_eq!(setup.inner, common::config(4000));
    for (index, item) in common::mission().iter().enumerate() {
        let read = setup.plans.item(PlanKind::Mission, 0, index as u16).unwrap();
        // NaN with its bits, so not by PartialEq.
        assert_eq!(read.params.map(f32::to_bits), item.params.map(f32::to_bits));
        assert_eq!((read.command, read.x, read.z), (item.command, item.x, item.z));
    }
    assert_eq!(
        setup
            .plans
            .item(PlanKind::Mission, 0, common::mission().len() as u16),
        None
    );
}

#[test]
fn a_difference_names_topic_field_and_both_values() {
    let mut attitude = VehicleAttitude::default();
    let before = View::VehicleAttitude(attitude);
    attitude.q.y = -0.25;
    let found = difference(&before, &View::VehicleAttitude(attitude)).unwrap();
    assert_eq!(found.to_string(), "vehicle_attitude.q[2] is -0.25, was 0");
    // Minus zero is another value than zero.
    attitude.q.y = -0.0;
    assert!(difference(&before, &View::VehicleAttitude(attitude)).is_some());
}
