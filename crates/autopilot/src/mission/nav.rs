//! The points that a mission is flown to, found by looking ahead.

use windhover_math::geodesy::LocalFrame;
use windhover_math::{Vector3, min};

use super::action::{Action, Altitude, Place};
use super::route::{Cursor, Stored};
use super::{MissionParameters, MissionSource};
use crate::mode::Mode;
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
    /// Above the place of the landing that the mission names.
    Approach,
    /// None: the mission ends here, and this mode follows.
    End(Mode),
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

/// What looking ahead needs.
pub struct Chart<'a, S: ?Sized> {
    /// The stored missions.
    pub source: &'a S,
    /// Which of them is flown.
    pub stored: Stored,
    /// The local frame.
    pub frame: &'a LocalFrame,
    /// Home, NED, m from the frame's origin: altitudes of items count from it.
    pub home: Vector3,
    /// Speeds, radii, heights.
    pub parameters: &'a MissionParameters,
}

impl<S: MissionSource + ?Sized> Chart<'_, S> {
    /// Where the mission begins, before the item with index `first`; `None` when there is nothing to
    /// fly to.
    pub fn start(&self, first: u16, position: Vector3, landed: bool) -> Option<Nav> {
        let start = Nav {
            item: 0,
            kind: NavKind::Start { landed },
            target: position,
            hold: 0.0,
            radius: self.parameters.acceptance_radius,
            heading: None,
            speed: None,
            rest_before: false,
            after: Cursor::before(first),
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
        match nav.kind {
            NavKind::Start { landed } => self.first(nav, landed),
            NavKind::Approach => Some(Nav {
                kind: NavKind::End(Mode::Land),
                ..*nav
            }),
            NavKind::End(_) => None,
            _ => self.next(nav.after, nav.target, nav.speed),
        }
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
                // A vehicle that is higher already stays there.
                target: Vector3::new(from.x, from.y, min(self.down(*altitude), from.z)),
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
            Action::Return => Nav {
                kind: NavKind::End(Mode::Return),
                ..plain
            },
            _ => Nav {
                kind: NavKind::End(Mode::Land),
                ..plain
            },
        }
    }

    fn down(&self, altitude: Altitude) -> f32 {
        altitude.down(self.frame, self.home)
    }

    /// Where a place is in the local frame, NED, m.
    pub fn local(&self, place: &Place) -> Vector3 {
        place.local(self.frame, self.home)
    }

    /// Speeds and accelerations of the leg to `nav`.
    pub fn limits(&self, nav: &Nav, landed: bool) -> Limits {
        let p = self.parameters;
        Limits {
            speed: nav.speed.unwrap_or(p.cruise_speed),
            climb: if landed { p.takeoff_speed } else { p.climb_speed },
            descend: p.descend_speed,
            acceleration: p.acceleration,
            vertical_acceleration: p.vertical_acceleration,
            jerk: p.jerk,
        }
    }
}
