//! What the program refuses, and how it says so.

use super::{Folder, edited, run_out, stderr};

/// Refused: exit code 2, one line on stderr with all of these words, nothing on stdout, nothing
/// written.
fn assert_refused(folder: &Folder, arguments: &[&str], words: &[&str]) {
    let output = run_out(folder, arguments);
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
    assert_eq!(told.trim_end().lines().count(), 1, "{arguments:?}: {told}");
    assert!(told.starts_with("error: "), "{told}");
    for word in words {
        assert!(told.contains(word), "{arguments:?}: no {word:?} in {told}");
    }
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert!(!folder.out().exists(), "{arguments:?}: something was written");
}

#[test]
fn bad_options_are_refused_in_one_line() {
    let folder = Folder::new("bad-options");
    let cases: &[(&[&str], &str)] = &[
        (&["--wind", "-1,0"], "wind"),
        (&["--wind", "nan,0"], "--wind"),
        (&["--wind", "3"], "--wind"),
        (&["--wind", "500,0"], "wind"),
        (&["--gust", "-1"], "gust"),
        (&["--gust", "NaN"], "gust"),
        (&["--push", "1,2,3"], "--push"),
        (&["--push", "-1,2,3,4,5"], "push"),
        (&["--payload", "-0.1"], "payload"),
        (&["--payload", "inf"], "payload"),
        (&["--seed", "-3"], "seed"),
        (&["--vehicle", "spaceship"], "--vehicle"),
        (&["--model", "cubic"], "--model"),
        (&["--preset", "mine"], "--preset"),
        (&["--altitude", "5"], "--altitude"),
        (&["--battery", "101"], "101 % is outside 0 to 100"),
        (&["--battery", "-1"], "-1 % is outside 0 to 100"),
        (&["--battery", "full"], "'full' is not a number"),
        (&["--battery", "50", "--truth"], "--truth"),
        (&["--rc", "--truth"], "--truth"),
        (&["--rc", "--model", "paper"], "--rc"),
        (&["--battery", "50", "--model", "simple"], "--battery"),
        (&["--set", "GF_ACTION"], "NAME=VALUE is wanted"),
        (&["--set", "GF_ACTION=9"], "GF_ACTION: the range is 0 to 5"),
        (&["--set", "GF_ACTION=one"], "'one' is not a number"),
        (&["--set", "ALTITUDE=5"], "there is no parameter ALTITUDE"),
        (
            &["--set", "CA_ROTOR0_PX=-0.23"],
            "--set CA_ROTOR0_PX=-0.23: [parameters]",
        ),
    ];
    for (arguments, word) in cases {
        assert_refused(&folder, arguments, &[word]);
        let mut after_fly = vec!["fly"];
        after_fly.extend_from_slice(arguments);
        assert_refused(&folder, &after_fly, &[word]);
    }
}

/// A plan of one waypoint with what is given in its place.
fn plan(latitude: &str, height: &str, command: u16) -> String {
    format!(
        r#"{{"fileType":"Plan","version":1,"groundStation":"x","mission":{{"version":2,"firmwareType":12,
        "vehicleType":2,"cruiseSpeed":2,"hoverSpeed":2,"plannedHomePosition":[47.3977,8.5456,488],"items":[
        {{"type":"SimpleItem","autoContinue":true,"command":22,"frame":3,"doJumpId":1,"params":[0,0,0,null,47.3977,8.5456,10]}},
        {{"type":"SimpleItem","autoContinue":true,"command":{command},"frame":3,"doJumpId":2,"params":[0,0,0,null,{latitude},8.5456,{height}]}}]}}}}"#
    )
}

