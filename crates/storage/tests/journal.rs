//! The journal without trouble: what is stored is there at the next start.

mod common;

use common::nor::{Nor, SECTOR};
use common::{KINDS, State, Vehicle, load, open, plan};
use embassy_futures::block_on;
use windhover_autopilot::Parameters;
use windhover_autopilot::mission::{PlanKind, PlanMemory};
use windhover_storage::{Damage, Journal, LIMIT, MOST, StoreError};

fn index(name: &str) -> usize {
    Parameters::find(name).expect("a parameter of this name")
}

#[test]
fn blank_flash_is_all_defaults_and_not_damaged() {
    let mut nor = Nor::blank();
    let (state, loaded) = load(&mut nor);
    assert_eq!((state, loaded.stored), (State::default(), 0));
    assert_eq!(loaded.damage, Damage::default());
    assert_eq!(nor.bytes, Nor::blank().bytes, "a start writes nothing");
}

#[test]
fn what_was_stored_is_there_after_a_restart() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.set(index("IMU_GYRO_RATEMAX"), 4000.0);
    vehicle.set(index("CAL_MAG0_XOFF_UT"), -12.5);
    for (kind, count) in KINDS.into_iter().zip([250, 9, 3]) {
        vehicle.upload(kind, &plan(kind.code().into(), count));
    }
    vehicle.settle().unwrap();
    let state = vehicle.state();
    let (after, loaded) = load(&mut nor);
    assert_eq!((after, loaded.stored), (state, 2));
    assert_eq!(loaded.damage, Damage::default());
}

#[test]
fn a_plan_that_is_cleared_is_gone_and_its_room_is_given_back() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    for round in 0..40 {
        vehicle.upload(PlanKind::Mission, &plan(round, 256));
        vehicle.settle().unwrap();
        vehicle.upload(PlanKind::Mission, &[]);
        vehicle.settle().unwrap();
    }
    let (state, loaded) = load(&mut nor);
    assert_eq!((state, loaded.damage), (State::default(), Damage::default()));
}

/// Far more writes than the flash has room for: sectors are used in turn.
#[test]
fn sectors_are_used_in_turn() {
    let mut nor = Nor::blank();
    nor.record = Some(Vec::new());
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.set(index("MOT_IDLE"), 0.1);
    for n in 0..2000u16 {
        vehicle.set(index("IMU_GYRO_RATEMAX"), 1000.0 + f32::from(n));
        vehicle.settle().unwrap();
    }
    let state = vehicle.state();
    let mut erased = [0; 3];
    for operation in nor.record.take().unwrap() {
        if let common::nor::Operation::Erase { sector } = operation {
            erased[sector] += 1;
        }
    }
    let (least, most) = (erased.iter().min().unwrap(), erased.iter().max().unwrap());
    println!("2000 changes: {erased:?} erasures by sector");
    assert!(*least > 0 && most - least <= 1, "{erased:?}");
    assert_eq!(load(&mut nor).0, state);
}

/// Everything as large as it may be, and each plan then replaced by another as large.
#[test]
fn there_is_room_for_everything_at_once() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    for (index, declaration) in Parameters::declarations().enumerate() {
        vehicle.set(index, declaration.max);
    }
    for round in 0..6 {
        for kind in KINDS {
            vehicle.upload(kind, &plan(round, PlanMemory::capacity(kind).into()));
            vehicle.settle().unwrap();
        }
    }
    // And all parameters in turn while it is full.
    for (index, declaration) in Parameters::declarations().enumerate().step_by(7) {
        vehicle.set(index, declaration.default);
        vehicle.settle().unwrap();
    }
    let state = vehicle.state();
    let (after, loaded) = load(&mut nor);
    assert_eq!((after, loaded.damage), (state, Damage::default()));
    println!("{MOST} bytes at most, {LIMIT} find room");
}

#[test]
fn a_plan_that_is_too_long_is_refused_and_the_old_one_stays() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.upload(PlanKind::Rally, &plan(1, 5));
    vehicle.settle().unwrap();
    let state = vehicle.state();
    vehicle.upload(
        PlanKind::Rally,
        &plan(2, usize::from(PlanMemory::capacity(PlanKind::Rally)) + 1),
    );
    assert_eq!(vehicle.step(), None);
    assert_eq!(vehicle.keeper.given_up(), Some(StoreError::Full));
    assert!(vehicle.keeper.is_behind(&vehicle.view()));
    assert_eq!(load(&mut nor).0, state);
}

/// Settings of another firmware in the same sectors, or whatever it is.
#[test]
fn what_is_no_journal_is_damage_until_something_is_stored() {
    let mut nor = Nor::blank();
    for (n, byte) in nor.bytes.iter_mut().enumerate().skip(100).take(20_000) {
        *byte = (n * 7) as u8;
    }
    let mut vehicle = Vehicle::start(&mut nor);
    assert_eq!(vehicle.state(), State::default());
    assert!(vehicle.loaded.damage.journal);
    assert_eq!(vehicle.step(), None, "nothing is stored of itself");
    vehicle.set(index("MOT_IDLE"), 0.2);
    vehicle.upload(PlanKind::Mission, &plan(1, 256));
    vehicle.settle().unwrap();
    let state = vehicle.state();
    let (after, loaded) = load(&mut nor);
    assert_eq!((after, loaded.damage), (state, Damage::default()));
}

#[test]
fn a_range_that_is_not_three_whole_sectors_is_refused() {
    let sector = SECTOR as u32;
    for range in [0..2 * sector, 0..sector * 3 - 4, 4..sector * 3 + 4, sector..0] {
        let mut nor = Nor::blank();
        let opened = block_on(Journal::open(&mut nor, range.clone()));
        assert_eq!(opened.err(), Some(StoreError::Range), "{range:?}");
    }
    open(&mut Nor::blank());
}

/// What reading costs: a start goes over the flash a few times. To turn a page that is full of
/// small records goes over it for each of them; that lets others have turns.
#[test]
fn reading_is_bounded() {
    let mut nor = Nor::blank();
    let (mut start, mut change) = (0, 0);
    for n in 0..300u16 {
        let mut vehicle = Vehicle::start(&mut nor);
        vehicle.upload(PlanKind::Rally, &plan(n.into(), 8));
        for (index, declaration) in Parameters::declarations().enumerate().step_by(20) {
            let share = f32::from(n) * 1e-3;
            vehicle.set(
                index,
                declaration.min + (declaration.max - declaration.min) * share,
            );
        }
        vehicle.settle().unwrap();
        drop(vehicle);
        let all = std::mem::take(&mut nor.read);
        load(&mut nor);
        start = start.max(nor.read);
        change = change.max(all - std::mem::take(&mut nor.read));
    }
    println!("at most {start} bytes are read at a start, {change} for a change");
    assert!(start < 4 * 3 * SECTOR && change < 10_000_000);
}
