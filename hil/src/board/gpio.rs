//! A port of general-purpose input and output (RM0090 8.4).

use super::refusal::{Answer, Refusal, misuse};

const MODER: u32 = 0x00;
const OTYPER: u32 = 0x04;
const OSPEEDR: u32 = 0x08;
const PUPDR: u32 = 0x0C;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const LCKR: u32 = 0x1C;
const AFRL: u32 = 0x20;
const AFRH: u32 = 0x24;

const LCKK: u32 = 1 << 16;

/// The register whose bits that are not written stay untouched instead of being written back.
pub(super) const SET_AND_RESET: u32 = BSRR;

/// Values of two bits in MODER.
const OUTPUT: u32 = 1;
const ALTERNATE: u32 = 2;
const ANALOG: u32 = 3;
/// Values of two bits in PUPDR.
const PULL_UP: u32 = 1;

/// Reset values of MODER, OSPEEDR and PUPDR: ports A and B have the debug pins (RM0090 table 39).
const RESET_VALUES: [[u32; 3]; 3] = [
    [0xA800_0000, 0x0C00_0000, 0x6400_0000],
    [0x0000_0280, 0x0000_00C0, 0x0000_0100],
    [0; 3],
];

pub(super) struct Port {
    mode: u32,
    output_type: u32,
    speed: u32,
    pull: u32,
    output: u32,
    alternate: [u32; 2],
    /// Pins whose configuration is locked.
    locked: u32,
    /// How far the sequence that locks has come, and for which pins.
    lock_sequence: (u8, u32),
    /// Pins by their mode, from MODER.
    outputs: u16,
    analogs: u16,
    pulled_up: u16,
    /// Pins that something outside drives, and to which level.
    driven: u16,
    driven_levels: u16,
    /// Modes or alternate functions were written.
    switched: bool,
    /// Outputs that were told to the wiring, and at which level.
    told: u16,
    told_levels: u16,
}

impl Port {
    /// Port `index`, 0 for A, after a reset.
    pub(super) fn new(index: usize) -> Self {
        let [mode, speed, pull] = RESET_VALUES[index.min(2)];
        let mut port = Self {
            mode,
            output_type: 0,
            speed,
            pull,
            output: 0,
            alternate: [0; 2],
            locked: 0,
            lock_sequence: (0, 0),
            outputs: 0,
            analogs: 0,
            pulled_up: 0,
            driven: 0,
            driven_levels: 0,
            switched: false,
            told: 0,
            told_levels: 0,
        };
        port.sort_pins();
        port
    }

    /// A reset. What is outside goes on driving its pins.
    pub(super) fn reset(&mut self, index: usize) {
        *self = Self {
            driven: self.driven,
            driven_levels: self.driven_levels,
            ..Self::new(index)
        };
    }

    /// Something outside drives a pin from now on.
    pub(super) fn drive(&mut self, pin: u8, level: bool) {
        let bit = 1 << pin;
        self.driven |= bit;
        self.driven_levels = self.driven_levels & !bit | if level { bit } else { 0 };
    }

    /// The alternate function that a pin is switched to.
    pub(super) fn alternate_function(&self, pin: u8) -> Option<u8> {
        let pin = u32::from(pin);
        if (self.mode >> (2 * pin)) & 3 != ALTERNATE {
            return None;
        }
        Some((self.alternate[pin as usize / 8] >> (4 * (pin % 8)) & 0xF) as u8)
    }

    /// Whether a pin drives only low, where it drives.
    pub(super) fn is_open_drain(&self, pin: u8) -> bool {
        self.output_type & (1 << pin) != 0
    }

    /// Whether a pin is analogue.
    pub(super) fn is_analogue(&self, pin: u8) -> bool {
        self.analogs & (1 << pin) != 0
    }

    /// The levels of the pins, as IDR shows them. A pin that nothing drives or pulls is low.
    pub(super) fn levels(&self) -> u16 {
        let (output, open_drain) = (self.output as u16, self.output_type as u16);
        let pushed = self.outputs & !open_drain;
        let drained = self.outputs & open_drain & !output;
        let outside = self.driven & self.driven_levels | !self.driven & self.pulled_up;
        (pushed & output | !pushed & outside) & !drained & !self.analogs
    }

