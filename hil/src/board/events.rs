//! What happens by itself: events at their time, and the transfers of DMA that they ask for.

use super::chip::{Chip, Outside};
use super::dma::requests::Request;
use super::map::Unit;
use super::refusal::{Answer, misuse};
use super::slots::{SLOTS, UNITS, slot};
use super::usart::PORTS;
use super::{Inputs, ResetCause};
use crate::time::NEVER;
use crate::violation::Violation;

impl Chip {
    /// Lets everything happen that is due now, here and outside.
    pub(super) fn advance(&mut self, now: u64, outside: &mut Outside) -> Result<(), Violation> {
        for (index, unit) in UNITS.into_iter().enumerate() {
            if self.next_events[index] <= now {
                self.changed |= 1 << index;
                self.event(now, unit, outside)?;
            }
        }
        if outside.wiring.next_event() <= now {
            let mut inputs = std::mem::take(&mut self.inputs);
            outside.wiring.advance(now, &mut inputs);
            self.take_inputs(now, &inputs)?;
            let Inputs { levels, received } = &mut inputs;
            levels.clear();
            received.clear();
            self.inputs = inputs;
        }
        self.settle(now, outside)
    }

    fn event(&mut self, now: u64, unit: Unit, outside: &mut Outside) -> Result<(), Violation> {
        match unit {
            Unit::Timer(index) => {
                self.timers[index].catch_up(now);
                self.show_pwm(now, index, outside.wiring)?;
            }
            Unit::Usart(index) => {
                if let Some(frame) = self.usarts[index].advance(now) {
                    outside.wiring.transmitted(now, PORTS[index].number, frame);
                }
            }
            Unit::Spi1 => self.spi.advance(now, |byte| outside.wiring.spi(now, byte)),
            Unit::I2c1 => self
                .i2c
                .advance(now, outside.wiring)
                .map_err(|refusal| refusal.during(unit.name()))?,
            Unit::Adc1 => self.convert(now, outside)?,
            Unit::Rcc => {
                let before = self.rcc.clocks();
                self.rcc
                    .advance(now)
                    .map_err(|refusal| refusal.during(unit.name()))?;
                if self.rcc.clocks() != before {
                    self.clocks_changed(now, outside)?;
                }
            }
            Unit::Flash => self.flash.advance(now, outside.memory),
            Unit::Iwdg if self.iwdg.expires(now) => {
                self.wanted_reset = Some(ResetCause::IndependentWatchdog);
            }
            _ => {}
        }
        Ok(())
    }

    /// Conversions of which the processor can learn by an access to this peripheral are done.
    pub(super) fn see_conversions(
        &mut self,
        now: u64,
        unit: Unit,
        outside: &mut Outside,
    ) -> Result<(), Violation> {
        if matches!(unit, Unit::Adc1 | Unit::Dma(1)) && self.adc.done(now).is_some() {
            self.convert(now, outside)?;
            self.note_changes();
        }
        Ok(())
    }

    /// Conversions that are done by now, each with what DMA makes of it.
    fn convert(&mut self, now: u64, outside: &mut Outside) -> Result<(), Violation> {
        while let Some((time, channel)) = self.adc.done(now) {
            let refused = |what| Violation::Misuse {
                peripheral: Unit::Adc1.name(),
                what,
            };
            let Some(pin) = super::adc::pin(channel) else {
                return Err(refused(format!("channel {channel} is not modelled")));
            };
            if !self.ports[usize::from(pin.port)].is_analogue(pin.number) {
                return Err(refused(format!("{pin} is converted and is not analogue")));
            }
            let counts = outside.wiring.analogue(time, pin);
            self.adc.finish(counts);
            self.changed |= slot(Unit::Adc1);
            self.serve_dma(now, outside)?;
        }
        Ok(())
    }

    /// After any change: serves DMA, then notes events and interrupts anew.
    pub(super) fn settle(&mut self, now: u64, outside: &mut Outside) -> Result<(), Violation> {
        self.serve_dma(now, outside)?;
        self.note_changes();
        Ok(())
    }

    fn serve_dma(&mut self, now: u64, outside: &mut Outside) -> Result<(), Violation> {
        loop {
            let mut served = false;
            for index in 0..self.dma.len() {
                let next = self.dma[index].next_transfer(|request| self.is_high(request));
                if let Some((stream, request)) = next {
                    self.transfer(now, index, stream, request, outside)?;
                    served = true;
                }
            }
            if !served {
                return Ok(());
            }
        }
    }

    fn is_high(&self, request: Request) -> bool {
        match request {
            Request::SpiReceive => self.spi.offers_byte(),
            Request::SpiTransmit => self.spi.requests_byte(),
            Request::Adc => self.adc.offers(),
            Request::UsartReceive(port) => self.usarts[usize::from(port)].offers_byte(),
            Request::UsartTransmit(port) => self.usarts[usize::from(port)].requests_byte(),
            Request::Timer(timer, event) => self.timers[usize::from(timer)].requests_dma(event),
        }
    }

