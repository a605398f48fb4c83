//! The inertial measurement unit TDK ICM-42688-P on SPI (data sheet DS-000347 rev. 1.7).
//!
//! [`Icm42688p::configure`] resets the part, checks its identity, writes the configuration and
//! reads it back. From then on the part raises INT1 for 8 µs at each sample, and
//! [`Icm42688p::read`] fetches the sample in one transfer of 15 bytes. Between samples
//! [`Icm42688p::verify`] looks whether the part still holds its configuration.
//!
//! ±2000 °/s, ±16 g, both sensors in low-noise mode at the same rate. The bus is to be in mode 3
//! (or 0), most significant bit first, at most 24 MHz, with nothing else on it.
//!
//! The driver has no clock. A bus that never completes a transfer hangs it: wrap calls in a
//! time-out. A call may be dropped at any point; the chip select is then released, and the next
//! call finds its way back to the right register bank.

mod configuration;
mod error;
mod registers;
mod sample;

use core::convert::Infallible;

use embedded_hal::digital::OutputPin;
use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::spi::SpiBus;

pub use configuration::OutputDataRate;
use configuration::{SETTINGS, Setting, settings};
pub use error::Error;
pub use registers::{Bank, Register};
use registers::{DEVICE_CONFIG, IDENTITY, READ, REG_BANK_SEL, SOFT_RESET, TEMP_DATA1, WHO_AM_I};
use sample::SAMPLE_BYTES;
pub use sample::Sample;

/// How often [`Icm42688p::configure`] begins anew before it gives up.
pub const CONFIGURE_ATTEMPTS: usize = 3;

/// Wait before the first access, in µs: the supply may take 3 ms to rise, the part 1 ms more.
pub const POWER_UP_US: u32 = 4_000;

/// Wait after a software reset, in µs. The data sheet asks for 1 ms without any access.
pub const RESET_US: u32 = 2_000;

/// Wait after the sensors are turned on, in µs. The data sheet asks for 200 µs without a write,
/// for 30 ms until rates are valid, and for the gyroscope to stay on for at least 45 ms.
pub const START_UP_US: u32 = 50_000;

/// The longest that all waits of [`Icm42688p::configure`] add up to, in µs; transfers come on
/// top: fewer than 400 of 2 bytes.
pub const CONFIGURE_US: u32 = POWER_UP_US + CONFIGURE_ATTEMPTS as u32 * (RESET_US + START_UP_US);

/// The part, the bus that only it is on, and its chip select.
///
/// The transfer buffers lie in this struct: where transfers are made by DMA, it has to live in
/// memory that DMA reaches.
#[derive(Debug)]
pub struct Icm42688p<B, P> {
    bus: B,
    select: P,
    /// The bank that is selected; `None` while that is uncertain.
    bank: Option<Bank>,
    settings: [Setting; SETTINGS],
    /// Which setting is verified next.
    next: usize,
    burst: [u8; 1 + SAMPLE_BYTES],
    exchange: [u8; 2],
}

/// The chip select held low; released on drop, also when a call is dropped half-way.
struct Selected<'a, P: OutputPin<Error = Infallible>>(&'a mut P);

impl<'a, P: OutputPin<Error = Infallible>> Selected<'a, P> {
    fn new(pin: &'a mut P) -> Self {
        let Ok(()) = pin.set_low();
        Self(pin)
    }
}

impl<P: OutputPin<Error = Infallible>> Drop for Selected<'_, P> {
    fn drop(&mut self) {
        let Ok(()) = self.0.set_high();
    }
}

impl<B: SpiBus<u8>, P: OutputPin<Error = Infallible>> Icm42688p<B, P> {
    /// The part on this bus, its chip select on that pin, which should be high by now. Nothing
    /// is sent.
    pub fn new(bus: B, select: P) -> Self {
        Self {
            bus,
            select,
            bank: None,
            settings: settings(OutputDataRate::Hz1000),
            next: 0,
            burst: [0; 1 + SAMPLE_BYTES],
            exchange: [0; 2],
        }
    }

    /// The bus, for instance to change its clock.
    pub fn bus_mut(&mut self) -> &mut B {
        &mut self.bus
    }

    /// Gives back bus and chip select.
    pub fn release(self) -> (B, P) {
        (self.bus, self.select)
    }

