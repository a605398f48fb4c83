//! The power fails in the middle of anything. What was being written is old or new, whole, the rest
//! is as it was, and no start finds damage.

mod common;

use std::slice;

use common::nor::{Nor, Operation};
use common::{KINDS, Random, State, Vehicle, load, plan};
use windhover_autopilot::Parameters;
use windhover_autopilot::mission::{PlanKind, PlanMemory};
use windhover_storage::Damage;

/// One thing that is stored.
#[derive(Clone, Debug)]
enum Change {
    /// Parameters, by index, with values.
    Parameters(Vec<(usize, f32)>),
    /// A plan of so many items that come from a seed.
    Plan(PlanKind, u64, usize),
}

impl Change {
    fn any(random: &mut Random) -> Self {
        if random.below(2) == 0 {
            let count = 1 + random.below(31);
            return Self::Parameters((0..count).map(|_| parameter(random)).collect());
        }
        let kind = KINDS[random.below(3)];
        let most = [40, 40, 8][usize::from(kind.code())];
        let all = usize::from(PlanMemory::capacity(kind));
        let count = [0, random.below(most), random.below(most), all][random.below(4)];
        Self::Plan(kind, random.next(), count)
    }

    fn make(&self, vehicle: &mut Vehicle<'_>) {
        match self {
            Self::Parameters(writes) => {
                for (index, value) in writes {
                    vehicle.set(*index, *value);
                }
            }
            Self::Plan(kind, seed, count) => vehicle.upload(*kind, &plan(*seed, *count)),
        }
    }
}

/// Any parameter with a value that is taken.
fn parameter(random: &mut Random) -> (usize, f32) {
    let index = random.below(Parameters::COUNT);
    let declaration = Parameters::declaration(index).expect("an index of the table");
    let share = random.below(1001) as f32 * 1e-3;
    let value = declaration.min + (declaration.max - declaration.min) * share;
    (index, value.clamp(declaration.min, declaration.max))
}

/// A start from this flash finds one of these, and no damage.
fn check(nor: &mut Nor, allowed: &[State], what: &str) {
    let (state, loaded) = load(nor);
    assert_eq!(loaded.damage, Damage::default(), "{what}");
    for (kind, plan) in state.plans.iter().enumerate() {
        let one_of = allowed.iter().any(|allowed| allowed.plans[kind] == *plan);
        assert!(one_of, "{what}: plan {kind} is {plan:?}");
    }
    let one_of = allowed
        .iter()
        .any(|allowed| allowed.parameters == state.parameters);
    assert!(one_of, "{what}: parameters are neither the old nor the new ones");
}

/// A part that has been used for a while, so that the next writes turn pages.
fn used(changes: usize, seed: u64) -> Nor {
    let mut nor = Nor::blank();
    let mut random = Random(seed);
    let mut vehicle = Vehicle::start(&mut nor);
    for _ in 0..changes {
        Change::any(&mut random).make(&mut vehicle);
        vehicle.settle().expect("flash that works");
    }
    nor
}

/// Stores one change after the other, and cuts the power before and within every single operation
/// of it. Where `often` divides the operation's number, what follows must work as well.
fn cut_everywhere(mut nor: Nor, changes: &[Change], often: usize) -> (usize, usize) {
    let (mut cuts, mut erasures) = (0, 0);
    for change in changes {
        let (old, _) = load(&mut nor);
        let mut after = nor.clone();
        after.record = Some(Vec::new());
        let mut vehicle = Vehicle::start(&mut after);
        change.make(&mut vehicle);
        vehicle.settle().expect("flash that works");
        let new = vehicle.state();
        // More parameters than a group holds are several groups.
        let mut allowed = vec![old, new.clone()];
        if let Change::Parameters(writes) = change {
            assert!(writes.len() <= 31, "one group");
        }
        for operation in after.record.take().expect("it is recorded") {
            let is_erasure = matches!(operation, Operation::Erase { .. });
            erasures += usize::from(is_erasure);
            let what = format!("{change:?} before {cuts}, {operation:?}");
            check(&mut nor.clone(), &allowed, &what);
            // A word is torn in one way, a sector in many.
            let ways = if is_erasure { 100 } else { 1 };
            for way in 0..ways {
                let mut torn = nor.clone();
                torn.random = Random(cuts as u64 * 1000 + way);
                torn.tear(operation);
                let what = format!("{what}, within, way {way}");
                check(&mut torn.clone(), &allowed, &what);
                if is_erasure && way % 10 == 0 || cuts % often == 0 {
                    let mut vehicle = Vehicle::start(&mut torn);
                    change.make(&mut vehicle);
                    vehicle.settle().expect("flash that works again");
                    check(&mut torn, slice::from_ref(&new), &format!("{what}, and again"));
                }
            }
            nor.apply(operation);
            cuts += 1;
        }
        allowed.remove(0);
        check(&mut nor, &allowed, "in the end");
    }
    (cuts, erasures)
}

