//! Mission files as ground stations save them, and everything that can be wrong with one.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use windhover_autopilot::mission::item::MAX_ITEMS;
use windhover_sim::mission_file::{self, MissionFile};

const PLAN: &str = include_str!("data/qgroundcontrol_sample.plan");
const SURVEY: &str = include_str!("data/qgroundcontrol_sample_with_survey.plan");
const WAYPOINTS: &str = include_str!("data/mission_planner_sample.txt");

fn parse(text: impl AsRef<[u8]>) -> Result<MissionFile, String> {
    let name = Path::new("x.plan");
    mission_file::read_bytes(name, text.as_ref()).map_err(|e| e.to_string())
}

fn refusal(text: impl AsRef<[u8]>) -> String {
    let message = parse(text).expect_err("refused");
    assert!(!message.contains('\n'), "{message}");
    message
}

/// The sample plan with one piece of text replaced.
fn edited(from: &str, to: &str) -> String {
    assert!(PLAN.contains(from), "{from}");
    PLAN.replacen(from, to, 1)
}

fn repository(file: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.join(file)
}

fn commands(file: &MissionFile) -> Vec<u16> {
    file.items.iter().map(|item| item.command).collect()
}

#[test]
fn a_plan_of_qgroundcontrol() {
    let file = parse(PLAN).unwrap();
    assert_eq!(commands(&file), [22, 16, 2000, 16, 16, 20]);
    assert_eq!(file.home, Some((473_977_507, 85_456_075, 488_931)));
    assert_eq!((file.cruise_speed, file.hover_speed), (Some(15.0), Some(5.0)));
    let takeoff = &file.items[0];
    assert_eq!((takeoff.frame, takeoff.autocontinue), (3, true));
    assert_eq!(takeoff.params[..3], [15.0, 0.0, 0.0]);
    assert!(takeoff.params[3].is_nan());
    assert_eq!((takeoff.x, takeoff.y, takeoff.z), (473_977_507, 85_456_075, 50.0));
    assert_eq!((file.items[1].x, file.items[1].y), (473_977_711, 85_466_122));
    assert!(file.notes.is_empty());
    assert_eq!(file.describe(5), "item 6");
}

#[test]
fn a_survey_is_flown_as_its_stored_items() {
    let file = parse(SURVEY).unwrap();
    let expected = [530, 16, 206, 16, 206, 16, 16, 16, 16, 206, 16, 16, 206];
    assert_eq!(commands(&file), expected);
    assert_eq!((file.items[0].x, file.items[0].y), (i32::MAX, i32::MAX), "unset");
    assert_eq!((file.items[1].x, file.items[1].y), (473_977_060, 85_463_397));
    assert_eq!(file.describe(0), "item 1");
    assert_eq!(file.describe(7), "item 2 (survey), part 7");
}

#[test]
fn a_waypoint_file_that_begins_with_a_takeoff() {
    let file = parse(WAYPOINTS).unwrap();
    assert_eq!(commands(&file), [22, 16, 16, 20]);
    assert_eq!(file.home, None);
    assert_eq!((file.items[3].x, file.items[3].y), (473_977_774, 85_453_247));
    assert_eq!(file.describe(3), "item 3 (line 5)");
}

#[test]
fn item_0_of_mission_planner_is_home() {
    let text = "\u{feff}QGC WPL 110\r\n\
        0\t1\t0\t16\t0\t0\t0\t0\t-35.3632610\t149.1652300\t584.090000\t1\r\n\
        1\t0\t3\t22\t0.0\t0.0\t0.0\t0.0\t0.0\t0.0\t20.0\t1\r\n\
        # a remark\r\n\r\n\
        2 0 3 16 0.5 0 0 0 -35.36 149.16 20 1\r\n";
    let file = parse(text).unwrap();
    assert_eq!(file.home, Some((-353_632_610, 1_491_652_300, 584_090)));
    assert_eq!(commands(&file), [22, 16]);
    assert_eq!(file.describe(1), "item 2 (line 6)");

    let unset = "QGC WPL 110\n0 1 0 16 0 0 0 0 0 0 0 1\n1 0 3 22 0 0 0 0 0 0 20 1\n";
    assert_eq!(parse(unset).unwrap().home, None);
    let hold = "QGC WPL 110\n0 1 0 16 3 0 0 0 47 8 500 1\n";
    assert_eq!(parse(hold).unwrap().items.len(), 1, "it holds: no home");
}

