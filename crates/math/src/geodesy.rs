//! Positions on the Earth as integers, differences between them as metres.
//!
//! Degrees do not fit an `f32`: its spacing at 180° is 1.7 m. Here global positions are
//! integers throughout; the difference from an origin is taken in integers, exactly, and only the
//! difference becomes an `f32` in metres.
//!
//! A [`LocalFrame`] is a plane: north and east are those of the WGS84 ellipsoid's tangent plane
//! at the origin, to second order in the distance. Down is not the tangent plane's: it is the
//! difference in altitude, which is what a barometer measures and a pilot means (at 10 km the
//! Earth has fallen 8 m below the plane).
//!
//! Measured against the ellipsoid itself, for latitudes within ±80°:
//!
//! | distance | horizontal error below |
//! |---|---|
//! | 1 km | 2 mm |
//! | 10 km | 0.15 m |
//!
//! The plane is at the origin's altitude: a vehicle 100 m above it moves by 1.6e-5 of the way
//! more than the coordinates say, as much as not knowing the geoid's height makes.

use core::f32::consts::PI;

use nalgebra::Vector3;

use crate::{max, sin_cos, sqrt};

/// Radians in 1e-7 degrees.
const UNIT: f32 = PI / 1.8e9;

/// Half a turn in 1e-7 degrees.
const HALF_TURN: i64 = 1_800_000_000;

/// A right angle in 1e-7 degrees.
const POLE: i32 = 900_000_000;

/// Semi-major axis of the WGS84 ellipsoid in m.
const EQUATOR_RADIUS: f32 = 6_378_137.0;

/// First eccentricity of the WGS84 ellipsoid, squared.
const ECCENTRICITY_SQUARED: f32 = 6.694_38e-3;

/// The smallest radius of a circle of latitude to divide by, in m. Nearer to a pole than this
/// east and west mean nothing to a plane.
const SMALLEST_PARALLEL: f32 = 1_000.0;

/// A position on the Earth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GlobalPosition {
    /// WGS84 latitude in 1e-7 degrees, north positive.
    pub latitude: i32,
    /// WGS84 longitude in 1e-7 degrees, east positive.
    pub longitude: i32,
    /// Altitude above mean sea level in mm.
    pub altitude: i32,
}

/// North, east and down in metres from an origin.
///
/// ```
/// use windhover_math::geodesy::{GlobalPosition, LocalFrame};
/// let home = GlobalPosition { latitude: 473_977_418, longitude: 85_455_938, altitude: 488_000 };
/// let frame = LocalFrame::new(home);
/// let higher = GlobalPosition { altitude: 518_000, ..home };
/// assert_eq!(frame.to_local(higher).z, -30.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalFrame {
    origin: GlobalPosition,
    sin_latitude: f32,
    /// Radius of the meridian's curvature at the origin, in m.
    meridian: f32,
    /// Radius of the origin's circle of latitude, in m.
    parallel: f32,
}

impl LocalFrame {
    /// The plane that touches the Earth at `origin`.
    #[must_use]
    pub fn new(origin: GlobalPosition) -> Self {
        let (sin_latitude, cos_latitude) = sin_cos(origin.latitude as f32 * UNIT);
        let altitude = origin.altitude as f32 * 1e-3;
        let w = 1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude;
        let prime_vertical = EQUATOR_RADIUS / sqrt(w);
        let meridian = prime_vertical * (1.0 - ECCENTRICITY_SQUARED) / w;
        Self {
            origin,
            sin_latitude,
            meridian: meridian + altitude,
            parallel: (prime_vertical + altitude) * cos_latitude,
        }
    }

    /// The position that is north 0, east 0, down 0.
    #[must_use]
    pub fn origin(&self) -> GlobalPosition {
        self.origin
    }

