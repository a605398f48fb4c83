//! A ground station at the flashed firmware's serial port: what it uploads is there, and is still there
//! after power has been away.

use mavlink::dialects::common::{HEARTBEAT_DATA, MavCmd, MavMissionResult, MavResult};
use windhover_hil::serve::memory::Memory;
use windhover_hil::time::SECOND;

use crate::plan;
use crate::station::{Station, downloaded, monitoring};

/// Uploaded and set, and there again after power has been away; uploads enough to turn the journal's
/// pages meanwhile, while the processor stands still for the flash.
#[test]
fn what_is_uploaded_outlasts_power() {
    let mut station = Station::new(&plan(1.0));
    station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
    assert_eq!(station.parameter("RTL_RETURN_ALT"), 30.0, "its default");
    let short = monitoring();
    let mut items = short.clone();
    while items.len() < 150 {
        items.extend_from_slice(&short[1..]);
    }
    let last = 140;
    // Some 5 kB each: more than three sectors hold.
    for count in [150, 149, 148, 147, 146, 145, 144, 143, 142, 141, last] {
        let outcome = station.upload(&items[..count]);
        assert_eq!(
            outcome,
            MavMissionResult::MAV_MISSION_ACCEPTED,
            "{:?}",
            station.flight.lines
        );
        station.set_parameter("RTL_RETURN_ALT", count as f32);
        // Parameters rest before they are stored.
        station.run(3.0);
    }
    assert_eq!(station.download(), downloaded(&items[..last]));
    station.power_cycle();
    assert_eq!(station.download(), downloaded(&items[..last]));
    assert_eq!(station.parameter("RTL_RETURN_ALT"), last as f32);
    // And once more: what is read back is stored as it is.
    station.power_cycle();
    assert_eq!(station.download(), downloaded(&items[..last]));
    let errors: Vec<_> = station
        .flight
        .lines
        .iter()
        .filter(|line| line.level == "error")
        .collect();
    assert!(errors.is_empty(), "{errors:?}");
    assert_eq!(station.flight.machine.resets().len(), 2, "no watchdog meanwhile");
}

/// What a board's flash keeps goes into a file, and from there into another board's.
#[test]
fn a_file_is_as_good_as_a_flash() {
    let folder = std::env::temp_dir().join(format!("windhover-flash-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("board.flash");
    let start = || {
        let mut station = Station::new(&plan(1.0));
        let memory = Memory::load(&path, &mut station.flight.machine).expect("it is read");
        station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
        (station, memory)
    };
    let items = monitoring();
    let (mut station, mut memory) = start();
    memory.store(&station.flight.machine).expect("nothing to do");
    assert!(!path.exists(), "nothing was stored");
    assert_eq!(station.upload(&items), MavMissionResult::MAV_MISSION_ACCEPTED);
    station.set_parameter("RTL_RETURN_ALT", 42.0);
    station.run(3.0);
    memory.store(&station.flight.machine).expect("it is written");
    let (mut other, _) = start();
    assert_eq!(other.parameter("RTL_RETURN_ALT"), 42.0);
    assert_eq!(other.download(), downloaded(&items));
    std::fs::remove_dir_all(folder).expect("it was made here");
}

/// A restart that comes before its answer has left looks like a vehicle that is gone: whenever it is
/// asked for between two looks at what is to be stored, the answer comes first.
#[test]
fn a_restart_is_answered_first() {
    let mut station = Station::new(&plan(1.0));
    for starts in 1..=10 {
        station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
        // Everything is stored, so that nothing holds it up.
        station.run(1.0);
        let ask = station.flight.machine.now() + starts * SECOND / 200;
        station.flight.run(ask).expect("it runs");
        let restart = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let answer = station.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, restart);
        assert_eq!(answer, MavResult::MAV_RESULT_ACCEPTED);
        station.until(1.0, "it restarts", |station| {
            station.flight.machine.resets().len() == starts as usize
        });
    }
}
