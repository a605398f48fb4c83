//! What the keeper stores, and when.

mod common;

use common::nor::Nor;
use common::{State, Vehicle, load, plan};
use windhover_autopilot::Parameters;
use windhover_autopilot::mission::PlanKind;
use windhover_storage::keeper::{LATEST, REST, TRIES};
use windhover_storage::{Damage, Keeper, StoreError, Task};

const SECOND: u64 = 1_000_000;

fn index(name: &str) -> usize {
    Parameters::find(name).expect("a parameter of this name")
}

fn max(index: usize) -> f32 {
    Parameters::declaration(index).expect("an index of the table").max
}

/// Does what there is to do now; how many tasks that was.
fn work(vehicle: &mut Vehicle<'_>) -> usize {
    std::iter::from_fn(|| vehicle.step()).map(Result::unwrap).count()
}

fn next(vehicle: &mut Vehicle<'_>) -> Option<Task> {
    let view = windhover_storage::View {
        time: vehicle.time,
        armed: vehicle.armed,
        parameters: &vehicle.parameters,
        plans: vehicle.plans,
    };
    vehicle.keeper.next(&view, &vehicle.memory)
}

/// Armed at any moment of a change, it names nothing, and afterwards it goes on.
#[test]
fn nothing_is_stored_while_armed() {
    for moment in 0..40 {
        let mut nor = Nor::blank();
        nor.record = Some(Vec::new());
        let mut vehicle = Vehicle::start(&mut nor);
        vehicle.set(3, max(3));
        vehicle.set(4, max(4));
        vehicle.upload(PlanKind::Mission, &plan(1, 60));
        vehicle.keeper.hurry();
        for _ in 0..moment {
            vehicle.step();
        }
        vehicle.armed = true;
        vehicle.set(5, max(5));
        for _ in 0..100 {
            vehicle.time += SECOND;
            assert_eq!(vehicle.step(), None);
        }
        vehicle.armed = false;
        vehicle.settle().unwrap();
        let state = vehicle.state();
        assert_eq!(load(&mut nor).0, state, "armed after {moment} tasks");
    }
}

#[test]
fn parameters_are_stored_once_they_have_rested_and_in_the_end_even_if_they_do_not() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.time = 10 * SECOND;
    vehicle.set(0, max(0));
    for part in 0..10 {
        assert_eq!(work(&mut vehicle), 0, "{part} tenths of the rest");
        vehicle.time += REST / 10;
    }
    // Announced, written, settled.
    assert_eq!(work(&mut vehicle), 3);

    let begin = vehicle.time;
    let mut tasks = 0;
    for n in 0..100 {
        vehicle.set(0, max(0) * 0.001 * n as f32 + 0.5);
        tasks += work(&mut vehicle);
        vehicle.time += REST / 2;
        if tasks > 0 {
            break;
        }
    }
    assert!(
        tasks == 3 && vehicle.time - begin <= LATEST + REST,
        "{tasks} tasks"
    );
}

/// Before a restart on purpose there is no time to rest.
#[test]
fn in_a_hurry_parameters_are_stored_at_once() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.time = 10 * SECOND;
    assert_eq!(work(&mut vehicle), 0);
    vehicle.set(0, max(0));
    vehicle.keeper.hurry();
    assert!(vehicle.keeper.is_behind(&vehicle.view()));
    assert_eq!(work(&mut vehicle), 3);
    assert!(!vehicle.keeper.is_behind(&vehicle.view()));
    vehicle.set(1, max(1));
    assert_eq!(work(&mut vehicle), 0, "once");
}

#[test]
fn a_task_is_named_again_until_it_is_done() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.upload(PlanKind::Fence, &plan(1, 30));
    for _ in 0..6 {
        let task = next(&mut vehicle);
        assert!(task.is_some());
        assert_eq!(next(&mut vehicle), task);
        vehicle.step();
    }
}

