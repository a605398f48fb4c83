//! The vehicle's end of the ground link: what ground stations ask for becomes inputs of the core,
//! what the core reports becomes telemetry, answers and lines of text.
//!
//! Firmware and desktop run the same code. Whoever runs the outer step tells [`Told`] each result;
//! whoever serves the links, at a lower priority, does this every few milliseconds:
//!
//! 1. [`VehicleLink::receive`] with the bytes of each [`Link`](windhover_ground_link::Link);
//! 2. [`VehicleLink::step`] with what was told since the last time;
//! 3. [`VehicleLink::take_inputs`] into the core's queues, [`VehicleLink::take_urgent`] into its latch;
//! 4. [`VehicleLink::poll`] for the bytes that each link sends.
//!
//! A command is answered when the core has taken it in and said yes or no to it: what is
//! acknowledged has happened. Nothing here decides whether the vehicle may do something; that is the
//! core's, and its reasons are passed on in its words.
#![cfg_attr(not(test), no_std)]

mod calibrate;
mod changes;
mod command;
mod plans;
mod refusal;
mod setpoint;
mod shutter;
mod state;
mod told;

use heapless::Deque;
use windhover_autopilot::blocker::Sentence;
use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::{
    Command, MissionCommit, OuterInputs, OuterReport, ParameterWrite, Parameters, Phase, Station, Urgent, Why,
};
use windhover_ground_link::parameters::{Appended, QGROUNDCONTROL};
use windhover_ground_link::{
    Calibration, CommandId, CommandResult, Context, Identity, Link, Order, Photo, PlanKind, Request,
    Severity, Signing, Telemetry,
};
use windhover_math::geodesy::LocalFrame;

pub use calibrate::Fitting;
pub use plans::PlanMedium;
pub use told::{Happened, Outcome, Told};

use calibrate::{Calibrating, Standing};
use changes::Shown;
use command::Meaning;
use plans::{PlanState, Plans};
use setpoint::Overrides;
use shutter::Shutter;

/// Commands that the core has and has not answered yet, at most: as many as a snapshot takes.
const ASKED: usize = 4;

/// A command that the core does not answer within this time has failed, µs.
const ANSWER_TIMEOUT: u64 = 500_000;

/// A command that the core has.
#[derive(Clone, Copy, Debug)]
struct Asked {
    command: Command,
    /// Whose answer it is: the link, and the number that the link gave; `None` where nobody waits.
    answer: Option<(usize, CommandId)>,
    since: u64,
}

/// A write to the parameter table that the core has.
#[derive(Clone, Copy, Debug)]
struct Written {
    write: ParameterWrite,
    /// The link that asked.
    link: Option<usize>,
    since: u64,
}

/// What the caller is to do besides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effects {
    /// Start anew: asked for while disarmed.
    pub reboot: bool,
}

/// A line for people: how grave it is, and what it says.
pub type Say<'a> = dyn FnMut(Severity, core::fmt::Arguments<'_>) + 'a;

/// Between the core and its links.
#[derive(Clone, Debug)]
pub struct VehicleLink {
    parameters: Parameters,
    telemetry: Telemetry,
    signing: Signing,
    plans: PlanState,
    /// The last report, without its events.
    report: OuterReport,
    asked: Deque<Asked, ASKED>,
    written: Deque<Written, ASKED>,
    inputs: OuterInputs,
    urgent: Option<Urgent>,
    effects: Effects,
    shutter: Shutter,
    photos: u32,
    overrides: Overrides,
    shown: Shown,
    fitting: Fitting,
    calibrating: Option<(Calibrating, Option<(usize, CommandId)>)>,
    /// What the parameters are to be, and the next one to look at.
    wanted: Option<(u16, Parameters)>,
    /// When a ground station was last passed on as heard, µs.
    station: Option<u64>,
    /// Share of the processor's time that is used, 0 to 1.
    load: f32,
}

impl VehicleLink {
    /// Of a vehicle with these parameters, whose sensors sit like this, and these plans in use.
    pub fn new(parameters: &Parameters, fitting: Fitting, plans: [MissionCommit; 3]) -> Self {
        Self {
            parameters: *parameters,
            telemetry: Telemetry::default(),
            signing: Signing::default(),
            plans: PlanState::new(plans),
            report: OuterReport::default(),
            asked: Deque::new(),
            written: Deque::new(),
            inputs: OuterInputs::default(),
            urgent: None,
            effects: Effects::default(),
            shutter: Shutter::default(),
            photos: 0,
            overrides: Overrides::default(),
            shown: Shown::default(),
            fitting,
            calibrating: None,
            wanted: None,
            station: None,
            load: 0.0,
        }
    }

