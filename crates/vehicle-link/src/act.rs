//! What ground stations ask for: to the core, or done here.

use windhover_autopilot::blocker::Sentence;
use windhover_autopilot::{Command, ParameterWrite, Parameters, Phase, Station, Urgent};
use windhover_ground_link::{CommandId, CommandResult, Link, Order, PlanKind, Request, Severity};

use crate::command::Meaning;
use crate::shutter::Shutter;
use crate::{Asked, Say, VehicleLink, Written, command, finish, setpoint, tell};

impl VehicleLink {
    /// Whether the core takes another command now.
    pub(crate) fn has_room(&self) -> bool {
        !self.asked.is_full() && !self.inputs.command.is_full()
    }

    fn ask(&mut self, command: Command, answer: Option<(usize, CommandId)>, since: u64) -> bool {
        if !self.has_room() {
            return false;
        }
        let _ = self.asked.push_back(Asked {
            command,
            answer,
            since,
        });
        let _ = self.inputs.command.push(command);
        true
    }

    pub(crate) fn write(&mut self, write: ParameterWrite, link: Option<usize>, since: u64) -> bool {
        if self.written.is_full() || self.inputs.parameter.is_full() {
            return false;
        }
        let _ = self.written.push_back(Written { write, link, since });
        let _ = self.inputs.parameter.push(write);
        true
    }

    /// Plans that were uploaded go to the core.
    pub(crate) fn commit_plans(&mut self, now: u64) {
        for kind in PlanKind::EACH {
            if self.has_room()
                && let Some(commit) = self.plans.next_commit(kind)
            {
                self.ask(Command::Commit(kind, commit), None, now);
            }
        }
    }

    /// Parameters that are to have other values go to the core, as many as it takes.
    pub(crate) fn write_parameters(&mut self, now: u64) {
        while let Some((index, wanted)) = self.wanted {
            let Some(value) = wanted.get(usize::from(index)) else {
                self.wanted = None;
                return;
            };
            let is_so = self.parameters.get(usize::from(index)) == Some(value);
            if !is_so && !self.write(ParameterWrite { index, value }, None, now) {
                return;
            }
            self.wanted = Some((index + 1, wanted));
        }
    }

    /// Photos follow the vehicle's own clock, which in a simulation may run faster than the links'.
    fn clock(&self, now: u64) -> u64 {
        self.telemetry.time.unwrap_or(now)
    }

    pub(crate) fn take_photos(&mut self, now: u64) {
        let position = self.report.estimate.position;
        if self.has_room() && self.shutter.is_due(self.clock(now), position) {
            self.ask(Command::TakePhoto, None, now);
        }
    }

    /// Takes what one link asks for, as long as the core has room.
    #[inline(never)]
    pub(crate) fn serve(&mut self, links: &mut [Link], index: usize, now: u64, say: &mut Say<'_>) {
        self.hear(links.get(index));
        while self.has_room()
            && !self.written.is_full()
            && !self.inputs.parameter.is_full()
            && let Some(order) = links.get_mut(index).and_then(Link::next_request)
        {
            self.act(links, index, &order, now, say);
        }
    }

    /// Passes on that a ground station is heard.
    fn hear(&mut self, link: Option<&Link>) {
        let heard = link.and_then(Link::station_heard);
        if let Some(heard) = heard
            && self.station.is_none_or(|before| heard > before)
            && self.inputs.station.push(Station { system: 255 }).is_ok()
        {
            self.station = Some(heard);
        }
    }

    #[inline(never)]
    fn act(&mut self, links: &mut [Link], link: usize, order: &Order, now: u64, say: &mut Say<'_>) {
        let answer = order.id.map(|id| (link, id));
        match command::meaning(&order.request, &self.report) {
            Meaning::Command(command) => {
                self.ask(command, answer, now);
            }
            Meaning::Answer(result, text) => {
                if let Some(text) = text {
                    tell(links, say, Severity::Warning, format_args!("{text}"));
                }
                finish(links, answer, result, now);
            }
            Meaning::Calibrate(kind) => self.start_calibration(links, kind, answer, now, say),
            Meaning::Own => {
                let result = self.act_here(links, link, &order.request, now, say);
                finish(links, answer, result, now);
            }
        }
    }

    /// What needs no command of the core.
    #[inline(never)]
    fn act_here(
        &mut self,
        links: &mut [Link],
        link: usize,
        request: &Request,
        now: u64,
        say: &mut Say<'_>,
    ) -> CommandResult {
        let disarmed = self.report.phase == Phase::Disarmed;
        match *request {
            // Beyond the table lie constants, which the link answers itself.
            Request::WriteParameter { index, value } if usize::from(index) < Parameters::COUNT => {
                self.write(ParameterWrite { index, value }, Some(link), now);
            }
            Request::Kill => {
                self.urgent = Some(Urgent::Kill);
                tell(links, say, Severity::Critical, format_args!("Motors killed"));
            }
            Request::TakePhotos { interval, count } => self.shutter.start(interval, count, self.clock(now)),
            Request::PhotosByDistance { distance, at_once } => {
                let here = self.report.estimate.position;
                self.shutter.by_distance(distance, (!at_once).then_some(here));
            }
            Request::StopPhotos => self.shutter = Shutter::default(),
            Request::Reboot if disarmed => self.effects.reboot = true,
            Request::ResetParameters if disarmed => self.wanted = Some((0, Parameters::default())),
            Request::Reboot | Request::ResetParameters => {
                tell(links, say, Severity::Warning, format_args!("Only while disarmed"));
                return CommandResult::TemporarilyRejected;
            }
            Request::CheckArming => self.check_arming(links, say),
            // In flight nobody is locked out by a key that he does not know.
            Request::SetSigningKey { secret, time } if disarmed => self.signing.set_key(secret, time, now),
            Request::Offboard(ref setpoint) => {
                setpoint::guide(setpoint, &self.report, &self.parameters, &mut self.inputs);
            }
            Request::Sticks(ref sticks) => setpoint::steer(sticks, &mut self.inputs),
            Request::Channels(ref channels) => {
                if let Some(frame) = self.overrides.take(channels) {
                    let _ = self.inputs.rc.push(frame);
                }
            }
            Request::StoreParameters => self.effects.store = true,
            _ => {}
        }
        CommandResult::Accepted
    }

    /// All that speaks against arming, a line each.
    #[inline(never)]
    fn check_arming(&self, links: &mut [Link], say: &mut Say<'_>) {
        if self.report.blockers.is_empty() {
            return tell(links, say, Severity::Info, format_args!("Ready to arm"));
        }
        for blocker in self.report.blockers.iter() {
            let report = &self.report;
            let sentence = Sentence { blocker, report };
            tell(
                links,
                say,
                Severity::Critical,
                format_args!("Not ready to arm: {sentence}"),
            );
        }
    }
}
