//! What keeps coming by the clock keeps coming in a simulation that runs faster: setpoints, sticks,
//! channels and heartbeats are repeated, for as long as their sender may still be there.

use windhover_autopilot::mode::Guidance;
use windhover_autopilot::{OuterInputs, RcFrame, Station, Sticks};
use windhover_control::position::AttitudeSetpoint;

/// Whoever sends so rarely, µs by the clock, has stopped: half a second for what steers.
const STEERING: u64 = 500_000;

/// The same for heartbeats, which come once a second.
const HEARTBEAT: u64 = 2_500_000;

/// Between two repetitions, outer steps.
const STEPS: u32 = 25;

/// The newest of each, and when it came, µs by the clock.
#[derive(Clone, Debug, Default)]
pub struct Echo {
    guidance: Option<(u64, Guidance)>,
    attitude: Option<(u64, AttitudeSetpoint)>,
    sticks: Option<(u64, Sticks)>,
    rc: Option<(u64, RcFrame)>,
    station: Option<(u64, Station)>,
    steps: u32,
}

/// Notes what is new, and gives the last one when nothing is and it is not too old.
fn echo<T: Copy>(
    newest: &mut Option<(u64, T)>,
    new: Option<&T>,
    now: u64,
    patience: u64,
    due: bool,
) -> Option<T> {
    if let Some(new) = new {
        *newest = Some((now, *new));
        return None;
    }
    newest
        .filter(|(at, _)| due && now.saturating_sub(*at) < patience)
        .map(|(_, item)| item)
}

impl Echo {
    /// Adds to what comes in with an outer step, at `now`.
    pub fn repeat(&mut self, inputs: &mut OuterInputs, now: u64) {
        self.steps += 1;
        let due = self.steps >= STEPS;
        if due {
            self.steps = 0;
        }
        // One kind of setpoint at a time: the newer one is meant.
        if !inputs.guidance.is_empty() {
            self.attitude = None;
        }
        if !inputs.attitude.is_empty() {
            self.guidance = None;
        }
        let last = inputs.guidance.last();
        let guidance = echo(&mut self.guidance, last, now, STEERING, due);
        let attitude = echo(&mut self.attitude, inputs.attitude.last(), now, STEERING, due);
        let sticks = echo(&mut self.sticks, inputs.sticks.last(), now, STEERING, due);
        let rc = echo(&mut self.rc, inputs.rc.last(), now, STEERING, due);
        let station = echo(&mut self.station, inputs.station.last(), now, HEARTBEAT, due);
        inputs.guidance.extend(guidance);
        inputs.attitude.extend(attitude);
        inputs.sticks.extend(sticks);
        inputs.rc.extend(rc);
        inputs.station.extend(station);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_came_is_repeated_until_its_sender_is_gone() {
        let mut echo = Echo::default();
        let mut inputs = OuterInputs::default();
        let _ = inputs.station.push(Station { system: 7 });
        let _ = inputs.sticks.push(Sticks::default());
        echo.repeat(&mut inputs, 0);
        assert_eq!(
            (inputs.station.len(), inputs.sticks.len()),
            (1, 1),
            "nothing is doubled"
        );
        let (mut stations, mut sticks, mut last) = (0, 0, 0);
        // Twenty times as fast: an outer step is 200 µs by the clock.
        for step in 1..20_000u64 {
            let mut inputs = OuterInputs::default();
            echo.repeat(&mut inputs, step * 200);
            stations += inputs.station.len();
            sticks += inputs.sticks.len();
            if !inputs.sticks.is_empty() {
                last = step * 200;
            }
        }
        assert!((490..=500).contains(&stations), "{stations}");
        assert!(
            (95..=100).contains(&sticks) && last < STEERING,
            "{sticks}, {last}"
        );
    }
}
