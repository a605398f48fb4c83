//! An hour in the air, and inputs that nobody would send.

use proptest::prelude::*;
use windhover_estimator::covariance::Group;
use windhover_estimator::measurement::{
    BarometricHeight, ExternalPose, GnssPosition, GnssVelocity, MagneticField,
};
use windhover_estimator::start::Deviations;
use windhover_estimator::{Filter, InertialIncrements, NoiseParameters, Start, State};
use windhover_math::{Quaternion, Vector3};

use crate::dense;
use crate::flight::{Flight, Manoeuvre};

#[test]
fn over_an_hour_the_covariance_stays_symmetric_and_positive_definite() {
    let mut flight = Flight::new(42, Manoeuvre::Hover, 120_000);
    let mut smallest = f64::INFINITY;
    for second in 0..3600 {
        flight.manoeuvre = if second / 60 % 3 == 0 {
            Manoeuvre::Lively
        } else {
            Manoeuvre::Hover
        };
        // Ten minutes without receiver.
        flight.gnss = !(1500..2100).contains(&second);
        for _ in 0..250 {
            flight.step();
        }
        let p = dense::of(flight.filter.covariance());
        assert_eq!(p, p.transpose());
        smallest = windhover_math::min(smallest, dense::smallest_pivot(&p));
        assert!(smallest > 0.0, "{smallest:e} after {second} s");
        assert!(flight.filter.state().is_finite());
    }
    let e = flight.errors();
    println!(
        "smallest pivot {smallest:e}, errors after an hour {:.3?}",
        e.as_slice()
    );
    assert!(
        e[6].abs() < 0.01 && e[7].abs() < 0.01 && e[0].abs() < 1.0 && e[2].abs() < 0.3,
        "{e}"
    );
}

#[test]
fn two_runs_give_equal_bits() {
    let run = || {
        let mut flight = Flight::new(5, Manoeuvre::Lively, 120_000);
        for _ in 0..5000 {
            flight.step();
        }
        flight.filter
    };
    let bits = |filter: &Filter| filter.covariance().to_rows().map(|row| row.map(f32::to_bits));
    let (a, b) = (run(), run());
    assert_eq!(bits(&a), bits(&b));
    assert_eq!(a, b);
}

/// Any bits, or a plausible number.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        1 => proptest::num::f32::ANY,
        1 => -1e5_f32..1e5,
        4 => -10_f32..10.0,
    ]
}

fn vector() -> impl Strategy<Value = Vector3> {
    [number(), number(), number()].prop_map(Vector3::from)
}

fn deviation() -> impl Strategy<Value = f32> {
    prop_oneof![1 => proptest::num::f32::ANY, 1 => 1e-4_f32..1e4, 4 => 1e-4_f32..1.0]
}

#[derive(Clone, Debug)]
enum Input {
    Step(Vector3, Vector3, Vector3, f32),
    Position(Vector3, f32, u64),
    Velocity(Vector3, f32, u64),
    Height(f32, f32),
    Field(Vector3, f32, f32),
    Pose(Vector3, Vector3, Vector3, f32),
    Rest(Vector3, f32),
    Realign(f32),
}

fn input() -> impl Strategy<Value = Input> {
    let lag = || 0_u64..400_000;
    let duration = prop_oneof![1 => proptest::num::f32::ANY, 3 => 1e-6_f32..0.5, 6 => Just(0.004_f32)];
    prop_oneof![
        6 => (vector(), vector(), vector(), duration).prop_map(|(r, b, v, d)| Input::Step(r, b, v, d)),
        1 => (vector(), deviation(), lag()).prop_map(|(p, d, l)| Input::Position(p, d, l)),
        1 => (vector(), deviation(), lag()).prop_map(|(v, d, l)| Input::Velocity(v, d, l)),
        1 => (number(), deviation()).prop_map(|(h, d)| Input::Height(h, d)),
        1 => (vector(), deviation(), number()).prop_map(|(f, d, n)| Input::Field(f, d, n)),
        1 => (vector(), vector(), vector(), deviation()).prop_map(|(p, v, a, d)| Input::Pose(p, v, a, d)),
        1 => (vector(), deviation()).prop_map(|(v, d)| Input::Rest(v, d)),
        1 => deviation().prop_map(Input::Realign),
    ]
}

fn increments(rotation: Vector3, gyro_bias: Vector3, velocity: Vector3, duration: f32) -> InertialIncrements {
    InertialIncrements {
        rotation: Quaternion::from_rotation_vector(rotation).normalized(),
        gyro_bias,
        velocity,
        duration,
    }
}

/// Whatever comes of it; refusals are as good.
fn apply(filter: &mut Filter, input: &Input) {
    let now = filter.time();
    match *input {
        Input::Step(r, b, v, d) => {
            // Half of them in ranges that are let in.
            let _ = filter.predict(&increments(r, b, v * d.abs(), d), now + 4000);
        }
        Input::Position(position, deviation, lag) => {
            let measured = GnssPosition {
                time: now.wrapping_sub(lag),
                position,
                horizontal_deviation: deviation,
                vertical_deviation: deviation,
            };
            let _ = filter.fuse_gnss_position(&measured);
            let _ = filter.fuse_gnss_height(&measured);
        }
        Input::Velocity(velocity, deviation, lag) => {
            let time = now.wrapping_sub(lag);
            let _ = filter.fuse_gnss_velocity(&GnssVelocity {
                time,
                velocity,
                deviation,
            });
        }
        Input::Height(height, deviation) => {
            let _ = filter.fuse_barometer(&BarometricHeight {
                time: now,
                height,
                deviation,
            });
        }
        Input::Field(field, deviation, declination) => {
            let _ = filter.fuse_compass(&MagneticField {
                repeats: 1.0,
                time: now,
                field,
                deviation,
                declination,
            });
        }
        Input::Pose(position, velocity, turn, deviation) => {
            let _ = filter.fuse_pose(&ExternalPose {
                time: now,
                position,
                velocity,
                attitude: Quaternion::from_rotation_vector(turn).normalized(),
                position_deviation: deviation,
                velocity_deviation: deviation,
                attitude_deviation: deviation,
            });
        }
        Input::Rest(v, deviation) => {
            let still = increments(Vector3::zeros(), Vector3::zeros(), v * 0.004, 0.004);
            let _ = filter.fuse_rest(&still, deviation, deviation);
            let _ = filter.fuse_gravity(&still, deviation);
        }
        Input::Realign(deviation) => {
            let _ = filter.realign(deviation, deviation);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]
    #[test]
    fn no_input_makes_the_state_anything_but_finite(inputs in prop::collection::vec(input(), 1..400)) {
        let start = Start { state: State::default(), deviations: Deviations::default() };
        let mut filter = Filter::new(&start, &NoiseParameters::default(), 1_000_000).unwrap();
        for input in &inputs {
            apply(&mut filter, input);
            prop_assert!(filter.state().is_finite(), "{input:?} {:?}", filter.state());
            for group in Group::ALL {
                let v = filter.covariance().variances(group);
                prop_assert!(v.iter().all(|v| v.is_finite()), "{input:?} {group:?} {v:?}");
            }
        }
    }
}
