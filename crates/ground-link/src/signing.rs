//! MAVLink 2 signing: who may speak, once a key is set.
//!
//! A signature is a link number, a time and the first 48 bits of
//! SHA-256(key, frame, link, time). Time counts 10 µs since 2015 and only ever grows, for each
//! sender on each of its links: what was sent once is not accepted again. The table of senders is
//! bounded and never forgets one, so that nothing old is taken for new.

use crate::frame::{Address, Frame, SIGNATURE};
use crate::scale::divided;
use crate::sha256::Sha256;
use heapless::Vec;

/// Senders, each with one of its links, whose time is followed.
const STREAMS: usize = 16;

/// A sender that is new here may be behind our time by so much, in 10 µs: a minute.
const NEW_STREAM: u64 = 6_000_000;

/// `HEARTBEAT` and `RADIO_STATUS`: a radio cannot sign, and who is there may be known to all.
const UNSIGNED: [u32; 2] = [0, 109];

/// What was not let in since start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    /// Without a signature.
    pub unsigned: u32,
    /// With one that is not of our key.
    pub wrong: u32,
    /// Seen before, or too old for a sender that is new.
    pub replayed: u32,
    /// From more senders than there is room for.
    pub crowded: u32,
}

/// One sender on one link, and its newest time.
#[derive(Clone, Copy, Debug)]
struct Stream {
    sender: Address,
    link: u8,
    time: u64,
}

#[derive(Clone, Debug)]
struct Key {
    secret: [u8; 32],
    /// Time of signing at `since`, 10 µs since 2015.
    time: u64,
    /// Time of the link at which it was that, µs.
    since: u64,
    /// The last time that was written.
    last: u64,
}

/// Checks and makes signatures; lets everything pass until a key is set.
///
/// There is one for all channels of a vehicle: what was heard on one of them is not accepted again
/// on another.
#[derive(Clone, Debug, Default)]
pub struct Signing {
    key: Option<Key>,
    streams: Vec<Stream, STREAMS>,
    refusals: Refusals,
}

impl Signing {
    /// From `now` (µs) on only frames signed with this secret are let in. `time` is in 10 µs since
    /// 2015-01-01; it must be later than all that was ever signed with it.
    /// A secret of nothing but zeros, which everybody knows, is none: it ends signing.
    pub fn set_key(&mut self, secret: [u8; 32], time: u64, now: u64) {
        if secret == [0; 32] {
            return self.clear_key();
        }
        self.streams.clear();
        self.key = Some(Key {
            secret,
            time,
            since: now,
            last: time,
        });
    }

    /// Lets everything pass again.
    pub fn clear_key(&mut self) {
        self.key = None;
    }

    /// Whether a key is set.
    pub fn is_on(&self) -> bool {
        self.key.is_some()
    }

    /// What was not let in since start.
    pub fn refusals(&self) -> Refusals {
        self.refusals
    }

    /// The time to store for the next start, 10 µs since 2015.
    pub fn time(&self, now: u64) -> Option<u64> {
        self.key.as_ref().map(|key| key.at(now))
    }

    /// Whether a frame that comes at `now` (µs) may be acted on. Counts it if not.
    pub fn accepts(&mut self, frame: &Frame<'_>, now: u64) -> bool {
        let Some(key) = &mut self.key else { return true };
        let count = match frame.signature {
            None if UNSIGNED.contains(&frame.id) => return true,
            None => &mut self.refusals.unsigned,
            Some(signature) => {
                let (link, time, hash) = parts(signature);
                if !equal(&key.hash(frame.covered, link, time), &hash) {
                    &mut self.refusals.wrong
                } else {
                    match admit(&mut self.streams, frame.source, link, time, key.at(now)) {
                        Admission::Accepted => {
                            key.catch_up(time, now);
                            return true;
                        }
                        Admission::Replayed => &mut self.refusals.replayed,
                        Admission::Crowded => &mut self.refusals.crowded,
                    }
                }
            }
        };
        *count = count.saturating_add(1);
        false
    }

