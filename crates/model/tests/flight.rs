//! Short flights without a controller: commands in, truth out.

use windhover_math::{Quaternion, Vector3};
use windhover_model::{
    Command, Conditions, Contact, GRAVITY, Integrator, Kinematics, ModelKind, Payload, Push, Quantity, Truth,
    Vehicle, World, ideal_counts,
};

const MODELS: [ModelKind; 3] = [ModelKind::Simple, ModelKind::Paper, ModelKind::Rigid];
const INTEGRATORS: [Integrator; 2] = [Integrator::Rk4, Integrator::SemiImplicitEuler];

fn length(v: Vector3<f64>) -> f64 {
    v.dot(&v).sqrt()
}

/// Commands at once, no wind.
fn still_air() -> Conditions {
    Conditions {
        pwm_hz: None,
        ..Conditions::default()
    }
}

fn world(name: &str, model: ModelKind, integrator: Integrator, conditions: &Conditions) -> World {
    let vehicle = Vehicle::named(name).unwrap();
    World::new(&vehicle.plant, model, integrator, conditions)
}

/// Hovering 100 m above the ground.
fn hovering(name: &str, model: ModelKind, integrator: Integrator, conditions: &Conditions) -> World {
    let world = world(name, model, integrator, conditions);
    let speed = world.hover_speed();
    let state = Kinematics {
        position: Vector3::new(0.0, 0.0, -100.0),
        ..Kinematics::default()
    };
    world.in_flight(state, [speed; 4])
}

/// A command at which every rotor turns at hover speed plus `offset` rad/s, to the nearest count.
fn hover_command(name: &str, offset: [f64; 4]) -> Command {
    let plant = Vehicle::named(name).unwrap().plant;
    let count =
        |offset: f64| ((plant.hover_speed() + offset) / plant.rotor_speed_max * 65_535.0 + 0.5) as u16;
    Some(offset.map(count))
}

fn run(world: &mut World, seconds: f64, dt: f64, command: Command) -> Truth {
    for _ in 0..(seconds / dt + 0.5) as u32 {
        world.step(dt, command);
    }
    world.truth()
}

#[test]
fn at_rest_nothing_moves_and_an_accelerometer_reads_gravity() {
    for model in MODELS {
        let mut world = world("os4", model, Integrator::Rk4, &Conditions::reference()).facing(1.0);
        for command in [
            None,
            Some([0; 4]),
            hover_command("os4", [-5.0, -5.0, 20.0, -50.0]),
        ] {
            let truth = run(&mut world, 0.5, 1e-3, command);
            assert_eq!(world.contact(), Contact::Resting);
            assert_eq!(
                (truth.position, truth.velocity),
                (Vector3::zeros(), Vector3::zeros())
            );
            assert!(length(truth.specific_force - Vector3::new(0.0, 0.0, -GRAVITY)) < 1e-12);
            assert_eq!(truth.body_rate, Vector3::zeros());
            assert!((truth.attitude.heading() - 1.0).abs() < 1e-12);
            let counts = ideal_counts(&truth);
            assert_eq!((counts.accel, counts.gyro), ([0, 0, -2048], [0, 0, 0]));
        }
    }
}

#[test]
fn more_thrust_than_weight_lifts_off_and_climbs() {
    for name in ["os4", "x450"] {
        for model in MODELS {
            for integrator in INTEGRATORS {
                let mut world = world(name, model, integrator, &still_air());
                let below = run(&mut world, 1.0, 1e-3, hover_command(name, [-0.1; 4]));
                assert_eq!(below.position.z, 0.0);
                let above = run(&mut world, 2.0, 1e-3, hover_command(name, [10.0; 4]));
                assert_eq!(world.contact(), Contact::Flying);
                assert!(
                    above.position.z < -0.3 && above.velocity.z < -0.2,
                    "{name} {model:?}"
                );
                assert!(above.specific_force.z < -GRAVITY);
            }
        }
    }
}

