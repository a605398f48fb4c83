//! Mission files as ground stations save them, and everything that can be wrong with one.

mod fences;
mod hostile;
mod refused;

use std::path::{Path, PathBuf};

use windhover_sim::mission_file::{self, MissionFile};

const PLAN: &str = include_str!("../data/qgroundcontrol_sample.plan");
const SURVEY: &str = include_str!("../data/qgroundcontrol_sample_with_survey.plan");
const WAYPOINTS: &str = include_str!("../data/mission_planner_sample.txt");

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
