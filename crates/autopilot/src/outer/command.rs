//! What the operator wants, and what speaks against it.

use windhover_estimator::Sensor;
use windhover_math::geodesy::LocalFrame;
use windhover_math::{Vector3, sqrt};

use super::Outer;
use super::report::{Refusals, Refused, Why};
use crate::blocker::{Blocker, Blockers};
use crate::fence::FenceAction;
use crate::inner::Snapshot;
use crate::mission::action::{Altitude, Place, Reason, Refusal, over_ground};
use crate::mission::{MissionEvent, MissionEvents, MissionSource, PlanKind};
use crate::mode::{Mode, Need, Target};
use crate::queue::{Command, MotorTest};
use crate::rc::Events;
use crate::supervisor::{Denied, Facts, Order, Phase, Row};

/// The item of a photo that no mission asked for.
pub const NO_ITEM: u16 = u16::MAX;

impl Outer {
    /// Takes all commands of a snapshot, and what the remote control's switches say.
    pub(super) fn commands<S: MissionSource + ?Sized>(
        &mut self,
        snapshot: &Snapshot,
        source: &S,
        facts: &Facts,
        events: &mut MissionEvents,
        refusals: &mut Refusals,
    ) {
        if !self.is_commanded(snapshot) {
            return;
        }
        let switches = self.switches;
        let arm = match switches.arm {
            Some(true) => Some(Command::Arm),
            Some(false) => Some(Command::Disarm),
            None => None,
        };
        let by_switch = [switches.mode.map(Command::Fly), arm];
        let commands = by_switch.into_iter().flatten();
        for command in commands.chain(snapshot.inputs.command.iter().copied()) {
            if let Err(why) = self.command(&command, source, facts, events) {
                let _ = refusals.push(Refused::Command(command, why));
            }
        }
    }

    /// Whether there is a command, or a switch was thrown.
    pub(super) fn is_commanded(&self, snapshot: &Snapshot) -> bool {
        let Events { arm, mode, .. } = self.switches;
        arm.is_some() || mode.is_some() || !snapshot.inputs.command.is_empty()
    }

    fn command<S: MissionSource + ?Sized>(
        &mut self,
        command: &Command,
        source: &S,
        facts: &Facts,
        events: &mut MissionEvents,
    ) -> Result<(), Why> {
        match command {
            Command::Arm => self.arm(source, facts, false),
            Command::ForceArm => self.arm(source, facts, true),
            Command::Disarm => self.order(Order::Disarm, facts),
            Command::Fly(Mode::Mission) => self.start_mission(None, source, facts),
            Command::Fly(mode) => self.order(Order::Fly(*mode), facts),
            Command::Takeoff(altitude, heading) => {
                finite(altitude_of(*altitude))?;
                finite(*heading)?;
                self.order(Order::Fly(Mode::Takeoff), facts)?;
                self.modes.takeoff = (*altitude, *heading);
                Ok(())
            }
            Command::GoTo(target) => self.go_to(target, facts),
            Command::StartMission(first) => self.start_mission(Some(*first), source, facts),
            Command::SelectItem(index) => self.select_item(*index, source, facts),
            Command::SetSpeed(speed) => self.set_speed(*speed),
            Command::SetHome(place) => self.set_home(place.as_ref()),
            Command::LookAt(place) => self.look_at(place.as_ref()),
            Command::TakePhoto => {
                let _ = events.push(MissionEvent::Photo {
                    item: NO_ITEM,
                    target: None,
                    settled: true,
                });
                Ok(())
            }
            Command::Commit(kind, commit) => self.commit(*kind, commit, source),
            Command::TestMotor(test) => self.test_motor(test, facts),
        }
    }

    /// Hands an order to the supervisor.
    fn order(&mut self, order: Order, facts: &Facts) -> Result<(), Why> {
        let before = self.supervisor.mode();
        let phase = self.supervisor.phase();
        self.supervisor
            .order(order, facts, &self.actions)
            .map_err(|denied| self.why(denied))?;
        if let Order::Fly(mode) = order {
            self.ordered = true;
            (self.modes.target, self.modes.takeoff) = (None, (None, None));
            if mode == before && mode == Mode::Hold {
                // Asked for again, on the way to somewhere: it stops.
                self.modes.reenter();
            }
            if phase == Phase::Landed {
                self.stand();
            }
        }
        Ok(())
    }

