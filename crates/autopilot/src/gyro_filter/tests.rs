//! Sections against their closed forms, and the whole filter against what it is for.

extern crate std;

use std::vec::Vec;

use nalgebra::Complex;
use proptest::prelude::*;
use windhover_parameters::Group;

use super::*;

const PI: f64 = core::f64::consts::PI;

const OS4: Rotors = Rotors {
    speed_max: 400.0,
    lag: 0.03,
};

fn all_axes(value: f64) -> Vector3 {
    Vector3::new(value as f32, -0.5 * value as f32, 0.25 * value as f32)
}

fn size(value: Complex<f64>) -> f64 {
    libm::hypot(value.re, value.im)
}

/// What becomes of a tone at `frequency` (share of the sample rate): gain and phase, once the
/// first `settle` samples are over.
fn response(frequency: f64, settle: u32, mut step: impl FnMut(Vector3) -> Vector3) -> Complex<f64> {
    // Whole periods, so that nothing else adds to the sum.
    let (samples, turns) = (4000, (frequency * 4000.0 + 0.5) as u32);
    let angle = 2.0 * PI * f64::from(turns) / f64::from(samples);
    let mut sum = Complex::new(0.0, 0.0);
    for n in 0..settle + samples {
        let at = angle * f64::from(n);
        let y = step(all_axes(libm::sin(at)));
        assert!((y.x + 2.0 * y.y).abs() < 1e-5 && (y.x - 4.0 * y.z).abs() < 1e-5);
        if n >= settle {
            let turned = Complex::new(libm::cos(at), -libm::sin(at));
            sum += turned * (f64::from(y.x) * 2.0 / f64::from(samples));
        }
    }
    // A sine is the real part of −i·e^(iωt).
    sum * Complex::i()
}

/// The frequencies at which responses are measured: whole periods in 4000 samples.
fn frequencies() -> impl Iterator<Item = f64> {
    (1..60)
        .map(|n| f64::from(n * n) / 4000.0 + 0.0005)
        .filter(|f| *f < 0.49)
        .map(|f| (f * 4000.0 + 0.5) as u32)
        .map(|turns| f64::from(turns) / 4000.0)
}

/// Butterworth's filter 1/(1 + √2·s + s²) by the bilinear transform: s = i·tan(πf)/tan(πf_c).
#[test]
fn the_low_pass_filter_has_butterworths_response() {
    for cutoff in [0.01, 0.03, 0.12, 0.3, 0.45] {
        let filter = LowPass::new(cutoff as f32);
        for f in frequencies() {
            let s = Complex::new(0.0, libm::tan(PI * f) / libm::tan(PI * cutoff));
            let exact = (s * s + s * 2f64.sqrt() + 1.0).inv();
            let (mut input, mut output) = (Past::default(), Past::default());
            let measured = response(f, 2000, |now| {
                let y = filter.apply(now, &input, &output);
                input.push(now);
                output.push(y);
                y
            });
            let error = size(measured - exact);
            assert!(
                error < 2e-5,
                "cutoff {cutoff}, {f}: {measured} instead of {exact}"
            );
        }
    }
}

/// The response of one notch of `width` at `centre` (shares of the sample rate).
fn notch_response(width: f64, centre: f64, weight: f32, f: f64) -> Complex<f64> {
    let of = Width::new(width as f32);
    let notch = of.notch((2.0 * PI * centre) as f32, weight);
    let (mut input, mut tone) = (Past::default(), Past::default());
    response(f, 8000, |sample| {
        let (mut now, mut two) = (sample, input.two);
        notch.take_out(&of, &mut now, &mut two, &mut tone);
        input.push(sample);
        now
    })
}

/// The analogue notch (s² + c²)/(s² + b·s + c²) by the bilinear transform, s = i·tan(πf), with
/// c = tan(π·centre) and b = (1 + c²)·tan(π·width).
#[test]
fn a_notch_has_the_response_of_the_analogue_one() {
    for (width, centre) in [(0.005, 0.036), (0.005, 0.09), (0.02, 0.2), (0.00125, 0.009)] {
        for weight in [0.0, 0.3, 1.0] {
            for f in frequencies() {
                let (s, c) = (Complex::new(0.0, libm::tan(PI * f)), libm::tan(PI * centre));
                let b = (1.0 + c * c) * libm::tan(PI * width);
                let full = (s * s + c * c) / (s * s + s * b + c * c);
                let exact = Complex::new(1.0, 0.0) - (Complex::new(1.0, 0.0) - full) * f64::from(weight);
                let measured = notch_response(width, centre, weight, f);
                let error = size(measured - exact);
                assert!(
                    error < 1e-4,
                    "{width} at {centre}, {f}: {measured} instead of {exact}"
                );
            }
        }
    }
}