    /// A position as north, east and down of the origin, in m; the short way round the Earth.
    #[must_use]
    pub fn to_local(&self, position: GlobalPosition) -> Vector3<f32> {
        let origin = self.origin;
        let latitude = position.latitude.saturating_sub(origin.latitude);
        let longitude = wrap_longitude(i64::from(position.longitude) - i64::from(origin.longitude));
        let altitude = position.altitude.saturating_sub(origin.altitude);
        let latitude = latitude as f32 * UNIT;
        let longitude = longitude as f32 * UNIT;
        let east = self.parallel_at(latitude) * longitude;
        let north = self.meridian * latitude + self.bend(east, longitude);
        Vector3::new(north, east, -(altitude as f32) / 1000.0)
    }

    /// The position that is `local` (north, east, down in m) from the origin. Coordinates that
    /// are not numbers count as 0; the result saturates at the poles and at ±2147 km of altitude.
    #[must_use]
    pub fn to_global(&self, local: Vector3<f32>) -> GlobalPosition {
        // The two equations of `to_local`, solved by iteration: each pass gains two digits or
        // more within 10 km.
        let mut latitude = local.x / self.meridian;
        let mut longitude = 0.0;
        for _ in 0..3 {
            longitude = local.y / self.parallel_at(latitude);
            latitude = (local.x - self.bend(local.y, longitude)) / self.meridian;
        }
        let origin = self.origin;
        let latitude = origin.latitude.saturating_add(round(latitude / UNIT));
        let longitude = i64::from(origin.longitude) + i64::from(round(longitude / UNIT));
        GlobalPosition {
            latitude: latitude.clamp(-POLE, POLE),
            longitude: wrap_longitude(longitude),
            altitude: origin.altitude.saturating_sub(round(local.z * 1000.0)),
        }
    }

    /// Radius in m of the circle of latitude that is `latitude` radians north of the origin. The
    /// slope is exact for an ellipsoid: d(N cos φ)/dφ = −M sin φ.
    #[inline(always)]
    fn parallel_at(&self, latitude: f32) -> f32 {
        let radius = self.parallel - self.meridian * self.sin_latitude * latitude;
        max(radius, SMALLEST_PARALLEL)
    }

    /// How far north of the east axis the circle of latitude has bent, in m, at `east` m, which
    /// are `longitude` radians.
    #[inline(always)]
    fn bend(&self, east: f32, longitude: f32) -> f32 {
        0.5 * self.sin_latitude * east * longitude
    }
}

/// The integer nearest to `x`; the largest or smallest for what is too large, 0 for NaN.
#[inline(always)]
fn round(x: f32) -> i32 {
    (x + 0.5_f32.copysign(x)) as i32
}

