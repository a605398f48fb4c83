//! What the reference manual (RM0090) states of each peripheral, one test a statement, on the bus
//! without a processor. Each test names the section that states it.

mod adc;
mod bench;
mod clocks;
mod dma;
mod dma_refusals;
mod exti;
mod flash;
mod gpio;
mod i2c;
mod i2c_lines;
mod map;
mod power_cut;
mod registers;
mod reset;
mod serial;
mod spi;
mod time;
mod timer;
mod timer_outputs;
mod watchdog;
