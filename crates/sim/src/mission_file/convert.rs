//! Numbers of a file into a [`MissionItem`]: degrees become integers here, once.

use windhover_autopilot::mission::item::MissionItem;

use super::error::{Field, Place, Problem};

/// An item's values as they stand in the file.
pub(super) struct RawItem {
    pub command: u16,
    pub frame: u8,
    pub autocontinue: bool,
    /// Parameters 1 to 7; NaN says unset.
    pub params: [f64; 7],
}

/// MAVLink's `INT32_MAX` for a parameter 5 or 6 that is unset.
const UNSET: i32 = i32::MAX;

/// Whether parameters 5 to 7 of a command are a position (`hasLocation` in MAVLink's definitions).
fn has_location(command: u16) -> bool {
    matches!(
        command,
        16..=19 // waypoint, loiter unlimited, turns, time
            | 21 // land
            | 22 // takeoff
            | 23..=25 // land and takeoff locally, follow
            | 31 // loiter to altitude
            | 34..=36 // orbit, figure of eight, arc
            | 80..=82 // region of interest, path planning, spline waypoint
            | 84 | 85 // VTOL takeoff and land
            | 94 // payload place
            | 179 // set home
            | 188 | 189 // return path, landing sequence
            | 192 // reposition
            | 195 | 201 // region of interest
            | 252 // override
            | 4001 // guided circle
            | 4501 // gate
            | 5000..=5004 // fence
            | 5100 // rally point
            | 30001 // payload deployment
            | 31000..=31009 // user's waypoints and places
    )
}

/// Whether positions in a frame are latitude and longitude.
fn is_global(frame: u8) -> bool {
    matches!(frame, 0 | 3 | 5 | 6 | 10 | 11)
}

/// Whether positions in a frame are metres from somewhere.
fn is_local(frame: u8) -> bool {
    !is_global(frame) && frame != 2
}

/// The item that a ground station would upload for these values.
///
/// A command without a position keeps parameters 5 and 6 as plain integers. Some ground stations
/// leave a position behind in such a command all the same (Mission Planner's return to launch):
/// in a global frame fractions are therefore taken as degrees.
pub(super) fn item(raw: &RawItem, place: &Place) -> Result<MissionItem, Problem> {
    let [p1, p2, p3, p4, p5, p6, p7] = raw.params;
    let mut params = [0.0; 4];
    for (index, value) in [p1, p2, p3, p4].into_iter().enumerate() {
        params[index] = single(value, place, &format!("parameter {}", index + 1))?;
    }
    let located = has_location(raw.command);
    let integers = fits_integer(p5) && fits_integer(p6);
    let degrees = is_global(raw.frame) && (located || !integers);
    let (x, y) = if degrees {
        (
            latitude(p5, &Field::new(place, "latitude"))?,
            longitude(p6, &Field::new(place, "longitude"))?,
        )
    } else if located && is_local(raw.frame) {
        (
            tenths_of_mm(p5, &Field::new(place, "x"))?,
            tenths_of_mm(p6, &Field::new(place, "y"))?,
        )
    } else {
        (
            whole(p5, raw.frame, &Field::new(place, "parameter 5"))?,
            whole(p6, raw.frame, &Field::new(place, "parameter 6"))?,
        )
    };
    let z = if located && raw.frame != 2 {
        altitude(p7, place)?
    } else {
        single(p7, place, "parameter 7")?
    };
    Ok(MissionItem {
        command: raw.command,
        frame: raw.frame,
        autocontinue: raw.autocontinue,
        params,
        x,
        y,
        z,
    })
}

/// Degrees of latitude in 1e-7 degree.
pub(super) fn latitude(degrees: f64, field: &Field) -> Result<i32, Problem> {
    scaled(degrees, 90.0, 1e7, field)
}

/// Degrees of longitude in 1e-7 degree.
pub(super) fn longitude(degrees: f64, field: &Field) -> Result<i32, Problem> {
    scaled(degrees, 180.0, 1e7, field)
}

/// Metres in mm, for an altitude above the sea.
pub(super) fn millimetres(metres: f64, field: &Field) -> Result<i32, Problem> {
    scaled(metres, 100_000.0, 1e3, field)
}

/// Metres in 1e-4 m, as MAVLink carries a local position.
fn tenths_of_mm(metres: f64, field: &Field) -> Result<i32, Problem> {
    scaled(metres, 200_000.0, 1e4, field)
}

/// `value · unit` rounded, where `value` is a number from `-limit` to `limit`.
fn scaled(value: f64, limit: f64, unit: f64, field: &Field) -> Result<i32, Problem> {
    if value.is_nan() {
        return Err(Problem::WrongType {
            field: Box::new(field.clone()),
            found: "no number (null or NaN)".into(),
            wanted: "a number",
        });
    }
    if !(-limit..=limit).contains(&value) {
        return Err(out_of_range(field, value, limit));
    }
    Ok((value * unit).round() as i32)
}

/// The altitude of a position.
fn altitude(metres: f64, place: &Place) -> Result<f32, Problem> {
    if metres.is_nan() {
        return Err(Problem::WrongType {
            field: Box::new(Field::new(place, "altitude")),
            found: "no number (null or NaN)".into(),
            wanted: "a number",
        });
    }
    single(metres, place, "altitude")
}

/// A value in single precision, as MAVLink carries it; NaN stays NaN.
fn single(value: f64, place: &Place, name: &str) -> Result<f32, Problem> {
    let single = value as f32;
    if single.is_infinite() {
        let field = Field::new(place, name);
        return Err(out_of_range(&field, value, f64::from(f32::MAX)));
    }
    Ok(single)
}