#[test]
fn every_model_turns_the_same_way() {
    // Faster rotors by 5 rad/s, and the sign of roll, pitch and yaw that must come of it.
    let cases = [
        ("x450", [5.0, -5.0, -5.0, 5.0], (-1.0, 0.0, 0.0)), // the two on the right
        ("x450", [5.0, -5.0, 5.0, -5.0], (0.0, 1.0, 0.0)),  // the two in front
        ("x450", [20.0, 20.0, -20.0, -20.0], (0.0, 0.0, 1.0)), // counter-clockwise ones
        ("os4", [0.0, 0.0, -5.0, 5.0], (-1.0, 0.0, 0.0)),
        ("os4", [5.0, -5.0, 0.0, 0.0], (0.0, 1.0, 0.0)),
        ("os4", [5.0, 5.0, -5.0, -5.0], (0.0, 0.0, 1.0)),
    ];
    for (name, offset, (roll, pitch, yaw)) in cases {
        for model in MODELS {
            let mut world = hovering(name, model, Integrator::Rk4, &still_air());
            let truth = run(&mut world, 0.2, 1e-3, hover_command(name, offset));
            let euler = truth.attitude.to_euler();
            for (angle, rate, sign) in [
                (euler.roll, truth.body_rate.x, roll),
                (euler.pitch, truth.body_rate.y, pitch),
                (euler.yaw, truth.body_rate.z, yaw),
            ] {
                let turned = if sign == 0.0 {
                    angle.abs() < 1e-3
                } else {
                    angle * sign > 2e-3
                };
                assert!(turned, "{name} {model:?} {offset:?}: {euler:?}");
                assert!(sign == 0.0 || rate * sign > 0.0);
            }
            // Leaning right moves it east, nose up moves it south.
            assert!(truth.velocity.y * roll >= 0.0 && truth.velocity.x * pitch <= 0.0);
        }
    }
}

/// Rolls and pitches to and fro, and ends near hover.
fn manoeuvre(name: &str, model: ModelKind, integrator: Integrator, dt: f64, size: f64) -> Truth {
    let conditions = Conditions {
        wind: Vector3::new(0.5, -0.3, 0.0),
        ..still_air()
    };
    let mut world = hovering(name, model, integrator, &conditions);
    let roll = [-size, size, size, -size];
    let pitch = [size, -size, size, -size];
    for (torque, sign, seconds) in [
        (roll, 1.0, 0.1),
        (pitch, 1.0, 0.1),
        (roll, -1.0, 0.2),
        (pitch, -1.0, 0.2),
    ] {
        run(
            &mut world,
            seconds,
            dt,
            hover_command(name, torque.map(|w| w * sign)),
        );
    }
    run(&mut world, 0.4, dt, hover_command(name, [0.0; 4]))
}

#[test]
fn the_papers_model_and_the_rigid_body_agree_at_small_angles() {
    for model in [ModelKind::Simple, ModelKind::Paper] {
        let rigid = manoeuvre("x450", ModelKind::Rigid, Integrator::Rk4, 1e-3, 2.0);
        let other = manoeuvre("x450", model, Integrator::Rk4, 1e-3, 2.0);
        let (a, b) = (rigid.attitude.to_euler(), other.attitude.to_euler());
        let moved = length(rigid.position - Vector3::new(0.0, 0.0, -100.0));
        assert!(a.roll.abs() > 0.02 && moved > 0.01, "must move: {a:?} {moved}");
        assert!(
            (a.roll - b.roll).abs() < 0.01 * a.roll.abs(),
            "{model:?} {a:?} {b:?}"
        );
        assert!((a.pitch - b.pitch).abs() < 0.01, "{model:?} {a:?} {b:?}");
        assert!(
            length(rigid.position - other.position) < 0.02 * moved,
            "{model:?}"
        );
        assert!(length(rigid.body_rate - other.body_rate) < 0.01);
    }
}

#[test]
fn the_models_part_at_large_angles() {
    // Otherwise the test above would pass with one model behind every name.
    let [simple, paper, rigid] =
        MODELS.map(|model| manoeuvre("x450", model, Integrator::Rk4, 1e-3, 60.0).velocity);
    assert!(length(simple - paper) > 1e-2 && length(paper - rigid) > 1e-2 && length(simple - rigid) > 1e-2);
}

