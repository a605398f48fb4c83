//! The vehicle in real time, or faster, with ground stations at its links, until it is stopped.

pub mod echo;
pub mod net;
pub mod pace;
pub mod served;

use std::fs::File;
use std::io::Write;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use windhover_math::geodesy::GlobalPosition;

use crate::closed_loop::ClosedLoop;
use crate::flight::{Setup, SetupError};
use crate::flight_log::FlightLog;
use crate::stored::Stored;
use net::{Arrival, LINKS, Net};
use pace::Pace;
use served::{Line, Served};

/// Between two looks at the sockets nothing is done for so long.
const NAP: Duration = Duration::from_millis(1);

/// What is simulated at most between two looks at the sockets, s of the clock.
const BURST: Duration = Duration::from_millis(20);

/// The log goes to disk so often, s of the clock.
const SAVE: Duration = Duration::from_secs(1);

/// Where, how fast, and for whom.
#[derive(Clone, Debug)]
pub struct Service {
    /// Where the vehicle stands at the start.
    pub home: GlobalPosition,
    /// Whom it speaks to first, by UDP.
    pub udp: SocketAddr,
    /// Where it listens, by TCP.
    pub tcp: Option<SocketAddr>,
    /// Simulated seconds in one of the clock.
    pub speed: f64,
}

/// How it ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Why, for people.
    pub why: String,
    /// Whether it was stopped from outside, and did not crash.
    pub stopped: bool,
    /// Simulated time, s.
    pub time: f64,
    /// Simulated seconds in one of the clock, as it came out.
    pub speed: f64,
}

/// A vehicle on the ground that nobody has spoken to.
pub fn vehicle(
    setup: &Setup,
    home: GlobalPosition,
    conditions: &[(String, String)],
) -> Result<Served, SetupError> {
    let outer = setup.outer(home)?;
    let log = FlightLog::new(setup, outer.parameters(), home, &Stored::default(), conditions);
    let flown = ClosedLoop::new(
        setup.world(),
        setup.inner_config(),
        outer,
        &Stored::default(),
        home,
    );
    Ok(Served::new(setup.equip(flown, home), log, LINKS))
}

/// Opens the sockets. The error is one line for the user.
pub fn open(service: &Service) -> Result<Net, String> {
    Net::open(Some(service.udp), service.tcp)
}

/// Serves until `stop` is set or the vehicle crashes. The log grows in `log_file`; `tell` is told
/// each line. The error is one line for the user.
pub fn serve(
    mut served: Served,
    mut net: Net,
    service: &Service,
    log_file: &Path,
    stop: &AtomicBool,
    tell: &mut dyn FnMut(&Line),
) -> Result<(FlightLog, Ended), String> {
    if service.speed > 1.0 {
        served = served.hurried();
    }
    let at_file = |e: std::io::Error| format!("{}: {e}", log_file.display());
    let mut file = File::create(log_file).map_err(at_file)?;
    let start = Instant::now();
    let mut saved = start;
    let mut pace = Pace::new(service.speed, 0.0);
    let micros = |time: Instant| time.duration_since(start).as_micros() as u64;
    let why = loop {
        if stop.load(Ordering::Relaxed) {
            break None;
        }
        let now = Instant::now();
        let wanted = pace.wanted(now.duration_since(start).as_secs_f64(), served.time());
        receive(&mut net, &mut served, micros(now), tell);
        while served.time() < wanted && now.elapsed() < BURST {
            let effects = served.step(micros(Instant::now()));
            if effects.reboot {
                tell(&line(
                    &served,
                    "Asked to reboot: stop the program and start it again",
                ));
            }
            send(&mut net, &mut served, micros(Instant::now()));
        }
        served.take_lines().iter().for_each(&mut *tell);
        send(&mut net, &mut served, micros(Instant::now()));
        if now.duration_since(saved) >= SAVE {
            saved = now;
            file.write_all(&served.take_log()).map_err(at_file)?;
        }
        let world = &served.flown().world;
        if let Some(crash) = world.crash() {
            break Some(crash.to_string());
        }
        if let Some(divergence) = world.diverged() {
            break Some(divergence.to_string());
        }
        std::thread::sleep(NAP);
    };
    file.write_all(&served.take_log()).map_err(at_file)?;
    let time = served.time();
    let ended = Ended {
        stopped: why.is_none(),
        why: why.unwrap_or_else(|| "stopped".into()),
        time,
        speed: time / start.elapsed().as_secs_f64(),
    };
    Ok((served.into_log(), ended))
}

fn receive(net: &mut Net, served: &mut Served, now: u64, tell: &mut dyn FnMut(&Line)) {
    net.receive(&mut |arrival| match arrival {
        Arrival::Packet(link, packet) => served.receive_packet(link, packet, now),
        Arrival::Bytes(link, bytes) => served.receive(link, bytes, now),
        Arrival::Opened(_, from) => {
            tell(&line(served, &format!("Connected by TCP: {from}")));
        }
        Arrival::Closed(link) => {
            served.close(link);
            tell(&line(served, "Disconnected by TCP"));
        }
    });
}

fn send(net: &mut Net, served: &mut Served, now: u64) {
    for link in 0..LINKS {
        if net.is_open(link) {
            served.poll(link, now, &mut |frame| net.send(link, frame));
        }
    }
    net.flush();
}

fn line(served: &Served, text: &str) -> Line {
    Line {
        time: served.time(),
        severity: windhover_ground_link::Severity::Info,
        text: text.into(),
    }
}
