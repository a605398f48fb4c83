//! Calibrations: begun, followed and ended as ground stations ask for.

use windhover_autopilot::Phase;
use windhover_ground_link::{Calibration, CommandId, CommandResult, Link, Severity};

use crate::calibrate::{Calibrating, Standing};
use crate::{Say, Told, VehicleLink, finish, tell};

impl VehicleLink {
    /// A calibration that is under way goes on.
    #[inline(never)]
    pub(crate) fn calibrate(&mut self, links: &mut [Link], told: &Told, now: u64, say: &mut Say<'_>) {
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
    pub(crate) fn start_calibration(
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
}
