//! The rig without a processor: its pins are moved by hand.

use windhover_model::Vehicle;

use crate::board::{Frame, Pin, PwmPulse, Wiring};

use super::*;

const MS: u64 = SECOND / 1000;
const PERIOD: u64 = SECOND / 400;
const WIRES: Wires = Wires::SPEEDYBEE_F405_V4;

/// A byte as the command port has it.
fn frame(byte: u8) -> Frame {
    Frame {
        data: byte.into(),
        format: Format::plain(WIRES.commands_baud),
    }
}

/// Somebody who moves pins.
struct Hand {
    rig: Rig,
    now: u64,
    inputs: Inputs,
}

impl Hand {
    fn new(faults: &[&str]) -> Self {
        let faults = faults.iter().map(|text| text.parse().unwrap()).collect();
        Self::with(&Setup {
            faults,
            ..Setup::default()
        })
    }

    fn with(setup: &Setup) -> Self {
        let plant = Vehicle::named("x450").unwrap().plant;
        Self {
            rig: Rig::new(world(&plant, &Conditions::default()), setup),
            now: 0,
            inputs: Inputs::default(),
        }
    }

    /// With the sensors sampling at 1 kHz, data-ready pushed high.
    fn sampling(faults: &[&str]) -> Self {
        Self::new(faults).started()
    }

    fn sampling_with(setup: &Setup) -> Self {
        Self::with(setup).started()
    }

    fn started(self) -> Self {
        let mut hand = self;
        hand.wait(2 * MS);
        for [register, value] in [[0x14, 0x03], [0x64, 0x60], [0x65, 0x08], [0x4E, 0x0F]] {
            hand.transaction([register, value]);
        }
        hand.wait(48 * MS);
        hand.inputs = Inputs::default();
        hand
    }

    fn wait(&mut self, ticks: u64) {
        let end = self.now + ticks;
        while self.rig.next_event() <= end {
            self.now = self.now.max(self.rig.next_event());
            self.rig.advance(self.now, &mut self.inputs);
        }
        self.now = end;
    }

    fn transaction<const N: usize>(&mut self, mosi: [u8; N]) -> [u8; N] {
        self.rig.output(self.now, WIRES.imu_select, false);
        let miso = mosi.map(|byte| {
            self.now += MICROSECOND;
            self.rig.spi(self.now, byte)
        });
        self.rig.output(self.now, WIRES.imu_select, true);
        miso
    }

    /// Accelerometer and gyroscope along the part's axes.
    fn burst(&mut self) -> [i16; 6] {
        let mut mosi = [0; 13];
        mosi[0] = 0x80 | 0x1F;
        let [_, bytes @ ..] = self.transaction(mosi);
        core::array::from_fn(|i| i16::from_be_bytes([bytes[2 * i], bytes[2 * i + 1]]))
    }

    /// Pulses in µs for some frames, in the core's rotor order.
    fn pulses(&mut self, frames: u64, high: [u64; 4]) {
        for _ in 0..frames {
            for (pin, high) in WIRES.motors.into_iter().zip(high) {
                let pulse = PwmPulse {
                    high: high * MICROSECOND,
                    period: PERIOD,
                };
                self.rig.pwm(self.now, pin, pulse);
            }
            self.wait(PERIOD);
        }
    }

    fn rises(&self) -> usize {
        let rise = |(pin, level): &&(Pin, bool)| *pin == WIRES.imu_ready && *level;
        self.inputs.levels.iter().filter(rise).count()
    }
}

#[test]
fn the_sensors_answer_on_their_pins() {
    let mut hand = Hand::new(&[]);
    hand.wait(2 * MS);
    assert_eq!(hand.transaction([0x80 | 0x75, 0])[1], 0x47);
    assert_eq!(hand.rig.imu_misuse(), []);
}

#[test]
fn data_ready_rises_on_its_pin_at_each_sample() {
    let mut hand = Hand::sampling(&[]);
    let before = hand.rig.record().data_ready.len();
    hand.wait(100 * MS);
    assert_eq!(hand.rises(), 100);
    let times = &hand.rig.record().data_ready[before..];
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] == MS));
    assert_eq!(hand.inputs.levels.len(), 200, "and falls again");
}

