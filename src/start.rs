//! What the core starts with: parameters from flash, or defaults; and where it is kept.

use embassy_futures::block_on;
use embassy_time::Instant;
use static_cell::{ConstStaticCell, StaticCell};
use windhover_autopilot::mission::PlanKind;
use windhover_autopilot::{
    Command, Inner, InnerConfig, MissionCommit, Outer, OuterConfig, ParameterWrite, Parameters,
};
use windhover_flight_log::{Logger, LoggerConfig};
use windhover_storage::{Journal, Keeper, Loaded, StoreError, View};
use windhover_vehicle_link::Fitting;

use crate::board::{self, STORED, Storage};
use crate::fault::{self, LastRun};
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

/// Loads what is stored and makes the core; its log begins. Where the last run left a parameter to be
/// stored, does that and starts anew instead.
///
/// What is loaded and what is made goes over the stack, of which `main` never gives back anything:
/// functions of their own, one after the other and not one within the other.
#[inline(never)]
pub fn core(storage: Storage, last: LastRun) -> Core {
    static STORED_THERE: StaticCell<Stored> = StaticCell::new();
    let stored = STORED_THERE.init_with(|| load(storage, last.store));
    make(stored, last)
}

#[inline(never)]
fn make(stored: &'static mut Stored, last: LastRun) -> Core {
    static OUTER: StaticCell<Outer> = StaticCell::new();
    static LOG: StaticCell<shared::FlightLog> = StaticCell::new();
    static LOG_STORAGE: ConstStaticCell<[u8; shared::LOG_BYTES]> = ConstStaticCell::new([0; _]);
    static START: StaticCell<task::Start> = StaticCell::new();
    static GROUND: StaticCell<task::Ground> = StaticCell::new();

    let outer_config = OuterConfig::default();
    let outer = OUTER.init_with(|| outer(&stored.parameters, stored.damaged, &outer_config));
    let parameters = *outer.parameters();
    let config = InnerConfig {
        imu_rate: parameters.board.imu_rate(),
        rotation: board::ROTATION,
    };
    let logging = LoggerConfig::new(config, &parameters);
    let inner = Inner::new(config, outer.inner_parameters());
    shared::begin(LOG.init_with(|| Logger::in_storage(logging, LOG_STORAGE.take())));
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
    let ground = GROUND.init_with(|| task::Ground::new(&parameters, fitting, stored.plans));
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

/// What is stored; plans go to the shelf. Where there is a parameter to `store`, does that and starts
/// anew. Nothing waits for time or interrupts yet, so flash may keep the processor.
#[inline(never)]
fn load(storage: Storage, store: Option<ParameterWrite>) -> Stored {
    let mut journal = block_on(Journal::open(storage, STORED)).expect("whole sectors");
    let loaded = block_on(journal.load(&mut Shelf));
    if let Some(write) = store {
        match save(&mut journal, &loaded, &write) {
            Ok(()) => defmt::info!("parameter {=u16} is stored", write.index),
            Err(_) => defmt::error!("parameter {=u16} could not be stored", write.index),
        }
        fault::restart();
    }
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
fn outer(parameters: &Parameters, damaged: bool, config: &OuterConfig) -> Outer {
    if let Some(outer) = Outer::new(*parameters, config) {
        return if damaged {
            outer.with_damaged_storage()
        } else {
            outer
        };
    }
    defmt::error!("the stored parameters describe no vehicle that flies: all are at their defaults");
    Outer::new(Parameters::default(), config)
        .expect("the default parameters describe a vehicle that flies")
        .with_damaged_storage()
}

/// Stores one parameter, and whatever a start before did not finish.
#[inline(never)]
fn save(journal: &mut Journal<Storage>, loaded: &Loaded, write: &ParameterWrite) -> Result<(), StoreError> {
    let mut keeper = Keeper::new(loaded);
    let mut parameters = loaded.parameters;
    // A value that is refused is not stored: it would be refused at each start.
    let _ = parameters.set(usize::from(write.index), write.value);
    keeper.hurry();
    let view = View {
        time: 0,
        armed: false,
        parameters: &parameters,
        plans: loaded.plans,
    };
    while let Some(task) = keeper.next(&view, &Shelf) {
        let outcome = block_on(journal.perform(&task));
        keeper.done(outcome);
    }
    keeper.given_up().map_or(Ok(()), Err)
}
