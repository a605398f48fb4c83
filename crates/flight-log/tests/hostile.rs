//! Logs that were cut, damaged or made to harm: never a panic, never much memory.

// A counting allocator is unsafe by its trait.
#![allow(unsafe_code)]

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use common::{Plot, Random, fly};
use windhover_flight_log::reader::{CoreSetup, Entry, Log, OpenError, Reason, Step, difference};
use windhover_flight_log::{View, wire};

thread_local! {
    static NOW: Cell<usize> = const { Cell::new(0) };
    static PEAK: Cell<usize> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: hands everything on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = NOW.try_with(|now| {
            now.set(now.get() + layout.size());
            let _ = PEAK.try_with(|peak| peak.set(peak.get().max(now.get())));
        });
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        let _ = NOW.try_with(|now| now.set(now.get().saturating_sub(layout.size())));
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// What a reading takes at its peak, bytes.
fn peak(work: impl FnOnce()) -> usize {
    let before = NOW.get();
    PEAK.set(before);
    work();
    PEAK.get() - before
}

/// Reads everything in every way; periods read, and why reading ended.
fn read(bytes: &[u8]) -> Result<(usize, Reason), OpenError> {
    let log = Log::open(bytes)?;
    let _ = CoreSetup::new(&log);
    let mut entries = log.entries();
    let mut last: Option<View> = None;
    for entry in entries.by_ref() {
        if let Entry::View { view, .. } = entry
            && let Some(last) = last.replace(view)
        {
            let _ = difference(&last, &view);
        }
    }
    let end = entries.end().expect("an end").clone();
    assert!(end.offset <= bytes.len());
    let mut periods = log.periods();
    let count = periods
        .by_ref()
        .filter(|step| matches!(step, Step::Period(_)))
        .count();
    let reason = periods.end().expect("an end").reason.clone();
    Ok((count, reason))
}

fn small_log() -> Vec<u8> {
    fly::<16384>(Plot::disrupted(5, 1000, 120)).log
}

#[test]
fn a_log_cut_at_any_byte_gives_everything_before() {
    let flown = fly::<16384>(Plot::disrupted(5, 1000, 120));
    let whole = Log::open(&flown.log).unwrap();
    let all: Vec<Step> = whole.periods().collect();
    for cut in 0..=flown.log.len() {
        let bytes = &flown.log[..cut];
        let log = match Log::open(bytes) {
            Ok(log) => log,
            Err(error) => {
                assert!(cut < wire::FILE_HEADER);
                assert_eq!(error, OpenError::NotUlog);
                continue;
            }
        };
        assert!(cut < flown.header || CoreSetup::new(&log).is_ok());
        let mut steps = log.periods();
        let read: Vec<Step> = steps.by_ref().collect();
        assert!(read.len() <= all.len());
        for (n, (read, whole)) in read.iter().zip(&all).enumerate() {
            let (Step::Period(read_one), Step::Period(whole)) = (read, whole) else {
                panic!("a gap");
            };
            assert_eq!((read_one.record, &read_one.ticks), (whole.record, &whole.ticks));
            assert_eq!(&read_one.inputs, &whole.inputs);
            // The outputs of the last one may be cut off.
            assert!(read_one.outputs == whole.outputs || n + 1 == all.len().min(steps_len(&log)));
        }
        let end = steps.end().unwrap();
        assert!(matches!(end.reason, Reason::Cut | Reason::Complete));
        assert!(end.offset <= cut);
    }
}

fn steps_len(log: &Log<'_>) -> usize {
    log.periods().count()
}

/// Damages some bytes, in one of the ways in which files are damaged.
fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(4) {
        let length = bytes.len();
        let at = random.below(length);
        match random.below(6) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes.truncate(at),
            2 => {
                let until = (at + random.below(40)).min(length);
                bytes.drain(at..until);
            }
            3 => {
                let junk: Vec<u8> = (0..random.below(40)).map(|_| random.next() as u8).collect();
                bytes.splice(at..at, junk);
            }
            4 => bytes[at] = random.next() as u8,
            // The size of some message.
            _ => {
                let mut offset = wire::FILE_HEADER;
                for _ in 0..random.below(200) {
                    let Some(size) = bytes.get(offset..offset + 2) else {
                        break;
                    };
                    offset += wire::MESSAGE_HEADER + usize::from(u16::from_le_bytes([size[0], size[1]]));
                }
                if let Some(size) = bytes.get_mut(offset..offset + 2) {
                    size.copy_from_slice(&(random.next() as u16).to_le_bytes());
                }
            }
        }
        if bytes.is_empty() {
            return;
        }
    }
}