    fn why(&self, denied: Denied) -> Why {
        match denied {
            Denied::Stopped => Why::Blocked(Blockers::of(Blocker::Stopped)),
            Denied::Blocked => Why::Blocked(self.blockers),
            Denied::InFlight => Why::InFlight,
            Denied::OnGround => Why::OnGround,
            Denied::Unavailable(mode) => Why::Blocked(self.missing(mode)),
            Denied::Failsafe(row) => Why::Failsafe(row),
        }
    }

    /// Arms: home is here from now on.
    fn arm<S: MissionSource + ?Sized>(&mut self, source: &S, facts: &Facts, force: bool) -> Result<(), Why> {
        let was = self.supervisor.phase();
        if was == Phase::Disarmed {
            self.blockers = self.find_blockers(facts.stopped);
        }
        let estimate = self.estimation.estimate();
        let home = if estimate.known.position && !self.home_is_set {
            estimate.position
        } else {
            self.home
        };
        if was == Phase::Disarmed
            && !force
            && self.supervisor.mode() == Mode::Mission
            && self.blockers.is_empty()
            && let Some(frame) = self.estimation.frame()
        {
            // It may have been stored, or the fence, after it was chosen; and home is here only now.
            self.plans.check_mission(source, frame, home, &self.parameters)?;
        }
        let blocked = !self.blockers.is_empty();
        let order = if force {
            Order::ForceArm
        } else {
            Order::Arm { blocked }
        };
        let facts = Facts {
            active: if was == Phase::Disarmed {
                self.watch.settle()
            } else {
                facts.active
            },
            ..*facts
        };
        self.order(order, &facts)?;
        if was == Phase::Disarmed {
            self.stand();
            self.home = home;
        }
        Ok(())
    }

    /// The vehicle stands where it is, and a flight begins.
    fn stand(&mut self) {
        self.landing.stand(self.estimation.estimate().position.z);
        self.estimation.forget_steps();
        self.on_ground = 0.0;
        self.modes.reenter();
    }

    fn go_to(&mut self, target: &Target, facts: &Facts) -> Result<(), Why> {
        let Target {
            altitude,
            heading,
            speed,
            ..
        } = target;
        finite(altitude_of(*altitude))?;
        finite(*heading)?;
        finite(*speed)?;
        if self.supervisor.phase() != Phase::Flying {
            return Err(Why::OnGround);
        }
        self.check_target(target)?;
        self.order(Order::Fly(Mode::Hold), facts)?;
        if heading.is_some() {
            self.modes.look_at = None;
        }
        // Entered anew, wherever hold was going.
        self.modes.reenter();
        self.modes.target = Some(Target {
            speed: target.speed.filter(|speed| *speed > 0.0).or(self.modes.speed),
            ..*target
        });
        Ok(())
    }

    /// Whether a place may be gone to: within reach, and inside the fence.
    fn check_target(&self, target: &Target) -> Result<(), Why> {
        let p = &self.parameters;
        let here = self.estimation.estimate().position;
        let ground = match (target.ground, self.estimation.frame()) {
            (None, _) => here,
            (Some(_), None) => return Err(Why::NotANumber),
            (Some((latitude, longitude)), Some(frame)) => over_ground(latitude, longitude, frame),
        };
        let (north, east) = (ground.x - self.home.x, ground.y - self.home.y);
        let (value, max) = (sqrt(north * north + east * east), p.mission.distance_max);
        // A place too far for numbers is too far.
        if !(..=max).contains(&value) {
            let reason = Reason::Distance { value, max };
            return Err(Why::Place(Refusal {
                field: "position",
                reason,
            }));
        }
        let origin = self.estimation.frame().map_or(0, |frame| frame.origin().altitude);
        let height = target
            .altitude
            .map_or(self.home.z - here.z, |altitude| match altitude {
                Altitude::Home(height) => height,
                Altitude::SeaLevel(_) => altitude.above_home(origin) + self.home.z,
            });
        let max = p.mission.altitude_max;
        if !(-max..=max).contains(&height) {
            let reason = Reason::Range {
                value: height,
                min: -max,
                max,
            };
            return Err(Why::Place(Refusal {
                field: "altitude",
                reason,
            }));
        }
        let to = Vector3::new(ground.x, ground.y, self.home.z - height);
        let counts = p.fence.action() != FenceAction::Nothing && !self.breach;
        if counts && self.plans.fence.leaves(&p.fence, self.home, here, to) {
            return Err(Why::Blocked(Blockers::of(Blocker::OutsideFence)));
        }
        Ok(())
    }

