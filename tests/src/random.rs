//! Flights with everything drawn at random from a seed.

use windhover_autopilot::{Parameters, Preset};
use windhover_model::random::Random;
use windhover_model::sensor::fault::SensorFault;
use windhover_model::{ModelKind, mean_wind_from};
use windhover_sim::closed_loop::Disruption;
use windhover_sim::flight::Setup;
use windhover_sim::mission_file::MissionFile;
use windhover_sim::sensors::{Receiver, Sensors};

use crate::plan::Plan;
use crate::{seeded, setup, write};

/// A setup with everything drawn at random: vehicle, preset, rate, late results, missing samples,
/// writes to the parameter table that are taken or refused.
pub fn random_setup(seed: u64) -> Setup {
    let mut random = Random::new(seed, 4711);
    let mut coin = |share: f64| random.uniform() < share;
    let vehicle = if coin(0.5) { "os4" } else { "x450" };
    let preset = if coin(0.5) {
        Preset::Paper
    } else {
        Preset::Windhover
    };
    let imu_rate = if coin(0.5) { 1000 } else { 4000 };
    let mut number = |most: f64| random.uniform() * most;
    let (late, missing) = (number(0.4), number(0.02));
    let disruption = Disruption::new(
        seed,
        late,
        2 + number(8.0) as u32,
        missing,
        1 + number(8.0) as u32,
    );
    let mut writes: Vec<_> = [
        "POS_N_P",
        "POS_D_I",
        "POS_FF",
        "OBS_TC",
        "ATT_TILT_P",
        "MASS",
        "CAL_GYRO0_XOFF",
    ]
    .into_iter()
    .map(|name| {
        let table = Parameters::default();
        let value = table.get(Parameters::find(name).unwrap_or(0)).unwrap_or(0.0);
        (
            2.0 + number(25.0),
            write(name, (value + 0.001) * (0.8 + number(0.19)) as f32),
        )
    })
    .collect();
    writes.push((number(20.0), write("POS_E_P", f32::NAN)));
    writes.push((number(20.0), write("POS_E_P", 1e9)));
    writes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let base = Setup {
        imu_rate,
        disruption: Some(disruption),
        writes,
        ..setup(vehicle, preset, ModelKind::Rigid)
    };
    seeded(&base, seed)
}

/// Sensors with a receiver and a fault drawn at random; some flights have no fault.
fn random_sensors(random: &mut Random) -> Sensors {
    let mut number = |most: f64| random.uniform() * most;
    let names = SensorFault::all();
    let faults = (number(1.0) < 0.6).then(|| {
        let name = &names[number(names.len() as f64) as usize].name;
        let text = format!("{name}@{},{}", number(25.0), 0.5 + number(10.0));
        text.parse().expect("a fault of the list")
    });
    Sensors {
        receiver: if number(1.0) < 0.5 {
            Receiver::Standard
        } else {
            Receiver::Rtk
        },
        faults: faults.into_iter().collect(),
        errors: None,
        remote: number(1.0) < 0.5,
        charge: None,
        own_declination: false,
    }
}

/// The same, in wind and gusts from anywhere as well, half of them on sensors.
pub fn random_conditions(seed: u64) -> Setup {
    let mut random = Random::new(seed, 815);
    let mut setup = random_setup(seed);
    if seed.is_multiple_of(2) {
        setup.sensors = Some(random_sensors(&mut random));
    }
    setup.conditions.wind = mean_wind_from(random.uniform() * 6.0, random.uniform() * 360.0);
    setup.conditions.gust = random.uniform() * 1.5;
    setup
}

/// A mission of a few points within 20 m, some of them stops, some with photos.
pub fn random_mission(seed: u64) -> MissionFile {
    let mut random = Random::new(seed, 2718);
    let mut number = |least: f64, most: f64| least + random.uniform() * (most - least);
    let mut plan = Plan::new().takeoff(number(3.0, 8.0) as f32);
    for _ in 0..number(1.0, 5.0) as usize {
        let (north, east, height) = (number(-20.0, 20.0), number(-20.0, 20.0), number(3.0, 10.0));
        let (north, east, height) = (north as f32, east as f32, height as f32);
        let stops = number(0.0, 1.0) < 0.5;
        plan = plan.waypoint(if stops { 1.0 } else { 0.0 }, 1.0, north, east, height);
        if number(0.0, 1.0) < 0.4 {
            plan = plan.photo();
        }
    }
    if number(0.0, 1.0) < 0.5 { plan.land() } else { plan }.file()
}