#[test]
fn a_notch_is_deep_at_its_centre_and_as_wide_as_it_says() {
    assert!(size(notch_response(0.005, 0.036, 1.0, 0.036)) < 1e-4);
    // Where the response above is −3 dB: c² − t² = ±b·t with t = tan(πf).
    let (width, centre) = (0.01, 0.1);
    let c = libm::tan(PI * centre);
    let half = 0.5 * (1.0 + c * c) * libm::tan(PI * width);
    let [low, high] = [-half, half].map(|b| libm::atan(b + libm::hypot(b, c)) / PI);
    assert!((high - low - width).abs() < 1e-9, "{low} to {high}");
}

fn anywhere() -> impl Strategy<Value = FilterParameters> {
    let ranges: Vec<_> = FilterParameters::DECLARATIONS
        .iter()
        .map(|declared| declared.min..=declared.max)
        .collect();
    ranges.prop_map(|values| FilterParameters {
        cutoff: values[0],
        notches: values[1],
        notch_width: values[2],
        notch_least: values[3],
    })
}

/// Whether both poles of 1/(1 + a₁z⁻¹ + a₂z⁻²) lie inside the unit circle (Jury).
fn is_stable(a1: f64, a2: f64) -> bool {
    a2.abs() < 1.0 && a1.abs() < 1.0 + a2
}

proptest! {
    /// Wherever parameters and rotors are, all poles lie inside the unit circle.
    #[test]
    fn always_stable(
        parameters in anywhere(), rate in prop::sample::select(&[250.0f32, 1000.0, 2000.0, 4000.0, 8000.0]),
        angle in -1.0f32..7.0,
    ) {
        let design = Design::new(&parameters, &OS4, rate);
        if let Some(low_pass) = design.low_pass {
            let (a1, a2) = low_pass.denominator();
            prop_assert!(is_stable(a1, a2), "{low_pass:?}");
        }
        let notch = design.notch(angle);
        let (a1, a2) = notch.denominator(&design.width);
        prop_assert!(is_stable(a1, a2), "{notch:?} {:?}", design.width);
        let weight = notch.weight(&design.width);
        prop_assert!((0.0..=1.0).contains(&weight), "{weight}");
        let least = TAU * parameters.notch_least / rate;
        if angle <= least || angle >= TAU * HIGHEST {
            prop_assert_eq!(weight, 0.0);
        } else if parameters.notches >= 0.5 && angle > 1.26 * least && angle < TAU * (HIGHEST - FADE_HIGH) {
            prop_assert_eq!(weight, 1.0);
        }
    }

    /// Whatever the part measures and the motors are told, what comes out is a number that fits,
    /// and the same a second time.
    #[test]
    fn numbers_that_repeat(
        parameters in anywhere(), rate in prop::sample::select(&[1000.0f32, 4000.0]),
        samples in prop::collection::vec((prop::array::uniform3(any::<i16>()), prop::array::uniform4(any::<u16>())), 1..300),
    ) {
        let mut filter = GyroFilter::new(&parameters, &OS4, rate);
        let mut again = filter.clone();
        for (counts, commands) in samples {
            let sample = Vector3::from(counts.map(f32::from)) * crate::sensing::GYRO_SCALE;
            for filter in [&mut filter, &mut again] {
                filter.follow(&MotorCommand::Run(commands));
                filter.step(sample);
            }
            for axis in 0..3 {
                prop_assert!(filter.rate()[axis].abs() < 35.0 * 32.0, "{}", filter.rate());
                prop_assert_eq!(filter.rate()[axis].to_bits(), again.rate()[axis].to_bits());
            }
        }
    }

    /// What rests comes out as it is, from the first sample on, while rotors change their speed
    /// and parameters change.
    #[test]
    fn rest_stays_rest(
        parameters in prop::array::uniform2(anywhere()), rest in prop::array::uniform3(-35.0f32..35.0),
        commands in prop::collection::vec(prop::array::uniform4(any::<u16>()), 100),
    ) {
        let rest = Vector3::from(rest);
        let mut filter = GyroFilter::new(&parameters[0], &OS4, 1000.0);
        for (n, rotors) in commands.into_iter().enumerate() {
            if n == 50 {
                filter.retune(&parameters[1], &OS4, 1000.0);
            }
            filter.follow(&MotorCommand::Run(rotors));
            filter.step(rest);
            prop_assert_eq!(filter.rate(), rest);
        }
    }
}

/// Frequency of a rotor of the os4 with this command, Hz.
fn hertz(command: u16) -> f64 {
    f64::from(command) / 65535.0 * 400.0 / (2.0 * PI)
}

/// The default filter with rotors that have had these commands for a second.
fn turning(parameters: &FilterParameters, command: MotorCommand, rate: f32) -> GyroFilter {
    let mut filter = GyroFilter::new(parameters, &OS4, rate);
    for _ in 0..rate as u32 {
        filter.follow(&command);
        filter.step(Vector3::zeros());
    }
    filter
}

/// Response of that filter at a frequency in Hz.
fn filter_response(
    parameters: &FilterParameters,
    command: MotorCommand,
    rate: f32,
    frequency: f64,
) -> Complex<f64> {
    let mut filter = turning(parameters, command, rate);
    response(frequency / f64::from(rate), 2 * rate as u32, |sample| {
        filter.follow(&command);
        filter.step(sample);
        filter.rate()
    })
}

