//! Attitude control: an attitude has two quaternions, and one torque.

use windhover_control::attitude::{AttitudeController, AttitudeEstimate, AttitudeGains, AttitudeParameters};
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{Quaternion, Vector3};

/// The error is turned away the short way round, whichever of its two signs the setpoint has.
#[test]
fn both_quaternions_of_an_attitude_demand_the_same() {
    let gains = AttitudeGains::new(
        &AttitudeParameters::default(),
        Vector3::new(7.5e-3, 7.5e-3, 1.3e-2),
    );
    let turned = Quaternion::from_rotation_vector(Vector3::new(0.05, -0.03, 0.1));
    let negative = Quaternion::new(-turned.w, -turned.x, -turned.y, -turned.z);
    let torque = |attitude| {
        let setpoint = AttitudeSetpoint {
            attitude,
            rate: Vector3::zeros(),
            thrust: 6.4,
        };
        let estimate = AttitudeEstimate {
            attitude: Quaternion::IDENTITY,
            rate: Vector3::zeros(),
        };
        let mut controller = AttitudeController::default();
        controller.step(&gains, &setpoint, 0.0, &estimate, Vector3::zeros(), 1e-3)
    };
    let wanted = torque(turned);
    assert_eq!(torque(negative), wanted);
    assert!(wanted.x > 0.0 && wanted.y < 0.0 && wanted.z > 0.0, "{wanted}");
}
