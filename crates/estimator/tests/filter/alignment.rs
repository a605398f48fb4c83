//! From standing still to a filter.

use windhover_estimator::alignment::{Progress, Stillness, Unsettled};
use windhover_estimator::measurement::MagneticField;
use windhover_estimator::{Alignment, InertialIncrements, NoiseParameters};
use windhover_math::{Euler, Quaternion, Vector3};

use crate::dense;
use crate::flight::FIELD;
use crate::oracle::{GRAVITY, logarithm, narrow, narrow_rotation, wide_rotation};
use crate::random::Random;

struct Bench {
    random: Random,
    attitude: Quaternion<f64>,
    gyro_bias: Vector3<f64>,
    accel_bias: Vector3<f64>,
    /// How much the wind rocks it, m/s² and rad/s.
    wind: f64,
}

impl Bench {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let attitude = Quaternion::from_euler(Euler {
            roll: 0.1 * random.either(),
            pitch: 0.1 * random.either(),
            yaw: 3.1 * random.either(),
        });
        Self {
            attitude,
            gyro_bias: random.normals() * 0.01,
            accel_bias: random.normals() * 0.08,
            wind: 0.0,
            random,
        }
    }

    fn increments(&mut self) -> InertialIncrements {
        let force = self.attitude.inverse_rotate(-GRAVITY) + self.accel_bias;
        let force = force + self.random.normals() * (0.05 + self.wind);
        let rate = self.gyro_bias + self.random.normals() * (2e-3 + 0.05 * self.wind);
        InertialIncrements {
            rotation: narrow_rotation(Quaternion::from_rotation_vector(rate * 0.004)),
            gyro_bias: Vector3::zeros(),
            velocity: narrow(force * 0.004),
            duration: 0.004,
        }
    }

    fn field(&mut self) -> MagneticField {
        let field = self.attitude.inverse_rotate(FIELD) + self.random.normals() * 0.4;
        MagneticField {
            repeats: 1.0,
            time: 0,
            field: narrow(field),
            deviation: 0.4,
            declination: 0.0,
        }
    }
}

#[test]
fn the_errors_of_the_first_attitude_are_those_that_it_claims() {
    let mut sums = [0.0; 3];
    for seed in 1..=200 {
        let mut bench = Bench::new(seed);
        bench.wind = 0.1;
        let mut alignment = Alignment::default();
        let mut settled = false;
        for n in 0..600 {
            if n % 10 == 0 {
                alignment.take_in_field(&bench.field());
            }
            settled = alignment.step(&bench.increments()) == Progress::Settled;
        }
        assert!(settled);
        let place = Vector3::new(1.0, 2.0, 3.0);
        let filter = alignment
            .finish(place, place, &NoiseParameters::default(), 5_000_000)
            .unwrap();
        assert_eq!(filter.state().position, place);
        let e = logarithm(bench.attitude * wide_rotation(filter.state().attitude).conjugate());
        assert!(e.x.abs() < 0.032 && e.y.abs() < 0.032, "{e}");
        let p = dense::of(filter.covariance());
        for k in 0..3 {
            sums[k] += e[k] * e[k] / p[(6 + k, 6 + k)] / 200.0;
        }
        let bias = filter.state().gyro_bias.map(f64::from) - bench.gyro_bias;
        assert!(bias.amax() < 2e-3, "{bias}");
    }
    println!("mean squares {sums:.2?}");
    // The compass's mean is better than one of its measurements, which is what it claims.
    assert!(
        sums[0] > 0.7 && sums[0] < 1.3 && sums[1] > 0.7 && sums[1] < 1.3 && sums[2] < 1.3,
        "{sums:?}"
    );
}

#[test]
fn it_starts_again_when_moved_and_says_why() {
    let mut bench = Bench::new(1);
    let mut alignment = Alignment::new(Stillness::default());
    for _ in 0..100 {
        assert!(matches!(
            alignment.step(&bench.increments()),
            Progress::Collecting(_)
        ));
    }
    let mut pushed = bench.increments();
    pushed.velocity.x += 0.02;
    assert_eq!(
        alignment.step(&pushed),
        Progress::Restarted(Unsettled::Accelerating)
    );
    let mut turned = bench.increments();
    turned.rotation = Quaternion::from_rotation_vector(Vector3::new(0.0, 0.0, 0.01));
    assert_eq!(alignment.step(&turned), Progress::Restarted(Unsettled::Turning));
    let mut broken = bench.increments();
    broken.velocity.y = f32::NAN;
    assert!(matches!(
        alignment.step(&broken),
        Progress::Restarted(Unsettled::Refused(_))
    ));
    for _ in 0..600 {
        alignment.step(&bench.increments());
    }
    assert_eq!(alignment.step(&bench.increments()), Progress::NoField);
    let noise = NoiseParameters::default();
    // Whoever does not wait for a compass gets a filter that knows that it has no heading.
    let filter = alignment
        .finish(Vector3::zeros(), Vector3::new(1.0, 1.0, 1.0), &noise, 0)
        .unwrap();
    assert!(filter.accuracy().heading > 2.0 && filter.accuracy().tilt < 0.02);
    alignment.take_in_field(&bench.field());
    assert_eq!(alignment.step(&bench.increments()), Progress::Settled);
}
