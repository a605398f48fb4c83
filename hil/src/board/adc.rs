//! The converter ADC1 (RM0090 chapter 13) as it is used: a sequence of pins, started by software,
//! once or again and again, read by the processor or by DMA.
//!
//! While DMA fetches the data, conversions are done when somebody looks or a stream has something
//! to say, not each at its own time: nobody can tell the difference, and the emulator has little
//! to do.

use super::refusal::{Answer, Refusal, misuse};
use super::wiring::Pin;
use crate::time::{MICROSECOND, NEVER, SECOND};

const SR: u32 = 0x00;
const CR1: u32 = 0x04;
const CR2: u32 = 0x08;
const SMPR1: u32 = 0x0C;
const SMPR2: u32 = 0x10;
const SQR1: u32 = 0x2C;
const SQR3: u32 = 0x34;
const DR: u32 = 0x4C;
const CCR: u32 = 0x304;

/// Its data register, for DMA.
pub(super) const DATA: u32 = 0x4001_2000 + DR;
pub(super) const INTERRUPT: u32 = 18;

const SR_EOC: u32 = 1 << 1;
const SR_STRT: u32 = 1 << 4;
const SR_OVR: u32 = 1 << 5;

const CR1_EOCIE: u32 = 1 << 5;
const CR1_SCAN: u32 = 1 << 8;
const CR1_RES_SHIFT: u32 = 24;
const CR1_OVRIE: u32 = 1 << 26;
const CR1_MODELLED: u32 = CR1_EOCIE | CR1_SCAN | 3 << CR1_RES_SHIFT | CR1_OVRIE;

const CR2_ADON: u32 = 1 << 0;
const CR2_CONT: u32 = 1 << 1;
const CR2_DMA: u32 = 1 << 8;
const CR2_DDS: u32 = 1 << 9;
const CR2_EOCS: u32 = 1 << 10;
const CR2_SWSTART: u32 = 1 << 30;
const CR2_MODELLED: u32 = CR2_ADON | CR2_CONT | CR2_DMA | CR2_DDS | CR2_EOCS | CR2_SWSTART;

const CCR_ADCPRE_SHIFT: u32 = 16;
const CCR_MODELLED: u32 = 3 << CCR_ADCPRE_SHIFT;

/// From ADON to the first conversion (datasheet table 67, tSTAB).
const STABILISATION: u64 = 3 * MICROSECOND;
/// The fastest clock (datasheet table 67).
const FASTEST: u64 = 36_000_000;
/// Cycles of sampling by SMP (RM0090 13.13.4).
const SAMPLING: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];

pub(super) struct Adc {
    status: u32,
    control: u32,
    control_2: u32,
    sampling: [u32; 2],
    sequence: [u32; 3],
    common: u32,
    data: u32,
    /// Place in the sequence of the conversion under way.
    place: u32,
    /// When it will be done.
    due: u64,
    /// From when on it can convert.
    stable: u64,
    /// Ticks in a cycle of its bus.
    cycle: u64,
}

impl Adc {
    pub(super) fn new() -> Self {
        Self {
            status: 0,
            control: 0,
            control_2: 0,
            sampling: [0; 2],
            sequence: [0; 3],
            common: 0,
            data: 0,
            place: 0,
            due: NEVER,
            stable: 0,
            cycle: 0,
        }
    }

    pub(super) fn set_cycle(&mut self, cycle: u64) {
        self.cycle = cycle;
    }

    pub(super) fn interrupt(&self) -> bool {
        [(CR1_EOCIE, SR_EOC), (CR1_OVRIE, SR_OVR)]
            .iter()
            .any(|(enable, flag)| self.control & enable != 0 && self.status & flag != 0)
    }

    /// Whether it asks the DMA controller to fetch a result.
    pub(super) fn offers(&self) -> bool {
        self.control_2 & CR2_DMA != 0 && self.status & (SR_EOC | SR_OVR) == SR_EOC
    }

    /// When somebody has to know of a conversion: of the next, or of the last of so many that a
    /// stream can take without anything to say.
    pub(super) fn next_event(&self, silent: u32) -> u64 {
        if self.due == NEVER {
            return NEVER;
        }
        let length = self.last() + 1;
        let times = |count| (1..=count).map(|n| self.conversion_time((self.place + n) % length));
        let rounds: u64 = times(length).sum::<u64>() * u64::from(silent / length);
        self.due + rounds + times(silent % length).sum::<u64>()
    }

    /// The conversion that is done by now: when it was, and of which channel.
    pub(super) fn done(&self, now: u64) -> Option<(u64, u32)> {
        (self.due <= now).then(|| (self.due, self.channel(self.place)))
    }

