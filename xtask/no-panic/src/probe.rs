//! What the linker sees around the steps: an entry that calls them, and the panic handler.

// Linking is the purpose here: a name for the entry, and a symbol that does not exist.
#![allow(unsafe_code)]

use core::hint::black_box;
use core::panic::PanicInfo;

use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::mode::Guidance;
use windhover_autopilot::{
    BarometerSample, BatterySample, Command, CompassSample, ExternalEstimate, GnssSample, Imu, ImuCounts,
    Inner, InnerConfig, InnerInput, Mailboxes, Outer, OuterConfig, ParameterWrite, Parameters, Queues,
    RcFrame, Station, Sticks,
};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
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

/// Something into every queue. Behind a black box each stands for all that its type can hold: the
/// command for all commands, with all modes and kinds of plans.
fn feed(queues: &mut Queues) {
    queues.command.push(black_box(Command::Arm));
    queues
        .parameter
        .push(black_box(ParameterWrite { index: 0, value: 0.0 }));
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
    queues
        .setpoint
        .push(black_box(TrajectorySetpoint::at_rest(Vector3::zeros(), 0.0)));
    queues.attitude.push(black_box(AttitudeSetpoint::default()));
    queues.guidance.push(black_box(Guidance::default()));
    queues.rc.push(black_box(RcFrame::default()));
    queues.sticks.push(black_box(Sticks::default()));
    queues.battery.push(black_box(BatterySample::default()));
    queues.station.push(black_box(Station::default()));
}

unsafe extern "C" {
    /// Defined nowhere: the linker names it when a step can panic.
    safe fn windhover_step_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    windhover_step_can_panic()
}