#[test]
fn the_integrators_have_their_orders_in_the_whole_world() {
    for model in MODELS {
        for (integrator, dt, wanted) in [
            (Integrator::Rk4, 20e-3, 4.0),
            (Integrator::SemiImplicitEuler, 1e-3, 1.0),
        ] {
            let ends = [dt, dt / 2.0, dt / 4.0].map(|dt| manoeuvre("x450", model, integrator, dt, 20.0));
            let gap = |a: &Truth, b: &Truth| {
                let turn = (a.attitude.conjugate() * b.attitude).shortest();
                length(a.position - b.position)
                    + length(a.velocity - b.velocity)
                    + length(Vector3::new(turn.x, turn.y, turn.z))
                    + length(a.body_rate - b.body_rate)
            };
            let order = libm::log2(gap(&ends[0], &ends[1]) / gap(&ends[1], &ends[2]));
            assert!((order - wanted).abs() < 0.3, "{model:?} {integrator:?}: {order}");
        }
    }
}

#[test]
fn adding_up_what_the_imu_measures_gives_velocity_and_attitude() {
    for model in MODELS {
        for integrator in INTEGRATORS {
            let mut world = hovering("x450", model, integrator, &Conditions::reference());
            let (mut velocity, mut attitude) = (Vector3::zeros(), Quaternion::IDENTITY);
            let dt = 1e-3;
            for n in 0..2000_u32 {
                let offset = if n % 200 < 100 { 30.0 } else { -30.0 };
                world.step(dt, hover_command("x450", [offset, 20.0, -offset, -20.0]));
                let truth = world.truth();
                let counts = ideal_counts(&truth);
                let rate = Vector3::from(counts.gyro.map(f64::from)) / windhover_model::imu::GYRO_SCALE;
                let force = Vector3::from(counts.accel.map(f64::from)) / windhover_model::imu::ACCEL_SCALE;
                assert!(length(rate - truth.mean_rate) < 1e-3 && length(force - truth.specific_force) < 5e-3);
                let middle = attitude * Quaternion::from_rotation_vector(truth.mean_rate * (0.5 * dt));
                velocity += (middle.rotate(truth.specific_force) + Vector3::new(0.0, 0.0, GRAVITY)) * dt;
                attitude = attitude * Quaternion::from_rotation_vector(truth.mean_rate * dt);
            }
            let truth = world.truth();
            assert!(
                truth.attitude.cos_tilt() < 0.99 && length(truth.velocity) > 1.0,
                "must move"
            );
            assert!(
                length(velocity - truth.velocity) < 1e-6,
                "{model:?} {velocity} {}",
                truth.velocity
            );
            assert!(attitude.dot(truth.attitude).abs() > 1.0 - 1e-9, "{model:?}");
        }
    }
}

#[test]
fn rotors_answer_at_the_next_frame_of_the_pwm() {
    let conditions = Conditions {
        pwm_hz: Some(400),
        ..still_air()
    };
    let mut world = world("os4", ModelKind::Rigid, Integrator::Rk4, &conditions);
    // Written at 0: the frame begins at 2.5 ms.
    let speeds: Vec<f64> = (0..25)
        .map(|_| {
            world.step(0.25e-3, Some([65_535; 4]));
            world.truth().rotor_speed[0]
        })
        .collect();
    assert!(speeds[..10].iter().all(|&speed| speed == 0.0), "{speeds:?}");
    let wanted = 400.0 * (1.0 - libm::exp(-0.25e-3 / 0.03));
    assert!((speeds[10] - wanted).abs() < 1e-9, "{speeds:?}");
    // Disarmed at 6.25 ms: the pulses end with the frame at 7.5 ms.
    let before = run(&mut world, 1.25e-3, 0.25e-3, None).rotor_speed[0];
    let after = run(&mut world, 0.25e-3, 0.25e-3, None).rotor_speed[0];
    assert!(before > speeds[24] && after < before);
}