    /// Moves one item between a peripheral and memory.
    fn transfer(
        &mut self,
        now: u64,
        controller: usize,
        stream: usize,
        request: Request,
        outside: &mut Outside,
    ) -> Result<(), Violation> {
        let refused = |refusal: super::refusal::Refusal| refusal.during(Unit::Dma(controller).name());
        if self.dma[controller].transmits(stream) {
            let (address, value) = self.dma[controller]
                .take(stream, outside.memory)
                .map_err(refused)?;
            self.write_for(now, request, address, value).map_err(refused)?;
        } else {
            let address = self.dma[controller].source(stream);
            let value = self.read_for(now, request, address).map_err(refused)?;
            self.dma[controller]
                .put(stream, value, outside.memory)
                .map_err(refused)?;
        }
        self.changed |= slot(Unit::Dma(controller));
        match request {
            Request::SpiReceive | Request::SpiTransmit => {
                self.changed |= slot(Unit::Spi1);
                self.check_spi_pins()
            }
            Request::Adc => {
                self.changed |= slot(Unit::Adc1);
                Ok(())
            }
            Request::UsartReceive(port) | Request::UsartTransmit(port) => {
                self.changed |= slot(Unit::Usart(usize::from(port)));
                Ok(())
            }
            Request::Timer(timer, event) => {
                let timer = usize::from(timer);
                self.timers[timer].dma_served(event);
                self.changed |= slot(Unit::Timer(timer));
                self.show_pwm(now, timer, outside.wiring)
            }
        }
    }

    fn write_for(&mut self, now: u64, request: Request, address: u32, value: u32) -> Answer<()> {
        match request {
            Request::SpiReceive | Request::SpiTransmit => self.spi.write_data(now, value),
            Request::Adc => misuse("ADC1's DR can only be read"),
            Request::UsartReceive(port) | Request::UsartTransmit(port) => {
                self.usarts[usize::from(port)].write_data(now, value)
            }
            Request::Timer(timer, _) => self.timers[usize::from(timer)].write(now, address & 0x3FC, value),
        }
    }

    fn read_for(&mut self, now: u64, request: Request, address: u32) -> Answer<u32> {
        match request {
            Request::SpiReceive | Request::SpiTransmit => Ok(self.spi.read_data()),
            Request::Adc => Ok(self.adc.read_data()),
            Request::UsartReceive(port) | Request::UsartTransmit(port) => {
                Ok(self.usarts[usize::from(port)].read_data())
            }
            Request::Timer(timer, _) => self.timers[usize::from(timer)].read(now, address & 0x3FC),
        }
    }

    /// Notes when those that changed will next do something, and which interrupts they raise.
    pub(super) fn note_changes(&mut self) {
        if self.changed == 0 {
            return;
        }
        if self.changed & slot(Unit::Dma(1)) != 0 {
            // When a conversion matters depends on its stream.
            self.changed |= slot(Unit::Adc1);
        }
        let mut changed = std::mem::take(&mut self.changed) & ((1 << SLOTS) - 1);
        while changed != 0 {
            let index = changed.trailing_zeros() as usize;
            changed &= changed - 1;
            (self.next_events[index], self.lines[index]) = self.state(UNITS[index]);
        }
        self.next = self
            .next_events
            .iter()
            .fold(NEVER, |next, event| next.min(*event));
        self.requested = self.lines.iter().fold(0, |all, lines| all | lines);
    }

    /// The next event and the request lines of a peripheral.
    fn state(&self, unit: Unit) -> (u64, u128) {
        let line = |raised: bool, interrupt: u32| u128::from(raised) << interrupt;
        match unit {
            Unit::Timer(index) => (self.timers[index].next_event(), self.timers[index].interrupts()),
            Unit::Usart(index) => {
                let usart = &self.usarts[index];
                (
                    usart.next_event(),
                    line(usart.interrupt(), PORTS[index].interrupt),
                )
            }
            Unit::Spi1 => (
                self.spi.next_event(),
                line(self.spi.interrupt(), super::spi::INTERRUPT),
            ),
            Unit::I2c1 => {
                let [event, error] = self.i2c.interrupts();
                let [event_line, error_line] = super::i2c::INTERRUPTS;
                (
                    self.i2c.next_event(),
                    line(event, event_line) | line(error, error_line),
                )
            }
            Unit::Adc1 => {
                let silent = self.dma[1].silent_items(Request::Adc);
                (
                    self.adc.next_event(silent),
                    line(self.adc.interrupt(), super::adc::INTERRUPT),
                )
            }
            Unit::Dma(index) => (NEVER, self.dma[index].interrupts()),
            Unit::Exti => (NEVER, self.exti.interrupts()),
            Unit::Rcc => (
                self.rcc.next_event(),
                line(self.rcc.interrupt(), super::rcc::INTERRUPT),
            ),
            Unit::Flash => (
                self.flash.next_event(),
                line(self.flash.interrupt(), super::flash::INTERRUPT),
            ),
            Unit::Iwdg => (self.iwdg.next_event(), 0),
            _ => (NEVER, 0),
        }
    }
}