    /// Starts the mission at an item, or goes on with it.
    fn start_mission<S: MissionSource + ?Sized>(
        &mut self,
        first: Option<u16>,
        source: &S,
        facts: &Facts,
    ) -> Result<(), Why> {
        let begun = self.modes.mission().is_some();
        if first.is_some() || !begun {
            let first = first.unwrap_or(self.modes.first_item);
            if self.plans.mission.is_some_and(|stored| first >= stored.count) {
                return Err(Why::Blocked(Blockers::of(Blocker::NoMission)));
            }
            if let Some(frame) = self.estimation.frame() {
                self.plans
                    .check_mission(source, frame, self.home, &self.parameters)?;
            }
            self.order(Order::Fly(Mode::Mission), facts)?;
            self.modes.first_item = first;
            self.modes.forget_mission();
            self.modes.reenter();
            return Ok(());
        }
        self.order(Order::Fly(Mode::Mission), facts)
    }

    /// The item that the mission goes on with.
    fn select_item<S: MissionSource + ?Sized>(
        &mut self,
        index: u16,
        source: &S,
        facts: &Facts,
    ) -> Result<(), Why> {
        if self.plans.mission.is_none_or(|stored| index >= stored.count) {
            return Err(Why::Blocked(Blockers::of(Blocker::NoMission)));
        }
        if self.supervisor.mode() == Mode::Mission && self.supervisor.phase() == Phase::Flying {
            return self.start_mission(Some(index), source, facts);
        }
        self.modes.first_item = index;
        self.modes.forget_mission();
        Ok(())
    }

    fn test_motor(&mut self, test: &MotorTest, facts: &Facts) -> Result<(), Why> {
        if self.supervisor.phase() != Phase::Disarmed {
            return Err(Why::Armed);
        }
        if facts.stopped {
            return Err(Why::Blocked(Blockers::of(Blocker::Stopped)));
        }
        if !test.is_valid() {
            return Err(Why::NotANumber);
        }
        self.motor_test = Some(*test);
        Ok(())
    }

    /// Another ground speed from the next leg on: of the mission, and of where hold is sent.
    fn set_speed(&mut self, speed: Option<f32>) -> Result<(), Why> {
        finite(speed)?;
        let speed = speed.filter(|speed| *speed > 0.0);
        let flies = self.supervisor.phase() == Phase::Flying;
        let mission = self.modes.mission_mut();
        if !flies && mission.is_none() {
            return Err(Why::OnGround);
        }
        if let Some(mission) = mission {
            mission.set_speed(speed);
        }
        if flies {
            self.modes.speed = speed;
        }
        Ok(())
    }

    fn set_home(&mut self, place: Option<&Place>) -> Result<(), Why> {
        let Some(frame) = self.estimation.frame() else {
            return Err(Why::NotANumber);
        };
        self.home = match place {
            Some(place) => local(place, frame, self.home)?,
            None if self.estimation.estimate().known.position => self.estimation.estimate().position,
            None => return Err(Why::NotANumber),
        };
        self.home_is_set = true;
        Ok(())
    }

    fn look_at(&mut self, place: Option<&Place>) -> Result<(), Why> {
        let Some(frame) = self.estimation.frame() else {
            return Err(Why::NotANumber);
        };
        let place = place.map(|place| local(place, frame, self.home)).transpose()?;
        self.modes.look_at = place;
        if let Some(mission) = self.modes.mission_mut() {
            mission.look_at(place);
        }
        Ok(())
    }

    fn commit<S: MissionSource + ?Sized>(
        &mut self,
        kind: PlanKind,
        commit: &crate::queue::MissionCommit,
        source: &S,
    ) -> Result<(), Why> {
        if kind == PlanKind::Mission && self.supervisor.phase() != Phase::Disarmed {
            let mode = self.supervisor.mode();
            if mode == Mode::Mission || self.supervisor.interrupted() == Some(Mode::Mission) {
                return Err(Why::InFlight);
            }
            // What was interrupted is not there any more.
            self.modes.forget_mission();
        }
        let frame = self.estimation.frame();
        self.plans.commit(kind, commit, source, frame, &self.parameters)?;
        if kind == PlanKind::Mission {
            self.modes.first_item = 0;
        }
        Ok(())
    }

