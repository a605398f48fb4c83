//! The journal on a model of NOR flash.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use sequential_storage::cache::Cache;
use sequential_storage::map::{MapConfig, MapStorage};
use windhover_autopilot::Parameters;
use windhover_storage::{Loaded, ParameterStore, StoreError};

const SECTOR: usize = 16 * 1024;
const SECTORS: usize = 3;

/// Three sectors of 16 KiB whose bits can only be cleared, but by erasing. Power can fail before
/// any write or erasure.
#[derive(Clone)]
struct Nor {
    bytes: Vec<u8>,
    /// Operations until the power fails.
    power: Option<usize>,
    operations: usize,
}

#[derive(Debug, PartialEq, Eq)]
struct PowerCut;

impl NorFlashError for PowerCut {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Nor {
    fn blank() -> Self {
        Self {
            bytes: vec![0xff; SECTORS * SECTOR],
            power: None,
            operations: 0,
        }
    }

    fn operate(&mut self) -> Result<(), PowerCut> {
        if self.power == Some(self.operations) {
            return Err(PowerCut);
        }
        self.operations += 1;
        Ok(())
    }
}

impl ErrorType for &mut Nor {
    type Error = PowerCut;
}

impl ReadNorFlash for &mut Nor {
    const READ_SIZE: usize = 1;
    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerCut> {
        let offset = offset as usize;
        bytes.copy_from_slice(&self.bytes[offset..offset + bytes.len()]);
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for &mut Nor {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerCut> {
        self.operate()?;
        self.bytes[from as usize..to as usize].fill(0xff);
        Ok(())
    }
    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerCut> {
        for (n, word) in bytes.chunks(4).enumerate() {
            self.operate()?;
            for (m, byte) in word.iter().enumerate() {
                let place = &mut self.bytes[offset as usize + 4 * n + m];
                assert!(*place == 0xff || *byte == *place, "a word is written twice");
                *place &= byte;
            }
        }
        Ok(())
    }
}

fn store(nor: &mut Nor) -> ParameterStore<&mut Nor> {
    ParameterStore::new(nor, 0..(SECTORS * SECTOR) as u32).expect("three whole sectors")
}

fn load(nor: &mut Nor) -> (Parameters, Loaded) {
    let mut parameters = Parameters::default();
    let loaded = block_on(store(nor).load(&mut parameters));
    (parameters, loaded)
}

fn index(name: &str) -> usize {
    Parameters::find(name).expect("a parameter of this name")
}

#[test]
fn blank_flash_is_all_defaults_and_not_corrupt() {
    assert_eq!(
        load(&mut Nor::blank()),
        (Parameters::default(), Loaded::default())
    );
}

#[test]
fn what_was_stored_is_there_after_a_restart() {
    let mut nor = Nor::blank();
    let rate = index("IMU_GYRO_RATEMAX");
    for value in [2000.0, 4000.0] {
        block_on(store(&mut nor).save(rate, value)).unwrap();
    }
    let (parameters, loaded) = load(&mut nor);
    assert_eq!(parameters.get(rate), Some(4000.0));
    assert_eq!(
        loaded,
        Loaded {
            set: 1,
            ..Default::default()
        }
    );
}

/// Far more writes than the flash has room for.
#[test]
fn sectors_are_used_in_turn() {
    let mut nor = Nor::blank();
    let (rate, idle) = (index("IMU_GYRO_RATEMAX"), index("MOT_IDLE"));
    block_on(store(&mut nor).save(idle, 0.1)).unwrap();
    for n in 0..3000u16 {
        block_on(store(&mut nor).save(rate, 1000.0 + f32::from(n))).unwrap();
    }
    let (parameters, loaded) = load(&mut nor);
    assert_eq!(
        (parameters.get(rate), parameters.get(idle)),
        (Some(3999.0), Some(0.1))
    );
    assert_eq!((loaded.set, loaded.refused, loaded.corrupt), (2, 0, false));
}

/// As a firmware did that took other values.
fn save_unchecked(nor: &mut Nor, name: &[u8; 16], value: f32) {
    let range = 0..(SECTORS * SECTOR) as u32;
    let config = MapConfig::try_new(range).expect("three whole sectors");
    let mut journal = MapStorage::<[u8; 16], _, _>::new(nor, config, Cache::new_uncached());
    block_on(journal.store_item(&mut [0; 64], name, &value)).expect("there is room");
}

#[test]
fn a_stored_value_that_is_refused_leaves_the_default() {
    let mut nor = Nor::blank();
    for bad in [f32::NAN, 1e9, -1.0] {
        save_unchecked(&mut nor, b"IMU_GYRO_RATEMAX", bad);
        let (parameters, loaded) = load(&mut nor);
        assert_eq!(parameters, Parameters::default());
        assert_eq!((loaded.set, loaded.refused), (0, 1));
    }
}

#[test]
fn what_would_be_refused_at_each_start_is_not_stored() {
    let mut nor = Nor::blank();
    let rate = index("IMU_GYRO_RATEMAX");
    block_on(store(&mut nor).save(rate, 4000.0)).unwrap();
    for bad in [f32::NAN, 1e9, -1.0] {
        let refused = block_on(store(&mut nor).save(rate, bad));
        assert_eq!(refused, Err(StoreError::Refused));
    }
    assert_eq!(load(&mut nor).0.board.imu_rate(), 4000);
    assert_eq!(
        block_on(store(&mut nor).save(Parameters::COUNT, 0.0)),
        Err(StoreError::Unknown)
    );
}

/// Power fails before every single operation of a write: the next start has the old value or the
/// new one, and nothing else changed.
#[test]
fn a_power_cut_loses_at_most_the_write_under_way() {
    let (rate, idle) = (index("IMU_GYRO_RATEMAX"), index("MOT_IDLE"));
    let mut full = Nor::blank();
    block_on(store(&mut full).save(idle, 0.1)).unwrap();
    for n in 0..1500u16 {
        block_on(store(&mut full).save(rate, 1000.0 + f32::from(n))).unwrap();
    }
    let mut cuts = 0;
    for start in 0..20 {
        let mut before = full.clone();
        for n in 0..start * 13 {
            block_on(store(&mut before).save(rate, 3000.0 + n as f32)).unwrap();
        }
        let (old, _) = load(&mut before.clone());
        for operation in 0.. {
            let mut nor = before.clone();
            nor.power = Some(nor.operations + operation);
            let outcome = block_on(store(&mut nor).save(rate, 2500.0));
            nor.power = None;
            let (after, _) = load(&mut nor);
            let value = after.get(rate);
            assert!(
                value == old.get(rate) || value == Some(2500.0),
                "{value:?} at {operation}"
            );
            assert_eq!(after.get(idle), Some(0.1), "at {operation}");
            if outcome.is_ok() {
                break;
            }
            cuts += 1;
        }
    }
    assert!(cuts > 100, "{cuts} cuts");
}
