//! Feed-forward of position control: the body rate that goes with the attitude demanded.

use proptest::prelude::*;
use windhover_control::position::{
    AttitudeSetpoint, PositionController, PositionEstimate, PositionParameters,
};
use windhover_control::{TrajectorySetpoint, VehicleParameters};
use windhover_math::{Quaternion, Vector3, scalar};

/// What is demanded of a vehicle that is where it should be.
fn demanded(parameters: &PositionParameters, setpoint: &TrajectorySetpoint) -> AttitudeSetpoint {
    let estimate = PositionEstimate {
        position: setpoint.position,
        velocity: setpoint.velocity,
        attitude: Quaternion::IDENTITY,
        disturbance: Vector3::zeros(),
    };
    let vehicle = VehicleParameters::default();
    PositionController::default().step(parameters, &vehicle, setpoint, &estimate, 0.0, 0.004)
}

proptest! {
    /// Turning on with the rate that is fed forward leads to the attitude that is demanded next,
    /// heading included, also where the vehicle is tilted and turns its nose.
    #[test]
    fn the_rate_leads_to_the_next_attitude(
        a in prop::array::uniform2(-3.0f32..3.0), jerk in prop::array::uniform2(-4.0f32..4.0),
        heading in -3.0f32..3.0, heading_rate in -0.8f32..0.8,
    ) {
        let parameters = PositionParameters::default();
        let dt = 0.02;
        let at = |t: f32| TrajectorySetpoint {
            acceleration: Vector3::new(a[0] + jerk[0] * t, a[1] + jerk[1] * t, 0.0),
            jerk: Vector3::new(jerk[0], jerk[1], 0.0),
            heading: heading + heading_rate * t,
            heading_rate,
            ..TrajectorySetpoint::at_rest(Vector3::zeros(), heading)
        };
        // The rate of the middle leads from one end to the other but for the third order.
        let (now, middle, next) = (
            demanded(&parameters, &at(0.0)),
            demanded(&parameters, &at(0.5 * dt)),
            demanded(&parameters, &at(dt)),
        );
        let turned = now.attitude * Quaternion::from_rotation_vector(middle.rate * dt);
        let off = (turned.conjugate() * next.attitude).shortest();
        let angle = 2.0 * scalar::norm(Vector3::new(off.x, off.y, off.z));
        prop_assert!(angle < 2e-4, "{angle} rad off, turned by {} rad", scalar::norm(middle.rate) * dt);
    }
}

/// A vehicle in free fall has no thrust to turn with: nothing is fed forward, and nothing is
/// divided by it.
#[test]
fn in_free_fall_no_rate_is_fed_forward() {
    let parameters = PositionParameters {
        thrust_min: 0.0,
        ..Default::default()
    };
    for down in [9.3, 9.806_65, 12.0] {
        let setpoint = TrajectorySetpoint {
            acceleration: Vector3::new(0.0, 0.0, down),
            jerk: Vector3::new(2.0, -3.0, 0.0),
            ..TrajectorySetpoint::at_rest(Vector3::zeros(), 0.0)
        };
        let demand = demanded(&parameters, &setpoint);
        assert_eq!(demand.rate, Vector3::zeros(), "{down} m/s²");
        assert!(demand.attitude.is_finite());
    }
}
