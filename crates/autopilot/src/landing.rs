//! Whether the vehicle is on the ground: from thrust, force, speed and time.
//!
//! A vehicle on the ground whose rotors give much less than its weight is pushed up by the ground:
//! the accelerometer shows gravity's reaction though the thrust does not explain it. In the air that
//! lasts for no longer than a gust, since whatever is not held up falls. It has left the ground when
//! its height says so, or where that is not known, when the rotors give more than its weight.

use windhover_math::{GRAVITY, Vector3, scalar};

use crate::estimation::Estimate;
use crate::inner::Snapshot;

/// Thrust on the ground is below this share of what the vehicle hovers with.
const THRUST: f32 = 0.4;
/// Time constant with which that is learnt in flight, s: nobody may have told the true mass.
const LEARNING: f32 = 3.0;
/// How far the specific force may be from gravity's, m/s².
const FORCE: f32 = 1.5;
/// Vertical and horizontal speed of a vehicle that stands, m/s.
const SPEED: (f32, f32) = (0.3, 1.0);
/// Rate at which it does not turn, rad/s.
const RATE: f32 = 0.5;
/// How long all that lasts, s: a fall over this time is faster than [`SPEED`].
const LANDED_AFTER: f32 = 0.6;
/// Where the accelerometer shows nothing it takes longer: no controller lets the vehicle fall so long.
const BLIND_AFTER: f32 = 1.0;
/// Time constant of the means, s.
const SMOOTHING: f32 = 0.1;

/// Above the place of arming by so much, the vehicle flies, m.
const AIRBORNE_HEIGHT: f32 = 0.3;
/// More thrust than the weight for so long, and it flies, s; counted where the height is not known.
const AIRBORNE_AFTER: f32 = 0.1;

/// The detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandDetector {
    landed: bool,
    /// Height of the ground where it stands or stood last, down, m.
    ground: f32,
    /// For how long it seems to stand, or to lift, s.
    since: f32,
    /// The thrust that the vehicle hovers with, N.
    hover: f32,
    /// Means of the thrust, N, and of the specific force, FRD, m/s².
    thrust: f32,
    force: Vector3,
    /// The accelerometer shows nothing.
    blind: bool,
}

impl Default for LandDetector {
    fn default() -> Self {
        Self {
            landed: true,
            ground: 0.0,
            since: 0.0,
            hover: 0.0,
            thrust: 0.0,
            force: Vector3::new(0.0, 0.0, -GRAVITY),
            blind: false,
        }
    }
}

impl LandDetector {
    /// Whether the vehicle is on the ground.
    #[inline]
    pub fn is_landed(&self) -> bool {
        self.landed
    }

    /// Size of the specific force, smoothed, m/s².
    #[inline]
    pub fn force(&self) -> f32 {
        scalar::norm(self.force)
    }

    /// Whether the accelerometer showed nothing at the last step.
    #[inline]
    pub fn is_blind(&self) -> bool {
        self.blind
    }

    /// The vehicle stands here, `down` m below the origin.
    pub fn stand(&mut self, down: f32) {
        *self = Self {
            ground: down,
            ..Self::default()
        };
    }

    /// The thrust that the vehicle hovers with, N, as far as it has been learnt.
    #[inline]
    pub fn hover(&self) -> f32 {
        self.hover
    }

    /// One step of a vehicle whose motors turn. `weight` in N, as the parameters have it.
    pub fn step(&mut self, snapshot: &Snapshot, estimate: &Estimate, weight: f32) {
        let increments = &snapshot.increments;
        let dt = increments.duration;
        if dt <= 0.0 {
            return;
        }
        let share = dt / (dt + SMOOTHING);
        let per_second = 1.0 / dt;
        self.thrust += (increments.thrust * per_second - self.thrust) * share;
        if self.landed || self.hover <= 0.0 {
            self.hover = weight;
        } else if self.thrust > THRUST * self.hover {
            self.hover += (self.thrust - self.hover) * (dt / (dt + LEARNING));
        }
        self.force += (increments.velocity * per_second - self.force) * share;
        self.blind = increments.blind > 0;
        let changes = if self.landed {
            self.lifts(estimate)
        } else {
            self.thrust < THRUST * self.hover && self.stands(snapshot, estimate, per_second)
        };
        self.since = if changes { self.since + dt } else { 0.0 };
        let enough = if !self.landed {
            if self.blind { BLIND_AFTER } else { LANDED_AFTER }
        } else if estimate.known.height {
            0.0
        } else {
            AIRBORNE_AFTER
        };
        if changes && self.since > enough {
            self.landed = !self.landed;
            self.since = 0.0;
            // The ground is here, whatever the height says: it may have gone wrong in flight.
            self.ground = estimate.position.z;
        }
    }

    fn lifts(&self, estimate: &Estimate) -> bool {
        if estimate.known.height {
            estimate.position.z < self.ground - AIRBORNE_HEIGHT
        } else {
            self.thrust > self.hover
        }
    }

