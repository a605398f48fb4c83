//! What the pins do to the parts, and the parts to the pins.

use super::Rig;
use crate::board::{Frame, I2cCondition, Inputs, Pin, PwmPulse, Usart, Wiring};
use crate::parts::i2c::Line;

impl Wiring for Rig {
    fn spi(&mut self, now: u64, mosi: u8) -> u8 {
        self.run(now);
        self.imu.exchange(self.now, mosi)
    }

    fn output(&mut self, now: u64, pin: Pin, level: bool) {
        self.run(now);
        if pin == self.wires.imu_select {
            if level {
                self.imu.deselect();
            } else {
                self.imu.select();
            }
        }
        let line = self.wires.i2c.iter().position(|wired| *wired == pin);
        if let (Some(line), Some(sensors)) = (line, &mut self.sensors) {
            sensors.drive(now, [Line::Clock, Line::Data][line], level);
            self.tell_lines();
        }
    }

    fn i2c_condition(&mut self, now: u64, condition: I2cCondition) {
        self.run(now);
        if let Some(sensors) = &mut self.sensors {
            sensors.condition(now, condition);
            self.tell_lines();
        }
    }

    fn i2c_send(&mut self, now: u64, byte: u8) -> bool {
        self.run(now);
        let sensors = self.sensors.as_mut();
        sensors.is_some_and(|sensors| sensors.send(now, byte))
    }

    fn i2c_receive(&mut self, now: u64, acknowledge: bool) -> u8 {
        self.run(now);
        let sensors = self.sensors.as_mut();
        sensors.map_or(0xFF, |sensors| sensors.receive(now, acknowledge))
    }

    fn analogue(&mut self, now: u64, pin: Pin) -> u16 {
        // Conversions are made up for: what is due by then has happened.
        self.run(now);
        let sensors = self.sensors.as_ref();
        sensors.map_or(0, |sensors| sensors.analogue(pin, &self.wires))
    }

    fn pwm(&mut self, now: u64, pin: Pin, pulse: PwmPulse) {
        self.run(now);
        let change = self.motors.pulse(self.now, pin, pulse);
        self.record.pulses.extend(change);
    }

    /// The controllers notice it when the next pulses do not come.
    fn pwm_stopped(&mut self, now: u64, _: Pin) {
        self.run(now);
    }

    fn transmitted(&mut self, now: u64, port: Usart, frame: Frame) {
        self.run(now);
        if port == self.wires.log {
            self.log.push(frame.data as u8);
        } else if port == self.wires.commands {
            self.commands.receive(now, frame);
        } else if let Some(sensors) = &mut self.sensors {
            sensors.transmitted(now, port, frame, &self.wires);
        }
    }

    fn next_event(&self) -> u64 {
        let told = self.inputs.levels.is_empty() && self.inputs.received.is_empty();
        if told { self.next_change() } else { self.now }
    }

    fn advance(&mut self, now: u64, inputs: &mut Inputs) {
        self.run(now);
        inputs.levels.append(&mut self.inputs.levels);
        inputs.received.append(&mut self.inputs.received);
    }
}