#[test]
fn each_rotors_tone_is_taken_out() {
    let tones = [33.0, 35.0, 37.0, 40.0];
    let commands = tones.map(|hz| (hz / hertz(1) + 0.5) as u16);
    for rate in [1000.0, 4000.0] {
        for frequency in tones {
            let parameters = FilterParameters::default();
            let passed = filter_response(&parameters, MotorCommand::Run(commands), rate as f32, frequency);
            let left = size(passed);
            assert!(left < 0.002, "{left} of {frequency} Hz at {rate} Hz");
        }
    }
}

/// One rotor, far from the others, changes its speed by a tenth and back once a second, and shakes
/// the gyro as it really turns: a twentieth of that is left.
#[test]
fn a_notch_follows_its_rotor() {
    let off = FilterParameters {
        notches: 0.0,
        ..Default::default()
    };
    for rate in [1000.0, 4000.0] {
        let mut filters = [FilterParameters::default(), off].map(|p| GyroFilter::new(&p, &OS4, rate as f32));
        let (mut turned, mut speed, mut left) = (0.0, 220.0, [0.0; 2]);
        for n in 0..4 * rate as u32 {
            let wanted = 220.0 * (1.0 + 0.1 * libm::sin(2.0 * PI * f64::from(n) / rate));
            speed += (wanted - speed) / (0.03 * rate);
            turned += speed / rate;
            let command = (wanted / 400.0 * 65535.0) as u16;
            let command = MotorCommand::Run([60_000, 60_000, command, 60_000]);
            for (filter, left) in filters.iter_mut().zip(&mut left) {
                filter.step(all_axes(libm::sin(turned)));
                filter.follow(&command);
                if n > rate as u32 {
                    *left += f64::from(filter.rate().x) * f64::from(filter.rate().x);
                }
            }
        }
        let share = (left[0] / left[1]).sqrt();
        assert!(share < 0.05, "{share} at {rate} Hz");
    }
}

/// The lag that default filters add where the attitude loop crosses over (5 Hz), with all rotors
/// at the os4's hover: of the low-pass filter 3.4°, of the notches 4.5°.
#[test]
fn the_lag_at_crossover_is_small() {
    let hover = MotorCommand::Run([36_980; 4]);
    for rate in [1000.0, 4000.0] {
        let passed = filter_response(&FilterParameters::default(), hover, rate, 5.0);
        let lag = -libm::atan2(passed.im, passed.re).to_degrees();
        assert!((7.0..9.0).contains(&lag), "{lag}° at {rate} Hz");
        assert!((0.98..1.04).contains(&size(passed)));
    }
}

#[test]
fn rotors_at_rest_and_slow_ones_have_no_notch() {
    let off = FilterParameters {
        notches: 0.0,
        ..Default::default()
    };
    for command in [
        MotorCommand::Disarmed,
        MotorCommand::Idle(5000),
        MotorCommand::Run([20_000; 4]),
    ] {
        let mut filters = [FilterParameters::default(), off].map(|p| turning(&p, command, 1000.0));
        for n in 0..500 {
            let sample = all_axes(libm::sin(f64::from(n) * 0.1));
            filters.iter_mut().for_each(|filter| filter.step(sample));
            assert_eq!(filters[0].rate(), filters[1].rate());
        }
    }
}

#[test]
fn without_both_the_samples_pass() {
    let off = FilterParameters {
        cutoff: 0.0,
        notches: 0.0,
        ..Default::default()
    };
    let mut filter = turning(&off, MotorCommand::Run([37_000; 4]), 1000.0);
    for n in 0..100 {
        let sample = all_axes(f64::from(n * n % 17));
        filter.step(sample);
        assert_eq!(filter.rate(), sample);
    }
}

/// In the middle of a turn with vibration, new parameters move the next output by less than the
/// signal itself moves in a few samples.
#[test]
fn retuning_makes_no_jump() {
    let hover = MotorCommand::Run([36_980; 4]);
    let mut filter = turning(&FilterParameters::default(), hover, 1000.0);
    let sample = |n: i32| {
        let t = f64::from(n) * 1e-3;
        all_axes(libm::sin(2.0 * PI * 2.0 * t) + 0.03 * libm::sin(2.0 * PI * 36.0 * t))
    };
    for n in 0..2000 {
        filter.step(sample(n));
    }
    let other = FilterParameters {
        cutoff: 60.0,
        notch_width: 12.0,
        notch_least: 25.0,
        ..Default::default()
    };
    let off = FilterParameters {
        notches: 0.0,
        ..Default::default()
    };
    for new in [other, off] {
        let (mut same, mut retuned) = (filter.clone(), filter.clone());
        retuned.retune(&new, &OS4, 1000.0);
        same.step(sample(2000));
        retuned.step(sample(2000));
        let jump = (same.rate().x - retuned.rate().x).abs();
        assert!(jump < 0.01, "{jump} rad/s");
    }
}