/// Parameters and plans, from the first write into a blank part over several turns of the pages.
#[test]
fn a_power_cut_at_every_operation_loses_nothing() {
    let group = |from: usize, count: usize, share: f32| {
        let value = |index: usize| {
            let declaration = Parameters::declaration(index).expect("an index of the table");
            (declaration.min + (declaration.max - declaration.min) * share)
                .clamp(declaration.min, declaration.max)
        };
        Change::Parameters((from..from + count).map(|index| (index, value(index))).collect())
    };
    let mut changes = vec![group(0, 3, 0.25)];
    for round in 0..12 {
        changes.push(Change::Plan(PlanKind::Mission, round, 20));
        changes.push(group(20, 31, 0.08 * round as f32));
        changes.push(Change::Plan(PlanKind::Mission, 10 + round, 130));
        changes.push(Change::Plan(PlanKind::Fence, round, 30 * (round as usize % 2)));
        changes.push(group(0, 12, 0.07 * round as f32));
        changes.push(Change::Plan(PlanKind::Rally, round, 1 + round as usize % 8));
    }
    let (cuts, erasures) = cut_everywhere(Nor::blank(), &changes, 37);
    println!("{cuts} operations, {erasures} erasures");
    assert!(cuts > 20_000 && erasures >= 3, "{cuts} cuts, {erasures} erasures");
}

/// The same where everything is as full as it may be, so that pages turn all the time.
#[test]
fn a_power_cut_loses_nothing_where_it_is_full() {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    for (index, declaration) in Parameters::declarations().enumerate() {
        vehicle.set(index, declaration.max);
    }
    for round in 0..3 {
        for kind in KINDS {
            vehicle.upload(kind, &plan(round, PlanMemory::capacity(kind).into()));
            vehicle.settle().expect("flash that works");
        }
    }
    let changes = [
        Change::Plan(
            PlanKind::Mission,
            7,
            PlanMemory::capacity(PlanKind::Mission).into(),
        ),
        Change::Plan(PlanKind::Fence, 7, PlanMemory::capacity(PlanKind::Fence).into()),
        Change::Plan(
            PlanKind::Mission,
            8,
            PlanMemory::capacity(PlanKind::Mission).into(),
        ),
        Change::Parameters(vec![(1, Parameters::declaration(1).expect("it exists").default)]),
    ];
    let (cuts, erasures) = cut_everywhere(nor, &changes, 101);
    assert!(cuts > 5000 && erasures >= 2, "{cuts} cuts, {erasures} erasures");
}

