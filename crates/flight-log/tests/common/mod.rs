//! A flight of the core without a world, logged: samples at random around hovering.

// Each test uses its own part.
#![allow(dead_code)]

use windhover_autopilot::battery::BatterySample;
use windhover_autopilot::mission::MissionItem;
use windhover_autopilot::mission::action::Altitude;
use windhover_autopilot::mode::{Guidance, Target};
use windhover_autopilot::{
    Command, ExternalEstimate, Imu, ImuCounts, Inner, InnerConfig, InnerInput, Mailboxes, MissionCommit,
    Mode, MotorCommand, Outer, OuterConfig, OuterInputs, OuterResult, ParameterWrite, Parameters, RcFrame,
    ScheduleRecord, Station, Sticks, Urgent,
};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_flight_log::views::Truth;
use windhover_flight_log::{
    Header, HeaderWriter, InfoValue, Logger, LoggerConfig, Plan, PlanKind, mission_crc,
};
use windhover_math::geodesy::GlobalPosition;
use windhover_math::{Quaternion, Vector3};

/// Random numbers that follow from a seed (xorshift64*).
#[derive(Clone)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }

    /// Between −1 and 1.
    pub fn signed(&mut self) -> f32 {
        (self.next() >> 40) as f32 / 8_388_608.0 - 1.0
    }
}

/// What a flight is like.
#[derive(Clone, Copy)]
pub struct Plot {
    pub seed: u64,
    pub imu_rate: u32,
    pub ticks: usize,
    /// Late results, missing samples, jitter, urgent commands, parameter writes.
    pub disrupted: bool,
    /// Bytes are drained every so many ticks.
    pub drain_every: usize,
    pub truth: bool,
}

impl Plot {
    pub fn calm(imu_rate: u32, ticks: usize) -> Self {
        Self {
            seed: 1,
            imu_rate,
            ticks,
            disrupted: false,
            drain_every: 16,
            truth: false,
        }
    }

    pub fn disrupted(seed: u64, imu_rate: u32, ticks: usize) -> Self {
        Self {
            seed,
            disrupted: true,
            ..Self::calm(imu_rate, ticks)
        }
    }
}

/// What was flown, and its log.
pub struct Flown {
    pub log: Vec<u8>,
    pub header: usize,
    pub inputs: Vec<InnerInput>,
    pub motors: Vec<MotorCommand>,
    pub records: Vec<ScheduleRecord>,
    pub frozen: Vec<OuterInputs>,
    pub dropped_inputs: u32,
    pub dropped_outputs: u32,
}

pub const HOME: GlobalPosition = GlobalPosition {
    latitude: 473_977_418,
    longitude: 85_455_938,
    altitude: 488_000,
};

pub fn mission() -> Vec<MissionItem> {
    let item = |command, north: i32, z| MissionItem {
        command,
        frame: 3,
        autocontinue: true,
        params: [0.0, 0.0, 0.0, f32::from_bits(0x7fc0_1234)],
        x: HOME.latitude + north * 90,
        y: HOME.longitude,
        z,
    };
    let photo = MissionItem {
        params: [0.0, 0.0, 1.0, f32::NAN],
        ..item(2000, 0, 0.0)
    };
    vec![
        item(22, 0, 10.0),
        item(16, 20, 10.0),
        photo,
        item(16, 40, 12.0),
        item(21, 40, 0.0),
    ]
}

pub fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.set(Parameters::find("MASS").unwrap(), 0.7123).unwrap();
    parameters
}

pub fn config(imu_rate: u32) -> InnerConfig {
    InnerConfig {
        imu_rate,
        rotation: Default::default(),
    }
}

pub fn outer_config() -> OuterConfig {
    OuterConfig {
        home: Some(HOME),
        declination: Some(0.05),
        ..OuterConfig::default()
    }
}

pub fn header_bytes(imu_rate: u32, mission: &[MissionItem]) -> Vec<u8> {
    header_with(&outer_config(), imu_rate, mission)
}

