//! Equal runs are equal.

use crate::scenario::Scenario;
use crate::tester::{finish, machine};
use windhover_hil::time::MICROSECOND;

fn hash(seed: u64) -> (u64, u64, u64) {
    let mut machine = machine(Scenario::Storm, seed);
    finish(&mut machine).unwrap();
    (machine.trace_hash(), machine.instructions(), machine.now())
}

#[test]
fn equal_seeds_give_equal_runs() {
    assert_eq!(hash(7), hash(7));
}

#[test]
fn equal_seeds_give_equal_runs_in_another_thread() {
    let other = std::thread::spawn(|| hash(8));
    assert_eq!(hash(8), other.join().unwrap());
}

#[test]
fn other_seeds_give_other_runs() {
    assert_ne!(hash(7).0, hash(8).0);
}

#[test]
fn a_run_in_pieces_is_the_same_run() {
    let mut whole = machine(Scenario::Storm, 9);
    let mut pieces = machine(Scenario::Storm, 9);
    whole.run(10_000 * MICROSECOND).unwrap();
    for piece in 1..=10_000 {
        pieces.run(piece * MICROSECOND).unwrap();
    }
    assert_eq!(whole.trace_hash(), pieces.trace_hash());
    assert_eq!(whole.instructions(), pieces.instructions());
}
