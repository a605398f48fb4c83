//! The supervisor, explored completely: every state that can be reached, and from each of them every
//! event and every pair of events.
//!
//! A situation is the supervisor's state, whether the vehicle is in the air, and what its modes can
//! rely on. Events are what may happen between two steps: a row becomes active, or is found active;
//! the row that acts is over; an order; the latch; a timer; a mode that is done; a takeoff, a
//! touchdown; something that modes rely on comes or goes. A row that acts stays active until an event
//! ends it; other rows are active as events say. That is more than can really happen, so what holds
//! here holds in flight.

extern crate std;

use std::collections::BTreeSet;
use std::println;
use std::vec::Vec;

use super::*;
use crate::mode::{Need, Needs};
use crate::parameters::Parameters;

/// What modes rely on: each level includes the ones before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Known {
    Nothing,
    Attitude,
    Height,
    Position,
}

/// The state of the world as far as it counts here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Situation {
    supervisor: Supervisor,
    airborne: bool,
    known: Known,
    /// A pilot's sticks and setpoints from outside are there.
    outside: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    Rises(Row),
    IsActive(Row),
    Ends,
    Order(Order),
    Stopped,
    DisarmDue,
    Done(Mode),
    Airborne(bool),
    Known(Known),
    Outside(bool),
}

/// The modes that can fly; where setpoints come from outside they are attitudes, which need least.
fn available(known: Known, outside: bool) -> ModeSet {
    let there_is = Needs::default()
        .with(Need::Attitude, known >= Known::Attitude)
        .with(Need::Height, known >= Known::Height)
        .with(Need::Position, known >= Known::Position)
        .with(Need::Sticks, outside)
        .with(Need::Setpoint, outside)
        .with(Need::Mission, true);
    crate::mode::available(there_is, false)
}

const KNOWN: [Known; 4] = [Known::Nothing, Known::Attitude, Known::Height, Known::Position];

fn orders() -> Vec<Order> {
    let mut orders = std::vec![
        Order::Arm { blocked: false },
        Order::Arm { blocked: true },
        Order::ForceArm,
        Order::Disarm
    ];
    orders.extend(Mode::ALL.map(Order::Fly));
    orders
}

/// Everything that may happen in a situation.
fn events(situation: &Situation) -> Vec<Event> {
    let mut events: Vec<Event> = Row::ALL.iter().copied().map(Event::Rises).collect();
    events.extend(Row::ALL.iter().copied().map(Event::IsActive));
    events.extend(orders().into_iter().map(Event::Order));
    events.extend([Event::Ends, Event::Stopped, Event::DisarmDue]);
    events.extend(done(situation.supervisor.mode).iter().copied().map(Event::Done));
    events.push(Event::Airborne(!situation.airborne));
    events.push(Event::Outside(!situation.outside));
    let others = KNOWN.into_iter().filter(|known| *known != situation.known);
    events.extend(others.map(Event::Known));
    events
}

/// The modes that may follow a mode that is done.
fn done(mode: Mode) -> &'static [Mode] {
    match mode {
        Mode::Takeoff => &[Mode::Hold],
        Mode::Mission => &[Mode::Hold, Mode::Return, Mode::Land],
        Mode::Return => &[Mode::Land],
        _ => &[],
    }
}

/// What each order was answered.
type Answers = Vec<(Order, Result<(), Denied>)>;

/// What some events make of a situation: the situation after, the facts of the step, and what each
/// order was answered.
fn apply(from: &Situation, events: &[Event], actions: &Actions) -> (Situation, Facts, Answers) {
    let mut to = *from;
    let mut facts = Facts::default();
    if let Some(acting) = from.supervisor.acting
        && !events.contains(&Event::Ends)
    {
        facts.active = RowSet::of(acting);
    }
    for event in events {
        match *event {
            Event::Rises(row) => {
                facts.rising = facts.rising.with(row, true);
                facts.active = facts.active.with(row, true);
            }
            Event::IsActive(row) => facts.active = facts.active.with(row, true),
            Event::Stopped => facts.stopped = true,
            Event::DisarmDue => facts.disarm_due = true,
            Event::Done(next) => facts.next = Some(next),
            Event::Airborne(is) => to.airborne = is,
            Event::Known(known) => to.known = known,
            Event::Outside(is) => to.outside = is,
            Event::Ends | Event::Order(_) => {}
        }
    }
    facts.airborne = to.airborne;
    facts.available = available(to.known, to.outside);
    let mut answers = Vec::new();
    for event in events {
        if let Event::Order(order) = event {
            answers.push((*order, to.supervisor.order(*order, &facts, actions)));
        }
    }
    to.supervisor.step(&facts, actions);
    (to, facts, answers)
}

