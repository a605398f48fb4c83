//! Every record comes back as it was written, bit for bit.

use proptest::prelude::*;
use windhover_autopilot::battery::BatterySample;
use windhover_autopilot::mission::action::{Altitude, Place};
use windhover_autopilot::mission::{MissionItem, PlanKind};
use windhover_autopilot::mode::{Guidance, Target};
use windhover_autopilot::{
    BarometerSample, Command, CompassSample, ExternalEstimate, GnssSample, Imu, ImuCounts, MissionCommit,
    Mode, MotorCommand, MotorTest, ParameterWrite, RcFrame, ScheduleRecord, Station, Sticks, Urgent,
};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_flight_log::record::{Description, Record};
use windhover_flight_log::value::Scalar;
use windhover_flight_log::wire::{Decoder, Encoder};
use windhover_flight_log::{ImuBatch, ImuTimes, MAX_K, MotorBatch, PlanItem, View, views};

fn bytes_of(put: impl FnOnce(&mut Encoder<'_>)) -> Vec<u8> {
    let mut buffer = [0; 512];
    let mut out = Encoder::new(&mut buffer);
    put(&mut out);
    let length = out.finish().expect("it fits");
    buffer[..length].to_vec()
}

/// Bytes that may stand for a record with these fields: a truth value is 0 or 1.
fn sane(fields: &[windhover_flight_log::record::Field], mut bytes: Vec<u8>) -> Vec<u8> {
    let mut at = 0;
    for field in fields {
        let size = field.size(0);
        if field.scalar == Scalar::Bool {
            bytes[at] &= 1;
        }
        at += size;
    }
    bytes.truncate(at);
    bytes
}

/// Bytes → record → bytes.
fn comes_back<T: Record>(bytes: &[u8]) -> Result<(), TestCaseError> {
    let bytes = sane(T::FIELDS, bytes.to_vec());
    let record = T::get(&mut Decoder::new(&bytes));
    let record = record.ok_or(TestCaseError::fail("not read"))?;
    prop_assert_eq!(bytes_of(|out| record.put(out)), bytes);
    Ok(())
}

fn view_comes_back(topic: &Description, bytes: &[u8]) -> Result<(), TestCaseError> {
    let bytes = sane(topic.fields, bytes.to_vec());
    let view = View::get(topic.id, &mut Decoder::new(&bytes)).ok_or(TestCaseError::fail("not read"))?;
    let mut buffer = [0; 512];
    let (other, written) = view.put(&mut buffer);
    prop_assert_eq!(other.name, topic.name);
    prop_assert_eq!(written, &bytes[..]);
    prop_assert!(View::get(topic.id, &mut Decoder::new(&bytes[..bytes.len() - 1])).is_none());
    Ok(())
}

fn counts() -> impl Strategy<Value = ImuCounts> {
    any::<([i16; 3], [i16; 3])>().prop_map(|(accel, gyro)| ImuCounts { accel, gyro })
}

/// A tick: mostly a sample at nearly the nominal step, sometimes none, sometimes at any time.
fn ticks(
    count: impl Into<prop::collection::SizeRange>,
) -> impl Strategy<Value = Vec<(bool, i64, ImuCounts)>> {
    let step = prop_oneof![9 => -130i64..130, 1 => any::<i64>()];
    prop::collection::vec((prop::bool::weighted(0.1), step, counts()), count)
}

fn command() -> impl Strategy<Value = MotorCommand> {
    prop_oneof![
        Just(MotorCommand::Disarmed),
        any::<u16>().prop_map(MotorCommand::Idle),
        any::<[u16; 4]>().prop_map(MotorCommand::Run),
    ]
}

/// Commands of every kind, and each kind with every choice of what it leaves out.
fn commands_with(
    slot: u8,
    count: u16,
    crc: u32,
    (latitude, longitude): (i32, i32),
    [metres, heading, speed]: [f32; 3],
) -> Vec<Command> {
    let altitudes = [
        None,
        Some(Altitude::Home(metres)),
        Some(Altitude::SeaLevel(metres)),
    ];
    let place = |altitude| Place {
        latitude,
        longitude,
        altitude,
    };
    let mut all = vec![
        Command::Arm,
        Command::ForceArm,
        Command::Disarm,
        Command::StartMission(count),
        Command::TakePhoto,
        Command::SelectItem(count),
        Command::TestMotor(MotorTest {
            rotor: slot,
            share: speed,
            duration: heading,
        }),
    ];
    all.extend(Mode::ALL.map(Command::Fly));
    for kind in [PlanKind::Mission, PlanKind::Fence, PlanKind::Rally] {
        all.push(Command::Commit(kind, MissionCommit { slot, count, crc }));
    }
    all.extend([None, Some(speed)].map(Command::SetSpeed));
    for altitude in altitudes {
        all.push(Command::SetHome(altitude.map(place)));
        all.push(Command::LookAt(altitude.map(place)));
        for heading in [None, Some(heading)] {
            all.push(Command::Takeoff(altitude, heading));
            for (ground, speed) in [
                (None, None),
                (None, Some(speed)),
                (Some((latitude, longitude)), None),
                (Some((latitude, longitude)), Some(speed)),
            ] {
                all.push(Command::GoTo(Target {
                    ground,
                    altitude,
                    heading,
                    speed,
                }));
            }
        }
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn records_come_back(bytes in any::<[[u8; 32]; 8]>().prop_map(|bytes| bytes.concat())) {
        comes_back::<ExternalEstimate>(&bytes)?;
        comes_back::<ParameterWrite>(&bytes)?;
        comes_back::<TrajectorySetpoint>(&bytes)?;
        comes_back::<MissionItem>(&bytes)?;
        comes_back::<Guidance>(&bytes)?;
        comes_back::<RcFrame>(&bytes)?;
        comes_back::<Sticks>(&bytes)?;
        comes_back::<BatterySample>(&bytes)?;
        comes_back::<Station>(&bytes)?;
        comes_back::<AttitudeSetpoint>(&bytes)?;
        comes_back::<BarometerSample>(&bytes)?;
        comes_back::<CompassSample>(&bytes)?;
        comes_back::<GnssSample>(&bytes)?;
        for topic in views::TOPICS {
            view_comes_back(topic, &bytes)?;
        }
        let mut item = bytes.clone();
        item[0] %= 3;
        item[6] &= 1;
        item[7] &= 1;
        comes_back::<PlanItem>(&item)?;
    }

    #[test]
    fn commands_come_back(
        slot: u8, count: u16, crc: u32, place: (i32, i32), altitude: f32, heading: f32, speed: f32,
    ) {
        for command in commands_with(slot, count, crc, place, [altitude, heading, speed]) {
            let bytes = bytes_of(|out| command.put(out));
            prop_assert_eq!(Command::get(&mut Decoder::new(&bytes)), Some(command));
        }
        for urgent in [Urgent::Kill, Urgent::Disarm] {
            let bytes = bytes_of(|out| urgent.put(out));
            prop_assert_eq!(Urgent::get(&mut Decoder::new(&bytes)), Some(urgent));
        }
    }

    #[test]
    fn batches_of_samples_come_back(
        k in 1..=MAX_K,
        given in ticks(1..=MAX_K),
        start: u64,
        tick: u32,
        adopted: bool,
        snapshot_taken: bool,
        nominal in prop::sample::select(vec![250u64, 1000, 4000]),
    ) {
        let mut batch = ImuBatch::new(ScheduleRecord { tick, adopted, snapshot_taken });
        let mut at = start;
        let mut pushed = Vec::new();
        for (missing, deviation, counts) in given.iter().take(k) {
            let imu = if *missing { Imu::Missing { time: at } } else { Imu::Sample { counts: *counts, time: at } };
            prop_assert!(batch.push(&imu));
            pushed.push(imu);
            at = at.wrapping_add(nominal).wrapping_add_signed(*deviation);
        }
        let exact = ImuTimes { tick, times: batch.times };
        let exact_bytes = bytes_of(|out| exact.put(k, out));
        prop_assert_eq!(exact_bytes.len() + 8, ImuTimes::TOPIC.size(k));
        let exact = ImuTimes::get(k, &mut Decoder::new(&exact_bytes)).unwrap();
        let exact = batch.needs_times(nominal).then_some(&exact);
        let bytes = bytes_of(|out| batch.put(k, nominal, out));
        prop_assert_eq!(bytes.len() + 8, ImuBatch::TOPIC.size(k));
        let read = ImuBatch::get(batch.times[0], k, nominal, exact, &mut Decoder::new(&bytes)).unwrap();
        prop_assert_eq!(read.record, batch.record);
        for n in 0..=MAX_K {
            prop_assert_eq!(read.imu(n), pushed.get(n).copied());
        }
        if exact.is_some() {
            let without = ImuBatch::get(batch.times[0], k, nominal, None, &mut Decoder::new(&bytes));
            prop_assert!(without.is_none(), "times are missing, and nobody says so");
        }
    }

    #[test]
    fn batches_of_commands_come_back(
        k in 1..=MAX_K,
        given in prop::collection::vec(command(), 0..=MAX_K),
        tick: u16,
        hash: u32,
    ) {
        let mut batch = MotorBatch { tick, hash, ..MotorBatch::new() };
        given.iter().take(k).for_each(|command| batch.push(*command));
        let bytes = bytes_of(|out| batch.put(k, out));
        prop_assert_eq!(bytes.len() + 8, MotorBatch::TOPIC.size(k));
        prop_assert_eq!(MotorBatch::get(k, &mut Decoder::new(&bytes)), Some(batch));
    }
}
