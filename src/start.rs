//! What the core starts with: parameters from flash, or defaults.

use embassy_futures::block_on;
use windhover_autopilot::{Outer, OuterConfig, ParameterWrite, Parameters};
use windhover_storage::ParameterStore;

use crate::board::{STORED, Storage};
use crate::fault;

/// The outer step with the parameters that are stored; where some are damaged, one that does not
/// arm of itself. Where there is one to `store`, it does that and starts anew. Nothing waits for
/// time or interrupts yet, so flash may keep the processor.
pub fn outer(storage: Storage, store: Option<ParameterWrite>, config: &OuterConfig) -> Outer {
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
    if loaded.refused > 0 || loaded.corrupt {
        defmt::error!(
            "{=u32} stored parameters are refused, the journal is damaged: {=bool}",
            loaded.refused,
            loaded.corrupt
        );
    }
    match Outer::new(parameters, config) {
        Some(outer) if loaded.refused == 0 && !loaded.corrupt => outer,
        Some(outer) => outer.with_damaged_storage(),
        None => {
            defmt::error!("the stored parameters describe no vehicle that flies: all are at their defaults");
            Outer::new(Parameters::default(), config)
                .expect("the default parameters describe a vehicle that flies")
                .with_damaged_storage()
        }
    }
}
