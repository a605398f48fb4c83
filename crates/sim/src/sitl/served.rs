//! A simulated vehicle and its links, without a clock or a socket: time and bytes in, bytes out.

use windhover_autopilot::mission::{MissionItem, MissionSource, PlanMemory};
use windhover_autopilot::{InnerInput, MotorCommand, OuterResult, ScheduleRecord, Snapshot};
use windhover_flight_log::{PlanItem, version};
use windhover_ground_link::{Address, Config, Link, PlanKind, Severity};
use windhover_model::Truth;
use windhover_vehicle_link::{Effects, Fitting, PlanMedium, Told, VehicleLink};

use crate::closed_loop::{ClosedLoop, Recorder};
use crate::flight_log::FlightLog;
use crate::sensors::compass_fitting;
use crate::sitl::echo::Echo;

/// Bytes a second that a socket carries, for all that the link has to know: a tenth of that would do.
const BANDWIDTH: u32 = 1_000_000;

/// A line for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Simulated time, s.
    pub time: f64,
    /// How grave it is.
    pub severity: Severity,
    /// What it says.
    pub text: String,
}

/// The vehicle with its links.
pub struct Served {
    flown: ClosedLoop,
    vehicle: VehicleLink,
    links: Vec<Link>,
    told: Box<Told>,
    taken: Box<Told>,
    log: FlightLog,
    /// In a simulation that runs faster than the clock.
    echo: Option<Echo>,
    lines: Vec<Line>,
    /// Simulated time, s.
    time: f64,
    period: f64,
    ticks: u64,
    ticks_per_step: u64,
}

impl Served {
    /// A vehicle that nobody has spoken to yet, with so many links.
    pub fn new(flown: ClosedLoop, log: FlightLog, links: usize) -> Self {
        let config = *flown.inner_config();
        let fitting = Fitting {
            rotation: config.rotation,
            compass: compass_fitting(),
        };
        let vehicle = VehicleLink::new(flown.outer().parameters(), fitting, Default::default());
        let mut served = Self {
            vehicle,
            links: Vec::new(),
            told: Box::default(),
            taken: Box::default(),
            log,
            echo: None,
            lines: Vec::new(),
            time: 0.0,
            period: 1.0 / f64::from(config.imu_rate),
            ticks: 0,
            ticks_per_step: u64::from(config.k()),
            flown,
        };
        served.links = (0..links).map(|index| served.fresh_link(index)).collect();
        served
    }

    /// The same, to run faster than the clock: what its senders repeat by the clock is repeated here by
    /// the simulated time.
    #[must_use]
    pub fn hurried(mut self) -> Self {
        self.echo = Some(Echo::default());
        self
    }

    fn fresh_link(&self, index: usize) -> Link {
        let mut release = [0; 8];
        for (to, from) in release.iter_mut().zip(version::COMMIT.bytes()) {
            *to = from;
        }
        Link::new(Config {
            address: Address {
                system: self.vehicle.parameters().link.system as u8,
                component: 1,
            },
            bandwidth: BANDWIDTH,
            channel: index as u8,
            version: release,
            ..Config::default()
        })
    }

