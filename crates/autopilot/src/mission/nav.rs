//! The points that a mission is flown to, found by looking ahead.

use windhover_math::Vector3;
use windhover_math::geodesy::LocalFrame;

use super::action::{Action, Altitude, Place};
use super::route::{Cursor, Stored};
use super::{MissionParameters, MissionSource, PlanKind};
use crate::trajectory::Limits;

/// What kind of leg leads to a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NavKind {
    /// None yet: where the mission begins, on the ground or in the air.
    Start {
        /// Whether on the ground.
        landed: bool,
    },
    /// Straight up: from the ground, or before returning.
    Climb,
    /// To a waypoint of the mission.
    Waypoint,
    /// Above the place of the landing: home, or where the mission says.
    Approach,
    /// Down, until the ground is there.
    Land,
}

/// A point to fly to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nav {
    /// Index of its item.
    pub item: u16,
    /// Kind of the leg to it.
    pub kind: NavKind,
    /// Where it is, NED, m.
    pub target: Vector3,
    /// How long to stay, s.
    pub hold: f32,
    /// Reached within this distance, m.
    pub radius: f32,
    /// Heading, where the item gives one, rad.
    pub heading: Option<f32>,
    /// Speed on the way there, where the mission has set one, m/s.
    pub speed: Option<f32>,
    /// Whether something before it needs the vehicle at rest where it is now.
    pub rest_before: bool,
    /// Where the mission goes on after it.
    pub after: Cursor,
}

/// How far below home the landing leg leads: the ground comes first.
const BELOW_HOME: f32 = 200.0;

/// What looking ahead needs.
pub struct Chart<'a, S: ?Sized> {
    /// The stored missions.
    pub source: &'a S,
    /// Which of them is flown.
    pub stored: Stored,
    /// The local frame; its origin is home.
    pub frame: &'a LocalFrame,
    /// Speeds, radii, heights.
    pub parameters: &'a MissionParameters,
}

impl<S: MissionSource + ?Sized> Chart<'_, S> {
    /// Where the mission begins; `None` when there is nothing to fly to.
    pub fn start(&self, position: Vector3, landed: bool) -> Option<Nav> {
        let start = Nav {
            item: 0,
            kind: NavKind::Start { landed },
            target: position,
            hold: 0.0,
            radius: self.parameters.acceptance_radius,
            heading: None,
            speed: None,
            rest_before: false,
            after: Cursor::default(),
        };
        self.following(&start).map(|_| start)
    }

    /// The first point: a mission that begins on the ground without a takeoff item climbs
    /// straight up to its first waypoint's height, before everything else.
    fn first(&self, start: &Nav, landed: bool) -> Option<Nav> {
        let from = start.target;
        let first = self.next(start.after, from, start.speed)?;
        if landed && first.kind == NavKind::Waypoint {
            return Some(Nav {
                kind: NavKind::Climb,
                target: Vector3::new(from.x, from.y, first.target.z),
                hold: 0.0,
                radius: self.parameters.acceptance_radius,
                heading: None,
                after: start.after,
                ..first
            });
        }
        Some(first)
    }

    /// The point after `nav`.
    pub fn following(&self, nav: &Nav) -> Option<Nav> {
        let returning = self.is_returning(nav);
        match nav.kind {
            NavKind::Start { landed } => self.first(nav, landed),
            NavKind::Climb if returning => Some(self.home(nav)),
            NavKind::Approach => Some(self.land(nav, nav.target)),
            _ => self.next(nav.after, nav.target, nav.speed),
        }
    }

    /// Whether the item of `nav` ends the mission on the ground, in several legs.
    fn is_returning(&self, nav: &Nav) -> bool {
        let action = self
            .source
            .item(PlanKind::Mission, self.stored.slot, nav.item)
            .and_then(|item| super::action::interpret(&item).ok());
        matches!(action, Some(Action::Return | Action::Land { .. }))
    }

    /// The next point behind `cursor`, flown to from `from`.
    fn next(&self, mut cursor: Cursor, from: Vector3, mut speed: Option<f32>) -> Option<Nav> {
        let mut rest_before = false;
        loop {
            let (item, action) = cursor.advance(self.source, self.stored)?;
            rest_before |= action.needs_rest();
            if let Action::Speed(wanted) = action {
                speed = wanted;
            }
            let plain = Nav {
                item,
                kind: NavKind::Waypoint,
                target: from,
                hold: 0.0,
                radius: self.parameters.acceptance_radius,
                heading: None,
                speed,
                rest_before,
                after: cursor,
            };
            if action.is_navigation() {
                return Some(self.point(plain, &action));
            }
        }
    }

    fn point(&self, plain: Nav, action: &Action) -> Nav {
        let from = plain.target;
        match action {
            Action::Takeoff { altitude } => Nav {
                kind: NavKind::Climb,
                target: Vector3::new(from.x, from.y, self.down(*altitude)),
                ..plain
            },
            Action::Waypoint {
                place,
                hold,
                acceptance_radius,
                heading,
            } => Nav {
                target: self.local(place),
                hold: *hold,
                radius: acceptance_radius.unwrap_or(plain.radius),
                heading: *heading,
                ..plain
            },
            Action::Land { place: Some(place) } => {
                let above = self.local(place);
                Nav {
                    kind: NavKind::Approach,
                    target: Vector3::new(above.x, above.y, from.z),
                    ..plain
                }
            }
            Action::Return => self.climb_or_home(plain),
            _ => self.land(&plain, from),
        }
    }

    /// The first leg of the way home: up to the return height, unless there or close by.
    fn climb_or_home(&self, plain: Nav) -> Nav {
        let from = plain.target;
        let height = -self.parameters.return_altitude;
        let near =
            windhover_math::sqrt(from.x * from.x + from.y * from.y) < self.parameters.acceptance_radius;
        if from.z > height && !near {
            return Nav {
                kind: NavKind::Climb,
                target: Vector3::new(from.x, from.y, height),
                ..plain
            };
        }
        self.home(&plain)
    }

    fn home(&self, before: &Nav) -> Nav {
        Nav {
            kind: NavKind::Approach,
            target: Vector3::new(0.0, 0.0, before.target.z),
            heading: None,
            hold: 0.0,
            ..*before
        }
    }

    fn land(&self, before: &Nav, above: Vector3) -> Nav {
        Nav {
            kind: NavKind::Land,
            target: Vector3::new(above.x, above.y, BELOW_HOME),
            heading: None,
            hold: 0.0,
            ..*before
        }
    }

    fn down(&self, altitude: Altitude) -> f32 {
        -altitude.above_home(self.frame.origin().altitude)
    }

    /// Where a place is in the local frame, NED, m.
    pub fn local(&self, place: &Place) -> Vector3 {
        let ground = self.frame.to_local(place.ground(self.frame.origin()));
        Vector3::new(ground.x, ground.y, self.down(place.altitude))
    }

    /// Speeds and accelerations of the leg to `nav`.
    pub fn limits(&self, nav: &Nav, landed: bool) -> Limits {
        let p = self.parameters;
        Limits {
            speed: nav.speed.unwrap_or(p.cruise_speed),
            climb: if landed { p.takeoff_speed } else { p.climb_speed },
            descend: if nav.kind == NavKind::Land {
                p.land_speed
            } else {
                p.descend_speed
            },
            acceleration: p.acceleration,
            vertical_acceleration: p.vertical_acceleration,
            jerk: p.jerk,
        }
    }
}
