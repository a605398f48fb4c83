//! The driver's bus, pin and delay on the register model of the part.

use std::cell::RefCell;
use std::convert::Infallible;
use std::future::{Future, pending};
use std::pin::pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};

use embedded_hal::digital::{ErrorType as PinError, OutputPin};
use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::spi::{Error, ErrorKind, ErrorType, SpiBus};
use windhover_drivers::icm42688p::Icm42688p;
use windhover_model::sensor::icm42688p as model;

/// What a byte takes on a bus of 1 MHz, in ns.
const BYTE_NS: u64 = 8_000;

/// A microsecond and a millisecond in ns.
pub const US: u64 = 1_000;
pub const MS: u64 = 1_000_000;

/// What the bus may say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun;

impl Error for Overrun {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Overrun
    }
}

/// Part, time, and what was done.
#[derive(Debug)]
pub struct Desk {
    pub part: model::Icm42688p,
    pub now: u64,
    pub measured: model::Measurement,
    /// Times at which INT1 rose.
    pub rises: Vec<u64>,
    /// Bytes of the transfers since the last look.
    pub transfers: Vec<usize>,
    pub selected: bool,
    /// Transfers until the bus fails once.
    pub fails_after: Option<usize>,
    /// Transfers until the bus hangs, and how many bytes of the next one it still sends.
    pub hangs_after: Option<(usize, usize)>,
    /// Writes to this address are lost.
    pub loses: Option<u8>,
}

impl Desk {
    pub fn wait(&mut self, ns: u64) {
        self.now += ns;
        while let Some(event) = self.part.advance(self.now) {
            match event {
                model::Event::Sample { .. } => self.part.put(&self.measured),
                model::Event::Int1 { time, level: true } => self.rises.push(time),
                model::Event::Int1 { .. } => {}
            }
        }
    }

    /// Whether the bus hangs in this transfer; what it still sends is sent.
    fn hangs(&mut self, words: &[u8]) -> bool {
        match &mut self.hangs_after {
            Some((0, bytes)) => {
                for word in words.iter().take(*bytes) {
                    self.part.exchange(self.now, *word);
                }
                true
            }
            Some((transfers, _)) => {
                *transfers -= 1;
                false
            }
            None => false,
        }
    }

    /// A transaction that the driver does not make.
    pub fn transaction(&mut self, mosi: [u8; 2]) {
        self.part.select();
        for byte in mosi {
            self.part.exchange(self.now, byte);
        }
        self.part.deselect();
    }
}

/// A handle on the desk: bus and delay at once.
#[derive(Clone, Debug)]
pub struct Handle(pub Rc<RefCell<Desk>>);

/// The chip select.
#[derive(Clone, Debug)]
pub struct Select(Handle);

pub type Driver = Icm42688p<Handle, Select>;

/// A part at its power-on, and a driver for it.
pub fn bench() -> (Handle, Driver) {
    let handle = Handle(Rc::new(RefCell::new(Desk {
        part: model::Icm42688p::new(US),
        now: 0,
        measured: model::Measurement {
            accel: [1, -2, 2048],
            gyro: [-4, 500, -32_767],
            temperature: 1325,
        },
        rises: vec![],
        transfers: vec![],
        selected: false,
        fails_after: None,
        hangs_after: None,
        loses: None,
    })));
    let driver = Icm42688p::new(handle.clone(), Select(handle.clone()));
    (handle, driver)
}

/// Runs a call to its end.
pub fn run<F: Future>(call: F) -> F::Output {
    let mut call = pin!(call);
    for _ in 0..1_000_000 {
        if let Some(output) = poll_once(call.as_mut()) {
            return output;
        }
    }
    panic!("the call does not end");
}

/// Polls a call once.
pub fn poll_once<F: Future>(call: std::pin::Pin<&mut F>) -> Option<F::Output> {
    match call.poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => Some(output),
        Poll::Pending => None,
    }
}

impl ErrorType for Handle {
    type Error = Overrun;
}

impl SpiBus for Handle {
    async fn read(&mut self, _: &mut [u8]) -> Result<(), Overrun> {
        unreachable!("the driver transfers in place");
    }

    async fn write(&mut self, _: &[u8]) -> Result<(), Overrun> {
        unreachable!("the driver transfers in place");
    }

    async fn transfer(&mut self, _: &mut [u8], _: &[u8]) -> Result<(), Overrun> {
        unreachable!("the driver transfers in place");
    }

    async fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Overrun> {
        let hangs = self.0.borrow_mut().hangs(words);
        if hangs {
            pending::<()>().await;
        }
        let desk = &mut *self.0.borrow_mut();
        assert!(desk.selected, "bytes without chip select");
        desk.transfers.push(words.len());
        if let Some(left) = &mut desk.fails_after {
            if *left == 0 {
                desk.fails_after = None;
                return Err(Overrun);
            }
            *left -= 1;
        }
        let lost = desk.loses == Some(words[0]);
        for word in words {
            desk.wait(BYTE_NS);
            if !lost {
                *word = desk.part.exchange(desk.now, *word);
            }
        }
        Ok(())
    }

    async fn flush(&mut self) -> Result<(), Overrun> {
        Ok(())
    }
}

impl PinError for Select {
    type Error = Infallible;
}

impl OutputPin for Select {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let desk = &mut *self.0.0.borrow_mut();
        assert!(!desk.selected, "selected twice");
        desk.selected = true;
        desk.part.select();
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        let desk = &mut *self.0.0.borrow_mut();
        desk.selected = false;
        desk.part.deselect();
        Ok(())
    }
}

impl DelayNs for Handle {
    async fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().wait(u64::from(ns));
    }
}
