//! What ground stations stored, after power failed at any moment of it, and after bits flipped.

use std::ops::Range;

use mavlink::dialects::common::{HEARTBEAT_DATA, MavCmd, MavMissionResult, MavResult};
use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::{Blocker, Parameters};
use windhover_hil::flight::Flight;
use windhover_model::random::Random;

use crate::station::{Station, downloaded, monitoring};
use crate::{is_long, plan};

/// The sectors that the journal lies in.
const SECTORS: Range<u32> = 0x0800_4000..0x0801_0000;

/// A parameter that is written, and its default.
const NAME: &str = "RTL_RETURN_ALT";
const DEFAULT: f32 = 30.0;

/// What lies in the journal's sectors.
pub fn image(flight: &Flight) -> Vec<u8> {
    let mut bytes = vec![0; SECTORS.len()];
    assert!(flight.machine.read_memory(SECTORS.start, &mut bytes));
    bytes
}

/// Puts this there.
pub fn put_image(flight: &mut Flight, image: &[u8]) {
    assert!(flight.machine.write_memory(SECTORS.start, image));
}

/// A mission that is like no other one.
fn mission(number: u64) -> Vec<MissionItem> {
    let mut items = monitoring();
    for item in items.iter_mut().filter(|item| item.command == 16) {
        item.z += number as f32 * 0.01;
    }
    items
}

/// What a station finds on board: a parameter, and the mission.
#[derive(Clone, Debug, PartialEq)]
struct Found {
    value: f32,
    mission: Vec<Vec<u8>>,
}

impl Found {
    fn on(station: &mut Station) -> Self {
        Self {
            mission: station.download(),
            value: station.parameter(NAME),
        }
    }
}

fn errors(station: &Station) -> Vec<String> {
    let errors = station.said().iter().filter(|line| line.level == "error");
    errors.map(|line| line.message.clone()).collect()
}

/// What a round stores.
struct Store {
    number: u64,
    value: Option<f32>,
    mission: Option<Vec<MissionItem>>,
}

impl Store {
    /// A parameter, a mission, or both.
    fn new(number: u64) -> Self {
        Self {
            number,
            value: (number % 3 != 1).then_some(20.0 + (number % 50) as f32),
            mission: (!number.is_multiple_of(3)).then(|| mission(number)),
        }
    }

    /// The flash's operations within which power is to fail: as many as a mission of this length takes,
    /// or a parameter.
    fn operations(&self) -> u64 {
        if self.mission.is_some() { 250 } else { 30 }
    }

    /// What is found once all is stored.
    fn over(&self, old: &Found) -> Found {
        let mission = self.mission.as_deref().map(downloaded);
        Found {
            value: self.value.unwrap_or(old.value),
            mission: mission.unwrap_or_else(|| old.mission.clone()),
        }
    }

    /// Has it stored; whether power failed meanwhile. It is back then, and does not fail again.
    fn perform(&self, station: &mut Station) -> bool {
        let failures = station.power_failures;
        if let Some(value) = self.value {
            station.ask_for_value(NAME, value);
        }
        if let Some(items) = &self.mission {
            let outcome = station.upload(items);
            assert!(
                outcome == MavMissionResult::MAV_MISSION_ACCEPTED || station.power_failures > failures,
                "{}: {outcome:?}",
                self.number
            );
        }
        // Parameters rest for half a second before they are stored.
        let (mut before, mut quiet) = (0, 0);
        while station.power_failures == failures && quiet < 14 {
            station.run(0.05);
            let operations = station.flight.machine.bus().flash_operations();
            quiet = if operations == before { quiet + 1 } else { 0 };
            before = operations;
        }
        let failed = station.power_failures > failures;
        if failed {
            station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
        } else {
            // All was stored with fewer operations.
            station.flight.machine.bus().cut_power_at(u64::MAX);
        }
        failed
    }
}

