//! The figures of a flight: how well the path was held, and at what cost.

use serde::Serialize;
use windhover_autopilot::MotorCommand;
use windhover_math::Vector3;

/// A figure for each axis of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Axes {
    /// North.
    pub north: f64,
    /// East.
    pub east: f64,
    /// Down.
    pub down: f64,
}

impl Axes {
    /// Length of the horizontal part.
    pub fn horizontal(&self) -> f64 {
        libm::hypot(self.north, self.east)
    }

    /// Length.
    pub fn length(&self) -> f64 {
        libm::hypot(self.horizontal(), self.down)
    }
}

impl From<Vector3<f64>> for Axes {
    fn from(v: Vector3<f64>) -> Self {
        Self {
            north: v.x,
            east: v.y,
            down: v.z,
        }
    }
}

/// One photo.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Photo {
    /// Number of the item in the mission that asked for it, counted from 1.
    pub item: usize,
    /// When, s.
    pub time_s: f64,
    /// Whether the vehicle stopped for it.
    pub stop: bool,
    /// Whether position and speed had settled by what the vehicle knew.
    pub settled: bool,
    /// True distance from the point where it was to be taken, m.
    pub position_error_m: f64,
    /// True speed at the shutter, m/s.
    pub speed_m_s: f64,
    /// True tilt at the shutter, degrees.
    pub tilt_deg: f64,
}

/// The figures of a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Whether the mission was flown to its end.
    pub completed: bool,
    /// How the flight ended, in a sentence.
    pub ended: String,
    /// From the start of the mission to its end, s.
    pub duration_s: f64,
    /// Waypoints that the vehicle came close enough to.
    pub waypoints_reached: usize,
    /// Photos in the order in which they were taken.
    pub photos: Vec<Photo>,
    /// Root mean square of true position less setpoint at the same tick, m.
    pub rmse_m: Axes,
    /// Largest magnitude of the same, m.
    pub max_error_m: Axes,
    /// Root mean square of what the receiver said of the position less the truth of that moment,
    /// m; nothing in flights on the truth.
    pub gnss_rmse_m: Option<Axes>,
    /// Root mean square of estimated less true position, m; nothing in flights on the truth.
    pub estimate_rmse_m: Option<Axes>,
    /// Root mean square of the errors of roll and pitch (of the vertical about two level axes),
    /// degrees.
    pub attitude_rmse_deg: Option<f64>,
    /// Root mean square of estimated less true heading, degrees.
    pub heading_rmse_deg: Option<f64>,
    /// Root mean square of the distance from the polyline of the mission, m.
    pub cross_track_rmse_m: f64,
    /// Largest true tilt, degrees.
    pub tilt_max_deg: f64,
    /// Share of the flight's ticks in which a rotor limit changed what control wanted.
    pub saturated_fraction: f64,
    /// Electrical energy, J.
    pub energy_j: f64,
    /// Simulated time over wall time.
    pub speed_factor: f64,
    /// What a board would log, bytes per second.
    pub log_bytes_per_s: f64,
    /// Hash of every motor command.
    pub motor_hash: String,
    /// What everything random followed from.
    pub seed: u64,
}

/// Sums up position errors.
#[derive(Clone, Copy, Debug, Default)]
pub struct ErrorSum {
    squares: Vector3<f64>,
    largest: Vector3<f64>,
    count: u64,
}

impl ErrorSum {
    /// Adds an error, m.
    pub fn add(&mut self, error: Vector3<f64>) {
        self.squares += error.component_mul(&error);
        self.largest = self
            .largest
            .zip_map(&error, |most, e| windhover_math::max(most, e.abs()));
        self.count += 1;
    }

    /// Root mean square.
    pub fn rms(&self) -> Axes {
        let count = windhover_math::max(self.count, 1) as f64;
        Axes::from(self.squares.map(|sum| (sum / count).sqrt()))
    }

    /// Root mean square, where there was anything.
    pub fn rms_of_any(&self) -> Option<Axes> {
        (self.count > 0).then(|| self.rms())
    }

    /// Largest magnitudes.
    pub fn largest(&self) -> Axes {
        Axes::from(self.largest)
    }
}

/// Sums up errors of one number.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScalarErrorSum {
    squares: f64,
    largest: f64,
    count: u64,
}

