//! The declination at a place: the bearing of magnetic north.
//!
//! A compass shows magnetic north; missions, receivers and maps count from true north. Where
//! people live up to 30° lie between the two, so whoever says where the vehicle is says how far
//! the compass is to be turned as well.
//!
//! The table is the World Magnetic Model 2025 (NOAA and British Geological Survey) at sea level on
//! the first day of 2026, every 5°. Between its points it is interpolated in both directions. Largest
//! differences from the model:
//!
//! | latitude | error below |
//! |---|---|
//! | 50° S to 50° N | 0.75° |
//! | 50° N to 70° N | 0.5° |
//! | 55° S to 50° S | 1.6° |
//!
//! Nearer to a magnetic pole (64° S 136° E, 86° N 139° E) it changes by degrees within some
//! kilometres, and a compass is of little use whatever a table says. 5 km of altitude make less
//! than 0.1°. The model holds until 2030, with a field that wanders by some 0.1° a year.

mod table;

use core::f32::consts::PI;

use windhover_math::geodesy::GlobalPosition;
use windhover_math::wrap_pi;

use table::TABLE;

/// Radians in the table's unit, 0.01°.
const UNIT: f32 = PI / HALF_TURN as f32;
/// Half a turn in the table's unit.
const HALF_TURN: i32 = 18_000;

/// Between two points of the table, 1e-7 degrees.
const STEP: i32 = 50_000_000;
/// The last latitude of the table, 1e-7 degrees.
const LAST: i32 = 800_000_000;
/// Rows, from 80° S to 80° N.
const ROWS: usize = 33;
/// Columns, from 180° W to 175° E.
const COLUMNS: usize = 72;

/// Bearing of magnetic north at a place, east positive, rad within ±π. Beyond 80° of latitude it
/// is that at 80°.
#[must_use]
pub fn declination(place: GlobalPosition) -> f32 {
    let north = place.latitude.clamp(-LAST, LAST) + LAST;
    let west_end = -36 * i64::from(STEP);
    let east = i64::from(place.longitude) - west_end;
    let east = east.rem_euclid(-2 * west_end) as u32;
    let (row, column) = (north / STEP, east / STEP as u32);
    let share = |rest: i32| rest as f32 / STEP as f32;
    let (up, right) = (share(north % STEP), share((east % STEP as u32) as i32));
    let corner = |rows, columns| point(row as usize + rows, column as usize + columns);
    // From the south-western corner, the short way round.
    let first = corner(0, 0);
    let rise = |rows, columns| shortest(corner(rows, columns) - first) as f32;
    let south = rise(0, 1) * right;
    let north = rise(1, 0) + (rise(1, 1) - rise(1, 0)) * right;
    let hundredths = first as f32 + south + (north - south) * up;
    wrap_pi(hundredths * UNIT)
}

/// A point of the table, 0.01°. After the last column comes the first; beyond the last row is the
/// last.
fn point(row: usize, column: usize) -> i32 {
    let row = TABLE.get(row).or(TABLE.last());
    let value = row.and_then(|row| row.get(column).or(row.first()));
    value.map_or(0, |value| i32::from(*value))
}

/// A difference of two bearings, 0.01°, within half a turn.
fn shortest(difference: i32) -> i32 {
    (difference + HALF_TURN).rem_euclid(2 * HALF_TURN) - HALF_TURN
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(latitude: f64, longitude: f64) -> f32 {
        let scaled = |degrees: f64| (degrees * 1e7) as i32;
        let place = GlobalPosition {
            latitude: scaled(latitude),
            longitude: scaled(longitude),
            altitude: 0,
        };
        declination(place).to_degrees()
    }

    #[test]
    fn it_is_the_tables_at_its_points_and_the_mean_halfway() {
        for (row, points) in TABLE.iter().enumerate() {
            for (column, point) in points.iter().enumerate() {
                let found = at(row as f64 * 5.0 - 80.0, column as f64 * 5.0 - 180.0);
                assert!((found - f32::from(*point) / 100.0).abs() < 1e-3, "{row} {column}");
            }
        }
        let halfway = (at(45.0, 10.0) + at(45.0, 15.0) + at(50.0, 10.0) + at(50.0, 15.0)) / 4.0;
        assert!((at(47.5, 12.5) - halfway).abs() < 1e-3);
    }

    #[test]
    fn it_is_steady_round_the_earth_and_everywhere_a_bearing() {
        assert!((at(-36.0, 180.0) - at(-36.0, -180.0)).abs() < 1e-4);
        assert!((at(-36.0, 179.999_999) - at(-36.0, -179.999_999)).abs() < 1e-3);
        assert_eq!(at(80.0, 33.0), at(90.0, 33.0));
        for longitude in [i32::MIN, -1_800_000_000, -1, 0, 1_799_999_999, i32::MAX] {
            for latitude in [i32::MIN, -800_000_001, 0, 799_999_999, i32::MAX] {
                let place = GlobalPosition {
                    latitude,
                    longitude,
                    altitude: 0,
                };
                assert!((-PI..=PI).contains(&declination(place)), "{place:?}");
            }
        }
    }

    #[test]
    fn where_the_table_jumps_by_a_turn_it_goes_the_short_way() {
        // 80° S, 140° E to 145° E: −173.84° and 178.62°.
        let between = at(-80.0, 142.5).abs();
        assert!(between > 175.0, "{between}");
    }
}
