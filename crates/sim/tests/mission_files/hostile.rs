//! Files that are too long, too deep, damaged or random.

use proptest::prelude::*;
use windhover_autopilot::mission::item::MAX_ITEMS;

use super::{PLAN, SURVEY, WAYPOINTS, edited, parse, refusal};

/// A plan with `count` waypoints, compact.
fn plan_of(count: usize) -> String {
    let item =
        r#"{"type":"SimpleItem","autoContinue":true,"command":16,"frame":3,"params":[0,0,0,null,47,8,30]}"#;
    let items = vec![item; count].join(",");
    format!(r#"{{"fileType":"Plan","version":1,"mission":{{"version":2,"items":[{items}]}}}}"#)
}

#[test]
fn a_mission_that_is_too_long_is_refused_with_its_length() {
    assert_eq!(parse(plan_of(MAX_ITEMS)).unwrap().items.len(), MAX_ITEMS);
    let message = refusal(plan_of(MAX_ITEMS + 1));
    assert_eq!(message, "x.plan: has 257 items, a mission holds at most 256");
    let million = refusal(plan_of(1_000_000));
    assert_eq!(million, "x.plan: has 1000000 items, a mission holds at most 256");

    let line = |seq: usize| format!("{seq} 0 3 16 0 0 0 0 47 8 30 1\n");
    let lines: String = (0..300_000).map(line).collect();
    let message = refusal(format!("QGC WPL 110\n{lines}"));
    assert_eq!(message, "x.plan: has 300000 items, a mission holds at most 256");

    let (start, part) = SURVEY.split_once("\"Items\": [").unwrap();
    let many = "{},".repeat(500);
    let message = refusal(format!("{start}\"Items\": [{many}{part}"));
    assert_eq!(message, "x.plan: has 513 items, a mission holds at most 256");
}

#[test]
fn memory_is_bounded_whatever_the_nesting() {
    let level = |inner: &str| format!("{{\"items\":[{}]}}", vec![inner; 200].join(","));
    let plan = level(&level(&level("1")));
    let text = format!(r#"{{"fileType":"Plan","version":1,"mission":{plan}}}"#);
    assert!(refusal(text).contains("mission version is missing"));
    let text = edited("\"items\": [", &format!("\"items\": [{plan},"));
    assert!(refusal(text).contains("more data than a mission needs"));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse(&bytes);
        let _ = parse([b"{\"fileType\":\"Plan\",".as_slice(), &bytes].concat());
        let _ = parse([b"QGC WPL 110\n".as_slice(), &bytes].concat());
    }

    #[test]
    fn damaged_files_are_read_or_refused_in_one_line(
        which in 0..3_usize,
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        drop in 0..40_usize,
    ) {
        let mut bytes = [PLAN, SURVEY, WAYPOINTS][which].as_bytes().to_vec();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let at = cut.index(bytes.len());
        let end = (at + drop).clamp(0, bytes.len());
        bytes.drain(at..end);
        match parse(&bytes) {
            Ok(file) => prop_assert!(file.items.len() <= MAX_ITEMS),
            Err(message) => prop_assert!(!message.contains('\n') && message.chars().count() < 500),
        }
    }
}