pub fn header_with(outer: &OuterConfig, imu_rate: u32, mission: &[MissionItem]) -> Vec<u8> {
    let parameters = parameters();
    let header = Header {
        time: 0,
        commit: "0123456789abcdef0123456789abcdef01234567",
        release: 0x0000_0100,
        board: "none",
        inner: config(imu_rate),
        parameters: &parameters,
        outer: *outer,
        reset_cause: "power",
        mission_crc: mission_crc(mission.iter().copied()),
        plans: &[Plan {
            kind: PlanKind::Mission,
            slot: 0,
            count: mission.len() as u16,
        }],
        more: &[
            ("sim_seed", InfoValue::U32(1)),
            ("sim_model", InfoValue::Text("none")),
        ],
    };
    let mut writer = HeaderWriter::new(header, |_, _, index| mission.get(usize::from(index)).copied());
    let mut bytes = Vec::new();
    while let Some(chunk) = writer.chunk() {
        assert!(chunk.len() <= windhover_flight_log::header::CHUNK);
        bytes.extend_from_slice(chunk);
    }
    bytes
}

/// A core with its logger, and what drives it.
pub struct Bench<const N: usize> {
    pub random: Random,
    pub inner: Inner,
    pub outer: Outer,
    pub mailboxes: Mailboxes,
    late: Option<(OuterResult, usize)>,
    pub logger: Logger<N>,
    pub mission: Vec<MissionItem>,
    plot: Plot,
    time: u64,
}

impl<const N: usize> Bench<N> {
    pub fn new(plot: Plot) -> Self {
        let outer = Outer::new(parameters(), &outer_config()).unwrap();
        let mission = mission();
        let mut mailboxes = Mailboxes::default();
        let crc = mission_crc(mission.iter().copied());
        let count = mission.len() as u16;
        mailboxes.queues.command.push(Command::Commit(
            PlanKind::Mission,
            MissionCommit { slot: 0, count, crc },
        ));
        mailboxes.queues.command.push(Command::Arm);
        Self {
            random: Random::new(plot.seed),
            inner: Inner::new(config(plot.imu_rate), outer.inner_parameters()),
            outer,
            mailboxes,
            late: None,
            logger: Logger::new(LoggerConfig::new(config(plot.imu_rate), &parameters())),
            mission,
            plot,
            time: 0,
        }
    }

    pub fn input(&mut self, tick: usize) -> InnerInput {
        let nominal = 1_000_000 / u64::from(self.plot.imu_rate);
        let chance = |random: &mut Random, one_in| random.below(one_in) == 0;
        let r = &mut self.random;
        let small = |r: &mut Random| (r.signed() * 40.0) as i16;
        let counts = ImuCounts {
            accel: [small(r), small(r), -2048 + small(r)],
            gyro: [small(r), small(r), small(r)],
        };
        let mut input = InnerInput {
            imu: Imu::Sample {
                counts,
                time: self.time,
            },
            urgent: None,
        };
        if self.plot.disrupted {
            if chance(r, 50) {
                let time = self.time + nominal / 2;
                input.imu = Imu::Missing { time };
            }
            if chance(r, 900) {
                input.urgent = Some(if chance(r, 2) {
                    Urgent::Kill
                } else {
                    Urgent::Disarm
                });
            }
            self.time = self.time + nominal + r.below(5) as u64 - 2;
        } else {
            self.time += nominal;
        }
        self.outside(tick);
        input
    }

    /// What comes into the queues.
    fn outside(&mut self, tick: usize) {
        let rate = self.plot.imu_rate as usize;
        let r = &mut self.random;
        if tick.is_multiple_of(rate / 50) {
            self.mailboxes.queues.external.push(ExternalEstimate {
                position: Vector3::new(r.signed(), r.signed(), r.signed()) * 0.01,
                velocity: Vector3::new(r.signed(), r.signed(), r.signed()) * 0.01,
                attitude: Quaternion::IDENTITY,
            });
        }
        if tick == rate / 2 {
            self.mailboxes.queues.command.push(Command::Fly(Mode::Mission));
        }
        if self.plot.disrupted && r.below(rate / 4) == 0 {
            let index = r.below(Parameters::COUNT + 2) as u16;
            let value = r.signed() * 10.0;
            self.mailboxes
                .queues
                .parameter
                .push(ParameterWrite { index, value });
            let at = TrajectorySetpoint::at_rest(Vector3::new(value, 0.0, -1.0), 0.0);
            self.mailboxes.queues.setpoint.push(at);
            self.mailboxes.queues.attitude.push(AttitudeSetpoint {
                attitude: Quaternion::from_heading(value),
                rate: Vector3::zeros(),
                thrust: value,
            });
            let commands = [
                Command::Arm,
                Command::ForceArm,
                Command::Fly(Mode::Offboard),
                Command::Fly(Mode::Takeoff),
                Command::Takeoff(Some(Altitude::SeaLevel(490.0 + value)), Some(value)),
                Command::GoTo(Target {
                    speed: Some(value),
                    ..Target::default()
                }),
                Command::StartMission(r.below(6) as u16),
                Command::SetHome(None),
                Command::TakePhoto,
                Command::Disarm,
            ];
            self.mailboxes
                .queues
                .command
                .push(commands[r.below(commands.len())]);
            self.more(value);
        }
    }

