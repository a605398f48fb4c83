//! Why a vehicle does not arm, or a mode does not fly: named reasons, each with a sentence.

use core::fmt;

use windhover_parameters::Decimal;

use crate::outer::OuterReport;
use crate::set::bit_set;

/// Declares the blockers: variant, what it means, sentence.
macro_rules! blockers {
    ($($(#[$meta:meta])* $Blocker:ident = $text:literal;)*) => {
        /// A named reason not to arm, or not to fly in a mode.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Blocker {
            $($(#[$meta])* $Blocker,)*
        }

        impl Blocker {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$Blocker,)*];

            /// The sentence without figures.
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$Blocker => $text,)*
                }
            }
        }
    };
}

blockers! {
    /// The inner step keeps the motors stopped.
    Stopped = "motors are held stopped: kill switch, or no inertial samples";
    /// Roll and pitch are not known.
    AttitudeUnknown = "attitude unknown: keep the vehicle still";
    /// The vehicle stands too tilted.
    Tilted = "vehicle tilted: put it on level ground";
    /// Inertial samples are missing or invalid.
    ImuUnreliable = "inertial sensors unreliable";
    /// The gyro was never calibrated.
    GyroUncalibrated = "gyro not calibrated";
    /// The accelerometer was never calibrated.
    AccelerometerUncalibrated = "accelerometer not calibrated";
    /// The compass was never calibrated.
    CompassUncalibrated = "compass not calibrated";
    /// The compass is silent or rejected.
    CompassFault = "compass silent or disturbed";
    /// The barometer is silent or rejected.
    BarometerFault = "barometer silent or implausible";
    /// The height is not known.
    HeightUnknown = "height unknown";
    /// The heading is not known.
    HeadingUnknown = "heading unknown";
    /// The position is not known.
    PositionUnknown = "position unknown: wait for GNSS";
    /// The battery has too little left.
    BatteryLow = "battery low";
    /// There is no remote control, and one is required.
    RcMissing = "no remote control, and COM_RC_IN_MODE requires one";
    /// The remote control was lost.
    RcLost = "remote control lost";
    /// Throttle or sticks are not where they are safe.
    SticksUnsafe = "throttle not at its low end";
    /// The vehicle is outside of the fence.
    OutsideFence = "outside the geofence";
    /// The stored fence or rally points cannot be flown with.
    FenceInvalid = "stored fence or rally points invalid";
    /// There is no mission that can be flown.
    NoMission = "no mission stored, or one that cannot be flown";
    /// Setpoints from outside do not come.
    NoSetpoint = "no setpoints from outside";
    /// There are no sticks.
    NoSticks = "no sticks for a manual mode";
    /// What is stored was found damaged.
    StorageDamaged = "stored settings damaged, defaults loaded: check and save them, then restart";
}

bit_set! {
    /// A set of blockers.
    Blockers(u32) of Blocker
}

/// A blocker as a sentence, with figures where they help.
#[derive(Clone, Copy, Debug)]
pub struct Sentence<'a> {
    /// What.
    pub blocker: Blocker,
    /// Where the figures are.
    pub report: &'a OuterReport,
}

impl fmt::Display for Sentence<'_> {
    #[cold]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let battery = &self.report.battery;
        match (self.blocker, battery.voltage) {
            (Blocker::BatteryLow, Some(voltage)) if voltage < battery.arming_voltage => {
                let [voltage, least] =
                    [voltage, battery.arming_voltage].map(|volts| Decimal::rounded(volts, 1));
                write!(f, "battery {voltage} V below {least} V")
            }
            (Blocker::BatteryLow, _) => {
                let percent = Decimal::rounded(battery.remaining.unwrap_or_default() * 100.0, 0);
                write!(f, "battery low: {percent} % left")
            }
            (Blocker::PositionUnknown, _) if self.report.estimate.known.position => {
                let accuracy = Decimal::rounded(self.report.estimate.accuracy.horizontal, 1);
                write!(f, "position not measured lately (within {accuracy} m)")
            }
            (other, _) => f.write_str(other.text()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::string::ToString;

    #[test]
    fn every_blocker_is_a_sentence_of_its_own_and_fits_a_line_of_text() {
        let report = OuterReport::default();
        let mut all: std::vec::Vec<_> = Blocker::ALL
            .iter()
            .map(|blocker| {
                let sentence = Sentence {
                    blocker: *blocker,
                    report: &report,
                };
                sentence.to_string()
            })
            .collect();
        assert!(all.iter().all(|text| (8..100).contains(&text.len())), "{all:?}");
        all.sort();
        all.dedup();
        assert_eq!(all.len(), Blocker::ALL.len());
        assert!(Blocker::ALL.len() <= 32);
    }

    #[test]
    fn a_low_battery_is_told_with_its_voltage() {
        let mut report = OuterReport::default();
        report.battery.voltage = Some(10.2);
        report.battery.arming_voltage = 10.5;
        let sentence = Sentence {
            blocker: Blocker::BatteryLow,
            report: &report,
        };
        assert_eq!(sentence.to_string(), "battery 10.2 V below 10.5 V");
    }

    #[test]
    fn sets_hold_what_is_put_in() {
        for blocker in Blocker::ALL {
            let set = Blockers::of(*blocker);
            assert!(set.iter().eq([*blocker]), "{blocker:?}");
            assert_eq!(Blockers::default().with(*blocker, false), Blockers::default());
        }
    }
}
