//! What the gyro filter is for, and what it must not cost: quiet motors on a sensor that rotors
//! shake, and an attitude loop that stays as steady as without it.

use rayon::prelude::*;
use windhover_autopilot::Preset;
use windhover_model::sensor::inertial::InertialErrors;
use windhover_model::{Conditions, ModelKind};
use windhover_sim::flight::Setup;
use windhover_tests::shaken::{Shaken, overshoot, roughness};
use windhover_tests::{setup, with_parameter};

/// Roll of the steps, rad.
const ROLL: f64 = 0.2;

/// Both vehicles at both rates, in calm air.
fn setups() -> Vec<Setup> {
    let mut all = vec![];
    for vehicle in ["os4", "x450"] {
        for imu_rate in [1000, 4000] {
            all.push(Setup {
                imu_rate,
                conditions: Conditions::default(),
                ..setup(vehicle, Preset::Windhover, ModelKind::Rigid)
            });
        }
    }
    all
}

fn name(setup: &Setup) -> String {
    format!("{} at {} Hz", setup.vehicle.name, setup.imu_rate)
}

fn without_low_pass(setup: Setup) -> Setup {
    with_parameter(setup, "IMU_GYRO_CUTOFF", 0.0)
}

fn without_notches(setup: Setup) -> Setup {
    with_parameter(setup, "IMU_GYRO_DNF_EN", 0.0)
}

fn unfiltered(setup: Setup) -> Setup {
    without_low_pass(without_notches(setup))
}

/// The core takes the rotors for faster than they are by this share, with the same thrust.
fn with_wrong_speed(setup: Setup, share: f64) -> Setup {
    let plant = setup.vehicle.plant.clone();
    let speed = 1.0 + share;
    let setup = with_parameter(setup, "ROTOR_SPEED_MAX", plant.rotor_speed_max * speed);
    let setup = with_parameter(setup, "ROTOR_KF", plant.k_f / (speed * speed));
    with_parameter(setup, "ROTOR_KM", plant.k_z / (speed * speed))
}

/// Roughness of the commands in hover with the reference conditions' sensor.
fn hover(setup: &Setup) -> f64 {
    roughness(&Shaken::new(setup, &Shaken::errors(setup)).fly(4.0))
}

/// Both filters together make commands at least ten times as smooth; each does its part.
#[test]
fn filters_quieten_the_motors() {
    setups().par_iter().for_each(|setup| {
        let bare = hover(&unfiltered(setup.clone()));
        let low_pass = hover(&without_notches(setup.clone()));
        let notches = hover(&without_low_pass(setup.clone()));
        let both = hover(setup);
        let wrong = hover(&with_wrong_speed(setup.clone(), 0.05));
        let text = format!(
            "{}: {:.2} ‰ without filters, {:.2} with the low-pass filter, {:.2} with notches, {:.3} with \
             both, {:.2} with rotors 5 % slower than said",
            name(setup),
            bare * 1e3,
            low_pass * 1e3,
            notches * 1e3,
            both * 1e3,
            wrong * 1e3
        );
        println!("{text}");
        assert!(both < 0.1 * bare, "{text}");
        assert!(both < 0.5 * low_pass && both < 0.7 * notches, "{text}");
        assert!(wrong < 0.35 * bare, "{text}");
    });
}

/// How far a step of the roll overshoots, with a sensor that is true.
fn step_overshoot(setup: &Setup) -> f64 {
    let mut flight = Shaken::new(setup, &InertialErrors::ideal());
    flight.steer(ROLL as f32, 1.02);
    overshoot(&flight.fly(2.0), ROLL)
}

#[test]
fn filters_do_not_add_to_overshoot() {
    setups().par_iter().for_each(|setup| {
        let (with, without) = (step_overshoot(setup), step_overshoot(&unfiltered(setup.clone())));
        let text = format!(
            "{}: {:.1} % with filters, {:.1} % without",
            name(setup),
            with * 100.0,
            without * 100.0
        );
        println!("{text}");
        assert!(with < without + 0.01, "{text}");
    });
}

/// Whether roll settles after a step with all gains of the rate loop that many times as large,
/// which makes the whole loop's gain that many times as large.
fn settles(setup: &Setup, gain: f64) -> bool {
    let mut scaled = setup.clone();
    for (name, default) in [("RATE_TILT_P", 40.0), ("RATE_TILT_I", 20.0), ("RATE_TILT_D", 0.6)] {
        scaled = with_parameter(scaled, name, gain * default);
    }
    let mut flight = Shaken::new(&scaled, &InertialErrors::ideal());
    flight.steer(0.02, 1.02);
    flight.fly(2.0);
    let rolls = flight.fly(0.5);
    let swing = rolls.iter().map(|&(_, roll)| (roll - 0.02).abs());
    swing.fold(0.0, windhover_math::max) < 0.002
}

/// The largest gain, as a multiple of the one that flies, at which the loop is stable; at most 7.5,
/// where the range of the parameters ends.
fn gain_margin(setup: &Setup) -> f64 {
    let (mut stable, mut unstable) = (1.0, 7.5);
    for _ in 0..10 {
        let middle = f64::sqrt(stable * unstable);
        if settles(setup, middle) {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    stable
}

/// A gain margin of 12 dB at least is left; 6 dB is the usual demand.
#[test]
fn filters_leave_a_gain_margin() {
    setups().par_iter().for_each(|setup| {
        let decibels = |gain| 20.0 * libm::log10(gain);
        let with = decibels(gain_margin(setup));
        let without = decibels(gain_margin(&unfiltered(setup.clone())));
        let text = format!("{}: {with:.1} dB with filters, {without:.1} without", name(setup));
        println!("{text}");
        assert!(with > 12.0, "{text}");
    });
}
