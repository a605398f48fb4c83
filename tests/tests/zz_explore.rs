use rayon::prelude::*;
use windhover_autopilot::Preset;
use windhover_model::sensor::inertial::InertialErrors;
use windhover_model::{Conditions, ModelKind};
use windhover_sim::flight::Setup;
use windhover_tests::shaken::*;
use windhover_tests::{setup, with_parameter};

fn one(s: &Setup, mismatch: f64) -> (f64, f64, f64, f64, f64) {
    let mut s = s.clone();
    if mismatch != 1.0 {
        let w = s.vehicle.plant.rotor_speed_max;
        // the core believes another top speed, k_f to match thrust
        let kf = s.vehicle.plant.k_f;
        let km = s.vehicle.plant.k_z;
        s = with_parameter(s, "ROTOR_SPEED_MAX", w * mismatch);
        s = with_parameter(s, "ROTOR_KF", kf / mismatch / mismatch);
        s = with_parameter(s, "ROTOR_KM", km / mismatch / mismatch);
    }
    let mut f = Shaken::new(&s, &Shaken::errors(&s));
    let hover = roughness(&f.fly(4.0));
    // tilting every 0.5 s
    let mut all = vec![];
    for n in 0..12 {
        f.steer(if n % 2 == 0 { 0.3 } else { -0.3 }, 1.05);
        all.extend(f.fly(0.5));
    }
    let moving = roughness(&all);
    let mut f = Shaken::new(&s, &InertialErrors::ideal());
    let quiet = roughness(&f.fly(4.0));
    let mut all = vec![];
    let mut g = f;
    g.steer(0.1745, 1.02);
    let over = overshoot(&g.fly(1.5), 0.1745);
    for n in 0..12 {
        g.steer(if n % 2 == 0 { 0.3 } else { -0.3 }, 1.05);
        all.extend(g.fly(0.5));
    }
    (
        hover * 1e4,
        moving * 1e4,
        quiet * 1e4,
        roughness(&all) * 1e4,
        over * 100.0,
    )
}

#[test]
fn explore() {
    let mut cases = vec![];
    for vehicle in ["os4", "x450"] {
        for rate in [1000, 4000] {
            for (cut, en, bw) in [
                (0.0, 0.0, 5.0),
                (40.0, 0.0, 5.0),
                (80.0, 0.0, 5.0),
                (120.0, 0.0, 5.0),
                (200.0, 0.0, 5.0),
                (0.0, 1.0, 2.0),
                (0.0, 1.0, 3.0),
                (0.0, 1.0, 5.0),
                (0.0, 1.0, 8.0),
                (0.0, 1.0, 15.0),
                (40.0, 1.0, 3.0),
                (80.0, 1.0, 3.0),
                (80.0, 1.0, 5.0),
                (120.0, 1.0, 3.0),
                (120.0, 1.0, 5.0),
                (120.0, 1.0, 8.0),
                (200.0, 1.0, 5.0),
            ] {
                for (mis, wind) in [(1.0, false), (1.0, true), (1.05, false)] {
                    if mis != 1.0 && (en == 0.0 || rate == 4000) {
                        continue;
                    }
                    cases.push((vehicle, rate, cut, en, bw, mis, wind));
                }
            }
        }
    }
    let lines: Vec<String> = cases.par_iter().map(|&(v, rate, cut, en, bw, mis, wind)| {
        let mut s = Setup { imu_rate: rate, conditions: if wind {Conditions::reference()} else {Conditions::default()}, ..setup(v, Preset::Windhover, ModelKind::Rigid) };
        s = with_parameter(s, "IMU_GYRO_CUTOFF", cut);
        s = with_parameter(s, "IMU_GYRO_DNF_EN", en);
        s = with_parameter(s, "IMU_GYRO_DNF_BW", bw);
        let (h, m, q, mq, o) = one(&s, mis);
        format!("{v:5} {rate} cut {cut:4} en {en} bw {bw:4} mis {mis} wind {wind:5}: hover {h:6.1} quiet {q:6.1} moving {m:6.1} quietmoving {mq:6.1} overshoot {o:.1}%")
    }).collect();
    for l in lines {
        println!("{l}");
    }
}
