//! What the autopilot says about a mission that it does not fly, as a client and a human are told.

use windhover_autopilot::mission::{Reason, Refusal};

use windhover_ground_link::{MissionResult, PlanRefusal};

/// Refuses an item, counted from 0, for the reason that the autopilot gives.
pub fn of_item(index: u16, refusal: &Refusal) -> PlanRefusal {
    PlanRefusal::new(result(refusal), format_args!("item {index}: {refusal}"))
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
        (_, "latitude" | "position") => MissionResult::InvalidParam5,
        (_, "longitude") => MissionResult::InvalidParam6,
        (_, "acceptance radius") => MissionResult::InvalidParam2,
        (_, "heading") => MissionResult::InvalidParam4,
        (_, "region of interest mode") => MissionResult::InvalidParam1,
        (_, "altitude") => MissionResult::InvalidParam7,
        _ => MissionResult::Invalid,
    }
}

#[cfg(test)]
mod tests {
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
        of_item(7, &interpret(&item).expect_err("it is not flown"))
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
}
