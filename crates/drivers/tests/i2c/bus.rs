//! A bus with one part, whose transfers are counted and can fail.

use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};

/// A part's registers at a time in µs.
pub trait Registers {
    fn address(&self) -> u8;
    fn read(&mut self, now: u64, register: u8) -> u8;
    fn write(&mut self, now: u64, register: u8, value: u8);
    /// Power was away.
    fn power_cycle(&mut self, now: u64);
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    Unplugged,
    /// Lines are held: each transfer ends by time-out.
    Held,
    /// The n-th transfer from now fails, counted down.
    Next(u32),
}

#[derive(Clone, Copy, Debug)]
pub struct Failed(ErrorKind);

impl Error for Failed {
    fn kind(&self) -> ErrorKind {
        self.0
    }
}

pub struct Bus<P> {
    pub part: P,
    pub now: u64,
    pub fault: Option<Fault>,
    pub transfers: u32,
    pub bytes: usize,
}

impl<P: Registers> Bus<P> {
    pub fn new(part: P) -> Self {
        Self {
            part,
            now: 0,
            fault: None,
            transfers: 0,
            bytes: 0,
        }
    }

    /// Polls every ms for a time: what came, and that each call was short.
    pub fn poll<R>(&mut self, us: u64, mut poll: impl FnMut(&mut Self, u64) -> Option<R>) -> Vec<R> {
        let end = self.now + us;
        let mut found = vec![];
        while self.now < end {
            self.now += 1_000;
            let (transfers, bytes) = (self.transfers, self.bytes);
            let now = self.now;
            found.extend(poll(self, now));
            assert!(self.transfers - transfers <= 2 && self.bytes - bytes <= 24);
        }
        found
    }

    fn fails(&mut self) -> Option<Failed> {
        let nobody = Failed(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
        match &mut self.fault {
            None => None,
            Some(Fault::Unplugged) => Some(nobody),
            Some(Fault::Held) => Some(Failed(ErrorKind::Other)),
            Some(Fault::Next(0)) => {
                self.fault = None;
                Some(nobody)
            }
            Some(Fault::Next(count)) => {
                *count -= 1;
                None
            }
        }
    }
}

impl<P> ErrorType for Bus<P> {
    type Error = Failed;
}

impl<P: Registers> I2c for Bus<P> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Failed> {
        self.transfers += 1;
        if let Some(failed) = self.fails() {
            return Err(failed);
        }
        assert_eq!(address, self.part.address());
        let mut register = 0;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    self.bytes += bytes.len();
                    register = bytes[0];
                    for value in &bytes[1..] {
                        self.part.write(self.now, register, *value);
                        register += 1;
                    }
                }
                Operation::Read(bytes) => {
                    self.bytes += bytes.len();
                    for byte in bytes.iter_mut() {
                        *byte = self.part.read(self.now, register);
                        register += 1;
                    }
                }
            }
        }
        Ok(())
    }
}
