//! Changes of mode in motion: nothing that control is given makes a jump.

use windhover_autopilot::mission::action::command::{NAV_TAKEOFF, NAV_WAYPOINT};
use windhover_autopilot::mode::{Guidance, Target};
use windhover_autopilot::{Command, Mode, OuterResult, Sticks};
use windhover_math::{Quaternion, Vector3, max, scalar};

use super::flight::{DT, Flight};
use super::{item, item_at, waypoint};

/// All that may be ordered in flight.
const MODES: [Mode; 8] = [
    Mode::Stabilize,
    Mode::Altitude,
    Mode::Position,
    Mode::Hold,
    Mode::Mission,
    Mode::Return,
    Mode::Land,
    Mode::Offboard,
];

/// Of a step, at most: m, m/s, degrees, share of the weight.
const MOST: [f32; 4] = [0.05, 0.2, 3.0, 0.1];

/// Steps after a change that are looked at.
const STEPS: usize = 25;

/// At 20 m, with a pilot, a companion computer and a mission that all want to go somewhere.
fn aloft() -> Flight {
    let items = [
        item(NAV_TAKEOFF, [0.0; 4]),
        item_at(NAV_WAYPOINT, [0.0, 0.0, 0.0, 90.0], 30.0, 5.0, 22.0),
        waypoint(60.0, -10.0, 15.0),
    ];
    let mut flight = Flight::with_mission(&items);
    flight.steady.sticks = Some(Sticks {
        roll: 0.3,
        pitch: 0.6,
        yaw: 0.3,
        throttle: 0.2,
    });
    flight.steady.guidance = Some(Guidance {
        uses: Guidance::VELOCITY | Guidance::CLIMB | Guidance::HEADING_RATE,
        velocity: Vector3::new(1.5, -1.5, 0.5),
        heading_rate: -0.4,
        ..Guidance::default()
    });
    flight.hovering(20.0)
}

/// In motion in a mode, so many seconds after it was chosen.
fn in_motion(mode: Mode, seconds: f32) -> Flight {
    let mut flight = aloft();
    if matches!(mode, Mode::Return | Mode::Land | Mode::Hold) {
        let away = waypoint(40.0, 10.0, 0.0);
        flight.obey(Command::GoTo(Target {
            ground: Some((away.x, away.y)),
            speed: Some(3.0),
            ..Target::default()
        }));
        flight.run(4.0);
    }
    flight.obey(Command::Fly(mode));
    flight.run(seconds);
    assert_eq!(flight.report().mode, mode);
    flight
}

fn angle(from: Quaternion, to: Quaternion) -> f32 {
    let turn = (from.conjugate() * to).shortest();
    2.0 * scalar::norm(Vector3::new(turn.x, turn.y, turn.z)).to_degrees()
}

/// How far one step's setpoints are from what the last ones led to: m, m/s, degrees, share of the weight.
/// Where one of the two followed no path, attitude and thrust are its own.
fn jump(before: &OuterResult, after: &OuterResult, weight: f32) -> [f32; 4] {
    let (Some(from), Some(to)) = (before.report.trajectory, after.report.trajectory) else {
        return [0.0; 4];
    };
    let position = to.position - from.position - from.velocity * DT;
    [
        scalar::norm(position),
        scalar::norm(to.velocity - from.velocity),
        angle(before.setpoint.attitude, after.setpoint.attitude),
        (after.setpoint.thrust - before.setpoint.thrust).abs() / weight,
    ]
}

#[test]
fn no_change_of_mode_makes_a_jump() {
    let mut worst = [(0.0, Mode::Hold, Mode::Hold); 4];
    let mut pairs = 0;
    for from in MODES {
        for seconds in [0.3, 1.5, 4.0] {
            let start = in_motion(from, seconds);
            let weight = start.mass() * windhover_math::GRAVITY;
            for to in MODES {
                let mut flight = start.clone();
                let mut before = flight.result.clone();
                flight.obey(Command::Fly(to));
                assert_eq!(flight.report().mode, to);
                for step in 0..STEPS {
                    let jump = jump(&before, &flight.result, weight);
                    for ((worst, jump), most) in worst.iter_mut().zip(jump).zip(MOST) {
                        assert!(
                            jump < most,
                            "{from:?} to {to:?} after {seconds} s, step {step}: {jump} of {most}"
                        );
                        if jump > worst.0 {
                            *worst = (jump, from, to);
                        }
                    }
                    before = flight.result.clone();
                    flight.step();
                }
                pairs += 1;
            }
        }
    }
    for ((jump, from, to), unit) in worst.iter().zip(["m", "m/s", "degrees", "of the weight"]) {
        println!("worst of {pairs} changes: {jump:.4} {unit}, {from:?} to {to:?}");
    }
}

