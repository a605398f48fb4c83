//! Parameters that are only asked for: QGroundControl's pages read PX4's parameters by name, and
//! complain about those that they do not find. What has no meaning here exists as a constant.

use windhover_parameters::Declaration;

use super::ParameterTable;

/// A table with constants after its end. What the table has already by name is the table's.
#[derive(Clone, Copy)]
pub struct Appended<'a> {
    /// What can be set.
    pub table: &'a dyn ParameterTable,
    /// What has one value only, its default: a write is answered with that.
    pub constants: &'static [Declaration],
}

impl ParameterTable for Appended<'_> {
    fn count(&self) -> u16 {
        let constants = u16::try_from(self.constants.len()).unwrap_or_default();
        self.table.count().saturating_add(constants)
    }

    fn declaration(&self, index: u16) -> Option<&'static Declaration> {
        match index.checked_sub(self.table.count()) {
            None => self.table.declaration(index),
            Some(beyond) => self.constants.get(usize::from(beyond)),
        }
    }

    fn value(&self, index: u16) -> Option<f32> {
        match index.checked_sub(self.table.count()) {
            None => self.table.value(index),
            Some(_) => self.declaration(index).map(|constant| constant.default),
        }
    }
}

/// A constant under PX4's name.
const fn constant(name: &'static str, value: f32) -> Declaration {
    Declaration {
        name,
        unit: "",
        min: value,
        max: value,
        default: value,
        text: "Constant, for ground stations that ask for it",
    }
}

/// What QGroundControl asks for and has no meaning here (its sources: the `*Component.cc` and
/// `*Summary.qml` in `src/AutoPilotPlugins/PX4`). The identities of the parts that are calibrated
/// (`CAL_GYRO0_ID` and its like) are the core's: there they say the truth.
pub const QGROUNDCONTROL: &[Declaration] = &[
    constant("SYS_AUTOSTART", 4001.0), // generic quadcopter, X
    constant("SYS_AUTOCONFIG", 0.0),
    constant("SYS_HAS_MAG", 1.0),
    constant("CAL_MAG1_ID", 0.0),
    constant("CAL_MAG2_ID", 0.0),
    constant("SENS_BOARD_ROT", 0.0),
    constant("SENS_BOARD_X_OFF", 0.0),
    constant("SENS_BOARD_Y_OFF", 0.0),
    constant("SENS_BOARD_Z_OFF", 0.0),
    constant("SENS_DPRES_OFF", 0.0),
    constant("CBRK_AIRSPD_CHK", 162_128.0), // there is no airspeed to be checked
];
