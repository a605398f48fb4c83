//! The inner and the outer step of the firmware, counted while it flies.
//!
//! The flight is an open loop but for the attitude: a thrust a little above the weight, and a new
//! attitude every other second, so that control always has something to do.

use std::sync::Arc;

use windhover_math::{Euler, GRAVITY, Quaternion};

use super::{Call, Count};
use crate::elf::Elf;
use crate::flight::{Flight, FlightError, Plan, Vehicle405};
use crate::machine::{Calls, Probe};
use crate::pilot;
use crate::time::SECOND;
use crate::trouble::{INNER_STEP, OUTER_STEP};

/// The machine stops so often to be asked, in ticks of virtual time: several times between two
/// inner ticks, so that each call is seen alone.
const SLICE: u64 = SECOND / 10_000;

/// A setpoint arrives so often.
const SETPOINT_PERIOD: u64 = SECOND / 50;

/// So long the disarmed vehicle is looked at, from power-on.
const DISARMED: u64 = SECOND;

/// From then on, since its motors turn, the vehicle is in the air, and everything counts.
const AIRBORNE: u64 = 3 * SECOND;

/// Thrust as a share of the weight.
const CLIMB: f64 = 1.05;

/// Roll and pitch that are held in turn, in degrees, and for how long.
const TILTS: [[f32; 2]; 4] = [[10.0, 0.0], [0.0, 10.0], [-10.0, 0.0], [0.0, -10.0]];
const HOLD: u64 = 2 * SECOND;

/// What a flight counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ticks {
    /// Inner ticks while disarmed.
    pub disarmed: Count,
    /// Inner ticks in the air: predictor, attitude control and mixer, and nothing else.
    pub between: Count,
    /// The gyro filter's step, in every inner tick that has a sample.
    pub filter: Count,
    /// Inner ticks in the air that also adopt a result of the outer step and hand over to it.
    pub boundaries: Count,
    /// The outer step in the air: the filter, and attitudes that are passed on.
    pub outer: Count,
}

/// Flies the firmware for the plan's seconds in the air.
///
/// # Errors
/// When it has not these functions, or does what it must not.
pub fn count(elf: Arc<Elf>, plan: &Plan) -> Result<Ticks, FlightError> {
    let mut flight = Flight::new(elf, plan)?;
    let mut inner = Sampler::new(&mut flight.machine, INNER_STEP)?;
    let mut outer = Sampler::new(&mut flight.machine, OUTER_STEP)?;
    let mut filter = Sampler::new(&mut flight.machine, "GyroFilter::step")?;
    let mut ticks = Ticks::default();
    for slice in 1..=DISARMED / SLICE {
        flight.run(slice * SLICE)?;
        if let Some(call) = inner.take(&flight.machine) {
            ticks.disarmed.add(call);
        }
    }
    flight.prepare()?;
    if !flight.arm()? {
        return Err(FlightError::Unarmed);
    }
    let armed = flight.machine.now();
    let end = AIRBORNE + (plan.seconds * SECOND as f64) as u64;
    let mut last_inner = None;
    for slice in 0..end / SLICE {
        let now = slice * SLICE;
        steer(&mut flight, plan.vehicle.plant.mass, now);
        flight.run(armed + now + SLICE)?;
        let calls = [&mut inner, &mut filter, &mut outer].map(|sampler| sampler.take(&flight.machine));
        let [inner, filter, outer] = if now < AIRBORNE { [None; 3] } else { calls };
        if let Some(call) = inner
            && let Some(call) = last_inner.replace(call)
        {
            // Whether the last one was a boundary is known by now.
            ticks.between.add(call);
        }
        if let Some(call) = filter {
            ticks.filter.add(call);
        }
        // An outer step ends before the next inner tick: the last one was its boundary.
        if let Some(call) = outer {
            ticks.outer.add(call);
            if let Some(call) = last_inner.take() {
                ticks.boundaries.add(call);
            }
        }
    }
    Ok(ticks)
}

/// Sends what is due at this moment since the motors turn.
fn steer(flight: &mut Flight, mass: f64, now: u64) {
    if now.is_multiple_of(SETPOINT_PERIOD) {
        let [roll, pitch] = TILTS[(now / HOLD) as usize % TILTS.len()].map(f32::to_radians);
        let attitude = Quaternion::from_euler(Euler {
            roll,
            pitch,
            yaw: 0.0,
        });
        flight.send(&pilot::attitude(
            attitude,
            (CLIMB * mass * f64::from(GRAVITY)) as f32,
        ));
    }
}

/// Tells the calls of a function apart.
struct Sampler {
    probe: Probe,
    seen: Calls,
}

impl Sampler {
    fn new(machine: &mut Vehicle405, function: &str) -> Result<Self, FlightError> {
        let probe = machine.count(function)?;
        let seen = machine.calls(probe);
        Ok(Self { probe, seen })
    }

    /// The call that ended since the last time; none as well if it was more than one.
    fn take(&mut self, machine: &Vehicle405) -> Option<Call> {
        let calls = machine.calls(self.probe);
        let before = std::mem::replace(&mut self.seen, calls);
        (calls.count == before.count + 1).then(|| Call {
            instructions: calls.instructions.sum - before.instructions.sum,
            cycles: calls.cycles.sum - before.cycles.sum,
        })
    }
}
