//! Whatever bytes there are: the reader ends, without a panic.
#![no_main]

use libfuzzer_sys::fuzz_target;
use windhover_flight_log::reader::{CoreSetup, Entry, Log, difference};

fuzz_target!(|bytes: &[u8]| {
    let Ok(log) = Log::open(bytes) else {
        return;
    };
    let _ = CoreSetup::new(&log);
    let mut entries = log.entries();
    let mut last = None;
    for entry in entries.by_ref() {
        if let Entry::View { view, .. } = entry
            && let Some(last) = last.replace(view)
        {
            let _ = difference(&last, &view);
        }
    }
    assert!(entries.end().is_some_and(|end| end.offset <= bytes.len()));
    let mut periods = log.periods();
    for step in periods.by_ref() {
        let _ = std::hint::black_box(step);
    }
    assert!(periods.end().is_some());
});