#[test]
fn what_fails_is_left_until_something_changes() {
    let mut nor = Nor::blank();
    nor.refused = 0..usize::MAX;
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.upload(PlanKind::Rally, &plan(1, 3));
    let tries = |vehicle: &mut Vehicle<'_>| {
        let outcomes: Vec<_> = std::iter::from_fn(|| vehicle.step()).collect();
        assert!(outcomes.iter().all(Result::is_err));
        outcomes.len()
    };
    assert_eq!(tries(&mut vehicle), TRIES as usize);
    assert_eq!(vehicle.keeper.given_up(), Some(StoreError::Flash));
    assert!(vehicle.keeper.is_behind(&vehicle.view()));
    vehicle.upload(PlanKind::Rally, &plan(2, 3));
    assert_eq!(tries(&mut vehicle), TRIES as usize, "after another upload");
    vehicle.set(0, max(0));
    assert_eq!(tries(&mut vehicle), TRIES as usize, "after a parameter");
    vehicle.armed = true;
    assert_eq!(tries(&mut vehicle), 0);
    vehicle.armed = false;
    assert_eq!(tries(&mut vehicle), TRIES as usize, "after a flight");
}

/// At every moment of storing a plan another one is committed.
#[test]
fn a_plan_that_is_replaced_while_it_is_stored_leaves_nothing() {
    for moment in 0..20 {
        let mut nor = Nor::blank();
        let mut vehicle = Vehicle::start(&mut nor);
        vehicle.upload(PlanKind::Mission, &plan(1, 40));
        vehicle.settle().unwrap();
        vehicle.upload(PlanKind::Mission, &plan(2, 60));
        for _ in 0..moment {
            vehicle.step();
        }
        vehicle.upload(PlanKind::Mission, &plan(3, 20));
        vehicle.settle().unwrap();
        let state = vehicle.state();
        let (after, loaded) = load(&mut nor);
        assert_eq!(
            (after, loaded.damage),
            (state, Damage::default()),
            "after {moment}"
        );
    }
}

/// The memory of a plan changes while it is stored, without a commit: what is stored then was never
/// committed, and is not made valid.
#[test]
fn a_plan_without_its_crc_is_not_stored() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.upload(PlanKind::Mission, &plan(1, 20));
    vehicle.settle().unwrap();
    let state = vehicle.state();
    vehicle.upload(PlanKind::Mission, &plan(2, 20));
    let slot = vehicle.plans[0].slot;
    vehicle.step();
    let other = common::item(99);
    assert!(vehicle.memory.put(PlanKind::Mission, slot, 12, other));
    while let Some(outcome) = vehicle.step() {
        outcome.unwrap();
    }
    assert_eq!(vehicle.keeper.given_up(), Some(StoreError::Damaged));
    let (after, loaded) = load(&mut nor);
    assert_eq!((after, loaded.damage), (state, Damage::default()));
}

/// Stores some things, then flips bits of the newest record with this value.
fn damaged(value: &[u8]) -> Nor {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.set(index("CAL_GYRO0_XOFF"), 0.012_345);
    vehicle.set(index("MOT_IDLE"), 0.123);
    vehicle.upload(PlanKind::Mission, &plan(1, 12));
    vehicle.upload(PlanKind::Fence, &plan(2, 12));
    vehicle.settle().unwrap();
    let at = nor.bytes.windows(value.len()).rposition(|bytes| bytes == value);
    nor.flip(8 * at.expect("it is stored") + 3);
    nor.strict = false;
    nor
}

/// A calibration that is lost is no calibration that was never made: defaults, no arming, and
/// nothing is stored over it until a human says so.
#[test]
fn damaged_parameters_stay_damaged_until_they_are_accepted() {
    let mut nor = damaged(&0.012_345f32.to_le_bytes());
    let before = nor.bytes.clone();
    let mut vehicle = Vehicle::start(&mut nor);
    assert!(vehicle.loaded.damage.parameters);
    assert_eq!(vehicle.parameters, Parameters::default());
    assert_eq!(vehicle.state().plans[0].0, 12, "the mission is whole");
    assert_eq!(
        vehicle.loaded.damage.to_string(),
        "damaged in storage: parameters"
    );
    vehicle.set(0, max(0));
    for _ in 0..10 {
        vehicle.time += SECOND;
        assert_eq!(vehicle.step(), None);
    }
    vehicle.keeper.accept();
    vehicle.settle().unwrap();
    let state = vehicle.state();
    assert_ne!(nor.bytes, before);
    let (after, loaded) = load(&mut nor);
    assert_eq!((after, loaded.damage), (state, Damage::default()));
}

