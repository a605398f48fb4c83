//! When sensors measure.

/// When a sensor measures: at `phase`, and every `period` from then on; both in µs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// From one measurement to the next.
    pub period: u64,
    /// The first.
    pub phase: u64,
}

/// Rates of all sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rates {
    /// Inertial measurement unit: that of the world's steps.
    pub imu: Rate,
    /// Barometer.
    pub barometer: Rate,
    /// Compass.
    pub compass: Rate,
    /// Satellite receiver.
    pub gnss: Rate,
    /// ADC of the battery.
    pub battery: Rate,
    /// RC receiver.
    pub rc: Rate,
}

impl Default for Rates {
    /// 1 kHz, 50 Hz for barometer, compass and RC, 10 Hz for the rest; apart from each other, as
    /// things that do not know of each other are.
    fn default() -> Self {
        let rate = |period, phase| Rate { period, phase };
        Self {
            imu: rate(1_000, 0),
            barometer: rate(20_000, 3_000),
            compass: rate(20_000, 7_000),
            gnss: rate(100_000, 0),
            battery: rate(100_000, 11_000),
            rc: rate(20_000, 13_000),
        }
    }
}

/// When one sensor is due.
#[derive(Clone, Copy, Debug)]
pub(super) struct Due {
    rate: Rate,
    next: u64,
}

impl Due {
    pub fn new(rate: Rate) -> Self {
        Self {
            rate,
            next: rate.phase,
        }
    }

    /// Whether it measures now. Moments missed are not made up for.
    pub fn now(&mut self, time: u64) -> bool {
        let due = time >= self.next;
        if due {
            let period = Ord::max(self.rate.period, 1);
            self.next += period * (1 + (time - self.next) / period);
        }
        due
    }
}