/// What must hold after every step, whatever happened before.
fn check(
    from: &Situation,
    events: &[Event],
    to: &Situation,
    facts: &Facts,
    actions: &Actions,
    answers: &[(Order, Result<(), Denied>)],
) {
    let (before, after) = (&from.supervisor, &to.supervisor);
    let what = || std::format!("{from:?}\n{events:?}\n{to:?}");
    let armed = after.phase != Phase::Disarmed;
    // Nothing but an order to arm ends the state "disarmed", and no blocked one.
    if before.phase == Phase::Disarmed && armed {
        let arms = |order: &Order| matches!(order, Order::Arm { blocked: false } | Order::ForceArm);
        assert!(
            answers
                .iter()
                .any(|(order, answer)| arms(order) && answer.is_ok()),
            "{}",
            what()
        );
    }
    // The latch always works.
    assert!(!(facts.stopped && armed), "{}", what());
    // A flight ends only by the latch, the ground, or a row that says so.
    if before.phase == Phase::Flying && !armed && to.airborne {
        let terminates = |row: Row| actions.of(row) == Action::Terminate;
        assert!(facts.stopped || facts.active.iter().any(terminates), "{}", what());
    }
    // In the air is in the air.
    assert_eq!(after.phase == Phase::Flying, armed && to.airborne, "{}", what());
    // No mode flies without what it relies on.
    assert!(!armed || facts.available.contains(after.mode), "{}", what());
    // What acts is at least as bad as every row that has just become active.
    if after.phase == Phase::Flying {
        let acts = after.acting.map_or(Action::None, |row| actions.of(row));
        for row in facts.rising.iter() {
            assert!(
                acts >= actions.of(row),
                "{} does not act: {}",
                row.watched().name,
                what()
            );
        }
        // And the mode does what it asks for, or the most of it that can be done.
        let wanted = acts.mode();
        let done = wanted.is_none_or(|mode| {
            Action::of(after.mode) >= acts || after.mode == mode || !facts.available.contains(mode)
        });
        assert!(done, "{}", what());
    }
    // Without an operator's order nothing makes a worse failsafe do less while it lasts.
    if let (Some(acting), true) = (before.acting, answers.is_empty())
        && facts.active.contains(acting)
        && actions.of(acting) >= Action::Hold
        && before.phase == Phase::Flying
        && after.phase == Phase::Flying
    {
        let now = after.acting.map_or(Action::None, |row| actions.of(row));
        assert!(now >= actions.of(acting), "{}", what());
        let kept =
            Action::of(after.mode) >= Action::of(before.mode) || !facts.available.contains(before.mode);
        assert!(kept || facts.next.is_some(), "{}", what());
    }
    // A vehicle that has landed does not think of something else to fly by itself.
    let grounded = before.phase == Phase::Landed && after.phase == Phase::Landed;
    if grounded && answers.is_empty() && facts.next.is_none() {
        let quiet = after.mode == before.mode || matches!(after.mode, Mode::Altitude | Mode::Descend);
        assert!(quiet, "{}", what());
    }
    if before.phase == Phase::Flying && after.phase == Phase::Landed && answers.is_empty() {
        assert_eq!(after.interrupted, None, "{}", what());
    }
    // Orders that were refused by themselves changed nothing.
    if let ([(_, Err(_))], [Event::Order(_)]) = (answers, events) {
        let (quiet, ..) = apply(from, &[], actions);
        assert_eq!(quiet.supervisor, *after, "{}", what());
    }
}

/// A vehicle on the ground disarms when it is told to, in one step.
fn disarms_on_the_ground(situation: &Situation, actions: &Actions) {
    let grounded = Situation {
        airborne: false,
        ..*situation
    };
    let (landed, ..) = apply(&grounded, &[], actions);
    let (disarmed, _, answers) = apply(&landed, &[Event::Order(Order::Disarm)], actions);
    assert!(answers.iter().all(|(_, answer)| answer.is_ok()), "{situation:?}");
    assert_eq!(disarmed.supervisor.phase, Phase::Disarmed, "{situation:?}");
}