/// From sticks to a path: the path begins where the vehicle is and moves as it does.
#[test]
fn a_path_begins_with_the_vehicles_motion() {
    for from in [Mode::Stabilize, Mode::Altitude] {
        let start = in_motion(from, 3.0);
        assert!(scalar::norm(start.velocity) > 1.0, "in motion");
        for to in [
            Mode::Position,
            Mode::Hold,
            Mode::Mission,
            Mode::Return,
            Mode::Land,
            Mode::Offboard,
        ] {
            let mut flight = start.clone();
            let (position, velocity) = (flight.position, flight.velocity);
            flight.obey(Command::Fly(to));
            let point = flight.report().trajectory.expect("a path");
            let (off, slow) = (
                point.position - position - velocity * DT,
                point.velocity - velocity,
            );
            assert!(scalar::norm(off) < MOST[0], "{from:?} to {to:?}: {off}");
            assert!(scalar::norm(slow) < MOST[1], "{from:?} to {to:?}: {slow}");
        }
    }
}

/// From a path to sticks: the tilt begins with the one there is, and the heading with its own.
#[test]
fn sticks_begin_with_the_attitude_there_is() {
    for from in [Mode::Position, Mode::Hold, Mode::Mission, Mode::Offboard] {
        for to in [Mode::Stabilize, Mode::Altitude] {
            let mut flight = in_motion(from, 1.0);
            let before = flight.result.setpoint.attitude;
            flight.obey(Command::Fly(to));
            let turned = angle(before, flight.result.setpoint.attitude);
            assert!(turned < 3.0, "{from:?} to {to:?}: {turned} degrees");
        }
    }
}

/// A takeoff that is called off at any height brakes from its climb.
#[test]
fn a_takeoff_that_is_called_off_brakes() {
    let mut flight = Flight::new();
    flight.step();
    flight.obey(Command::Fly(Mode::Takeoff));
    flight.obey(Command::Arm);
    flight.until(10.0, |flight| flight.position.z < -0.6);
    let weight = flight.mass() * windhover_math::GRAVITY;
    for to in [Mode::Hold, Mode::Return, Mode::Land] {
        let mut other = flight.clone();
        let before = other.result.clone();
        other.obey(Command::Fly(to));
        let jump = jump(&before, &other.result, weight);
        assert!(
            jump.iter().zip(MOST).all(|(jump, most)| *jump < most),
            "{to:?}: {jump:?}"
        );
    }
}

/// Gains that are written while it moves: no step of attitude or thrust, and they count.
#[test]
fn gains_written_in_motion_make_no_jump() {
    let start = in_motion(Mode::Mission, 3.0);
    let weight = start.mass() * windhover_math::GRAVITY;
    let mut worst = 0.0f32;
    for (name, value) in [
        ("POS_N_P", 5.0),
        ("POS_N_I", 3.0),
        ("POS_N_D", 3.0),
        ("POS_E_P", 5.0),
        ("POS_D_P", 10.0),
        ("POS_D_I", 4.0),
    ] {
        let (mut with, mut without) = (start.clone(), start.clone());
        with.write(name, value);
        without.step();
        let (a, b) = (&with.result.setpoint, &without.result.setpoint);
        let (turned, pushed) = (
            angle(a.attitude, b.attitude),
            (a.thrust - b.thrust).abs() / weight,
        );
        assert!(
            turned < 0.3 && pushed < 0.01,
            "{name}: {turned} degrees, {pushed} of the weight"
        );
        worst = max(worst, turned);
    }
    println!("worst turn by a gain written in motion: {worst:.4} degrees");
}
