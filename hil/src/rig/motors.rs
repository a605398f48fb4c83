//! Four electronic speed controllers: pulses in, commands of the rotors out.
//!
//! A pulse acts from the beginning of its frame on, as in the desktop's flights; a real
//! controller knows its length only when it ends.

use windhover_model::Command;
use windhover_model::esc::pulse_command;

use crate::board::{Pin, PwmPulse};
use crate::time::{MICROSECOND, NEVER};

/// Without a new pulse for so many frames, a controller stops its motor.
pub const LOST_FRAMES: u64 = 4;

/// One controller.
#[derive(Clone, Copy, Debug)]
struct Motor {
    pin: Pin,
    command: Option<u16>,
    /// The pulses' length in ticks, while there are any.
    high: Option<u64>,
    /// Since when the command is summed up.
    since: u64,
    /// The command times its duration, since the last step.
    sum: u64,
    /// When the pulses count as lost.
    lost: u64,
}

impl Motor {
    fn sum_up(&mut self, now: u64) {
        self.sum += u64::from(self.command.unwrap_or(0)) * (now - self.since);
        self.since = now;
    }

    /// Sets command and pulse; whether the pulse changed.
    fn set(&mut self, now: u64, command: Option<u16>, high: Option<u64>) -> bool {
        self.sum_up(now);
        self.command = command;
        let changed = self.high != high;
        self.high = high;
        changed
    }
}

/// A pulse that changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PulseChange {
    /// When its frame began, or when pulses counted as lost, in ticks.
    pub time: u64,
    /// The rotor in the core's order, 0 to 3.
    pub rotor: usize,
    /// The pulse's length in ticks; `None`: no pulses any more.
    pub high: Option<u64>,
}

/// The four controllers, in the core's rotor order.
#[derive(Clone, Debug)]
pub struct Motors {
    motors: [Motor; 4],
    /// When the step began that the next command is for.
    step: u64,
}

impl Motors {
    /// Controllers at these pins, without pulses.
    pub fn new(pins: [Pin; 4]) -> Self {
        Self {
            motors: pins.map(|pin| Motor {
                pin,
                command: None,
                high: None,
                since: 0,
                sum: 0,
                lost: NEVER,
            }),
            step: 0,
        }
    }

    /// A frame begins at a pin; says what changed by it.
    pub fn pulse(&mut self, now: u64, pin: Pin, pulse: PwmPulse) -> Option<PulseChange> {
        let rotor = self.motors.iter().position(|motor| motor.pin == pin)?;
        let motor = &mut self.motors[rotor];
        motor.lost = now + LOST_FRAMES * pulse.period;
        let high = (pulse.high > 0).then_some(pulse.high);
        let changed = motor.set(now, pulse_command(pulse.high, MICROSECOND), high);
        changed.then_some(PulseChange {
            time: now,
            rotor,
            high,
        })
    }

    /// When the next controller loses its pulses.
    pub fn next_event(&self) -> u64 {
        let lost = self.motors.iter().map(|motor| motor.lost);
        lost.min().unwrap_or(NEVER)
    }

    /// Stops one motor whose pulses are lost by now.
    pub fn advance(&mut self, now: u64) -> Option<PulseChange> {
        let rotor = self.motors.iter().position(|motor| motor.lost <= now)?;
        let motor = &mut self.motors[rotor];
        let time = motor.lost;
        motor.lost = NEVER;
        motor.set(time, None, None).then_some(PulseChange {
            time,
            rotor,
            high: None,
        })
    }

    /// What the controllers are told now.
    pub fn commands(&self) -> [Option<u16>; 4] {
        self.motors.map(|motor| motor.command)
    }

    /// The commands since the last step, as their mean over time; begins the next step.
    pub fn take_step(&mut self, now: u64) -> Command {
        let length = now - self.step;
        self.step = now;
        let mut stopped = true;
        let means = self.motors.each_mut().map(|motor| {
            motor.sum_up(now);
            let sum = core::mem::take(&mut motor.sum);
            stopped &= sum == 0 && motor.command.is_none();
            ((sum + length / 2) / length.max(1)) as u16
        });
        (!stopped).then_some(means)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::Wires;
    use crate::time::SECOND;

    const MS: u64 = SECOND / 1000;
    const PERIOD: u64 = SECOND / 400;
    const PINS: [Pin; 4] = Wires::SPEEDYBEE_F405_V4.motors;

    fn pulse(us: u64) -> PwmPulse {
        PwmPulse {
            high: us * MICROSECOND,
            period: PERIOD,
        }
    }

    #[test]
    fn pads_are_at_their_corners() {
        // M1 rear right, M2 front right, M3 rear left, M4 front left.
        let pads = [('B', 6, 3), ('B', 7, 0), ('B', 0, 1), ('B', 1, 2)];
        for (port, number, rotor) in pads {
            let mut motors = Motors::new(PINS);
            motors.pulse(0, Pin::new(port, number), pulse(1500));
            let mut expected = [None; 4];
            expected[rotor] = Some(32_768);
            assert_eq!(motors.commands(), expected);
        }
    }

    #[test]
    fn other_pins_turn_nothing() {
        let mut motors = Motors::new(PINS);
        assert_eq!(motors.pulse(0, Pin::new('B', 2), pulse(2000)), None);
        assert_eq!(motors.take_step(MS), None);
    }

    #[test]
    fn a_pulse_weighs_by_its_time_in_the_step() {
        let mut motors = Motors::new(PINS);
        motors.pulse(0, PINS[0], pulse(2000));
        motors.pulse(3 * MS, PINS[0], pulse(1000));
        assert_eq!(motors.take_step(4 * MS), Some([49_151, 0, 0, 0]));
        assert_eq!(motors.take_step(5 * MS), None);
    }

    #[test]
    fn only_changes_are_told() {
        let mut motors = Motors::new(PINS);
        assert!(motors.pulse(0, PINS[1], pulse(1000)).is_some());
        assert!(motors.pulse(PERIOD, PINS[1], pulse(1000)).is_none());
        let change = PulseChange {
            time: 2 * PERIOD,
            rotor: 1,
            high: Some(1100 * MICROSECOND),
        };
        assert_eq!(motors.pulse(2 * PERIOD, PINS[1], pulse(1100)), Some(change));
    }

    #[test]
    fn without_pulses_for_four_frames_the_motor_stops() {
        let mut motors = Motors::new(PINS);
        motors.pulse(MS, PINS[2], pulse(1500));
        let lost = MS + 4 * PERIOD;
        assert_eq!(motors.next_event(), lost);
        assert_eq!(motors.advance(lost - 1), None);
        let change = PulseChange {
            time: lost,
            rotor: 2,
            high: None,
        };
        assert_eq!(motors.advance(lost + 5), Some(change));
        assert_eq!((motors.commands(), motors.next_event()), ([None; 4], NEVER));
    }
}