impl ScalarErrorSum {
    /// Adds an error.
    pub fn add(&mut self, error: f64) {
        self.squares += error * error;
        self.largest = windhover_math::max(self.largest, error.abs());
        self.count += 1;
    }

    /// Root mean square, where there was anything.
    pub fn rms_of_any(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.squares / self.count as f64).sqrt())
    }

    /// Largest magnitude.
    pub fn largest(&self) -> f64 {
        self.largest
    }
}

/// A hash over motor commands: equal for equal commands, and practically only then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorHash(u64);

impl Default for MotorHash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl MotorHash {
    /// Adds a command.
    #[inline]
    pub fn add(&mut self, command: MotorCommand) {
        let (kind, rotors) = match command {
            MotorCommand::Disarmed => (1, [0; 4]),
            MotorCommand::Idle(idle) => (2, [idle; 4]),
            MotorCommand::Run(rotors) => (3, rotors),
        };
        let word = rotors
            .iter()
            .fold(0u64, |word, &rotor| word << 16 | u64::from(rotor));
        // Rotate, mix, multiply by an odd constant (2^64 over the golden ratio).
        let mixed = self.0.rotate_left(29) ^ word ^ (kind << 61);
        self.0 = mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

impl std::fmt::Display for MotorHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // One last round, so that the last command reaches every digit.
        let spread = (self.0 ^ self.0 >> 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        write!(f, "{:016x}", spread ^ spread >> 29)
    }
}

/// Distance from a point to a polyline, m.
pub fn distance_to_polyline(point: Vector3<f64>, corners: &[Vector3<f64>]) -> f64 {
    let to_segment = |pair: &[Vector3<f64>]| {
        let (a, b) = (pair[0], pair[1]);
        let (way, length_squared) = (b - a, (b - a).dot(&(b - a)));
        let share = if length_squared > 0.0 {
            (point - a).dot(&way) / length_squared
        } else {
            0.0
        };
        let off = point - a - way * share.clamp(0.0, 1.0);
        off.dot(&off)
    };
    let least = corners
        .windows(2)
        .map(to_segment)
        .fold(f64::INFINITY, windhover_math::min);
    if least.is_finite() { least.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rms_and_largest() {
        let mut sum = ErrorSum::default();
        sum.add(Vector3::new(3.0, 0.0, -1.0));
        sum.add(Vector3::new(-4.0, 0.0, 1.0));
        assert_eq!(
            sum.rms(),
            Axes {
                north: 12.5f64.sqrt(),
                east: 0.0,
                down: 1.0
            }
        );
        assert_eq!(
            sum.largest(),
            Axes {
                north: 4.0,
                east: 0.0,
                down: 1.0
            }
        );
    }

    #[test]
    fn distance_to_corners_and_segments() {
        let corners = [
            Vector3::zeros(),
            Vector3::new(10.0, 0.0, 0.0),
            Vector3::new(10.0, 10.0, 0.0),
        ];
        assert_eq!(distance_to_polyline(Vector3::new(5.0, -2.0, 0.0), &corners), 2.0);
        assert_eq!(distance_to_polyline(Vector3::new(13.0, -4.0, 0.0), &corners), 5.0);
        assert_eq!(distance_to_polyline(Vector3::new(1.0, 1.0, 1.0), &[]), 0.0);
    }

    #[test]
    fn every_bit_of_every_command_reaches_the_hash() {
        let hash = |commands: &[MotorCommand]| {
            let mut hash = MotorHash::default();
            commands.iter().for_each(|command| hash.add(*command));
            hash.to_string()
        };
        let base = [
            MotorCommand::Idle(7),
            MotorCommand::Run([1, 2, 3, 4]),
            MotorCommand::Disarmed,
        ];
        let mut seen = vec![hash(&base)];
        for bit in 0..64 {
            let mut rotors = [1u16, 2, 3, 4];
            rotors[bit / 16] ^= 1 << (bit % 16);
            seen.push(hash(&[base[0], MotorCommand::Run(rotors), base[2]]));
            seen.push(hash(&[base[0], base[2], MotorCommand::Run(rotors)]));
        }
        seen.push(hash(&[MotorCommand::Run([7; 4]), base[1], base[2]]));
        let count = seen.len();
        seen.sort();
        seen.dedup();
        assert_eq!(seen.len(), count);
    }
}
