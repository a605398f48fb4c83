//! The travels of the channels as parameters.

use windhover_parameters::parameters;

use super::{RcCalibration, RcChannel};

parameters! {
    /// Ends and middle of the first eight channels, as PX4 names them.
    pub struct RcCalibrationParameters {
        min_1: "RC1_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 1 at its lower end";
        trim_1: "RC1_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 1 at rest";
        max_1: "RC1_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 1 at its upper end";
        min_2: "RC2_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 2 at its lower end";
        trim_2: "RC2_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 2 at rest";
        max_2: "RC2_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 2 at its upper end";
        min_3: "RC3_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 3 at its lower end";
        trim_3: "RC3_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 3 at rest";
        max_3: "RC3_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 3 at its upper end";
        min_4: "RC4_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 4 at its lower end";
        trim_4: "RC4_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 4 at rest";
        max_4: "RC4_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 4 at its upper end";
        min_5: "RC5_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 5 at its lower end";
        trim_5: "RC5_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 5 at rest";
        max_5: "RC5_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 5 at its upper end";
        min_6: "RC6_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 6 at its lower end";
        trim_6: "RC6_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 6 at rest";
        max_6: "RC6_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 6 at its upper end";
        min_7: "RC7_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 7 at its lower end";
        trim_7: "RC7_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 7 at rest";
        max_7: "RC7_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 7 at its upper end";
        min_8: "RC8_MIN", "us", 800.0..=1500.0, 1000.0, "Pulse of channel 8 at its lower end";
        trim_8: "RC8_TRIM", "us", 800.0..=2200.0, 1500.0, "Pulse of channel 8 at rest";
        max_8: "RC8_MAX", "us", 1500.0..=2200.0, 2000.0, "Pulse of channel 8 at its upper end";
    }
}

/// Lower end, middle and upper end of a channel that has no parameters, µs.
const USUAL: [f32; 3] = [1000.0, 1500.0, 2000.0];

impl RcCalibrationParameters {
    /// Lower end, middle and upper end of a channel, counted from 1, µs; those above the eighth have
    /// the usual ones.
    pub fn travel(&self, channel: u8) -> [f32; 3] {
        match channel {
            1 => [self.min_1, self.trim_1, self.max_1],
            2 => [self.min_2, self.trim_2, self.max_2],
            3 => [self.min_3, self.trim_3, self.max_3],
            4 => [self.min_4, self.trim_4, self.max_4],
            5 => [self.min_5, self.trim_5, self.max_5],
            6 => [self.min_6, self.trim_6, self.max_6],
            7 => [self.min_7, self.trim_7, self.max_7],
            8 => [self.min_8, self.trim_8, self.max_8],
            _ => USUAL,
        }
    }

    /// Lower end, middle and upper end of each channel.
    fn places(&mut self) -> [[&mut f32; 3]; 8] {
        [
            [&mut self.min_1, &mut self.trim_1, &mut self.max_1],
            [&mut self.min_2, &mut self.trim_2, &mut self.max_2],
            [&mut self.min_3, &mut self.trim_3, &mut self.max_3],
            [&mut self.min_4, &mut self.trim_4, &mut self.max_4],
            [&mut self.min_5, &mut self.trim_5, &mut self.max_5],
            [&mut self.min_6, &mut self.trim_6, &mut self.max_6],
            [&mut self.min_7, &mut self.trim_7, &mut self.max_7],
            [&mut self.min_8, &mut self.trim_8, &mut self.max_8],
        ]
    }
}

impl RcCalibration {
    /// Puts the first eight channels into the parameters; what was not calibrated stays.
    pub fn write(&self, parameters: &mut RcCalibrationParameters) {
        for (place, channel) in parameters.places().into_iter().zip(self.channels) {
            if let Some(RcChannel { min, trim, max }) = channel {
                for (value, pulse) in place.into_iter().zip([min, trim, max]) {
                    *value = f32::from(pulse);
                }
            }
        }
    }
}
