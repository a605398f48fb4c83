//! The inner step alone: what closes and opens the latch, when results are adopted, and what a
//! late attitude does.

use windhover_autopilot::sensing::{ACCEL_SCALE, GYRO_SCALE};
use windhover_autopilot::{
    Imu, ImuCounts, Inner, InnerConfig, InnerInput, InnerParameters, Mailboxes, MotorCommand, MotorState,
    OuterReport, OuterResult, Parameters, Stop, Urgent,
};
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{GRAVITY, Quaternion, Vector3, scalar};

/// An inner step on a stool: level, with samples as they are told.
pub struct Stool {
    pub inner: Inner,
    pub mailboxes: Mailboxes,
    time: u64,
    period: u64,
    pub gyro: [i16; 3],
    silent: bool,
}

impl Stool {
    pub fn new(imu_rate: u32) -> Self {
        let parameters = InnerParameters::new(&Parameters::default()).expect("the default vehicle");
        let config = InnerConfig {
            imu_rate,
            rotation: Default::default(),
        };
        Self {
            inner: Inner::new(config, parameters),
            mailboxes: Mailboxes::default(),
            time: 0,
            period: 1_000_000 / u64::from(imu_rate),
            gyro: [0; 3],
            silent: false,
        }
    }

    pub fn tick(&mut self, urgent: Option<Urgent>) -> MotorCommand {
        let counts = ImuCounts {
            accel: [0, 0, -(GRAVITY / ACCEL_SCALE) as i16],
            gyro: self.gyro,
        };
        let time = self.time;
        let imu = if self.silent {
            Imu::Missing { time }
        } else {
            Imu::Sample { counts, time }
        };
        self.time += self.period;
        let input = InnerInput { imu, urgent };
        self.inner.tick(&input, &mut self.mailboxes).motors
    }

    /// Ticks to just before a boundary; the last command.
    pub fn run_to_boundary(&mut self) -> MotorCommand {
        let mut last = self.tick(None);
        while !self.inner.schedule().at_boundary() {
            last = self.tick(None);
        }
        last
    }

    /// Answers the waiting snapshot with what the outer step might say of a vehicle in the air.
    pub fn answer(&mut self, motors: MotorState) {
        self.answer_landed(motors, false);
    }

    /// The same, of one that may stand on the ground.
    pub fn answer_landed(&mut self, motors: MotorState, landed: bool) {
        let snapshot = self.mailboxes.snapshot.take().expect("a snapshot waits");
        self.mailboxes.result = Some(OuterResult {
            landed,
            ..result(snapshot.tick, motors)
        });
    }

    /// What the snapshot says of the latch.
    fn stopped(&self) -> Option<Stop> {
        self.mailboxes
            .snapshot
            .as_ref()
            .expect("a snapshot waits")
            .stopped
    }
}

/// A result made from the snapshot of a tick: level, thrust of the weight.
fn result(tick: u32, motors: MotorState) -> OuterResult {
    OuterResult {
        tick,
        attitude: Quaternion::IDENTITY,
        gyro_bias: Vector3::zeros(),
        motors,
        landed: false,
        setpoint: AttitudeSetpoint {
            attitude: Quaternion::IDENTITY,
            rate: Vector3::zeros(),
            thrust: 6.4,
        },
        motor_gain: 1.0,
        parameters: None,
        report: OuterReport::default(),
    }
}

fn is_running(command: MotorCommand) -> bool {
    matches!(command, MotorCommand::Run(_))
}

/// Flies: the motors run by the outer step's word.
pub fn flying(imu_rate: u32) -> Stool {
    let mut stool = Stool::new(imu_rate);
    stool.run_to_boundary();
    stool.answer(MotorState::Run);
    stool.run_to_boundary();
    assert!(is_running(stool.tick(None)));
    stool.run_to_boundary();
    stool
}

/// A result that waits has to wait for the next boundary, all of it.
#[test]
fn results_are_adopted_at_boundaries_only() {
    for rate in [250, 1000, 4000] {
        let k = rate / 250;
        let mut stool = Stool::new(rate);
        stool.tick(None);
        for n in 1..k {
            if n == 1 {
                stool.answer(MotorState::Idle);
            }
            let command = stool.tick(None);
            assert_eq!(command, MotorCommand::Disarmed, "tick {n} of {k}");
            assert!(stool.mailboxes.result.is_some(), "taken at tick {n} of {k}");
        }
        if k == 1 {
            stool.answer(MotorState::Idle);
        }
        assert!(matches!(stool.tick(None), MotorCommand::Idle(_)), "{rate} Hz");
        assert!(stool.mailboxes.result.is_none());
    }
}

