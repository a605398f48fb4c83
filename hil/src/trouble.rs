//! What goes wrong inside the processor, by name and time: on the unmodified firmware, from outside.
//!
//! In text `name@seconds`: `outer-spins@8`.

use std::str::FromStr;

use crate::board::Wiring;
use crate::elf::ElfError;
use crate::flight::Vehicle405;
use crate::machine::{Bus, Machine};
use crate::time::SECOND;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TroubleKind {
    /// The outer step never ends.
    OuterSpins,
    /// The inner step never ends.
    InnerSpins,
    /// Something in the thread never ends.
    ThreadSpins,
    /// The stack is used up.
    StackOverflows,
    /// The firmware panics.
    Panics,
    /// The supply fails and comes back at once.
    PowerCut,
}

const NAMES: [(&str, TroubleKind); 6] = [
    ("outer-spins", TroubleKind::OuterSpins),
    ("inner-spins", TroubleKind::InnerSpins),
    ("thread-spins", TroubleKind::ThreadSpins),
    ("stack-overflows", TroubleKind::StackOverflows),
    ("panics", TroubleKind::Panics),
    ("power-cut", TroubleKind::PowerCut),
];

/// All names, for help.
pub fn names() -> impl Iterator<Item = &'static str> {
    NAMES.iter().map(|(name, _)| *name)
}

/// What goes wrong and when, in ticks since power-on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trouble {
    /// What.
    pub kind: TroubleKind,
    /// When.
    pub start: u64,
}

/// A text that names no trouble.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}: not NAME@SECONDS; there are {names}", names = NAMES.map(|(name, _)| name).join(", "))]
pub struct NoTrouble(String);

impl FromStr for Trouble {
    type Err = NoTrouble;

    fn from_str(text: &str) -> Result<Self, NoTrouble> {
        let refused = || NoTrouble(text.into());
        let (name, start) = text.split_once('@').ok_or_else(refused)?;
        let (_, kind) = NAMES
            .iter()
            .find(|(known, _)| *known == name)
            .ok_or_else(refused)?;
        let seconds: f64 = start.parse().map_err(|_| refused())?;
        if !(0.0..1e9).contains(&seconds) {
            return Err(refused());
        }
        Ok(Self {
            kind: *kind,
            start: (seconds * SECOND as f64).round() as u64,
        })
    }
}

/// The inner and the outer step in the firmware, and where its thread goes to sleep.
pub const INNER_STEP: &str = "inner::Inner::tick";
/// See [`INNER_STEP`].
pub const OUTER_STEP: &str = "outer_loop::outer_step";
const SLEEP: &str = "stm32f405::sleep";

/// The lock that everything shared is behind: a `RefCell`, whose count of borrowers comes first.
const SHARED: &str = "shared::SHARED";

/// The lowest address of the stack.
const STACK_BOTTOM: u32 = 0x1000_0000;

/// Lets it go wrong, now.
///
/// # Errors
/// When the program has no such function.
pub fn befall(machine: &mut Vehicle405, kind: TroubleKind) -> Result<(), ElfError> {
    match kind {
        TroubleKind::OuterSpins => machine.stall(OUTER_STEP, u64::MAX),
        TroubleKind::InnerSpins => machine.stall(INNER_STEP, u64::MAX),
        TroubleKind::ThreadSpins => machine.stall(SLEEP, u64::MAX),
        TroubleKind::StackOverflows => machine.set_sp(OUTER_STEP, STACK_BOTTOM + 16),
        TroubleKind::Panics => borrow_for_ever(machine),
        TroubleKind::PowerCut => {
            machine.power_cycle();
            Ok(())
        }
    }
}

/// Whoever locks next finds it borrowed, and panics.
fn borrow_for_ever<B: Bus>(machine: &mut Machine<B>) -> Result<(), ElfError> {
    let address = machine.elf().find(SHARED)?.address;
    machine.write_memory(address, &1u32.to_le_bytes());
    Ok(())
}

/// An outer step that is slowed on purpose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slow {
    /// Longest extra time, in s; each is drawn between 0 and this.
    pub most: f64,
    /// Share of the steps that are slowed.
    pub share: f64,
    /// What is random about it follows from this.
    pub seed: u64,
}

/// Slows the outer step from now on.
///
/// # Errors
/// When the program has no such function.
pub fn slow<W: Wiring + 'static>(
    machine: &mut Machine<crate::board::Board<W>>,
    slow: &Slow,
) -> Result<(), ElfError> {
    let mut random = windhover_model::random::Random::new(slow.seed, 405);
    let Slow { most, share, .. } = *slow;
    machine.stall_by(OUTER_STEP, move |_| {
        if random.uniform() < share {
            (random.uniform() * most * SECOND as f64) as u64
        } else {
            0
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn troubles_have_names_and_times() {
        for (name, kind) in NAMES {
            let trouble: Trouble = format!("{name}@1.5").parse().unwrap();
            assert_eq!(
                trouble,
                Trouble {
                    kind,
                    start: SECOND * 3 / 2
                }
            );
        }
        for wrong in ["panics", "panics@", "panics@-1", "panics@nan", "panic@3"] {
            let error = wrong.parse::<Trouble>().unwrap_err().to_string();
            assert!(error.contains(wrong) && error.contains("power-cut"), "{error}");
        }
    }
}
