//! An entry that calls all of it, and the panic handler.

// Linking is the purpose here: a name for the entry, and a symbol that does not exist.
#![allow(unsafe_code)]

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use windhover_autopilot::mission::PlanMemory;
use windhover_autopilot::{Imu, ImuCounts, MotorCommand, OuterInputs, OuterResult, Parameters, Snapshot};
use windhover_ground_link::{Config, Link};
use windhover_vehicle_link::{Fitting, Told, VehicleLink};

static mut LINK: MaybeUninit<[Link; 1]> = MaybeUninit::uninit();
static mut VEHICLE: MaybeUninit<VehicleLink> = MaybeUninit::uninit();
static mut PLANS: PlanMemory = PlanMemory::new();
static mut TOLD: MaybeUninit<Told> = MaybeUninit::uninit();

/// The entry: for ever, on inputs that the optimiser knows nothing about.
#[unsafe(no_mangle)]
extern "C" fn reset() -> ! {
    let (links, vehicle, plans, told) = (&raw mut LINK, &raw mut VEHICLE, &raw mut PLANS, &raw mut TOLD);
    // SAFETY: this is the only place that names them, and it is entered once.
    let (links, vehicle, plans, told) = unsafe { (&mut *links, &mut *vehicle, &mut *plans, &mut *told) };
    let links = links.write([Link::new(black_box(Config::default()))]);
    let parameters = black_box(Parameters::default());
    let vehicle = vehicle.write(VehicleLink::new(
        &parameters,
        Fitting::default(),
        Default::default(),
    ));
    vehicle.set_trouble(black_box("panic"));
    let mut told = told.write(Told::default());
    let bytes = [0; 64];
    let mut taken = Told::default();
    let mut taken = &mut taken;
    loop {
        let now = black_box(0);
        told_outer(
            told,
            black_box(&SNAPSHOT.get()),
            black_box(&OuterResult::default()),
        );
        vehicle_receive(
            vehicle,
            black_box(links),
            black_box(&bytes),
            now,
            black_box(plans),
        );
        black_box(vehicle_step(
            vehicle,
            black_box(links),
            black_box(&mut told),
            black_box(&mut taken),
            now,
        ));
        vehicle_poll(vehicle, black_box(links), now, black_box(plans));
    }
}

struct Nowhere;

impl Nowhere {
    fn get(&self) -> Snapshot {
        Snapshot {
            tick: 0,
            time: 0,
            increments: Default::default(),
            stopped: None,
            inputs: OuterInputs::default(),
        }
    }
}

const SNAPSHOT: Nowhere = Nowhere;

/// What the loops tell.
#[inline(never)]
#[unsafe(no_mangle)]
fn told_outer(told: &mut Told, snapshot: &Snapshot, result: &OuterResult) {
    told.outer(snapshot, result);
    let imu = Imu::Sample {
        counts: ImuCounts::default(),
        time: 0,
    };
    told.tick(
        black_box(&imu),
        black_box(MotorCommand::Disarmed),
        black_box(None),
    );
}

/// Bytes that have come.
#[inline(never)]
#[unsafe(no_mangle)]
fn vehicle_receive(
    vehicle: &mut VehicleLink,
    links: &mut [Link; 1],
    bytes: &[u8],
    now: u64,
    plans: &mut PlanMemory,
) {
    #[cfg(feature = "prove-it-fails")]
    let _ = black_box(bytes.first()).unwrap();
    let [link] = links;
    vehicle.receive(link, bytes, now, plans);
}

/// Everything between core and links.
#[inline(never)]
#[unsafe(no_mangle)]
fn vehicle_step<'a>(
    vehicle: &mut VehicleLink,
    links: &mut [Link; 1],
    told: &mut &'a mut Told,
    taken: &mut &'a mut Told,
    now: u64,
) -> OuterInputs {
    Told::take(told, taken);
    vehicle.step(links, taken, now, &mut |severity, text| {
        black_box((severity, text));
    });
    black_box(vehicle.take_urgent());
    black_box(vehicle.take_effects());
    vehicle.set_load(black_box(0.5));
    vehicle.take_inputs()
}

/// Frames that are to be sent.
#[inline(never)]
#[unsafe(no_mangle)]
fn vehicle_poll(vehicle: &mut VehicleLink, links: &mut [Link; 1], now: u64, plans: &mut PlanMemory) {
    let [link] = links;
    vehicle.poll(link, now, plans, &mut |frame| {
        black_box(frame);
    });
}

unsafe extern "C" {
    /// Defined nowhere: the linker names it when something here can panic.
    safe fn windhover_step_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    windhover_step_can_panic()
}
