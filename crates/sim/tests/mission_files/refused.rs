//! Every way in which a file can be wrong, and the line that says so.

use std::path::Path;

use windhover_sim::mission_file;

use super::{PLAN, SURVEY, WAYPOINTS, edited, parse, refusal, repository};

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
            "plannedHomePosition: found a list of 1, latitude and longitude is needed",
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
fn other_vehicles_are_noted() {
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