    /// Whoever was at the other end of a link is gone.
    pub fn close(&mut self, link: usize) {
        let mut medium = Medium {
            plans: &mut self.flown.plans,
            log: &mut self.log,
        };
        self.vehicle.close(&mut self.links[link], link, &mut medium);
        self.links[link] = self.fresh_link(link);
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The vehicle in its world.
    pub fn flown(&self) -> &ClosedLoop {
        &self.flown
    }

    /// The vehicle's end of the links.
    pub fn vehicle(&self) -> &VehicleLink {
        &self.vehicle
    }

    /// The lines since the last time.
    pub fn take_lines(&mut self) -> Vec<Line> {
        std::mem::take(&mut self.lines)
    }

    /// The log so far, since the last time.
    pub fn take_log(&mut self) -> Vec<u8> {
        self.log.take()
    }

    /// The log, to be ended.
    pub fn into_log(self) -> FlightLog {
        self.log
    }

    /// Bytes have come by a link that is a stream, at `now` µs of the links' time.
    pub fn receive(&mut self, link: usize, bytes: &[u8], now: u64) {
        let mut medium = Medium {
            plans: &mut self.flown.plans,
            log: &mut self.log,
        };
        self.vehicle
            .receive(&mut self.links[link], bytes, now, &mut medium);
    }

    /// A packet has come by a link of packets.
    pub fn receive_packet(&mut self, link: usize, packet: &[u8], now: u64) {
        let mut medium = Medium {
            plans: &mut self.flown.plans,
            log: &mut self.log,
        };
        self.vehicle
            .receive_packet(&mut self.links[link], packet, now, &mut medium);
    }

    /// What a link sends at `now`.
    pub fn poll(&mut self, link: usize, now: u64, out: &mut dyn FnMut(&[u8])) {
        let mut medium = Medium {
            plans: &mut self.flown.plans,
            log: &mut self.log,
        };
        self.vehicle.poll(&mut self.links[link], now, &mut medium, out);
    }

    /// Goes on by one outer period, and answers.
    pub fn step(&mut self, now: u64) -> Effects {
        for _ in 0..self.ticks_per_step {
            let mut ears = Ears {
                told: &mut self.told,
                log: &mut self.log,
            };
            self.flown.tick(&mut ears);
            self.ticks += 1;
        }
        self.time = self.ticks as f64 * self.period;
        self.answer(now)
    }

    /// Passes on between core and links, without time going on.
    fn answer(&mut self, now: u64) -> Effects {
        Told::take(&mut self.told, &mut self.taken);
        let (time, lines) = (self.time, &mut self.lines);
        let mut say = |severity, text: core::fmt::Arguments<'_>| {
            lines.push(Line {
                time,
                severity,
                text: text.to_string(),
            });
        };
        self.vehicle.step(&mut self.links, &self.taken, now, &mut say);
        let mut inputs = self.vehicle.take_inputs();
        if let Some(echo) = &mut self.echo {
            echo.repeat(&mut inputs, now);
        }
        self.flown.mailboxes.queues.refill(&inputs);
        if let Some(urgent) = self.vehicle.take_urgent() {
            self.flown.urgent = Some(urgent);
        }
        self.vehicle.take_effects()
    }
}

/// Hears what the core does, and logs it.
struct Ears<'a> {
    told: &'a mut Told,
    log: &'a mut FlightLog,
}

impl Recorder for Ears<'_> {
    fn tick(
        &mut self,
        truth: &Truth,
        input: &InnerInput,
        motors: MotorCommand,
        record: Option<ScheduleRecord>,
    ) {
        self.told.tick(&input.imu, motors, record);
        self.log.tick(truth, input, motors, record);
    }

    fn outer(&mut self, truth: &Truth, snapshot: &Snapshot, result: &OuterResult) {
        self.told.outer(snapshot, result);
        self.log.outer(truth, snapshot, result);
    }
}

/// The plans on board; what is written is logged, so that a replay has it too.
struct Medium<'a> {
    plans: &'a mut PlanMemory,
    log: &'a mut FlightLog,
}

impl MissionSource for Medium<'_> {
    fn item(&self, kind: PlanKind, slot: u8, index: u16) -> Option<MissionItem> {
        self.plans.item(kind, slot, index)
    }
}

impl PlanMedium for Medium<'_> {
    fn clear(&mut self, kind: PlanKind, slot: u8) {
        self.plans.clear(kind, slot);
    }

    fn push(&mut self, kind: PlanKind, slot: u8, index: u16, item: &MissionItem) -> bool {
        let taken = self.plans.push(kind, slot, *item);
        if taken {
            self.log.plan_item(&PlanItem {
                kind,
                slot,
                index,
                item: *item,
            });
        }
        taken
    }
}
