//! The 32-bit hash of a period's outputs: equal outputs, equal hash; other outputs, practically
//! always another one, where they differ in what is hashed.
//!
//! A period's outputs are the outer result that was adopted at its boundary, if one was, and the
//! motor commands of its ticks. Words of 32 bits, floats by their bits, go through four lanes: in
//! each, exclusive or, multiplication by FNV's prime, rotation (so that high bits reach low ones).
//! The lanes are joined by the finaliser of MurmurHash3.

use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::{MotorCommand, MotorState, OuterReport, OuterResult, Refused, Row, Why};
use windhover_control::TrajectorySetpoint;
use windhover_control::position::AttitudeSetpoint;
use windhover_math::{Quaternion, Vector3};

use crate::inputs::FlatCommand;
use crate::views::{known_code, motor_state_code, refusal_code, why_code};

const PRIME: u32 = 16_777_619;

struct Lanes([u32; 4]);

impl Lanes {
    const fn new() -> Self {
        Self([0x811c_9dc5, 0x1234_5678, 0x9e37_79b9, 0xc2b2_ae35])
    }

    #[inline(always)]
    fn words(&mut self, words: [u32; 4]) {
        for (lane, word) in self.0.iter_mut().zip(words) {
            *lane = (*lane ^ word).wrapping_mul(PRIME).rotate_left(13);
        }
    }

    #[inline(always)]
    fn vector(&mut self, v: &Vector3, word: u32) {
        self.words([v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), word]);
    }

    #[inline(always)]
    fn quaternion(&mut self, q: &Quaternion) {
        self.words([q.w.to_bits(), q.x.to_bits(), q.y.to_bits(), q.z.to_bits()]);
    }

    fn finish(self) -> u32 {
        self.0.iter().fold(0, |hash, lane| {
            let hash = (hash ^ lane).wrapping_mul(0x85eb_ca6b);
            let hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
            hash ^ hash >> 16
        })
    }
}

/// The hash of an outer result and its report. New parameters of the inner step count as present
/// or not; what they do shows in the motor commands.
///
/// Not hashed are of the report: where positions count from; of the sensors all but the number of
/// measurements that the gates rejected; of the estimate the accuracy of height, velocity and tilt,
/// and the gyro bias (the result's own is); of a refusal what is wrong with an item of the mission,
/// of the fence or with a place, and the range of a parameter.
pub fn result_hash(result: &OuterResult) -> u32 {
    let mut lanes = Lanes::new();
    lanes.words([
        result.tick,
        motor_bits(result.motors),
        u32::from(result.landed),
        u32::from(result.parameters.is_some()),
    ]);
    lanes.quaternion(&result.attitude);
    let report = &result.report;
    let state = (report.phase as u32) << 16 | (report.mode as u32) << 8 | row_code(report.failsafe);
    lanes.vector(&result.gyro_bias, state);
    let AttitudeSetpoint {
        attitude,
        rate,
        thrust,
    } = &result.setpoint;
    lanes.quaternion(attitude);
    lanes.vector(rate, thrust.to_bits() ^ result.motor_gain.to_bits());
    self::report(&mut lanes, report);
    lanes.finish()
}

/// The state of the motors with all that belongs to it.
fn motor_bits(motors: MotorState) -> u32 {
    let (rotor, command) = match motors {
        MotorState::Test { rotor, command } => (rotor, command),
        _ => (0, 0),
    };
    u32::from(motor_state_code(motors)) | u32::from(rotor) << 8 | u32::from(command) << 16
}

/// 0 for none.
fn row_code(row: Option<Row>) -> u32 {
    row.map_or(0, |row| row as u32 + 1)
}

fn report(lanes: &mut Lanes, report: &OuterReport) {
    let (battery, mission) = (&report.battery, &report.mission);
    lanes.vector(&report.home, report.active.0);
    lanes.words([
        report.blockers.0,
        u32::from(mission.current) << 16 | u32::from(mission.count),
        u32::from(mission.begun) << 8 | battery.charge as u32,
        battery.drawn.to_bits(),
    ]);
    let maybe = |value: Option<f32>| value.map_or(u32::MAX, f32::to_bits);
    lanes.words([
        maybe(battery.voltage),
        maybe(battery.current),
        maybe(battery.remaining),
        battery.arming_voltage.to_bits(),
    ]);
    let estimate = &report.estimate;
    let accuracy = &estimate.accuracy;
    lanes.vector(&estimate.position, u32::from(known_code(estimate.known)));
    lanes.vector(&estimate.velocity, accuracy.horizontal.to_bits());
    lanes.quaternion(&estimate.attitude);
    lanes.vector(&estimate.accel_bias, accuracy.heading.to_bits());
    let handover = &report.handover;
    lanes.vector(&handover.position, handover.heading.to_bits());
    lanes.vector(&handover.velocity, report.sensors.rejected);
    let more = report.thrust_scale.to_bits() ^ u32::from(report.leg_end.is_some());
    lanes.vector(&report.disturbance, more);
    lanes.vector(
        &report.leg_end.unwrap_or_default(),
        u32::from(report.trajectory.is_some()),
    );
    if let Some(trajectory) = &report.trajectory {
        let TrajectorySetpoint {
            position,
            velocity,
            acceleration,
            jerk,
            heading,
            heading_rate,
        } = trajectory;
        lanes.vector(position, heading.to_bits());
        lanes.vector(velocity, heading_rate.to_bits());
        lanes.vector(acceleration, 0);
        lanes.vector(jerk, 0);
    }
    for happened in &report.events {
        event(lanes, happened);
    }
    for refused in &report.refusals {
        refusal(lanes, refused);
    }
}

