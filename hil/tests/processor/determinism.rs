//! Equal runs are equal.

use crate::scenario::Scenario;
use crate::tester::{finish, machine};

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
