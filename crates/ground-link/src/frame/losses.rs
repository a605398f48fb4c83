//! Frames lost on the way here, by the gaps in their senders' sequence numbers.

use heapless::Vec;

use super::Address;

/// Senders whose sequence is followed.
const SENDERS: usize = 8;

/// Numbers behind the last one are late or repeated, not 200 frames lost.
const LATE: u8 = 128;

/// Counts frames that did not arrive.
#[derive(Clone, Debug, Default)]
pub struct Losses {
    senders: Vec<(Address, u8), SENDERS>,
    received: u32,
    lost: u32,
}

impl Losses {
    /// A frame has arrived. Senders beyond the first few are not followed.
    pub fn note(&mut self, source: Address, sequence: u8) {
        self.received = self.received.saturating_add(1);
        let known = self.senders.iter_mut().find(|(sender, _)| *sender == source);
        let Some((_, last)) = known else {
            let _ = self.senders.push((source, sequence));
            return;
        };
        let step = sequence.wrapping_sub(*last);
        if step == 0 {
            return;
        }
        if step < LATE {
            self.lost = self.lost.saturating_add(u32::from(step - 1));
        }
        *last = sequence;
    }

    /// Frames that arrived since start.
    pub fn received(&self) -> u32 {
        self.received
    }

    /// Frames that did not, since start.
    pub fn lost(&self) -> u32 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_count_for_each_sender_and_late_frames_do_not() {
        let station = Address {
            system: 255,
            component: 190,
        };
        let other = Address {
            system: 254,
            component: 190,
        };
        let mut losses = Losses::default();
        for sequence in [250, 251, 254, 254, 1] {
            losses.note(station, sequence);
        }
        losses.note(other, 77);
        losses.note(other, 78);
        assert_eq!((losses.received(), losses.lost()), (7, 2 + 2));
        losses.note(other, 70);
        assert_eq!(losses.lost(), 4, "a late frame is no loss");
    }

    #[test]
    fn more_senders_than_there_is_room_for_are_only_counted() {
        let mut losses = Losses::default();
        for system in 0..=255 {
            let source = Address { system, component: 1 };
            losses.note(source, 0);
            losses.note(source, 2);
        }
        assert_eq!((losses.received(), losses.lost()), (512, SENDERS as u32));
    }
}
