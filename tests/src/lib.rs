//! Whole flights: what their tests share.
//!
//! - [`plan`]: missions written in metres from home; [`trace`]: what a flight did, step by step.
//! - [`random`]: flights with everything drawn at random.
//! - [`shaken`]: the core on an inertial sensor that rotors shake.
//! - [`failsafe`]: flights in which something goes wrong.
//! - [`station`]: a ground station at a simulated vehicle, without a socket or a clock.
//! - [`mod@bench`]: the core and a world driven by hand, for what no orderly flight does.
//! - Here: setups by name, and flights that are recorded and replayed whatever they are for.

pub mod bench;
pub mod failsafe;
pub mod plan;
pub mod random;
pub mod shaken;
pub mod station;
pub mod trace;

use std::path::Path;

use windhover_autopilot::{ParameterWrite, Parameters, Preset};
use windhover_model::{Conditions, ModelKind, Vehicle};
use windhover_sim::flight::{self, Flight, Setup};
use windhover_sim::flight_log::FlightLog;
use windhover_sim::mission_file::{self, MissionFile};
use windhover_sim::recording::Recording;
use windhover_sim::sensors::{Receiver, Sensors};

use trace::Trace;

/// A vehicle that is built in.
pub fn vehicle(name: &str) -> Vehicle {
    Vehicle::named(name).expect("a vehicle that is built in")
}

/// The reference conditions with this vehicle, preset and model.
pub fn setup(vehicle_name: &str, preset: Preset, model: ModelKind) -> Setup {
    Setup {
        preset,
        model,
        ..Setup::reference(vehicle(vehicle_name))
    }
}

/// Our preset on the os4 in the reference conditions, on its sensors with this receiver.
pub fn on_sensors(receiver: Receiver) -> Setup {
    Setup {
        sensors: Some(Sensors {
            receiver,
            ..Sensors::default()
        }),
        ..setup("os4", Preset::Windhover, ModelKind::Rigid)
    }
}

/// Our preset on the os4 as a rigid body in still air: for what has nothing to do with wind.
pub fn calm() -> Setup {
    Setup {
        conditions: Conditions::default(),
        ..setup("os4", Preset::Windhover, ModelKind::Rigid)
    }
}

/// The same setup with another seed.
pub fn seeded(setup: &Setup, seed: u64) -> Setup {
    let mut setup = setup.clone();
    setup.conditions.seed = seed;
    setup
}

/// The same setup with one parameter set from the start.
pub fn with_parameter(mut setup: Setup, name: &str, value: f64) -> Setup {
    assert!(Parameters::find(name).is_some(), "{name} is no parameter");
    setup.vehicle.parameters.insert(name.into(), value);
    setup
}

/// A write to the parameter of that name.
pub fn write(name: &str, value: f32) -> ParameterWrite {
    let index = Parameters::find(name).unwrap_or_else(|| panic!("{name} is no parameter"));
    ParameterWrite {
        index: index as u16,
        value,
    }
}

/// A mission file of this repository, by its path in it.
pub fn mission(path: &str) -> MissionFile {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    mission_file::read(&root.join(path)).expect("a mission that is read")
}

/// The reference mission.
pub fn monitoring() -> MissionFile {
    mission("missions/monitoring.plan")
}

/// Flies and logs: the flight, and its log as the program writes it.
pub fn logged(setup: &Setup, mission: &MissionFile) -> (Flight, Vec<u8>) {
    let loaded = flight::closed_loop(setup, mission).expect("a flight that starts");
    let (parameters, home) = (*loaded.outer().parameters(), flight::home(mission));
    let mut log = FlightLog::new(setup, &parameters, home, &mission.stored(), &[]);
    let mut flown = flight::fly(setup, mission, &mut log, &mut |_| {}).expect("a flight that starts");
    flown.figures.log_bytes_per_s = log.rate(flown.simulated);
    let bytes = log.finish(&[], &flown.events);
    (flown, bytes)
}

/// Flies and records, and replays the record: the same motor commands, whatever the flight was.
pub fn recorded(setup: &Setup, mission: &MissionFile) -> (Flight, Recording) {
    let mut recording = Recording::default();
    let flown = flight::fly(setup, mission, &mut recording, &mut |_| {}).expect("a flight that starts");
    replay(setup, mission, &recording);
    (flown, recording)
}

/// Like [`recorded`], with a trace of every outer step.
pub fn traced(setup: &Setup, mission: &MissionFile) -> (Flight, Trace) {
    let (mut recording, mut trace) = (Recording::default(), Trace::default());
    let mut both = (&mut recording, &mut trace);
    let flown = flight::fly(setup, mission, &mut both, &mut |_| {}).expect("a flight that starts");
    replay(setup, mission, &recording);
    (flown, trace)
}

/// A core that is as new gives the recorded motor commands again.
pub fn replay(setup: &Setup, mission: &MissionFile, recording: &Recording) {
    let outer = setup.outer(flight::home(mission)).expect("a vehicle that flies");
    let replayed = recording.replay(setup.inner_config(), outer, &mission.stored());
    assert_eq!(replayed, Ok(()), "replay differs from the flight");
    assert!(recording.ticks() > 0, "nothing was recorded");
}
