//! Geofences and rally points of a plan: as QGroundControl uploads them, and what is wrong with
//! them.

use proptest::prelude::*;
use windhover_autopilot::fence::{MAX_RALLY, MAX_VERTICES};
use windhover_autopilot::mission::MissionItem;
use windhover_sim::mission_file::MissionFile;

use super::{PLAN, edited, parse, refusal};

/// A square of some 200 m around the sample's home.
const SQUARE: &str = "[[47.3967, 8.5443], [47.3987, 8.5443], [47.3987, 8.5470], [47.3967, 8.5470]]";

/// The sample plan with these shapes.
fn fenced(polygons: &str, circles: &str) -> String {
    let text = edited("\"polygons\": [", &format!("\"polygons\": [ {polygons}"));
    text.replacen("\"circles\": [", &format!("\"circles\": [ {circles}"), 1)
}

/// Where the sample plan's rally points begin.
const POINTS: &str = "\"points\": [";

/// The sample plan with these rally points.
fn rallied(points: &str) -> String {
    edited(POINTS, &format!("{POINTS} {points}"))
}

fn polygon(inclusion: bool, vertices: &str) -> String {
    format!(r#"{{"inclusion": {inclusion}, "polygon": {vertices}, "version": 1}}"#)
}

fn circle(inclusion: bool, radius: &str) -> String {
    format!(
        r#"{{"circle": {{"center": [47.3977, 8.5456], "radius": {radius}}}, "inclusion": {inclusion}, "version": 1}}"#
    )
}

fn item(command: u16, frame: u8, p1: f32, (x, y): (i32, i32), z: f32) -> MissionItem {
    MissionItem {
        command,
        frame,
        autocontinue: false,
        params: [p1, 0.0, 0.0, 0.0],
        x,
        y,
        z,
    }
}

fn described(file: &MissionFile) -> Vec<String> {
    (0..file.fence.len())
        .map(|index| file.describe_fence(index))
        .collect()
}

/// As QGroundControl's `GeoFenceManager` uploads it: polygons, circles, return point.
#[test]
fn a_fence_is_read_as_the_items_that_are_uploaded() {
    let triangle = "[[47.3970, 8.5450], [47.3971, 8.5450], [47.3970, 8.5452, 12]]";
    let polygons = [polygon(true, SQUARE), polygon(false, triangle)].join(", ");
    let circles = [circle(true, "250.5"), circle(false, "20")].join(", ");
    let file = parse(fenced(&polygons, &circles)).unwrap();
    let centre = (473_977_000, 85_456_000);
    let expected = [
        item(5001, 0, 4.0, (473_967_000, 85_443_000), 0.0),
        item(5001, 0, 4.0, (473_987_000, 85_443_000), 0.0),
        item(5001, 0, 4.0, (473_987_000, 85_470_000), 0.0),
        item(5001, 0, 4.0, (473_967_000, 85_470_000), 0.0),
        item(5002, 0, 3.0, (473_970_000, 85_450_000), 0.0),
        item(5002, 0, 3.0, (473_971_000, 85_450_000), 0.0),
        item(5002, 0, 3.0, (473_970_000, 85_452_000), 0.0),
        item(5003, 0, 250.5, centre, 0.0),
        item(5004, 0, 20.0, centre, 0.0),
    ];
    assert_eq!(file.fence, expected);
    let described = described(&file);
    assert_eq!(described[3], "geofence polygon 1");
    assert_eq!(
        described[6..],
        ["geofence polygon 2", "geofence circle 1", "geofence circle 2"]
    );
    assert!(file.notes.is_empty() && file.rally.is_empty());
    assert_eq!(file.stored().fence, expected);

    let back = fenced("", &circle(true, "100")).replacen(
        "\"circles\": [",
        "\"breachReturn\": [47.3977, 8.5456, 25], \"circles\": [",
        1,
    );
    let file = parse(back).unwrap();
    assert_eq!(file.fence[1], item(5000, 3, 0.0, centre, 25.0));
    assert!(file.notes[0].contains("breach return point is not used"));
}

/// As its `RallyPointManager` does: heights count from home.
#[test]
fn rally_points_are_read_with_heights_above_home() {
    let file = parse(rallied("[47.3977, 8.5456, 20], [-1.5, -8, 0.5]")).unwrap();
    let expected = [
        item(5100, 3, 0.0, (473_977_000, 85_456_000), 20.0),
        item(5100, 3, 0.0, (-15_000_000, -80_000_000), 0.5),
    ];
    assert_eq!(file.rally, expected);
    assert_eq!(file.stored().rally, expected);
}

#[test]
fn there_may_be_none() {
    for text in [
        PLAN.to_owned(),
        edited("\"geoFence\"", "\"x\""),
        edited("\"rallyPoints\"", "\"x\""),
        edited("\"geoFence\": {", "\"geoFence\": null, \"x\": {"),
        // The old format, empty.
        edited(
            "\"version\": 2\n    },\n    \"ground",
            "\"version\": 1\n    },\n    \"ground",
        ),
    ] {
        let file = parse(text).unwrap();
        assert!(file.fence.is_empty() && file.rally.is_empty() && file.notes.is_empty());
    }
}

#[test]
fn what_is_wrong_is_named_with_its_shape() {
    let polygon_of = |vertices: &str| fenced(&polygon(true, vertices), "");
    let many = |count: usize| format!("[{}]", vec!["[47, 8]"; count].join(","));
    let circles = vec![circle(true, "30"); 17].join(",");
    let two = [polygon(true, &many(50)), polygon(false, &many(40))].join(",");
    let cases = [
        (
            polygon_of("[]"),
            "geofence polygon 1: 0 vertices, a polygon has 3 or more",
        ),
        (
            polygon_of("[[47, 8], [47, 9]]"),
            "geofence polygon 1: 2 vertices, a polygon has 3 or more",
        ),
        (
            polygon_of("7"),
            "geofence polygon 1, polygon: found 7, a list is needed",
        ),
        (
            polygon_of("[[47, 8], [91, 8], [47, 9]]"),
            "geofence polygon 1, vertex 2, latitude: 91 is outside -90 to 90",
        ),
        (
            polygon_of("[[47, 8], [47, -180.5], [47, 9]]"),
            "geofence polygon 1, vertex 2, longitude: -180.5 is outside -180 to 180",
        ),
        (
            polygon_of("[[47, 8], [47, null], [47, 9]]"),
            "geofence polygon 1, vertex 2, longitude: found no number (null or NaN), a number is needed",
        ),
        (
            polygon_of("[[47, 8], [47], [47, 9]]"),
            "geofence polygon 1, vertex 2, position: found a list of 1, latitude and longitude is needed",
        ),
        (
            polygon_of("[[47, 8], {}, [47, 9]]"),
            "geofence polygon 1, vertex 2, position: found an object, latitude and longitude is needed",
        ),
        (
            polygon_of("[[47, 8], [47, true], [47, 9]]"),
            "geofence polygon 1, vertex 2, position: found true, a number is needed",
        ),
        (
            polygon_of(&many(85)),
            "has 85 vertices in its geofence, the vehicle stores at most 84",
        ),
        (
            polygon_of(&many(100_000)),
            "has 100000 vertices in its geofence, the vehicle stores at most 84",
        ),
        (
            fenced(&two, ""),
            "has 90 vertices in its geofence, the vehicle stores at most 84",
        ),
        (
            fenced("", &circles),
            "has 17 shapes in its geofence, the vehicle stores at most 16",
        ),
        (
            polygon_of(SQUARE).replacen("\"inclusion\": true, ", "", 1),
            "geofence polygon 1, inclusion is missing",
        ),
        (
            polygon_of(SQUARE).replacen("\"inclusion\": true", "\"inclusion\": 1", 1),
            "geofence polygon 1, inclusion: found 1, true or false is needed",
        ),
        (
            polygon_of(SQUARE).replacen("\"version\": 1}", "\"version\": 2}", 1),
            "geofence polygon 1, version: 2 is not known, only version 1 is read",
        ),
        (fenced("", "{}"), "geofence circle 1, inclusion is missing"),
        (
            fenced("", r#"{"inclusion": true}"#),
            "geofence circle 1, circle is missing",
        ),
        (
            fenced("", r#"{"inclusion": true, "circle": 3}"#),
            "geofence circle 1, center is missing",
        ),
        (
            fenced("", r#"{"inclusion": true, "circle": {"center": [47, 8]}}"#),
            "geofence circle 1, radius is missing",
        ),
        (
            fenced("", &circle(true, "null")),
            "geofence circle 1, radius: found null, a number is needed",
        ),
        (
            fenced("", &circle(true, "1e300")),
            "geofence circle 1, parameter 1: 1e300 is outside -3.4028234663852886e38 to 3.4028234663852886e38",
        ),
        (
            edited("\"geoFence\": {", "\"geoFence\": [1], \"x\": {"),
            "geoFence: found a list of 1, an object is needed",
        ),
        (
            edited("\"circles\": [\n        ],", "\"circles\": 5,"),
            "circles: found 5, a list is needed",
        ),
        (
            fenced("", &circle(true, "30")).replacen(
                "\"version\": 2\n    },\n    \"ground",
                "\"version\": 1\n    },\n    \"ground",
                1,
            ),
            "geoFence version: 1 is not known, only version 2 is read",
        ),
        (
            rallied("[47, 8]"),
            "rally point 1, position: found a list of 2, latitude, longitude and height is needed",
        ),
        (
            rallied("[47, 8, 20], [47, 181, 20]"),
            "rally point 2, longitude: 181 is outside -180 to 180",
        ),
        (
            rallied("[47, 8, null]"),
            "rally point 1, altitude: found no number (null or NaN), a number is needed",
        ),
        (
            rallied(&["[47, 8, 20]"; 9].join(",")),
            "has 9 rally points, the vehicle stores at most 8",
        ),
    ];
    for (text, message) in cases {
        assert_eq!(refusal(text), format!("x.plan: {message}"));
    }
}

#[test]
fn memory_is_bounded_in_a_fence_too() {
    let nested = format!("{}1{}", "[".repeat(60), "]".repeat(60));
    let list = vec![nested.as_str(); 20_000].join(",");
    assert!(refusal(fenced(&list, "")).contains("20000 shapes"));
    let polygon = polygon(true, &format!("[{list}]"));
    assert!(refusal(fenced(&polygon, "")).contains("20000 vertices"));
}

proptest! {
    #[test]
    fn any_shape_is_read_or_refused_in_one_line(
        vertices in proptest::collection::vec((-100.0..100.0_f64, -200.0..200.0_f64), 0..100),
        radius: f64,
        inclusion: bool,
        rally in proptest::collection::vec((-90.0..90.0_f64, -180.0..180.0_f64, -100.0..100.0_f64), 0..12),
        damage in proptest::option::of((any::<prop::sample::Index>(), any::<u8>())),
    ) {
        let vertices: Vec<String> = vertices.iter().map(|(lat, lon)| format!("[{lat}, {lon}]")).collect();
        let polygon = polygon(inclusion, &format!("[{}]", vertices.join(", ")));
        let rally: Vec<String> = rally.iter().map(|(lat, lon, height)| format!("[{lat}, {lon}, {height}]")).collect();
        let text = fenced(&polygon, &circle(inclusion, &radius.to_string()));
        let text = text.replacen(POINTS, &format!("{POINTS} {}", rally.join(", ")), 1);
        let mut bytes = text.into_bytes();
        if let Some((at, value)) = damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        match parse(&bytes) {
            // The circle is an item too.
            Ok(file) => prop_assert!(file.fence.len() <= MAX_VERTICES + 1 && file.rally.len() <= MAX_RALLY),
            Err(message) => prop_assert!(!message.contains('\n') && message.chars().count() < 500),
        }
    }
}
