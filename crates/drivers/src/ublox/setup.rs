//! The receiver is found and configured, by a machine of states without a port.

use super::frames::{BY_MESSAGE, BY_VALUE, Command, PORT_BY_MESSAGE, PORT_BY_VALUE, PROBE, PRT, VALSET};
use super::parser::Message;
pub use crate::health::Health;

/// Baud rates at which a receiver is looked for, in this order.
pub const BAUDS: [u32; 5] = [TARGET_BAUD, 38_400, 9_600, 57_600, 230_400];

/// The baud rate that it is set to: ten reports a second are a tenth of it.
pub const TARGET_BAUD: u32 = 115_200;

/// How long reports may be missing before the receiver is looked for anew, in µs.
pub const SILENCE_US: u64 = 3_000_000;

/// From a change of the port's rate to the first byte, in µs.
const SETTLE_US: u64 = 20_000;

/// The longest that an answer takes, in µs: behind the sentences of a whole second at 9,600 baud.
const ANSWER_US: u64 = 400_000;

/// From the command that changes the receiver's rate until it has changed, in µs: sending it takes
/// 30 ms at 9,600 baud.
const RETUNE_US: u64 = 200_000;

/// How often something is sent before its answer is given up.
const TRIES: u8 = 2;

/// What the owner of the port is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Action {
    /// Set the port to this rate, 8N1.
    SetBaud(u32),
    /// Send these bytes: at most 44.
    Send(&'static [u8]),
}

/// How the receiver is configured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dialect {
    /// M9 and later.
    Values,
    /// M8 and before.
    Messages,
}

impl Dialect {
    const fn port(self) -> &'static [u8] {
        match self {
            Self::Values => PORT_BY_VALUE,
            Self::Messages => PORT_BY_MESSAGE,
        }
    }

    const fn commands(self) -> &'static [Command] {
        match self {
            Self::Values => &BY_VALUE,
            Self::Messages => &BY_MESSAGE,
        }
    }
}

/// What comes next.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// The port is set to the rate on trial.
    Tune,
    /// Somebody is asked for, after so many tries.
    Probe { tries: u8 },
    /// The receiver's rate is set.
    Port,
    /// The port follows.
    Retune,
    /// The receiver is asked for at its new rate.
    Confirm { tries: u8 },
    /// A command is sent.
    Configure { index: usize, tries: u8 },
    /// Reports come, the last one at this time in µs.
    Report { heard: u64 },
}

/// Finds and configures a receiver, again and again if it has to.
///
/// It tries [`BAUDS`] until somebody answers, sets the receiver to [`TARGET_BAUD`] and follows,
/// then sends what makes it report. A receiver that does not know values is told by the messages
/// of M8. Nothing is stored in the receiver: one that lost its power is found and configured anew.
#[derive(Clone, Debug)]
pub struct Setup {
    step: Step,
    /// Nothing is done before this time in µs.
    due: u64,
    /// Which of the rates is on trial.
    trial: usize,
    /// Somebody is there.
    answered: bool,
    dialect: Dialect,
    health: Health,
}

impl Default for Setup {
    fn default() -> Self {
        Self::new()
    }
}

impl Setup {
    /// A receiver of which nothing is known.
    pub const fn new() -> Self {
        Self {
            step: Step::Tune,
            due: 0,
            trial: 0,
            answered: false,
            dialect: Dialect::Values,
            health: Health::Configuring,
        }
    }

    /// How the receiver is: absent if nothing answers at any rate, or reports ceased; stuck if it
    /// answers but does not report.
    pub fn health(&self) -> Health {
        self.health
    }

