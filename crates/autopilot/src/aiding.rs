//! The sensing border of the outer loop: what barometer, compass and satellite receiver measured,
//! converted once into what the filter takes in.
//!
//! The inertial sensors' part of the border is [`crate::sensing`].

use windhover_estimator::measurement::{GnssPosition, GnssVelocity};
use windhover_math::geodesy::{GlobalPosition, LocalFrame};
use windhover_math::{Vector3, max};

use crate::sensing::BoardRotation;

/// One result of the barometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarometerSample {
    /// When it was measured, µs since start.
    pub time: u64,
    /// Pressure of the air, Pa, compensated by the part's own coefficients.
    pub pressure: f32,
}

/// One result of the compass as its registers hold it, in the part's own axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CompassSample {
    /// When it was measured, µs since start.
    pub time: u64,
    /// Raw counts.
    pub counts: [i16; 3],
}

/// What a satellite receiver says: fields and units of UBX-NAV-PVT (u-blox M10 interface
/// description).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GnssSample {
    /// When the message came, µs since start. It describes a moment before.
    pub time: u64,
    /// Latitude, longitude and altitude above mean sea level.
    pub position: GlobalPosition,
    /// Velocity over ground, NED, mm/s.
    pub velocity: [i32; 3],
    /// Declared error (1 σ) of the horizontal position, both axes together, mm.
    pub horizontal_accuracy: u32,
    /// Declared error (1 σ) of the altitude, mm.
    pub vertical_accuracy: u32,
    /// Declared error (1 σ) of the velocity, three axes together, mm/s.
    pub speed_accuracy: u32,
    /// 0 none, 2 flat, 3 three-dimensional; the rest is no fix.
    pub fix: u8,
    /// Satellites used.
    pub satellites: u8,
}

impl GnssSample {
    /// Whether it says where the vehicle is: a fix in three dimensions that declares an error
    /// below 25 m and 2 m/s, from a place on Earth.
    pub fn is_fix(&self) -> bool {
        self.fix == 3
            && self.satellites >= 5
            && (1..25_000).contains(&self.horizontal_accuracy)
            && (1..50_000).contains(&self.vertical_accuracy)
            && (1..2_000).contains(&self.speed_accuracy)
            && self.position.latitude.unsigned_abs() <= 900_000_000
            && self.position.longitude.unsigned_abs() <= 1_800_000_000
            && (-1_000_000..20_000_000).contains(&self.position.altitude)
            && self.velocity.iter().all(|axis| axis.unsigned_abs() < 200_000)
    }

    /// Position from the origin of `frame`, measured at `time`, µs.
    pub(crate) fn position(&self, frame: &LocalFrame, time: u64) -> GnssPosition {
        GnssPosition {
            time,
            position: frame.to_local(self.position),
            horizontal_deviation: self.horizontal_deviation(),
            vertical_deviation: max(0.01, self.vertical_accuracy as f32 * 1e-3),
        }
    }

    /// Standard deviation of north and of east, m.
    pub(crate) fn horizontal_deviation(&self) -> f32 {
        // of two axes together: each has 1/√2
        max(
            0.01,
            self.horizontal_accuracy as f32 * (1e-3 * core::f32::consts::FRAC_1_SQRT_2),
        )
    }

    /// Velocity, measured at `time`, µs.
    pub(crate) fn velocity(&self, time: u64) -> GnssVelocity {
        let [north, east, down] = self.velocity.map(|axis| axis as f32 * 1e-3);
        GnssVelocity {
            time,
            velocity: Vector3::new(north, east, down),
            // of three axes together: each has 1/√3
            deviation: max(0.02, self.speed_accuracy as f32 * (1e-3 * 0.577_350_3)),
        }
    }
}

/// How a compass sits in the vehicle, and what its counts are worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassFitting {
    /// µT per count.
    pub per_count: f32,
    /// Body axes as rows of the part's axes. A part whose axes are left-handed (IST8310) has one
    /// sign turned.
    pub rotation: BoardRotation,
}

impl Default for CompassFitting {
    /// An IST8310 with x and y along front and right: 3.3 counts per µT in its 14 bits (data
    /// sheet: sensitivity), and a z axis that points up, so that its axes are left-handed.
    fn default() -> Self {
        Self {
            per_count: 1.0 / 3.3,
            rotation: BoardRotation([[1, 0, 0], [0, 1, 0], [0, 0, -1]]),
        }
    }
}

impl CompassFitting {
    /// The field in body axes (FRD), µT, before calibration.
    pub fn field(&self, counts: [i16; 3]) -> Vector3 {
        let [x, y, z] = counts.map(|count| f32::from(count) * self.per_count);
        let along = |row: [i8; 3]| f32::from(row[0]) * x + f32::from(row[1]) * y + f32::from(row[2]) * z;
        let [front, right, down] = self.rotation.0;
        Vector3::new(along(front), along(right), along(down))
    }
}

/// R·L/g of the standard atmosphere (ISO 2533): gas constant of air, lapse rate, gravity.
const EXPONENT: f32 = 0.190_263_1;
/// Lapse rate of the standard atmosphere, K/m.
const LAPSE: f32 = 0.0065;
/// Temperature, K, and pressure, Pa, of the standard atmosphere at sea level.
const SEA_LEVEL: (f32, f32) = (288.15, 101_325.0);
/// What a barometer can show on Earth where something flies, Pa.
const PRESSURES: core::ops::RangeInclusive<f32> = 30_000.0..=110_000.0;

