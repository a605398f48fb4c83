//! Drivers of parts on I2C against models of the parts' registers.

mod bus;
mod ist8310;
mod spl06;