    fn stands(&self, snapshot: &Snapshot, estimate: &Estimate, per_second: f32) -> bool {
        let velocity = &estimate.velocity;
        // An accelerometer that shows nothing says nothing of the ground either, and the velocity is
        // that of a fall that the receiver takes back ten times a second: the thrust has to do.
        if self.blind && estimate.known.height {
            return true;
        }
        let still_upright = !estimate.known.height || velocity.z.abs() < SPEED.0;
        let still_flat =
            !estimate.known.position || velocity.x * velocity.x + velocity.y * velocity.y < SPEED.1 * SPEED.1;
        let turn = snapshot.increments.rotation.shortest();
        let rate = 2.0 * per_second * scalar::norm(Vector3::new(turn.x, turn.y, turn.z));
        let held = (scalar::norm(self.force) - GRAVITY).abs() < FORCE;
        held && still_upright && still_flat && rate < RATE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::Known;
    use crate::io::Increments;
    use crate::queue::OuterInputs;
    use proptest::prelude::*;

    const DT: f32 = 0.004;
    const WEIGHT: f32 = 6.4;

    /// A body that moves up and down under thrust, with a ground at `floor` m below.
    struct Body {
        detector: LandDetector,
        height: f32,
        climb: f32,
        knows_height: bool,
        /// What the estimated height is off by, m.
        offset: f32,
        noise: u32,
    }

    impl Body {
        fn flying(height: f32) -> Self {
            let mut body = Self::standing();
            body.height = height;
            body.detector.landed = false;
            body.detector.thrust = WEIGHT;
            body.detector.hover = WEIGHT;
            body
        }

        fn standing() -> Self {
            Self {
                detector: LandDetector::default(),
                height: 0.0,
                climb: 0.0,
                knows_height: true,
                offset: 0.0,
                noise: 1,
            }
        }

        fn random(&mut self) -> f32 {
            self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (self.noise >> 8) as f32 / 8_388_608.0 - 1.0
        }

        /// One step with a thrust as a share of the weight.
        fn step(&mut self, thrust: f32, shaking: f32) -> bool {
            let force = if self.height <= 0.0 && self.climb <= 0.0 && thrust < 1.0 {
                self.climb = 0.0;
                GRAVITY
            } else {
                self.climb += (thrust - 1.0) * GRAVITY * DT;
                self.height += self.climb * DT;
                thrust * GRAVITY
            };
            let shaken = force + shaking * self.random();
            let snapshot = Snapshot {
                tick: 0,
                time: 0,
                increments: Increments {
                    velocity: Vector3::new(shaking * self.random(), 0.0, -shaken) * DT,
                    duration: DT,
                    thrust: thrust * WEIGHT * DT,
                    ..Increments::default()
                },
                stopped: None,
                inputs: OuterInputs::default(),
            };
            let estimate = Estimate {
                position: Vector3::new(0.0, 0.0, -self.height - self.offset),
                velocity: Vector3::new(0.0, 0.0, -self.climb),
                known: Known {
                    attitude: true,
                    heading: true,
                    height: self.knows_height,
                    position: self.knows_height,
                },
                ..Estimate::default()
            };
            self.detector.step(&snapshot, &estimate, WEIGHT);
            self.detector.is_landed()
        }
    }

    proptest! {
        /// However the thrust is moved in the air, free fall and thrust noise included: no landing.
        #[test]
        fn no_flight_is_a_landing(
            thrusts in prop::collection::vec((0.0f32..2.0, 10u32..400), 1..12), noise in 0.0f32..1.0, known in any::<bool>(),
        ) {
            let mut body = Body::flying(10_000.0);
            body.knows_height = known;
            for (thrust, steps) in thrusts {
                for _ in 0..steps {
                    let noisy = windhover_math::max(0.0, thrust + noise * body.random());
                    prop_assert!(!body.step(noisy, 5.0), "landed at {thrust} of the weight");
                }
            }
        }

        /// On the ground with little thrust it has landed within a second and a half, shaken or not.
        #[test]
        fn every_landing_is_noticed(thrust in 0.0f32..0.3, noise in 0.0f32..0.3, known in any::<bool>()) {
            let mut body = Body::flying(0.0);
            body.knows_height = known;
            let landed = (0..375).any(|_| {
                let noisy = windhover_math::max(0.0, thrust + noise * body.random());
                body.step(noisy, 4.0)
            });
            prop_assert!(landed);
        }
    }

    /// A height that has gone wrong in flight, by a barometer's step, does not lift the vehicle off
    /// again as soon as it has landed.
    #[test]
    fn a_landing_at_a_wrong_height_stays_one() {
        let mut body = Body::flying(0.0);
        body.offset = 5.0;
        assert!((0..375).any(|_| body.step(0.1, 1.0)));
        assert!((0..1000).all(|_| body.step(0.1, 1.0)));
    }

    #[test]
    fn a_takeoff_is_noticed_with_and_without_a_height() {
        for known in [false, true] {
            let mut body = Body::standing();
            body.knows_height = known;
            for _ in 0..250 {
                assert!(body.step(0.8, 1.0), "still on the ground");
            }
            let steps = (0..500).find(|_| !body.step(1.2, 1.0));
            assert!(steps.is_some_and(|steps| steps < 250), "{steps:?}");
        }
    }
}