/// The pressure that heights are counted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureLevel {
    pressure: f32,
    /// Temperature there over the lapse rate, m.
    scale: f32,
}

impl PressureLevel {
    /// Heights count from where the pressure is `pressure`, Pa; `None` where nothing flies.
    pub fn new(pressure: f32) -> Option<Self> {
        PRESSURES.contains(&pressure).then(|| Self {
            pressure,
            scale: SEA_LEVEL.0 * (1.0 + power_less_one(pressure, SEA_LEVEL.1)) / LAPSE,
        })
    }

    /// Height above the level in the standard atmosphere, m; `None` for what is no pressure.
    pub fn height(&self, pressure: f32) -> Option<f32> {
        PRESSURES
            .contains(&pressure)
            .then(|| -self.scale * power_less_one(pressure, self.pressure))
    }
}

/// (p/q)^EXPONENT − 1, for pressures as above: to 2e-4 of itself at their ends, and better than 1e-5
/// within a factor of 2. Near 1 nothing cancels: at 100 kPa the last digit is 1 mm of height.
fn power_less_one(p: f32, q: f32) -> f32 {
    // ln(p/q) = 2 artanh((p − q)/(p + q)), of which the argument is at most 0.58
    let u = (p - q) / (p + q);
    let s = u * u;
    let logarithm = 2.0
        * u
        * (1.0 + s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0 + s * (1.0 / 9.0 + s * (1.0 / 11.0))))));
    let x = EXPONENT * logarithm;
    x * (1.0 + x * (1.0 / 2.0 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Height of the standard atmosphere above sea level, m, in double precision.
    fn altitude(pressure: f64) -> f64 {
        288.15 / 0.0065 * (1.0 - libm::pow(pressure / 101_325.0, 287.052_87 * 0.0065 / 9.806_65))
    }

    #[test]
    fn heights_are_those_of_the_standard_atmosphere() {
        for reference in [70_000.0, 95_600.0, 101_325.0, 104_000.0] {
            let level = PressureLevel::new(reference).unwrap();
            for step in -40..=40 {
                let pressure = reference + step as f32 * 250.0;
                let Some(height) = level.height(pressure) else {
                    continue;
                };
                let exact = altitude(pressure.into()) - altitude(reference.into());
                let error = f64::from(height) - exact;
                assert!(
                    error.abs() < 2e-3 + 2e-5 * exact.abs(),
                    "{reference} {pressure} {error}"
                );
            }
        }
    }

    #[test]
    fn the_power_is_as_exact_as_it_says() {
        for (ratio, most) in [(0.3, 1e-4), (0.5, 1e-5), (0.9, 1e-5), (1.1, 1e-5), (3.6, 2e-4)] {
            let exact = libm::pow(ratio, f64::from(EXPONENT)) - 1.0;
            let found = f64::from(power_less_one(30_000.0 * ratio as f32, 30_000.0));
            assert!((found / exact - 1.0).abs() < most, "{ratio}: {found} {exact}");
        }
    }

    #[test]
    fn what_is_no_pressure_is_no_height() {
        let level = PressureLevel::new(95_600.0).unwrap();
        for wrong in [f32::NAN, f32::INFINITY, -1.0, 0.0, 2e5] {
            assert_eq!(level.height(wrong), None);
            assert_eq!(PressureLevel::new(wrong), None);
        }
    }

    #[test]
    fn a_left_handed_part_shows_the_field_the_right_way_up() {
        let field = CompassFitting::default().field([33, -66, -99]);
        assert!((field - Vector3::new(10.0, -20.0, 30.0)).amax() < 1e-4);
    }

    fn fix() -> GnssSample {
        GnssSample {
            time: 1_000_000,
            position: GlobalPosition {
                latitude: 473_977_419,
                longitude: 85_455_938,
                altitude: 488_000,
            },
            velocity: [1000, -2000, 500],
            horizontal_accuracy: 1_414,
            vertical_accuracy: 2_500,
            speed_accuracy: 173,
            fix: 3,
            satellites: 14,
        }
    }

    #[test]
    fn a_fix_becomes_metres_from_the_origin_with_deviations_of_each_axis() {
        let sample = fix();
        assert!(sample.is_fix());
        let frame = LocalFrame::new(GlobalPosition {
            altitude: 480_000,
            ..sample.position
        });
        let position = sample.position(&frame, 880_000);
        assert_eq!(position.time, 880_000);
        assert!((position.position - Vector3::new(0.0, 0.0, -8.0)).amax() < 1e-4);
        assert!((position.horizontal_deviation - 1.0).abs() < 1e-3);
        let velocity = sample.velocity(880_000);
        assert_eq!(velocity.velocity, Vector3::new(1.0, -2.0, 0.5));
        assert!((velocity.deviation - 0.1).abs() < 1e-3);
    }

    #[test]
    fn what_is_no_fix_is_told() {
        let wrong: [fn(&mut GnssSample); 9] = [
            |s| s.fix = 2,
            |s| s.satellites = 3,
            |s| s.horizontal_accuracy = 0,
            |s| s.horizontal_accuracy = u32::MAX,
            |s| s.vertical_accuracy = 60_000,
            |s| s.speed_accuracy = 5_000,
            |s| s.position.latitude = i32::MIN,
            |s| s.position.altitude = 30_000_000,
            |s| s.velocity[2] = i32::MIN,
        ];
        for (index, spoil) in wrong.iter().enumerate() {
            let mut sample = fix();
            spoil(&mut sample);
            assert!(!sample.is_fix(), "{index}");
        }
    }
}