    /// Resets the part, checks its identity, configures it for `rate`, and reads the
    /// configuration back. Samples follow; the first is there when this returns.
    ///
    /// # Errors
    /// Those of the last of [`CONFIGURE_ATTEMPTS`] attempts: [`Error::Absent`] or
    /// [`Error::WrongPart`] by the identity, [`Error::Mismatch`] if a register does not hold
    /// what was written, [`Error::Bus`]. A part that is not there is known after 10 ms.
    pub async fn configure(
        &mut self,
        rate: OutputDataRate,
        delay: &mut impl DelayNs,
    ) -> Result<(), Error<B::Error>> {
        self.settings = settings(rate);
        self.next = 0;
        delay.delay_us(POWER_UP_US).await;
        let mut result = Ok(());
        for _ in 0..CONFIGURE_ATTEMPTS {
            result = self.attempt(delay).await;
            if result.is_ok() {
                break;
            }
        }
        result
    }

    /// Fetches the latest sample, in one transfer.
    ///
    /// # Errors
    /// [`Error::Stuck`] if all bytes are the same, [`Error::NotReady`] if there was no sample
    /// since the start, [`Error::Bus`].
    #[inline]
    pub async fn read(&mut self) -> Result<Sample, Error<B::Error>> {
        self.select_bank(Bank::Zero).await?;
        self.burst = [0; 1 + SAMPLE_BYTES];
        self.burst[0] = READ | TEMP_DATA1.address;
        {
            let _selected = Selected::new(&mut self.select);
            self.bus
                .transfer_in_place(&mut self.burst)
                .await
                .map_err(Error::Bus)?;
        }
        let [_, bytes @ ..] = &self.burst;
        Sample::decode(bytes)
    }

    /// Reads one register of the configuration back, the next one at each call: two bytes, six
    /// where the register lies in another bank. A part that was reset in flight shows by this
    /// within three calls, and a single register that changed within 17.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if it does not hold what was written: configure the part again.
    /// [`Error::Bus`].
    pub async fn verify(&mut self) -> Result<(), Error<B::Error>> {
        let next = self.next;
        self.next = if next + 1 < SETTINGS { next + 1 } else { 0 };
        match self.settings.get(next).copied() {
            Some(setting) => {
                let result = self.check(setting).await;
                // The burst then need not care for the bank.
                self.select_bank(Bank::Zero).await?;
                result
            }
            None => Ok(()),
        }
    }

    /// One attempt of [`Self::configure`].
    async fn attempt(&mut self, delay: &mut impl DelayNs) -> Result<(), Error<B::Error>> {
        // Whatever happened before, the part may be in any bank.
        self.bank = None;
        self.write(DEVICE_CONFIG, SOFT_RESET).await?;
        self.bank = None;
        delay.delay_us(RESET_US).await;
        match self.read_register(WHO_AM_I).await? {
            IDENTITY => {}
            who_am_i @ (0x00 | 0xFF) => return Err(Error::Absent { who_am_i }),
            who_am_i => return Err(Error::WrongPart { who_am_i }),
        }
        for setting in self.settings {
            let Setting {
                register,
                mask,
                value,
            } = setting;
            let before = self.read_register(register).await?;
            self.write(register, before & !mask | value).await?;
        }
        delay.delay_us(START_UP_US).await;
        for setting in self.settings {
            self.check(setting).await?;
        }
        self.select_bank(Bank::Zero).await
    }

    /// Compares a register with its setting.
    async fn check(&mut self, setting: Setting) -> Result<(), Error<B::Error>> {
        let read = self.read_register(setting.register).await? & setting.mask;
        if read == setting.value {
            return Ok(());
        }
        Err(Error::Mismatch {
            register: setting.register,
            wrote: setting.value,
            read,
        })
    }

    async fn read_register(&mut self, register: Register) -> Result<u8, Error<B::Error>> {
        self.select_bank(register.bank).await?;
        self.transfer(READ | register.address, 0).await
    }

    async fn write(&mut self, register: Register, value: u8) -> Result<(), Error<B::Error>> {
        self.select_bank(register.bank).await?;
        self.transfer(register.address, value).await?;
        Ok(())
    }

    #[inline]
    async fn select_bank(&mut self, bank: Bank) -> Result<(), Error<B::Error>> {
        if self.bank == Some(bank) {
            return Ok(());
        }
        self.bank = None;
        self.transfer(REG_BANK_SEL, bank as u8).await?;
        self.bank = Some(bank);
        Ok(())
    }

    /// One transaction of two bytes; the second that came back.
    async fn transfer(&mut self, address: u8, value: u8) -> Result<u8, Error<B::Error>> {
        self.exchange = [address, value];
        let _selected = Selected::new(&mut self.select);
        self.bus
            .transfer_in_place(&mut self.exchange)
            .await
            .map_err(Error::Bus)?;
        let [_, answer] = self.exchange;
        Ok(answer)
    }
}
