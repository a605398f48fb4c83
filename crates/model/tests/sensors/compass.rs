//! The compass.

use proptest::prelude::*;
use windhover_math::{Euler, Quaternion, Vector3};
use windhover_model::Truth;
use windhover_model::sensor::compass::{Compass, CompassErrors, CompassPart, default_field, earth_field};
use windhover_model::sensor::mounting::Mounting;

use crate::{assert_deviation, at_rest};

const PARTS: [CompassPart; 4] = [
    CompassPart::Ist8310,
    CompassPart::Ist8310Fine,
    CompassPart::Qmc5883l2G,
    CompassPart::Qmc5883l8G,
];

/// Nearly no rounding.
const FINE: CompassPart = CompassPart::Qmc5883l2G;

fn length(v: Vector3<f64>) -> f64 {
    v.dot(&v).sqrt()
}

/// In µT.
fn field(part: &mut Compass, truth: &Truth) -> Vector3<f64> {
    let (scale, sign) = (part.part().scale(), part.part().z_sign());
    let [x, y, z] = part.measure(truth).map(|count| f64::from(count) / scale);
    Vector3::new(x, y, z * sign)
}

fn ideal(part: CompassPart) -> Compass {
    Compass::new(part, &CompassErrors::ideal(), default_field(), 1)
}

proptest! {
    #[test]
    fn without_errors_the_field_is_the_earths(roll in -1.0_f64..1.0, pitch in -1.0_f64..1.0, yaw in -3.1_f64..3.1) {
        let attitude = Quaternion::from_euler(Euler { roll, pitch, yaw });
        let truth = Truth { attitude, ..at_rest() };
        for part in PARTS {
            let error = attitude.rotate(field(&mut ideal(part), &truth)) - default_field();
            // Half a count of each axis.
            prop_assert!(length(error) <= 0.87 / part.scale(), "{:?}: {}", part, error);
        }
    }
}

#[test]
fn the_field_points_where_it_is_said_to() {
    let right_angle = core::f64::consts::FRAC_PI_2;
    assert!(length(earth_field(0.0, 0.0, 40.0) - Vector3::new(40.0, 0.0, 0.0)) < 1e-12);
    assert!(length(earth_field(right_angle, 0.0, 40.0) - Vector3::new(0.0, 40.0, 0.0)) < 1e-12);
    assert!(length(earth_field(1.0, right_angle, 40.0) - Vector3::new(0.0, 0.0, 40.0)) < 1e-12);
    assert!((length(default_field()) - 48.4).abs() < 1e-9);
}

#[test]
fn counts_are_those_of_the_parts() {
    let strong = Vector3::new(100.0, -50.0, 10.0);
    let counts = |part| Compass::new(part, &CompassErrors::ideal(), strong, 1).measure(&at_rest());
    assert_eq!(counts(CompassPart::Ist8310), [330, -165, -33]);
    assert_eq!(counts(CompassPart::Ist8310Fine), [1320, -660, -132]);
    assert_eq!(counts(CompassPart::Qmc5883l2G), [12_000, -6000, 1200]);
    assert_eq!(counts(CompassPart::Qmc5883l8G), [3000, -1500, 300]);
}

#[test]
fn counts_are_held_at_the_ends_of_the_range() {
    let huge = Vector3::new(1e9, -1e9, 1e9);
    let counts = |part| Compass::new(part, &CompassErrors::ideal(), huge, 1).measure(&at_rest());
    assert_eq!(counts(CompassPart::Ist8310), [5280, -5280, -8250]);
    assert_eq!(counts(CompassPart::Ist8310Fine), [21_120, -21_120, -32_767]);
    assert_eq!(counts(CompassPart::Qmc5883l2G), [24_000, -24_000, 24_000]);
    assert_eq!(counts(CompassPart::Qmc5883l8G), [24_000, -24_000, 24_000]);
}