/// At random operations of the flash while a mission, a parameter, or both are stored: the next
/// start finds the old or the new one of each, whole, and nothing that is damaged. The journal is
/// never made anew, so that its pages turn in between.
#[test]
fn power_that_fails_while_a_station_stores_leaves_old_or_new() {
    let moments = if is_long() { 1000 } else { 100 };
    let mut random = Random::new(8, 1);
    let mut station = Station::new(&plan(1.0));
    station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
    let mut old = Found::on(&mut station);
    let (mut renewed, mut number) = ([0; 2], 0);
    while station.power_failures < moments {
        number += 1;
        let store = Store::new(number);
        let moment = {
            let bus = &mut station.flight.machine.bus();
            let moment = bus.flash_operations() + random.bits() % store.operations();
            bus.cut_power_at(moment);
            moment
        };
        let new = store.over(&old);
        let failed = store.perform(&mut station);
        let found = Found::on(&mut station);
        let what = format!("{number}, at operation {moment}");
        assert!(
            [old.value, new.value].contains(&found.value),
            "{what}: {} was {} or {}",
            found.value,
            old.value,
            new.value
        );
        assert!(
            [&old.mission, &new.mission].contains(&&found.mission),
            "{what}: neither mission: {:?}",
            found.mission
        );
        assert_eq!(errors(&station), [""; 0], "{what}");
        if failed {
            renewed[0] += usize::from(found.value != old.value);
            renewed[1] += usize::from(found.mission != old.mission);
        } else {
            assert_eq!(found, new, "{what}: power did not fail");
        }
        old = found;
    }
    println!(
        "{moments} power cuts in {number} rounds, {} operations of the flash; new after it: {} parameters, \
         {} missions",
        station.flight.machine.bus().flash_operations(),
        renewed[0],
        renewed[1]
    );
    assert!(renewed.iter().all(|times| *times > 0), "{renewed:?}");
    let starts = station.flight.machine.resets().len();
    assert!(starts <= moments + 1, "{starts} starts: it restarts by itself");
}

/// Bits of a journal with a mission and parameters in it flip, one each time, where something is
/// written and elsewhere: the next start has what was stored, or says that it is damaged, does not
/// arm for it, and has defaults.
#[test]
fn a_bit_that_flips_in_the_journal_is_told_or_does_no_harm() {
    let flips = if is_long() { 500 } else { 48 };
    let mut station = Station::new(&plan(1.0));
    station.wait::<HEARTBEAT_DATA>(5.0, |_| true);
    let items = monitoring();
    assert_eq!(station.upload(&items), MavMissionResult::MAV_MISSION_ACCEPTED);
    station.set_parameter(NAME, 42.0);
    station.set_parameter("MPC_LAND_SPEED", 0.5);
    station.run(2.0);
    let stored = image(&station.flight);
    let truth = Found {
        value: 42.0,
        mission: downloaded(&items),
    };
    let used: Vec<usize> = (0..stored.len()).filter(|at| stored[*at] != 0xFF).collect();
    let mut random = Random::new(8, 2);
    let (mut told, mut harmless) = (0, 0);
    for flip in 0..flips {
        let at = match flip % 4 {
            0 => random.bits() as usize % stored.len(),
            _ => used[random.bits() as usize % used.len()],
        };
        let bit = 1 << (random.bits() % 8);
        let mut image = stored.clone();
        image[at] ^= bit;
        put_image(&mut station.flight, &image);
        station.texts.clear();
        station.power_cycle();
        let found = Found::on(&mut station);
        let errors = errors(&station);
        let place = format!("bit {bit:#x} of {at:#x}: {errors:?}");
        // Without samples yet, it would be refused for that alone.
        station.run(0.5);
        let arm = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let armed = station.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, arm);
        assert_ne!(armed, MavResult::MAV_RESULT_ACCEPTED, "{place}");
        station.run(0.2);
        let blocked = station
            .texts
            .iter()
            .any(|text| text.ends_with(Blocker::StorageDamaged.text()));
        let is_damaged = errors.iter().any(|text| text.starts_with("damaged in storage: "));
        assert_eq!(blocked, is_damaged, "{place}: {:#?}", station.texts);
        if is_damaged {
            told += 1;
            let default = Parameters::find(NAME).and_then(|index| Parameters::default().get(index));
            assert_eq!(default, Some(DEFAULT));
            assert!(
                [truth.value, DEFAULT].contains(&found.value),
                "{place}: {}",
                found.value
            );
            assert!(
                found.mission == truth.mission || found.mission.is_empty(),
                "{place}"
            );
        } else {
            harmless += 1;
            assert_eq!(found, truth, "{place}");
            assert_eq!(errors, [""; 0], "{place}");
        }
    }
    println!("{flips} bits flipped: {told} told, {harmless} harmless");
    assert!(told > 0 && harmless > 0, "{told} told, {harmless} harmless");
    assert_eq!(
        station.flight.machine.resets().len(),
        flips,
        "it restarts by itself"
    );
}