#[test]
fn payload_needs_more_thrust_and_turns_more_slowly() {
    let loaded = Conditions {
        payload: Payload::new(0.7).unwrap(),
        ..still_air()
    };
    for model in MODELS {
        let mut empty = hovering("x450", model, Integrator::Rk4, &still_air());
        let mut full = hovering("x450", model, Integrator::Rk4, &loaded);
        assert!((full.hover_speed() / empty.hover_speed() - 1.5_f64.sqrt()).abs() < 1e-12);
        let command = hover_command("x450", [2.0, -2.0, 2.0, -2.0]);
        let (a, b) = (
            run(&mut empty, 0.1, 1e-3, command),
            run(&mut full, 0.1, 1e-3, command),
        );
        assert!(a.velocity.z.abs() < 1e-3 && b.velocity.z > 0.01, "{model:?}");
        // At equal speeds the torque is the same.
        let speed = [560.0, 550.0, 560.0, 550.0];
        let command = Some(speed.map(|w| (w / 1006.6 * 65_535.0) as u16));
        let rate = |conditions: &Conditions| {
            let mut world = hovering("x450", model, Integrator::Rk4, conditions).in_flight(
                Kinematics {
                    position: Vector3::new(0.0, 0.0, -100.0),
                    ..Kinematics::default()
                },
                speed,
            );
            run(&mut world, 0.1, 1e-3, command).body_rate.y
        };
        let inertia = 0.0219 + 0.7 * (0.05 * 0.05 + 0.1 * 0.1 / 6.0);
        let ratio = rate(&loaded) / rate(&still_air());
        assert!((ratio - 0.0219 / inertia).abs() < 1e-3, "{model:?} {ratio}");
    }
}

#[test]
fn payload_stays_on_the_ground_at_the_thrust_that_lifts_the_vehicle() {
    let conditions = Conditions {
        payload: Payload::new(0.7).unwrap(),
        ..still_air()
    };
    for model in MODELS {
        let mut world = world("x450", model, Integrator::Rk4, &conditions);
        for _ in 0..1000 {
            world.step(1e-3, hover_command("x450", [100.0; 4]));
            assert_eq!(world.contact(), Contact::Resting, "{model:?}");
        }
        run(&mut world, 1.0, 1e-3, hover_command("x450", [130.0; 4]));
        assert_eq!(world.contact(), Contact::Flying, "{model:?}");
    }
}

#[test]
fn gusts_are_shorter_near_the_ground() {
    let conditions = Conditions {
        gust: 1.0,
        ..still_air()
    };
    // Mean squared change of the vertical gust in 0.1 s.
    let change = |height: f64| {
        let mut sum = 0.0;
        for seed in 0..200 {
            let conditions = Conditions {
                seed,
                ..conditions.clone()
            };
            let state = Kinematics {
                position: Vector3::new(0.0, 0.0, -height),
                ..Kinematics::default()
            };
            let world = world(
                "os4",
                ModelKind::Rigid,
                Integrator::SemiImplicitEuler,
                &conditions,
            );
            let speed = world.hover_speed();
            let mut world = world.in_flight(state, [speed; 4]);
            let before = run(&mut world, 0.1, 1e-3, hover_command("os4", [0.0; 4])).wind.z;
            let after = run(&mut world, 0.1, 1e-3, hover_command("os4", [0.0; 4])).wind.z;
            sum += (after - before) * (after - before) / 200.0;
        }
        sum
    };
    let (low, high) = (change(5.0), change(100.0));
    assert!(
        low > 10.0 * high && low < 30.0 * high,
        "as the heights: {low} {high}"
    );
}

#[test]
fn pushes_and_disturbances_add_their_impulse() {
    for model in MODELS {
        for integrator in INTEGRATORS {
            let mut conditions = still_air();
            let mut plant = Vehicle::named("os4").unwrap().plant;
            plant.linear_drag = 0.0;
            conditions.disturbance = Vector3::new(0.1, 0.2, -0.3);
            conditions.pushes = vec![Push {
                start: 0.1003,
                force: Vector3::new(4.0, -2.0, 1.0),
                duration: 0.5,
            }];
            let flying = |conditions: &Conditions| {
                let state = Kinematics {
                    position: Vector3::new(0.0, 0.0, -100.0),
                    ..Kinematics::default()
                };
                let mut world =
                    World::new(&plant, model, integrator, conditions).in_flight(state, [225.0; 4]);
                run(&mut world, 1.0, 1e-3, hover_command("os4", [0.0; 4])).velocity
            };
            let gained = flying(&conditions) - flying(&still_air());
            let wanted = conditions.disturbance + Vector3::new(4.0, -2.0, 1.0) * (0.5 / 0.65);
            assert!(length(gained - wanted) < 1e-9, "{model:?} {gained}");
        }
    }
}