    /// The signature for a frame that goes out at `now` (µs) on the channel of that number.
    pub fn sign(&mut self, covered: &[u8], link: u8, now: u64) -> [u8; SIGNATURE] {
        let mut signature = [0; SIGNATURE];
        let Some(key) = &mut self.key else {
            return signature;
        };
        let time = key.at(now).max(key.last.saturating_add(1));
        key.last = time;
        let hash = key.hash(covered, link, time);
        let stamp = stamp(link, time);
        for (to, from) in signature.iter_mut().zip(stamp.iter().chain(&hash)) {
            *to = *from;
        }
        signature
    }
}

enum Admission {
    Accepted,
    Replayed,
    Crowded,
}

fn admit(streams: &mut Vec<Stream, STREAMS>, sender: Address, link: u8, time: u64, now: u64) -> Admission {
    let known = streams
        .iter_mut()
        .find(|stream| stream.sender == sender && stream.link == link);
    match known {
        Some(stream) if time > stream.time => {
            stream.time = time;
            Admission::Accepted
        }
        Some(_) => Admission::Replayed,
        None if time.saturating_add(NEW_STREAM) < now => Admission::Replayed,
        None => match streams.push(Stream { sender, link, time }) {
            Ok(()) => Admission::Accepted,
            Err(_) => Admission::Crowded,
        },
    }
}

impl Key {
    fn at(&self, now: u64) -> u64 {
        self.time
            .saturating_add(divided(now.saturating_sub(self.since), 10))
    }

    /// Others may know the time better: ours is never behind one that was accepted.
    fn catch_up(&mut self, time: u64, now: u64) {
        if time > self.at(now) {
            self.time = time;
            self.since = now;
        }
    }

    fn hash(&self, covered: &[u8], link: u8, time: u64) -> [u8; 6] {
        let mut hash = Sha256::new();
        hash.update(&self.secret);
        hash.update(covered);
        hash.update(&stamp(link, time));
        hash.first_six()
    }
}

/// Link and time as a signature has them.
fn stamp(link: u8, time: u64) -> [u8; 7] {
    let [a, b, c, d, e, f, _, _] = time.to_le_bytes();
    [link, a, b, c, d, e, f]
}

fn parts(signature: &[u8; SIGNATURE]) -> (u8, u64, [u8; 6]) {
    let [link, a, b, c, d, e, f, hash @ ..] = *signature;
    (link, u64::from_le_bytes([a, b, c, d, e, f, 0, 0]), hash)
}

