//! Position control at its limits: what it demands there, and that nothing winds up.

use windhover_control::position::{
    AttitudeSetpoint, PositionController, PositionEstimate, PositionParameters,
};
use windhover_control::{TrajectorySetpoint, VehicleParameters};
use windhover_math::{Quaternion, Vector3, acos};

const DT: f32 = 0.004;

/// Holds the vehicle still while the setpoint is `away` from it, for so many seconds; then puts
/// the setpoint where the vehicle is. What is demanded at the end of both.
fn held_back(parameters: &PositionParameters, away: Vector3, seconds: f32) -> [AttitudeSetpoint; 2] {
    let vehicle = VehicleParameters::default();
    let mut controller = PositionController::default();
    let estimate = PositionEstimate {
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: Quaternion::IDENTITY,
        disturbance: Vector3::zeros(),
    };
    let mut step = |at: Vector3| {
        let setpoint = TrajectorySetpoint::at_rest(at, 0.0);
        controller.step(parameters, &vehicle, &setpoint, &estimate, 0.0, DT)
    };
    let mut pulled = step(away);
    for _ in 0..(seconds / DT) as u32 {
        pulled = step(away);
    }
    [pulled, step(Vector3::zeros())]
}

fn tilt(setpoint: &AttitudeSetpoint) -> f32 {
    acos(setpoint.attitude.cos_tilt())
}

fn with_integral() -> PositionParameters {
    PositionParameters {
        north_i: 2.0,
        east_i: 2.0,
        down_i: 2.0,
        ..Default::default()
    }
}

/// A demand beyond the tilt limit keeps its direction, and leaves no integral behind.
#[test]
fn a_tilt_at_its_limit_does_not_wind_up() {
    let parameters = with_integral();
    for away in [
        Vector3::new(20.0, 0.0, 0.0),
        Vector3::new(0.0, -20.0, 0.0),
        Vector3::new(12.0, 12.0, 0.0),
    ] {
        let [pulled, released] = held_back(&parameters, away, 10.0);
        assert!(
            (tilt(&pulled) - parameters.tilt_max).abs() < 1e-3,
            "{}",
            tilt(&pulled)
        );
        let down = pulled.attitude.down_axis();
        assert!((down.x * away.y - down.y * away.x).abs() < 1e-3, "{away}: {down}");
        assert!(-(down.x * away.x + down.y * away.y) > 0.0, "towards it");
        assert!(tilt(&released) < 0.02, "{away}: {} rad are left", tilt(&released));
    }
}

/// The same error inside the limit does leave its integral, or the test above would mean nothing.
#[test]
fn inside_the_limit_the_integral_grows() {
    let [_, released] = held_back(&with_integral(), Vector3::new(0.1, 0.0, 0.0), 5.0);
    let grown = 2.0 * 0.1 * 5.0 / 9.806_65;
    assert!((tilt(&released) - grown).abs() < 0.01, "{}", tilt(&released));
}

/// Thrust at its end, above and below: inside the limits, and nothing winds up.
#[test]
fn a_thrust_at_its_limit_does_not_wind_up() {
    let (parameters, vehicle) = (with_integral(), VehicleParameters::default());
    let full = 4.0 * vehicle.rotor_thrust_max();
    for (down, limit) in [(-20.0, parameters.thrust_max), (20.0, parameters.thrust_min)] {
        let [pulled, released] = held_back(&parameters, Vector3::new(0.0, 0.0, down), 10.0);
        assert!((pulled.thrust - limit * full).abs() < 1e-3, "{} N", pulled.thrust);
        let hover = vehicle.mass * 9.806_65;
        assert!((released.thrust - hover).abs() < 0.2, "{} N", released.thrust);
    }
}

/// A vehicle that lies on its side, or on its back, is asked for no more thrust than one at the
/// tilt limit: the cosine in the height equation has a floor.
#[test]
fn a_steep_attitude_asks_for_no_more_thrust_than_the_tilt_limit() {
    let (parameters, vehicle) = (PositionParameters::default(), VehicleParameters::default());
    let most = vehicle.mass * 9.806_65 / windhover_math::cos(parameters.tilt_max);
    for roll in [1.2f32, 1.57, 3.1] {
        let estimate = PositionEstimate {
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
            attitude: Quaternion::from_rotation_vector(Vector3::new(roll, 0.0, 0.0)),
            disturbance: Vector3::zeros(),
        };
        let setpoint = TrajectorySetpoint::at_rest(Vector3::zeros(), 0.0);
        let demand = PositionController::default().step(&parameters, &vehicle, &setpoint, &estimate, 0.0, DT);
        assert!(
            (demand.thrust - most).abs() < 1e-3,
            "{roll} rad: {} N",
            demand.thrust
        );
    }
}
