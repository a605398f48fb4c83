//! What the motors' current adds to the compass, learned in the first seconds of flight.
//!
//! The cables' field turns with the body and grows with the current, which for rotors is the
//! thrust to the power 3/2. On the ground with the motors off the compass shows the Earth's field
//! alone; when the vehicle has just left the ground its attitude is still known by the gyros to a
//! tenth of a degree. What the compass then shows besides is the interference: three unknowns,
//! fitted by least squares. Until that is done the compass is not used.

use windhover_math::{Quaternion, Vector3, scalar, sqrt};

/// Time in the air that the fit takes, s.
const LEARNING: f32 = 8.0;
/// The Earth's field keeps its strength to this share.
const STRENGTH: f32 = 0.12;
/// What the motors add changes by less from one sample to the next, µT.
const SUDDEN: f32 = 8.0;
/// From this load on the vehicle counts as carried by its rotors.
const CARRIED: f32 = 0.5;
/// An interference beyond this is a fault of the compass, µT: as much as the Earth's field.
const LARGEST: f32 = 60.0;

/// The interference as far as it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interference {
    /// The Earth's field as the compass showed it on the ground, NED, µT.
    earth: Option<Vector3>,
    /// Time in the air so far, s.
    learned_for: f32,
    /// Sums of the fit: load squared, and load times what is not the Earth's, body, µT.
    squares: f32,
    products: Vector3,
    /// Body (FRD), µT at hover load.
    per_load: Vector3,
}

/// The current by the thrust, relative to hovering: (thrust/weight)^(3/2).
pub(super) fn load(thrust: f32, weight: f32) -> f32 {
    let share = thrust / weight;
    if (0.0..4.0).contains(&share) {
        share * sqrt(share)
    } else {
        0.0
    }
}

impl Interference {
    /// The vehicle stands still with its motors off: `field` (body, µT) is the Earth's alone.
    /// What was learned in an earlier flight stays.
    pub(super) fn refer(&mut self, attitude: Quaternion, field: Vector3) {
        self.earth = Some(attitude.rotate(field));
    }

    /// What was taken for north has a bearing of `angle`, rad, east positive.
    pub(super) fn turn(&mut self, angle: f32) {
        if let Some(earth) = &mut self.earth {
            *earth = Quaternion::from_heading(angle).rotate(*earth);
        }
    }

    /// Whether the compass may be used.
    pub(super) fn is_known(&self) -> bool {
        self.learned_for >= LEARNING || self.earth.is_none()
    }

    /// Takes in a field (body, µT) at this attitude and load, `dt` seconds after the last one.
    /// The field without the interference, once that is known.
    pub(super) fn correct(
        &mut self,
        field: Vector3,
        attitude: Quaternion,
        load: f32,
        dt: f32,
    ) -> Option<Vector3> {
        let Some(earth) = self.earth else {
            return Some(field);
        };
        if self.is_known() {
            let own = field - self.per_load * load;
            let off = scalar::norm(own) - scalar::norm(earth);
            return (off.abs() < STRENGTH * scalar::norm(earth)).then_some(own);
        }
        if load < CARRIED {
            // On the ground the motors idle: what they add there is little.
            return (self.learned_for == 0.0).then_some(field);
        }
        let more = field - attitude.inverse_rotate(earth);
        if self.squares > 0.0 && scalar::norm(more - self.products * (load / self.squares)) > SUDDEN {
            // It has changed all at once: what was learned so far was something else.
            *self = Self {
                earth: self.earth,
                ..Self::default()
            };
        }
        self.squares += load * load;
        self.products += more * load;
        self.learned_for += dt;
        if self.is_known() {
            let fitted = self.products / self.squares;
            self.per_load = if scalar::norm(fitted) <= LARGEST {
                fitted
            } else {
                Vector3::zeros()
            };
        }
        None
    }

    /// What the motors add at hover, body (FRD), µT.
    pub fn per_load(&self) -> Vector3 {
        self.per_load
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windhover_math::{Euler, sin};

    const EARTH: Vector3 = Vector3::new(21.0, 1.3, 43.0);
    const ADDED: Vector3 = Vector3::new(-6.0, 9.0, 4.0);

    fn attitude(time: f32) -> Quaternion {
        Quaternion::from_euler(Euler {
            roll: 0.1 * sin(2.0 * time),
            pitch: 0.1 * sin(1.3 * time),
            yaw: 0.7 + 0.3 * sin(0.5 * time),
        })
    }

    /// The fields corrected in a flight of `seconds`, with the largest error of any.
    fn fly(interference: &mut Interference, seconds: f32) -> (usize, f32) {
        let (mut time, mut corrected, mut worst) = (0.0, 0, 0.0);
        while time < seconds {
            let (q, load) = (attitude(time), 1.0 + 0.2 * sin(3.0 * time));
            let earth = q.inverse_rotate(EARTH);
            if let Some(field) = interference.correct(earth + ADDED * load, q, load, 0.02) {
                corrected += 1;
                worst = windhover_math::max(worst, scalar::norm(field - earth));
            }
            time += 0.02;
        }
        (corrected, worst)
    }

    #[test]
    fn after_some_seconds_of_flight_the_motors_are_taken_off() {
        let mut interference = Interference::default();
        interference.refer(attitude(0.0), attitude(0.0).inverse_rotate(EARTH));
        assert_eq!(
            fly(&mut interference, 7.5),
            (0, 0.0),
            "not used while it is learned"
        );
        let (corrected, worst) = fly(&mut interference, 10.0);
        assert!(corrected > 400 && worst < 0.02, "{corrected} {worst}");
        assert!(scalar::norm(interference.per_load() - ADDED) < 0.02);
    }

    #[test]
    fn a_field_of_another_strength_is_not_the_earths() {
        let mut interference = Interference::default();
        interference.refer(attitude(0.0), attitude(0.0).inverse_rotate(EARTH));
        fly(&mut interference, 10.0);
        let wrong = attitude(0.0).inverse_rotate(EARTH * 1.5) + ADDED;
        assert_eq!(interference.correct(wrong, attitude(0.0), 1.0, 0.02), None);
    }

    #[test]
    fn a_fault_while_learning_is_not_learned() {
        let mut interference = Interference::default();
        interference.refer(attitude(0.0), attitude(0.0).inverse_rotate(EARTH));
        fly(&mut interference, 3.0);
        let q = attitude(0.0);
        let iron = Vector3::new(20.0, 20.0, 20.0);
        for _ in 0..100 {
            interference.correct(q.inverse_rotate(EARTH) + ADDED + iron, q, 1.0, 0.02);
        }
        fly(&mut interference, 10.0);
        assert!(scalar::norm(interference.per_load() - ADDED) < 0.02);
    }

    #[test]
    fn without_a_reference_the_field_is_taken_as_it_is() {
        let mut interference = Interference::default();
        assert_eq!(interference.correct(EARTH, attitude(0.0), 1.0, 0.02), Some(EARTH));
    }

    #[test]
    fn a_load_that_is_no_number_is_none() {
        assert_eq!(load(f32::NAN, 6.0), 0.0);
        assert_eq!(load(6.0, 0.0), 0.0);
        assert!((load(6.0, 6.0) - 1.0).abs() < 1e-6);
    }
}
