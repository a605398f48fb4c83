use std::path::Path;
use windhover_model::Vehicle;
use windhover_model::sensor::suite::SensorErrors;
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file;
use windhover_sim::sensors::{Receiver, Sensors};
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let seeds: u64 = args[0].parse().unwrap();
    let vehicle = Vehicle::named("os4").unwrap();
    let mission = mission_file::read(Path::new("missions/monitoring.plan")).unwrap();
    for what in &args[1..] {
        let mut all = vec![];
        for seed in 1..=seeds {
            let mut setup = Setup::reference(vehicle.clone());
            setup.conditions.seed = seed;
            let mut e = SensorErrors::reference(1000.0, vehicle.plant.hover_speed());
            let ideal = SensorErrors::ideal();
            let mut receiver = Receiver::Standard;
            for w in what.split('+') {
                match w {
                    "full" => {}
                    "rtk" => {
                        receiver = Receiver::Rtk;
                        e.gnss = windhover_model::sensor::gnss::GnssErrors::rtk();
                    }
                    "ideal" => {
                        e = SensorErrors {
                            gnss: e.gnss,
                            ..ideal
                        }
                    }
                    "novib" => {
                        e.inertial.accel.vibration = 0.0;
                        e.inertial.gyro.vibration = 0.0;
                    }
                    "noavib" => {
                        e.inertial.accel.vibration = 0.0;
                    }
                    "nogvib" => {
                        e.inertial.gyro.vibration = 0.0;
                    }
                    "nocompass" => e.compass = ideal.compass,
                    "nobaro" => e.barometer = ideal.barometer,
                    "nognss" => e.gnss = ideal.gnss,
                    "nocal" => {
                        for t in [&mut e.inertial.accel, &mut e.inertial.gyro] {
                            t.bias = 0.0;
                            t.walk = 0.0;
                            t.scale = 0.0;
                            t.misalignment = 0.0;
                            t.per_kelvin = 0.0;
                        }
                    }
                    "nobias" => e.inertial.accel.bias = 0.0,
                    "nomis" => e.inertial.accel.misalignment = 0.0,
                    "noscale" => e.inertial.accel.scale = 0.0,
                    "nokelvin" => { e.inertial.accel.per_kelvin = 0.0; e.inertial.gyro.per_kelvin = 0.0; }
                    "nogbias" => { e.inertial.gyro.bias = 0.0; }
                    "noaa" => {
                        for t in [&mut e.inertial.accel, &mut e.inertial.gyro] {
                            t.bandwidth = None;
                        }
                    }
                    "nodens" => {
                        for t in [&mut e.inertial.accel, &mut e.inertial.gyro] {
                            t.density = [0.0; 3];
                        }
                    }
                    p if p.contains('=') => {
                        let (n, v) = p.split_once('=').unwrap();
                        setup.vehicle.parameters.insert(n.into(), v.parse().unwrap());
                    }
                    "idealgyro" => e.inertial.gyro = ideal.inertial.gyro,
                    "idealaccel" => e.inertial.accel = ideal.inertial.accel,
                    _ => panic!("{w}"),
                }
            }
            setup.sensors = Some(Sensors {
                receiver,
                errors: Some(e),
                ..Default::default()
            });
            let f = flight::fly(&setup, &mission, &mut (), &mut |_| {})
                .unwrap()
                .figures;
            all.push(f);
        }
        let mut print = |name: &str, get: &dyn Fn(&windhover_sim::figures::Figures) -> f64| {
            let mut v: Vec<f64> = all.iter().map(get).collect();
            v.sort_by(f64::total_cmp);
            let n = v.len();
            println!(
                "  {name:12} median {:.3} p95 {:.3} max {:.3} rms {:.3}",
                v[n / 2],
                v[(n * 95 / 100).min(n - 1)],
                v[n - 1],
                (v.iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt()
            );
        };
        println!("{what}: completed {}", all.iter().filter(|f| f.completed).count());
        for f in all.iter().filter(|f| !f.completed) {
            println!("   seed {} {}", f.seed, f.ended);
        }
        print("tilt err", &|f| f.attitude_rmse_deg.unwrap_or(f64::NAN));
        print("heading err", &|f| f.heading_rmse_deg.unwrap_or(f64::NAN));
        print("down", &|f| f.rmse_m.down);
        print("horizontal", &|f| f.rmse_m.horizontal());
        print("gnss", &|f| f.gnss_rmse_m.map_or(f64::NAN, |g| g.horizontal()));
        print("over gnss", &|f| {
            f.rmse_m.horizontal() - f.gnss_rmse_m.map_or(f64::NAN, |g| g.horizontal())
        });
        print("photo", &|f| {
            f.photos.iter().map(|p| p.position_error_m).fold(0.0, f64::max)
        });
        print("photo tilt", &|f| {
            f.photos.iter().map(|p| p.tilt_deg).fold(0.0, f64::max)
        });
    }
}
