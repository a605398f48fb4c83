//! Which requests reach which stream by which channel (RM0090 tables 42 and 43), for the
//! peripherals that are modelled.

use super::super::adc;
use super::super::spi;
use super::super::timer::{Event, kinds::TIMERS};
use super::super::usart::{self, PORTS};
use std::ops::Range;

/// A peripheral's wish for a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Request {
    SpiReceive,
    SpiTransmit,
    Adc,
    /// Index of the port.
    UsartReceive(u8),
    /// Index of the port.
    UsartTransmit(u8),
    /// Index of the timer.
    Timer(u8, Event),
}
use Request::{Adc, SpiReceive, SpiTransmit, UsartReceive, UsartTransmit};

impl Request {
    /// Whether data goes to the peripheral; a timer takes it either way.
    pub(super) fn to_peripheral(self) -> Option<bool> {
        match self {
            Adc | SpiReceive | UsartReceive(_) => Some(false),
            SpiTransmit | UsartTransmit(_) => Some(true),
            Self::Timer(..) => None,
        }
    }

    /// The addresses that a transfer for it may use.
    pub(super) fn registers(self) -> Range<u32> {
        let one = |address: u32| address..address + 1;
        match self {
            SpiReceive | SpiTransmit => one(spi::DATA),
            Adc => one(adc::DATA),
            UsartReceive(port) | UsartTransmit(port) => one(PORTS[usize::from(port)].base + usart::DR),
            Self::Timer(timer, _) => {
                let base = TIMERS[usize::from(timer)].base;
                base..base + 0x400
            }
        }
    }
}

/// A request and where it arrives.
struct Arrival {
    /// 0 for DMA1.
    controller: u8,
    stream: u8,
    channel: u8,
    request: Request,
}

const fn at(controller: u8, stream: u8, channel: u8, request: Request) -> Arrival {
    Arrival {
        controller: controller - 1,
        stream,
        channel,
        request,
    }
}

/// By the timer's number, as in the reference manual.
const fn update(timer: u8) -> Request {
    Request::Timer(timer - 1, Event::Update)
}

/// By the timer's and the channel's numbers, as in the reference manual.
const fn compare(timer: u8, channel: u8) -> Request {
    Request::Timer(timer - 1, Event::Compare(channel - 1))
}

/// Where a stream and channel carry several requests, they stand together.
const ARRIVALS: [Arrival; 61] = [
    at(1, 0, 2, compare(4, 1)),
    at(1, 0, 6, compare(5, 3)),
    at(1, 0, 6, update(5)),
    at(1, 1, 3, update(2)),
    at(1, 1, 3, compare(2, 3)),
    at(1, 1, 4, UsartReceive(2)),
    at(1, 1, 6, compare(5, 4)),
    at(1, 1, 7, update(6)),
    at(1, 2, 1, update(7)),
    at(1, 2, 5, compare(3, 4)),
    at(1, 2, 5, update(3)),
    at(1, 2, 6, compare(5, 1)),
    at(1, 3, 2, compare(4, 2)),
    at(1, 3, 4, UsartTransmit(2)),
    at(1, 3, 6, compare(5, 4)),
    at(1, 4, 1, update(7)),
    at(1, 4, 5, compare(3, 1)),
    at(1, 4, 6, compare(5, 2)),
    at(1, 4, 7, UsartTransmit(2)),
    at(1, 5, 3, compare(2, 1)),
    at(1, 5, 4, UsartReceive(1)),
    at(1, 5, 5, compare(3, 2)),
    at(1, 6, 2, update(4)),
    at(1, 6, 3, compare(2, 2)),
    at(1, 6, 3, compare(2, 4)),
    at(1, 6, 4, UsartTransmit(1)),
    at(1, 6, 6, update(5)),
    at(1, 7, 2, compare(4, 3)),
    at(1, 7, 3, update(2)),
    at(1, 7, 3, compare(2, 4)),
    at(1, 7, 5, compare(3, 3)),
    at(2, 0, 0, Adc),
    at(2, 0, 3, SpiReceive),
    at(2, 1, 5, UsartReceive(3)),
    at(2, 1, 6, compare(1, 1)),
    at(2, 1, 7, update(8)),
    at(2, 2, 0, compare(8, 1)),
    at(2, 2, 0, compare(8, 2)),
    at(2, 2, 0, compare(8, 3)),
    at(2, 2, 3, SpiReceive),
    at(2, 2, 4, UsartReceive(0)),
    at(2, 2, 5, UsartReceive(3)),
    at(2, 2, 6, compare(1, 2)),
    at(2, 2, 7, compare(8, 1)),
    at(2, 3, 3, SpiTransmit),
    at(2, 3, 6, compare(1, 1)),
    at(2, 3, 7, compare(8, 2)),
    at(2, 4, 0, Adc),
    at(2, 4, 6, compare(1, 4)),
    at(2, 4, 7, compare(8, 3)),
    at(2, 5, 3, SpiTransmit),
    at(2, 5, 4, UsartReceive(0)),
    at(2, 5, 6, update(1)),
    at(2, 6, 0, compare(1, 1)),
    at(2, 6, 0, compare(1, 2)),
    at(2, 6, 0, compare(1, 3)),
    at(2, 6, 5, UsartTransmit(3)),
    at(2, 6, 6, compare(1, 3)),
    at(2, 7, 4, UsartTransmit(0)),
    at(2, 7, 5, UsartTransmit(3)),
    at(2, 7, 7, compare(8, 4)),
];

/// A stream listens to at most so many requests by one channel.
pub(in super::super) type Heard = [Option<Request>; 3];

/// What a stream of a controller, 0 for DMA1, hears by a channel.
pub(super) fn heard(controller: usize, stream: usize, channel: u32) -> Heard {
    let mut heard = [None; 3];
    ARRIVALS
        .iter()
        .filter(|arrival| {
            usize::from(arrival.controller) == controller
                && usize::from(arrival.stream) == stream
                && u32::from(arrival.channel) == channel
        })
        .zip(&mut heard)
        .for_each(|(arrival, place)| *place = Some(arrival.request));
    heard
}