    /// The parameters as the core has them, as far as it has answered.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The plans in use: mission, fence, rally points.
    pub fn committed(&self) -> [MissionCommit; 3] {
        PlanKind::EACH.map(|kind| self.plans.committed(kind))
    }

    /// What ground stations are told.
    pub fn telemetry(&self) -> &Telemetry {
        &self.telemetry
    }

    /// Tells how busy the processor is: share of its time that is used, 0 to 1.
    pub fn set_load(&mut self, load: f32) {
        self.load = load;
    }

    /// A link takes bytes that have come, at `now` µs.
    pub fn receive(&mut self, link: &mut Link, bytes: &[u8], now: u64, medium: &mut dyn PlanMedium) {
        self.with_context(medium, |context| link.receive(bytes, now, context));
    }

    /// A link takes a packet that has come whole, at `now` µs.
    pub fn receive_packet(&mut self, link: &mut Link, packet: &[u8], now: u64, medium: &mut dyn PlanMedium) {
        self.with_context(medium, |context| link.receive_packet(packet, now, context));
    }

    /// A link gives the frames that are to be sent at `now` µs.
    pub fn poll(
        &mut self,
        link: &mut Link,
        now: u64,
        medium: &mut dyn PlanMedium,
        out: &mut dyn FnMut(&[u8]),
    ) {
        self.with_context(medium, |context| link.poll(now, context, out));
    }

