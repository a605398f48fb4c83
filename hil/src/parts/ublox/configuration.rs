//! What a receiver was told: rate of its line, what it sends, how often it measures.

use crate::time::SECOND;

/// Numbers of messages of configuration.
pub(super) const VALSET: u8 = 0x8A;
const PRT: u8 = 0x00;
const MSG: u8 = 0x01;
const RATE: u8 = 0x08;
const CFG: u8 = 0x09;
const NAV5: u8 = 0x24;

/// Keys of values (u-blox M10, interface description: configuration reference).
const UART1_BAUDRATE: u32 = 0x4052_0001;
const UART1OUTPROT_UBX: u32 = 0x1074_0001;
const UART1OUTPROT_NMEA: u32 = 0x1074_0002;
const RATE_MEAS: u32 = 0x3021_0001;
const RATE_NAV: u32 = 0x3021_0002;
const MSGOUT_NAV_PVT_UART1: u32 = 0x2091_0007;
/// Of sentences, in the order of their numbers.
const MSGOUT_NMEA_UART1: [u32; 6] = [
    0x2091_00BB,
    0x2091_00CA,
    0x2091_00C0,
    0x2091_00C5,
    0x2091_00AC,
    0x2091_00B1,
];
/// Groups of keys that are taken without an effect here: navigation, other messages, signals,
/// serial ports and their protocols.
const TAKEN: [u32; 7] = [0x11, 0x31, 0x51, 0x52, 0x73, 0x74, 0x91];

/// The fastest and slowest rates of measuring, in ms.
const PERIODS: std::ops::RangeInclusive<u16> = 25..=65_535;

#[derive(Clone, Debug)]
pub(super) struct Configuration {
    baud: u64,
    /// From one measurement to the next, in ms.
    period: u16,
    /// Every how many measurements there is a solution.
    solution: u16,
    ubx: bool,
    nmea: bool,
    /// Every how many solutions NAV-PVT is sent; 0 for never.
    pvt: u8,
    sentences: [u8; 6],
}

impl Configuration {
    pub(super) fn new(baud: u64) -> Self {
        Self {
            baud,
            period: 1000,
            solution: 1,
            ubx: true,
            nmea: true,
            pvt: 0,
            sentences: [1; 6],
        }
    }

    pub(super) fn baud(&self) -> u64 {
        self.baud
    }

    /// From one measurement to the next, in ticks.
    pub(super) fn period(&self) -> u64 {
        u64::from(self.period) * SECOND / 1000
    }

    /// Whether the measurement of this number is reported.
    pub(super) fn reports(&self, epoch: u64) -> bool {
        let every = u64::from(self.solution) * u64::from(self.pvt);
        self.ubx && every > 0 && epoch.is_multiple_of(every)
    }

    /// Whether a sentence is spoken.
    pub(super) fn speaks(&self, number: u8) -> bool {
        self.nmea && self.sentences[usize::from(number)] > 0
    }

    /// CFG-VALSET: all of its values, or none.
    pub(super) fn set_values(&mut self, payload: &[u8]) -> Option<()> {
        let ([_version, _layers, _, _], mut rest) = payload.split_first_chunk()?;
        let mut changed = self.clone();
        while let Some((key, behind)) = rest.split_first_chunk() {
            let key = u32::from_le_bytes(*key);
            let size = match key >> 28 {
                1 | 2 => 1,
                3 => 2,
                4 => 4,
                5 => 8,
                _ => return None,
            };
            let value = behind.get(..size)?;
            let value = value
                .iter()
                .rev()
                .fold(0, |all, byte| all << 8 | u64::from(*byte));
            changed.set_value(key, value)?;
            rest = &behind[size..];
        }
        if !rest.is_empty() {
            return None;
        }
        *self = changed;
        Some(())
    }

    fn set_value(&mut self, key: u32, value: u64) -> Option<()> {
        match key {
            UART1_BAUDRATE => self.set_baud(value)?,
            UART1OUTPROT_UBX => self.ubx = value == 1,
            UART1OUTPROT_NMEA => self.nmea = value == 1,
            RATE_MEAS => self.set_period(value as u16)?,
            RATE_NAV => self.set_solution(value as u16)?,
            MSGOUT_NAV_PVT_UART1 => self.pvt = value as u8,
            _ => {
                let sentence = MSGOUT_NMEA_UART1.iter().position(|known| *known == key);
                match sentence {
                    Some(sentence) => self.sentences[sentence] = value as u8,
                    None => return TAKEN.contains(&(key >> 16 & 0xFF)).then_some(()),
                }
            }
        }
        Some(())
    }

    fn set_baud(&mut self, baud: u64) -> Option<()> {
        self.baud = (4_800..=921_600).contains(&baud).then_some(baud)?;
        Some(())
    }

    fn set_period(&mut self, period: u16) -> Option<()> {
        self.period = PERIODS.contains(&period).then_some(period)?;
        Some(())
    }

    fn set_solution(&mut self, solution: u16) -> Option<()> {
        self.solution = (1..=127).contains(&solution).then_some(solution)?;
        Some(())
    }

    /// A message of configuration as M8 and before had them.
    pub(super) fn set(&mut self, number: u8, payload: &[u8]) -> Option<()> {
        let half = |place: usize| {
            Some(u16::from_le_bytes([
                *payload.get(place)?,
                *payload.get(place + 1)?,
            ]))
        };
        match (number, payload.len()) {
            // Only of port 1, in 8N1; masks of what comes in and goes out: UBX, NMEA.
            (PRT, 20) if payload[0] == 1 => {
                let word = |place| Some(u32::from(half(place)?) | u32::from(half(place + 2)?) << 16);
                const EIGHT_WITHOUT_PARITY: u32 = 0x8C0;
                if word(4)? & 0x3EC0 != EIGHT_WITHOUT_PARITY || half(12)? & 1 == 0 {
                    return None;
                }
                self.ubx = half(14)? & 1 != 0;
                self.nmea = half(14)? & 2 != 0;
                self.set_baud(word(8)?.into())
            }
            (MSG, 3) => self.set_message(payload[0], payload[1], payload[2]),
            // One rate a port: I2C, UART1, and so on.
            (MSG, 8) => self.set_message(payload[0], payload[1], payload[3]),
            (RATE, 6) => {
                self.set_period(half(0)?)?;
                self.set_solution(half(2)?)
            }
            (NAV5, 36) | (CFG, 12 | 13) => Some(()),
            _ => None,
        }
    }

    fn set_message(&mut self, class: u8, number: u8, rate: u8) -> Option<()> {
        match (class, number) {
            (0x01, 0x07) => self.pvt = rate,
            (0xF0, 0..6) => self.sentences[usize::from(number)] = rate,
            // Messages that it does not send anyway.
            (0x01 | 0x0A | 0xF0 | 0xF1, _) if rate == 0 => {}
            _ => return None,
        }
        Some(())
    }
}
