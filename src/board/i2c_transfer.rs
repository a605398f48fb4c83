//! Transfers of I2C1 as master, which may be preempted anywhere and for however long (RM0090
//! 27.3.3, application note AN2824).
//!
//! The HAL reads byte by byte. Preempted between the last byte but one and its refusal of the last
//! for as long as two bytes take, it has acknowledged one too many, and the stop that it then asks
//! for waits for a part that drives the data line. Here the clock is held low (BTF) whenever time
//! matters.

use cortex_m::interrupt;
use embassy_stm32::i2c::Error;
use embassy_stm32::pac::I2C1;
use embassy_stm32::pac::i2c::regs::Sr1;
use embassy_stm32::pac::i2c::vals::Pos;
use embassy_time::{Duration, Instant};

/// Looks at the stop condition of the transfer before, which takes some µs: far more than it needs.
const LOOKS: usize = 1000;

/// Writes, and behind that reads; either may be nothing.
///
/// # Errors
/// No answer, a line that others drive, or no end within `patience`.
pub fn transfer(address: u8, write: &[u8], read: &mut [u8], patience: Duration) -> Result<(), Error> {
    settle();
    let until = Instant::now() + patience;
    if !write.is_empty() {
        begin(address << 1, until)?;
        I2C1.sr2().read();
        for byte in write {
            I2C1.dr().write(|data| data.set_dr(*byte));
            wait(until, Sr1::btf)?;
        }
    }
    if read.is_empty() {
        stop();
        return Ok(());
    }
    receive(address, read, until)
}

/// Waits for the stop of the transfer before, and drops what one that failed has left.
fn settle() {
    for _ in 0..LOOKS {
        if !I2C1.cr1().read().stop() {
            break;
        }
    }
    // One in the data register, one behind it.
    for _ in 0..2 {
        if I2C1.sr1().read().rxne() {
            I2C1.dr().read();
        }
    }
}

fn stop() {
    I2C1.cr1().modify(|control| control.set_stop(true));
}

/// A start, or another one, and the address, up to where the part has acknowledged it.
fn begin(address: u8, until: Instant) -> Result<(), Error> {
    I2C1.cr1().modify(|control| control.set_start(true));
    wait(until, Sr1::start)?;
    I2C1.dr().write(|data| data.set_dr(address));
    wait(until, Sr1::addr)
}

/// Reads, refuses the last byte and stops.
fn receive(address: u8, read: &mut [u8], until: Instant) -> Result<(), Error> {
    let count = read.len();
    I2C1.cr1().modify(|control| {
        control.set_ack(count > 1);
        // What is refused is then the byte behind the one that comes in.
        control.set_pos(if count == 2 { Pos::NEXT } else { Pos::CURRENT });
    });
    begin(address << 1 | 1, until)?;
    interrupt::free(|_| {
        I2C1.sr2().read();
        match count {
            1 => stop(),
            2 => I2C1.cr1().modify(|control| control.set_ack(false)),
            _ => {}
        }
    });
    for (index, byte) in read.iter_mut().enumerate() {
        match count - index {
            // Two are there, the clock is held, and the one that comes is the last.
            3 => {
                wait(until, Sr1::btf)?;
                I2C1.cr1().modify(|control| control.set_ack(false));
                *byte = data();
            }
            // It is there already: nothing comes between the stop and its reading.
            2 => {
                wait(until, Sr1::btf)?;
                interrupt::free(|_| {
                    stop();
                    *byte = data();
                });
            }
            _ => {
                wait(until, Sr1::rxne)?;
                *byte = data();
            }
        }
    }
    Ok(())
}

fn data() -> u8 {
    I2C1.dr().read().dr()
}

/// Waits for a flag. What is there counts before the time that has passed, most of which may have
/// been others'.
fn wait(until: Instant, flag: impl Fn(&Sr1) -> bool) -> Result<(), Error> {
    loop {
        let status = I2C1.sr1().read();
        // Flags are cleared by zeros; a bus error is none of ours (errata ES0182).
        if status.af() || status.arlo() || status.berr() {
            I2C1.sr1().write(|clear| {
                clear.0 = !0;
                clear.set_af(false);
                clear.set_arlo(false);
                clear.set_berr(false);
            });
        }
        if status.af() {
            stop();
            return Err(Error::Nack);
        }
        if status.arlo() {
            return Err(Error::Arbitration);
        }
        if flag(&status) {
            return Ok(());
        }
        if Instant::now() > until {
            return Err(Error::Timeout);
        }
    }
}
