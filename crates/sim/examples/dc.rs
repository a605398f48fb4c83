use std::path::Path;
use windhover_autopilot::*;
use windhover_math::Vector3;
use windhover_model::sensor::suite::SensorErrors;
use windhover_model::{Truth, Vehicle};
use windhover_sim::closed_loop::Recorder;
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file;
use windhover_sim::sensors::Sensors;
struct R {
    n: u32,
    sum: Vector3<f64>,
    meas: Vector3<f64>,
    tr: Vector3<f64>,
    sp: [f64; 4],
    inc: Vector3<f64>,
    dur: f64,
    t: Vec<f64>,
}
impl Recorder for R {
    fn tick(&mut self, t: &Truth, i: &InnerInput, _: MotorCommand, _: Option<ScheduleRecord>) {
        if let Imu::Sample { counts, .. } = i.imu {
            let f = Vector3::new(
                counts.accel[0] as f64,
                counts.accel[1] as f64,
                counts.accel[2] as f64,
            ) * (9.80665 / 2048.0);
            self.sum += f - t.specific_force;
            self.meas += f;
            self.tr += t.specific_force;
            for k in 0..4 {
                self.sp[k] += t.rotor_speed[k];
            }
            self.n += 1;
            if self.n % 5000 == 0 {
                let d = self.sum / 5000.0;
                println!(
                    "{:.1} diff {:.3} {:.3} {:.3} rotor {:.1?} inc {:.3?}",
                    t.time,
                    d.x,
                    d.y,
                    d.z,
                    self.sp.map(|s| s / 5000.0 / 6.2832),
                    (self.inc / self.dur - self.tr / 5000.0).as_slice()
                );
                self.sum = Vector3::zeros();
                self.meas = Vector3::zeros();
                self.tr = Vector3::zeros();
                self.sp = [0.0; 4];
                self.inc = Vector3::zeros();
                self.dur = 0.0;
            }
        }
    }
    fn outer(&mut self, _: &Truth, s: &Snapshot, _: &OuterResult) {
        self.inc += s.increments.velocity.map(f64::from);
        self.dur += s.increments.duration as f64;
    }
}
fn main() {
    let vehicle = Vehicle::named("os4").unwrap();
    let mission = mission_file::read(Path::new("missions/monitoring.plan")).unwrap();
    let mut setup = Setup::reference(vehicle.clone());
    let ideal = SensorErrors::ideal();
    let mut e = SensorErrors::reference(1000.0, vehicle.plant.hover_speed());
    e.gnss = windhover_model::sensor::gnss::GnssErrors::rtk();
    let i = e.inertial;
    e = SensorErrors {
        gnss: e.gnss,
        ..ideal
    };
    e.inertial.accel.vibration = i.accel.vibration;
    e.inertial.vibration_speed = i.vibration_speed;
    setup.sensors = Some(Sensors {
        errors: Some(e),
        ..Default::default()
    });
    let f = flight::fly(
        &setup,
        &mission,
        &mut R {
            n: 0,
            sum: Vector3::zeros(),
            meas: Vector3::zeros(),
            tr: Vector3::zeros(),
            sp: [0.0; 4],
            inc: Vector3::zeros(),
            dur: 0.0,
            t: vec![],
        },
        &mut |_| {},
    )
    .unwrap()
    .figures;
    println!("{:?} {:?}", f.attitude_rmse_deg, f.completed);
}
