//! The speed controllers of the motors: the only map from motor commands to rotor speeds.
//!
//! A command is a u16 per rotor, 65535 at full speed and linear in speed between; `None` means
//! that there are no pulses, and the rotors run down. Commands pass the compare preload latch of
//! the board's timer: a new value shows at the next PWM frame, not when it is written.

/// What the board sends to the four rotors, in the core's order; `None`: no pulses.
pub type Command = Option<[u16; 4]>;

/// The pulse that stops a motor, in µs: so does every shorter one.
pub const PULSE_STOP_US: u64 = 1000;

/// The pulse for full speed, in µs.
pub const PULSE_FULL_US: u64 = 2000;

/// What is longer, in µs, is no pulse for a motor, and stops it.
pub const PULSE_LIMIT_US: u64 = 2500;

/// The command that a controller takes a pulse for: 65535·ω/ω_max, linear between
/// [`PULSE_STOP_US`] and [`PULSE_FULL_US`], to the nearest. `None` stops the motor.
///
/// `high` is the length of the pulse in ticks, of which a microsecond has so many.
pub fn pulse_command(high: u64, ticks_per_microsecond: u64) -> Option<u16> {
    let stop = PULSE_STOP_US * ticks_per_microsecond;
    let range = (PULSE_FULL_US - PULSE_STOP_US) * ticks_per_microsecond;
    if high <= stop || high > PULSE_LIMIT_US * ticks_per_microsecond {
        return None;
    }
    let part = (high - stop).min(range);
    Some(((part * u64::from(u16::MAX) + range / 2) / range) as u16)
}

/// The compare preload of a PWM timer. Frames lie at whole multiples of the period since time
/// 0, counted in integers, so that they never drift.
#[derive(Clone, Debug)]
pub struct PwmLatch {
    /// Frames a second; 0 passes commands through at once.
    hz: u64,
    /// Number of the next frame.
    next: u64,
    /// When it begins, in ns.
    next_ns: u64,
    active: Command,
}

/// The commands that act during a step: one, and from a frame boundary on another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latched {
    /// Acts from the start of the step.
    pub before: Command,
    /// Acts from the boundary on.
    pub after: Command,
    /// The part of the step for which `after` acts, 0 to 1.
    pub fraction: f64,
}

impl PwmLatch {
    /// A latch with `hz` frames a second; `None` passes commands through at once.
    pub fn new(hz: Option<u32>) -> Self {
        let mut latch = Self {
            hz: u64::from(hz.unwrap_or(0)),
            next: 0,
            next_ns: 0,
            active: None,
        };
        latch.skip_to(0);
        latch
    }

    /// Moves to the first frame after `time_ns`. Exact for 2⁶⁴/(10⁹·hz) seconds: 500 days at
    /// 400 Hz.
    #[inline]
    fn skip_to(&mut self, time_ns: u64) {
        while self.hz > 0 && self.next_ns <= time_ns {
            self.next += 1;
            // The frame of number n begins at n·10⁹/hz, rounded down to a nanosecond.
            self.next_ns = self.next * 1_000_000_000 / self.hz;
        }
    }

    /// The step from `start_ns` over `length_ns`, at whose start `command` is written. A frame
    /// that begins at that very instant has taken the value before: computing takes time.
    #[inline]
    pub fn step(&mut self, start_ns: u64, length_ns: u64, command: Command) -> Latched {
        let end_ns = start_ns + length_ns;
        let before = self.active;
        let mut fraction = 0.0;
        if self.hz == 0 {
            self.active = command;
            fraction = 1.0;
        } else if self.next_ns <= end_ns {
            self.active = command;
            fraction = (end_ns - self.next_ns) as f64 / length_ns as f64;
            self.skip_to(end_ns);
        }
        Latched {
            before,
            after: self.active,
            fraction,
        }
    }
}

/// Four speed controllers behind a latch.
#[derive(Clone, Debug)]
pub struct Esc {
    latch: PwmLatch,
    speed_per_count: f64,
}

impl Esc {
    /// Controllers that turn 65535 into `speed_max` rad/s, with the latch of a timer.
    pub fn new(speed_max: f64, latch: PwmLatch) -> Self {
        Self {
            latch,
            speed_per_count: speed_max / 65_535.0,
        }
    }