    /// Outputs whose level the wiring does not know yet, and the levels of all.
    pub(super) fn take_changed_outputs(&mut self) -> (u16, u16) {
        let levels = self.output as u16;
        let changed = self.outputs & (!self.told | (levels ^ self.told_levels));
        self.told = self.outputs;
        self.told_levels = levels;
        (changed, levels)
    }

    /// Whether pins may have been switched since this was asked last.
    pub(super) fn take_switched(&mut self) -> bool {
        std::mem::take(&mut self.switched)
    }

    pub(super) fn read(&mut self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            MODER => self.mode,
            OTYPER => self.output_type,
            OSPEEDR => self.speed,
            PUPDR => self.pull,
            IDR => u32::from(self.levels()),
            ODR => self.output,
            BSRR => 0,
            LCKR => self.read_lock(),
            AFRL => self.alternate[0],
            AFRH => self.alternate[1],
            _ => return Err(Refusal::Unknown),
        })
    }

    pub(super) fn write(&mut self, offset: u32, value: u32) -> Answer<()> {
        match offset {
            MODER => set(&mut self.mode, value, spread(self.locked, 2))?,
            OTYPER => set(&mut self.output_type, value & 0xFFFF, self.locked)?,
            OSPEEDR => set(&mut self.speed, value, spread(self.locked, 2))?,
            PUPDR => set(&mut self.pull, value, spread(self.locked, 2))?,
            IDR => return misuse("IDR can only be read"),
            ODR => self.output = value & 0xFFFF,
            // Where a bit is both set and reset, set has priority.
            BSRR => self.output = self.output & !(value >> 16) | value & 0xFFFF,
            LCKR => self.write_lock(value),
            AFRL => set(&mut self.alternate[0], value, spread(self.locked & 0xFF, 4))?,
            AFRH => set(&mut self.alternate[1], value, spread(self.locked >> 8, 4))?,
            _ => return Err(Refusal::Unknown),
        }
        if matches!(offset, MODER | PUPDR) {
            self.sort_pins();
        }
        self.switched |= matches!(offset, MODER | AFRL | AFRH);
        Ok(())
    }

    fn sort_pins(&mut self) {
        self.outputs = pins_with(self.mode, OUTPUT);
        self.analogs = pins_with(self.mode, ANALOG);
        self.pulled_up = pins_with(self.pull, PULL_UP);
    }

    fn read_lock(&mut self) -> u32 {
        if let (3, pins) = self.lock_sequence {
            self.locked = pins;
            self.lock_sequence = (0, 0);
        }
        self.locked | if self.locked == 0 { 0 } else { LCKK }
    }

    /// Three writes of the same pins, with the key 1, 0, 1, and a read (RM0090 8.4.8).
    fn write_lock(&mut self, value: u32) {
        if self.locked != 0 {
            return;
        }
        let (key, pins) = (value & LCKK != 0, value & 0xFFFF);
        self.lock_sequence = match (self.lock_sequence, key) {
            ((1, before), false) if before == pins => (2, pins),
            ((2, before), true) if before == pins => (3, pins),
            (_, true) => (1, pins),
            (_, false) => (0, 0),
        };
    }
}

/// Writes a configuration, of which the locked bits must stay.
fn set(register: &mut u32, value: u32, locked: u32) -> Answer<()> {
    if (*register ^ value) & locked != 0 {
        return misuse("the configuration of a locked pin is changed");
    }
    *register = value;
    Ok(())
}

/// The pins whose two bits have a value.
fn pins_with(register: u32, value: u32) -> u16 {
    (0..16).fold(0, |pins, pin| {
        let there = (register >> (2 * pin)) & 3 == value;
        pins | u16::from(there) << pin
    })
}

/// A bit for each pin, widened to `width` bits for each.
fn spread(pins: u32, width: u32) -> u32 {
    if pins == 0 {
        return 0;
    }
    (0..32 / width)
        .filter(|pin| pins & (1 << pin) != 0)
        .fold(0, |bits, pin| bits | ((1 << width) - 1) << (width * pin))
}