#[test]
fn at_rest_the_parts_z_reads_one_g() {
    let mut hand = Hand::sampling(&[]);
    assert_eq!(hand.burst(), [0, 0, 2048, 0, 0, 0]);
}

#[test]
fn a_record_has_the_truth_of_each_sample() {
    let mut hand = Hand::sampling(&[]);
    let before = hand.rig.record().samples.len();
    hand.wait(10 * MS);
    let samples = &hand.rig.record().samples[before..];
    assert_eq!(samples.len(), 10);
    let seconds = samples[9].time as f64 / SECOND as f64;
    assert!((samples[9].truth.time - seconds).abs() < 2e-9);
    assert_eq!(samples[9].counts.accel, [0, 0, -2048]);
}

#[test]
fn full_pulses_lift_the_vehicle() {
    let mut hand = Hand::sampling(&[]);
    hand.pulses(200, [2000; 4]);
    assert!(hand.rig.world().truth().position.z < -0.5);
}

#[test]
fn pulses_of_1_ms_turn_nothing() {
    let mut hand = Hand::sampling(&[]);
    hand.pulses(200, [1000; 4]);
    assert_eq!(hand.rig.world().truth().rotor_speed, [0.0; 4]);
    assert_eq!(hand.rig.motor_commands(), [None; 4]);
}

#[test]
fn more_thrust_on_the_right_rolls_to_the_left() {
    let mut hand = Hand::sampling(&[]);
    hand.pulses(200, [1800; 4]);
    // Front right and rear right: pads M2 and M1.
    hand.pulses(8, [1900, 1800, 1800, 1900]);
    assert!(hand.rig.world().truth().body_rate.x < -0.1);
    // Front is the part's y.
    let [_, _, _, x, y, z] = hand.burst();
    assert!(y < -50 && x.abs() < 10 && z.abs() < 10, "{x} {y} {z}");
}

#[test]
fn more_thrust_in_front_pitches_up() {
    let mut hand = Hand::sampling(&[]);
    hand.pulses(200, [1800; 4]);
    hand.pulses(8, [1900, 1800, 1900, 1800]);
    assert!(hand.rig.world().truth().body_rate.y > 0.1);
    // Right is the part's x.
    assert!(hand.burst()[3] > 50);
}

#[test]
fn without_pulses_the_motors_run_down() {
    let mut hand = Hand::sampling(&[]);
    hand.pulses(10, [1500; 4]);
    hand.rig.pwm_stopped(hand.now, WIRES.motors[0]);
    hand.wait(4 * PERIOD);
    assert_eq!(hand.rig.motor_commands(), [None; 4]);
    let last = hand.rig.record().pulses.last().unwrap();
    assert_eq!(last.high, None);
}

#[test]
fn changes_of_pulses_are_recorded_once() {
    let mut hand = Hand::sampling(&[]);
    hand.pulses(5, [1000; 4]);
    hand.pulses(5, [1000, 1000, 1200, 1000]);
    let record = &hand.rig.record().pulses;
    assert_eq!(record.len(), 5);
    assert_eq!((record[4].rotor, record[4].high), (2, Some(1200 * MICROSECOND)));
}

#[test]
fn the_world_goes_on_without_samples() {
    let mut hand = Hand::new(&["imu-absent"]);
    hand.pulses(200, [2000; 4]);
    let truth = hand.rig.world().truth();
    assert!(truth.position.z < -0.5);
    let seconds = hand.now as f64 / SECOND as f64;
    assert!((seconds - truth.time) < 1.3e-3);
}

#[test]
fn the_log_is_what_its_port_sent() {
    let mut hand = Hand::new(&[]);
    for byte in *b"ULog" {
        hand.rig.transmitted(hand.now, Usart(3), frame(byte));
    }
    assert_eq!(hand.rig.log(), b"ULog");
    assert_eq!(hand.rig.answers(), []);
}