/// If this failed, parameters with which nothing flies, after a power cut between two groups or with
/// another firmware, would be overwritten by the defaults that fly in their place.
#[test]
fn parameters_that_are_distrusted_stay_until_others_are_accepted() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.set(3, max(3));
    vehicle.settle().unwrap();
    let before = vehicle.state();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.keeper.distrust();
    vehicle.parameters = Parameters::default();
    for _ in 0..100 {
        vehicle.time += SECOND;
        assert_eq!(vehicle.step(), None);
    }
    assert_eq!(load(&mut nor).0, before);
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.keeper.distrust();
    vehicle.parameters = Parameters::default();
    vehicle.keeper.accept();
    vehicle.settle().unwrap();
    let state = vehicle.state();
    let (after, loaded) = load(&mut nor);
    assert_eq!((after, loaded.damage), (state, Damage::default()));
}

/// A damaged plan is told at every start, whatever else is stored, until there is another one.
#[test]
fn a_damaged_plan_stays_damaged_until_it_is_replaced() {
    let item = common::item(1 << 32 | 5);
    let ways: [fn(&mut Vehicle<'_>); 3] = [
        |vehicle| vehicle.upload(PlanKind::Mission, &plan(3, 30)),
        |vehicle| vehicle.upload(PlanKind::Mission, &[]),
        |vehicle| vehicle.keeper.accept(),
    ];
    for heal in ways {
        let mut nor = damaged(&item.x.to_le_bytes());
        let mut vehicle = Vehicle::start(&mut nor);
        assert_eq!(vehicle.loaded.damage.plans, [true, false, false]);
        assert_eq!(vehicle.state().plans[0], (0, 0));
        assert_eq!(vehicle.parameters.motor.idle, 0.123);
        vehicle.set(0, max(0));
        vehicle.upload(PlanKind::Fence, &plan(4, 5));
        vehicle.settle().unwrap();

        let mut vehicle = Vehicle::start(&mut nor);
        assert_eq!(vehicle.loaded.damage.plans, [true, false, false]);
        heal(&mut vehicle);
        vehicle.settle().unwrap();
        let state = vehicle.state();
        let (after, loaded) = load(&mut nor);
        assert_eq!((after, loaded.damage), (state, Damage::default()));
    }
}

/// The record that says which plan is valid is lost: the plan before it is not taken for it.
#[test]
fn a_damaged_head_is_told() {
    let crc = windhover_flight_log::mission_crc(plan(1, 12));
    let mut nor = damaged(&crc.to_le_bytes());
    let (state, loaded) = load(&mut nor);
    assert_eq!(loaded.damage.plans, [true, false, false]);
    assert_eq!(state.plans[0], (0, 0));
}

/// Values that this firmware refuses, as of one with other ranges, are told until they are stored
/// anew.
#[test]
fn values_out_of_range_are_told_until_they_are_accepted() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    let idle = index("MOT_IDLE");
    vehicle.parameters.motor.idle = 7.0;
    vehicle.keeper.hurry();
    assert_eq!(work(&mut vehicle), 3);

    let mut vehicle = Vehicle::start(&mut nor);
    let default = Parameters::default();
    assert_eq!(vehicle.parameters, default);
    assert_eq!(vehicle.loaded.damage.refused, 1);
    vehicle.keeper.accept();
    vehicle.settle().unwrap();
    let (state, loaded) = load(&mut nor);
    assert_eq!((state, loaded.damage), (State::default(), Damage::default()));
    assert_eq!(default.get(idle), Some(default.motor.idle));
}

/// The keeper and what it asks for fit the memory that there is.
#[test]
fn it_is_small() {
    assert!(size_of::<Keeper>() < 2048, "{} bytes", size_of::<Keeper>());
    assert!(size_of::<Task>() < 300, "{} bytes", size_of::<Task>());
}