fn event(lanes: &mut Lanes, event: &MissionEvent) {
    match event {
        MissionEvent::Reached(item) => lanes.words([1, u32::from(*item), 0, 0]),
        MissionEvent::Missed(item) => lanes.words([2, u32::from(*item), 0, 0]),
        MissionEvent::Photo {
            item,
            target,
            settled,
        } => {
            lanes.words([
                3,
                u32::from(*item),
                u32::from(*settled),
                u32::from(target.is_some()),
            ]);
            lanes.vector(&target.unwrap_or_default(), 0);
        }
        MissionEvent::Landed => lanes.words([4, 0, 0, 0]),
        MissionEvent::Finished => lanes.words([5, 0, 0, 0]),
    }
}

fn refusal(lanes: &mut Lanes, refused: &Refused) {
    match refused {
        Refused::Command(command, why) => {
            let flat = FlatCommand::from(*command);
            let kind = u32::from(flat.command) << 16 | u32::from(flat.mode) << 8 | u32::from(flat.uses);
            let (detail, item) = match why {
                Why::Blocked(blockers) => (blockers.0, 0),
                Why::Failsafe(row) => (row_code(Some(*row)), 0),
                Why::Mission(item, _) | Why::Fence(item, _) => (0, u32::from(*item)),
                _ => (0, 0),
            };
            lanes.words([6, kind, u32::from(why_code(why)), detail]);
            lanes.words([
                u32::from(flat.slot) << 16 | u32::from(flat.count),
                flat.crc ^ flat.altitude.to_bits(),
                flat.latitude as u32 ^ flat.heading.to_bits(),
                flat.longitude as u32 ^ flat.speed.to_bits() ^ item,
            ]);
        }
        Refused::Parameter(write, refusal) => {
            let reason = u32::from(refusal_code(*refusal));
            lanes.words([7, u32::from(write.index), write.value.to_bits(), reason]);
        }
    }
}

/// The hash of a period: [`result_hash`] of the result that was adopted at its boundary, and the
/// commands of its ticks.
pub fn period_hash(adopted: Option<u32>, commands: &[MotorCommand]) -> u32 {
    let mut lanes = Lanes::new();
    lanes.words([adopted.unwrap_or_default(), u32::from(adopted.is_some()), 0, 0]);
    for command in commands {
        let (kind, [a, b, c, d]) = match *command {
            MotorCommand::Disarmed => (1, [0; 4]),
            MotorCommand::Idle(idle) => (2, [idle; 4]),
            MotorCommand::Run(rotors) => (3, rotors),
        };
        lanes.words([
            u32::from(a) << 16 | u32::from(b),
            u32::from(c) << 16 | u32::from(d),
            kind,
            0,
        ]);
    }
    lanes.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn signs_do_not_cancel() {
        let hash = |words: &[[u32; 4]]| {
            let mut lanes = Lanes::new();
            words.iter().for_each(|w| lanes.words(*w));
            lanes.finish()
        };
        let sign = 1 << 31;
        let patterns = [
            [[0; 4]; 2],
            [[sign, 0, 0, 0], [sign, 0, 0, 0]],
            [[sign, sign, 0, 0], [0; 4]],
        ];
        let hashes: BTreeSet<u32> = patterns.iter().map(|words| hash(words)).collect();
        assert_eq!(hashes.len(), patterns.len());
    }

    #[test]
    fn each_part_of_a_period_counts() {
        let run = |n| MotorCommand::Run([n, 2, 3, 4]);
        let periods = [
            period_hash(None, &[run(1), run(1)]),
            period_hash(Some(0), &[run(1), run(1)]),
            period_hash(Some(1), &[run(1), run(1)]),
            period_hash(None, &[run(1)]),
            period_hash(None, &[run(1), run(2)]),
            period_hash(None, &[run(2), run(1)]),
            period_hash(None, &[MotorCommand::Idle(0); 2]),
            period_hash(None, &[MotorCommand::Disarmed; 2]),
            period_hash(None, &[MotorCommand::Run([0; 4]); 2]),
        ];
        assert_eq!(BTreeSet::from(periods).len(), periods.len());
    }
}