    /// Wanted rotor speeds in rad/s, as their mean over the step. Where a frame begins inside
    /// the step, the commands before and after it weigh by their time; against the rotors' lag
    /// that differs from the exact response by the square of step over lag.
    #[inline]
    pub fn step(&mut self, start_ns: u64, length_ns: u64, command: Command) -> [f64; 4] {
        let latched = self.latch.step(start_ns, length_ns, command);
        let after = self.speeds(latched.after);
        if latched.before == latched.after {
            return after;
        }
        let before = self.speeds(latched.before);
        core::array::from_fn(|i| before[i] + (after[i] - before[i]) * latched.fraction)
    }

    #[inline(always)]
    fn speeds(&self, command: Command) -> [f64; 4] {
        match command {
            Some(counts) => counts.map(|count| f64::from(count) * self.speed_per_count),
            None => [0.0; 4],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;
    const A: Command = Some([1; 4]);
    const B: Command = Some([2; 4]);

    #[test]
    fn a_command_acts_from_the_next_frame_on() {
        let mut latch = PwmLatch::new(Some(400));
        // Frames at 2.5 ms, 5 ms, 7.5 ms: steps of 1 ms.
        let expected = [
            (A, None, None, 0.0),
            (A, None, None, 0.0),
            (A, None, A, 0.5), // 2 to 3 ms: the frame lies in its middle
            (B, A, A, 0.0),
            (B, A, B, 0.0), // the frame at 5 ms takes what was written at 4 ms
            (A, B, B, 0.0), // written at 5 ms: too late for that frame
            (A, B, B, 0.0),
            (None, B, None, 0.5),
        ];
        for (i, (command, before, after, fraction)) in expected.into_iter().enumerate() {
            let latched = latch.step(i as u64 * MS, MS, command);
            let expected = Latched {
                before,
                after,
                fraction,
            };
            assert_eq!(latched, expected, "step {i}");
        }
    }

    #[test]
    fn a_pulse_is_linear_from_1_to_2_ms() {
        let pulses = [
            (0, None),
            (900_000, None),
            (1_000_000, None),
            (1_000_001, Some(0)),
            (1_250_000, Some(16_384)),
            (1_500_000, Some(32_768)),
            (2_000_000, Some(65_535)),
            (2_400_000, Some(65_535)),
            (2_500_001, None),
        ];
        for (high, command) in pulses {
            assert_eq!(pulse_command(high, 1000), command, "{high} ns");
        }
    }

    #[test]
    fn frames_do_not_drift() {
        // 490 Hz does not divide a second in nanoseconds; after an hour the frames are in place.
        let mut latch = PwmLatch::new(Some(490));
        let mut frames = 0;
        let step = 500_000;
        let mut time = 0;
        for i in 0..7_200_000_u64 {
            let command = Some([(i % 60_000) as u16; 4]);
            let before = latch.active;
            latch.step(time, step, command);
            frames += u64::from(latch.active != before);
            time += step;
        }
        assert_eq!(frames, 490 * 3600);
    }

    #[test]
    fn a_long_step_takes_the_command_at_its_first_frame() {
        let mut latch = PwmLatch::new(Some(400));
        assert_eq!(latch.step(0, 10 * MS, A).fraction, 0.75);
        assert_eq!(latch.step(10 * MS, 10 * MS, B).fraction, 0.75);
    }

    #[test]
    fn without_a_latch_commands_act_at_once() {
        let mut esc = Esc::new(400.0, PwmLatch::new(None));
        assert_eq!(
            esc.step(0, MS, Some([65_535, 0, 13_107, 32_768])),
            [400.0, 0.0, 80.0, 32_768.0 / 65_535.0 * 400.0]
        );
        assert_eq!(esc.step(MS, MS, None), [0.0; 4]);
    }

    #[test]
    fn a_frame_inside_a_step_weighs_by_time() {
        let mut esc = Esc::new(65_535.0, PwmLatch::new(Some(400)));
        esc.step(0, 2 * MS, Some([0; 4]));
        assert_eq!(esc.step(2 * MS, 2 * MS, Some([1000; 4])), [750.0; 4]);
        assert_eq!(esc.step(4 * MS, MS, Some([0; 4])), [1000.0; 4]);
    }
}
