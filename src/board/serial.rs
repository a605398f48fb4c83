//! Serial ports that receive by DMA, round and round a buffer.
//!
//! A byte costs the processor nothing until somebody asks what came, so that a port on which something
//! babbles takes no time from the loops. The HAL's own ring stops at the first framing error and
//! begins anew at a wrong place of its buffer; this one never stops.

use embassy_stm32::dma::{Channel, ReadableRingBuffer, TransferOptions};
use embassy_stm32::mode::Async;
use embassy_stm32::pac::usart::Usart;
use embassy_stm32::usart::{self, ConfigError, UartRx};

/// What [`SerialReceiver::take`] found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Taken {
    /// Bytes, the oldest first.
    pub count: usize,
    /// Some of them, or others that were lost, did not arrive as they were sent.
    pub faulty: bool,
}

/// The receiving half of a port.
pub struct SerialReceiver {
    /// Its registers are used besides; this is who keeps it running.
    half: UartRx<'static, Async>,
    port: Usart,
    ring: ReadableRingBuffer<'static, u8>,
}

impl SerialReceiver {
    /// Receives from now on into `buffer`. `channel` is the one that `half` was made with, and
    /// `request` its number for the port (RM0090, table 42).
    pub fn new(
        half: UartRx<'static, Async>,
        port: Usart,
        channel: Channel<'static>,
        request: u8,
        buffer: &'static mut [u8],
    ) -> Self {
        let from = port.dr().as_ptr().cast::<u8>();
        // SAFETY: `half` is never read, so that nobody else uses the channel; the data register is
        // there for ever, and a byte of it may be read at any time.
        let mut ring =
            unsafe { ReadableRingBuffer::new(channel, request, from, buffer, TransferOptions::default()) };
        ring.start();
        port.cr3().modify(|control| control.set_dmar(true));
        Self { half, port, ring }
    }

    /// What came and was not taken yet, as much as fits. Never waits. More than the buffer holds is
    /// lost, all of it.
    pub fn take(&mut self, bytes: &mut [u8]) -> Taken {
        let status = self.port.sr().read();
        match self.ring.read(bytes) {
            // The flags are of the last byte that came; the next one clears them.
            Ok((count, _)) => Taken {
                count,
                faulty: count > 0 && (status.pe() || status.fe() || status.ne() || status.ore()),
            },
            Err(_) => {
                self.ring.clear();
                Taken {
                    count: 0,
                    faulty: true,
                }
            }
        }
    }

    /// Receives otherwise from now on; what came before is dropped.
    ///
    /// # Errors
    /// A rate that the port cannot make.
    pub fn set_line(&mut self, line: &usart::Config) -> Result<(), ConfigError> {
        self.half.set_config(line)?;
        self.ring.clear();
        Ok(())
    }
}

/// A line of 8 bits, no parity, one stop bit.
pub fn baud(rate: u32) -> usart::Config {
    let mut config = usart::Config::default();
    config.baudrate = rate;
    config
}
