//! The bus of barometer and compass: I2C1, blocking, with an end to every wait. The HAL sets it up;
//! transfers are our own.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{Flex, Speed};
use embassy_stm32::i2c::{Config, Error, I2c as HalI2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::peripherals::{I2C1, PB8, PB9};
use embassy_stm32::time::Hertz;
use embassy_time::{Delay, Duration};
use embedded_hal::i2c::{ErrorType, I2c, Operation};
use windhover_drivers::i2c_recovery::{Held, recover};

use super::i2c_transfer::transfer;

/// The longest that one transfer may take.
const PATIENCE: Duration = Duration::from_millis(2);

/// The bus.
pub struct SensorBus {
    peripheral: Peri<'static, I2C1>,
    clock: Peri<'static, PB8>,
    data: Peri<'static, PB9>,
    /// None only while the lines are clocked by hand.
    bus: Option<HalI2c<'static, Blocking, Master>>,
}

impl SensorBus {
    /// The bus on these pins, at 400 kHz.
    pub fn new(peripheral: Peri<'static, I2C1>, clock: Peri<'static, PB8>, data: Peri<'static, PB9>) -> Self {
        let mut this = Self {
            peripheral,
            clock,
            data,
            bus: None,
        };
        this.open();
        this
    }

    fn open(&mut self) {
        let mut config = Config::default();
        config.frequency = Hertz(400_000);
        config.timeout = PATIENCE;
        config.scl_pullup = true;
        config.sda_pullup = true;
        // SAFETY: whoever had them before is gone: `bus` is none.
        self.bus.get_or_insert_with(|| unsafe {
            HalI2c::new_blocking(
                self.peripheral.clone_unchecked(),
                self.clock.clone_unchecked(),
                self.data.clone_unchecked(),
                config,
            )
        });
    }

    /// Clocks a part off the data line that holds it. Takes 0.1 ms.
    ///
    /// # Errors
    /// A line that is held all the same.
    pub fn recover(&mut self) -> Result<(), Held> {
        self.bus = None;
        let mut clock = Flex::new(self.clock.reborrow());
        let mut data = Flex::new(self.data.reborrow());
        clock.set_high();
        data.set_high();
        clock.set_as_input_output(Speed::Medium);
        data.set_as_input_output(Speed::Medium);
        let outcome = recover(&mut clock, &mut data, &mut Delay);
        drop((clock, data));
        self.open();
        outcome
    }
}

impl ErrorType for SensorBus {
    type Error = Error;
}

impl I2c for SensorBus {
    /// A write, a read, or a read behind a write: what our drivers do. Others are refused.
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        match operations {
            [Operation::Write(write)] => transfer(address, write, &mut [], PATIENCE),
            [Operation::Read(read)] => transfer(address, &[], read, PATIENCE),
            [Operation::Write(write), Operation::Read(read)] => transfer(address, write, read, PATIENCE),
            _ => Err(Error::Bus),
        }
    }
}
