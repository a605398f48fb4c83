//! What the battery is, and when it is low.

use windhover_parameters::parameters;

use super::cell;

parameters! {
    /// What the battery is, how it is measured, and when it is low.
    pub struct BatteryParameters {
        divider: "BAT1_V_DIV", "", 1.0..=100.0, 11.0, "Volts of the battery for a volt at the ADC";
        per_volt: "BAT1_A_PER_V", "A/V", 0.1..=1000.0, 25.0, "Amperes of the battery for a volt at the ADC";
        cells: "BAT1_N_CELLS", "", 0.0..=16.0, 4.0, "Cells in series; 0: no battery is watched";
        empty: "BAT1_V_EMPTY", "V", 2.5..=3.7, 3.5, "Voltage of an empty cell, the drop by the load taken off";
        charged: "BAT1_V_CHARGED", "V", 3.9..=4.4, 4.15, "Voltage of a full cell, the drop by the load taken off";
        resistance: "BAT1_R_INTERNAL", "Ohm", 0.0..=0.2, 0.005, "Resistance of each cell with its share of the leads";
        capacity: "BAT1_CAPACITY", "mAh", -1.0..=100000.0, 5000.0, "Charge of the full battery; -1 or 0: not known, and the voltage alone counts";
        low: "BAT_LOW_THR", "", 0.05..=0.9, 0.25, "Below this share of its charge the battery is low";
        critical: "BAT_CRIT_THR", "", 0.03..=0.5, 0.12, "Below this share of its charge the battery is critical";
        emergency: "BAT_EMERGEN_THR", "", 0.01..=0.3, 0.06, "Below this share of its charge the battery has to be on the ground";
        arm_voltage: "BAT_ARM_V_CELL", "V", 0.0..=4.2, 3.5, "No arming below this voltage of a cell as it is measured";
    }
}

impl BatteryParameters {
    /// Whether there is a battery to watch.
    pub fn is_watched(&self) -> bool {
        self.cell_count() > 0.0
    }

    /// Cells in series, a whole number.
    pub(super) fn cell_count(&self) -> f32 {
        f32::from(self.cells as u8)
    }

    /// Below this voltage the battery is not armed with, V.
    pub fn arming_voltage(&self) -> f32 {
        self.cell_count() * self.arm_voltage
    }

    /// Resistance of all cells, Ω.
    pub(super) fn pack_resistance(&self) -> f32 {
        self.cell_count() * self.resistance
    }

    /// Charge of the full battery, C, if it is known.
    pub(super) fn full_charge(&self) -> Option<f32> {
        (self.capacity >= 1.0).then_some(self.capacity * 3.6)
    }

    /// Share of the charge, 0 to 1, that an open-circuit voltage of the whole battery, V, stands for.
    pub(super) fn share_at(&self, open_circuit: f32) -> f32 {
        // the ranges keep the two ends apart
        let [empty, full] = [self.empty, self.charged].map(cell::charge);
        let share = (cell::charge(open_circuit / self.cell_count()) - empty) / (full - empty);
        share.clamp(0.0, 1.0)
    }
}