#[test]
fn our_missions_are_what_their_readme_says() {
    let monitoring = mission_file::read(&repository("missions/monitoring.plan")).unwrap();
    let expected: Vec<u16> = std::iter::once(22).chain([16, 2000].repeat(10)).collect();
    assert_eq!(commands(&monitoring), expected);
    assert_eq!(monitoring.home, Some((473_977_419, 85_455_938, 488_000)));
    assert_eq!(monitoring.hover_speed, Some(2.0));
    for item in monitoring.items.iter().filter(|item| item.command == 16) {
        assert_eq!((item.params[0], item.z), (3.0, 30.0));
    }
    // Two steps of 20 m north and 30 m east, in 1e-7 degree.
    let [first, second] = [&monitoring.items[1], &monitoring.items[3]];
    assert_eq!((first.x - 473_977_419, first.y), (1799, 85_455_938));
    assert_eq!((second.x, second.y - first.y), (first.x, 3974));

    let survey = mission_file::read(&repository("missions/survey.plan")).unwrap();
    let waypoints = survey.items.iter().filter(|item| item.command == 16);
    assert_eq!(waypoints.clone().count(), 16);
    for item in waypoints {
        assert_eq!((item.params[0], item.params[1]), (0.0, 2.0));
    }
    assert_eq!(commands(&survey)[..4], [22, 178, 16, 206]);
}

#[test]
fn what_is_not_a_mission_is_named_so() {
    let no_mission = "x.plan: is not a mission";
    for junk in [
        b"\x7fELF\0\0".as_slice(),
        b"Q\xff\xfe\0",
        b"hello",
        b"[1, 2]",
        b"{\"fileType\": \"Parameters\", \"version\": 1}",
        b"{}",
        b"QGC WPL",
    ] {
        assert!(refusal(junk).starts_with(no_mission), "{junk:?}");
    }
    assert_eq!(refusal(""), "x.plan: is empty");
    assert_eq!(refusal(" \r\n \n"), "x.plan: is empty");
}

#[test]
fn files_that_cannot_be_read() {
    let folder = mission_file::read(&repository("missions")).unwrap_err();
    assert!(folder.to_string().contains("is a folder"), "{folder}");
    let absent = mission_file::read(Path::new("no/such\nfile")).unwrap_err();
    let message = absent.to_string();
    assert!(
        message.starts_with("no/such\\nfile: cannot be read: "),
        "{message}"
    );
}

#[test]
fn broken_json_is_named_by_line() {
    let cut = &PLAN[..900];
    assert!(refusal(cut).contains("EOF while parsing"), "{}", refusal(cut));
    assert_eq!(
        refusal("{\n  nonsense"),
        "x.plan: line 2, column 3: key must be a string; save the plan again in QGroundControl"
    );
    let twice = edited(
        "\"groundStation\": \"QGroundControl\",",
        "\"fileType\": \"Plan\",",
    );
    assert!(refusal(twice).contains("`fileType` stands twice"));
    let huge = edited("47.39777106", "1e999");
    assert!(refusal(huge).contains("number out of range"));
    let after = format!("{PLAN} 1");
    assert!(refusal(after).contains("trailing characters"));
    let deep = "[".repeat(100_000);
    assert!(refusal(edited("15,", &deep)).contains("recursion limit"));
}

#[test]
fn versions() {
    let plan = PLAN.trim_end().strip_suffix("\"version\": 1\n}").unwrap();
    assert_eq!(
        refusal(format!("{plan} \"version\": 7 }}")),
        "x.plan: version: 7 is not known, only version 1 is read"
    );
    assert_eq!(
        refusal(edited(
            "\"vehicleType\": 2,\n        \"version\": 2",
            "\"version\": 1"
        )),
        "x.plan: mission version: 1 is not known, only version 2 is read"
    );
    let survey = SURVEY.replace("\"version\": 5", "\"version\": 9");
    assert_eq!(
        refusal(survey),
        "x.plan: item 2, survey version: 9 is not known, only version 4 or 5 is read"
    );
    assert_eq!(
        refusal("QGC WPL 120\n"),
        "x.plan: QGC WPL: version 120 is not known, only version 110 is read"
    );
}

