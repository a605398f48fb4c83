//! The filter between the gyro and attitude control: a low-pass filter, and a notch at each
//! rotor's frequency.
//!
//! Rotors shake the gyro at the frequencies at which they turn. These are known: the commands are
//! shares of the largest rotor speed, and rotors follow them with a lag. So nothing is searched
//! for in a spectrum; each notch follows its rotor, one of the four every 4 ms.
//!
//! Only the rate that attitude control sees is filtered. The attitude is integrated from every
//! sample as it comes, without delay.
//!
//! A notch is faded out where it would harm or cannot work: near the frequencies at which control
//! works, with rotors at rest, and near half the sample rate.

mod section;
#[cfg(test)]
mod tests;

use core::f32::consts::TAU;

use windhover_control::mixer::FULL_COMMAND;
use windhover_control::pid::low_pass_share;
use windhover_math::{Vector3, max, min};
use windhover_parameters::parameters;

use crate::io::MotorCommand;
use section::{LowPass, Notch, Past, Width};

parameters! {
    /// What attitude control does not see of the gyro.
    ///
    /// The defaults are for the os4, whose rotors hover at only seven times the frequency at which
    /// its attitude loop crosses over (36 and 5 Hz): all filters together take 8° of phase there,
    /// and leave 32° of 40°. Faster rotors leave room for wider notches, which forgive
    /// more of an error in `ROTOR_SPEED_MAX`.
    pub struct FilterParameters {
        cutoff: "IMU_GYRO_CUTOFF", "Hz", 0.0..=1000.0, 120.0, "Cutoff of the gyro's low-pass filter of second order; none below 5 Hz and above 0.45 of the sample rate";
        notches: "IMU_GYRO_DNF_EN", "", 0.0..=1.0, 1.0, "Whether notches take the rotors' frequencies out of the gyro's signal: 1 for yes, 0 for no";
        notch_width: "IMU_GYRO_DNF_BW", "Hz", 1.0..=50.0, 5.0, "Width of each rotor's notch between its points of -3 dB";
        notch_least: "IMU_GYRO_DNF_MIN", "Hz", 10.0..=200.0, 20.0, "Rotor frequency up to which there is no notch; from 1.25 times this on it is full";
    }
}

/// Below this cutoff there is no low-pass filter: no vehicle flies with such a delay, Hz.
const CUTOFF_LEAST: f32 = 5.0;

/// Nothing is filtered at frequencies above this share of the sample rate.
const HIGHEST: f32 = 0.45;

/// Over this share of the sample rate, up to the highest, notches fade out.
const FADE_HIGH: f32 = 0.05;

/// Over this share of the least frequency, from there up, notches fade in.
const FADE_LOW: f32 = 0.25;

/// So many times a second one rotor's notch is renewed.
const TURNS: u32 = 250;

/// What the filter knows of the rotors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotors {
    /// Speed at full command, rad/s.
    pub speed_max: f32,
    /// Time constant with which they follow their commands, s.
    pub lag: f32,
}

/// The parameters in the form in which a step uses them; angles are in rad a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Design {
    low_pass: Option<LowPass>,
    width: Width,
    /// Weight of a notch in the middle of the range: 0 or 1.
    weight: f32,
    least: f32,
    /// Weight per angle above the least.
    rise: f32,
    /// Angle by which a rotor turns in a sample, per unit of command.
    per_command: f32,
    /// Ticks from one rotor's turn to the next one's.
    every: u32,
    /// Share of the way to its command that a rotor goes from one turn of its own to the next.
    share: f32,
}

impl Design {
    /// For these rotors and `rate` samples a second.
    fn new(parameters: &FilterParameters, rotors: &Rotors, rate: f32) -> Self {
        let p = parameters;
        let cutoff = p.cutoff / rate;
        let least = min(TAU * HIGHEST, TAU * p.notch_least / rate);
        let every = max(1, rate as u32 / TURNS);
        Self {
            low_pass: (p.cutoff >= CUTOFF_LEAST && cutoff <= HIGHEST).then(|| LowPass::new(cutoff)),
            width: Width::new(p.notch_width / rate),
            weight: if p.notches >= 0.5 { 1.0 } else { 0.0 },
            least,
            rise: 1.0 / (FADE_LOW * least),
            per_command: rotors.speed_max / (FULL_COMMAND * rate),
            every,
            share: low_pass_share(rotors.lag, (4 * every) as f32 / rate),
        }
    }

