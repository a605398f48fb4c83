//! A DMA controller (RM0090 chapter 10): eight streams, their registers and interrupts.

pub(super) mod requests;
mod setup;
mod stream;

use super::Memory;
use super::refusal::{Answer, Refusal, misuse};
use requests::Request;
use stream::Stream;

const LISR: u32 = 0x00;
const HISR: u32 = 0x04;
const LIFCR: u32 = 0x08;
const HIFCR: u32 = 0x0C;
/// The streams' registers begin here, and are so far apart.
const STREAMS: u32 = 0x10;
const STREAM_SPAN: u32 = 0x18;

/// Within a stream.
const CR: u32 = 0x00;
const NDTR: u32 = 0x04;
const PAR: u32 = 0x08;
const M0AR: u32 = 0x0C;
const M1AR: u32 = 0x10;
const FCR: u32 = 0x14;

/// Where the flags of the four streams of LISR and HISR begin.
const FLAG_SHIFTS: [u32; 4] = [0, 6, 16, 22];
/// The flags of one stream.
const FLAGS: u32 = 0x3D;

/// Interrupts of the streams of both controllers.
const INTERRUPTS: [[u32; 8]; 2] = [[11, 12, 13, 14, 15, 16, 17, 47], [56, 57, 58, 59, 60, 68, 69, 70]];

pub(super) struct Dma {
    /// 0 for DMA1.
    index: usize,
    streams: [Stream; 8],
    /// Streams that are enabled, as bits.
    enabled: u8,
}

impl Dma {
    pub(super) fn new(index: usize) -> Self {
        Self {
            index,
            streams: [Stream::new(); 8],
            enabled: 0,
        }
    }

    /// Its request lines, a bit for each interrupt.
    pub(super) fn interrupts(&self) -> u128 {
        let mut lines = 0;
        for (stream, interrupt) in self.streams.iter().zip(INTERRUPTS[self.index]) {
            lines |= u128::from(stream.interrupt()) << interrupt;
        }
        lines
    }

    /// The stream to serve next, and the request that it serves: by priority, then by number.
    pub(super) fn next_transfer(&self, is_high: impl Fn(Request) -> bool) -> Option<(usize, Request)> {
        let mut best: Option<(usize, Request)> = None;
        let mut remaining = self.enabled;
        while remaining != 0 {
            let index = remaining.trailing_zeros() as usize;
            remaining &= remaining - 1;
            let stream = &self.streams[index];
            let first = best.is_none_or(|(other, _)| stream.priority() > self.streams[other].priority());
            if !first {
                continue;
            }
            let high = stream.heard.iter().flatten().find(|request| is_high(**request));
            best = high.map(|request| (index, *request)).or(best);
        }
        best
    }

    /// How many items the stream that serves a request can take before the one with which it sets a
    /// flag; none for a request that no stream serves.
    pub(super) fn silent_items(&self, request: Request) -> u32 {
        let serves = |stream: &&Stream| stream.enabled() && stream.heard.contains(&Some(request));
        let stream = self.streams.iter().find(serves);
        stream.map_or(0, Stream::silent_items)
    }

    /// Whether a stream takes data to its peripheral.
    pub(super) fn transmits(&self, stream: usize) -> bool {
        self.streams[stream].transmits()
    }

    /// The next data of a stream for its peripheral, and the register for them.
    pub(super) fn take(&mut self, stream: usize, memory: &mut dyn Memory) -> Answer<(u32, u32)> {
        let taken = self.streams[stream].take(memory);
        self.note_enabled(stream);
        named(stream, taken)
    }

    /// The register of its peripheral that a stream reads next.
    pub(super) fn source(&self, stream: usize) -> u32 {
        self.streams[stream].source()
    }

    /// Gives a stream data from its peripheral.
    pub(super) fn put(&mut self, stream: usize, value: u32, memory: &mut dyn Memory) -> Answer<()> {
        let put = self.streams[stream].put(value, memory);
        self.note_enabled(stream);
        named(stream, put)
    }

    fn note_enabled(&mut self, index: usize) {
        let enabled = u8::from(self.streams[index].enabled());
        self.enabled = self.enabled & !(1 << index) | enabled << index;
    }

    pub(super) fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            LISR => return Ok(self.flags(0)),
            HISR => return Ok(self.flags(4)),
            LIFCR | HIFCR => return Ok(0),
            _ => {}
        }
        let (index, register) = locate(offset)?;
        let stream = &self.streams[index];
        Ok(match register {
            CR => stream.control,
            NDTR => stream.left,
            PAR => stream.peripheral,
            M0AR => stream.memories[0],
            M1AR => stream.memories[1],
            FCR => stream.fifo_status(),
            _ => return Err(Refusal::Unknown),
        })
    }

    pub(super) fn write(&mut self, offset: u32, value: u32, memory: &mut dyn Memory) -> Answer<()> {
        match offset {
            LISR | HISR => return misuse("LISR and HISR can only be read"),
            LIFCR => self.clear(0, value),
            HIFCR => self.clear(4, value),
            _ => {
                let (index, register) = locate(offset)?;
                named(index, self.write_stream(index, register, value, memory))?;
                self.note_enabled(index);
            }
        }
        Ok(())
    }

    fn write_stream(
        &mut self,
        index: usize,
        register: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Answer<()> {
        let stream = &mut self.streams[index];
        if register == CR {
            return stream.write_control(self.index, index, value, memory);
        }
        if stream.enabled() {
            return misuse("its registers are written while it is enabled");
        }
        match register {
            NDTR => stream.write_count(value),
            PAR => stream.peripheral = value,
            M0AR => stream.memories[0] = value,
            M1AR => stream.memories[1] = value,
            FCR => stream.write_fifo_control(value),
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }

    fn flags(&self, first: usize) -> u32 {
        FLAG_SHIFTS
            .iter()
            .zip(&self.streams[first..])
            .fold(0, |flags, (shift, stream)| flags | stream.flags << shift)
    }

    fn clear(&mut self, first: usize, value: u32) {
        for (shift, stream) in FLAG_SHIFTS.iter().zip(&mut self.streams[first..]) {
            stream.flags &= !(value >> shift & FLAGS);
        }
    }
}

/// The stream and its register at an offset.
fn locate(offset: u32) -> Answer<(usize, u32)> {
    let place = offset - STREAMS;
    let index = (place / STREAM_SPAN) as usize;
    if index < 8 && place.is_multiple_of(4) {
        Ok((index, place % STREAM_SPAN))
    } else {
        Err(Refusal::Unknown)
    }
}

/// Says which stream was refused something.
fn named<T>(stream: usize, answer: Answer<T>) -> Answer<T> {
    answer.map_err(|refusal| match refusal {
        Refusal::Misuse(what) => Refusal::Misuse(format!("stream {stream}: {what}")),
        Refusal::Unknown => Refusal::Unknown,
    })
}
