//! A bus with parts that have registers: the byte behind a part's address for writing says which,
//! and the bytes after it go to that register and those behind it, as do the bytes that are read.
//!
//! A part that was left in the middle of a byte goes on driving the data line until it is clocked
//! through it (I2C-bus specification UM10204, 3.1.16: bus clear).

use crate::board::I2cCondition;
use crate::time::NEVER;

/// A part on the bus.
pub trait Part {
    /// Reads a register.
    fn read(&mut self, now: u64, register: u8) -> u8;
    /// Writes a register.
    fn write(&mut self, now: u64, register: u8, value: u8);
    /// A transfer begins.
    fn begin(&mut self) {}
    /// Its power comes on.
    fn power_on(&mut self, now: u64);
    /// When something will next happen in it.
    fn next_event(&self) -> u64;
}

/// A part at its address.
#[derive(Clone, Debug)]
pub struct Slave<P> {
    address: u8,
    plugged: bool,
    /// The register that comes next; none before it was said.
    register: Option<u8>,
    /// The part.
    pub part: P,
}

impl<P: Part> Slave<P> {
    /// A part that has power.
    pub fn new(address: u8, part: P) -> Self {
        Self {
            address,
            plugged: true,
            register: None,
            part,
        }
    }

    /// Whether it is there.
    pub fn plugged(&self) -> bool {
        self.plugged
    }

    /// Takes it away.
    pub fn unplug(&mut self) {
        self.plugged = false;
    }

    /// Puts it back: its power comes on.
    pub fn plug(&mut self, now: u64) {
        self.plugged = true;
        self.register = None;
        self.part.power_on(now);
    }

    /// When something will next happen in it.
    pub fn next_event(&self) -> u64 {
        if self.plugged {
            self.part.next_event()
        } else {
            NEVER
        }
    }
}

/// What a bus needs of a part, whichever it is.
pub trait Talker {
    /// Whether it answers to an address.
    fn answers(&self, address: u8) -> bool;
    /// Takes a byte: whether it is acknowledged.
    fn take(&mut self, now: u64, byte: u8) -> bool;
    /// Gives the next byte.
    fn give(&mut self, now: u64) -> u8;
    /// It is addressed, for reading or writing.
    fn address(&mut self, to_read: bool);
}

impl<P: Part> Talker for Slave<P> {
    fn answers(&self, address: u8) -> bool {
        self.plugged && self.address == address
    }

    fn take(&mut self, now: u64, byte: u8) -> bool {
        if !self.plugged {
            return false;
        }
        match self.register {
            None => self.register = Some(byte),
            Some(register) => {
                self.part.write(now, register, byte);
                self.register = Some(register.wrapping_add(1));
            }
        }
        true
    }

    fn give(&mut self, now: u64) -> u8 {
        if !self.plugged {
            return 0xFF;
        }
        let register = self.register.unwrap_or(0);
        self.register = Some(register.wrapping_add(1));
        self.part.read(now, register)
    }

    fn address(&mut self, to_read: bool) {
        self.part.begin();
        if !to_read {
            self.register = None;
        }
    }
}

/// What goes on between the master and a part, by the part's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Talk {
    Nothing,
    /// The next byte is an address.
    Address,
    ToPart(usize),
    FromPart(usize),
    /// A part was left in the middle of this byte, so many bits of which have been clocked.
    Left {
        part: usize,
        byte: u8,
        clocks: u32,
    },
    /// A part was left where it acknowledges a byte.
    LeftAcknowledging,
}

/// Clock or data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// SCL.
    Clock,
    /// SDA.
    Data,
}

/// The bus, without its parts.
#[derive(Clone, Debug)]
pub struct Bus {
    talk: Talk,
    /// Lines as the master's pins, as outputs, leave them: clock and data.
    master: [bool; 2],
    /// Lines that something holds low for good.
    shorted: [bool; 2],
}

impl Default for Bus {
    fn default() -> Self {
        Self {
            talk: Talk::Nothing,
            master: [true; 2],
            shorted: [false; 2],
        }
    }
}

impl Bus {
    /// Holds a line low, or lets it go.
    pub fn short(&mut self, line: Line, held: bool) {
        self.shorted[line as usize] = held;
    }