/// A sum or difference of two longitudes in 1e-7 degrees, brought within ±180°.
#[inline(always)]
fn wrap_longitude(units: i64) -> i32 {
    let wrapped = if units > HALF_TURN {
        units - 2 * HALF_TURN
    } else if units < -HALF_TURN {
        units + 2 * HALF_TURN
    } else {
        units
    };
    // At most twice an i32 came in, less than one turn beyond ±180°.
    wrapped as i32
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    /// The WGS84 ellipsoid in double precision, from its axis and flattening.
    mod wgs84 {
        use super::GlobalPosition;

        const A: f64 = 6_378_137.0;
        const B: f64 = A * (1.0 - 1.0 / 298.257_223_563);

        /// Earth-centred coordinates of latitude, longitude in radians and height in m.
        fn earth_centred(latitude: f64, longitude: f64, height: f64) -> [f64; 3] {
            let (s, c) = libm::sincos(latitude);
            let d = libm::sqrt(A * A * c * c + B * B * s * s);
            let p = (A * A / d + height) * c;
            let (sl, cl) = libm::sincos(longitude);
            [p * cl, p * sl, (B * B / d + height) * s]
        }

        fn radians(p: GlobalPosition) -> (f64, f64) {
            let unit = core::f64::consts::PI / 1.8e9;
            (f64::from(p.latitude) * unit, f64::from(p.longitude) * unit)
        }

        /// North and east of `position` in the tangent plane at `origin`, both at the origin's
        /// altitude.
        pub fn tangent_plane(origin: GlobalPosition, position: GlobalPosition) -> (f64, f64) {
            let height = f64::from(origin.altitude) * 1e-3;
            let (latitude, longitude) = radians(origin);
            let o = earth_centred(latitude, longitude, height);
            let (to_latitude, to_longitude) = radians(position);
            let p = earth_centred(to_latitude, to_longitude, height);
            let d = [p[0] - o[0], p[1] - o[1], p[2] - o[2]];
            let (s, c) = libm::sincos(latitude);
            let (sl, cl) = libm::sincos(longitude);
            let north = -s * (cl * d[0] + sl * d[1]) + c * d[2];
            let east = -sl * d[0] + cl * d[1];
            (north, east)
        }
    }

    fn position(latitude: f64, longitude: f64, altitude: f64) -> GlobalPosition {
        GlobalPosition {
            latitude: (latitude * 1e7) as i32,
            longitude: (longitude * 1e7) as i32,
            altitude: (altitude * 1e3) as i32,
        }
    }

    /// The largest horizontal error in m, against the ellipsoid, of points on a circle of
    /// `radius` m around origins up to 80° of latitude.
    fn worst_error(radius: f64) -> f64 {
        let mut worst = 0.0;
        for latitude in (-80..=80).step_by(2) {
            for longitude in [-180.0, -179.99, -70.0, 0.0, 8.5, 179.99, 180.0] {
                for altitude in [-400.0, 0.0, 4000.0] {
                    let origin = position(latitude.into(), longitude, altitude);
                    let frame = LocalFrame::new(origin);
                    for bearing in 0..24 {
                        let (s, c) = libm::sincos(f64::from(bearing) * core::f64::consts::PI / 12.0);
                        let local = Vector3::new(radius * c, radius * s, 0.0).map(|v| v as f32);
                        let there = frame.to_global(local);
                        let local = frame.to_local(there);
                        let (north, east) = wgs84::tangent_plane(origin, there);
                        let error = libm::hypot(f64::from(local.x) - north, f64::from(local.y) - east);
                        worst = crate::max(worst, error);
                    }
                }
            }
        }
        worst
    }

    #[test]
    fn the_plane_is_the_ellipsoids_tangent_plane() {
        for (radius, bound) in [(10.0, 1e-5), (100.0, 1e-4), (1e3, 2e-3), (10e3, 0.15)] {
            let worst = worst_error(radius);
            assert!(worst < bound, "{worst:e} m at {radius} m");
        }
    }

    #[test]
    fn differences_across_the_date_line_are_short() {
        let west = GlobalPosition {
            latitude: 0,
            longitude: 1_799_999_000,
            altitude: 0,
        };
        let east = GlobalPosition {
            longitude: -1_799_999_000,
            ..west
        };
        let local = LocalFrame::new(west).to_local(east);
        let metres = 2_000.0 * UNIT * EQUATOR_RADIUS;
        assert!((local.y - metres).abs() < 1e-4, "{local}");
        assert_eq!(LocalFrame::new(east).to_local(west).y, -local.y);
        assert_eq!(LocalFrame::new(west).to_global(local), east);
        assert_eq!(LocalFrame::new(east).to_global(-local), west);
    }

    #[test]
    fn down_is_the_difference_in_altitude() {
        let origin = position(47.0, 8.0, 500.0);
        let frame = LocalFrame::new(origin);
        let there = position(47.08, 8.05, 530.001);
        assert_eq!(frame.to_local(there).z, -30.001);
        assert_eq!(frame.to_global(Vector3::new(0.0, 0.0, 10.0)).altitude, 490_000);
        assert_eq!(frame.origin(), origin);
    }

    #[test]
    fn a_unit_of_latitude_is_a_centimetre() {
        // 110 574 m a degree at the equator, 111 694 m at the poles; 111 320 m of longitude
        let metres = |latitude: i32, step: [i32; 2]| {
            let origin = GlobalPosition {
                latitude,
                longitude: 0,
                altitude: 0,
            };
            LocalFrame::new(origin).to_local(GlobalPosition {
                latitude: latitude + step[0],
                longitude: step[1],
                altitude: 0,
            })
        };
        assert!((metres(0, [10_000, 0]).x - 110.574).abs() < 1e-3);
        assert!((metres(899_000_000, [10_000, 0]).x - 111.694).abs() < 1e-3);
        assert!((metres(0, [0, 10_000]).y - 111.320).abs() < 1e-3);
        assert!((metres(600_000_000, [0, 10_000]).y - 55.800).abs() < 1e-3);
    }

    #[test]
    fn the_poles_and_nonsense_give_numbers() {
        for latitude in [i32::MIN, -POLE, -POLE + 1, 0, POLE, i32::MAX] {
            for longitude in [i32::MIN, -1_800_000_000, 0, 1_800_000_000, i32::MAX] {
                let origin = GlobalPosition {
                    latitude,
                    longitude,
                    altitude: i32::MIN,
                };
                let frame = LocalFrame::new(origin);
                for altitude in [i32::MIN, 0, i32::MAX] {
                    let there = GlobalPosition {
                        latitude: -latitude.saturating_add(1),
                        longitude: -longitude.saturating_add(1),
                        altitude,
                    };
                    assert!(crate::scalar::is_finite(frame.to_local(there)));
                }
                for v in [0.0, 1e3, -1e9, f32::MAX, f32::INFINITY, f32::NAN] {
                    let there = frame.to_global(Vector3::new(v, -v, v));
                    assert!(there.latitude.abs() <= POLE);
                    assert!(i64::from(there.longitude).abs() <= HALF_TURN);
                }
            }
        }
    }

    #[test]
    fn there_and_back_at_a_pole() {
        for latitude in [POLE, POLE - 300, -POLE, 300 - POLE] {
            let frame = LocalFrame::new(GlobalPosition {
                latitude,
                longitude: 123_456_789,
                altitude: 0,
            });
            let local = Vector3::new(0.0, 10.0, 0.0);
            let error = frame.to_local(frame.to_global(local)) - local;
            assert!(error.amax() < 0.02, "{error}");
        }
    }

    #[test]
    fn not_a_number_counts_as_the_origin() {
        let origin = position(-33.0, 151.0, 20.0);
        let nan = Vector3::repeat(f32::NAN);
        assert_eq!(LocalFrame::new(origin).to_global(nan), origin);
    }

    fn any_origin() -> impl Strategy<Value = GlobalPosition> {
        let latitude = -800_000_000..=800_000_000;
        let longitude = -1_800_000_000..=1_800_000_000;
        (latitude, longitude, -400_000..=5_000_000).prop_map(|(latitude, longitude, altitude)| {
            GlobalPosition {
                latitude,
                longitude,
                altitude,
            }
        })
    }

    proptest! {
        #[test]
        fn there_and_back_in_metres(
            origin in any_origin(),
            north in -10e3_f32..10e3,
            east in -10e3_f32..10e3,
            down in -500.0_f32..500.0,
        ) {
            let frame = LocalFrame::new(origin);
            let local = Vector3::new(north, east, down);
            let error = frame.to_local(frame.to_global(local)) - local;
            prop_assert!(error.x.abs() < 0.008, "{}", error);
            prop_assert!(error.y.abs() < 0.008, "{}", error);
            prop_assert!(error.z.abs() < 0.001, "{}", error);
        }

        #[test]
        fn there_and_back_in_units(
            origin in any_origin(),
            latitude in -90_000..90_000,
            longitude in -90_000..90_000,
            altitude in -500_000..500_000,
        ) {
            let frame = LocalFrame::new(origin);
            let there = GlobalPosition {
                latitude: origin.latitude + latitude,
                longitude: wrap_longitude(i64::from(origin.longitude) + i64::from(longitude)),
                altitude: origin.altitude + altitude,
            };
            let back = frame.to_global(frame.to_local(there));
            prop_assert_eq!(back.latitude, there.latitude);
            prop_assert_eq!(back.altitude, there.altitude);
            let longitude = wrap_longitude(i64::from(back.longitude) - i64::from(there.longitude));
            prop_assert_eq!(longitude, 0);
        }
    }
}
