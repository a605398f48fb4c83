//! Rally points: places to return to that lie nearer than home.

use heapless::Vec;
use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};

use super::ground;
use super::items::{FenceRefusal, command};
use super::shape::squared;
use crate::mission::action::place;
use crate::mission::{MissionSource, PlanKind};

/// The most rally points.
pub const MAX_RALLY: usize = 8;

/// A place to return to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RallyPoint {
    /// Where it is, NED, m; down is that of the altitude its item gives.
    pub position: Vector3,
}

/// The rally points in the local frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rally {
    points: Vec<RallyPoint, MAX_RALLY>,
}

impl Rally {
    /// The rally points of the `count` items in a slot, in metres of `frame`; or the item, counted
    /// from 0, for which they are refused.
    pub fn compile<S: MissionSource + ?Sized>(
        source: &S,
        slot: u8,
        count: u16,
        frame: &LocalFrame,
    ) -> Result<Self, (u16, FenceRefusal)> {
        let mut rally = Self::default();
        for index in 0..count {
            let refuse = |refusal| (index, refusal);
            let item = source.item(PlanKind::Rally, slot, index);
            let item = item.ok_or(refuse(FenceRefusal::Missing))?;
            if item.command != command::RALLY_POINT {
                return Err(refuse(FenceRefusal::Command(item.command)));
            }
            let place = place(&item).map_err(|refusal| refuse(FenceRefusal::Place(refusal)))?;
            let position = place.local(frame, Vector3::zeros());
            let room = rally.points.push(RallyPoint { position });
            room.map_err(|_| refuse(FenceRefusal::TooManyRallyPoints))?;
        }
        Ok(rally)
    }

    /// Refuses rally points before they are accepted, when home need not be known yet.
    pub fn check<S: MissionSource + ?Sized>(
        source: &S,
        slot: u8,
        count: u16,
    ) -> Result<(), (u16, FenceRefusal)> {
        let anywhere = LocalFrame::new(GlobalPosition::default());
        Self::compile(source, slot, count, &anywhere).map(|_| ())
    }

    /// The rally point that is nearest to a position, NED in m, over ground.
    pub fn nearest(&self, position: Vector3) -> Option<RallyPoint> {
        let distance = |to: &RallyPoint| squared(ground(to.position) - ground(position));
        let nearer = |a: RallyPoint, b: RallyPoint| if distance(&b) < distance(&a) { b } else { a };
        self.points.iter().copied().reduce(nearer)
    }

    /// Where to return to from a position, NED in m: home, or the nearest rally point if that is
    /// nearer over ground.
    pub fn destination(&self, position: Vector3, home: Vector3) -> Vector3 {
        let here = ground(position);
        match self.nearest(position) {
            Some(RallyPoint { position })
                if squared(ground(position) - here) < squared(ground(home) - here) =>
            {
                position
            }
            _ => home,
        }
    }
}
