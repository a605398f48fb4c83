//! The vehicle's end of the ground link: what ground stations ask for becomes inputs of the core,
//! what the core reports becomes telemetry, answers and lines of text.
//!
//! Firmware and desktop run the same code. Whoever runs the outer step tells [`Told`] each result;
//! whoever serves the links, at a lower priority, does this every few milliseconds:
//!
//! 1. [`VehicleLink::receive`] with the bytes of each [`Link`];
//! 2. [`VehicleLink::step`] with what was told since the last time;
//! 3. [`VehicleLink::take_inputs`] into the core's queues, [`VehicleLink::take_urgent`] into its latch;
//! 4. [`VehicleLink::poll`] for the bytes that each link sends.
//!
//! A command is answered when the core has taken it in and said yes or no to it: what is
//! acknowledged has happened. Nothing here decides whether the vehicle may do something; that is the
//! core's, and its reasons are passed on in its words.
#![cfg_attr(not(test), no_std)]

mod act;
mod answers;
mod calibrate;
mod calibration;
mod changes;
mod command;
mod plans;
mod refusal;
mod setpoint;
mod shutter;
mod state;
mod told;
mod trouble;

use heapless::Deque;
use windhover_autopilot::{
    Command, MissionCommit, OuterInputs, OuterReport, ParameterWrite, Parameters, Urgent,
};
use windhover_ground_link::parameters::{Appended, QGROUNDCONTROL};
use windhover_ground_link::{
    CommandId, CommandResult, Context, Link, PlanKind, Severity, Signing, Telemetry,
};

pub use calibrate::Fitting;
pub use plans::PlanMedium;
pub use told::{Happened, Outcome, Told};

use calibrate::Calibrating;
use changes::Shown;
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
    /// Store everything as it is now, also over what was found damaged: a human has looked at it.
    pub store: bool,
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
    /// What ended the last run, if it was to be told.
    trouble: &'static str,
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
            trouble: "",
        }
    }

    /// The vehicle started because of a `trouble` that ended its last run: each ground station that comes
    /// is told, as long as the vehicle is disarmed.
    pub fn set_trouble(&mut self, trouble: &'static str) {
        self.trouble = trouble;
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
        self.tell_trouble(links);
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

    /// Nobody is at the other end of a link any more, which is one of several: nobody waits for its
    /// answers, and what it was uploading has come to nothing.
    pub fn close(&mut self, link: &mut Link, index: usize, medium: &mut dyn PlanMedium) {
        self.with_context(medium, |context| link.close(context));
        self.forget(index);
    }

    fn forget(&mut self, link: usize) {
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
