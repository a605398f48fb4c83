//! Walking through a mission item by item, jumps included.
//!
//! A [`Cursor`] is a value: looking ahead is walking on with a copy.

use super::MissionSource;
use super::action::{Action, interpret};
use super::item::{MAX_ITEMS, PlanKind};

/// How many jump items a mission may have: their repeats are counted.
pub const MAX_JUMPS: usize = 8;

/// The valid mission: the slot that holds it and how many items it has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stored {
    /// Storage slot.
    pub slot: u8,
    /// Number of items.
    pub count: u16,
}

/// A place in the list of items, with how often each jump was taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cursor {
    next: u16,
    jumps: [(u16, u16); MAX_JUMPS],
}

impl Cursor {
    /// Before the item with this index.
    pub fn before(index: u16) -> Self {
        Self {
            next: index,
            ..Self::default()
        }
    }

    /// The next item that is not a jump, and its index; the cursor stands behind it then. `None`
    /// at the end of the mission, at an item that is not understood, and when a mission of jumps
    /// leads nowhere.
    pub fn advance<S: MissionSource + ?Sized>(
        &mut self,
        source: &S,
        stored: Stored,
    ) -> Option<(u16, Action)> {
        for _ in 0..2 * MAX_ITEMS {
            let index = self.next;
            if index >= stored.count {
                return None;
            }
            let action = interpret(&source.item(PlanKind::Mission, stored.slot, index)?).ok()?;
            self.next = match action {
                Action::Jump { to, times } if self.takes_jump(index, times) => to,
                _ => index + 1,
            };
            if !matches!(action, Action::Jump { .. }) {
                return Some((index, action));
            }
        }
        None
    }

    /// Counts a jump; whether it is still to be taken.
    fn takes_jump(&mut self, index: u16, times: Option<u16>) -> bool {
        let Some(times) = times else {
            return true;
        };
        // A free place has the count 0; places are filled from the front.
        for (at, count) in &mut self.jumps {
            if *count == 0 || *at == index {
                *at = index;
                if *count >= times {
                    return false;
                }
                *count += 1;
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::super::item::MissionItem;
    use super::*;
    extern crate std;
    use std::vec::Vec;

    fn item(command: u16, p1: f32, p2: f32) -> MissionItem {
        MissionItem {
            command,
            frame: 3,
            autocontinue: true,
            params: [p1, p2, 0.0, f32::NAN],
            x: 470_000_000,
            y: 80_000_000,
            z: 10.0,
        }
    }

    fn walk(items: &[MissionItem], most: usize) -> Vec<u16> {
        let stored = Stored {
            slot: 0,
            count: items.len() as u16,
        };
        let mut cursor = Cursor::default();
        let mut visited = Vec::new();
        while let Some((index, _)) = cursor.advance(items, stored) {
            visited.push(index);
            if visited.len() == most {
                break;
            }
        }
        visited
    }

    #[test]
    fn jumps_are_taken_as_often_as_they_say() {
        let way = item(16, 0.0, 0.0);
        let items = [way, way, item(177, 1.0, 2.0), way, item(177, 0.0, 1.0), way];
        // The inner jump has been used up when the outer one leads past it again.
        assert_eq!(walk(&items, 100), [0, 1, 1, 1, 3, 0, 1, 3, 5]);
    }

    #[test]
    fn a_jump_for_ever_goes_on() {
        let way = item(16, 0.0, 0.0);
        assert_eq!(walk(&[way, way, item(177, 0.0, -1.0)], 7), [0, 1, 0, 1, 0, 1, 0]);
    }

    #[test]
    fn jumps_that_lead_nowhere_end() {
        assert_eq!(walk(&[item(177, 0.0, -1.0)], 100), []);
        assert_eq!(walk(&[item(177, 1.0, -1.0), item(177, 0.0, -1.0)], 100), []);
    }
}
