//! Failsafes as a user tries them: told before the figures, in the report and in the conditions.

use super::{Folder, run, run_out, stderr, stdout};

/// Flies with these options; exit code and text. The report tells the same events.
fn fly(name: &str, options: &[&str]) -> (Option<i32>, String) {
    let folder = Folder::new(name);
    let output = run_out(&folder, options);
    let text = stdout(&output);
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    let page = std::fs::read_to_string(folder.out().join("report.html")).unwrap();
    let list = page
        .split_once("<ol class=\"events\">")
        .expect("a list of events")
        .1;
    let list = list.split_once("</ol>").expect("its end").0;
    for line in text.lines().take_while(|line| !line.is_empty()) {
        let (_, event) = line.split_once(" s  ").expect("a time and an event");
        assert!(list.contains(event), "no {event:?} in {list}");
    }
    (output.status.code(), text)
}

fn assert_tells(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(
            text.lines().any(|told| told.contains(line)),
            "no {line:?} in {text}"
        );
    }
}

#[test]
fn a_lost_remote_control_returns_or_does_what_is_set() {
    let fault = ["--rc", "--fault", "rc-dropout@45"];
    let (code, text) = fly("rc-return", &fault);
    assert_eq!(code, Some(1));
    let lines = [
        "fault rc-dropout from here on",
        "45.5 s  failsafe rc_lost: remote control lost; mode return",
        "no: landed at ",
    ];
    assert_tells(&text, &lines);

    let (_, text) = fly("rc-land", &[&fault[..], &["--set", "NAV_RCL_ACT=3"]].concat());
    assert_tells(
        &text,
        &["45.5 s  failsafe rc_lost: remote control lost; mode land"],
    );

    let (code, text) = fly("rc-warn", &[&fault[..], &["--set", "NAV_RCL_ACT=0"]].concat());
    assert_eq!(code, Some(0), "{text}");
    assert_tells(
        &text,
        &[
            "45.5 s  failsafe rc_lost: remote control lost",
            "mode return",
            "disarmed",
        ],
    );

    // Motors off in flight: it falls.
    let (code, text) = fly("rc-off", &[&fault[..], &["--set", "NAV_RCL_ACT=6"]].concat());
    assert_eq!(code, Some(1));
    let lines = [
        "45.5 s  disarmed; failsafe rc_lost: remote control lost",
        "no: motors off in flight at 45.5 s (remote control lost), crash at ",
    ];
    assert_tells(&text, &lines);
}

#[test]
fn a_battery_that_runs_low_is_told_and_acted_on() {
    // Low, but enough to come home.
    let (code, text) = fly("battery-low", &["--battery", "35"]);
    assert_eq!(code, Some(0), "{text}");
    assert_tells(
        &text,
        &["failsafe battery_low: battery low", "mode return", "disarmed"],
    );
    let (code, text) = fly(
        "battery-critical",
        &["--battery", "40", "--set", "BAT_CRIT_THR=0.3"],
    );
    assert_eq!(code, Some(1));
    assert_tells(
        &text,
        &["failsafe battery_critical: battery critical; mode return"],
    );
    // Too little to take off with.
    let (code, text) = fly("battery-empty", &["--battery", "10"]);
    assert_eq!(code, Some(1));
    assert_tells(&text, &["no: given up at 60.0 s: battery low: "]);
}

/// The inner step stops the motors by itself.
#[test]
fn silent_inertial_sensors_are_named() {
    let (code, text) = fly("imu", &["--fault", "imu-dropout@45"]);
    assert_eq!(code, Some(1));
    let lines = [
        "fault imu-dropout from here on: nothing comes; disarmed",
        "no: motors off in flight at 45.0 s (inertial sensors silent, motors off), crash at ",
    ];
    assert_tells(&text, &lines);
}

#[test]
fn what_is_set_stands_in_the_report() {
    let folder = Folder::new("set");
    let set = ["--set", "GF_ACTION=1", "--battery", "80", "--rc", "--json"];
    let output = run_out(&folder, &set);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(serde_json::from_str::<serde_json::Value>(&stdout(&output)).is_ok());
    let page = std::fs::read_to_string(folder.out().join("report.html")).unwrap();
    for words in ["<dd>GF_ACTION=1</dd>", "<dd>80 %</dd>", "Remote control"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn tables_are_listed() {
    let folder = Folder::new("tables");
    let text = |arguments: &[&str]| {
        let output = run(&folder, arguments);
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{arguments:?}"
        );
        stdout(&output)
    };
    let parameters = text(&["parameters"]);
    assert!(parameters.starts_with("name ") && parameters.contains("\nMPC_XY_CRUISE "));
    assert_eq!(text(&["parameters", "mpc_xy_cruise"]).lines().count(), 2);
    assert!(text(&["parameters", "--markdown"]).starts_with("# Parameters\n"));
    assert!(text(&["failsafes"]).contains("\nrc_lost "));
    assert!(text(&["failsafes", "--markdown"]).starts_with("# Failsafes\n"));

    let unknown = run(&folder, &["parameters", "SPEEDY"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert_eq!(
        stderr(&unknown),
        "error: there is no parameter SPEEDY; `windhover parameters` lists them\n"
    );
}