#[test]
fn the_wind_carries_a_hovering_vehicle_along() {
    let wind = Vector3::new(4.0, 2.0, 0.0);
    let conditions = Conditions { wind, ..still_air() };
    for name in ["os4", "x450"] {
        for model in MODELS {
            let mut world = hovering(name, model, Integrator::Rk4, &conditions);
            let early = run(&mut world, 1.0, 1e-3, hover_command(name, [0.0; 4]));
            let late = run(&mut world, 60.0, 10e-3, hover_command(name, [0.0; 4]));
            let lack =
                |truth: &Truth| length(Vector3::new(4.0 - truth.velocity.x, 2.0 - truth.velocity.y, 0.0));
            assert!(
                lack(&early) > 2.0 && lack(&late) < 0.8,
                "{name} {model:?} {}",
                lack(&late)
            );
            assert_eq!(early.wind, wind);
        }
    }
}

#[test]
fn a_slow_landing_comes_to_rest_and_may_take_off_again() {
    for model in MODELS {
        let mut world = world("os4", model, Integrator::SemiImplicitEuler, &still_air());
        run(&mut world, 1.0, 1e-3, hover_command("os4", [10.0; 4]));
        let mut truth = world.truth();
        while world.contact() == Contact::Flying && truth.time < 60.0 {
            let offset = if truth.velocity.z > 0.5 { 1.0 } else { -4.0 };
            world.step(1e-3, hover_command("os4", [offset; 4]));
            truth = world.truth();
        }
        assert!(
            truth.velocity.z > 0.4 && truth.velocity.z < 0.6,
            "{model:?} {}",
            truth.velocity.z
        );
        let rest = run(&mut world, 0.5, 1e-3, hover_command("os4", [-4.0; 4]));
        assert_eq!((world.contact(), world.crash()), (Contact::Resting, None));
        assert_eq!((rest.position.z, rest.velocity), (0.0, Vector3::zeros()));
        let again = run(&mut world, 1.0, 1e-3, hover_command("os4", [10.0; 4]));
        assert!(again.position.z < -0.1 && world.contact() == Contact::Flying);
    }
}

#[test]
fn a_crash_is_recorded_and_the_state_stays() {
    for model in MODELS {
        let mut world = world("os4", model, Integrator::Rk4, &still_air()).in_flight(
            Kinematics {
                position: Vector3::new(3.0, 4.0, -1.0),
                ..Kinematics::default()
            },
            [0.0; 4],
        );
        run(&mut world, 1.0, 1e-3, None);
        // A fall of 1 m takes 0.45 s and ends at 4.4 m/s, a little less for the drag.
        let crash = world.crash().expect("a crash");
        assert!(
            (crash.time - 0.45).abs() < 0.05 && (crash.descent - 4.2).abs() < 0.2,
            "{crash}"
        );
        assert!(crash.sideways < 0.1 && crash.tilt < 0.01 && crash.north > 2.9 && crash.east > 3.9);
        let frozen = world.truth();
        let later = run(&mut world, 1.0, 1e-3, Some([65_535; 4]));
        assert_eq!(
            (later.position, later.attitude),
            (frozen.position, frozen.attitude)
        );
        assert_eq!((later.velocity, later.rotor_speed), (Vector3::zeros(), [0.0; 4]));
        assert!((later.time - 2.0).abs() < 1e-9);
    }
}

