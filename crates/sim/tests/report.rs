//! The report: self-contained, well-formed, and calm about missing data.

use std::path::Path;

use windhover_sim::report::{Event, Figure, PhotoMark, Report, Sample, html};

/// Samples a second of the made-up flight.
const RATE: f32 = 250.0;

/// The corners of the made-up path: north and east in m.
const CORNERS: [(f32, f32); 11] = [
    (0.0, 0.0),
    (20.0, 0.0),
    (20.0, 30.0),
    (40.0, 30.0),
    (40.0, 0.0),
    (60.0, 0.0),
    (60.0, 30.0),
    (80.0, 30.0),
    (80.0, 0.0),
    (100.0, 0.0),
    (100.0, 30.0),
];

/// The setpoint of the made-up flight: up, then each leg in 15 s, then a stop of 3 s.
fn setpoint(time: f32) -> [f32; 3] {
    let ease = |t: f32| {
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let down = -30.0 * ease(time / 18.0);
    let after = (time - 18.0).clamp(0.0, 180.0) / 18.0;
    let leg = (after as usize).clamp(0, 9);
    let part = ease((after - leg as f32) * 18.0 / 15.0);
    let ((n0, e0), (n1, e1)) = (CORNERS[leg], CORNERS[leg + 1]);
    [n0 + part * (n1 - n0), e0 + part * (e1 - e0), down]
}

/// A sample of the made-up flight: the setpoint with waves around it.
fn sample(index: usize) -> Sample {
    let time = index as f32 / RATE;
    let wave = |hertz: f32, phase: f32| libm::sinf(hertz * core::f32::consts::TAU * time + phase);
    let gust = |phase| 0.6 * wave(0.11, phase) + 0.3 * wave(0.53, phase) + 0.1 * wave(2.9, phase);
    let push = |at: f32| 0.7 * libm::expf(-(time - at - 1.0) * (time - at - 1.0));
    let wanted = setpoint(time);
    let position = [
        wanted[0] + 0.12 * gust(0.0) + push(30.0),
        wanted[1] + 0.1 * gust(1.0) + push(60.0),
        wanted[2] + 0.02 * gust(2.0),
    ];
    let later = setpoint(time + 0.01);
    let attitude_setpoint = [4.0 + 2.0 * gust(1.0), -7.0 + 2.0 * gust(0.0), 0.0];
    Sample {
        time,
        position,
        position_setpoint: wanted,
        velocity: core::array::from_fn(|i| (later[i] - wanted[i]) * 100.0),
        attitude: [
            attitude_setpoint[0] + 0.4 * wave(1.7, 0.3),
            attitude_setpoint[1] + 0.4 * wave(1.9, 0.9),
            0.3 * gust(0.4),
        ],
        attitude_setpoint,
        rotor_speed: core::array::from_fn(|i| 226.0 + 8.0 * gust(i as f32 * 1.6)),
        wind: [4.0 + gust(0.0), 2.0 + gust(1.0), 0.3 * gust(2.0)],
    }
}

fn flight() -> Report {
    let samples: Vec<Sample> = (0..(200.0 * RATE) as usize).map(sample).collect();
    let text = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    let figure = |label: &str, value: &str, unit: &str| Figure {
        label: label.into(),
        value: value.into(),
        unit: unit.into(),
    };
    let photos = (0..10).map(|stop| {
        let at = samples[((35.9 + 18.0 * stop as f32) * RATE) as usize];
        PhotoMark {
            time: at.time,
            position: at.position,
            position_error: 0.021 + 0.004 * stop as f32,
            speed: 0.032,
            tilt: 8.1,
        }
    });
    let corners = CORNERS.iter().map(|(north, east)| [*north, *east, -30.0]);
    Report {
        title: "Flight of monitoring.plan".into(),
        subtitle: "Completed in 198.4 s: 10 of 10 waypoints, 10 photos.".into(),
        conditions: vec![
            text("Vehicle", "os4"),
            text("Model", "rigid"),
            text("Preset", "windhover"),
            text("Wind", "4.47 m/s from 206.6°"),
            text("Gusts", "1 m/s"),
            text("Payload", "0 kg"),
            text("Estimate", "true state"),
            text("Seed", "1"),
        ],
        figures: vec![
            figure("Completed", "yes", ""),
            figure("Duration", "198.4", "s"),
            figure("Photos", "10 of 10", ""),
            figure("RMSE north", "0.041", "m"),
            figure("RMSE east", "0.038", "m"),
            figure("RMSE down", "0.009", "m"),
            figure("Cross-track RMSE", "0.036", "m"),
            figure("Largest tilt", "14.2", "°"),
            figure("Saturated", "0.0", "%"),
            figure("Energy", "21 480", "J"),
            figure("Speed factor", "412", "×"),
            figure("Motor hash", "9f31c2d40a77e5b1", ""),
        ],
        path: [[0.0, 0.0, 0.0]].into_iter().chain(corners).collect(),
        photos: photos.collect(),
        samples,
        events: vec![
            Event {
                time: 30.0,
                text: "push of 4 N north for 0.5 s".into(),
            },
            Event {
                time: 60.0,
                text: "push of 4 N east for 0.5 s".into(),
            },
        ],
    }
}

/// The JSON of each plot on a page.
fn plots(page: &str) -> Vec<(String, serde_json::Value)> {
    let parts = page.split("<script type=\"application/json\" id=\"data-");
    let plot = |part: &str| {
        let (id, rest) = part.split_once("\">").expect("an id");
        let (json, _) = rest.split_once("</script>").expect("an end");
        let value = serde_json::from_str(json).expect("valid JSON");
        (id.to_owned(), value)
    };
    parts.skip(1).map(plot).collect()
}

/// The page without the drawing library.
fn without_library(page: &str) -> String {
    let start = page.find("<script type=\"text/javascript\">").expect("it");
    let end = start + page[start..].find("</script>").expect("its end");
    format!("{}{}", &page[..start], &page[end..])
}

#[test]
fn a_report_is_one_file_that_loads_nothing() {
    let page = html(&flight());
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
    let ours = without_library(&page);
    for word in [
        "http:", "https:", "src=", "<link", "@import", "url(", "//cdn", "fetch(", "MathJax",
    ] {
        assert!(!ours.contains(word), "{word}");
    }
    assert!(ours.contains("default-src 'none'"));
    assert_eq!(page.matches("<script type=\"text/javascript\">").count(), 1);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("report.html"), page).expect("written");
}

