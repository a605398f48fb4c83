//! The sensors besides the inertial ones, wired to parts that have clocks of their own: when a part
//! measures, the vehicle's sensor suite says what.

use windhover_model::World;
use windhover_model::sensor::icm42688p::Measurement;
use windhover_model::sensor::rate::Rates;
use windhover_model::sensor::rc::CHANNELS;
use windhover_model::sensor::suite::SensorSuite;

use super::fault::Socket;
use super::serial::Port;
use super::wires::Wires;
use crate::board::{Frame, I2cCondition, Inputs, Pin, Usart};
use crate::parts::Misuse;
use crate::parts::i2c::{Bus, Line, Slave, Talker};
use crate::parts::ist8310::{self, Ist8310};
use crate::parts::rc::{Protocol, Receiver};
use crate::parts::spl06::{self, Spl06};
use crate::parts::ublox::{Generation, Ublox};
use crate::time::{MICROSECOND, NEVER};

/// The suite's µs of a moment.
fn microseconds(now: u64) -> u64 {
    now / MICROSECOND
}

/// A socket that is asked at a rate.
#[derive(Clone, Debug)]
struct Regular {
    plugged: bool,
    due: u64,
    period: u64,
}

impl Regular {
    fn new(rate: windhover_model::sensor::rate::Rate) -> Self {
        Self {
            plugged: true,
            due: rate.phase * MICROSECOND,
            period: rate.period * MICROSECOND,
        }
    }

    fn now(&mut self, now: u64) -> bool {
        let due = self.due <= now;
        if due {
            self.due += self.period;
        }
        due
    }
}

/// All of them.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    pub suite: SensorSuite,
    pub bus: Bus,
    barometer: Slave<Spl06>,
    compass: Slave<Ist8310>,
    gnss: Ublox,
    remote: Option<(Receiver, Port)>,
    remote_asked: Regular,
    battery_asked: Regular,
    /// Counts of voltage and current.
    battery: [u16; 2],
}

impl Sensors {
    pub fn new(suite: SensorSuite, generation: Generation, remote: Option<Protocol>) -> Self {
        let rates = Rates::default();
        let formula = *suite.formula();
        let remote = remote.map(|protocol| {
            let receiver = Receiver::new(protocol);
            let port = Port::new(receiver.format());
            (receiver, port)
        });
        Self {
            suite,
            bus: Bus::default(),
            barometer: Slave::new(spl06::ADDRESS, Spl06::new(formula, 0)),
            compass: Slave::new(ist8310::ADDRESS, Ist8310::new(0)),
            gnss: Ublox::new(generation, 0),
            remote,
            remote_asked: Regular::new(rates.rc),
            battery_asked: Regular::new(rates.battery),
            battery: [0; 2],
        }
    }

    /// When something will next happen by itself.
    pub fn next_event(&self) -> u64 {
        let remote = match &self.remote {
            Some((_, port)) => port.next_event().min(self.remote_asked.due),
            None => NEVER,
        };
        self.barometer
            .next_event()
            .min(self.compass.next_event())
            .min(self.gnss.next_event())
            .min(self.battery_asked.due)
            .min(remote)
    }

    /// Lets everything happen that is due by now.
    pub fn advance(&mut self, now: u64, world: &World, wires: &Wires, inputs: &mut Inputs) {
        let time = microseconds(now);
        if self.barometer.next_event() <= now {
            let counts = self.suite.measure_barometer(&world.truth(), time);
            self.barometer.part.put(now, counts);
        }
        if self.compass.next_event() <= now {
            let counts = self.suite.measure_compass(&world.truth(), time);
            self.compass.part.put(counts);
        }
        if self.gnss.measures(now) {
            self.suite.measure_gnss(&world.truth(), time);
        }
        let frame = self.gnss.advance(now);
        inputs.received.extend(frame.map(|frame| (wires.gnss, frame)));
        if self.battery_asked.now(now) {
            self.measure_battery(now, world);
        }
        if let Some((receiver, port)) = &mut self.remote {
            if self.remote_asked.now(now) && self.remote_asked.plugged {
                let heard = self.suite.measure_rc(time);
                port.send(now, &receiver.frame(heard));
            }
            let frame = port.advance(now);
            inputs.received.extend(frame.map(|frame| (wires.remote, frame)));
        }
    }