    /// What speaks against arming, all of it.
    pub(super) fn find_blockers(&self, stopped: bool) -> Blockers {
        let p = &self.parameters;
        let estimate = self.estimation.estimate();
        let mode = self.supervisor.mode();
        let needs = mode.needs(self.setpoint_needs_position());
        let needs_position = needs.contains(Need::Position);
        let on_sensors = self.estimation.is_on_sensors();
        let misses = |sensor| self.estimation.misses(sensor);
        let uncalibrated = |id: f32| on_sensors && id < 0.5;
        let cos_tilt = estimate.attitude.cos_tilt();
        let active = self.watch.active();
        let tilted = estimate.known.attitude && cos_tilt < windhover_math::cos(p.safety.arming_tilt);
        let battery_low = self.battery.is_too_low_to_arm(&p.battery)
            || self.battery.charge() >= crate::battery::Charge::Critical;
        Blockers::default()
            .with(Blocker::Stopped, stopped)
            .with(Blocker::AttitudeUnknown, !estimate.known.attitude)
            .with(Blocker::Tilted, tilted || active.contains(Row::TumbleLow))
            .with(Blocker::ImuUnreliable, active.contains(Row::ImuUnreliable))
            .with(Blocker::GyroUncalibrated, uncalibrated(p.calibration.gyro_id))
            .with(
                Blocker::AccelerometerUncalibrated,
                uncalibrated(p.calibration.accel_id),
            )
            .with(
                Blocker::CompassUncalibrated,
                needs_position && uncalibrated(p.calibration.compass_id),
            )
            .with(
                Blocker::CompassFault,
                needs_position && (self.estimation.is_compass_lost() || misses(Sensor::Compass)),
            )
            .with(
                Blocker::BarometerFault,
                needs.contains(Need::Height)
                    && (self.estimation.is_barometer_lost() || misses(Sensor::Barometer)),
            )
            .with(Blocker::BatteryLow, battery_low)
            .with(Blocker::RcMissing, p.rc.needs_remote() && !self.remote.was_seen())
            .with(Blocker::RcLost, self.remote.is_lost())
            .with(
                Blocker::SticksUnsafe,
                self.switches.refused || self.is_throttle_up(),
            )
            .with(Blocker::OutsideFence, self.breach)
            .with(Blocker::FenceInvalid, self.plans.invalid)
            .with(Blocker::StorageDamaged, self.storage_damaged)
            .or(self.missing(mode))
    }

    /// A pilot's throttle that would lift the vehicle as soon as it is armed.
    fn is_throttle_up(&self) -> bool {
        let up = self.remote.sticks().is_some_and(|sticks| sticks.throttle > -0.8);
        up && self.supervisor.mode().is_manual()
    }

    /// What a mode needs and has not.
    fn missing(&self, mode: Mode) -> Blockers {
        let needs = mode.needs(self.setpoint_needs_position());
        let lacks = needs.without(self.there_is());
        let known = &self.estimation.estimate().known;
        let turned = known.attitude && !known.heading;
        Blockers::default()
            .with(Blocker::AttitudeUnknown, lacks.contains(Need::Attitude))
            .with(Blocker::HeightUnknown, lacks.contains(Need::Height))
            .with(Blocker::HeadingUnknown, needs.contains(Need::Position) && turned)
            .with(Blocker::PositionUnknown, lacks.contains(Need::Position))
            .with(Blocker::NoMission, lacks.contains(Need::Mission))
            .with(Blocker::NoSetpoint, lacks.contains(Need::Setpoint))
            .with(Blocker::NoSticks, lacks.contains(Need::Sticks))
    }
}

fn altitude_of(altitude: Option<Altitude>) -> Option<f32> {
    altitude.map(|altitude| match altitude {
        Altitude::SeaLevel(metres) | Altitude::Home(metres) => metres,
    })
}

/// What is given is a number.
fn finite(value: Option<f32>) -> Result<(), Why> {
    match value {
        Some(value) if !value.is_finite() => Err(Why::NotANumber),
        _ => Ok(()),
    }
}

/// A place in the local frame, NED, m.
fn local(place: &Place, frame: &LocalFrame, home: Vector3) -> Result<Vector3, Why> {
    finite(altitude_of(Some(place.altitude)))?;
    Ok(place.local(frame, home))
}