/// Kill and disarm act in their tick, wherever that lies, whatever a result in the same tick says.
#[test]
fn the_latch_closes_in_its_tick() {
    for urgent in [Urgent::Kill, Urgent::Disarm] {
        for offset in 0..4 {
            let mut stool = flying(1000);
            stool.answer(MotorState::Run);
            for _ in 0..offset {
                assert!(is_running(stool.tick(None)));
            }
            assert_eq!(
                stool.tick(Some(urgent)),
                MotorCommand::Disarmed,
                "{urgent:?} at {offset}"
            );
            assert_eq!(stool.run_to_boundary(), MotorCommand::Disarmed);
        }
    }
}

/// A tick without a sample leaves the filtered rate as it is: the filter has seen nothing new.
#[test]
fn without_a_sample_the_filtered_rate_holds() {
    for rate in [1000, 4000] {
        let mut stool = flying(rate);
        stool.gyro = [500, -300, 200];
        stool.tick(None);
        let (seen, whole) = (stool.inner.rate(), 500.0 * GYRO_SCALE);
        assert!(seen.x > 0.0 && seen.x < 0.5 * whole, "on its way at {seen}");
        stool.silent = true;
        for _ in 0..3 {
            stool.tick(None);
            assert_eq!(stool.inner.rate(), seen);
        }
        stool.silent = false;
        stool.tick(None);
        assert!(stool.inner.rate().x > seen.x);
    }
}

/// The first sample is taken for what the rate has always been.
#[test]
fn the_filter_starts_settled() {
    let mut stool = Stool::new(1000);
    stool.gyro = [500, -300, 200];
    for _ in 0..20 {
        stool.tick(None);
        assert_eq!(
            stool.inner.rate(),
            Vector3::new(500.0, -300.0, 200.0).map(|counts: f32| counts * GYRO_SCALE)
        );
    }
}

/// Results made before the stop, and results that still say "run", do not open the latch; one
/// that has seen the stop and disarms does; and only the one after that moves a motor.
#[test]
fn the_latch_opens_when_the_outer_step_has_seen_it_and_disarmed() {
    let mut stool = flying(1000);
    // The result for the snapshot from before the kill is out while the kill comes.
    stool.tick(Some(Urgent::Kill));
    stool.answer(MotorState::Disarmed);
    stool.run_to_boundary();
    stool.tick(None);
    assert_eq!(
        stool.stopped(),
        Some(Stop::Commanded(Urgent::Kill)),
        "a result from before the kill has opened the latch"
    );
    for _ in 0..5 {
        stool.answer(MotorState::Run);
        assert_eq!(stool.run_to_boundary(), MotorCommand::Disarmed);
        assert_eq!(stool.tick(None), MotorCommand::Disarmed, "run does not open it");
        assert!(stool.stopped().is_some());
    }
    stool.answer(MotorState::Disarmed);
    stool.run_to_boundary();
    assert_eq!(stool.tick(None), MotorCommand::Disarmed);
    assert_eq!(stool.stopped(), None, "open");
    stool.answer(MotorState::Run);
    stool.run_to_boundary();
    assert!(is_running(stool.tick(None)));
}

/// 20 ms without a sample stop the motors; the time counts, not the number of ticks.
#[test]
fn silence_of_the_imu_is_measured_in_time() {
    for rate in [1000u64, 4000] {
        let mut stool = flying(rate as u32);
        stool.silent = true;
        let last_sample = stool.time - stool.period;
        loop {
            let now = stool.time;
            if stool.mailboxes.snapshot.is_some() {
                stool.answer(MotorState::Run);
            }
            let command = stool.tick(None);
            let silence = now - last_sample;
            assert_eq!(
                is_running(command),
                silence <= 20_000,
                "{silence} µs at {rate} Hz"
            );
            if silence > 25_000 {
                break;
            }
        }
        stool.run_to_boundary();
        stool.tick(None);
        assert_eq!(stool.stopped(), Some(Stop::ImuMissing));
    }
}

/// The estimate is of the snapshot's tick; what has been turned since stays on top of it.
#[test]
fn a_late_attitude_is_composed_with_what_was_turned_since() {
    let mut stool = Stool::new(1000);
    let rate = 1.0f32;
    stool.gyro = [(rate / GYRO_SCALE) as i16, 0, 0];
    let rate = f32::from(stool.gyro[0]) * GYRO_SCALE;
    stool.tick(None);
    // The snapshot was taken at the end of that tick. Ten boundaries pass before the answer.
    for _ in 0..39 {
        stool.tick(None);
    }
    let mut answer = result(0, MotorState::Disarmed);
    answer.attitude = Quaternion::from_heading(0.5);
    stool.mailboxes.snapshot = None;
    stool.mailboxes.result = Some(answer);
    stool.tick(None);
    let turned = Quaternion::from_rotation_vector(Vector3::new(rate * 0.040, 0.0, 0.0));
    let expected = Quaternion::from_heading(0.5) * turned;
    let off = expected.conjugate() * stool.inner.attitude();
    assert!(
        scalar::norm(Vector3::new(off.x, off.y, off.z)) < 1e-5,
        "{off:?}: the turns since the snapshot count"
    );
}