    /// The result of the conversion that is done, in 12 bits.
    pub(super) fn finish(&mut self, counts: u16) {
        let dma = self.control_2 & CR2_DMA != 0;
        let last = self.place == self.last();
        let each = dma || self.control_2 & CR2_EOCS != 0;
        if each && self.status & SR_EOC != 0 {
            // Who does not read in time stops it (RM0090 13.8.1).
            self.status |= SR_OVR;
            self.due = NEVER;
            return;
        }
        self.data = u32::from(counts & 0xFFF) >> (2 * (self.control >> CR1_RES_SHIFT & 3));
        if each || last {
            self.status |= SR_EOC;
        }
        self.place = if last { 0 } else { self.place + 1 };
        if last && self.control_2 & CR2_CONT == 0 {
            self.due = NEVER;
        } else {
            self.due += self.conversion_time(self.place);
        }
    }

    /// Last place in the sequence.
    fn last(&self) -> u32 {
        self.sequence[0] >> 20 & 0xF
    }

    /// The channel at a place of the sequence, the first of which lies in SQR3.
    fn channel(&self, place: u32) -> u32 {
        let register = self.sequence[2 - place as usize / 6];
        register >> (5 * (place % 6)) & 0x1F
    }

    fn conversion_time(&self, place: u32) -> u64 {
        let channel = self.channel(place);
        let (register, shift) = if channel >= 10 {
            (0, 3 * (channel - 10))
        } else {
            (1, 3 * channel)
        };
        let sampling = SAMPLING[(self.sampling[register] >> shift & 7) as usize];
        let bits = 12 - 2 * u64::from(self.control >> CR1_RES_SHIFT & 3);
        (sampling + bits) * self.clock()
    }

    /// Ticks in a cycle of its own clock.
    fn clock(&self) -> u64 {
        2 * (1 + u64::from(self.common >> CCR_ADCPRE_SHIFT & 3)) * self.cycle
    }

    pub(super) fn read(&mut self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            SR => self.status,
            CR1 => self.control,
            CR2 => self.control_2,
            SMPR1 | SMPR2 => self.sampling[((offset - SMPR1) / 4) as usize],
            SQR1..=SQR3 => self.sequence[((offset - SQR1) / 4) as usize],
            DR => self.read_data(),
            CCR => self.common,
            _ => return Err(Refusal::Unknown),
        })
    }

    /// The result of the last conversion.
    pub(super) fn read_data(&mut self) -> u32 {
        self.status &= !SR_EOC;
        self.data
    }

    pub(super) fn write(&mut self, now: u64, offset: u32, value: u32) -> Answer<()> {
        match offset {
            SR => self.status &= value,
            CR1 if value & !CR1_MODELLED != 0 => {
                return misuse("injected and discontinuous conversions and the watchdog are not modelled");
            }
            CR1 => self.control = value,
            CR2 if value & !CR2_MODELLED != 0 => {
                return misuse("triggers, injected conversions and alignment to the left are not modelled");
            }
            CR2 => return self.write_control_2(now, value),
            SMPR1 | SMPR2 => self.sampling[((offset - SMPR1) / 4) as usize] = value & 0x3FFF_FFFF,
            SQR1..=SQR3 => self.sequence[((offset - SQR1) / 4) as usize] = value & 0x3FFF_FFFF,
            DR => return misuse("DR can only be read"),
            CCR if value & !CCR_MODELLED != 0 => {
                return misuse("several converters at once and inner channels are not modelled");
            }
            CCR => self.common = value,
            _ => return Err(Refusal::Unknown),
        }
        Ok(())
    }

    fn write_control_2(&mut self, now: u64, value: u32) -> Answer<()> {
        if value & !self.control_2 & CR2_ADON != 0 {
            self.stable = now + STABILISATION;
        }
        self.control_2 = value & !CR2_SWSTART;
        if value & CR2_ADON == 0 {
            self.due = NEVER;
            self.place = 0;
        }
        if value & CR2_SWSTART == 0 {
            return Ok(());
        }
        self.check_start(value)?;
        if self.due == NEVER && self.status & SR_OVR == 0 {
            self.status |= SR_STRT;
            self.place = 0;
            self.due = now.max(self.stable) + self.conversion_time(0);
        }
        Ok(())
    }

    fn check_start(&self, value: u32) -> Answer<()> {
        if value & CR2_ADON == 0 {
            return misuse("SWSTART is set while it is off");
        }
        if value & (CR2_DMA | CR2_DDS) == CR2_DMA {
            return misuse("DMA without DDS is not modelled");
        }
        if self.last() > 0 && self.control & CR1_SCAN == 0 {
            return misuse("a sequence of several needs SCAN");
        }
        if self.clock() * FASTEST < SECOND {
            return misuse(format!("its clock is faster than {FASTEST} Hz"));
        }
        Ok(())
    }
}

/// The pin of a channel (datasheet table 6); none for those inside.
pub(super) fn pin(channel: u32) -> Option<Pin> {
    let number = channel as u8;
    match number {
        0..=7 => Some(Pin::new('A', number)),
        8..=9 => Some(Pin::new('B', number - 8)),
        10..=15 => Some(Pin::new('C', number - 10)),
        _ => None,
    }
}