fn fits_integer(value: f64) -> bool {
    value.is_nan() || (value.trunc() == value && i32::try_from(value as i64).is_ok())
}

/// A whole number in MAVLink's integer field.
fn whole(value: f64, frame: u8, field: &Field) -> Result<i32, Problem> {
    if value.is_nan() {
        return Ok(UNSET);
    }
    let limit = f64::from(i32::MAX);
    if !(-limit..=limit).contains(&value) {
        return Err(out_of_range(field, value, limit));
    }
    if value.trunc() != value {
        return Err(Problem::NotWhole {
            field: Box::new(field.clone()),
            found: value.to_string(),
            frame,
        });
    }
    Ok(value as i32)
}

/// A number beyond `limit` either way.
fn out_of_range(field: &Field, value: f64, limit: f64) -> Problem {
    Problem::OutOfRange {
        field: Box::new(field.clone()),
        found: number(value),
        min: number(-limit),
        max: number(limit),
    }
}

/// A number for a message: an exponent where digits would fill the line.
pub(super) fn number(value: f64) -> String {
    if value.abs() < 1e15 {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn raw(command: u16, frame: u8, p5: f64, p6: f64, p7: f64) -> RawItem {
        RawItem {
            command,
            frame,
            autocontinue: true,
            params: [0.0, 0.0, 0.0, f64::NAN, p5, p6, p7],
        }
    }

    fn convert(command: u16, frame: u8, p5: f64, p6: f64, p7: f64) -> Result<MissionItem, String> {
        item(&raw(command, frame, p5, p6, p7), &Place::Item(3)).map_err(|e| e.to_string())
    }

    #[test]
    fn degrees_are_rounded_not_cut() {
        let item = convert(16, 3, 47.397_705_960_554_916, -8.546_339_694_155_481, 50.0).unwrap();
        assert_eq!((item.x, item.y, item.z), (473_977_060, -85_463_397, 50.0));
        assert!(item.params[3].is_nan());
    }

    #[test]
    fn the_edges_of_the_globe_are_allowed_and_beyond_is_not() {
        assert_eq!(convert(16, 0, 90.0, -180.0, 0.0).unwrap().x, 900_000_000);
        let refused = |p5, p6| convert(16, 3, p5, p6, 1.0).unwrap_err();
        assert_eq!(refused(91.0, 0.0), "item 3, latitude: 91 is outside -90 to 90");
        assert_eq!(
            refused(0.0, -181.0),
            "item 3, longitude: -181 is outside -180 to 180"
        );
        assert!(refused(f64::NAN, 0.0).contains("latitude: found no number"));
        assert!(refused(0.0, f64::INFINITY).contains("longitude: inf is outside"));
        let altitude = convert(16, 3, 0.0, 0.0, f64::NAN).unwrap_err();
        assert!(altitude.contains("altitude: found no number"));
    }

    #[test]
    fn a_command_without_position_keeps_plain_integers() {
        let item = convert(203, 2, 1.0, -2.0, 7.5).unwrap();
        assert_eq!((item.x, item.y, item.z), (1, -2, 7.5));
        let unset = convert(530, 2, f64::NAN, f64::NAN, f64::NAN).unwrap();
        assert_eq!((unset.x, unset.y), (i32::MAX, i32::MAX));
        assert!(unset.z.is_nan());
        assert_eq!(
            convert(206, 2, 0.5, 0.0, 0.0).unwrap_err(),
            "item 3, parameter 5: 0.5 is not a whole number, and frame 2 has no position"
        );
        assert!(convert(206, 2, 3e9, 0.0, 0.0).unwrap_err().contains("outside"));
    }

    #[test]
    fn a_position_left_in_a_command_without_one_is_kept_as_degrees() {
        let item = convert(20, 5, 47.397_777_4, 8.545_324_7, 0.0).unwrap();
        assert_eq!((item.x, item.y), (473_977_774, 85_453_247));
    }

    #[test]
    fn local_positions_are_tenths_of_a_millimetre() {
        let item = convert(16, 1, 1.5, -20.0, -3.0).unwrap();
        assert_eq!((item.x, item.y), (15_000, -200_000));
    }

    #[test]
    fn numbers_beyond_single_precision_are_refused() {
        let error = convert(16, 3, 0.0, 0.0, 1e300).unwrap_err();
        assert!(error.starts_with("item 3, altitude: 1e300 is outside"));
        let mut huge = raw(16, 3, 0.0, 0.0, 0.0);
        huge.params[1] = f64::NEG_INFINITY;
        let error = item(&huge, &Place::Item(3)).unwrap_err().to_string();
        assert!(error.starts_with("item 3, parameter 2: -inf is outside"));
    }

    proptest! {
        #[test]
        fn integers_survive_degrees(lat in -900_000_000..=900_000_000_i32, lon in -1_800_000_000..=1_800_000_000_i32) {
            let text = |v: i32| format!("{:.7}", f64::from(v) / 1e7).parse::<f64>().unwrap();
            let item = convert(16, 3, text(lat), text(lon), 1.0).unwrap();
            prop_assert_eq!((item.x, item.y), (lat, lon));
        }

        #[test]
        fn any_numbers_give_an_item_or_a_refusal(command: u16, frame: u8, values: [f64; 7]) {
            let raw = RawItem { command, frame, autocontinue: false, params: values };
            if let Ok(item) = item(&raw, &Place::Item(1)) {
                prop_assert!(item.params.iter().all(|p| !p.is_infinite()));
                prop_assert!(!item.z.is_infinite());
            }
        }
    }
}
