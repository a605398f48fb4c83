//! The core's table of the declination against the model that it is taken from.

use std::fmt::Write as _;

use windhover_autopilot::declination;
use windhover_math::geodesy::GlobalPosition;
use windhover_math::max;
use windhover_sim::sensors::EarthField;

/// Coordinates in degrees.
fn place(latitude: f64, longitude: f64) -> GlobalPosition {
    GlobalPosition {
        latitude: (latitude * 1e7).round() as i32,
        longitude: (longitude * 1e7).round() as i32,
        altitude: 0,
    }
}

/// By the model, degrees.
fn model(place: GlobalPosition) -> f64 {
    let earth = EarthField::at(place).expect("a place on Earth");
    f64::from(earth.declination).to_degrees()
}

/// How far the core is from the model, degrees.
fn error(place: GlobalPosition) -> f64 {
    let difference = f64::from(declination(place)).to_degrees() - model(place);
    (difference + 180.0).rem_euclid(360.0) - 180.0
}

/// The table as it should stand in the core.
fn table() -> String {
    let mut table = String::new();
    for row in -16..=16 {
        let points = (-36..36).map(|column| {
            let hundredths = model(place(f64::from(row) * 5.0, f64::from(column) * 5.0)) * 100.0;
            (hundredths.round() as i32).to_string()
        });
        let points: Vec<String> = points.collect();
        writeln!(table, "    [{}],", points.join(", ")).expect("a text that grows");
    }
    table
}

#[test]
fn the_table_is_the_models_at_its_points() {
    for row in -16..=16 {
        for column in -36..36 {
            let point = place(f64::from(row) * 5.0, f64::from(column) * 5.0);
            let off = error(point);
            assert!(
                off.abs() < 0.0055,
                "{point:?} is off by {off}°; the table anew:\n{}",
                table()
            );
        }
    }
}

/// The largest error between two latitudes, every half degree, in degrees.
fn largest(from: i32, to: i32) -> f64 {
    let latitudes = (from * 2..=to * 2).map(|half| f64::from(half) * 0.5);
    let places = latitudes.flat_map(|latitude| {
        let longitudes = (-360..360).map(|half| f64::from(half) * 0.5);
        longitudes.map(move |longitude| place(latitude, longitude))
    });
    places.map(|place| error(place).abs()).fold(0.0, max)
}

#[test]
fn between_its_points_it_errs_by_no_more_than_it_says() {
    for (from, to, bound) in [(-50, 50, 0.75), (50, 70, 0.5), (-55, -50, 1.6)] {
        let off = largest(from, to);
        println!("{from}° to {to}°: {off:.2}°");
        assert!(off < bound, "{from}° to {to}°: {off}°");
    }
}

#[test]
fn height_makes_little_of_it() {
    for (latitude, longitude) in [(47.6, -122.3), (-36.8, 174.8), (64.1, -21.9), (-33.9, 18.4)] {
        let ground = place(latitude, longitude);
        let above = GlobalPosition {
            altitude: 5_000_000,
            ..ground
        };
        assert!((model(above) - model(ground)).abs() < 0.1, "{ground:?}");
    }
}