#[test]
fn fields_of_a_plan_that_are_missing_or_wrong() {
    let cases = [
        ("\"mission\": {", "\"missing\": {", "mission is missing"),
        (
            "\"items\": [",
            "\"items\": 3, \"x\": [",
            "items: found 3, a list is needed",
        ),
        ("\"command\": 16,", "", "item 2, command is missing"),
        (
            "\"command\": 16,",
            "\"command\": \"16\",",
            "item 2, command: found \"16\", a whole number is needed",
        ),
        (
            "\"command\": 16,",
            "\"command\": 65536,",
            "item 2, command: 65536 is outside 0 to 65535",
        ),
        (
            "\"command\": 16,",
            "\"command\": 16.5,",
            "item 2, command: found 16.5, a whole number is needed",
        ),
        (
            "\"command\": 16,",
            "\"command\": -1,",
            "item 2, command: -1 is outside 0 to 65535",
        ),
        (
            "\"frame\": 3,",
            "\"frame\": 256,",
            "item 1, frame: 256 is outside 0 to 255",
        ),
        (
            "\"autoContinue\": true,",
            "\"autoContinue\": 1,",
            "item 1, autoContinue: found 1, true or false is needed",
        ),
        ("47.39777106", "91", "item 2, latitude: 91 is outside -90 to 90"),
        (
            "8.5466122",
            "-180.5",
            "item 2, longitude: -180.5 is outside -180 to 180",
        ),
        (
            "47.39777106",
            "null",
            "item 2, latitude: found no number (null or NaN), a number is needed",
        ),
        (
            "47.39777106",
            "\"47\"",
            "item 2, parameter 5: found \"47\", a number or null is needed",
        ),
        (
            "47.39777106,",
            "",
            "item 2, params: found a list of 6, a list of 7 numbers is needed",
        ),
        (
            "\"type\": \"SimpleItem\"",
            "\"type\": \"a\\nb\"",
            "item 1, type: \"a\\nb\" is not flown; known are SimpleItem and ComplexItem",
        ),
        (
            "\"type\": \"SimpleItem\"",
            "\"kind\": 1",
            "item 1, type is missing",
        ),
        (
            "\"hoverSpeed\": 5",
            "\"hoverSpeed\": -5",
            "hoverSpeed: -5 is outside 0 to 1000",
        ),
        (
            "488.93101752001763",
            "true",
            "plannedHomePosition: found true, a number is needed",
        ),
        (
            "            47.3977507,\n            8.5456075,\n            488.93101752001763",
            "1",
            "plannedHomePosition: found a list of 1, latitude, longitude and altitude is needed",
        ),
    ];
    for (from, to, message) in cases {
        assert_eq!(refusal(edited(from, to)), format!("x.plan: {message}"));
    }
}

#[test]
fn fields_that_may_be_absent() {
    let nulls = edited("488.93101752001763", "null");
    assert_eq!(parse(nulls).unwrap().home.unwrap().2, 0);
    let unset = edited("\"plannedHomePosition\"", "\"x\"").replace("\"hoverSpeed\": 5,", "");
    let file = parse(unset).unwrap();
    assert_eq!((file.home, file.hover_speed), (None, None));
}

#[test]
fn patterns_that_are_not_flown_say_what_to_do() {
    let pattern = |kind: &str| refusal(SURVEY.replace("\"survey\"", &format!("\"{kind}\"")));
    let start = "x.plan: item 2, complexItemType: ";
    for kind in ["StructureScan", "fwLandingPattern", "vtolLandingPattern", "other"] {
        let message = pattern(kind);
        let expected = format!("{start}\"{kind}\" is not flown; ");
        assert!(message.starts_with(&expected), "{message}");
    }
    let unstored = refusal(SURVEY.replace("\"Items\"", "\"Other\""));
    assert!(unstored.contains("a survey without stored items is not flown; open and save"));
    let inside = SURVEY.replace("47.39748113179102", "91");
    assert_eq!(
        refusal(inside),
        "x.plan: item 2 (survey), part 8, latitude: 91 is outside -90 to 90"
    );
    let corridor = SURVEY
        .replace("\"survey\"", "\"CorridorScan\"")
        .replace("\"version\": 5", "\"version\": 2");
    assert_eq!(parse(corridor).unwrap().items.len(), 13);
}

#[test]
fn fences_rally_points_and_other_vehicles_are_noted() {
    let fence = edited(
        "\"polygons\": [",
        "\"polygons\": [ {\"polygon\": [], \"version\": 1}",
    );
    let file = parse(fence.replace("\"points\": [", "\"points\": [[1, 2, 3]")).unwrap();
    assert!(file.has_geofence && file.has_rally_points);
    assert_eq!(file.notes.len(), 2);
    let plane = parse(edited("\"vehicleType\": 2", "\"vehicleType\": 1")).unwrap();
    assert!(plane.notes[0].contains("vehicle type 1"));
}