    /// Levels of clock and data, as all but the master leave them.
    pub fn lines(&self) -> [bool; 2] {
        let part_holds = match self.talk {
            Talk::Left { byte, clocks, .. } => clocks < 8 && byte & (0x80 >> clocks) == 0,
            Talk::LeftAcknowledging => true,
            _ => false,
        };
        [!self.shorted[0], !self.shorted[1] && !part_holds]
    }

    /// The master does something else than bytes.
    pub fn condition(&mut self, now: u64, condition: I2cCondition, parts: &mut [&mut dyn Talker]) {
        // The interface drives the lines, and no output does.
        self.master = [true; 2];
        self.talk = match (condition, self.talk) {
            (I2cCondition::Start, _) => Talk::Address,
            (I2cCondition::Stop, _) => Talk::Nothing,
            (I2cCondition::Released { clocks }, Talk::FromPart(part)) => Talk::Left {
                part,
                byte: parts[part].give(now),
                clocks,
            },
            (I2cCondition::Released { clocks: 8 }, Talk::ToPart(_)) => Talk::LeftAcknowledging,
            (I2cCondition::Released { .. }, _) => Talk::Nothing,
        };
    }

    /// The master sends a byte: whether it is acknowledged.
    pub fn send(&mut self, now: u64, byte: u8, parts: &mut [&mut dyn Talker]) -> bool {
        match self.talk {
            Talk::Address => {
                let found = parts.iter().position(|part| part.answers(byte >> 1));
                let to_read = byte & 1 == 1;
                self.talk = match found {
                    Some(part) if to_read => Talk::FromPart(part),
                    Some(part) => Talk::ToPart(part),
                    None => Talk::Nothing,
                };
                if let Some(part) = found {
                    parts[part].address(to_read);
                }
                found.is_some()
            }
            Talk::ToPart(part) => parts[part].take(now, byte),
            _ => false,
        }
    }

    /// The master receives a byte, and acknowledges it or not.
    pub fn receive(&mut self, now: u64, acknowledge: bool, parts: &mut [&mut dyn Talker]) -> u8 {
        let Talk::FromPart(part) = self.talk else {
            return 0xFF;
        };
        if !acknowledge {
            self.talk = Talk::Nothing;
        }
        parts[part].give(now)
    }

    /// A pin of the master drives a line by hand.
    pub fn drive(&mut self, now: u64, line: Line, level: bool, parts: &mut [&mut dyn Talker]) {
        let before = self.levels();
        self.master[line as usize] = level;
        let [clock, data] = self.levels();
        match (before, [clock, data]) {
            ([true, _], [false, _]) => self.clocked(now, parts),
            // Data change while the clock is high: a stop, or a start.
            ([true, false], [true, true]) => self.talk = Talk::Nothing,
            ([true, true], [true, false]) => self.talk = Talk::Address,
            _ => {}
        }
    }

    fn levels(&self) -> [bool; 2] {
        let others = self.lines();
        [self.master[0] && others[0], self.master[1] && others[1]]
    }