/// Ticks without a sample turn on with the last rate, and are counted.
#[test]
fn missing_samples_turn_on_and_are_counted() {
    let mut stool = Stool::new(1000);
    stool.gyro = [0, 0, 500];
    stool.run_to_boundary();
    stool.answer(MotorState::Disarmed);
    for n in 0..4 {
        stool.silent = n == 1 || n == 2;
        stool.tick(None);
    }
    stool.silent = false;
    stool.answer(MotorState::Disarmed);
    stool.tick(None);
    let increments = stool.mailboxes.snapshot.as_ref().unwrap().increments;
    assert_eq!((increments.ticks, increments.missing), (4, 2));
    let turned = 500.0 * GYRO_SCALE * 0.004;
    assert!((2.0 * increments.rotation.z - turned).abs() < 1e-6);
    assert!((increments.duration - 0.004).abs() < 1e-7);
    assert!((increments.velocity.z + GRAVITY * 0.004).abs() < 1e-4);
}

/// The gyro bias that comes with a result is taken off, and new calibration is used, from the
/// boundary on at which the result is adopted; the boundary's own sample was converted before.
#[test]
fn bias_and_calibration_come_with_a_result() {
    let mut stool = Stool::new(1000);
    stool.gyro = [1000, 0, 0];
    let rate = 1000.0 * GYRO_SCALE;
    let mut table = Parameters::default();
    table
        .set(Parameters::find("CAL_GYRO0_XOFF").unwrap(), 0.25)
        .unwrap();
    let calibrated = InnerParameters::new(&table);
    stool.tick(None);
    // The rate over each period, and what comes with the result at its end.
    let mut period = |bias: f32, parameters: Option<InnerParameters>| {
        stool.answer(MotorState::Disarmed);
        if let Some(result) = &mut stool.mailboxes.result {
            result.gyro_bias = Vector3::new(bias, 0.0, 0.0);
            result.parameters = parameters;
        }
        for _ in 0..3 {
            stool.tick(None);
        }
        stool.tick(None);
        let increments = &stool.mailboxes.snapshot.as_ref().unwrap().increments;
        2.0 * increments.rotation.x / 0.004
    };
    let close = |a: f32, b: f32| (a - b).abs() < 1e-3;
    assert!(close(period(0.0, None), rate));
    // Bias acts on the boundary's own sample, which is predicted after the adoption.
    assert!(close(period(rate, None), 0.75 * rate));
    assert!(close(period(rate, None), 0.0));
    assert!(close(period(0.0, calibrated), 0.25 * rate));
    assert!(close(period(0.0, None), rate - 0.25));
}

/// Where the motors rest, nothing winds up and no thrust is reported.
#[test]
fn at_rest_nothing_winds_up() {
    let mut stool = flying(1000);
    stool.gyro = [2000, -3000, 1000];
    let kicked = stool.tick(None);
    stool.gyro = [0; 3];
    stool.run_to_boundary();
    stool.answer(MotorState::Idle);
    for _ in 0..2 {
        stool.run_to_boundary();
        stool.tick(None);
        stool.answer(MotorState::Idle);
    }
    stool.run_to_boundary();
    stool.tick(None);
    let increments = stool.mailboxes.snapshot.as_ref().unwrap().increments;
    assert_eq!(increments.thrust, 0.0);
    let MotorCommand::Run(rotors) = kicked else {
        panic!("it ran");
    };
    assert!(
        rotors.iter().any(|rotor| *rotor != rotors[0]),
        "and fought the kick"
    );
}

/// Parameters outside what a vehicle can be make no inner step.
#[test]
fn a_vehicle_that_cannot_fly_gives_no_inner_parameters() {
    let mut table = Parameters::default();
    for name in ["CA_ROTOR0_PX", "CA_ROTOR1_PX", "CA_ROTOR2_PX", "CA_ROTOR3_PX"] {
        table.set(Parameters::find(name).unwrap(), 0.0).unwrap();
    }
    assert!(InnerParameters::new(&table).is_none(), "no arm to pitch with");
}

/// A time before the last tick's counts as the shortest step, not as a long one.
#[test]
fn time_that_runs_backwards_is_no_long_step() {
    let mut stool = flying(1000);
    stool.answer(MotorState::Run);
    stool.run_to_boundary();
    stool.answer(MotorState::Run);
    stool.time -= stool.period + 300;
    stool.run_to_boundary();
    stool.tick(None);
    let snapshot = stool.mailboxes.snapshot.as_ref().expect("a snapshot waits");
    let duration = snapshot.increments.duration;
    assert!((0.003..0.005).contains(&duration), "{duration} s in four ticks");
}
