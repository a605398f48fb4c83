//! The inner step alone: what it makes of motion, and what it tells the outer step of it.

use windhover_autopilot::sensing::GYRO_SCALE;
use windhover_autopilot::{Increments, MotorCommand, MotorState, Parameters};
use windhover_math::{GRAVITY, Vector3, sin_cos};

use super::inner::{Stool, flying};

/// Runs to the end of the next full period with results that say the same each time, changed by
/// `change`; the last command.
fn period(stool: &mut Stool, change: &dyn Fn(&mut windhover_autopilot::OuterResult)) -> MotorCommand {
    stool.run_to_boundary();
    if stool.mailboxes.snapshot.is_some() {
        stool.answer(MotorState::Run);
        change(stool.mailboxes.result.as_mut().unwrap());
    }
    stool.tick(None)
}

fn increments(stool: &Stool) -> Increments {
    stool.mailboxes.snapshot.as_ref().unwrap().increments
}

fn rotors(command: MotorCommand) -> [f32; 4] {
    let MotorCommand::Run(rotors) = command else {
        panic!("{command:?}");
    };
    rotors.map(f32::from)
}

/// Largest difference between two rotors, as a share of full command.
fn unevenness(command: MotorCommand) -> f32 {
    let rotors = rotors(command);
    let most = rotors.iter().copied().fold(0.0, windhover_math::max);
    let least = rotors.iter().copied().fold(65_535.0, windhover_math::min);
    (most - least) / 65_535.0
}

/// A vehicle that turns exactly as the setpoint does is left alone, however old the setpoint is:
/// the setpoint has turned on as well.
#[test]
fn a_turning_setpoint_turns_on_between_results() {
    let mut stool = flying(1000);
    stool.gyro = [300, 0, 0];
    let rate = 300.0 * GYRO_SCALE;
    let mut last = MotorCommand::Disarmed;
    for _ in 0..50 {
        last = period(&mut stool, &|result| result.setpoint.rate.x = rate);
    }
    assert!(unevenness(last) < 0.01, "{last:?}");
    // Twenty milliseconds on, no new result.
    for _ in 0..20 {
        last = stool.tick(None);
    }
    assert!(unevenness(last) < 0.01, "{last:?}");
}

/// Specific force is summed up in the body axes of the last snapshot: what the vehicle turned in
/// between is turned back.
#[test]
fn force_is_summed_in_the_axes_of_the_last_snapshot() {
    let mut stool = Stool::new(1000);
    stool.gyro = [30_000, 0, 0];
    let rate = 30_000.0 * GYRO_SCALE;
    stool.run_to_boundary();
    stool.answer(MotorState::Disarmed);
    stool.run_to_boundary();
    stool.tick(None);
    let mut expected = Vector3::zeros();
    for n in 1..=4u8 {
        let (sin, cos) = sin_cos(rate * 1e-3 * f32::from(n));
        expected += Vector3::new(0.0, sin, -cos) * (GRAVITY * 1e-3);
    }
    let found = increments(&stool).velocity;
    assert!(
        (found - expected).abs().max() < 1e-4,
        "{found} and not {expected}"
    );
}

/// A torque that the rotors cannot make does not wind the integral up: when the cause is gone, so
/// is the torque.
#[test]
fn saturation_does_not_wind_the_rate_loop_up() {
    let mut stool = flying(1000);
    let mut last = MotorCommand::Disarmed;
    stool.gyro = [-20_000, 0, 0];
    for _ in 0..250 {
        last = period(&mut stool, &|_| {});
    }
    assert!(unevenness(last) > 0.5, "{last:?}");
    assert_eq!(increments(&stool).saturated, 4);
    stool.gyro = [0; 3];
    // After such a jump the notches of the gyro filter ring for a fifth of a second.
    for _ in 0..50 {
        last = period(&mut stool, &|_| {});
    }
    assert!(unevenness(last) < 0.05, "{last:?}");
}

