//! The failsafes as a table: what is watched, for how long, what is done, who may override it.

use super::action::Action;
use crate::parameters::Parameters;
use crate::set::bit_set;

/// Who may fly on in spite of a failsafe that acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Override {
    /// The operator, by choosing any mode.
    Operator,
    /// A pilot, by choosing a mode that sticks fly.
    Pilot,
    /// Nobody.
    Nobody,
}

/// One row of the table.
#[derive(Clone, Copy)]
pub struct Watched {
    /// Its name in the log.
    pub name: &'static str,
    /// What the pilot is told.
    pub text: &'static str,
    /// The condition has to last for so long, s.
    pub after: fn(&Parameters) -> f32,
    /// And has to be gone for so long to be over, s.
    pub clears: f32,
    /// Whether it is watched while an armed vehicle stands on the ground, too: there everything from
    /// [`Action::Hold`] on disarms.
    pub on_ground: bool,
    /// What is done.
    pub action: fn(&Parameters) -> Action,
    /// Who may override it.
    pub yields_to: Override,
    /// Whether the mode that was interrupted goes on when it is over.
    pub resumes: bool,
}

/// Declares the rows: variant, what it means, and its line of the table.
macro_rules! rows {
    ($($(#[$meta:meta])* $Row:ident { $($field:ident: $value:expr),* $(,)? })*) => {
        /// A row of the table.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Row {
            $($(#[$meta])* $Row,)*
        }

        impl Row {
            /// All rows; of two that do the same, the first one is named.
            pub const ALL: &'static [Self] = &[$(Self::$Row,)*];

            /// Its line of the table.
            pub const fn watched(self) -> &'static Watched {
                match self {
                    $(Self::$Row => {
                        const LINE: Watched = Watched { $($field: $value),* };
                        &LINE
                    })*
                }
            }
        }
    };
}

rows! {
    /// No sample of the inertial sensors for 20 ms: the inner step has stopped the motors by itself.
    ImuMissing {
        name: "imu_missing", text: "inertial sensors silent, motors off",
        after: |_| 0.0, clears: 0.0, on_ground: true,
        action: |_| Action::Terminate, yields_to: Override::Nobody, resumes: false,
    }
    /// The vehicle lies on its side, or worse, close to the ground.
    TumbleLow {
        name: "tumble_low", text: "attitude lost near the ground, motors off",
        after: |p| p.safety.tumble_time, clears: 0.0, on_ground: true,
        action: |_| Action::Terminate, yields_to: Override::Nobody, resumes: false,
    }
    /// Roll and pitch are not known any more.
    AttitudeUnknown {
        name: "attitude_unknown", text: "estimate diverged, descending",
        after: |_| 0.0, clears: 2.0, on_ground: true,
        action: |_| Action::Descend, yields_to: Override::Nobody, resumes: false,
    }
    /// Nothing measures the height any more.
    HeightUnknown {
        name: "height_unknown", text: "height unknown, descending",
        after: |_| 0.0, clears: 2.0, on_ground: false,
        action: |_| Action::Descend, yields_to: Override::Pilot, resumes: true,
    }
    /// The position has not been known for a minute.
    PositionGone {
        name: "position_gone", text: "position lost for long, descending",
        after: |p| p.safety.position_gone, clears: 2.0, on_ground: false,
        action: |_| Action::Descend, yields_to: Override::Pilot, resumes: true,
    }
    /// Inertial samples are missing, invalid or at the end of their range, again and again.
    ImuUnreliable {
        name: "imu_unreliable", text: "inertial sensors clip or drop samples, landing",
        after: |_| 1.0, clears: 5.0, on_ground: true,
        action: |_| Action::Land, yields_to: Override::Pilot, resumes: false,
    }
    /// The battery is empty.
    BatteryEmergency {
        name: "battery_emergency", text: "battery empty",
        after: |_| 1.0, clears: 5.0, on_ground: true,
        action: |p| if p.safety.low_battery_action >= 1.5 { Action::Land } else { Action::Warn },
        yields_to: Override::Pilot, resumes: false,
    }
    /// A rotor has been at its limit for too long.
    MotorSaturated {
        name: "motor_saturated", text: "a motor is at its limit, landing",
        after: |p| p.safety.saturation_time, clears: 5.0, on_ground: false,
        action: |_| Action::Land, yields_to: Override::Operator, resumes: false,
    }
    /// The wind takes all the tilt that is allowed.
    WindTooStrong {
        name: "wind_too_strong", text: "wind stronger than the tilt limit holds, landing",
        after: |p| p.safety.wind_time, clears: 10.0, on_ground: false,
        action: |_| Action::Land, yields_to: Override::Operator, resumes: false,
    }
    /// What the battery has left does not bring the vehicle home.
    RangeShort {
        name: "range_short", text: "battery just lasts to return",
        after: |_| 2.0, clears: 30.0, on_ground: false,
        action: |p| if p.safety.low_battery_action >= 1.5 { Action::Return } else { Action::Warn },
        yields_to: Override::Operator, resumes: false,
    }
    /// The battery is nearly empty.
    BatteryCritical {
        name: "battery_critical", text: "battery critical",
        after: |_| 1.0, clears: 5.0, on_ground: false,
        action: |p| match p.safety.low_battery_action as u8 {
            0 | 1 => Action::Warn,
            2 => Action::Land,
            _ => Action::Return,
        },
        yields_to: Override::Operator, resumes: false,
    }
    /// The remote control is not heard any more.
    RcLost {
        name: "rc_lost", text: "remote control lost",
        after: |_| 0.0, clears: 1.0, on_ground: true,
        action: |p| Action::of_link(p.safety.rc_lost_action), yields_to: Override::Operator, resumes: false,
    }
    /// The ground station is not heard any more.
    StationLost {
        name: "station_lost", text: "ground station lost",
        after: |p| p.safety.station_lost_time, clears: 1.0, on_ground: false,
        action: |p| Action::of_link(p.safety.station_lost_action), yields_to: Override::Operator, resumes: false,
    }
    /// The compass is not to be relied on.
    CompassFault {
        name: "compass_fault", text: "compass fault, returning",
        after: |_| 2.0, clears: 5.0, on_ground: false,
        action: |_| Action::Return, yields_to: Override::Operator, resumes: false,
    }
    /// The barometer is not to be relied on.
    BarometerFault {
        name: "barometer_fault", text: "barometer fault, returning",
        after: |_| 2.0, clears: 5.0, on_ground: false,
        action: |_| Action::Return, yields_to: Override::Operator, resumes: false,
    }
    /// The vehicle has left the geofence, or could not stop inside any more.
    Fence {
        name: "fence", text: "geofence",
        after: |_| 0.0, clears: 1.0, on_ground: false,
        action: |p| Action::of_fence(p.fence.action()), yields_to: Override::Operator, resumes: false,
    }
    /// The vehicle lies on its side, or worse, with room below it to recover.
    TumbleHigh {
        name: "tumble_high", text: "attitude lost, recovering",
        after: |p| p.safety.tumble_time, clears: 2.0, on_ground: false,
        action: |_| Action::Hold, yields_to: Override::Pilot, resumes: false,
    }
    /// The position is not known: level at height and heading until it is again.
    PositionLost {
        name: "position_lost", text: "position lost, level hold",
        after: |_| 0.0, clears: 2.0, on_ground: false,
        action: |_| Action::Hold, yields_to: Override::Pilot, resumes: true,
    }
    /// Setpoints from outside do not come any more.
    OffboardLost {
        name: "offboard_lost", text: "setpoints from outside lost",
        after: |_| 0.0, clears: 0.0, on_ground: false,
        action: |p| Action::of_link(p.safety.offboard_lost_action), yields_to: Override::Operator, resumes: false,
    }
    /// The receiver is silent or rejected: position by prediction.
    GnssLost {
        name: "gnss_lost", text: "GNSS lost, position by prediction",
        after: |_| 1.0, clears: 2.0, on_ground: false,
        action: |_| Action::Warn, yields_to: Override::Operator, resumes: false,
    }
    /// The battery is low.
    BatteryLow {
        name: "battery_low", text: "battery low",
        after: |_| 1.0, clears: 5.0, on_ground: true,
        action: |_| Action::Warn, yields_to: Override::Operator, resumes: false,
    }
    /// There was no outer step for 100 ms: the inner step went level and down by itself meanwhile.
    OuterSilent {
        name: "outer_silent", text: "outer loop was silent, level descent until it came back",
        after: |_| 0.0, clears: 1.0, on_ground: false,
        action: |_| Action::Warn, yields_to: Override::Nobody, resumes: false,
    }
}

/// How many rows there are.
pub const ROWS: usize = Row::ALL.len();

bit_set! {
    /// A set of rows.
    RowSet(u32) of Row
}

/// The rows that are watched on the ground.
pub(super) const ON_GROUND: RowSet = {
    let (mut set, mut n) = (RowSet(0), 0);
    while n < ROWS {
        set = set.with(Row::ALL[n], Row::ALL[n].watched().on_ground);
        n += 1;
    }
    set
};

/// What each row does, by the parameters as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Actions([Action; ROWS]);

impl Actions {
    /// By these parameters.
    pub fn new(parameters: &Parameters) -> Self {
        let mut actions = [Action::None; ROWS];
        for (action, row) in actions.iter_mut().zip(Row::ALL) {
            *action = (row.watched().action)(parameters);
        }
        Self(actions)
    }

    /// What this row does.
    pub fn of(&self, row: Row) -> Action {
        self.0.get(row as usize).copied().unwrap_or_default()
    }

    /// The row of a set that does most; of several the first in the table. Rows that do nothing are
    /// not looked at.
    pub fn worst(&self, rows: RowSet) -> Option<Row> {
        let mut worst = None;
        for row in rows.iter() {
            if self.of(row) > worst.map_or(Action::None, |other| self.of(other)) {
                worst = Some(row);
            }
        }
        worst
    }
}
