//! scratch
use std::sync::Arc;
use windhover_hil::elf::Elf;
use windhover_hil::flight::{self, Plan};
use windhover_hil::time::SECOND;
use windhover_model::Vehicle;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let elf = Arc::new(Elf::load(std::path::Path::new(&a[1])).unwrap());
    let s: f64 = a.get(2).map_or(10.0, |x| x.parse().unwrap());
    let rig = windhover_hil::rig::Setup {
        faults: a[3..].iter().map(|f| f.parse().unwrap()).collect(),
        ..Default::default()
    };
    let plan = Plan {
        vehicle: Vehicle::named("os4").unwrap(),
        conditions: Default::default(),
        rig,
        seconds: s,
    };
    let mut m = flight::machine(elf, &plan).unwrap();
    let t = std::time::Instant::now();
    let r = flight::fly(&mut m, &plan, |_| {});
    println!("{r:?}");
    let w = t.elapsed().as_secs_f64();
    let v = m.now() as f64 / SECOND as f64;
    println!(
        "{v} s virtual in {w} s: {:.2} x, {} instructions",
        v / w,
        m.instructions()
    );
    for r in m.resets().iter().take(3) {
        println!("reset {:?}", r.cause);
    }
    for l in m.lockups() {
        println!("lockup {l:?}");
    }
    let total = m.load().total() as f64;
    println!("asleep {:.3}", m.load().asleep as f64 / total);
    for n in 0..110 {
        let x = m.load().exception(n) as f64 / total;
        if x > 1e-4 {
            println!("exception {n}: {x:.4}");
        }
    }
    let b = m.bus();
    println!("misuse {:?}", b.wiring.imu_misuse());
    std::fs::write("/tmp/boot.ulg", b.wiring.log()).unwrap();
    let bytes = b.wiring.log().to_vec();
    match windhover_flight_log::reader::Log::open(&bytes) {
        Ok(log) => println!("{:?}", windhover_sim::replay::replay(&log)),
        Err(e) => println!("{e}"),
    }
}
