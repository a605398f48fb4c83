//! The board as a process that ground stations fly: its serial line at their sockets, its time by the
//! clock, until it is stopped.
//!
//! - [`pump`]: bytes between sockets and line; [`logs`]: the files of its logs; [`memory`]: its flash.

pub mod logs;
pub mod memory;
pub mod pump;

use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use windhover_math::max;
use windhover_sim::sitl::net::{Arrival, LINKS, Net};
use windhover_sim::sitl::pace::Pace;

use crate::flight::{Flight, FlightError, Outcome};
use crate::machine::Stop;
use crate::time::SECOND;
use logs::Logs;
use memory::Memory;
use pump::{Counts, Pump};

/// Virtual time between two looks at the sockets, in ticks: 2 ms, in which 23 bytes come at 115,200 baud.
const LOOK: u64 = SECOND / 500;

/// Where the time is ahead of the clock nothing is done for so long.
const NAP: Duration = Duration::from_millis(1);

/// The flash goes to its file so often, if it was written to.
const SAVE: Duration = Duration::from_secs(1);

/// Where, how fast, and how long.
#[derive(Clone, Copy, Debug)]
pub struct Service {
    /// Whom the board speaks to first, by UDP.
    pub udp: Option<SocketAddr>,
    /// Where it listens, by TCP.
    pub tcp: Option<SocketAddr>,
    /// Virtual seconds in one of the clock, 0 for as many as there can be.
    pub speed: f64,
    /// The end, in s of virtual time; `None` where there is none.
    pub seconds: Option<f64>,
}

/// How it ended.
#[derive(Clone, Debug)]
pub struct Ended {
    /// Why, for people.
    pub why: String,
    /// Whether the firmware did nothing that it must not, and the vehicle did not crash.
    pub well: bool,
    /// Greatest height, and whether the motors stand still.
    pub outcome: Outcome,
    /// What went over the line.
    pub counts: Counts,
    /// Frames that a station by TCP did not take.
    pub untaken: u64,
}

/// Serves until `stop` is set, the time is over, the firmware does what it must not, or the vehicle
/// crashes. `tell` is told each line for people. The error is one line.
pub fn serve(
    flight: &mut Flight,
    net: &mut Net,
    service: &Service,
    logs: &mut Logs,
    mut memory: Option<&mut Memory>,
    stop: &AtomicBool,
    tell: &mut dyn FnMut(&str),
) -> Result<Ended, String> {
    let mut pump = Pump::default();
    let start = Instant::now();
    let mut pace = Pace::new(service.speed, seconds(flight));
    let mut saved = start;
    let mut height = 0.0;
    let mut flies = false;
    let end = loop {
        if stop.load(Ordering::Relaxed) {
            break Ok("stopped".into());
        }
        if service.seconds.is_some_and(|end| seconds(flight) >= end) {
            break Ok("its time is over".into());
        }
        let now = Instant::now();
        receive(flight, net, &mut pump, tell);
        if pace.wanted((now - start).as_secs_f64(), seconds(flight)) > seconds(flight) {
            match flight.run(flight.machine.now() + LOOK) {
                Ok(()) => {}
                Err(FlightError::Stop(Stop::PowerFailure { .. })) => break Ok("power failed".into()),
                Err(error) => break Err(format!("the firmware did what it must not: {error}")),
            }
        } else {
            std::thread::sleep(NAP);
        }
        send(flight, net, &mut pump);
        keep(flight, logs, tell)?;
        height = max(height, -flight.truth().position.z);
        if !flies && !flight.stopped() {
            flies = true;
            flight.begin_figures();
        }
        if let Some(memory) = &mut memory
            && now - saved >= SAVE
        {
            saved = now;
            memory.store(&flight.machine)?;
        }
        if let Some(crash) = flight.machine.bus().wiring.world().crash() {
            break Err(crash.to_string());
        }
    };
    send(flight, net, &mut pump);
    keep(flight, logs, tell)?;
    if let Some(memory) = memory {
        memory.store(&flight.machine)?;
    }
    let outcome = Outcome {
        attitude_error: None,
        height,
        stopped: flight.stopped(),
    };
    Ok(Ended {
        well: end.is_ok(),
        why: end.unwrap_or_else(|why| why),
        outcome,
        counts: pump.counts(),
        untaken: net.lost,
    })
}

/// Virtual time, in s.
fn seconds(flight: &Flight) -> f64 {
    flight.machine.now() as f64 / SECOND as f64
}

/// From the sockets to the line.
fn receive(flight: &Flight, net: &mut Net, pump: &mut Pump, tell: &mut dyn FnMut(&str)) {
    let now = flight.machine.now();
    let mut bus = flight.machine.bus();
    net.receive(&mut |arrival| {
        match &arrival {
            Arrival::Opened(_, from) => tell(&format!("connected by TCP: {from}")),
            Arrival::Closed(_) => tell("disconnected by TCP"),
            Arrival::Packet(..) | Arrival::Bytes(..) => {}
        }
        pump.hear(&arrival, now, bus.wiring.ground_port());
    });
}

/// From the line to all sockets.
fn send(flight: &Flight, net: &mut Net, pump: &mut Pump) {
    let mut bus = flight.machine.bus();
    pump.speak(bus.wiring.ground_port(), &mut |frame| {
        for link in 0..LINKS {
            net.send(link, frame);
        }
    });
    net.flush();
}

/// Keeps what is to be kept of what the firmware said, and forgets the rest: it may run for days.
fn keep(flight: &mut Flight, logs: &mut Logs, tell: &mut dyn FnMut(&str)) -> Result<(), String> {
    for line in flight.lines.drain(..) {
        tell(&line.to_string());
    }
    let mut bus = flight.machine.bus();
    bus.wiring.take_record();
    logs.write(&bus.wiring.take_log())
}
