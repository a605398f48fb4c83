//! What the core was made with, from the header of a log.

use std::collections::BTreeMap;
use std::string::{String, ToString};

use thiserror::Error;
use windhover_autopilot::mission::{MissionItem, MissionSource};
use windhover_autopilot::sensing::BoardRotation;
use windhover_autopilot::{CompassFitting, InnerConfig, OuterConfig, Parameters};
use windhover_math::geodesy::GlobalPosition;

use super::log::Log;
use crate::batch::MAX_K;
use crate::crc::mission_crc;
use crate::header::LOG_VERSION;
use crate::plan::{PlanItem, PlanKind};

/// The most items that are kept in all slots together.
const MOST: usize = 4096;

/// What the core was made with.
#[derive(Clone, Debug, PartialEq)]
pub struct CoreSetup {
    /// For the inner step.
    pub inner: InnerConfig,
    /// Parameters as loaded, bit for bit.
    pub parameters: Parameters,
    /// For the outer step.
    pub outer: OuterConfig,
    /// The stored plans.
    pub plans: PlanStore,
}

/// Why a log does not say what the core was made with.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetupError {
    /// A value is not there, because the log is cut in its header or is not ours.
    #[error("the log does not say {0}")]
    Missing(&'static str),
    /// Another version of what we write into ULog's frame.
    #[error("the log is of version {0}; this program reads version {LOG_VERSION}")]
    Version(u32),
    /// Rate and period do not go together.
    #[error("the log has {imu_rate} samples a second and {k} in a period: not a rate of the core's")]
    Rate {
        /// Samples a second.
        imu_rate: u32,
        /// Samples in a period.
        k: u32,
    },
    /// A parameter of the core is not there.
    #[error("the log has no value of parameter {0}")]
    MissingParameter(&'static str),
    /// A parameter that this core does not have or accept.
    #[error("parameter {name} = {value}: {refusal}")]
    Parameter {
        /// Its name.
        name: String,
        /// Its value.
        value: f32,
        /// What is wrong with it.
        refusal: windhover_parameters::Refusal,
    },
    /// Items of the mission are not there.
    #[error("the log has {found} of {count} mission items")]
    MissionCut {
        /// Items found.
        found: u16,
        /// Items that there should be.
        count: u16,
    },
    /// The mission's CRC is another one.
    #[error("the mission's CRC is {found:#010x}, the log says {written:#010x}")]
    MissionCrc {
        /// Of the items found.
        found: u32,
        /// As the log says.
        written: u32,
    },
}

impl CoreSetup {
    /// From the header of a log.
    pub fn new(log: &Log<'_>) -> Result<Self, SetupError> {
        let version = required(log.value("log_version"), "log_version")?;
        if version != LOG_VERSION {
            return Err(SetupError::Version(version));
        }
        let inner = InnerConfig {
            imu_rate: required(log.value("imu_rate"), "imu_rate")?,
            rotation: rotation(log, "imu_rotation")?,
        };
        let k = required(log.value("imu_k"), "imu_k")?;
        if inner.k() != k || k as usize > MAX_K {
            let imu_rate = inner.imu_rate;
            return Err(SetupError::Rate { imu_rate, k });
        }
        Ok(Self {
            inner,
            parameters: parameters(log)?,
            outer: outer(log)?,
            plans: plans(log)?,
        })
    }
}

fn required<T>(value: Option<T>, name: &'static str) -> Result<T, SetupError> {
    value.ok_or(SetupError::Missing(name))
}

fn rotation(log: &Log<'_>, name: &'static str) -> Result<BoardRotation, SetupError> {
    let [a, b, c, d, e, f, g, h, i] = required(log.value::<[i8; 9]>(name), name)?;
    Ok(BoardRotation([[a, b, c], [d, e, f], [g, h, i]]))
}

fn outer(log: &Log<'_>) -> Result<OuterConfig, SetupError> {
    let home = GlobalPosition {
        latitude: required(log.value("home_lat"), "home_lat")?,
        longitude: required(log.value("home_lon"), "home_lon")?,
        altitude: required(log.value("home_alt"), "home_alt")?,
    };
    let known: u32 = required(log.value("home_known"), "home_known")?;
    Ok(OuterConfig {
        home: (known != 0).then_some(home),
        declination: log.value("declination"),
        compass: CompassFitting {
            per_count: required(log.value("mag_ut_per_count"), "mag_ut_per_count")?,
            rotation: rotation(log, "mag_rotation")?,
        },
    })
}

fn parameters(log: &Log<'_>) -> Result<Parameters, SetupError> {
    let mut parameters = Parameters::default();
    let mut found = [false; Parameters::COUNT];
    for &(name, value) in log.parameters() {
        let refuse = |refusal| SetupError::Parameter {
            name: name.to_string(),
            value,
            refusal,
        };
        let index = Parameters::find(name).ok_or(refuse(windhover_parameters::Refusal::Unknown))?;
        parameters.set(index, value).map_err(refuse)?;
        found[index] = true;
    }
    match Parameters::declarations().zip(found).find(|(_, found)| !found) {
        Some((declaration, _)) => Err(SetupError::MissingParameter(declaration.name)),
        None => Ok(parameters),
    }
}

fn plans(log: &Log<'_>) -> Result<PlanStore, SetupError> {
    let mut store = PlanStore::default();
    for item in log.items() {
        store.put(item);
    }
    let slot = required(log.value::<u32>("mission_slot"), "mission_slot")? as u8;
    let count = required(log.value::<u32>("mission_count"), "mission_count")? as u16;
    let written = required(log.value("mission_crc"), "mission_crc")?;
    let items = || (0..count).map_while(|index| store.item(PlanKind::Mission, slot, index));
    let found = items().count() as u16;
    if found < count {
        return Err(SetupError::MissionCut { found, count });
    }
    let found = mission_crc(items());
    if found != written {
        return Err(SetupError::MissionCrc { found, written });
    }
    Ok(store)
}

/// Plans as they are stored on board, by kind and slot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanStore {
    items: BTreeMap<(u8, u8, u16), MissionItem>,
}

impl PlanStore {
    /// Stores an item.
    pub fn put(&mut self, item: &PlanItem) {
        if self.items.len() < MOST {
            self.items
                .insert((item.kind.code(), item.slot, item.index), item.item);
        }
    }
}

impl MissionSource for PlanStore {
    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem> {
        self.items.get(&(kind.code(), slot, index)).copied()
    }
}