    /// The notch for a rotor that turns by `angle` a sample.
    #[inline]
    fn notch(&self, angle: f32) -> Notch {
        let most = TAU * HIGHEST;
        let inside = min(most, max(self.least, angle));
        let above = (inside - self.least) * self.rise;
        let below = (most - inside) * (1.0 / (TAU * FADE_HIGH));
        let weight = min(self.weight, min(above, below));
        self.width.notch(inside, weight)
    }
}

/// The filter with its memory.
#[derive(Clone, Debug, PartialEq)]
pub struct GyroFilter {
    design: Design,
    /// The last commands.
    commands: [u16; 4],
    /// Angle by which each rotor is thought to turn in a sample, rad.
    turn: [f32; 4],
    notches: [Notch; 4],
    /// Whose turn it is next.
    rotor: usize,
    /// Ticks so far.
    ticks: u32,
    /// Whether there has been a sample.
    started: bool,
    input: Past,
    /// Behind the low-pass filter.
    smooth: Past,
    /// What each notch took out.
    tones: [Past; 4],
    output: Vector3,
}

impl GyroFilter {
    /// For these rotors, at rest, and `rate` samples a second; before the first sample.
    pub fn new(parameters: &FilterParameters, rotors: &Rotors, rate: f32) -> Self {
        let design = Design::new(parameters, rotors, rate);
        Self {
            design,
            commands: [0; 4],
            turn: [0.0; 4],
            notches: [design.notch(0.0); 4],
            rotor: 0,
            ticks: 0,
            started: false,
            input: Past::default(),
            smooth: Past::default(),
            tones: [Past::default(); 4],
            output: Vector3::zeros(),
        }
    }

    /// Takes on new parameters without a jump: what is remembered are signals, and stays.
    pub fn retune(&mut self, parameters: &FilterParameters, rotors: &Rotors, rate: f32) {
        self.design = Design::new(parameters, rotors, rate);
        self.notches = self.turn.map(|turn| self.design.notch(turn));
    }

    /// What the rotors are told: once a tick.
    #[inline]
    pub fn follow(&mut self, command: &MotorCommand) {
        self.commands = command.rotors().unwrap_or([0; 4]);
        self.ticks = self.ticks.wrapping_add(1);
    }

    /// Takes in a sample (body FRD, rad/s, without bias): once a sample. The first one is taken
    /// for what the rate has always been.
    #[inline(never)]
    pub fn step(&mut self, rate: Vector3) {
        if !self.started {
            self.start(rate);
        }
        // Half way between two boundaries of the schedule, whose ticks have enough to do.
        if self.ticks.checked_rem(self.design.every) == Some(self.design.every / 2) {
            self.renew_notch();
        }
        let mut now = match &self.design.low_pass {
            Some(low_pass) => low_pass.apply(rate, &self.input, &self.smooth),
            None => rate,
        };
        let mut two = self.smooth.two;
        self.input.push(rate);
        self.smooth.push(now);
        // One after the other in the text as well: no loop is unrolled in a program that is built for size.
        let width = &self.design.width;
        let [n0, n1, n2, n3] = &self.notches;
        let [t0, t1, t2, t3] = &mut self.tones;
        n0.take_out(width, &mut now, &mut two, t0);
        n1.take_out(width, &mut now, &mut two, t1);
        n2.take_out(width, &mut now, &mut two, t2);
        n3.take_out(width, &mut now, &mut two, t3);
        self.output = now;
    }

    /// The filtered rate at the last sample, body FRD, rad/s.
    #[inline]
    pub fn rate(&self) -> Vector3 {
        self.output
    }

    #[cold]
    fn start(&mut self, rate: Vector3) {
        self.input = Past::settled(rate);
        self.smooth = self.input;
        self.started = true;
    }

    /// One rotor follows its command, and its notch follows the rotor.
    #[inline]
    fn renew_notch(&mut self) {
        let n = self.rotor;
        if let (Some(command), Some(turn), Some(notch)) = (
            self.commands.get(n),
            self.turn.get_mut(n),
            self.notches.get_mut(n),
        ) {
            *turn += (f32::from(*command) * self.design.per_command - *turn) * self.design.share;
            *notch = self.design.notch(*turn);
        }
        self.rotor = (n + 1) % 4;
    }
}
