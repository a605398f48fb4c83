//! What passes between the peripherals and the pins: levels, edges, PWM; and whether a pin is
//! switched to the peripheral that uses it.

use super::alternate::{self, ROUTES, Signal};
use super::chip::Chip;
use super::map::Unit;
use super::slots::slot;
use super::usart::PORTS;
use super::wiring::{I2cCondition, Inputs, Pin, Wiring};
use crate::violation::Violation;

/// What a byte on SPI goes over.
const SPI_SIGNALS: [(&str, Signal); 3] = [
    ("SCK", Signal::SpiClock),
    ("MISO", Signal::SpiMiso),
    ("MOSI", Signal::SpiMosi),
];

/// A timer's output that reaches a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Output {
    timer: usize,
    channel: u8,
    complement: bool,
    pin: Pin,
    /// A pulse was told to the wiring, and no end of it.
    active: bool,
}

impl Chip {
    /// A port's registers were written: the wiring and EXTI see what changed.
    pub(super) fn port_written(
        &mut self,
        now: u64,
        port: usize,
        wiring: &mut dyn Wiring,
    ) -> Result<(), Violation> {
        self.tell_outputs(now, port, wiring);
        self.port_levels_changed(port);
        if self.ports[port].take_switched() {
            self.route_outputs(now, wiring);
        }
        self.note_i2c_lines(now)
    }

    pub(super) fn tell_outputs(&mut self, now: u64, port: usize, wiring: &mut dyn Wiring) {
        let (mut changed, levels) = self.ports[port].take_changed_outputs();
        while changed != 0 {
            let number = changed.trailing_zeros() as u8;
            changed &= changed - 1;
            let pin = Pin {
                port: port as u8,
                number,
            };
            wiring.output(now, pin, levels & (1 << number) != 0);
        }
    }

    /// What the outside did arrives.
    pub(super) fn take_inputs(&mut self, now: u64, inputs: &Inputs) -> Result<(), Violation> {
        for (pin, level) in &inputs.levels {
            let port = usize::from(pin.port);
            self.ports[port].drive(pin.number, *level);
            self.port_levels_changed(port);
        }
        for (name, frame) in &inputs.received {
            let Some(index) = PORTS.iter().position(|port| port.number == *name) else {
                continue;
            };
            self.usarts[index].receive(now, *frame);
            self.changed |= slot(Unit::Usart(index));
        }
        if inputs.levels.is_empty() {
            return Ok(());
        }
        self.note_i2c_lines(now)
    }

    fn port_levels_changed(&mut self, port: usize) {
        let levels = self.ports[port].levels();
        let mut edges = levels ^ self.levels[port];
        self.levels[port] = levels;
        while edges != 0 {
            let line = edges.trailing_zeros() as usize;
            edges &= edges - 1;
            if self.syscfg.port(line) == port {
                self.line_level(line, levels & (1 << line) != 0);
            }
        }
    }

    fn line_level(&mut self, line: usize, level: bool) {
        if self.exti.set_level(line, level) {
            self.changed |= slot(Unit::Exti);
        }
    }

    /// All pins' levels, and the lines of EXTI that listen to them.
    pub(super) fn note_pins(&mut self) {
        self.levels = std::array::from_fn(|port| self.ports[port].levels());
        for line in 0..16 {
            let level = self.levels[self.syscfg.port(line)] & (1 << line) != 0;
            self.line_level(line, level);
        }
    }

    /// Pins were switched: finds the timers' outputs that reach one.
    pub(super) fn route_outputs(&mut self, now: u64, wiring: &mut dyn Wiring) {
        self.spi_connected = false;
        let before = std::mem::take(&mut self.outputs);
        for route in ROUTES
            .iter()
            .filter(|route| alternate::connected(&self.ports, route))
        {
            let (timer, channel, complement) = match route.signal {
                Signal::Channel(timer, channel) => (usize::from(timer), channel, false),
                Signal::Complement(timer, channel) => (usize::from(timer), channel, true),
                _ => continue,
            };
            let mut output = Output {
                timer,
                channel,
                complement,
                pin: route.pin,
                active: true,
            };
            output.active = before.contains(&output);
            self.outputs.push(output);
        }
        for output in before.iter().filter(|output| output.active) {
            if !self.outputs.contains(output) {
                wiring.pwm_stopped(now, output.pin);
            }
        }
    }

    pub(super) fn stop_all_pwm(&mut self, now: u64, wiring: &mut dyn Wiring) {
        for output in self.outputs.iter().filter(|output| output.active) {
            wiring.pwm_stopped(now, output.pin);
        }
    }

