//! What the autopilot says about a mission that it does not fly, as a client and a human are told.

use core::fmt;

use windhover_autopilot::mission::{MAX_ITEMS, Reason, Refusal};

use super::{MissionResult, PlanRefusal};
use crate::scale::integer;
use crate::text::{Decimal, Plain, Whole};

impl PlanRefusal {
    /// Refuses an item, counted from 0, for the reason that the autopilot gives.
    pub fn of_item(index: u16, refusal: &Refusal) -> Self {
        Self::new(
            result(refusal),
            format_args!("item {}: {}", Whole(index.into()), Words(refusal)),
        )
    }
}

/// Which parameter it is that is wrong, where the field tells.
fn result(refusal: &Refusal) -> MissionResult {
    match (refusal.reason, refusal.field) {
        (Reason::Command(_), _) => MissionResult::Unsupported,
        (Reason::Frame(_), _) => MissionResult::UnsupportedFrame,
        (Reason::TooMany(_), _) => MissionResult::NoSpace,
        (Reason::Missing, _) => MissionResult::Error,
        (Reason::Fence, _) => MissionResult::Invalid,
        (_, "hold time" | "loiter time" | "delay" | "trigger distance" | "jump target") => {
            MissionResult::InvalidParam1
        }
        (_, "speed" | "photo interval" | "jump repeats") => MissionResult::InvalidParam2,
        (_, "number of photos") => MissionResult::InvalidParam3,
        (_, "position") => MissionResult::InvalidParam5,
        (_, "altitude") => MissionResult::InvalidParam7,
        _ => MissionResult::Invalid,
    }
}

/// The reason in words, as the autopilot has them, but without the standard way of writing floats.
struct Words<'a>(&'a Refusal);

impl fmt::Display for Words<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let field = Plain(self.0.field);
        let whole = |number: u16| Whole(number.into());
        match self.0.reason {
            Reason::Command(command) => {
                write!(f, "{field}: {} is not flown by this vehicle", whole(command))
            }
            Reason::Frame(frame) => {
                let frame = whole(frame.into());
                write!(f, "{field}: {frame} is not understood; use 0, 3, 5 or 6")
            }
            Reason::NotANumber => write!(f, "{field}: not a number"),
            Reason::Range { value, min, max } => {
                let [value, min, max] = [value, min, max].map(Decimal);
                write!(f, "{field}: {value} is outside {min} to {max}")
            }
            Reason::Distance { value, max } => {
                let [value, max] = [value, max].map(|metres| Whole(integer(metres, 1).unsigned_abs()));
                write!(f, "{field}: {value} m from home, the limit is {max} m")
            }
            Reason::NoWaypoint => write!(f, "{field}: nothing to fly to; add a waypoint"),
            Reason::Missing => write!(f, "{field}: the item is missing"),
            Reason::TooMany(count) => {
                let [count, most] = [count, MAX_ITEMS].map(|number| Whole(number as u32));
                write!(f, "{field}: {count} items, the vehicle stores {most}")
            }
            Reason::Jump => write!(f, "{field}: leads out of the mission, or is one jump too many"),
            Reason::Fence => write!(f, "{field}: leg leaves the geofence; move it or the fence"),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::iter::successors;
    use std::string::ToString;

    use windhover_autopilot::mission::MissionItem;
    use windhover_autopilot::mission::action::interpret;

    use super::*;

    const ITEM: MissionItem = MissionItem {
        command: 16,
        frame: 3,
        autocontinue: true,
        params: [0.0; 4],
        x: 473_977_418,
        y: 85_455_938,
        z: 30.0,
    };

    fn refused(item: MissionItem) -> PlanRefusal {
        PlanRefusal::of_item(7, &interpret(&item).expect_err("it is not flown"))
    }

    #[test]
    fn a_client_is_told_which_number_is_wrong_and_a_human_why() {
        for (item, result, reason) in [
            (
                MissionItem { command: 84, ..ITEM },
                MissionResult::Unsupported,
                "item 7: command: 84 is not flown by this vehicle",
            ),
            (
                MissionItem { frame: 10, ..ITEM },
                MissionResult::UnsupportedFrame,
                "item 7: frame: 10 is not understood; use 0, 3, 5 or 6",
            ),
            (
                MissionItem {
                    params: [5000.5, 0.0, 0.0, 0.0],
                    ..ITEM
                },
                MissionResult::InvalidParam1,
                "item 7: hold time: 5000.5 is outside 0 to 3600",
            ),
            (
                MissionItem { z: f32::NAN, ..ITEM },
                MissionResult::InvalidParam7,
                "item 7: altitude: not a number",
            ),
        ] {
            let refusal = refused(item);
            assert_eq!((refusal.result, refusal.reason.as_str()), (result, reason));
        }
    }

    /// The reason after this one, in the order of their declaration: a new one must find its place.
    fn next(reason: &Reason) -> Option<Reason> {
        Some(match reason {
            Reason::Command(_) => Reason::Frame(10),
            Reason::Frame(_) => Reason::NotANumber,
            Reason::NotANumber => Reason::Range {
                value: -0.0625,
                min: 0.5,
                max: 65_535.0,
            },
            Reason::Range { .. } => Reason::Distance {
                value: 1_234.6,
                max: 999.9,
            },
            Reason::Distance { .. } => Reason::NoWaypoint,
            Reason::NoWaypoint => Reason::Missing,
            Reason::Missing => Reason::TooMany(MAX_ITEMS + 1),
            Reason::TooMany(_) => Reason::Jump,
            Reason::Jump => Reason::Fence,
            Reason::Fence => return None,
        })
    }

    /// Logs and the simulator show the core's words: by radio the same is said.
    #[test]
    fn every_reason_is_in_the_autopilots_own_words() {
        for reason in successors(Some(Reason::Command(84)), next) {
            let refusal = Refusal {
                field: "some field",
                reason,
            };
            assert_eq!(Words(&refusal).to_string(), refusal.to_string());
        }
    }
}