/// Takes the same time whatever differs.
fn equal(a: &[u8; 6], b: &[u8; 6]) -> bool {
    a.iter().zip(b).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use sha2::Digest;

    use super::*;
    use crate::frame::{MAX_FRAME, Parser, Writer};

    const SECRET: [u8; 32] = [7; 32];
    const TIME: u64 = 36_000_000_000_000;

    /// A sender with its link.
    struct Sender(Signing, u8);

    fn vehicle(time: u64) -> Signing {
        let mut signing = Signing::default();
        signing.set_key(SECRET, time, 0);
        signing
    }

    fn station(link: u8, time: u64) -> Sender {
        Sender(vehicle(time), link)
    }

    fn frame(signing: Option<&mut Sender>, system: u8, id: u32, now: u64) -> Vec<u8> {
        let mut buffer = [0; MAX_FRAME];
        let mut writer = Writer::new(Address { system, component: 1 });
        let length = match signing {
            Some(Sender(signing, link)) => {
                let mut sign = |bytes: &[u8]| signing.sign(bytes, *link, now);
                writer.write(&mut buffer, id, &[1, 2, 3], Some(&mut sign))
            }
            None => writer.write(&mut buffer, id, &[1, 2, 3], None),
        };
        buffer[..length.unwrap()].to_vec()
    }

    fn accepts(signing: &mut Signing, bytes: &[u8], now: u64) -> bool {
        let mut accepted = Vec::new();
        Parser::default().feed(bytes, |frame| accepted.push(signing.accepts(frame, now)));
        assert_eq!(accepted.len(), 1);
        accepted[0]
    }

    /// The signature as the document of the protocol describes it, from `sha256sum`'s view.
    #[test]
    fn a_signature_is_the_start_of_the_hash_over_key_frame_link_and_time() {
        let bytes = frame(Some(&mut station(3, TIME)), 255, 76, 0);
        let (covered, signature) = bytes.split_at(bytes.len() - SIGNATURE);
        let time = (TIME + 1).to_le_bytes();
        assert_eq!((signature[0], &signature[1..7]), (3, &time[..6]));
        let mut all = SECRET.to_vec();
        all.extend(covered);
        all.extend(&signature[..7]);
        assert_eq!(&signature[7..], &sha2::Sha256::digest(&all)[..6]);
    }

    #[test]
    fn everything_passes_without_a_key() {
        let mut vehicle = Signing::default();
        assert!(accepts(&mut vehicle, &frame(None, 255, 76, 0), 0));
        assert!(accepts(
            &mut vehicle,
            &frame(Some(&mut station(1, TIME)), 255, 76, 0),
            0
        ));
        assert_eq!(vehicle.refusals(), Refusals::default());
    }

    #[test]
    fn with_a_key_only_signed_frames_and_heartbeats_pass() {
        let mut vehicle = vehicle(TIME);
        assert!(!accepts(&mut vehicle, &frame(None, 255, 76, 0), 0));
        assert!(accepts(&mut vehicle, &frame(None, 255, 0, 0), 0));
        assert!(accepts(&mut vehicle, &frame(None, 51, 109, 0), 0));
        assert!(accepts(
            &mut vehicle,
            &frame(Some(&mut station(1, TIME)), 255, 76, 0),
            0
        ));
        let mut stranger = station(1, TIME);
        stranger.0.set_key([8; 32], TIME, 0);
        assert!(!accepts(&mut vehicle, &frame(Some(&mut stranger), 255, 76, 0), 0));
        let refusals = Refusals {
            unsigned: 1,
            wrong: 1,
            ..Refusals::default()
        };
        assert_eq!(vehicle.refusals(), refusals);
        vehicle.set_key([0; 32], TIME, 0);
        assert!(!vehicle.is_on());
        assert!(accepts(&mut vehicle, &frame(None, 255, 76, 0), 0));
    }

    #[test]
    fn what_was_accepted_once_is_refused_again_on_each_link_for_itself() {
        let mut vehicle = vehicle(TIME);
        let mut sender = station(1, TIME);
        let (old, new) = (
            frame(Some(&mut sender), 255, 76, 0),
            frame(Some(&mut sender), 255, 76, 0),
        );
        assert!(accepts(&mut vehicle, &new, 0));
        assert!(!accepts(&mut vehicle, &new, 0), "the same again");
        assert!(!accepts(&mut vehicle, &old, 0), "older than the newest");
        let other_link = frame(Some(&mut station(2, TIME)), 255, 76, 0);
        assert!(accepts(&mut vehicle, &other_link, 0));
        let other_sender = frame(Some(&mut station(1, TIME)), 254, 76, 0);
        assert!(accepts(&mut vehicle, &other_sender, 0));
        assert_eq!(vehicle.refusals().replayed, 2);
    }

    #[test]
    fn a_new_sender_may_be_behind_by_a_minute_and_ours_catches_up_with_one_ahead() {
        let mut vehicle = vehicle(TIME);
        let late = frame(Some(&mut station(1, TIME - 6_100_000)), 255, 76, 0);
        assert!(!accepts(&mut vehicle, &late, 0));
        let just = frame(Some(&mut station(1, TIME - 5_900_000)), 255, 76, 0);
        assert!(accepts(&mut vehicle, &just, 0));
        let ahead = frame(Some(&mut station(2, TIME + 100_000_000)), 255, 76, 0);
        assert!(accepts(&mut vehicle, &ahead, 0));
        assert!(vehicle.time(0) > Some(TIME + 100_000_000));
    }

    #[test]
    fn the_table_is_bounded_and_forgets_nobody() {
        let mut vehicle = vehicle(TIME);
        let first = frame(Some(&mut station(1, TIME)), 1, 76, 0);
        assert!(accepts(&mut vehicle, &first, 0));
        for system in 2..=40 {
            let bytes = frame(Some(&mut station(1, TIME)), system, 76, 0);
            assert_eq!(accepts(&mut vehicle, &bytes, 0), usize::from(system) <= STREAMS);
        }
        assert_eq!(vehicle.refusals().crowded, 40 - STREAMS as u32);
        assert!(!accepts(&mut vehicle, &first, 0));
    }
}