#[test]
fn ten_thousand_damaged_logs() {
    let log = small_log();
    let (mut whole, mut partial, mut refused, mut most) = (0, 0, 0, 0);
    for seed in 0..10_000 {
        let mut random = Random::new(seed);
        let mut bytes = log.clone();
        damage(&mut bytes, &mut random);
        most = most.max(peak(|| match read(&bytes) {
            Ok((_, Reason::Complete)) => whole += 1,
            Ok(_) => partial += 1,
            Err(_) => refused += 1,
        }));
    }
    assert!(most < 5_000_000, "{most} bytes");
    assert!(
        whole > 0 && partial > 0 && refused > 0,
        "{whole} {partial} {refused}"
    );
}

/// A log's header with some message many times after it.
fn repeated(kind: u8, body: impl Fn(u32) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = common::header_bytes(1000, &[]);
    for n in 0..300_000 {
        let body = body(n);
        bytes.extend((body.len() as u16).to_le_bytes());
        bytes.push(kind);
        bytes.extend(body);
    }
    bytes
}

#[test]
fn much_of_anything_takes_little_memory() {
    let key = |n: u32| {
        let key = format!("float P{n}");
        let mut body = vec![key.len() as u8];
        body.extend(key.bytes());
        body.extend(1f32.to_le_bytes());
        body
    };
    let with_number = |id: u16, n: u32, rest: usize| {
        let mut body = id.to_le_bytes().to_vec();
        body.extend(u64::from(n).to_le_bytes());
        body.resize(10 + rest, 0);
        body
    };
    let logs = [
        repeated(wire::kind::INFO, key),
        repeated(wire::kind::PARAMETER, key),
        repeated(wire::kind::FORMAT, |n| {
            format!("topic{n}:uint64_t timestamp;").into_bytes()
        }),
        repeated(wire::kind::SUBSCRIPTION, |n| {
            let mut body = vec![0];
            body.extend((n as u16).to_le_bytes());
            body.extend(b"vehicle_attitude");
            body
        }),
        // Views, stored items, inputs and urgent commands without a period.
        repeated(wire::kind::DATA, |n| with_number(32, n, 16)),
        repeated(wire::kind::DATA, |n| with_number(5, n, 36)),
        repeated(wire::kind::DATA, |n| with_number(8, n, 44)),
        repeated(wire::kind::DATA, |n| {
            let mut body = with_number(7, n, 5);
            body[14] = 1;
            body
        }),
        repeated(wire::kind::TEXT, |_| vec![b'a'; 100]),
        repeated(wire::kind::DROPOUT, |_| vec![0; 2]),
        repeated(b'Z', |_| vec![0; 2]),
    ];
    for (n, log) in logs.iter().enumerate() {
        let most = peak(|| {
            read(log).expect("a log");
        });
        assert!(most < 10_000_000, "log {n}: {most} bytes");
    }
}

#[test]
fn what_is_no_log_is_named() {
    assert_eq!(Log::open(&[]).err(), Some(OpenError::NotUlog));
    assert_eq!(
        Log::open(b"PK\x03\x04 and what follows").err(),
        Some(OpenError::NotUlog)
    );
    let mut log = small_log();
    log[7] = 9;
    assert_eq!(Log::open(&log).err(), Some(OpenError::Version(9)));
    log[7] = 1;
    log[wire::FILE_HEADER + 3 + 8] = 4;
    assert_eq!(Log::open(&log).err(), Some(OpenError::Incompatible));
}

/// A topic of ours with another format: no records of it, and replay says so.
#[test]
fn another_format_is_named() {
    let log = small_log();
    for (name, periods) in [("vehicle_attitude:", true), ("imu_batch:", false)] {
        let mut log = log.clone();
        let at = log
            .windows(name.len())
            .position(|bytes| bytes == name.as_bytes())
            .unwrap();
        let field = at + name.len();
        assert_eq!(&log[field..field + 6], b"uint64");
        log[field] = b'i';
        let (count, reason) = read(&log).unwrap();
        if periods {
            assert_eq!((count, reason), (30, Reason::Complete));
        } else {
            assert_eq!((count, reason), (0, Reason::Format("imu_batch".into())));
        }
    }
}