#[test]
fn the_residual_is_two_hundredths_of_the_field() {
    let errors = CompassErrors {
        residual: 0.02,
        ..CompassErrors::ideal()
    };
    let turned = Truth {
        attitude: Quaternion::from_euler(Euler {
            roll: 0.3,
            pitch: -0.2,
            yaw: 2.0,
        }),
        ..at_rest()
    };
    let mut square = 0.0;
    let n = 4000;
    for seed in 0..n {
        let mut part = Compass::new(FINE, &errors, default_field(), seed);
        let error = field(&mut part, &turned) - turned.attitude.inverse_rotate(default_field());
        square += error.dot(&error) / n as f64;
    }
    let ratio = square.sqrt() / (0.02 * 48.4);
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn hard_iron_turns_with_the_body_and_soft_iron_does_not() {
    let errors = CompassErrors {
        residual: 0.02,
        ..CompassErrors::ideal()
    };
    let mut part = Compass::new(FINE, &errors, default_field(), 3);
    let mut at = |yaw: f64, roll: f64| {
        let attitude = Quaternion::from_euler(Euler {
            roll,
            pitch: 0.0,
            yaw,
        });
        field(
            &mut part,
            &Truth {
                attitude,
                ..at_rest()
            },
        )
    };
    // Two opposite attitudes about down: the horizontal earth field cancels, and what is left
    // besides the vertical field's is the same all round.
    let half = core::f64::consts::PI;
    let north = (at(0.0, 0.0) + at(half, 0.0)) * 0.5;
    let east = (at(1.0, 0.0) + at(1.0 - half, 0.0)) * 0.5;
    assert!(length(north - east) < 0.01);
    // Upside down the soft iron's part changes its sign; the mean of both is hard iron.
    let upside_down = (at(0.0, half) + at(half, half)) * 0.5;
    let hard = length((north + upside_down) * 0.5);
    let wanted = 0.02 * 48.4 * core::f64::consts::FRAC_1_SQRT_2;
    assert!((hard - wanted).abs() < 0.01, "{hard}");
}

#[test]
fn current_makes_a_field_in_proportion() {
    let errors = CompassErrors {
        current: 1.0,
        ..CompassErrors::ideal()
    };
    let at = |errors: &CompassErrors, seed, amperes: f64| {
        let truth = Truth {
            power: amperes * 14.8,
            ..at_rest()
        };
        let mut part = Compass::new(FINE, errors, default_field(), seed);
        field(&mut part, &truth) - default_field()
    };
    for seed in 0..20 {
        let (ten, twenty) = (at(&errors, seed, 10.0), at(&errors, seed, 20.0));
        assert!((length(ten) - 10.0).abs() < 0.02, "{ten}");
        assert!(length(ten * 2.0 - twenty) < 0.03);
    }
    let down = CompassErrors {
        current_direction: Some(Vector3::new(0.0, 0.0, 1.0)),
        ..errors
    };
    assert!(length(at(&down, 1, 15.0) - Vector3::new(0.0, 0.0, 15.0)) < 0.02);
}

#[test]
fn noise_has_its_deviation() {
    let errors = CompassErrors {
        noise: 0.2,
        ..CompassErrors::ideal()
    };
    for part in PARTS {
        let mut compass = Compass::new(part, &errors, default_field(), 1);
        let measured: Vec<[i16; 3]> = (0..8000).map(|_| compass.measure(&at_rest())).collect();
        for axis in 0..3 {
            let values: Vec<f64> = measured
                .iter()
                .map(|m| f64::from(m[axis]) / part.scale())
                .collect();
            // A count of the coarsest part is 1.5 deviations: rounding still adds its twelfth.
            let count = 1.0 / part.scale();
            assert_deviation(&values, (0.04 + count * count / 12.0).sqrt());
        }
    }
}

#[test]
fn a_turned_part_reads_turned_counts() {
    let errors = CompassErrors {
        mounting: Mounting([[0, 1, 0], [1, 0, 0], [0, 0, -1]]),
        ..CompassErrors::ideal()
    };
    let field = Vector3::new(20.0, 1.0, 43.0);
    let counts = Compass::new(FINE, &errors, field, 1).measure(&at_rest());
    assert_eq!(counts, [120, 2400, -5160]);
}

#[test]
fn equal_seeds_give_equal_counts() {
    let run = |seed| {
        let mut part = Compass::new(FINE, &CompassErrors::default(), default_field(), seed);
        (0..100).map(|_| part.measure(&at_rest())).collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}
