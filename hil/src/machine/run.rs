//! The machine's main loop: events, exceptions, sleep, and instructions in between.

use super::bus::Bus;
use super::clock::Cause;
use super::engine::{Masks, Registers};
use super::fault::Fault;
use super::scs::scr;
use super::stop::Stop;
use super::{Machine, State};
use crate::board::ResetCause;
use crate::time::NEVER;
use crate::violation::Violation;
use unicorn_engine::RegisterARM;

const THUMB: u32 = 1 << 24;

impl<B: Bus + 'static> Machine<B> {
    /// Runs until this moment, or a block of instructions longer. Resets do not end a run.
    pub fn run(&mut self, until: u64) -> Result<(), Stop> {
        self.until = until;
        while self.now() < until {
            self.tap_log();
            let horizon = until.min(self.log.due());
            self.with_system(|system, _, clock| {
                system.horizon = horizon;
                system.settle(clock);
            });
            while self.now() < horizon {
                self.step()?;
            }
        }
        Ok(())
    }

    fn step(&mut self) -> Result<(), Stop> {
        self.let_things_happen()?;
        if self.wait_for_flash() || self.take_exception() {
            return Ok(());
        }
        match self.state {
            State::Lockup => self.stay_locked_up(),
            State::AsleepForInterrupt | State::AsleepForEvent => self.sleep(),
            State::Running => match self.spin_until() {
                Some(then) => self.spin(then),
                None => self.execute(),
            },
        }
    }

    fn let_things_happen(&mut self) -> Result<(), Stop> {
        self.with_system(|system, core, clock| system.advance(core, clock));
        self.program_flash();
        self.clock.attention.set(false);
        let (violation, reset) = {
            let mut system = self.system.borrow_mut();
            system.control.exceptions.changed = false;
            let software = system.control.reset_requested.then_some(ResetCause::Software);
            (system.violation.take(), system.bus.take_reset().or(software))
        };
        if let Some(violation) = violation {
            return Err(self.violated(violation));
        }
        if self.system.borrow_mut().bus.take_power_failure() {
            return Err(Stop::PowerFailure { place: self.here() });
        }
        if let Some(cause) = reset {
            self.reset(cause);
        }
        Ok(())
    }

    fn violated(&self, violation: Violation) -> Stop {
        Stop::Violation {
            violation,
            place: Box::new(self.place(self.clock.block.get())),
        }
    }

    fn here(&self) -> Box<super::Place> {
        Box::new(self.place(self.core.get(RegisterARM::PC)))
    }

    /// While flash is busy nothing can be fetched: not even a handler.
    fn wait_for_flash(&mut self) -> bool {
        let busy_until = self.system.borrow().bus.stalled_until();
        let waits = busy_until > self.now();
        if waits {
            self.clock.stand_until(busy_until.min(self.clock.due.get()));
        }
        waits
    }

    /// Takes the exception that may preempt now. If one waits behind the masks alone, the block
    /// hook watches these.
    fn take_exception(&mut self) -> bool {
        self.clock.watched_masks.set(None);
        if self.state == State::Lockup || self.system.borrow().control.exceptions.first_pending().is_none() {
            return false;
        }
        let masks = self.core.masks();
        let preempting = |masks: Masks| {
            let exceptions = &self.system.borrow().control.exceptions;
            exceptions.preempting(exceptions.execution_priority(masks))
        };
        if let Some(number) = preempting(masks) {
            self.enter(number);
            return true;
        }
        if preempting(Masks::default()).is_some() {
            self.clock.watched_masks.set(Some(masks));
        }
        // WFI ends also for what only PRIMASK holds back.
        let wakes = preempting(Masks {
            basepri: masks.basepri,
            ..Masks::default()
        })
        .is_some();
        if wakes && self.state == State::AsleepForInterrupt {
            self.wake();
        }
        false
    }

    fn wake(&mut self) {
        self.account();
        self.state = State::Running;
    }

    fn sleep(&mut self) -> Result<(), Stop> {
        if self.state == State::AsleepForEvent && self.clock.event.replace(false) {
            self.wake();
            return Ok(());
        }
        if self.waits_for_ever() {
            return Err(Stop::AsleepForEver { place: self.here() });
        }
        self.clock.now.set(self.clock.due.get().max(self.now()));
        Ok(())
    }

    /// Time passes until a reset.
    fn stay_locked_up(&mut self) -> Result<(), Stop> {
        if self.waits_for_ever() {
            return Err(Stop::Lockup { place: self.here() });
        }
        self.clock.stand_until(self.clock.due.get());
        Ok(())
    }

    /// Neither will anything happen, nor does the run end.
    fn waits_for_ever(&self) -> bool {
        let system = self.system.borrow();
        self.until == NEVER && system.bus.next_event() == NEVER && system.control.systick.next() == NEVER
    }

    /// An injected stall: this context spins.
    fn spin(&mut self, until: u64) -> Result<(), Stop> {
        if until == NEVER && self.waits_for_ever() {
            return Err(Stop::AsleepForEver { place: self.here() });
        }
        let before = self.now();
        self.clock.stand_until(until.min(self.clock.due.get()));
        self.injections.spun(self.now() - before);
        Ok(())
    }

    fn is_thumb(&self) -> bool {
        self.core.get(RegisterARM::EPSR) & THUMB != 0
    }

    fn execute(&mut self) -> Result<(), Stop> {
        let start = self.core.get(RegisterARM::PC) | u32::from(self.is_thumb());
        self.clock.cause.set(Cause::Unsaid);
        let result = self.core.emu_start(start.into(), 0, 0, 0);
        let cause = self.clock.cause.get();
        if !matches!(cause, Cause::Boundary | Cause::Mark(_)) {
            self.clock.finish_block();
        }
        match (cause, result) {
            (Cause::Unsaid, Err(error)) => Err(Stop::Engine {
                error: format!("{error:?}"),
                place: self.here(),
            }),
            (cause, _) => self.answer(cause),
        }
    }

    fn answer(&mut self, cause: Cause) -> Result<(), Stop> {
        match cause {
            Cause::Boundary | Cause::Refused => {}
            Cause::Mark(address) => self.reach(address),
            // At address 0 the engine stops, or looks before it.
            Cause::Unsaid | Cause::Fetch(_) if self.core.get(RegisterARM::PC) == 0 => {
                self.fault(if self.is_thumb() {
                    Fault::Undefined
                } else {
                    Fault::InvalidState
                });
            }
            Cause::Unsaid => return self.fall_asleep(State::AsleepForInterrupt),
            Cause::WaitForEvent => return self.fall_asleep(State::AsleepForEvent),
            Cause::ExceptionReturn => self.leave(),
            Cause::Supervisor => self.call_supervisor(),
            Cause::Breakpoint if self.options.debugger_attached => {
                return Err(Stop::Breakpoint { place: self.here() });
            }
            Cause::Breakpoint => self.fault(Fault::Breakpoint),
            Cause::Undefined => self.fault(Fault::Undefined),
            Cause::InvalidState => self.fault(Fault::InvalidState),
            Cause::Load(address) => self.fault(Fault::Load(address)),
            Cause::Store(address) => self.fault(Fault::Store(address)),
            Cause::Fetch(address) => self.fault(Fault::Fetch(address)),
        }
        Ok(())
    }

    fn fall_asleep(&mut self, state: State) -> Result<(), Stop> {
        if self.system.borrow().control.scr & scr::SLEEP_DEEP != 0 {
            let what = "Stop and Standby (SLEEPDEEP) are not modelled".into();
            return Err(self.violated(Violation::Misuse {
                peripheral: "power control",
                what,
            }));
        }
        self.account();
        self.state = state;
        Ok(())
    }

    fn call_supervisor(&mut self) {
        use super::nvic::SV_CALL;
        let priority = self.execution_priority();
        let callable = self
            .system
            .borrow()
            .control
            .exceptions
            .preemption_priority(SV_CALL)
            < priority;
        if callable {
            self.system.borrow_mut().control.exceptions.pend(SV_CALL);
        } else {
            self.fault(Fault::Supervisor);
        }
    }
}
