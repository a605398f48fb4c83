//! The program as its users call it: what it prints, where, what it leaves behind, and its exit
//! code.

mod failsafes;
mod refused;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder that is gone again after the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("windhover-cli-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// A file in it.
    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    fn out(&self) -> PathBuf {
        self.0.join("out")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Runs the program in an empty folder of its own, so that nothing it finds there can help it.
fn run(folder: &Folder, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_windhover"));
    command.args(arguments).current_dir(&folder.0);
    command.output().expect("the program runs")
}

/// The same, with `--out`.
fn run_out(folder: &Folder, arguments: &[&str]) -> Output {
    let out = folder.out();
    let with: Vec<&str> = arguments
        .iter()
        .copied()
        .chain(["--out", out.to_str().unwrap()])
        .collect();
    run(folder, &with)
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn repository(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file);
    path.to_str().unwrap().to_string()
}

/// The default flight, in an empty folder: report and figures where the documentation says.
#[test]
fn without_arguments_it_flies_the_default_mission() {
    let folder = Folder::new("default");
    let output = run(&folder, &[]);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for line in ["completed", "waypoints reached", "RMSE", "motor hash", "report: "] {
        assert!(text.contains(line), "no {line:?} in {text}");
    }
    // What happened stands before the figures, a line each.
    let events: Vec<&str> = text.lines().take_while(|line| !line.is_empty()).collect();
    let told = |what: &str| events.iter().position(|line| line.ends_with(what));
    let order = [
        "armed; mode takeoff",
        "mode mission",
        "mode return",
        "mode land",
        "landed",
        "disarmed",
    ];
    let places = order.map(|what| told(what).unwrap_or_else(|| panic!("no {what:?} in {text}")));
    assert!(places.is_sorted(), "{text}");
    assert_eq!(events.len(), order.len() + 2, "these and two pushes: {text}");
    let written = folder.0.join("flights").join("monitoring");
    let page = std::fs::read_to_string(written.join("report.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") || page.starts_with("<!doctype html>"));
    let figures = std::fs::read_to_string(written.join("figures.json")).unwrap();
    let figures: serde_json::Value = serde_json::from_str(&figures).unwrap();
    assert_eq!(figures["completed"], true);
    let ended = figures["ended"].as_str().unwrap();
    assert!(ended.starts_with("mission completed, landed at "), "{ended}");
    assert!(page.contains(ended) && page.contains("mode return") && page.contains("armed; mode takeoff"));
    assert_eq!(figures["waypoints_reached"], 10);
    assert_eq!(figures["photos"].as_array().unwrap().len(), 10);
    assert_eq!(figures["seed"], 1);
}

/// Everything that the issue names, in one object, and nothing else on stdout; not even on stderr
/// when nobody watches.
#[test]
fn json_is_one_object_and_nothing_else() {
    let folder = Folder::new("json");
    let output = run_out(&folder, &["fly", "--json", "--seed", "3"]);
    let text = stdout(&output);
    let figures: serde_json::Value = serde_json::from_str(&text).expect("one JSON value");
    let object = figures.as_object().expect("an object");
    for key in [
        "completed",
        "duration_s",
        "waypoints_reached",
        "photos",
        "rmse_m",
        "max_error_m",
        "cross_track_rmse_m",
        "tilt_max_deg",
        "saturated_fraction",
        "energy_j",
        "speed_factor",
        "motor_hash",
        "seed",
    ] {
        assert!(object.contains_key(key), "no {key}");
    }
    for axes in ["rmse_m", "max_error_m"] {
        for axis in ["north", "east", "down"] {
            assert!(figures[axes][axis].as_f64().is_some(), "{axes}.{axis}");
        }
    }
    for key in ["position_error_m", "speed_m_s", "tilt_deg"] {
        assert!(figures["photos"][0][key].as_f64().is_some(), "{key}");
    }
    assert!(figures["speed_factor"].as_f64().unwrap() > 0.0);
    assert_eq!(figures["seed"], 3);
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    assert!(folder.out().join("report.html").exists());
}

/// `fly FILE` for a plan, a plan with a survey, and a waypoint file.
#[test]
fn it_flies_files_of_either_kind() {
    for file in [
        "missions/survey.plan",
        "crates/sim/tests/data/qgroundcontrol_sample_with_survey.plan",
        "crates/sim/tests/data/mission_planner_sample.txt",
    ] {
        let folder = Folder::new(Path::new(file).file_stem().unwrap().to_str().unwrap());
        let path = repository(file);
        let output = run_out(&folder, &["fly", &path, "--json"]);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{file}: {told}");
        let figures: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!(figures["completed"], true, "{file}");
        assert!(figures["waypoints_reached"].as_u64().unwrap() >= 2, "{file}");
    }
}

/// Every option changes the flight: its motor commands differ from the default's.
#[test]
fn options_change_the_flight() {
    let folder = Folder::new("options");
    let hash = |arguments: &[&str]| {
        let mut all = vec!["fly", "--json"];
        all.extend_from_slice(arguments);
        let output = run_out(&folder, &all);
        // Some of them bring it home early.
        assert_ne!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            stderr(&output)
        );
        let figures: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        figures["motor_hash"].as_str().unwrap().to_string()
    };
    let default = hash(&[]);
    assert_eq!(default, hash(&[]), "the same again");
    assert_eq!(default, hash(&["--gnss", "standard"]), "defaults");
    let told = hash(&["--model", "paper"]);
    assert_eq!(
        told,
        hash(&["--model", "paper", "--truth"]),
        "always on the truth"
    );
    assert_eq!(
        default,
        hash(&["--wind", "4.47,206.6", "--gust", "1"]),
        "defaults"
    );
    assert_eq!(
        default,
        hash(&["--push", "30,4,0,0,0.5", "--push", "60,0,4,0,0.5"]),
        "defaults"
    );
    let others: Vec<&[&str]> = vec![
        &["--vehicle", "x450"],
        &["--preset", "paper"],
        &["--wind", "3,90"],
        &["--gust", "0.5"],
        &["--push", "20,1,0,0,1"],
        &["--payload", "0.05"],
        &["--model", "paper"],
        &["--model", "simple"],
        &["--seed", "2"],
        &["--truth"],
        &["--gnss", "rtk"],
        &["--fault", "baro-bias-step@50,5"],
        &["--fault", "baro-bias-step@50"],
        &["--set", "MPC_XY_CRUISE=2.5"],
        &["--set", "MPC_XY_CRUISE=2.5", "--set", "RTL_RETURN_ALT=40"],
    ];
    let mut seen = vec![default];
    for other in others {
        let flown = hash(other);
        assert!(!seen.contains(&flown), "{other:?} changes nothing");
        seen.push(flown);
    }
}

fn os4() -> String {
    std::fs::read_to_string(repository("vehicles/os4.toml")).unwrap()
}

fn edited(from: &str, to: &str) -> String {
    let text = os4();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

/// A flight that fails ends with what and when, exit code 1, and still writes its report.
fn assert_fails(folder: &Folder, arguments: &[&str], words: &[&str]) {
    let output = run_out(folder, arguments);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(1), "{text}{}", stderr(&output));
    for word in words {
        assert!(text.contains(word), "no {word:?} in {text}");
    }
    let out = folder.out();
    assert!(out.join("report.html").exists());
    let figures = std::fs::read_to_string(out.join("figures.json")).unwrap();
    let figures: serde_json::Value = serde_json::from_str(&figures).unwrap();
    assert_eq!(figures["completed"], false);
    let ended = figures["ended"].as_str().unwrap();
    assert!(ended.contains(" at ") && ended.contains(" s"), "{ended}");
}

#[test]
fn a_flight_that_fails_says_what_and_when_and_leaves_its_report() {
    let folder = Folder::new("fails");
    // A core that takes the vehicle for thirty times as hard to turn as it is.
    let wild = edited("INERTIA_XX = 7.5e-3", "INERTIA_XX = 0.225");
    let wild = folder.file("wild.toml", &wild);
    assert_fails(
        &folder,
        &["--vehicle", wild.to_str().unwrap()],
        &["completed", "no: crash at "],
    );
    // A storm that carries it away.
    assert_fails(
        &folder,
        &["--wind", "90,0", "--gust", "0"],
        &["no: crash at ", "sideways"],
    );
}

/// Hours of standing at full thrust would tell nobody more.
#[test]
fn a_vehicle_that_is_too_heavy_is_given_up_at_once() {
    let folder = Folder::new("heavy");
    assert_fails(
        &folder,
        &["fly", "--payload", "5"],
        &["too heavy", "given up at 14"],
    );
}

/// With `--json`, too, the object is all there is on stdout.
#[test]
fn a_flight_that_fails_is_json_too() {
    let folder = Folder::new("fails-json");
    let output = run_out(&folder, &["--wind", "90,0", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let figures: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(figures["completed"], false);
}

#[test]
fn help_names_every_option() {
    let folder = Folder::new("help");
    for arguments in [&["--help"][..], &["fly", "--help"]] {
        let output = run(&folder, arguments);
        let text = stdout(&output);
        assert!(output.status.success() && output.stderr.is_empty());
        for option in [
            "--vehicle",
            "--preset",
            "--wind",
            "--gust",
            "--push",
            "--payload",
            "--model",
            "--truth",
            "--fault",
            "--rc",
            "--battery",
            "--set",
            "--seed",
            "--out",
            "--json",
            "missions/monitoring.plan",
        ] {
            assert!(text.contains(option), "{arguments:?}: no {option}");
        }
    }
    assert!(stdout(&run(&folder, &["--version"])).starts_with("windhover "));
}

/// A folder that cannot be written to is named.
#[test]
fn a_report_that_cannot_be_written_is_an_error() {
    let folder = Folder::new("out");
    let file = folder.file("taken", "");
    let output = run(&folder, &["--out", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("taken"), "{}", stderr(&output));
}