    /// What else may come: a pilot, a companion computer, a battery, a ground station.
    fn more(&mut self, value: f32) {
        let (time, queues) = (self.time, &mut self.mailboxes.queues);
        let throttle = (value * 0.1).clamp(-1.0, 1.0);
        queues.sticks.push(Sticks {
            throttle,
            ..Sticks::default()
        });
        let mut channels = [1500; 16];
        channels[2] = (1500.0 + 50.0 * value) as u16;
        queues.rc.push(RcFrame { channels });
        queues.guidance.push(Guidance {
            uses: Guidance::CLIMB | Guidance::HEADING,
            velocity: Vector3::new(0.0, 0.0, value),
            heading: value,
            ..Guidance::default()
        });
        queues.battery.push(BatterySample {
            time,
            voltage: (1000.0 + 50.0 * value) as u16,
            current: 100,
        });
        queues.station.push(Station { system: 255 });
    }

    fn post(&mut self, result: OuterResult) {
        let late = self.plot.disrupted && self.random.below(10) == 0;
        if late {
            self.late = Some((result, self.random.below(3)));
        } else {
            self.mailboxes.result = Some(result);
        }
    }

    fn release(&mut self) {
        if !self.inner.schedule().at_boundary() {
            return;
        }
        if let Some((result, boundaries)) = self.late.take() {
            if boundaries == 0 {
                self.mailboxes.result = Some(result);
            } else {
                self.late = Some((result, boundaries - 1));
            }
        }
    }

    /// One tick of everything.
    pub fn tick(&mut self, tick: usize, flown: &mut Flown) {
        let input = self.input(tick);
        self.release();
        let output = self.inner.tick(&input, &mut self.mailboxes);
        self.logger.tick(&input, output.motors, output.record);
        flown.inputs.push(input);
        flown.motors.push(output.motors);
        flown.records.extend(output.record);
        if let Some(snapshot) = self.mailboxes.snapshot.take() {
            let result = self.outer.step(&snapshot, self.mission.as_slice());
            self.logger.inputs(&snapshot.inputs, snapshot.tick);
            self.logger.result(&snapshot, &result);
            if self.plot.truth {
                self.logger.view(snapshot.time, &Truth::default());
            }
            flown.frozen.push(snapshot.inputs.clone());
            self.post(result);
        }
    }

    pub fn drain(&mut self, log: &mut Vec<u8>) {
        let mut buffer = [0; 1000];
        loop {
            let count = self.logger.drain(&mut buffer);
            if count == 0 {
                break;
            }
            log.extend_from_slice(&buffer[..count]);
        }
    }
}

impl Flown {
    pub fn new(log: Vec<u8>) -> Self {
        Self {
            header: log.len(),
            log,
            inputs: Vec::new(),
            motors: Vec::new(),
            records: Vec::new(),
            frozen: Vec::new(),
            dropped_inputs: 0,
            dropped_outputs: 0,
        }
    }
}

/// Flies and logs.
pub fn fly<const N: usize>(plot: Plot) -> Flown {
    let mut flown = Flown::new(header_bytes(plot.imu_rate, &mission()));
    let mut bench = Bench::<N>::new(plot);
    for tick in 0..plot.ticks {
        bench.tick(tick, &mut flown);
        if (tick + 1) % plot.drain_every == 0 {
            bench.drain(&mut flown.log);
        }
    }
    bench.logger.finish();
    bench.drain(&mut flown.log);
    flown.dropped_inputs = bench.logger.dropped_inputs();
    flown.dropped_outputs = bench.logger.dropped_outputs();
    flown
}
