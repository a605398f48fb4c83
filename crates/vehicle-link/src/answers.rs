//! What the core has told: answers to commands and writes, events, changes.

use windhover_autopilot::blocker::Sentence;
use windhover_autopilot::mission::MissionEvent;
use windhover_autopilot::{Command, ParameterWrite, Why};
use windhover_ground_link::{CommandResult, Identity, Link, Photo, Severity};
use windhover_math::geodesy::LocalFrame;

use crate::told::{Happened, Outcome, Told};
use crate::{ANSWER_TIMEOUT, Say, VehicleLink, command, finish, state, tell};

impl VehicleLink {
    /// What the core has told since the last time.
    #[inline(never)]
    pub(crate) fn take_in(&mut self, links: &mut [Link], told: &Told, now: u64, say: &mut Say<'_>) {
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
    pub(crate) fn explain(&self, links: &mut [Link], command: &Command, why: &Why, say: &mut Say<'_>) {
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
    pub(crate) fn expire(&mut self, links: &mut [Link], now: u64) {
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
}