    /// What is to be done at `now`, in µs since start. To be called every few ms, after what came
    /// was handed to [`Self::heard`].
    pub fn poll(&mut self, now: u64) -> Option<Action> {
        if now < self.due {
            return None;
        }
        match self.step {
            Step::Tune => {
                self.answered = false;
                self.go(Step::Probe { tries: 0 }, now + SETTLE_US);
                let baud = BAUDS.get(self.trial).copied().unwrap_or(TARGET_BAUD);
                Some(Action::SetBaud(baud))
            }
            Step::Probe { .. } if self.answered => {
                // It told its port, but did not take values.
                self.found(Dialect::Messages, now);
                None
            }
            Step::Probe { tries } if tries < TRIES => {
                self.go(Step::Probe { tries: tries + 1 }, now + ANSWER_US);
                Some(Action::Send(PROBE))
            }
            Step::Confirm { tries } if tries < TRIES => {
                self.go(Step::Confirm { tries: tries + 1 }, now + ANSWER_US);
                Some(Action::Send(PROBE))
            }
            Step::Probe { .. } | Step::Confirm { .. } => {
                self.try_next(now);
                None
            }
            Step::Port => {
                self.go(Step::Retune, now + RETUNE_US);
                Some(Action::Send(self.dialect.port()))
            }
            Step::Retune => {
                self.go(Step::Confirm { tries: 0 }, now + SETTLE_US);
                Some(Action::SetBaud(TARGET_BAUD))
            }
            Step::Configure { index, tries } => self.configure(index, tries, now),
            Step::Report { heard } => {
                if now.saturating_sub(heard) > SILENCE_US {
                    self.lost(now);
                }
                None
            }
        }
    }

    /// A message came by `now`.
    pub fn heard(&mut self, message: &Message, now: u64) {
        match (self.step, message) {
            (Step::Probe { .. }, Message::Acknowledged(VALSET)) => self.found(Dialect::Values, now),
            (Step::Probe { .. }, Message::Refused(VALSET)) => self.found(Dialect::Messages, now),
            (Step::Probe { .. }, Message::Acknowledged(PRT) | Message::Refused(PRT)) => self.answered = true,
            (Step::Confirm { tries: 1.. }, _) => self.go(Step::Configure { index: 0, tries: 0 }, now),
            (Step::Configure { index, .. }, Message::Acknowledged(id)) if self.is_sent(index, *id) => {
                self.done(index, now);
            }
            (Step::Configure { index, .. }, Message::Refused(id)) if self.is_sent(index, *id) => {
                if index == 0 && self.dialect == Dialect::Values {
                    self.found(Dialect::Messages, now);
                } else {
                    self.done(index, now);
                }
            }
            (Step::Report { .. }, Message::NavPvt(_)) => {
                self.health = Health::Working;
                self.step = Step::Report { heard: now };
            }
            _ => {}
        }
    }

    fn go(&mut self, step: Step, due: u64) {
        self.step = step;
        self.due = due;
    }

    /// Somebody answers, who is configured so. One that was stuck is so until it reports.
    fn found(&mut self, dialect: Dialect, now: u64) {
        if self.health != Health::Stuck {
            self.health = Health::Configuring;
        }
        self.dialect = dialect;
        self.go(Step::Port, now);
    }

    /// Nobody answers at this rate.
    fn try_next(&mut self, now: u64) {
        self.trial += 1;
        if self.trial >= BAUDS.len() {
            self.trial = 0;
            self.health = Health::Absent;
        }
        self.go(Step::Tune, now);
    }

    /// Reports ceased, or never came.
    fn lost(&mut self, now: u64) {
        self.health = match self.health {
            Health::Working => Health::Absent,
            _ => Health::Stuck,
        };
        self.trial = 0;
        self.go(Step::Tune, now);
    }

    /// Whether the command of this number is of this class and number, and was sent.
    fn is_sent(&self, index: usize, id: [u8; 2]) -> bool {
        let commands = self.dialect.commands();
        commands.get(index).is_some_and(|command| command.id == id)
            && matches!(self.step, Step::Configure { tries: 1.., .. })
    }

    /// The command of this number is over.
    fn done(&mut self, index: usize, now: u64) {
        self.go(
            Step::Configure {
                index: index + 1,
                tries: 0,
            },
            now,
        );
    }

    /// Sends a command, or the next one where this one was sent in vain. Whether they were obeyed
    /// shows by reports.
    fn configure(&mut self, index: usize, tries: u8, now: u64) -> Option<Action> {
        match self.dialect.commands().get(index) {
            None => {
                self.go(Step::Report { heard: now }, now);
                None
            }
            Some(_) if tries >= TRIES => {
                self.done(index, now);
                None
            }
            Some(command) => {
                let tries = tries + 1;
                self.go(Step::Configure { index, tries }, now + ANSWER_US);
                Some(Action::Send(command.bytes))
            }
        }
    }
}
