//! Mission: brakes from whatever motion there was, then flies the stored items; a mission that was
//! interrupted goes on at the leg or the stop that was not finished.

use windhover_math::{Vector3, min};

use super::course::Course;
use super::{Around, Demand, Mode, Motion, Step};
use crate::mission::executor::{MissionEstimate, Surroundings};
use crate::mission::{MissionEvents, MissionExecutor, MissionSource};

/// The mode's memory; how far the mission has come is kept by [`super::Modes`].
#[derive(Clone, Debug)]
pub struct Mission {
    /// While it brakes.
    braking: Option<Course>,
}

impl Mission {
    /// From the present motion on. From the ground, a mission that goes on does so at the height of its
    /// leg: nothing is dragged along.
    pub fn enter<S: ?Sized>(
        motion: &Motion,
        around: &Around<'_, S>,
        interrupted: Option<&MissionExecutor>,
    ) -> Self {
        let from = motion.glide.position;
        let above = interrupted
            .filter(|_| around.landed)
            .map(|mission| Vector3::new(from.x, from.y, min(mission.leg_end().z, from.z)));
        Self {
            braking: Some(Course::new(motion, above.as_slice())),
        }
    }

    /// One step. `mission` is what was interrupted, if anything was; `first` is the item that a new
    /// one starts with. The step is written in place: a mission flies for long, and its steps are many.
    pub fn step<S: MissionSource + ?Sized>(
        &mut self,
        around: &Around<'_, S>,
        mission: &mut Option<MissionExecutor>,
        first: u16,
        events: &mut MissionEvents,
        step: &mut Step,
    ) {
        let Some(surroundings) = surroundings(around) else {
            *step = self.stay(around);
            return;
        };
        if let Some(course) = &mut self.braking {
            let setpoint = course.step(around);
            if !course.is_done() {
                *step = Step::of(Demand::Follow(setpoint));
                return;
            }
            begin(
                around,
                &surroundings,
                mission,
                first,
                course.position(),
                setpoint.heading,
            );
            if mission.is_none() {
                *step = self.stay(around);
                return;
            }
            self.braking = None;
        }
        let Some(mission) = mission else {
            *step = self.stay(around);
            return;
        };
        let waits = around.landed && mission.waits_on_ground();
        let setpoint = mission.step(&surroundings, around.dt, events);
        if waits {
            // The first step plans; the vehicle stands meanwhile.
            *step = Step::rest();
            return;
        }
        step.demand = Demand::Follow(setpoint);
        step.next = mission.outcome();
        step.contact = false;
        step.leg_end = Some(mission.leg_end());
    }

    /// There is nothing to fly to: stays where it is, and hold goes on with that.
    fn stay<S: ?Sized>(&mut self, around: &Around<'_, S>) -> Step {
        let demand = if around.landed {
            Demand::Rest
        } else {
            let rest = Course::new(&around.at_rest(), &[]);
            Demand::Follow(self.braking.get_or_insert(rest).step(around))
        };
        Step {
            next: Some(Mode::Hold),
            ..Step::of(demand)
        }
    }
}

/// What the executor is told.
fn surroundings<'a, S: MissionSource + ?Sized>(around: &Around<'a, S>) -> Option<Surroundings<'a, S>> {
    Some(Surroundings {
        source: around.source,
        frame: around.frame?,
        home: around.home,
        parameters: &around.parameters.mission,
        estimate: MissionEstimate {
            position: around.estimate.position,
            shift: around.handover.position,
            velocity: around.estimate.velocity,
            landed: around.landed,
        },
    })
}

/// Starts the mission from `position`, or takes it up again.
fn begin<S: MissionSource + ?Sized>(
    around: &Around<'_, S>,
    surroundings: &Surroundings<'_, S>,
    mission: &mut Option<MissionExecutor>,
    first: u16,
    position: Vector3,
    heading: f32,
) {
    match mission {
        Some(mission) => mission.rejoin(surroundings, position, heading),
        None => {
            *mission = around
                .stored
                .and_then(|stored| MissionExecutor::start(stored, surroundings, first, position, heading));
        }
    }
}