#[test]
fn lines_of_a_waypoint_file_that_are_wrong() {
    let cases = [
        ("0 1 3 16 0 0 0 0 47 8 20", "line 2: 11 fields, an item has 12"),
        (
            "1 1 3 16 0 0 0 0 47 8 20 1",
            "line 2: item 1 stands where item 0 is due",
        ),
        (
            "0 1 3 16 0 0 0 0 91 8 20 1",
            "item 0 (line 2), latitude: 91 is outside -90 to 90",
        ),
        (
            "0 1 3 16 0 0 0 0 nan 8 20 1",
            "item 0 (line 2), latitude: found no number (null or NaN), a number is needed",
        ),
        (
            "0 1 3 16 0 0 0 0 47 inf 20 1",
            "item 0 (line 2), longitude: inf is outside -180 to 180",
        ),
        (
            "0 1 3 16 0 0 0 0 47,1 8 20 1",
            "item 0 (line 2), parameter 5: found \"47,1\", a number with a decimal point is needed",
        ),
        (
            "0 1 3 16 0 0 0 0 47 8 1e99 1",
            "item 0 (line 2), altitude: 1e99 is outside -3.4028234663852886e38 to 3.4028234663852886e38",
        ),
        (
            "0 1 256 16 0 0 0 0 47 8 20 1",
            "item 0 (line 2), frame: 256 is outside 0 to 255",
        ),
        (
            "0 1 3 70000 0 0 0 0 47 8 20 1",
            "item 0 (line 2), command: 70000 is outside 0 to 65535",
        ),
        (
            "0 1 3 x 0 0 0 0 47 8 20 1",
            "item 0 (line 2), command: found \"x\", a whole number is needed",
        ),
        (
            "0 1 3 16 0 0 0 0 47 8 20 2",
            "item 0 (line 2), autocontinue: 2 is outside 0 to 1",
        ),
        (
            "0 2 3 16 0 0 0 0 47 8 20 1",
            "item 0 (line 2), current: 2 is outside 0 to 1",
        ),
    ];
    for (line, message) in cases {
        assert_eq!(
            refusal(format!("QGC WPL 110\n{line}\n")),
            format!("x.plan: {message}")
        );
    }
    let again = format!("{WAYPOINTS}\n3\t0\t3\t16\t0\t0\t0\t0\t1\t2\t3\t1\n");
    assert_eq!(
        refusal(again),
        "x.plan: line 6: item 3 stands where item 4 is due"
    );
    let long = format!("QGC WPL 110\n{}\n", "1".repeat(2000));
    assert_eq!(
        refusal(long),
        "x.plan: line 2: is not text, or longer than 1000 bytes"
    );
}

/// A plan with `count` waypoints, compact.
fn plan_of(count: usize) -> String {
    let item =
        r#"{"type":"SimpleItem","autoContinue":true,"command":16,"frame":3,"params":[0,0,0,null,47,8,30]}"#;
    let items = vec![item; count].join(",");
    format!(r#"{{"fileType":"Plan","version":1,"mission":{{"version":2,"items":[{items}]}}}}"#)
}

#[test]
fn a_mission_that_is_too_long_is_refused_with_its_length() {
    assert_eq!(parse(plan_of(MAX_ITEMS)).unwrap().items.len(), MAX_ITEMS);
    let message = refusal(plan_of(MAX_ITEMS + 1));
    assert_eq!(message, "x.plan: has 257 items, a mission holds at most 256");
    let million = refusal(plan_of(1_000_000));
    assert_eq!(million, "x.plan: has 1000000 items, a mission holds at most 256");

    let line = |seq: usize| format!("{seq} 0 3 16 0 0 0 0 47 8 30 1\n");
    let lines: String = (0..300_000).map(line).collect();
    let message = refusal(format!("QGC WPL 110\n{lines}"));
    assert_eq!(message, "x.plan: has 300000 items, a mission holds at most 256");

    let (start, part) = SURVEY.split_once("\"Items\": [").unwrap();
    let many = "{},".repeat(500);
    let message = refusal(format!("{start}\"Items\": [{many}{part}"));
    assert_eq!(message, "x.plan: has 513 items, a mission holds at most 256");
}

#[test]
fn memory_is_bounded_whatever_the_nesting() {
    let level = |inner: &str| format!("{{\"items\":[{}]}}", vec![inner; 200].join(","));
    let plan = level(&level(&level("1")));
    let text = format!(r#"{{"fileType":"Plan","version":1,"mission":{plan}}}"#);
    assert!(refusal(text).contains("mission version is missing"));
    let text = edited("\"items\": [", &format!("\"items\": [{plan},"));
    assert!(refusal(text).contains("more data than a mission needs"));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse(&bytes);
        let _ = parse([b"{\"fileType\":\"Plan\",".as_slice(), &bytes].concat());
        let _ = parse([b"QGC WPL 110\n".as_slice(), &bytes].concat());
    }

    #[test]
    fn damaged_files_are_read_or_refused_in_one_line(
        which in 0..3_usize,
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        drop in 0..40_usize,
    ) {
        let mut bytes = [PLAN, SURVEY, WAYPOINTS][which].as_bytes().to_vec();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let at = cut.index(bytes.len());
        let end = (at + drop).clamp(0, bytes.len());
        bytes.drain(at..end);
        match parse(&bytes) {
            Ok(file) => prop_assert!(file.items.len() <= MAX_ITEMS),
            Err(message) => prop_assert!(!message.contains('\n') && message.chars().count() < 500),
        }
    }
}