/// Random changes to a random part, cut at a random moment, again and again while it recovers.
/// `WINDHOVER_CUTS` says how many moments.
#[test]
fn a_power_cut_at_random_moments_loses_nothing() {
    let moments = std::env::var("WINDHOVER_CUTS").map_or(100, |cuts| cuts.parse().expect("a number"));
    for moment in 0..moments {
        let mut random = Random(moment);
        let mut nor = used(random.below(30), moment);
        for cut in 0..3 {
            let (old, _) = load(&mut nor);
            let change = Change::any(&mut random);
            let mut whole = nor.clone();
            whole.record = Some(Vec::new());
            let mut vehicle = Vehicle::start(&mut whole);
            change.make(&mut vehicle);
            vehicle.settle().expect("flash that works");
            let new = vehicle.state();
            let operations = whole.record.take().expect("it is recorded");
            let is_erasure = |operation: &Operation| matches!(operation, Operation::Erase { .. });

            nor.power = Some(match operations.iter().position(is_erasure) {
                // Rare, and the worst of all moments.
                Some(erasure) if random.below(2) == 0 => erasure,
                _ => random.below(operations.len() + 1),
            });
            nor.random = Random(random.next());
            let mut vehicle = Vehicle::start(&mut nor);
            change.make(&mut vehicle);
            let _ = vehicle.settle();
            (nor.power, nor.is_off) = (None, false);
            check(
                &mut nor,
                &[old, new],
                &format!("moment {moment}, cut {cut}, {change:?}"),
            );
        }
    }
}

/// Flash that refuses for a while, as it does while armed: what was stored stays, and a start in
/// between finds it; afterwards the rest is stored.
#[test]
fn what_is_refused_is_stored_later() {
    for seed in 0..100 {
        let mut random = Random(seed);
        let mut nor = used(random.below(30), seed);
        let (old, _) = load(&mut nor);
        let change = Change::any(&mut random);
        let first = random.below(300);
        nor.attempts = 0;
        nor.refused = first..first + 1 + random.below(20);
        let mut before = nor.clone();
        let mut vehicle = Vehicle::start(&mut before);
        change.make(&mut vehicle);
        let new = vehicle.state();
        let interrupted = vehicle.settle().is_err();
        if interrupted {
            check(&mut before, &[old, new.clone()], &format!("{seed}, {change:?}"));
        }
        let mut vehicle = Vehicle::start(&mut nor);
        change.make(&mut vehicle);
        let mut tries = 0;
        while vehicle.settle().is_err() {
            tries += 1;
            // Armed and disarmed again.
            vehicle.armed = true;
            assert_eq!(vehicle.step(), None);
            vehicle.armed = false;
        }
        assert_eq!(tries > 0, interrupted);
        check(&mut nor, &[new], &format!("{seed}, {change:?}, after {tries}"));
    }
}

/// Damaged parameters that a human accepted are written anew: until all are, each start finds the
/// damage, and none takes a part of them for the whole.
#[test]
fn a_power_cut_while_damage_is_repaired_leaves_it_damaged() {
    let mut nor = used(10, 1);
    let mut vehicle = Vehicle::start(&mut nor);
    vehicle.set(2, 0.012_345);
    vehicle.upload(PlanKind::Mission, &plan(1, 20));
    vehicle.settle().expect("flash that works");
    let value = 0.012_345f32.to_le_bytes();
    let at = nor.bytes.windows(4).rposition(|bytes| bytes == value);
    nor.flip(8 * at.expect("it is stored"));
    let mut after = nor.clone();
    after.record = Some(Vec::new());
    let mut vehicle = Vehicle::start(&mut after);
    assert!(vehicle.loaded.damage.parameters);
    vehicle.set(7, Parameters::declaration(7).expect("it exists").max);
    vehicle.keeper.accept();
    vehicle.settle().expect("flash that works");
    let new = vehicle.state();
    let operations = after.record.take().expect("it is recorded");
    assert!(operations.len() > 4 * Parameters::COUNT);
    let mut told = 0;
    for (number, operation) in operations.into_iter().enumerate() {
        let mut torn = nor.clone();
        torn.random = Random(number as u64);
        torn.tear(operation);
        for nor in [&mut nor.clone(), &mut torn] {
            let (state, loaded) = load(nor);
            told += usize::from(loaded.damage.is_any());
            let is_told = loaded.damage.journal || loaded.damage.parameters;
            assert!(is_told || state.parameters == new.parameters, "at {number}");
            let plan = [(0, 0), new.plans[0]].contains(&state.plans[0]);
            assert!(plan, "at {number}: {:?}", state.plans[0]);
        }
        nor.apply(operation);
    }
    assert!(told > 4 * Parameters::COUNT);
    check(&mut nor, slice::from_ref(&new), "in the end");
}