/// What the rotors cannot lift is told to the outer step, with its sign, and what they do lift
/// comes with their lag.
#[test]
fn thrust_and_its_shortfall_are_told() {
    let vehicle = Parameters::default().vehicle;
    let full = 4.0 * vehicle.rotor_thrust_max();
    let mut stool = flying(1000);
    for _ in 0..100 {
        period(&mut stool, &|result| result.setpoint.thrust = 2.0);
    }
    let quiet = increments(&stool);
    assert!(quiet.thrust_shortfall.abs() < 1e-4, "{quiet:?}");
    assert!((quiet.thrust - 2.0 * 0.004).abs() < 1e-4, "{quiet:?}");
    // At the next boundary the demand goes up by 3 N, within reach.
    period(&mut stool, &|result| result.setpoint.thrust = 5.0);
    period(&mut stool, &|result| result.setpoint.thrust = 5.0);
    let rising = increments(&stool).thrust / 0.004;
    let most = 2.0 + 3.0 * 0.008 / vehicle.rotor_lag;
    assert!(rising > 2.05 && rising < most, "{rising} N, at most {most}");
    for _ in 0..100 {
        period(&mut stool, &|result| result.setpoint.thrust = full + 3.0);
    }
    let short = increments(&stool);
    assert!((short.thrust_shortfall + 3.0 * 0.004).abs() < 1e-3, "{short:?}");
    assert!((short.thrust - full * 0.004).abs() < 1e-3, "{short:?}");
}

/// New gains of the rate loop come without a jump of the torque.
#[test]
fn new_inner_gains_do_not_jump() {
    let mut table = Parameters::default();
    let index = Parameters::find("RATE_TILT_P").unwrap();
    table.set(index, 0.6 * table.get(index).unwrap()).unwrap();
    let retuned = windhover_autopilot::InnerParameters::new(&table);
    let fly = |change: bool| {
        let mut stool = flying(1000);
        stool.gyro = [200, 100, 0];
        for _ in 0..5 {
            period(&mut stool, &|_| {});
        }
        let parameters = if change { retuned } else { None };
        period(&mut stool, &|result| result.parameters = parameters);
        stool.run_to_boundary();
        rotors(stool.tick(None))
    };
    let (with, without) = (fly(true), fly(false));
    for (a, b) in with.into_iter().zip(without) {
        assert!((a - b).abs() < 200.0, "{with:?} after {without:?}");
    }
}

/// On the ground the integrals are forgotten: after a rest there is nothing left of a kick.
#[test]
fn a_rest_forgets_the_integrals() {
    let mut stool = flying(1000);
    stool.gyro = [-100, 0, 0];
    for _ in 0..500 {
        period(&mut stool, &|_| {});
    }
    stool.gyro = [0; 3];
    let mut still = stool.tick(None);
    for _ in 0..20 {
        still = period(&mut stool, &|_| {});
    }
    assert!(unevenness(still) > 0.01, "the integral is there: {still:?}");
    for _ in 0..5 {
        period(&mut stool, &|result| result.motors = MotorState::Idle);
    }
    for _ in 0..20 {
        still = period(&mut stool, &|_| {});
    }
    assert!(unevenness(still) < 0.002, "{still:?}");
}

/// Level and down after 100 ms of silence, and again after the next 100 ms: a recovery in between
/// forgets nothing.
#[test]
fn every_silence_levels() {
    let tilted = |result: &mut windhover_autopilot::OuterResult| {
        let roll = windhover_math::Quaternion::from_small_rotation(Vector3::new(0.3, 0.0, 0.0));
        result.setpoint.attitude = roll;
    };
    let mut stool = flying(1000);
    for silence in 0..3 {
        let mut last = MotorCommand::Disarmed;
        for _ in 0..5 {
            last = period(&mut stool, &tilted);
        }
        assert!(unevenness(last) > 0.05, "it tilts before silence {silence}");
        for _ in 0..90 {
            last = stool.tick(None);
        }
        assert!(unevenness(last) > 0.05, "and keeps on at first");
        for _ in 0..40 {
            last = stool.tick(None);
        }
        // What is left is the integral of the rate, not the tilt.
        assert!(unevenness(last) < 0.05, "silence {silence}: {last:?}");
    }
}
