//! What the core starts with: parameters from flash, or defaults; and where it is kept.

use embassy_futures::block_on;
use embassy_time::Instant;
use static_cell::{ConstStaticCell, StaticCell};
use windhover_autopilot::mission::PlanKind;
use windhover_autopilot::{Command, Inner, InnerConfig, MissionCommit, Outer, OuterConfig, Parameters};
use windhover_flight_log::{Logger, LoggerConfig};
use windhover_storage::{Journal, Keeper};
use windhover_vehicle_link::{Fitting, Told};

use crate::board::{self, STORED, Storage};
use crate::fault::LastRun;
use crate::shelf::Shelf;
use crate::{shared, task};

/// The core, and what is made with it.
pub struct Core {
    /// The outer step.
    pub outer: &'static mut Outer,
    /// The inner step.
    pub inner: Inner,
    /// What that was made with.
    pub config: InnerConfig,
    /// How it is logged.
    pub logging: LoggerConfig,
    /// What the log begins with.
    pub start: &'static task::Start,
    /// The ground link.
    pub ground: &'static mut task::Ground,
    /// What outlasts power.
    pub stored: &'static mut Stored,
}

/// What was found in flash, and who keeps it up to date.
pub struct Stored {
    /// Parameters, or their defaults.
    pub parameters: Parameters,
    /// The plans that lie on the shelf.
    pub plans: [MissionCommit; 3],
    damaged: bool,
    /// Where it is stored.
    pub journal: Journal<Storage>,
    /// What is to be stored next.
    pub keeper: Keeper,
}

/// Loads what is stored and makes the core; its log begins.
///
/// What is loaded and what is made goes over the stack, of which `main` never gives back anything:
/// functions of their own, one after the other and not one within the other.
#[inline(never)]
pub fn core(storage: Storage, last: LastRun) -> Core {
    static STORED_THERE: StaticCell<Stored> = StaticCell::new();
    let stored = STORED_THERE.init_with(|| load(storage));
    make(stored, last)
}

#[inline(never)]
fn make(stored: &'static mut Stored, last: LastRun) -> Core {
    static OUTER: StaticCell<Outer> = StaticCell::new();
    static LOG: StaticCell<shared::FlightLog> = StaticCell::new();
    static LOG_STORAGE: ConstStaticCell<[u8; shared::LOG_BYTES]> = ConstStaticCell::new([0; _]);
    static START: StaticCell<task::Start> = StaticCell::new();
    static GROUND: StaticCell<task::Ground> = StaticCell::new();
    static TOLD: [StaticCell<Told>; 2] = [const { StaticCell::new() }; 2];

    let outer_config = OuterConfig::default();
    let outer = OUTER.init_with(|| outer(stored, &outer_config));
    let parameters = *outer.parameters();
    let config = InnerConfig {
        imu_rate: parameters.board.imu_rate(),
        rotation: board::ROTATION,
    };
    let logging = LoggerConfig::new(config, &parameters);
    let inner = Inner::new(config, outer.inner_parameters());
    let log = LOG.init_with(|| Logger::in_storage(logging, LOG_STORAGE.take()));
    let [telling, told] = TOLD.each_ref().map(|place| place.init_with(Told::default));
    shared::begin(log, telling);
    let start = START.init_with(|| task::Start {
        time: Instant::now().as_micros(),
        inner: config,
        parameters,
        outer: outer_config,
        cause: last.cause,
        plans: stored.plans,
    });
    commit(&stored.plans);
    let fitting = Fitting {
        rotation: board::ROTATION,
        compass: outer_config.compass,
    };
    let ground = GROUND.init_with(|| task::Ground::new(&parameters, fitting, stored.plans, told));
    if last.is_trouble {
        ground.set_trouble(last.cause);
    }
    Core {
        ground,
        stored,
        outer,
        inner,
        config,
        logging,
        start,
    }
}

/// What is stored; plans go to the shelf. Nothing waits for time or interrupts yet, so flash may keep
/// the processor.
#[inline(never)]
fn load(storage: Storage) -> Stored {
    let mut journal = block_on(Journal::open(storage, STORED)).expect("whole sectors");
    let loaded = block_on(journal.load(&mut Shelf));
    defmt::info!("{=u16} parameters from flash", loaded.stored);
    let damaged = loaded.damage.is_any();
    if damaged {
        defmt::error!("{}", defmt::Display2Format(&loaded.damage));
    }
    Stored {
        parameters: loaded.parameters,
        plans: loaded.plans,
        damaged,
        keeper: Keeper::new(&loaded),
        journal,
    }
}

/// Stored plans are the valid ones from the first step on.
fn commit(plans: &[MissionCommit; 3]) {
    shared::with(|shared| {
        for (kind, plan) in PlanKind::EACH.into_iter().zip(plans) {
            if plan.count > 0 {
                let command = Command::Commit(kind, *plan);
                shared.mailboxes.queues.command.push(command);
            }
        }
    });
}

/// The outer step with these parameters; where some are damaged, one that does not arm of itself.
#[inline(never)]
fn outer(stored: &mut Stored, config: &OuterConfig) -> Outer {
    if let Some(outer) = Outer::new(stored.parameters, config) {
        return if stored.damaged {
            outer.with_damaged_storage()
        } else {
            outer
        };
    }
    defmt::error!("the stored parameters describe no vehicle that flies: all are at their defaults");
    stored.keeper.distrust();
    Outer::new(Parameters::default(), config)
        .expect("the default parameters describe a vehicle that flies")
        .with_damaged_storage()
}