/// A mission that cannot be flown is refused with file, item and field.
#[test]
fn bad_missions_are_refused_in_one_line() {
    let folder = Folder::new("bad-missions");
    let cases: &[(&str, String, &[&str])] = &[
        ("latitude.plan", plan("91", "10", 16), &["item 2", "latitude"]),
        ("high.plan", plan("47.3977", "5000", 16), &["item 2", "altitude"]),
        ("far.plan", plan("48.9", "10", 16), &["item 2", "position"]),
        (
            "command.plan",
            plan("47.3977", "10", 84),
            &["item 2", "command", "84"],
        ),
        ("nan.plan", plan("47.3977", "NaN", 16), &[]),
        ("null.plan", plan("47.3977", "null", 16), &["item 2"]),
        ("nowhere.plan", plan("47.3977", "10", 22), &["waypoint"]),
        ("text.plan", "hello".into(), &[]),
        ("empty.plan", String::new(), &[]),
        (
            "wpl.txt",
            "QGC WPL 110\n0\t1\t3\t16\t0\t0\t0\t0\tx\t8\t10\t1\n".into(),
            &["line 2"],
        ),
        (
            "old.plan",
            plan("47.3977", "10", 16).replace(r#""version":1"#, r#""version":9"#),
            &["version"],
        ),
    ];
    for (name, text, words) in cases {
        let file = folder.file(name, text);
        let mut all = vec![*name];
        all.extend_from_slice(words);
        assert_refused(&folder, &["fly", file.to_str().unwrap()], &all);
    }
    assert_refused(&folder, &["fly", "absent.plan"], &["absent.plan"]);
    // The same plan with nothing wrong is flown.
    let good = folder.file("good.plan", &plan("47.3978", "10", 16));
    let output = run_out(&folder, &["fly", good.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn bad_vehicles_are_refused_in_one_line() {
    let folder = Folder::new("bad-vehicles");
    let cases: &[(&str, String, &[&str])] = &[
        (
            "mass.toml",
            edited("mass = 0.650", "mass = -0.650"),
            &["plant.mass", "-0.65"],
        ),
        (
            "inertia.toml",
            edited("[7.5e-3, 7.5e-3", "[0.0, 7.5e-3"),
            &["plant.inertia"],
        ),
        ("nan.toml", edited("k_f = 3.13e-5", "k_f = nan"), &["plant.k_f"]),
        ("missing.toml", edited("k_z", "k_q"), &["k_q"]),
        (
            "unknown.toml",
            edited("MASS = 0.650", "MASSE = 0.650"),
            &["MASSE"],
        ),
        (
            "range.toml",
            edited("MASS = 0.650", "MASS = -1.0"),
            &["MASS", "-1"],
        ),
        (
            "rotor.toml",
            edited("CA_ROTOR0_PX = 0.23", "CA_ROTOR0_PX = -0.23"),
            &["[parameters]"],
        ),
        ("text.toml", "hello".into(), &["line 1"]),
    ];
    for (name, text, words) in cases {
        let file = folder.file(name, text);
        let mut all = vec![*name];
        all.extend_from_slice(words);
        assert_refused(&folder, &["--vehicle", file.to_str().unwrap()], &all);
    }
    assert_refused(&folder, &["--vehicle", "absent.toml"], &["absent.toml"]);
}

/// The plan of [`plan`] with a fence and rally points.
fn fenced(polygons: &str, circles: &str, rally: &str) -> String {
    let parts = format!(
        r#"{{"fileType":"Plan","geoFence":{{"version":2,"polygons":[{polygons}],"circles":[{circles}]}},
        "rallyPoints":{{"version":2,"points":[{rally}]}},"#
    );
    plan("47.3980", "10", 16).replacen(r#"{"fileType":"Plan","#, &parts, 1)
}

fn circle(radius: f64, inclusion: bool) -> String {
    format!(r#"{{"inclusion":{inclusion},"circle":{{"center":[47.3977,8.5456],"radius":{radius}}}}}"#)
}

/// A fence that cannot be kept, and a mission that leaves it, are refused before the flight.
#[test]
fn bad_fences_are_refused_in_one_line() {
    let folder = Folder::new("bad-fences");
    let bow_tie =
        r#"{"inclusion":true,"polygon":[[47.3967,8.545],[47.3987,8.547],[47.3987,8.545],[47.3967,8.547]]}"#;
    let far = r#"{"inclusion":false,"polygon":[[47.39785,8.545],[47.39785,8.547],[47.3979,8.547],[47.3979,8.545]]}"#;
    let cases: &[(&str, String, &[&str])] = &[
        // The waypoint is 33 m north of home.
        (
            "leaves.plan",
            fenced("", &circle(20.0, true), ""),
            &["item 2, waypoint: leg leaves the geofence; move it or the fence"],
        ),
        (
            "across.plan",
            fenced(far, "", ""),
            &["item 2, waypoint: leg leaves the geofence"],
        ),
        (
            "inside.plan",
            fenced("", &circle(5.0, false), ""),
            &["item 1, takeoff: leg leaves the geofence"],
        ),
        (
            "bow-tie.plan",
            fenced(bow_tie, "", ""),
            &["geofence polygon 1: crosses or touches itself; move its vertices apart"],
        ),
        (
            "huge.plan",
            fenced("", &[circle(100.0, true), circle(20_000.0, true)].join(","), ""),
            &["geofence circle 2: a radius of 20000 m is outside 1 to 10000"],
        ),
        (
            "rally.plan",
            fenced("", "", "[47.3977,8.5456,20],[47.3977,8.5456,1e9]"),
            &["rally point 2: altitude"],
        ),
    ];
    for (name, text, words) in cases {
        let file = folder.file(name, text);
        let mut all = vec![*name];
        all.extend_from_slice(words);
        assert_refused(&folder, &["fly", file.to_str().unwrap()], &all);
    }
    // The same with room is flown, and so is the mission that leaves it when the fence is off.
    for (name, text, more) in [
        (
            "good.plan",
            fenced("", &circle(60.0, true), "[47.3977,8.5456,20]"),
            None,
        ),
        (
            "off.plan",
            fenced("", &circle(20.0, true), ""),
            Some("GF_ACTION=0"),
        ),
    ] {
        let file = folder.file(name, &text);
        let mut arguments = vec!["fly", file.to_str().unwrap(), "--json"];
        arguments.extend(more.iter().flat_map(|set| ["--set", set]));
        let output = run_out(&folder, &arguments);
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        let _ = std::fs::remove_dir_all(folder.out());
    }
}
