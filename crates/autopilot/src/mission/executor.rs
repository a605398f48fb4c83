//! Flies a mission: where to be now, when to take a photo, and what has been reached.
//!
//! The path is planned one leg ahead, so that waypoints without a stop are passed in a curve. At
//! a stop the vehicle first arrives, stays for the hold time, and then does what the items before
//! the next waypoint ask for; a photo there is taken once, when position and speed have settled.

use heapless::Vec;
use windhover_control::TrajectorySetpoint;
use windhover_math::geodesy::LocalFrame;
use windhover_math::{Vector3, atan2, scalar};

use super::action::Action;
use super::camera::Trigger;
use super::nav::{Chart, Nav, NavKind};
use super::route::{Cursor, Stored};
use super::{MissionParameters, MissionSource};
use crate::mode::Mode;
use crate::trajectory::path::{SHORTEST_PASS, direction_and_length};
use crate::trajectory::{HeadingSlew, Path, path::Joint, towards};

/// What happened in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MissionEvent {
    /// The vehicle came within the acceptance radius of the item with this index.
    Reached(u16),
    /// The mission goes on without having come that close.
    Missed(u16),
    /// The shutter was released.
    Photo {
        /// The item that asked for it.
        item: u16,
        /// Where it was to be taken, NED, m; `None` for photos taken in passing.
        target: Option<Vector3>,
        /// Whether position and speed had settled; always true for photos taken in passing.
        settled: bool,
    },
    /// The vehicle stands on the ground after a flight.
    Landed,
    /// Nothing is left to do.
    Finished,
}

/// Events of one step: at most a waypoint, a photo and an end.
pub type MissionEvents = Vec<MissionEvent, 4>;

/// What the executor needs to know of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionEstimate {
    /// Position, NED, m from home.
    pub position: Vector3,
    /// How far from the path's point control leads the vehicle meanwhile, NED, m: not 0 after a
    /// step of the estimate (see [`crate::estimation::handover`]).
    pub shift: Vector3,
    /// Velocity, NED, m/s.
    pub velocity: Vector3,
    /// Whether the vehicle is on the ground.
    pub landed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// On the way to `current`.
    Fly,
    /// At the end of a leg that ends in a stop; seconds since.
    Arrive(f32),
    /// Reached; seconds since.
    Hold(f32),
    /// Doing the items behind the stop.
    Work,
    /// A photo is to be taken: seconds since it was asked for, and since all has settled.
    Settle { item: u16, since: f32, settled: f32 },
    /// Waiting, seconds left.
    Delay(f32),
    /// Nothing left to do; this mode follows.
    Finished(Mode),
}

/// The mission as far as it has been flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionExecutor {
    stored: Stored,
    state: State,
    path: Path,
    current: Nav,
    next: Option<Nav>,
    /// The waypoint passed last, if the vehicle has not come close to it yet.
    passing: Option<Nav>,
    reached: bool,
    heading: HeadingSlew,
    heading_target: f32,
    look_at: Option<Vector3>,
    trigger: Trigger,
    trigger_item: u16,
    last_error: f32,
    /// What was interrupted at the stop that is being flown back to.
    rejoining: Option<State>,
}

/// What a step needs besides the executor's own state.
pub struct Surroundings<'a, S: ?Sized> {
    /// The stored missions.
    pub source: &'a S,
    /// The local frame.
    pub frame: &'a LocalFrame,
    /// Home, NED, m from the frame's origin.
    pub home: Vector3,
    /// The parameters.
    pub parameters: &'a MissionParameters,
    /// What is known of the vehicle.
    pub estimate: MissionEstimate,
}

impl<S: MissionSource + ?Sized> Surroundings<'_, S> {
    fn chart(&self, stored: Stored) -> Chart<'_, S> {
        Chart {
            source: self.source,
            stored,
            frame: self.frame,
            home: self.home,
            parameters: self.parameters,
        }
    }
}

impl MissionExecutor {
    /// Starts the mission before the item with index `first`, from a setpoint that rests at
    /// `position` (NED, m) with a `heading` (rad). `None` when there is nothing to fly to.
    pub fn start<S: MissionSource + ?Sized>(
        stored: Stored,
        around: &Surroundings<'_, S>,
        first: u16,
        position: Vector3,
        heading: f32,
    ) -> Option<Self> {
        let start = around
            .chart(stored)
            .start(first, position, around.estimate.landed)?;
        Some(Self {
            stored,
            state: State::Work,
            path: Path::at(position),
            current: start,
            next: None,
            passing: None,
            reached: false,
            heading: HeadingSlew { heading, rate: 0.0 },
            heading_target: heading,
            look_at: None,
            trigger: Trigger::Off,
            trigger_item: 0,
            last_error: 0.0,
            rejoining: None,
        })
    }

