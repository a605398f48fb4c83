//! Whether a mission can be flown: asked once, before it is accepted, whoever brings it.

use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::sqrt;

use super::action::{Action, Altitude, Place, Reason, Refusal, interpret};
use super::item::MAX_ITEMS;
use super::route::{MAX_JUMPS, Stored};
use super::{MissionParameters, MissionSource, PlanKind};

/// Refuses a mission that has an item which is not flown: the item's index, counted from 0, and
/// why. Without a `home` altitudes and distances are not looked at.
pub fn check<S: MissionSource + ?Sized>(
    source: &S,
    stored: Stored,
    home: Option<GlobalPosition>,
    parameters: &MissionParameters,
) -> Result<(), (u16, Refusal)> {
    if usize::from(stored.count) > MAX_ITEMS {
        let reason = Reason::TooMany(usize::from(stored.count));
        return Err((
            0,
            Refusal {
                field: "mission",
                reason,
            },
        ));
    }
    let frame = home.map(LocalFrame::new);
    let (mut waypoints, mut jumps) = (0, 0);
    for index in 0..stored.count {
        let missing = || {
            let (field, reason) = ("mission", Reason::Missing);
            (index, Refusal { field, reason })
        };
        let item = source
            .item(PlanKind::Mission, stored.slot, index)
            .ok_or_else(missing)?;
        let action = interpret(&item).map_err(|refusal| (index, refusal))?;
        waypoints += u32::from(matches!(action, Action::Waypoint { .. }));
        if let Action::Jump { to, .. } = action {
            jumps += 1;
            if to >= stored.count || jumps > MAX_JUMPS {
                return Err((
                    index,
                    Refusal {
                        field: "jump target",
                        reason: Reason::Jump,
                    },
                ));
            }
        }
        if let Some(frame) = &frame {
            check_place(&action, frame, parameters).map_err(|refusal| (index, refusal))?;
        }
    }
    if waypoints == 0 {
        return Err((
            0,
            Refusal {
                field: "mission",
                reason: Reason::NoWaypoint,
            },
        ));
    }
    Ok(())
}

fn check_place(action: &Action, frame: &LocalFrame, parameters: &MissionParameters) -> Result<(), Refusal> {
    let home = frame.origin();
    let check_altitude = |altitude: Altitude, min: f32| {
        let (value, max) = (altitude.above_home(home.altitude), parameters.altitude_max);
        if value >= min && value <= max {
            return Ok(());
        }
        Err(Refusal {
            field: "altitude",
            reason: Reason::Range { value, min, max },
        })
    };
    let check_distance = |place: &Place| {
        let local = place.over_ground(frame);
        let (value, max) = (
            sqrt(local.x * local.x + local.y * local.y),
            parameters.distance_max,
        );
        if value <= max {
            return Ok(());
        }
        Err(Refusal {
            field: "position",
            reason: Reason::Distance { value, max },
        })
    };
    match action {
        Action::Takeoff { altitude } => check_altitude(*altitude, 0.5),
        Action::Waypoint { place, .. } => {
            check_altitude(place.altitude, -parameters.altitude_max)?;
            check_distance(place)
        }
        Action::Land { place: Some(place) } => check_distance(place),
        _ => Ok(()),
    }
}