#[test]
fn commands_arrive_byte_by_byte_and_answers_are_kept() {
    let mut hand = Hand::new(&[]);
    hand.rig.send(0, b"arm");
    hand.wait(MS);
    let port = Usart(1);
    let expected = b"arm".map(|byte| (port, frame(byte)));
    assert_eq!(hand.inputs.received, expected);
    hand.rig.transmitted(hand.now, port, frame(b'k'));
    assert_eq!(hand.rig.answers(), [(hand.now, b'k')]);
}

#[test]
fn an_absent_part_answers_nothing() {
    let mut hand = Hand::new(&["imu-absent"]);
    hand.wait(10 * MS);
    assert_eq!(hand.transaction([0x80 | 0x75, 0])[1], 0xFF);
}

#[test]
fn an_unplugged_part_comes_back_without_its_configuration() {
    let mut hand = Hand::sampling(&["imu-unplugged@0.1+0.1"]);
    hand.wait(60 * MS);
    assert_eq!(hand.burst(), [-1; 6]);
    hand.wait(100 * MS);
    assert_eq!(hand.transaction([0x80 | 0x75, 0])[1], 0x47);
    assert_eq!(hand.transaction([0x80 | 0x4E, 0])[1], 0x00);
}

#[test]
fn a_stuck_line_comes_and_goes() {
    let mut hand = Hand::sampling(&["spi-stuck-low@0.1+0.1"]);
    hand.wait(60 * MS);
    assert_eq!(hand.burst(), [0; 6]);
    hand.wait(100 * MS);
    assert_eq!(hand.burst()[2], 2048);
}

#[test]
fn data_ready_is_lost_while_samples_go_on() {
    let mut hand = Hand::sampling(&["data-ready-lost@0.1+0.02"]);
    hand.wait(100 * MS);
    assert_eq!(hand.rises(), 80);
    let samples = hand.rig.record().samples.len();
    hand.wait(10 * MS);
    assert_eq!(hand.rig.record().samples.len(), samples + 10);
}

#[test]
fn equal_setups_make_equal_flights() {
    let fly = || {
        let mut hand = Hand::sampling(&["data-ready-random@0+10"]);
        hand.pulses(400, [1700, 1701, 1702, 1703]);
        (hand.rig.world().truth(), hand.rig.record().data_ready.clone())
    };
    assert_eq!(fly(), fly());
}

/// A flight on the rig is the desktop's flight: the same steps with the same commands.
#[test]
fn the_world_is_that_of_the_desktop() {
    let mut hand = Hand::sampling(&[]);
    let mut desktop = hand.rig.world().clone();
    let begin = hand.rig.record().samples.len();
    // The pulses begin at a sample.
    while hand.rig.record().samples.len() == begin {
        hand.wait(hand.rig.next_event() - hand.now);
    }
    desktop.step(1e-3, None);
    hand.pulses(40, [1600, 1650, 1700, 1750]);
    let samples = &hand.rig.record().samples[begin..];
    let command = hand.rig.motor_commands().map(|command| command.unwrap());
    for sample in &samples[1..] {
        desktop.step(1e-3, Some(command));
        assert_eq!(desktop.truth(), sample.truth);
    }
    assert_eq!(samples.len(), 101);
}

/// With a suite the inertial sensors have the errors of real ones: noise around one g.
#[test]
fn with_sensors_a_vehicle_at_rest_reads_noise_around_one_g() {
    let vehicle = Vehicle::named("x450").unwrap();
    let home = windhover_model::sensor::gnss::GnssSite::default().home;
    let suite = windhover_sim::sensors::Sensors::default().suite(&vehicle, home, 1000, 3);
    let mut hand = Hand::sampling_with(&Setup {
        sensors: Some(suite),
        ..Setup::default()
    });
    let down: Vec<i16> = (0..200)
        .map(|_| {
            hand.wait(MS);
            hand.burst()[2]
        })
        .collect();
    let mean = down.iter().map(|counts| f64::from(*counts)).sum::<f64>() / 200.0;
    assert!((mean - 2048.0).abs() < 100.0, "{mean}");
    let mut different = down;
    different.sort_unstable();
    different.dedup();
    assert!(different.len() > 5, "{different:?}");
    let last = hand.rig.record().samples.last().unwrap();
    assert_ne!(last.counts, ideal_counts(&last.truth));
}