    fn with_context(&mut self, medium: &mut dyn PlanMedium, act: impl FnOnce(&mut Context<'_>)) {
        let Self {
            parameters,
            telemetry,
            signing,
            plans,
            report,
            ..
        } = self;
        let table = Appended {
            table: &*parameters,
            constants: QGROUNDCONTROL,
        };
        act(&mut Context {
            telemetry,
            parameters: &table,
            plans: &mut Plans {
                state: plans,
                medium,
                report,
                parameters,
            },
            signing,
        });
    }

    /// Goes on at `now` µs: takes in what the core has told, answers commands, passes on requests.
    /// Each line for people goes to all links, and to `say`.
    pub fn step(&mut self, links: &mut [Link], told: &Told, now: u64, say: &mut Say<'_>) {
        self.take_in(links, told, now, say);
        self.expire(links, now);
        self.commit_plans(now);
        self.calibrate(links, told, now, say);
        self.write_parameters(now);
        self.take_photos(now);
        for index in 0..links.len() {
            self.serve(links, index, now, say);
        }
    }

    /// What goes into the core's queues now.
    pub fn take_inputs(&mut self) -> OuterInputs {
        core::mem::take(&mut self.inputs)
    }

    /// What goes into the latch of urgent commands now.
    pub fn take_urgent(&mut self) -> Option<Urgent> {
        self.urgent.take()
    }

    /// What the caller is to do besides.
    pub fn take_effects(&mut self) -> Effects {
        core::mem::take(&mut self.effects)
    }

    /// A link is not there any more: nobody waits for its answers.
    pub fn forget(&mut self, link: usize) {
        for asked in &mut self.asked {
            asked.answer = asked.answer.filter(|(of, _)| *of != link);
        }
        if let Some((_, answer)) = &mut self.calibrating {
            *answer = answer.filter(|(of, _)| *of != link);
        }
        for written in &mut self.written {
            written.link = written.link.filter(|of| *of != link);
        }
    }

    /// What the core has told since the last time.
    #[inline(never)]
    fn take_in(&mut self, links: &mut [Link], told: &Told, now: u64, say: &mut Say<'_>) {
        for outcome in told.outcomes() {
            match outcome {
                Outcome::Command(command, refused) => self.answer(links, command, refused.as_ref(), now, say),
                Outcome::Parameter(write, refused) => self.write_done(links, *write, *refused, now),
            }
        }
        if let Some(report) = told.report() {
            self.report = report.clone();
            state::fill(&mut self.telemetry, told, &self.parameters, self.load);
            let mut say = |severity, text: core::fmt::Arguments<'_>| tell(links, say, severity, text);
            self.shown.changes(report, &self.parameters, &mut say);
        }
        for happened in told.happened() {
            self.tell_event(links, happened, say);
        }
        self.telemetry.mission = self.shown.progress(&self.report);
        let identity = if self.parameters.link.autopilot >= 6.0 {
            Identity::Px4
        } else {
            Identity::Generic
        };
        for link in links {
            link.set_identity(identity);
        }
    }

    #[inline(never)]
    fn tell_event(&mut self, links: &mut [Link], happened: &Happened, say: &mut Say<'_>) {
        match happened.event {
            MissionEvent::Reached(index) => {
                for link in links.iter_mut() {
                    link.item_reached(index);
                }
            }
            MissionEvent::Missed(index) => tell(
                links,
                say,
                Severity::Warning,
                format_args!("Mission item {} not reached, going on", index + 1),
            ),
            MissionEvent::Photo { settled, .. } => {
                let position = self.report.origin.map(LocalFrame::new);
                let photo = Photo {
                    index: self.photos,
                    time: happened.time,
                    position: position
                        .map(|frame| frame.to_global(happened.position))
                        .unwrap_or_default(),
                    attitude: happened.attitude,
                };
                self.photos = self.photos.wrapping_add(1);
                self.shutter.taken(happened.position);
                for link in links.iter_mut() {
                    link.photo_taken(photo);
                }
                if !settled {
                    let text = format_args!("Photo {} taken before it was steady", photo.index + 1);
                    tell(links, say, Severity::Warning, text);
                }
            }
            MissionEvent::Landed => tell(links, say, Severity::Info, format_args!("Landed")),
            MissionEvent::Finished => {
                self.shown.finish();
                tell(links, say, Severity::Info, format_args!("Mission finished"));
            }
        }
    }

    /// The core has answered a command.
    #[inline(never)]
    fn answer(
        &mut self,
        links: &mut [Link],
        command: &Command,
        refused: Option<&Why>,
        now: u64,
        say: &mut Say<'_>,
    ) {
        if let Command::Commit(kind, commit) = command {
            self.plans.answered(*kind, commit, refused.is_none());
        }
        let Some(at) = self.asked.iter().position(|asked| asked.command == *command) else {
            return;
        };
        let mut answer = None;
        // A queue from whose middle one is taken: the others keep their order.
        for index in 0..self.asked.len() {
            if let Some(asked) = self.asked.pop_front() {
                if index == at {
                    answer = asked.answer;
                } else {
                    let _ = self.asked.push_back(asked);
                }
            }
        }
        if let Some(why) = refused {
            self.explain(links, command, why, say);
        }
        let result = refused.map_or(CommandResult::Accepted, command::result);
        finish(links, answer, result, now);
    }

    /// Why the core does not do it, in its words: a line for each blocker.
    fn explain(&self, links: &mut [Link], command: &Command, why: &Why, say: &mut Say<'_>) {
        let name = command::name(command);
        match why {
            Why::Blocked(blockers) => {
                for blocker in blockers.iter() {
                    let report = &self.report;
                    let sentence = Sentence { blocker, report };
                    let text = format_args!("{name} refused: {sentence}");
                    tell(links, say, Severity::Critical, text);
                }
            }
            why => tell(
                links,
                say,
                Severity::Warning,
                format_args!("{name} refused: {why}"),
            ),
        }
    }

    /// The core has answered a write to the parameter table.
    fn write_done(
        &mut self,
        links: &mut [Link],
        write: ParameterWrite,
        refused: Option<windhover_parameters::Refusal>,
        now: u64,
    ) {
        let waits = self.written.front().is_some_and(|written| written.write == write);
        let asking = if waits {
            self.written.pop_front().and_then(|written| written.link)
        } else {
            None
        };
        if refused.is_none() {
            // As the core has done it: the same table, the same checks.
            let _ = self.parameters.set(usize::from(write.index), write.value);
        }
        for (index, link) in links.iter_mut().enumerate() {
            match refused {
                Some(refusal) if asking == Some(index) => {
                    link.parameter_refused(write.index, refusal, &self.parameters, now);
                }
                None if asking != Some(index) => link.parameter_changed(write.index),
                _ => {}
            }
        }
    }

    /// Gives up what the core has not answered.
    fn expire(&mut self, links: &mut [Link], now: u64) {
        let late = |since: u64| now.saturating_sub(since) > ANSWER_TIMEOUT;
        while let Some(asked) = self.asked.front().filter(|asked| late(asked.since)).copied() {
            self.asked.pop_front();
            if let Command::Commit(kind, commit) = asked.command {
                self.plans.answered(kind, &commit, false);
            }
            finish(links, asked.answer, CommandResult::Failed, now);
        }
        while self.written.front().is_some_and(|written| late(written.since)) {
            self.written.pop_front();
        }
    }

    /// Whether the core takes another command now.
    fn has_room(&self) -> bool {
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

    fn write(&mut self, write: ParameterWrite, link: Option<usize>, since: u64) -> bool {
        if self.written.is_full() || self.inputs.parameter.is_full() {
            return false;
        }
        let _ = self.written.push_back(Written { write, link, since });
        let _ = self.inputs.parameter.push(write);
        true
    }

    /// Plans that were uploaded go to the core.
    fn commit_plans(&mut self, now: u64) {
        for kind in PlanKind::EACH {
            if self.has_room()
                && let Some(commit) = self.plans.next_commit(kind)
            {
                self.ask(Command::Commit(kind, commit), None, now);
            }
        }
    }

    /// Parameters that are to have other values go to the core, as many as it takes.
    fn write_parameters(&mut self, now: u64) {
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

    /// A calibration that is under way goes on.
    #[inline(never)]
    fn calibrate(&mut self, links: &mut [Link], told: &Told, now: u64, say: &mut Say<'_>) {
        let Some((calibrating, answer)) = &mut self.calibrating else {
            return;
        };
        let answer = *answer;
        if self.report.phase != Phase::Disarmed {
            self.end_calibration(
                links,
                "[cal] calibration cancelled",
                CommandResult::Failed,
                now,
                say,
            );
            return;
        }
        let before = calibrating.percent();
        let mut say = |severity, text: core::fmt::Arguments<'_>| tell(links, say, severity, text);
        match calibrating.step(told, &self.parameters, &mut say) {
            Standing::Going(percent) => {
                if percent != before
                    && let Some((link, id)) = answer
                    && let Some(link) = links.get_mut(link)
                {
                    link.progress(id, percent, now);
                }
            }
            Standing::Done(parameters) => {
                self.wanted = Some((0, parameters));
                self.calibrating = None;
                finish(links, answer, CommandResult::Accepted, now);
            }
            Standing::Failed => {
                self.calibrating = None;
                finish(links, answer, CommandResult::Failed, now);
            }
        }
    }

    fn end_calibration(
        &mut self,
        links: &mut [Link],
        text: &str,
        result: CommandResult,
        now: u64,
        say: &mut Say<'_>,
    ) {
        if let Some((_, answer)) = self.calibrating.take() {
            tell(links, say, Severity::Warning, format_args!("{text}"));
            finish(links, answer, result, now);
        }
    }

    /// A calibration is asked for, or the end of one.
    #[inline(never)]
    fn start_calibration(
        &mut self,
        links: &mut [Link],
        kind: Calibration,
        answer: Option<(usize, CommandId)>,
        now: u64,
        say: &mut Say<'_>,
    ) {
        let result = match kind {
            Calibration::Cancel => {
                self.end_calibration(
                    links,
                    "[cal] calibration cancelled",
                    CommandResult::Cancelled,
                    now,
                    say,
                );
                CommandResult::Accepted
            }
            // The level of pressure is found whenever the vehicle stands: there is nothing to do.
            Calibration::Pressure => CommandResult::Accepted,
            Calibration::AccelerometerOffset => CommandResult::Unsupported,
            _ if self.report.phase != Phase::Disarmed || self.calibrating.is_some() => {
                let text = format_args!("Calibration refused: armed, or another one is under way");
                tell(links, say, Severity::Warning, text);
                CommandResult::TemporarilyRejected
            }
            kind => {
                let fitting = self.fitting;
                let mut say = |severity, text: core::fmt::Arguments<'_>| tell(links, say, severity, text);
                self.calibrating =
                    Calibrating::begin(kind, fitting, &mut say).map(|calibrating| (calibrating, answer));
                CommandResult::InProgress
            }
        };
        finish(links, answer, result, now);
    }

    fn take_photos(&mut self, now: u64) {
        let position = self.report.estimate.position;
        if self.has_room() && self.shutter.is_due(now, position) {
            self.ask(Command::TakePhoto, None, now);
        }
    }

    /// Takes what one link asks for, as long as the core has room.
    #[inline(never)]
    fn serve(&mut self, links: &mut [Link], index: usize, now: u64, say: &mut Say<'_>) {
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
            Request::WriteParameter { index, value } => {
                if usize::from(index) < Parameters::COUNT {
                    self.write(ParameterWrite { index, value }, Some(link), now);
                }
            }
            Request::Kill => {
                self.urgent = Some(Urgent::Kill);
                tell(links, say, Severity::Critical, format_args!("Motors killed"));
            }
            Request::TakePhotos { interval, count } => self.shutter.start(interval, count, now),
            Request::PhotosByDistance { distance } => {
                self.shutter.by_distance(distance, self.report.estimate.position);
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
            // StoreParameters: what is set is stored as it is.
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

/// A line for everybody.
fn tell(links: &mut [Link], say: &mut Say<'_>, severity: Severity, text: core::fmt::Arguments<'_>) {
    for link in links {
        link.say(severity, text);
    }
    say(severity, text);
}

fn finish(links: &mut [Link], answer: Option<(usize, CommandId)>, result: CommandResult, now: u64) {
    if let Some((link, id)) = answer
        && let Some(link) = links.get_mut(link)
    {
        link.finish(id, result, now);
    }
}
