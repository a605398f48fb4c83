//! Flash that lies: bits flip, sectors are lost, something else is there. No start panics; it finds
//! the truth, or says what is damaged. A plan that is not the stored one is never taken.

mod common;

use std::panic::{AssertUnwindSafe, catch_unwind};

use common::nor::{Nor, SECTOR, SECTORS};
use common::{KINDS, Random, State, Vehicle, load, plan};
use windhover_autopilot::Parameters;
use windhover_autopilot::mission::PlanKind;
use windhover_storage::Damage;

const BITS: usize = SECTORS * SECTOR * 8;

/// A journal with everything in it and what was overwritten; and all states that were stored, the
/// present one last.
fn journal() -> (Nor, Vec<State>) {
    let mut nor = Nor::blank();
    let mut vehicle = Vehicle::start(&mut nor);
    let mut states = vec![vehicle.state()];
    for round in 0..4u16 {
        for index in (0..Parameters::COUNT).step_by(3) {
            let declaration = Parameters::declaration(index).expect("an index of the table");
            let share = 0.3 * f32::from(round);
            let value = declaration.min + (declaration.max - declaration.min) * share;
            vehicle.set(index, value.clamp(declaration.min, declaration.max));
        }
        for (kind, count) in KINDS.into_iter().zip([60, 20, 5]) {
            vehicle.upload(kind, &plan(u64::from(round), count));
        }
        vehicle.settle().expect("flash that works");
        states.push(vehicle.state());
    }
    nor.strict = false;
    (nor, states)
}

/// Whether what is found is one of these, where nothing is said to be damaged.
fn is_told(nor: &mut Nor, truth: &[State]) -> bool {
    let (state, loaded) = load(nor);
    let Damage {
        parameters,
        refused,
        plans,
        ..
    } = loaded.damage;
    let has = |test: &dyn Fn(&State) -> bool| truth.iter().any(test);
    let parameters = parameters || refused > 0 || has(&|truth| truth.parameters == state.parameters);
    let plans = (0..3).all(|kind| match plans[kind] {
        true => state.plans[kind] == (0, 0),
        false => has(&|truth| truth.plans[kind] == state.plans[kind]),
    });
    parameters && plans
}

/// A share of all bits; it meets every word.
#[test]
fn a_bit_that_flips_is_told_or_does_no_harm() {
    let (mut nor, states) = journal();
    let truth = &states[states.len() - 1..];
    let (mut harmless, mut told) = (0, 0);
    for bit in (0..BITS).step_by(29) {
        nor.flip(bit);
        assert!(is_told(&mut nor, truth), "bit {bit}");
        match load(&mut nor).1.damage.is_any() {
            true => told += 1,
            false => harmless += 1,
        }
        nor.flip(bit);
    }
    assert!(told > 500 && harmless > 5000, "{told} told, {harmless} harmless");
}

/// The mark of a sector and the markers of its page stand a wrong bit.
#[test]
fn a_bit_that_flips_in_a_marker_does_no_harm() {
    let (mut nor, states) = journal();
    let truth = states.last().expect("it was stored");
    for sector in 0..SECTORS {
        let ends = [0..64, (SECTOR - 4) * 8..SECTOR * 8];
        for bit in ends.into_iter().flatten().map(|bit| sector * SECTOR * 8 + bit) {
            nor.flip(bit);
            let (state, loaded) = load(&mut nor);
            assert_eq!(
                (state, loaded.damage),
                (truth.clone(), Damage::default()),
                "bit {bit}"
            );
            nor.flip(bit);
        }
    }
}

/// Or, where it was the newest one, all is as it was before it was begun.
#[test]
fn a_sector_that_is_lost_is_told() {
    let (nor, states) = journal();
    for sector in 0..SECTORS {
        for content in [0x00, 0xff, 0x5a] {
            let mut nor = nor.clone();
            nor.bytes[sector * SECTOR..][..SECTOR].fill(content);
            assert!(is_told(&mut nor, &states), "sector {sector} is {content:#x}");
        }
    }
}

