//! Counts beside their bounds and beside what the same work costs elsewhere.

use std::fmt::{self, Display, Formatter};

use super::Count;
use super::kernels::{FUNCTIONS, Kernels};
use super::ticks::Ticks;

/// What a count must not exceed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Nothing is asked.
    None,
    /// Instructions of a call in the mean.
    Mean(u64),
    /// Instructions of each call.
    Each(u64),
}

impl Bound {
    fn holds(self, count: &Count) -> bool {
        match self {
            Self::None => true,
            Self::Mean(most) => count.calls > 0 && count.mean() <= most as f64,
            Self::Each(most) => count.calls > 0 && count.max <= most,
        }
    }
}

impl Display for Bound {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        match self {
            Self::None => f.pad(""),
            Self::Mean(most) => f.pad(&format!("mean {most}")),
            Self::Each(most) => f.pad(&format!("{most}")),
        }
    }
}

/// Instructions of the same work in other autopilots and libraries, on a Cortex-M4F in QEMU
/// (mps2-an386), each with its own compiler flags; between two builds they differ by some 3.
type Peers = &'static [(&'static str, u64)];

const INNER: Peers = &[
    ("Crazyflie, controllerPid, attitude and rate only", 1_156),
    ("Crazyflie, power distribution and cap: at most", 88 + 88),
    ("Crazyflie, controllerPid, mean of a 1 kHz call", 837),
    ("Betaflight, pidController with angle, no mixer", 1_178),
    ("PX4, AttitudeControl and RateControl, no mixer", 814 + 183),
    (
        "holsatus, angle PID and rate PID of three axes, no mixer",
        206 + 243,
    ),
];

const OUTER: Peers = &[
    ("Crazyflie, controllerPid with position, whole tick", 3_197),
    ("Crazyflie, Mellinger, whole tick", 484),
    ("Crazyflie, INDI, whole tick", 1_298),
    ("Crazyflie, Lee, whole tick", 2_557),
    ("PX4, PositionControl", 892),
];

const PREDICT: Peers = &[
    ("Crazyflie, kalman_core, 9 states", 11_632),
    ("eskf-rs, 15 states", 4_534),
];

const SCALAR: Peers = &[
    ("Crazyflie, kalman_core, one scalar", 14_702),
    ("eskf-rs, height", 3_130),
];

const SIN: Peers = &[
    ("newlib", 84),
    ("micromath, error 1e-3", 38),
    ("CMSIS, error 2e-5", 37),
    ("crate libm", 1_262),
];

const ASIN: Peers = &[("newlib", 74), ("micromath, error 2e-2", 34), ("crate libm", 351)];

const ATAN2: Peers = &[("newlib", 110), ("micromath", 40), ("crate libm", 83)];

/// Why the longest tick in a mission is not the one that is bound.
const PLANNING: &str = "The outer tick in a mission is bound in the mean over the flight: the few ticks that plan a leg \
                        (max) are longer.";

/// One line, and those of the peers below it.
#[derive(Clone, Debug)]
struct Row {
    name: &'static str,
    count: Count,
    bound: Bound,
    peers: Peers,
}

/// All that was counted.
#[derive(Clone, Debug)]
pub struct Table(Vec<Row>);