#[test]
fn every_plot_is_on_the_page_with_its_data() {
    let page = html(&flight());
    let plots = plots(&page);
    let ids: Vec<&str> = plots.iter().map(|(id, _)| id.as_str()).collect();
    let expected = [
        "space",
        "map",
        "coordinates",
        "error",
        "speed",
        "attitude",
        "rotors",
        "wind",
    ];
    assert_eq!(ids, expected);
    for (id, plot) in &plots {
        assert!(page.contains(&format!("id=\"{id}\" role=\"img\" aria-label=\"")));
        assert_eq!(plot["config"]["responsive"], true);
        for trace in plot["data"].as_array().expect("traces") {
            let points = trace["x"].as_array().expect("x").len();
            assert!((2..=3000).contains(&points), "{id}: {points}");
            assert_eq!(trace["y"].as_array().expect("y").len(), points);
        }
    }
    let scene = &plots[0].1["layout"]["scene"];
    assert_eq!(scene["aspectmode"], "data");
    let wanted = &plots[0].1["data"][1];
    assert_eq!(wanted["z"][1], 30.0, "up, not down");
    assert_eq!((&wanted["x"][2], &wanted["y"][2]), (&0.0.into(), &20.0.into()));
    let coordinates = plots[2].1["data"].as_array().expect("traces");
    assert_eq!(coordinates.len(), 9);
    assert_eq!(coordinates[1]["line"]["dash"], "dash");
    assert_eq!(coordinates[7]["yaxis"], "y3");
    let shapes = plots[2].1["layout"]["shapes"].as_array().expect("shapes");
    assert_eq!(shapes.len(), 2, "a line for each event");
}

#[test]
fn text_is_escaped_wherever_it_stands() {
    let evil = "</script><b>\"&'";
    let mut report = flight();
    report.samples.truncate(2);
    report.title = evil.into();
    report.subtitle = evil.into();
    report.conditions = vec![(evil.into(), evil.into())];
    report.figures = vec![Figure {
        label: evil.into(),
        value: evil.into(),
        unit: evil.into(),
    }];
    report.events[0].text = evil.into();
    let page = without_library(&html(&report));
    assert!(!page.contains("<b>"));
    let escaped = "&lt;/script&gt;&lt;b&gt;&quot;&amp;&#39;";
    assert_eq!(page.matches(escaped).count(), 9);
}

#[test]
fn missing_data_is_no_failure() {
    let empty = html(&Report::default());
    assert!(empty.contains("Nothing of the flight was recorded."));
    assert!(empty.contains("No photo was taken."));
    assert!(plots(&empty).is_empty());

    let one = html(&Report {
        samples: vec![Sample::default()],
        ..Report::default()
    });
    assert_eq!(plots(&one).len(), 8);
}

#[test]
fn what_is_not_a_number_is_a_gap() {
    let mut report = flight();
    report.samples.truncate(3);
    report.samples[1].position = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    report.photos[0].tilt = f32::NAN;
    report.events[0].time = f32::NAN;
    let page = html(&report);
    for (_, plot) in plots(&page).iter().take(4) {
        assert!(plot["data"][0]["y"][1].is_null());
        assert!(plot["data"][0]["y"][2].is_number());
    }
    assert!(page.contains("<td>–</td>"));
}
