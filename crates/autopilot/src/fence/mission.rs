//! Whether a mission stays inside the fence: every leg, before the mission is accepted.
//!
//! The legs are those that the mission is flown with, as straight lines from point to point: up
//! from home, from waypoint to waypoint, across a jump to its target, and to the landing. A return
//! leads to the nearest rally point or home, whichever is nearer. The vehicle rounds corners
//! within the acceptance radius; that is left to the margin.

use windhover_math::{Vector3, min};

use super::shape::length;
use super::{Fence, FenceAction, FenceParameters, Rally, ground};
use crate::mission::action::{Action, Reason, Refusal, interpret};
use crate::mission::nav::{Chart, Nav, NavKind};
use crate::mission::route::Cursor;
use crate::mission::{MissionSource, PlanKind};

/// Refuses a mission that leaves the fence: the first item, counted from 0, whose leg does. With a
/// fence that does nothing every mission is accepted.
pub fn check_mission<S: MissionSource + ?Sized>(
    chart: &Chart<'_, S>,
    fence: &Fence,
    rally: &Rally,
    parameters: &FenceParameters,
) -> Result<(), (u16, Refusal)> {
    if parameters.action() == FenceAction::Nothing {
        return Ok(());
    }
    let walk = Walk {
        chart,
        fence,
        rally,
        parameters,
    };
    // Where the vehicle is before the item; behind a jump for ever that is not known.
    let mut from = Some(chart.home);
    let mut landed = true;
    for index in 0..chart.stored.count {
        let Some(action) = walk.action(index) else {
            continue;
        };
        if let Action::Jump { to, times } = action {
            if let Some(from) = from
                && times != Some(0)
            {
                let refused = |_| refuse(index, "jump target");
                walk.item(to, from, false).map_err(refused)?;
            }
            from = from.filter(|_| times.is_some());
        } else if action.is_navigation() {
            from = match from {
                Some(from) => Some(walk.item(index, from, landed)?),
                None => walk.place(&action),
            };
            landed = false;
        }
    }
    Ok(())
}

fn refuse(index: u16, field: &'static str) -> (u16, Refusal) {
    let reason = Reason::Fence;
    (index, Refusal { field, reason })
}

/// What a mission is held against.
struct Walk<'a, S: ?Sized> {
    chart: &'a Chart<'a, S>,
    fence: &'a Fence,
    rally: &'a Rally,
    parameters: &'a FenceParameters,
}

impl<S: MissionSource + ?Sized> Walk<'_, S> {
    fn action(&self, index: u16) -> Option<Action> {
        let chart = self.chart;
        let item = chart.source.item(PlanKind::Mission, chart.stored.slot, index)?;
        interpret(&item).ok()
    }

    /// Where an item is that gives a place.
    fn place(&self, action: &Action) -> Option<Vector3> {
        match action {
            Action::Waypoint { place, .. } | Action::Land { place: Some(place) } => {
                Some(self.chart.local(place))
            }
            _ => None,
        }
    }

    /// Flies from `from` to the first point at or behind an item, and on until the item is done:
    /// where that is.
    fn item(&self, index: u16, from: Vector3, landed: bool) -> Result<Vector3, (u16, Refusal)> {
        let kind = if landed {
            NavKind::Start { landed }
        } else {
            NavKind::Waypoint
        };
        let mut at = self.at(index, kind, from);
        // Up, across, down: no item has more legs.
        for _ in 0..3 {
            let Some(next) = self.chart.following(&at) else {
                break;
            };
            let action = self.action(next.item);
            if action == Some(Action::Return) {
                return self.homeward(next.item, at.target);
            }
            let field = match action {
                Some(Action::Takeoff { .. }) => "takeoff",
                Some(Action::Land { .. }) => "landing",
                _ => "waypoint",
            };
            self.leg(next.item, field, at.target, next.target)?;
            at = next;
            let climbs_first = next.kind == NavKind::Climb && field == "waypoint";
            if !climbs_first && next.kind != NavKind::Approach {
                break;
            }
        }
        Ok(at.target)
    }

    /// Up to the return height, unless close by, across to where it is nearest to land, and down
    /// there. Over ground all of that is the way across, and nothing is higher than its ends.
    fn homeward(&self, index: u16, from: Vector3) -> Result<Vector3, (u16, Refusal)> {
        let parameters = self.chart.parameters;
        let home = self.chart.home;
        let to = self.rally.destination(from, home);
        let near = length(ground(to - from)) < parameters.acceptance_radius;
        let height = if near {
            from.z
        } else {
            min(from.z, home.z - parameters.return_altitude)
        };
        let up = Vector3::new(from.x, from.y, height);
        self.leg(index, "return", up, Vector3::new(to.x, to.y, height))?;
        Ok(Vector3::new(to.x, to.y, home.z))
    }

    fn leg(&self, index: u16, field: &'static str, from: Vector3, to: Vector3) -> Result<(), (u16, Refusal)> {
        if self.fence.leaves(self.parameters, self.chart.home, from, to) {
            return Err(refuse(index, field));
        }
        Ok(())
    }

    /// Just before an item.
    fn at(&self, index: u16, kind: NavKind, target: Vector3) -> Nav {
        Nav {
            item: index,
            kind,
            target,
            hold: 0.0,
            radius: self.chart.parameters.acceptance_radius,
            heading: None,
            speed: None,
            rest_before: false,
            after: Cursor::before(index),
        }
    }
}
