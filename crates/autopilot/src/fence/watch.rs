//! Whether the vehicle is outside of the fence, or cannot stop inside any more unless it brakes
//! now.
//!
//! The stopping point lies ahead by v·t + v²/(2a): the way until the brakes act, and the way of
//! braking. Not that point alone is looked at but the whole way to it, so that no exclusion is too
//! thin to be seen. The margin comes on top; a vehicle that hardly moves has no direction, so up
//! to 1 m/s the margin grows with the speed.

use windhover_math::{Vector3, max, min};

use super::shape::{Point, length};
use super::{Fence, FenceParameters, ground};

/// From this speed on the whole margin is kept, m/s.
const MARGIN_SPEED: f32 = 1.0;

/// The least acceleration that is believed, m/s².
const LEAST_ACCELERATION: f32 = 0.1;

/// What lies outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BreachKind {
    /// All inclusions are left.
    Boundary,
    /// An exclusion is entered.
    Exclusion,
    /// Further from home than the parameter allows.
    Distance,
    /// Higher above home than the parameter allows.
    Altitude,
}

/// The vehicle is outside, or will be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Breach {
    /// What of.
    pub kind: BreachKind,
    /// Whether it is still inside, and has to brake now to stay there.
    pub predicted: bool,
}

impl Fence {
    /// Whether the vehicle is outside, or has to brake now. `home`, from which the parameters' limits
    /// count, `position` and `velocity` are NED in m and m/s; `acceleration` is what it brakes with,
    /// m/s²; `reaction_time` is how long it flies on before, s.
    pub fn watch(
        &self,
        parameters: &FenceParameters,
        home: Vector3,
        position: Vector3,
        velocity: Vector3,
        acceleration: f32,
        reaction_time: f32,
    ) -> Option<Breach> {
        let now = limits(parameters, position - home).or_else(|| self.breach_at(ground(position)));
        if let Some(kind) = now {
            let predicted = false;
            return Some(Breach { kind, predicted });
        }
        if !parameters.predicts() {
            return None;
        }
        let ahead = |speed: f32| {
            let braking = speed * speed / (2.0 * max(acceleration, LEAST_ACCELERATION));
            speed * reaction_time + braking + parameters.margin * min(speed / MARGIN_SPEED, 1.0)
        };
        let over_ground = ground(velocity);
        let speed = length(over_ground);
        let along = if speed > 0.0 {
            over_ground * (ahead(speed) / speed)
        } else {
            Point::zeros()
        };
        // Downwards there is no limit.
        let climb = ahead(max(-velocity.z, 0.0));
        let stop = position + Vector3::new(along.x, along.y, -climb);
        let ahead = || self.breach_ahead(ground(position), ground(stop));
        let kind = limits(parameters, stop - home).or_else(ahead)?;
        let predicted = true;
        Some(Breach { kind, predicted })
    }

    /// Whether the straight way between two positions, NED in m, leaves the fence, enters an
    /// exclusion or goes beyond a limit of the parameters anywhere, its ends included. What is
    /// thinner than a centimetre does not count.
    pub fn leaves(&self, parameters: &FenceParameters, home: Vector3, from: Vector3, to: Vector3) -> bool {
        // Distance and height are convex: the ends decide.
        limits(parameters, from - home)
            .or_else(|| limits(parameters, to - home))
            .or_else(|| self.breach_at(ground(from)))
            .or_else(|| self.breach_ahead(ground(from), ground(to)))
            .is_some()
    }
}

/// What of the parameters a position, counted from home, is beyond.
fn limits(parameters: &FenceParameters, position: Vector3) -> Option<BreachKind> {
    let beyond = |limit: f32, value: f32| limit > 0.0 && value > limit;
    if beyond(parameters.altitude_max, -position.z) {
        Some(BreachKind::Altitude)
    } else if beyond(parameters.distance_max, length(ground(position))) {
        Some(BreachKind::Distance)
    } else {
        None
    }
}