#[test]
fn a_divergence_names_what_and_when_and_nothing_becomes_nan() {
    for model in MODELS {
        let mut world = hovering("x450", model, Integrator::Rk4, &still_air());
        let before = run(&mut world, 0.5, 1e-3, hover_command("x450", [0.0; 4]));
        run(&mut world, 4.0, 1e-3, Some([65_535, 0, 65_535, 0]));
        let divergence = world.diverged().expect("a divergence");
        assert_eq!(divergence.what, Quantity::BodyRate, "{model:?}");
        assert!(divergence.value.abs() > 200.0 && divergence.time > before.time);
        let end = world.truth();
        assert!(end.attitude.is_finite() && length(end.position) < 1e3 && length(end.body_rate) < 350.0);
        let bad = Kinematics {
            velocity: Vector3::new(f64::NAN, 0.0, 0.0),
            ..Kinematics::default()
        };
        let mut world = hovering("x450", model, Integrator::Rk4, &still_air()).in_flight(bad, [0.0; 4]);
        world.step(1e-3, None);
        assert!(world.diverged().is_some());
    }
}

#[test]
fn a_step_that_is_no_time_does_nothing() {
    let mut world = hovering("os4", ModelKind::Rigid, Integrator::Rk4, &Conditions::reference());
    let before = run(&mut world, 0.1, 1e-3, None);
    for dt in [0.0, -1.0, f64::NAN, 1e-10] {
        world.step(dt, Some([65_535; 4]));
        assert_eq!(world.truth(), before);
    }
}

#[test]
fn energy_is_power_over_time() {
    for (name, low, high) in [("os4", 50.0, 65.0), ("x450", 190.0, 220.0)] {
        let mut world = hovering(
            name,
            ModelKind::Rigid,
            Integrator::SemiImplicitEuler,
            &still_air(),
        );
        let truth = run(&mut world, 10.0, 1e-3, hover_command(name, [0.0; 4]));
        assert!((truth.energy / 10.0 - truth.power).abs() < 0.01, "{name}");
        assert!(
            truth.power > low && truth.power < high,
            "{name}: {} W",
            truth.power
        );
        let plant = Vehicle::named(name).unwrap().plant;
        let shaft = 4.0 * plant.k_z * plant.hover_speed() * plant.hover_speed() * plant.hover_speed();
        assert!((truth.power * 0.6 / shaft - 1.0).abs() < 1e-3);
    }
}

/// Every bit of a truth that matters.
fn bits(truth: &Truth) -> Vec<u64> {
    let (p, v, r, w, q) = (
        truth.position,
        truth.velocity,
        truth.body_rate,
        truth.wind,
        truth.attitude,
    );
    [
        p.x,
        p.y,
        p.z,
        v.x,
        v.y,
        v.z,
        r.x,
        r.y,
        r.z,
        w.x,
        w.y,
        w.z,
        q.w,
        q.x,
        q.y,
        q.z,
        truth.energy,
    ]
    .map(f64::to_bits)
    .to_vec()
}

#[test]
fn equal_seeds_give_equal_bits_and_others_do_not() {
    for model in MODELS {
        for integrator in INTEGRATORS {
            let fly = |seed: u64| {
                let conditions = Conditions {
                    seed,
                    ..Conditions::reference()
                };
                let mut world = hovering("x450", model, integrator, &conditions);
                bits(&run(
                    &mut world,
                    5.0,
                    1e-3,
                    hover_command("x450", [0.1, 0.0, 0.0, 0.1]),
                ))
            };
            assert_eq!(fly(1), fly(1));
            assert_ne!(fly(1), fly(2));
        }
    }
}

#[test]
fn the_tilt_of_a_state_is_the_angle_from_level() {
    let tilted = |roll: f64, pitch: f64| {
        let attitude = Quaternion::from_euler(windhover_math::Euler {
            roll,
            pitch,
            yaw: 2.0,
        });
        let state = Kinematics {
            attitude,
            ..Kinematics::default()
        };
        state.tilt()
    };
    assert!((tilted(0.3, 0.0) - 0.3).abs() < 1e-12);
    assert!((tilted(0.0, -1.2) - 1.2).abs() < 1e-12);
    assert!((tilted(3.0, 0.0) - 3.0).abs() < 1e-12);
    let both = tilted(0.4, 0.5);
    assert!((libm::cos(both) - libm::cos(0.4) * libm::cos(0.5)).abs() < 1e-12);
}
