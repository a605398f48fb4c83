//! What the linker sees around the steps: an entry that calls them, and the panic handler.

// Linking is the purpose here: a name for the entry, and a symbol that does not exist.
#![allow(unsafe_code)]

use core::hint::black_box;
use core::panic::PanicInfo;

use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::{
    BarometerSample, Command, CompassSample, ExternalEstimate, GnssSample, Imu, ImuCounts, Inner,
    InnerConfig, InnerInput, Mailboxes, Outer, OuterConfig, Parameters, Queues,
};
use windhover_flight_log::{Logger, LoggerConfig};
use windhover_math::{Quaternion, Vector3};

use crate::steps::{LOG, Storage, inner_step, log_outer, log_tick, outer_step};

/// The entry: all steps for ever, on inputs that the optimiser knows nothing about.
#[unsafe(no_mangle)]
extern "C" fn reset() -> ! {
    let outer_config = black_box(OuterConfig::default());
    let items = black_box([ITEM; 4]);
    let config = InnerConfig {
        imu_rate: black_box(1000),
        rotation: Default::default(),
    };
    if let Some(mut outer) = Outer::new(black_box(Parameters::default()), &outer_config) {
        let mut inner = Inner::new(config, outer.inner_parameters());
        let mut mailboxes = Mailboxes::default();
        let mut logger = Logger::<LOG>::new(LoggerConfig::new(config, outer.parameters()));
        let mut out = [0; 64];
        loop {
            feed(&mut mailboxes.queues);
            let input = input();
            let output = inner_step(black_box(&mut inner), &input, black_box(&mut mailboxes));
            log_tick(black_box(&mut logger), &input, black_box(&output));
            if let Some(snapshot) = mailboxes.snapshot.take() {
                let result = outer_step(black_box(&mut outer), &snapshot, &Storage(black_box(&items)));
                black_box(log_outer(
                    black_box(&mut logger),
                    &snapshot,
                    &result,
                    black_box(&mut out),
                ));
                mailboxes.result = black_box(Some(result));
            }
        }
    }
    loop {
        core::hint::spin_loop();
    }
}

const ITEM: MissionItem = MissionItem {
    command: 16,
    frame: 3,
    autocontinue: true,
    params: [0.0; 4],
    x: 0,
    y: 0,
    z: 10.0,
};

fn input() -> InnerInput {
    let imu = Imu::Sample {
        counts: black_box(ImuCounts::default()),
        time: black_box(0),
    };
    black_box(InnerInput { imu, urgent: None })
}

fn feed(queues: &mut Queues) {
    queues.command.push(black_box(Command::Arm));
    queues.barometer.push(black_box(BarometerSample {
        time: 0,
        pressure: 1e5,
    }));
    queues.compass.push(black_box(CompassSample {
        time: 0,
        counts: [0; 3],
    }));
    queues.gnss.push(black_box(GnssSample::default()));
    queues.external.push(black_box(ExternalEstimate {
        position: Vector3::zeros(),
        velocity: Vector3::zeros(),
        attitude: Quaternion::IDENTITY,
    }));
}

unsafe extern "C" {
    /// Defined nowhere: the linker names it when a step can panic.
    safe fn windhover_step_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    windhover_step_can_panic()
}
