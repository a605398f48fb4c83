//! The power fails in the middle of anything. What was being written is old or new, whole, the rest
//! is as it was, and no start finds damage.

mod common;

use common::nor::{Nor, Operation};
use common::{KINDS, Random, State, Vehicle, load, plan};
use windhover_autopilot::Parameters;
use windhover_autopilot::mission::PlanKind;
use windhover_storage::{Damage, capacity};

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
        let all = usize::from(capacity(kind));
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
            erasures += usize::from(matches!(operation, Operation::Erase { .. }));
            let what = format!("{change:?} before {cuts}, {operation:?}");
            check(&mut nor.clone(), &allowed, &what);
            let mut torn = nor.clone();
            torn.random = Random(cuts as u64);
            torn.tear(operation);
            check(&mut torn.clone(), &allowed, &format!("{what}, within"));
            if cuts % often == 0 {
                let mut vehicle = Vehicle::start(&mut torn);
                change.make(&mut vehicle);
                vehicle.settle().expect("flash that works again");
                check(&mut torn, &[new.clone()], &format!("{what}, and again"));
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
            vehicle.upload(kind, &plan(round, capacity(kind).into()));
            vehicle.settle().expect("flash that works");
        }
    }
    let changes = [
        Change::Plan(PlanKind::Mission, 7, capacity(PlanKind::Mission).into()),
        Change::Plan(PlanKind::Fence, 7, capacity(PlanKind::Fence).into()),
        Change::Plan(PlanKind::Mission, 8, capacity(PlanKind::Mission).into()),
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
            let operations = whole.record.take().expect("it is recorded").len();

            nor.power = Some(random.below(operations + 1));
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
