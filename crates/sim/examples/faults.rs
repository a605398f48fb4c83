use std::path::Path;
use windhover_autopilot::*;
use windhover_math::Quaternion;
use windhover_model::sensor::fault::SensorFault;
use windhover_model::{Truth, Vehicle};
use windhover_sim::closed_loop::Recorder;
use windhover_sim::flight::{self, Setup};
use windhover_sim::mission_file;
use windhover_sim::sensors::Sensors;
struct R {
    tilt: f64,
    head: f64,
    since: f64,
    est: f64,
    dv: f64,
    last: Option<windhover_math::Vector3>,
    when: f64,
}
impl Recorder for R {
    fn tick(&mut self, _: &Truth, _: &InnerInput, _: MotorCommand, _: Option<ScheduleRecord>) {}
    fn outer(&mut self, t: &Truth, _: &Snapshot, r: &OuterResult) {
        if t.time < self.since || r.report.trajectory.is_none() {
            return;
        }
        let q = r.report.estimate.attitude;
        let b = Quaternion::new(q.w as f64, q.x as f64, q.y as f64, q.z as f64);
        let d = (b * t.attitude.conjugate()).shortest();
        let tilt = 2.0 * (d.x * d.x + d.y * d.y).sqrt().asin().to_degrees();
        if tilt > self.tilt {
            self.tilt = tilt;
            self.when = t.time;
        }
        self.head = self.head.max(2.0 * d.z.abs().asin().to_degrees());
        let e = r.report.estimate.position.map(f64::from) - t.position;
        self.est = self.est.max((e.x * e.x + e.y * e.y).sqrt());
    }
}
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let seeds: u64 = args[0].parse().unwrap();
    let at: f64 = args[1].parse().unwrap();
    let dur: f64 = args[2].parse().unwrap();
    let vehicle = Vehicle::named("os4").unwrap();
    let mission = mission_file::read(Path::new("missions/monitoring.plan")).unwrap();
    for name in SensorFault::all() {
        if name.name.starts_with("rc") || name.name.starts_with("battery") {
            continue;
        }
        if args.len() > 3 && !args[3..].iter().any(|a| name.name.contains(a.as_str())) {
            continue;
        }
        let (mut done, mut tilt, mut head, mut est) = (0, 0f64, 0f64, 0f64);
        let mut ends = std::collections::BTreeMap::new();
        for seed in 1..=seeds {
            let mut setup = Setup::reference(vehicle.clone());
            setup.conditions.seed = seed;
            setup.sensors = Some(Sensors {
                faults: vec![format!("{}@{at},{dur}", name.name).parse().unwrap()],
                ..Default::default()
            });
            let mut r = R {
                tilt: 0.0,
                head: 0.0,
                since: at,
                est: 0.0,
                dv: 0.0,
                last: None,
                when: 0.0,
            };
            let f = flight::fly(&setup, &mission, &mut r, &mut |_| {})
                .unwrap()
                .figures;
            done += f.completed as u32;
            if !f.completed {
                *ends.entry(f.ended.clone()).or_insert(0) += 1;
            }
            tilt = tilt.max(r.tilt);
            head = head.max(r.head);
            est = est.max(r.est);
        }
        println!(
            "{:20} completed {done}/{seeds} worst tilt err {tilt:.2} head {head:.2} pos {est:.2} {:?}",
            name.name,
            ends.iter().take(2).collect::<Vec<_>>()
        );
    }
}
