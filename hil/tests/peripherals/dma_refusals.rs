//! What the DMA controllers refuse: RM0090 chapter 10.

use super::bench::{Bench, FLASH_START, SRAM, assert_says};
use super::dma::*;
use super::registers::*;

/// What is said when a stream of DMA2 for SPI's receiver is enabled with one thing changed.
fn refused(change: impl FnOnce(&mut [u32; 4])) -> String {
    let mut bench = spi();
    let mut settings = [SPI_DR, TARGET, 4, SPI_CHANNEL | MINC];
    change(&mut settings);
    let [peripheral, memory, items, control] = settings;
    let stream = stream(DMA2, 0);
    bench.write(stream + 0x04, items);
    bench.write(stream + 0x08, peripheral);
    bench.write(stream + 0x0C, memory);
    bench.write(stream, control);
    let Err(violation) = bench.try_write(stream, control | EN) else {
        bench.write(SPI_CR1, SPI_ENABLED);
        bench.write(SPI_DR, 1);
        return bench.try_wait(BYTE).unwrap_err().to_string();
    };
    violation.to_string()
}

// 10.3.3, table 43
#[test]
fn a_channel_without_a_request_is_refused() {
    assert_says(
        &refused(|settings| settings[3] = 5 << 25),
        "DMA2: stream 0: channel 5 carries no modelled request",
    );
}

// 10.3.3
#[test]
fn an_address_that_is_not_the_requesting_peripheral_s_is_refused() {
    assert_says(
        &refused(|settings| settings[0] = USART1 + DR),
        "channel 3 carries SpiReceive, whose data are not at PAR = 0x40011004",
    );
}

// 10.3.6
#[test]
fn the_wrong_direction_is_refused() {
    assert_says(&refused(|settings| settings[3] |= TO_PERIPHERAL), "direction");
    assert_says(&refused(|settings| settings[3] |= 2 << 6), "memory to memory");
}

// 2.3.1
#[test]
fn the_core_coupled_memory_is_out_of_reach() {
    assert_says(
        &refused(|settings| settings[1] = 0x1000_0000),
        "cannot write memory at 0x10000000",
    );
}

// 2.3
#[test]
fn flash_cannot_be_written_and_other_addresses_not_reached() {
    assert_says(&refused(|settings| settings[1] = FLASH_START), "cannot write");
    assert_says(&refused(|settings| settings[1] = SRAM + 0x2_0000), "cannot write");
}

// 10.3.17
#[test]
fn a_stream_with_nothing_to_do_is_refused() {
    assert_says(&refused(|settings| settings[2] = 0), "NDTR = 0");
}

// 10.3.10
#[test]
fn a_memory_address_that_is_not_aligned_is_refused() {
    assert_says(
        &refused(|settings| {
            settings[1] = TARGET + 1;
            settings[3] |= PSIZE_16 | MSIZE_16;
        }),
        "not aligned",
    );
}

// 10.3.10
#[test]
fn a_count_that_does_not_fill_memory_s_items_is_refused() {
    let mut bench = serial();
    bench.write(stream(DMA1, 1) + 0x14, DMDIS);
    bench.write(stream(DMA1, 1) + 0x04, 3);
    bench.write(stream(DMA1, 1) + 0x08, USART3 + DR);
    bench.write(stream(DMA1, 1) + 0x0C, TARGET);
    let control = USART3_CHANNEL | MINC | MSIZE_32 | EN;
    assert_says(&bench.refused(stream(DMA1, 1), control), "no multiple");
}

// 10.3.17
#[test]
fn a_stream_is_enabled_only_with_its_flags_cleared() {
    let mut bench = exchange(1);
    bench.wait(BYTE);
    bench.write(stream(DMA2, 0) + 4, 1);
    let control = bench.read(stream(DMA2, 0));
    assert_says(
        &bench.refused(stream(DMA2, 0), control | EN),
        "before its flags are cleared",
    );
}

// 10.5.5 to 10.5.10
#[test]
fn a_stream_s_registers_stay_as_they_are_while_it_is_enabled() {
    let mut bench = exchange(4);
    let control = bench.read(stream(DMA2, 0));
    assert_says(&bench.refused(stream(DMA2, 0), control ^ MINC), "CR is changed");
    for register in [0x04, 0x08, 0x0C, 0x10, 0x14] {
        assert_says(
            &bench.refused(stream(DMA2, 0) + register, 0),
            "while it is enabled",
        );
    }
    bench.write(stream(DMA2, 0), control ^ TCIE);
}

#[test]
fn modes_that_nothing_here_uses_are_refused() {
    for mode in [1 << 5, 1 << 15, 1 << 21] {
        assert_says(&refused(|settings| settings[3] |= mode), "not modelled");
    }
    assert_says(&refused(|settings| settings[3] |= 3 << 11), "reserved");
    assert_says(&Bench::powered().refused(DMA1 + LISR, 0), "only be read");
}
