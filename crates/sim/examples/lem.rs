use windhover_math::Vector3;
use windhover_model::Vehicle;
use windhover_sim::{flight::Setup, lemniscate::Lemniscate};
fn main() {
    let mut s = Setup::reference(Vehicle::named("x450").unwrap());
    for a in std::env::args().skip(1) {
        let (n, v) = a.split_once('=').unwrap();
        s.vehicle.parameters.insert(n.into(), v.parse().unwrap());
    }
    for period in [16.0, 4.0] {
        for d in [
            Vector3::zeros(),
            Vector3::new(1.0, 0.0, 0.0),
            Vector3::new(0.0, 1.0, 0.0),
            Vector3::new(0.0, 0.0, 1.0),
            Vector3::new(0.577, 0.577, 0.577),
        ] {
            let f = Lemniscate {
                period,
                disturbance: d,
            }
            .fly(&s)
            .unwrap();
            println!(
                "{period} {:?} rmse {:.2} mm largest {:.2} mm",
                d.as_slice(),
                f.rmse * 1e3,
                f.largest * 1e3
            );
        }
    }
}
