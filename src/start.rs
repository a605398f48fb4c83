//! What the core starts with: parameters from flash, or defaults; and where it is kept.

use embassy_futures::block_on;
use embassy_time::Instant;
use static_cell::{ConstStaticCell, StaticCell};
use windhover_autopilot::{Inner, InnerConfig, Outer, OuterConfig, ParameterWrite, Parameters};
use windhover_flight_log::{Logger, LoggerConfig};
use windhover_storage::ParameterStore;
use windhover_vehicle_link::Fitting;

use crate::board::{self, STORED, Storage};
use crate::fault::{self, Cause};
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
}

/// Makes the core; its log begins. A function of its own: what is made goes over the stack, of which
/// `main` never gives back anything.
#[inline(never)]
pub fn core(storage: Storage, store: Option<ParameterWrite>, cause: Cause) -> Core {
    static OUTER: StaticCell<Outer> = StaticCell::new();
    static LOG: StaticCell<shared::FlightLog> = StaticCell::new();
    static LOG_STORAGE: ConstStaticCell<[u8; shared::LOG_BYTES]> = ConstStaticCell::new([0; _]);
    static START: StaticCell<task::Start> = StaticCell::new();
    static GROUND: StaticCell<task::Ground> = StaticCell::new();

    let outer_config = OuterConfig::default();
    let (parameters, damaged) = load(storage, store);
    let outer = OUTER.init_with(|| outer(&parameters, damaged, &outer_config));
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
        cause,
    });
    let fitting = Fitting {
        rotation: board::ROTATION,
        compass: outer_config.compass,
    };
    Core {
        ground: GROUND.init_with(|| task::Ground::new(&parameters, fitting)),
        outer,
        inner,
        config,
        logging,
        start,
    }
}

/// The stored parameters, and whether some are damaged. Where there is one to `store`, does that and
/// starts anew. Nothing waits for time or interrupts yet, so flash may keep the processor.
#[inline(never)]
fn load(storage: Storage, store: Option<ParameterWrite>) -> (Parameters, bool) {
    let mut journal = ParameterStore::new(storage, STORED).expect("whole sectors");
    if let Some(write) = store {
        match block_on(journal.save(usize::from(write.index), write.value)) {
            Ok(()) => defmt::info!("parameter {=u16} is stored", write.index),
            Err(_) => defmt::error!("parameter {=u16} could not be stored", write.index),
        }
        fault::restart();
    }
    let mut parameters = Parameters::default();
    let loaded = block_on(journal.load(&mut parameters));
    defmt::info!("{=u32} parameters from flash", loaded.set);
    let damaged = loaded.refused > 0 || loaded.corrupt;
    if damaged {
        defmt::error!(
            "{=u32} stored parameters are refused, the journal is damaged: {=bool}",
            loaded.refused,
            loaded.corrupt
        );
    }
    (parameters, damaged)
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