/// And by itself, when nobody says anything.
fn disarms_by_itself(situation: &Situation, actions: &Actions) {
    let grounded = Situation {
        airborne: false,
        ..*situation
    };
    let (landed, ..) = apply(&grounded, &[], actions);
    let (disarmed, ..) = apply(&landed, &[Event::DisarmDue], actions);
    assert_eq!(disarmed.supervisor.phase, Phase::Disarmed, "{situation:?}");
}

/// What an operator in flight may always do: come down. Either the order is taken, or what flies
/// comes down already.
fn can_come_down(situation: &Situation, actions: &Actions) {
    if situation.supervisor.phase != Phase::Flying {
        return;
    }
    let (next, _, answers) = apply(situation, &[Event::Order(Order::Fly(Mode::Land))], actions);
    let comes_down = Action::of(next.supervisor.mode) >= Action::Return;
    let may_fly_on = next.supervisor.phase != Phase::Flying;
    let held = matches!(answers.as_slice(), [(_, Err(Denied::Failsafe(_)))]);
    assert!(comes_down || may_fly_on || held, "{situation:?} {next:?}");
}

#[derive(Default, Debug)]
struct Count {
    states: usize,
    situations: usize,
    steps: u64,
}

fn explore(actions: &Actions) -> Count {
    let start = Situation {
        supervisor: Supervisor::default(),
        airborne: false,
        known: Known::Nothing,
        outside: false,
    };
    let mut seen = BTreeSet::from([start]);
    let mut frontier = std::vec![start];
    let mut count = Count::default();
    while let Some(from) = frontier.pop() {
        let events = events(&from);
        let mut leaves = false;
        let mut go = |some: &[Event]| {
            let (to, facts, answers) = apply(&from, some, actions);
            check(&from, some, &to, &facts, actions, &answers);
            leaves |= to.supervisor != from.supervisor;
            count.steps += 1;
            if seen.insert(to) {
                frontier.push(to);
            }
        };
        go(&[]);
        for (n, first) in events.iter().enumerate() {
            go(&[*first]);
            for second in &events[n + 1..] {
                go(&[*first, *second]);
            }
        }
        assert!(leaves, "no way out of {from:?}");
        disarms_on_the_ground(&from, actions);
        disarms_by_itself(&from, actions);
        can_come_down(&from, actions);
    }
    count.situations = seen.len();
    let states: BTreeSet<_> = seen.iter().map(|situation| situation.supervisor).collect();
    count.states = states.len();
    for phase in Phase::ALL {
        assert!(
            states.iter().any(|state| state.phase == phase),
            "{phase:?} is never reached"
        );
    }
    for mode in Mode::ALL {
        let flown = |state: &&Supervisor| state.mode == mode && state.phase == Phase::Flying;
        assert!(states.iter().any(|state| flown(&state)), "{mode:?} never flies");
    }
    for row in Row::ALL.iter().filter(|row| actions.of(**row) > Action::None) {
        let acts = states.iter().any(|state| state.acting == Some(*row));
        assert!(acts, "{row:?} never acts");
    }
    count
}

/// With the actions as they are by default. If this failed, there would be an order of events after
/// which motors run that should not, a failsafe does less than it should, or nothing helps any more.
#[test]
fn every_state_under_every_pair_of_events() {
    let count = explore(&Actions::new(&Parameters::default()));
    println!(
        "supervisor: {} states, {} situations, {} transitions by every event and every pair of {} rows and {} orders",
        count.states,
        count.situations,
        count.steps,
        row::ROWS,
        orders().len()
    );
    assert!(count.states > 300);
}

/// The same with every action that a parameter chooses at its most and at its least: whatever a user
/// sets, the rules hold.
#[test]
fn with_the_actions_at_their_most() {
    let mut parameters = Parameters::default();
    parameters.safety.rc_lost_action = 6.0;
    parameters.safety.station_lost_action = 3.0;
    parameters.safety.offboard_lost_action = 2.0;
    parameters.safety.low_battery_action = 2.0;
    parameters.fence.action = 4.0;
    explore(&Actions::new(&parameters));
}

/// See above.
#[test]
fn with_the_actions_at_their_least() {
    let mut parameters = Parameters::default();
    parameters.safety.rc_lost_action = 0.0;
    parameters.safety.offboard_lost_action = 0.0;
    parameters.safety.low_battery_action = 0.0;
    parameters.fence.action = 0.0;
    explore(&Actions::new(&parameters));
}