impl Table {
    /// From counts of the firmware's steps, and of the single functions.
    pub fn new(ticks: &Ticks, kernels: &Kernels) -> Self {
        use Bound::{Each, Mean, None};
        let [sin, cos, sin_cos, asin, acos, atan2] = kernels.functions;
        let [predict, barometer, compass, gravity, place, height, velocity] = kernels.filter;
        let row = |name, count, bound, peers| Row {
            name,
            count,
            bound,
            peers,
        };
        let all = ticks.between.and(&ticks.boundaries);
        let [sin_name, cos_name, sin_cos_name, asin_name, acos_name, atan2_name] = FUNCTIONS;
        Self(vec![
            row("inner tick, disarmed", ticks.disarmed, None, &[]),
            row("inner tick in flight", ticks.between, Mean(1000), INNER),
            row("  gyro filter in it", ticks.filter, None, &[]),
            row("  at a boundary", ticks.boundaries, None, &[]),
            row("  all of them", all, None, &[]),
            row(
                "outer tick in a mission, no filter",
                kernels.mission,
                Mean(2500),
                OUTER,
            ),
            row("outer tick, filter, no position", ticks.outer, None, &[]),
            row("filter: predict", predict, Each(1500), PREDICT),
            row("  barometer, direct", barometer, Each(800), SCALAR),
            row("  compass, 3 non-zeros", compass, Each(1000), &[]),
            row("  gravity, each of 3 scalars", gravity, Each(1000), &[]),
            row("  late position, each of 2", place, Each(1000), &[]),
            row("  late height", height, Each(1000), &[]),
            row("  late velocity, each of 3", velocity, Each(1000), &[]),
            row("  look back, once per late message", kernels.look_back, None, &[]),
            row(sin_name, sin, Each(50), SIN),
            row(cos_name, cos, Each(50), &[]),
            row(sin_cos_name, sin_cos, Each(65), &[]),
            row(asin_name, asin, Each(55), ASIN),
            row(acos_name, acos, Each(55), &[]),
            row(atan2_name, atan2, Each(75), ATAN2),
        ])
    }

    /// The lines whose bound is missed.
    pub fn missed(&self) -> Vec<&'static str> {
        let missed = self.0.iter().filter(|row| !row.bound.holds(&row.count));
        missed.map(|row| row.name.trim_start()).collect()
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        writeln!(
            f,
            "{:34} {:>7} {:>6} {:>8} {:>6} {:>9} {:>9}",
            "instructions", "calls", "min", "mean", "max", "at most", "cycles*"
        )?;
        for row in &self.0 {
            let Row {
                name, count, bound, ..
            } = row;
            let verdict = if bound.holds(count) { "" } else { "  MISSED" };
            writeln!(
                f,
                "{name:34} {:>7} {:>6} {:>8.1} {:>6} {bound:>9} {:>9.1}{verdict}",
                count.calls,
                count.min,
                count.mean(),
                count.max,
                count.mean_cycles()
            )?;
            for (peer, instructions) in row.peers {
                writeln!(f, "{:42} {instructions:>15}  {peer}", "")?;
            }
        }
        writeln!(f, "{PLANNING}")?;
        writeln!(f, "* of a call in the mean; an estimate by the cost model")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calls(min: u64, max: u64, sum: u64) -> Count {
        Count {
            calls: 2,
            min,
            max,
            instructions: sum,
            cycles: sum,
        }
    }

    #[test]
    fn a_bound_holds_for_the_mean_or_for_each_call() {
        let count = calls(650, 740, 1390);
        assert!(Bound::Mean(695).holds(&count));
        assert!(!Bound::Mean(694).holds(&count));
        assert!(Bound::Each(740).holds(&count));
        assert!(!Bound::Each(739).holds(&count));
    }

    #[test]
    fn what_was_never_called_holds_no_bound() {
        let table = Table::new(&Ticks::default(), &Kernels::default());
        assert_eq!(table.missed().len(), 15);
    }

    #[test]
    fn a_missed_bound_is_named() {
        let ticks = Ticks {
            between: calls(900, 1300, 2200),
            ..Ticks::default()
        };
        let kernels = Kernels {
            functions: [calls(40, 50, 90); 6],
            filter: [calls(700, 800, 1500); 7],
            mission: calls(1000, 2000, 3000),
            ..Kernels::default()
        };
        let table = Table::new(&ticks, &kernels);
        assert_eq!(table.missed(), ["inner tick in flight"]);
        assert_eq!(table.to_string().matches("MISSED").count(), 1);
    }
}
