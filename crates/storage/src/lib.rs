//! Parameters that outlast power: a journal in flash, by the crate `sequential-storage`.
//!
//! A parameter is stored under its name, so that a firmware with other indices finds it again.
//! What is stored passes the same check as any other write: a value that this firmware refuses
//! leaves the default, and is counted.
#![no_std]

use core::ops::Range;

use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use windhover_autopilot::Parameters;

/// Longest name of a parameter, as MAVLink has it.
const NAME: usize = 16;

/// Room for one item while it is read or written.
const ITEM: usize = 64;

type Key = [u8; NAME];

/// What [`ParameterStore::load`] found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loaded {
    /// Parameters that were set.
    pub set: u32,
    /// Parameters whose stored value is refused; they keep their default.
    pub refused: u32,
    /// The journal could not be read to its end.
    pub corrupt: bool,
}

/// A value that was not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// There is no such parameter.
    Unknown,
    /// The parameter does not take this value: stored, it would be refused at each start.
    Refused,
    /// The flash or its journal refuses.
    Flash,
}

/// The journal of parameters in one range of a flash.
pub struct ParameterStore<F: NorFlash> {
    journal: MapStorage<Key, F, Cache<Uncached, Uncached, Uncached, Key>>,
}

impl<F: NorFlash> ParameterStore<F> {
    /// In `range` of the flash, in bytes from its start: at least two whole sectors. `None` if it
    /// is not that.
    pub fn new(flash: F, range: Range<u32>) -> Option<Self> {
        let config = MapConfig::try_new(range).ok()?;
        Some(Self {
            journal: MapStorage::new(flash, config, Cache::new_uncached()),
        })
    }

    /// Sets every parameter that is stored. Blank flash holds none, and is not corrupt.
    pub async fn load(&mut self, parameters: &mut Parameters) -> Loaded {
        let mut loaded = Loaded::default();
        let mut buffer = [0; ITEM];
        for (index, declaration) in Parameters::declarations().enumerate() {
            let Some(key) = key(declaration.name) else {
                continue;
            };
            match self.journal.fetch_item::<f32>(&mut buffer, &key).await {
                Ok(None) => {}
                Ok(Some(value)) => match parameters.set(index, value) {
                    Ok(()) => loaded.set += 1,
                    Err(_) => loaded.refused += 1,
                },
                Err(_) => loaded.corrupt = true,
            }
        }
        loaded
    }

    /// Stores one parameter. It may erase a sector, for which a microcontroller that runs from
    /// the same flash stands still up to a second: never call it while motors may turn.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub async fn save(&mut self, index: usize, value: f32) -> Result<(), StoreError> {
        let declaration = Parameters::declaration(index).ok_or(StoreError::Unknown)?;
        declaration.check(value).map_err(|_| StoreError::Refused)?;
        let key = key(declaration.name).ok_or(StoreError::Unknown)?;
        let mut buffer = [0; ITEM];
        self.journal
            .store_item(&mut buffer, &key, &value)
            .await
            .map_err(|_| StoreError::Flash)
    }
}

/// A name, filled up with zeros.
fn key(name: &str) -> Option<Key> {
    let mut key = [0; NAME];
    key.get_mut(..name.len())?.copy_from_slice(name.as_bytes());
    Some(key)
}