    fn measure_battery(&mut self, now: u64, world: &World) {
        let counts = self.suite.measure_battery(&world.truth(), microseconds(now));
        let counts = counts.filter(|_| self.battery_asked.plugged);
        self.battery = counts.map_or([0; 2], |counts| [counts.voltage, counts.current]);
    }

    /// The world moved: what the satellite receiver has worked out comes out of it.
    pub fn moved(&mut self, now: u64) {
        while let Some(message) = self.suite.receive_gnss(microseconds(now)) {
            self.gnss.report(now, &message);
        }
    }

    /// What the inertial sensors measure, along the body's axes.
    pub fn inertial(&mut self, now: u64, world: &World) -> Option<Measurement> {
        self.suite.measure_imu(&world.truth(), microseconds(now))
    }

    pub fn transmitted(&mut self, now: u64, port: Usart, frame: Frame, wires: &Wires) {
        if port == wires.gnss {
            self.gnss.receive(now, frame);
        }
    }

    /// What a conversion of a pin gives.
    pub fn analogue(&self, pin: Pin, wires: &Wires) -> u16 {
        let place = wires.battery.iter().position(|wired| *wired == pin);
        place.map_or(0, |place| self.battery[place])
    }

    /// Plugs a sensor in, or takes it away.
    pub fn plug(&mut self, now: u64, socket: Socket, plugged: bool) {
        match (socket, plugged) {
            (Socket::Imu, _) => {}
            (Socket::Barometer, true) => self.barometer.plug(now),
            (Socket::Barometer, false) => self.barometer.unplug(),
            (Socket::Compass, true) => self.compass.plug(now),
            (Socket::Compass, false) => self.compass.unplug(),
            (Socket::Gnss, true) => self.gnss.plug(now),
            (Socket::Gnss, false) => self.gnss.unplug(),
            (Socket::Remote, _) => self.remote_asked.plugged = plugged,
            (Socket::Battery, _) => {
                self.battery_asked.plugged = plugged;
                self.battery = [0; 2];
            }
        }
    }

    pub fn set_sticks(&mut self, sticks: [f64; CHANNELS]) {
        self.suite.set_sticks(sticks);
    }

    /// What the firmware did to parts against their data sheets.
    pub fn misuse(&self) -> Vec<Misuse> {
        let mut all = self.barometer.part.misuse().to_vec();
        all.extend_from_slice(self.compass.part.misuse());
        all
    }

    /// How the other ends of the ports speak.
    pub fn format(&self, port: Usart, wires: &Wires) -> Option<crate::board::Format> {
        if port == wires.gnss {
            Some(self.gnss.format())
        } else {
            let remote = self.remote.as_ref().filter(|_| port == wires.remote);
            remote.map(|(_, port)| port.format())
        }
    }

    /// The bus, and the parts on it.
    fn talk<R>(&mut self, act: impl FnOnce(&mut Bus, &mut [&mut dyn Talker]) -> R) -> R {
        act(&mut self.bus, &mut [&mut self.barometer, &mut self.compass])
    }

    pub fn condition(&mut self, now: u64, condition: I2cCondition) {
        self.talk(|bus, parts| bus.condition(now, condition, parts));
    }

    pub fn send(&mut self, now: u64, byte: u8) -> bool {
        self.talk(|bus, parts| bus.send(now, byte, parts))
    }

    pub fn receive(&mut self, now: u64, acknowledge: bool) -> u8 {
        self.talk(|bus, parts| bus.receive(now, acknowledge, parts))
    }

    pub fn drive(&mut self, now: u64, line: Line, level: bool) {
        self.talk(|bus, parts| bus.drive(now, line, level, parts));
    }
}
