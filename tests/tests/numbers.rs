//! The numbers that the autopilot promises, each flown, recorded and replayed.

use rayon::prelude::*;
use windhover_autopilot::Preset;
use windhover_math::Vector3;
use windhover_model::{Conditions, ModelKind, Payload, mean_wind_from};
use windhover_sim::flight::{Flight, Setup};
use windhover_sim::lemniscate::Lemniscate;
use windhover_tests::{monitoring, recorded, seeded, setup, with_parameter};

fn paper() -> Setup {
    setup("os4", Preset::Paper, ModelKind::Paper)
}

fn assert_completed(flight: &Flight) {
    let figures = &flight.figures;
    assert!(figures.completed, "{}", figures.ended);
    assert_eq!(figures.waypoints_reached, 10, "waypoints");
    assert_eq!(figures.photos.len(), 10, "photos");
}

/// The paper's controller on the paper's model holds the path as well as promised, and the
/// figures are those of a real flight: at least this long, and with an error at all.
#[test]
fn the_papers_controller_on_the_papers_model() {
    let (flight, _) = recorded(&paper(), &monitoring());
    assert_completed(&flight);
    let rmse = &flight.figures.rmse_m;
    assert!(
        rmse.north <= 0.20 && rmse.east <= 0.22 && rmse.down <= 0.03,
        "{rmse:?}"
    );
    assert!(rmse.horizontal() > 0.05 && flight.figures.duration_s > 150.0);
}

/// Feed-forward and observer cut the horizontal error to a fifth, and every photo is sharp.
#[test]
fn our_controller_has_a_fifth_of_the_papers_error() {
    let (theirs, _) = recorded(&paper(), &monitoring());
    let ours = Setup {
        preset: Preset::Windhover,
        ..paper()
    };
    let (ours, _) = recorded(&ours, &monitoring());
    assert_completed(&ours);
    let (ours_m, theirs_m) = (
        ours.figures.rmse_m.horizontal(),
        theirs.figures.rmse_m.horizontal(),
    );
    assert!(ours_m <= theirs_m / 5.0, "{ours_m} against {theirs_m}");
    for photo in &ours.figures.photos {
        assert!(photo.stop && photo.settled, "{photo:?}");
        assert!(photo.position_error_m <= 0.15, "{photo:?}");
        assert!(photo.speed_m_s <= 0.2, "{photo:?}");
    }
}

/// The default flight, which is the first thing that a user sees.
#[test]
fn the_default_flight() {
    let default = setup("os4", Preset::Windhover, ModelKind::Rigid);
    let (flight, _) = recorded(&default, &monitoring());
    assert_completed(&flight);
    for photo in &flight.figures.photos {
        assert!(
            photo.position_error_m <= 0.15 && photo.speed_m_s <= 0.2,
            "{photo:?}"
        );
    }
}

/// Flies seeds 1 to 100; waypoints that may be missed, of ten.
fn heavy_in_a_storm(preset: Preset, missed: usize) {
    let mut storm = setup("x450", preset, ModelKind::Rigid);
    storm.conditions = Conditions {
        wind: mean_wind_from(8.0, 206.6),
        gust: 2.0,
        payload: Payload::new(0.7).unwrap(),
        ..Conditions::reference()
    };
    let mission = monitoring();
    let failed: Vec<String> = (1..=100u64)
        .into_par_iter()
        .filter_map(|seed| {
            let (flight, _) = recorded(&seeded(&storm, seed), &mission);
            let figures = flight.figures;
            let well = figures.completed && figures.waypoints_reached + missed >= 10;
            let reached = figures.waypoints_reached;
            (!well).then(|| format!("seed {seed}: {}, {reached} waypoints", figures.ended))
        })
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Half as heavy again in 8 m/s of wind with 2 m/s of gusts: no crash, nothing missed.
#[test]
fn a_heavy_x450_in_a_storm_with_our_preset() {
    heavy_in_a_storm(Preset::Windhover, 0);
}

/// The same with the paper's gains: without a disturbance observer the wind may hold the vehicle
/// off a stop or two for longer than it waits.
#[test]
fn a_heavy_x450_in_a_storm_with_the_papers_preset() {
    heavy_in_a_storm(Preset::Paper, 3);
}

/// Both readings of Table I, gains per unit mass and gains as forces, and both of equation (13).
#[test]
fn every_reading_of_the_papers_gains_flies() {
    let readings = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
    let hashes: Vec<String> = readings
        .into_par_iter()
        .map(|(unit, form)| {
            let reading = with_parameter(paper(), "POS_GAIN_UNIT", unit);
            let reading = with_parameter(reading, "POS_FORM", form);
            let (flight, _) = recorded(&reading, &monitoring());
            let figures = flight.figures;
            assert!(figures.completed, "unit {unit}, form {form}: {}", figures.ended);
            assert_eq!(figures.waypoints_reached, 10, "unit {unit}, form {form}");
            figures.motor_hash
        })
        .collect();
    // They are four different controllers: a parameter without effect would give equal flights.
    for (n, hash) in hashes.iter().enumerate() {
        assert!(!hashes[..n].contains(hash), "reading {n} is another one again");
    }
}

fn lemniscate(period: f64, most: f64) {
    let x450 = setup("x450", Preset::Windhover, ModelKind::Rigid);
    let diagonal = 1.0 / 3f64.sqrt();
    let directions = [
        Vector3::zeros(),
        Vector3::x(),
        -Vector3::x(),
        Vector3::y(),
        -Vector3::y(),
        Vector3::z(),
        -Vector3::z(),
        Vector3::new(diagonal, diagonal, diagonal),
        Vector3::new(-diagonal, diagonal, -diagonal),
    ];
    let flown: Vec<f64> = directions
        .par_iter()
        .map(|&disturbance| {
            let figure = Lemniscate { period, disturbance };
            figure.fly(&x450).unwrap().rmse
        })
        .collect();
    for (n, (rmse, disturbance)) in flown.iter().zip(&directions).enumerate() {
        let text = format!("{:?}: {:.2} mm", disturbance.as_slice(), rmse * 1e3);
        assert!(*rmse <= most, "{text}");
        // Better than a hundredth of a millimetre would be no flight, and as good as another one
        // to the last bit no other disturbance.
        assert!(*rmse > 1e-5 && !flown[..n].contains(rmse), "{text}");
    }
}

/// Slowly, an acceleration of 1 m/s² from any side disturbs it by no more than 2 mm.
#[test]
fn a_lemniscate_in_16_s() {
    lemniscate(16.0, 2e-3);
}

/// Fast, with tilts up to 45°.
#[test]
fn a_lemniscate_in_4_s() {
    lemniscate(4.0, 12e-3);
}