/// Whatever is there: a start ends, and so does everything after it, and what is stored then, after
/// a human has looked, is there at the next start.
#[test]
fn whatever_is_there_can_be_stored_over() {
    for seed in 0..300 {
        let mut random = Random(seed);
        let (mut nor, _) = journal();
        match random.below(4) {
            0 => (0..1 << random.below(12)).for_each(|_| nor.flip(random.below(BITS))),
            1 => nor.bytes.iter_mut().for_each(|byte| *byte = random.next() as u8),
            2 => {
                let (from, length) = (random.below(SECTOR * 2), random.below(SECTOR));
                // Programmed: what is programmed does not become blank but by whole sectors.
                nor.bytes[from..from + length].fill(0);
            }
            // The marks stay.
            _ => {
                for (n, byte) in nor.bytes.iter_mut().enumerate() {
                    if n % SECTOR >= 4 && random.below(3) == 0 {
                        *byte = random.next() as u8;
                    }
                }
            }
        }
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let mut vehicle = Vehicle::start(&mut nor);
            vehicle.keeper.accept();
            vehicle.set(0, Parameters::declaration(0).expect("it exists").max);
            vehicle.upload(PlanKind::Mission, &plan(seed, 30));
            let mut outcome = vehicle.settle();
            // A patchy sector takes a few tries for each record.
            for _ in 0..2000 {
                if outcome.is_err() {
                    if vehicle.keeper.given_up().is_some() {
                        vehicle.keeper.accept();
                    }
                    outcome = vehicle.settle();
                }
            }
            (outcome, vehicle.state())
        }));
        let (outcome, state) = outcome.unwrap_or_else(|_| panic!("it panics at {seed}"));
        let (after, loaded) = load(&mut nor);
        match outcome {
            Ok(()) => {
                assert_eq!(loaded.damage, Damage::default(), "{seed}");
                assert_eq!(after.plans, state.plans, "{seed}");
                assert!(after.parameters == state.parameters, "{seed}");
            }
            Err(error) => panic!("{seed}: {error:?}"),
        }
    }
}

/// CRC-16 of a length, as `sequential-storage` writes it beside the length.
fn length_sum(length: u16) -> u16 {
    let sum = length.to_le_bytes().into_iter().fold(0xffffu16, |sum, byte| {
        (0..8).fold(sum ^ u16::from(byte), |sum, _| match sum & 1 {
            1 => sum >> 1 ^ 0x1a2e,
            _ => sum >> 1,
        })
    });
    !sum
}

/// A header whose power failed may have any length, and a sum that fits it. The start skips it, and
/// what is stored later is found, pages that are moved included.
#[test]
fn a_header_of_a_record_that_nobody_wrote_is_skipped() {
    for length in [265, 300, 2000, 3000] {
        let (mut nor, states) = journal();
        let used = nor.bytes[SECTOR..2 * SECTOR - 8]
            .iter()
            .rposition(|byte| *byte != 0xff);
        let free = SECTOR + used.expect("the second sector is in use").next_multiple_of(4);
        let [low, high] = u16::to_le_bytes(length);
        let [sum_low, sum_high] = length_sum(length).to_le_bytes();
        nor.bytes[free..free + 8].copy_from_slice(&[1, 2, 3, 4, low, high, sum_low, sum_high]);
        let (state, loaded) = load(&mut nor);
        assert_eq!(
            (Some(&state), loaded.damage),
            (states.last(), Damage::default()),
            "{length}"
        );

        let mut vehicle = Vehicle::start(&mut nor);
        for round in 0..10 {
            vehicle.upload(PlanKind::Mission, &plan(round, 150));
            vehicle.settle().expect("flash that works");
        }
        let state = vehicle.state();
        let (after, loaded) = load(&mut nor);
        assert_eq!((after, loaded.damage), (state, Damage::default()), "{length}");
    }
}