    /// The clock falls: a part that was left goes on to its next bit.
    fn clocked(&mut self, now: u64, parts: &mut [&mut dyn Talker]) {
        self.talk = match self.talk {
            Talk::LeftAcknowledging => Talk::Nothing,
            // The ninth clock: nobody acknowledges, unless the data line is held.
            Talk::Left { clocks: 8, .. } if self.levels()[1] => Talk::Nothing,
            Talk::Left { part, clocks: 8, .. } => Talk::Left {
                part,
                byte: parts[part].give(now),
                clocks: 0,
            },
            Talk::Left { part, byte, clocks } => Talk::Left {
                part,
                byte,
                clocks: clocks + 1,
            },
            other => other,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Registers that hold their numbers.
    #[derive(Clone, Debug, Default)]
    struct Numbers {
        written: Vec<(u8, u8)>,
    }

    impl Part for Numbers {
        fn read(&mut self, _: u64, register: u8) -> u8 {
            register
        }
        fn write(&mut self, _: u64, register: u8, value: u8) {
            self.written.push((register, value));
        }
        fn power_on(&mut self, _: u64) {}
        fn next_event(&self) -> u64 {
            NEVER
        }
    }

    struct Hand {
        bus: Bus,
        part: Slave<Numbers>,
    }

    impl Hand {
        fn new() -> Self {
            Self {
                bus: Bus::default(),
                part: Slave::new(0x76, Numbers::default()),
            }
        }
        fn condition(&mut self, condition: I2cCondition) {
            self.bus.condition(0, condition, &mut [&mut self.part]);
        }
        fn send(&mut self, byte: u8) -> bool {
            self.bus.send(0, byte, &mut [&mut self.part])
        }
        fn receive(&mut self, acknowledge: bool) -> u8 {
            self.bus.receive(0, acknowledge, &mut [&mut self.part])
        }
        fn drive(&mut self, line: Line, level: bool) {
            self.bus.drive(0, line, level, &mut [&mut self.part]);
        }
        fn read_from(&mut self, register: u8) {
            self.condition(I2cCondition::Start);
            assert!(self.send(0xEC) && self.send(register));
            self.condition(I2cCondition::Start);
            assert!(self.send(0xED));
        }
        /// Clocks until the data line is high, as a driver clears a bus: how many it took.
        fn clear(&mut self) -> u32 {
            let mut clocks = 0;
            while !self.bus.lines()[1] && clocks < 20 {
                self.drive(Line::Clock, false);
                self.drive(Line::Clock, true);
                clocks += 1;
            }
            clocks
        }
    }

    #[test]
    fn registers_follow_each_other() {
        let mut hand = Hand::new();
        hand.condition(I2cCondition::Start);
        assert!([0xEC, 6, 0x33, 0x80].iter().all(|byte| hand.send(*byte)));
        hand.condition(I2cCondition::Stop);
        assert_eq!(hand.part.part.written, [(6, 0x33), (7, 0x80)]);
        hand.read_from(0xFE);
        assert_eq!(
            [hand.receive(true), hand.receive(true), hand.receive(false)],
            [0xFE, 0xFF, 0]
        );
        assert_eq!(hand.receive(true), 0xFF, "after the last nothing is sent");
    }

    #[test]
    fn nobody_answers_to_another_address_or_unplugged() {
        let mut hand = Hand::new();
        hand.condition(I2cCondition::Start);
        assert!(!hand.send(0x0E << 1));
        hand.read_from(0);
        hand.part.unplug();
        assert_eq!(hand.receive(true), 0xFF, "it is gone in the middle of a transfer");
        hand.condition(I2cCondition::Start);
        assert!(!hand.send(0xEC));
        hand.part.plug(0);
        hand.read_from(3);
    }

    /// Wherever the master lets go, nine clocks at most free the bus.
    #[test]
    fn a_part_that_was_left_is_clocked_free() {
        for register in [0x00, 0x55, 0xFF, 0x7F] {
            for clocks in 0..=8 {
                let mut hand = Hand::new();
                hand.read_from(register);
                hand.condition(I2cCondition::Released { clocks });
                let held = clocks < 8 && register & (0x80 >> clocks) == 0;
                assert_eq!(hand.bus.lines(), [true, !held]);
                let took = hand.clear();
                assert!(took <= 8, "{took}");
                assert!(hand.bus.lines()[1]);
                hand.drive(Line::Data, false);
                hand.drive(Line::Data, true);
                hand.read_from(1);
                assert_eq!(hand.receive(false), 1);
            }
        }
    }

    #[test]
    fn a_part_left_in_its_acknowledgement_lets_go_at_the_next_clock() {
        let mut hand = Hand::new();
        hand.condition(I2cCondition::Start);
        assert!(hand.send(0xEC));
        hand.condition(I2cCondition::Released { clocks: 8 });
        assert_eq!(hand.bus.lines(), [true, false]);
        assert_eq!(hand.clear(), 1);
    }

    #[test]
    fn a_short_is_not_clocked_away() {
        let mut hand = Hand::new();
        hand.bus.short(Line::Data, true);
        assert_eq!(hand.clear(), 20);
        hand.bus.short(Line::Data, false);
        assert_eq!(hand.bus.lines(), [true, true]);
    }
}