    /// Takes the mission up again after it was interrupted, from a setpoint that rests at `position`
    /// (NED, m) with a `heading` (rad): the leg is flown to its end; what was begun at a stop is
    /// begun there again, so that no photo is left out and none is taken twice.
    pub fn rejoin<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        position: Vector3,
        heading: f32,
    ) {
        self.heading = HeadingSlew { heading, rate: 0.0 };
        self.path = Path::at(position);
        self.next = None;
        if matches!(self.current.kind, NavKind::Start { .. }) || matches!(self.state, State::Finished(_)) {
            let landed = around.estimate.landed;
            self.current.kind = NavKind::Start { landed };
            self.current.target = position;
            return;
        }
        self.rejoining = match self.state {
            // It has been there already, on its way through.
            State::Fly if self.reached => Some(State::Hold(0.0)),
            State::Fly | State::Arrive(_) => self.rejoining,
            State::Settle { item, .. } => Some(State::Settle {
                item,
                since: 0.0,
                settled: 0.0,
            }),
            State::Hold(_) => Some(State::Hold(0.0)),
            other => Some(other),
        };
        self.state = State::Fly;
        self.reached = false;
        let current = self.current;
        self.push(around, &current, Joint::Stop, Joint::Stop);
    }

    /// Points the nose at a place from here on, or ahead again.
    pub fn look_at(&mut self, place: Option<Vector3>) {
        self.look_at = place;
    }

    /// Flies at another ground speed from the next leg on, m/s; `None` goes back to the parameter's.
    pub fn set_speed(&mut self, speed: Option<f32>) {
        self.current.speed = speed;
        if let Some(next) = &mut self.next {
            next.speed = speed;
        }
    }

    /// The mode that follows a mission that is over.
    pub fn outcome(&self) -> Option<Mode> {
        match self.state {
            State::Finished(mode) => Some(mode),
            _ => None,
        }
    }

    /// Whether the vehicle still stands where the mission was started, on the ground.
    pub fn waits_on_ground(&self) -> bool {
        self.current.kind == NavKind::Start { landed: true }
    }

    /// Where the leg that is being flown leads, NED, m.
    pub fn leg_end(&self) -> Vector3 {
        self.current.target
    }

    /// Index of the item that is being flown to or worked on.
    pub fn current_item(&self) -> u16 {
        self.current.item
    }

    /// Goes on by `dt` µs: where to be now. What happens is added to `events`.
    #[inline(always)]
    pub fn step<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        dt: u32,
        events: &mut MissionEvents,
    ) -> TrajectorySetpoint {
        let seconds = dt as f32 * 1e-6;
        let step = self.path.step(dt, self.path_rate(around.parameters));
        let mut setpoint = step.setpoint;
        let led_to = setpoint.position + around.estimate.shift;
        self.last_error = scalar::norm(led_to - around.estimate.position);
        self.watch(around, events);
        if self.trigger.step(around.estimate.position, seconds) {
            self.photo(events, self.trigger_item, None, true);
        }
        self.state = self.advance(around, step.leg_finished, seconds, events);
        self.turn(around, &mut setpoint, seconds);
        setpoint
    }

    /// One transition of the state machine.
    fn advance<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        leg_finished: bool,
        seconds: f32,
        events: &mut MissionEvents,
    ) -> State {
        match self.state {
            State::Fly if !leg_finished => State::Fly,
            State::Fly if self.path.is_finished() => State::Arrive(0.0),
            State::Fly => self.pass(around, events),
            State::Arrive(since) if self.reached => {
                self.give_up_passing(events);
                self.rejoining.take().unwrap_or(State::Hold(since))
            }
            State::Arrive(since) if since >= around.parameters.arrival_wait => {
                self.give_up_passing(events);
                self.give_up(events);
                self.rejoining.take().unwrap_or(State::Hold(since))
            }
            State::Arrive(since) => State::Arrive(since + seconds),
            State::Hold(since) if since >= self.current.hold => State::Work,
            State::Hold(since) => State::Hold(since + seconds),
            State::Work => self.work(around, events),
            State::Settle { item, since, settled } => {
                self.settle(around, item, since + seconds, settled + seconds, events)
            }
            State::Delay(left) if left > seconds => State::Delay(left - seconds),
            State::Delay(_) => State::Work,
            State::Finished(mode) => State::Finished(mode),
        }
    }

    /// How fast the path's point moves: slower when the vehicle has fallen behind.
    fn path_rate(&self, parameters: &MissionParameters) -> f32 {
        parameters.rate(self.last_error)
    }

    /// Plans the leg to `current` and, where that is not a stop, the one after it.
    fn begin_leg<S: MissionSource + ?Sized>(&mut self, around: &Surroundings<'_, S>) {
        let current = self.current;
        let following = around.chart(self.stored).following(&current);
        let after = joint(self.path.end(), &current, following.as_ref());
        self.reached = false;
        self.push(around, &current, Joint::Stop, after);
        self.plan_next(around, following, after);
        self.aim(around, &current);
    }

    /// Plans the leg after `current`, if it is joined to it.
    fn plan_next<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        following: Option<Nav>,
        joint_before: Joint,
    ) {
        let (Some(next), Joint::Pass { radius, .. }) = (following, joint_before) else {
            self.next = None;
            return;
        };
        let corner = self.path.end();
        let beyond = around.chart(self.stored).following(&next);
        let after = joint(corner, &next, beyond.as_ref());
        let before = Joint::Pass {
            direction: self.path.last_direction(),
            radius,
        };
        self.push(around, &next, before, after);
        self.next = Some(next);
    }

    fn push<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        nav: &Nav,
        before: Joint,
        after: Joint,
    ) {
        let limits = around.chart(self.stored).limits(nav, around.estimate.landed);
        self.path.push(nav.target, &limits, before, after);
    }

    /// A corner has been rounded: what the mission asks for there happens, and the leg after the
    /// next one is planned.
    fn pass<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        events: &mut MissionEvents,
    ) -> State {
        let Some(next) = self.next.take() else {
            return State::Arrive(0.0);
        };
        self.give_up_passing(events);
        self.passing = (!self.reached).then_some(self.current);
        self.run_passing_items(around, self.current.after, next.item);
        self.current = next;
        self.reached = false;
        let following = around.chart(self.stored).following(&next);
        let after = self.path.last_joint();
        self.plan_next(around, following, after);
        self.aim(around, &next);
        State::Fly
    }

    /// Does the items from `cursor` on that need no rest, up to the item with index `until`.
    fn run_passing_items<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        mut cursor: Cursor,
        until: u16,
    ) {
        while let Some((item, action)) = cursor.advance(around.source, self.stored) {
            if item == until || action.is_navigation() {
                return;
            }
            self.run(around, item, &action);
        }
    }

    /// Does one item that needs no rest.
    fn run<S: MissionSource + ?Sized>(&mut self, around: &Surroundings<'_, S>, item: u16, action: &Action) {
        match *action {
            Action::PhotoByDistance { distance, at_once } => {
                let far = Vector3::new(f32::MAX, 0.0, 0.0);
                let last = if at_once { far } else { around.estimate.position };
                let on = Trigger::Distance { distance, last };
                self.trigger = if distance > 0.0 { on } else { Trigger::Off };
                self.trigger_item = item;
            }
            Action::PhotoByTime { interval, count } => {
                let left = (count > 0).then_some(count);
                self.trigger = Trigger::Time {
                    interval,
                    since: interval,
                    left,
                };
                self.trigger_item = item;
            }
            Action::PhotoStop => self.trigger = Trigger::Off,
            Action::LookAt(place) => self.look_at = Some(around.chart(self.stored).local(&place)),
            Action::LookAhead => self.look_at = None,
            _ => {}
        }
    }

    /// The next item behind a stop.
    fn work<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        events: &mut MissionEvents,
    ) -> State {
        let mut cursor = self.current.after;
        let within = around.chart(self.stored).following(&self.current);
        let same_item = within.is_some_and(|next| next.after == cursor);
        let next = if same_item {
            None
        } else {
            cursor.advance(around.source, self.stored)
        };
        match next {
            Some((item, action)) if !action.is_navigation() => {
                self.current.after = cursor;
                self.current.speed = speed_after(self.current.speed, &action);
                match action {
                    Action::Photo => State::Settle {
                        item,
                        since: 0.0,
                        settled: 0.0,
                    },
                    Action::Delay(seconds) => State::Delay(seconds),
                    _ => {
                        self.run(around, item, &action);
                        State::Work
                    }
                }
            }
            _ => match within {
                Some(next) => {
                    if let NavKind::End(mode) = next.kind {
                        return self.finish(mode, events);
                    }
                    self.current = next;
                    self.begin_leg(around);
                    State::Fly
                }
                None => self.finish(Mode::Hold, events),
            },
        }
    }

    /// Waits until the vehicle is still enough for a photo, or has had its time.
    fn settle<S: MissionSource + ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        item: u16,
        since: f32,
        settled: f32,
        events: &mut MissionEvents,
    ) -> State {
        let p = around.parameters;
        let error = scalar::norm(self.current.target - around.estimate.position);
        let still = error <= p.photo_error && scalar::norm(around.estimate.velocity) <= p.photo_speed;
        let settled = if still { settled } else { 0.0 };
        let done = still && settled >= p.photo_dwell;
        if done || since >= p.photo_wait {
            self.photo(events, item, Some(self.current.target), done);
            return State::Work;
        }
        State::Settle { item, since, settled }
    }

    fn finish(&mut self, mode: Mode, events: &mut MissionEvents) -> State {
        let _ = events.push(MissionEvent::Finished);
        self.trigger = Trigger::Off;
        State::Finished(mode)
    }

    /// Notes which waypoints the vehicle has come close to.
    fn watch<S: ?Sized>(&mut self, around: &Surroundings<'_, S>, events: &mut MissionEvents) {
        let within = |nav: &Nav| scalar::norm(nav.target - around.estimate.position) <= nav.radius;
        if self.passing.as_ref().is_some_and(within) {
            let item = self.passing.take().map_or(0, |nav| nav.item);
            let _ = events.push(MissionEvent::Reached(item));
        }
        let closing = matches!(self.state, State::Fly | State::Arrive(_));
        // A stop is reached when the path ends there, not on the way in.
        let passes = self.next.is_some() || matches!(self.state, State::Arrive(_));
        if closing && passes && !self.reached && within(&self.current) {
            self.reached = true;
            if self.current.kind == NavKind::Waypoint && self.rejoining.is_none() {
                let _ = events.push(MissionEvent::Reached(self.current.item));
            }
        }
    }

    fn give_up(&mut self, events: &mut MissionEvents) {
        if self.current.kind == NavKind::Waypoint && self.rejoining.is_none() {
            let _ = events.push(MissionEvent::Missed(self.current.item));
        }
    }

    fn give_up_passing(&mut self, events: &mut MissionEvents) {
        if let Some(nav) = self.passing.take() {
            let _ = events.push(MissionEvent::Missed(nav.item));
        }
    }

    fn photo(&self, events: &mut MissionEvents, item: u16, target: Option<Vector3>, settled: bool) {
        let _ = events.push(MissionEvent::Photo {
            item,
            target,
            settled,
        });
    }

    /// Sets the heading that the leg to `nav` is flown with.
    fn aim<S: ?Sized>(&mut self, around: &Surroundings<'_, S>, nav: &Nav) {
        if let Some(heading) = nav.heading {
            self.heading_target = heading;
        } else if around.parameters.yaw_mode > 0.5
            && matches!(nav.kind, NavKind::Waypoint | NavKind::Approach)
        {
            let way = nav.target - around.estimate.position;
            if windhover_math::sqrt(way.x * way.x + way.y * way.y) > 1.0 {
                self.heading_target = atan2(way.y, way.x);
            }
        }
    }

    fn turn<S: ?Sized>(
        &mut self,
        around: &Surroundings<'_, S>,
        setpoint: &mut TrajectorySetpoint,
        seconds: f32,
    ) {
        let target = match self.look_at {
            Some(place) => towards(place, setpoint.position).unwrap_or(self.heading.heading),
            None => self.heading_target,
        };
        let p = around.parameters;
        self.heading.step(target, p.yaw_rate, p.yaw_acceleration, seconds);
        setpoint.heading = self.heading.heading;
        setpoint.heading_rate = self.heading.rate;
    }
}

fn speed_after(speed: Option<f32>, action: &Action) -> Option<f32> {
    match action {
        Action::Speed(wanted) => *wanted,
        _ => speed,
    }
}

/// How the leg from `from` to `nav` is joined to the one after it.
fn joint(from: Vector3, nav: &Nav, following: Option<&Nav>) -> Joint {
    let Some(next) = following else {
        return Joint::Stop;
    };
    let (_, length) = direction_and_length(from, nav.target);
    let (direction, next_length) = direction_and_length(nav.target, next.target);
    let passes = nav.hold <= 0.0
        && nav.kind == NavKind::Waypoint
        && next.kind == NavKind::Waypoint
        && !next.rest_before
        && length > SHORTEST_PASS
        && next_length > SHORTEST_PASS;
    if !passes {
        return Joint::Stop;
    }
    Joint::Pass {
        direction,
        // The rest of the radius is left to how well the path is followed.
        radius: 0.7 * nav.radius,
    }
}