    /// Tells the wiring what a timer's outputs do: the pulses of a period that begins, and the end
    /// of outputs that were switched off.
    pub(super) fn show_pwm(
        &mut self,
        now: u64,
        timer: usize,
        wiring: &mut dyn Wiring,
    ) -> Result<(), Violation> {
        let begins = self.timers[timer].take_beginning(now);
        if begins {
            self.check_output_pins(timer)?;
        }
        for output in self.outputs.iter_mut().filter(|output| output.timer == timer) {
            let Output {
                channel,
                complement,
                pin,
                ..
            } = *output;
            if !self.timers[timer].pulses(channel, complement) {
                if std::mem::take(&mut output.active) {
                    wiring.pwm_stopped(now, pin);
                }
            } else if begins {
                let pulse = self.timers[timer].pulse(channel, complement);
                let pulse = pulse.map_err(|refusal| refusal.during(Unit::Timer(timer).name()))?;
                if let Some(pulse) = pulse {
                    wiring.pwm(now, pin, pulse);
                    output.active = true;
                }
            }
        }
        Ok(())
    }

    fn check_output_pins(&self, timer: usize) -> Result<(), Violation> {
        for (channel, complement) in self.timers[timer].active_outputs() {
            let reaches_pin = self.outputs.iter().any(|output| {
                (output.timer, output.channel, output.complement) == (timer, channel, complement)
            });
            if !reaches_pin {
                let signal = if complement {
                    Signal::Complement(timer as u8, channel)
                } else {
                    Signal::Channel(timer as u8, channel)
                };
                let name = format!("CH{}{}", channel + 1, if complement { "N" } else { "" });
                self.check_pin(Unit::Timer(timer), &name, signal)?;
            }
        }
        Ok(())
    }

    /// Whether a serial port transmits and receives.
    pub(super) fn serial_directions(&self, unit: Unit) -> [bool; 2] {
        match unit {
            Unit::Usart(port) => [self.usarts[port].transmits(), self.usarts[port].receives()],
            _ => [false; 2],
        }
    }

    /// What a serial port does now and did not before must reach a pin.
    pub(super) fn check_serial_pins(&self, port: usize, before: [bool; 2]) -> Result<(), Violation> {
        let unit = Unit::Usart(port);
        let [transmits, receives] = self.serial_directions(unit);
        if transmits && !before[0] {
            self.check_pin(unit, "TX", Signal::UsartTransmit(port as u8))?;
        }
        if receives && !before[1] {
            self.check_pin(unit, "RX", Signal::UsartReceive(port as u8))?;
        }
        Ok(())
    }

    /// A byte on SPI needs all three pins.
    pub(super) fn check_spi_pins(&mut self) -> Result<(), Violation> {
        if self.spi_connected || !self.spi.busy() {
            return Ok(());
        }
        for (name, signal) in SPI_SIGNALS {
            self.check_pin(Unit::Spi1, name, signal)?;
        }
        self.spi_connected = true;
        Ok(())
    }

    /// I2C's lines as its pins show them: high, where no pin is switched to it.
    pub(super) fn note_i2c_lines(&mut self, now: u64) -> Result<(), Violation> {
        let lines = [Signal::I2cClock, Signal::I2cData].map(|signal| {
            alternate::carrier(&self.ports, signal).is_none_or(|pin| {
                let levels = self.levels[usize::from(pin.port)];
                levels & (1 << pin.number) != 0
            })
        });
        self.changed |= slot(Unit::I2c1);
        self.i2c
            .set_lines(now, lines)
            .map_err(|refusal| refusal.during(Unit::I2c1.name()))
    }

    /// Its registers were written: what starts needs both pins, which drive only low.
    pub(super) fn i2c_written(&mut self, now: u64, wiring: &mut dyn Wiring) -> Result<(), Violation> {
        self.tell_released(now, wiring);
        if !self.i2c.starts() {
            return Ok(());
        }
        for (name, signal) in [("SCL", Signal::I2cClock), ("SDA", Signal::I2cData)] {
            self.check_pin(Unit::I2c1, name, signal)?;
            let pin = alternate::carrier(&self.ports, signal);
            if let Some(pin) = pin.filter(|pin| !self.ports[usize::from(pin.port)].is_open_drain(pin.number))
            {
                return Err(Violation::Misuse {
                    peripheral: Unit::I2c1.name(),
                    what: format!("{pin} carries {name} and is not open-drain"),
                });
            }
        }
        Ok(())
    }

    /// I2C let go of the bus.
    pub(super) fn tell_released(&mut self, now: u64, wiring: &mut dyn Wiring) {
        if let Some(clocks) = self.i2c.take_released() {
            wiring.i2c_condition(now, I2cCondition::Released { clocks });
        }
    }

    fn check_pin(&self, unit: Unit, name: &str, signal: Signal) -> Result<(), Violation> {
        match alternate::missing(&self.ports, signal) {
            None => Ok(()),
            Some(choices) => Err(Violation::Misuse {
                peripheral: unit.name(),
                what: format!("no pin is switched to {name}: it takes {choices}"),
            }),
        }
    }
}
