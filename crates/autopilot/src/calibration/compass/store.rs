//! The samples that a fit is made from: few, spread out, and none alone in time.

use windhover_math::Vector3;

/// Most samples that are kept.
pub(super) const CAPACITY: usize = 160;
/// Distance between kept samples at first, µT: a weak field of 22 µT then gives about a hundred.
const FIRST_DISTANCE: f32 = 4.0;
/// What the distance grows by when the store is full.
const GROWTH: f32 = 1.25;
/// A sample agrees with another next to it in time within this, µT: at 50 samples a second, turning
/// by 3 rad/s in a field of 65 µT, two of them are 4 µT apart.
const AGREEMENT: f32 = 8.0;
/// Samples are averaged with those next to them in time within this, µT: on a sphere of 25 µT the
/// mean lies deeper than the surface by less than a half per cent.
const NEARNESS: f32 = 2.5;
/// Of the two before and the two after, so many must agree.
const LEAST_AGREEING: usize = 2;

/// See the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Store {
    /// The last ones, the newest last.
    recent: [Vector3; 5],
    /// How many of `recent` there are.
    seen: u8,
    kept: [Vector3; CAPACITY],
    count: usize,
    distance: f32,
    /// Running share of samples that agree with too few.
    alone: f32,
}

impl Store {
    pub(super) fn new() -> Self {
        Self {
            recent: [Vector3::zeros(); 5],
            seen: 0,
            kept: [Vector3::zeros(); CAPACITY],
            count: 0,
            distance: FIRST_DISTANCE,
            alone: 0.0,
        }
    }

    /// The kept ones.
    pub(super) fn samples(&self) -> &[Vector3] {
        self.kept.get(..self.count).unwrap_or(&[])
    }

    /// Whether most samples lie far from those before and after.
    pub(super) fn is_too_fast(&self) -> bool {
        self.alone > 0.5
    }

    /// Takes in a sample; whether the kept ones have changed by it.
    pub(super) fn offer(&mut self, field: Vector3) -> bool {
        self.recent.rotate_left(1);
        if let Some(newest) = self.recent.last_mut() {
            *newest = field;
        }
        self.seen = windhover_math::min(self.seen + 1, 5);
        if self.seen < 5 {
            return false;
        }
        let [a, b, middle, d, e] = self.recent;
        let near = |other: &Vector3| square(other - middle) < AGREEMENT * AGREEMENT;
        let agreeing = [a, b, d, e].iter().filter(|other| near(other)).count();
        let agrees = agreeing >= LEAST_AGREEING;
        self.alone += 0.05 * (if agrees { 0.0 } else { 1.0 } - self.alone);
        agrees && self.keep(self.mean_about(middle))
    }

    /// Mean of the recent ones that lie as near to this one as a slow turn takes them.
    fn mean_about(&self, middle: Vector3) -> Vector3 {
        let (mut sum, mut count) = (Vector3::zeros(), 0.0);
        for field in &self.recent {
            if square(field - middle) <= NEARNESS * NEARNESS {
                sum += field - middle;
                count += 1.0;
            }
        }
        middle + sum / windhover_math::max(count, 1.0)
    }

    /// Keeps a sample that is far from all others.
    fn keep(&mut self, field: Vector3) -> bool {
        if !is_apart(field, self.samples(), self.distance) {
            return false;
        }
        if self.count >= CAPACITY {
            self.thin();
            if !is_apart(field, self.samples(), self.distance) {
                return true;
            }
        }
        if let Some(place) = self.kept.get_mut(self.count) {
            *place = field;
            self.count += 1;
        }
        true
    }

    /// Leaves out samples so that the rest lie farther apart.
    fn thin(&mut self) {
        self.distance *= GROWTH;
        let all = self.kept;
        self.count = 0;
        for field in all {
            if is_apart(field, self.samples(), self.distance)
                && let Some(place) = self.kept.get_mut(self.count)
            {
                *place = field;
                self.count += 1;
            }
        }
    }
}

/// Square of the length.
pub(super) fn square(v: Vector3) -> f32 {
    v.dot(&v)
}

fn is_apart(field: Vector3, from: &[Vector3], distance: f32) -> bool {
    from.iter()
        .all(|other| square(field - other) >= distance * distance)
}
