//! The flash interface: RM0090 chapter 3.

use super::bench::{Bench, FLASH_START, assert_says};
use super::registers::*;
use windhover_hil::board::ResetCause;
use windhover_hil::machine::Bus;
use windhover_hil::time::MICROSECOND;

pub const PG: u32 = 1 << 0;
pub const SER: u32 = 1 << 1;
pub const STRT: u32 = 1 << 16;
const EOPIE: u32 = 1 << 24;
const LOCK: u32 = 1 << 31;
const BSY: u32 = 1 << 16;
pub const BY_WORDS: u32 = 2 << 8;
pub const MILLISECOND: u64 = 1000 * MICROSECOND;
/// The first of the sectors of 128 KiB.
pub const SECTOR_5: u32 = 0x0802_0000;

pub fn unlocked() -> Bench {
    let mut bench = Bench::powered();
    bench.write(FLASH_KEYR, 0x4567_0123);
    bench.write(FLASH_KEYR, 0xCDEF_89AB);
    bench
}

pub fn store(bench: &mut Bench, address: u32, size: u32, value: u32) -> Result<u32, String> {
    bench
        .board
        .store_to_flash(bench.now, address, size, value, &mut bench.memory)
        .map_err(|violation| violation.to_string())
}

// 3.6.1
#[test]
fn the_control_register_is_locked_after_reset() {
    let mut bench = Bench::powered();
    assert_eq!(bench.read(FLASH_CR), LOCK);
    assert_says(&bench.refused(FLASH_CR, PG), "locked");
}

// 3.6.1
#[test]
fn two_keys_unlock_the_control_register() {
    let mut bench = unlocked();
    assert_eq!(bench.read(FLASH_CR), 0);
    bench.write(FLASH_CR, LOCK);
    assert_says(&bench.refused(FLASH_CR, PG), "locked");
}

// 3.6.1
#[test]
fn a_wrong_key_is_refused() {
    let mut bench = Bench::powered();
    assert_says(&bench.refused(FLASH_KEYR, 0xCDEF_89AB), "not the key");
    bench.write(FLASH_KEYR, 0x4567_0123);
    assert_says(&bench.refused(FLASH_KEYR, 0x4567_0123), "not the key");
}

// 3.6.3, datasheet table 40
#[test]
fn an_erased_sector_is_all_ones_when_its_time_has_passed() {
    for (sector, start, size, time) in [
        (1, 0x0800_4000, 0x4000, 250),
        (4, 0x0801_0000, 0x1_0000, 550),
        (5, SECTOR_5, 0x2_0000, 1000),
        (11, 0x080E_0000, 0x2_0000, 1000),
    ] {
        let mut bench = unlocked();
        bench.memory.flash.fill(0);
        bench.write(FLASH_CR, SER | BY_WORDS | sector << 3);
        bench.write(FLASH_CR, SER | BY_WORDS | sector << 3 | STRT);
        assert_eq!(bench.read(FLASH_SR), BSY);
        assert_eq!(bench.board.stalled_until(), time * MILLISECOND);
        bench.wait(time * MILLISECOND - 1);
        assert_eq!(bench.bytes(start, 4), [0; 4]);
        bench.wait(1);
        assert_eq!(bench.read(FLASH_SR), 0);
        assert_eq!(bench.read(FLASH_CR) & STRT, 0);
        let from = (start - FLASH_START) as usize;
        let erased = bench.memory.flash.iter().filter(|byte| **byte == 0xFF).count();
        assert_eq!(erased, size);
        assert!(
            bench.memory.flash[from..from + size]
                .iter()
                .all(|byte| *byte == 0xFF)
        );
    }
}

// 3.6.3
#[test]
fn an_erase_needs_a_sector_that_exists_and_ser_alone() {
    assert_says(
        &unlocked().refused(FLASH_CR, SER | STRT | 12 << 3),
        "no sector 12",
    );
    assert_says(&unlocked().refused(FLASH_CR, STRT), "needs SER");
    assert_says(&unlocked().refused(FLASH_CR, STRT | 1 << 2), "mass erase");
}

// 3.6.3
#[test]
fn control_cannot_be_written_while_the_flash_is_busy() {
    let mut bench = unlocked();
    bench.write(FLASH_CR, SER | BY_WORDS | STRT | 5 << 3);
    assert_says(&bench.refused(FLASH_CR, 0), "busy");
}

// 3.6.4
#[test]
fn programming_clears_bits_and_sets_none() {
    let mut bench = unlocked();
    bench.set_bytes(SECTOR_5, &0xFF00_FF0F_u32.to_le_bytes());
    bench.write(FLASH_CR, PG | BY_WORDS);
    assert_eq!(store(&mut bench, SECTOR_5, 4, 0x1234_5678), Ok(0x1200_5608));
}

// 3.6.4, datasheet table 40
#[test]
fn programming_stalls_for_16_us_each_time() {
    let mut bench = unlocked();
    bench.write(FLASH_CR, PG | BY_WORDS);
    store(&mut bench, SECTOR_5, 4, 0).unwrap();
    assert_eq!(bench.read(FLASH_SR), BSY);
    assert_eq!(bench.board.stalled_until(), 16 * MICROSECOND);
    bench.wait(16 * MICROSECOND);
    assert_eq!(bench.read(FLASH_SR), 0);
}

// 3.6.4: PGSERR
#[test]
fn programming_needs_pg_and_no_lock() {
    assert_says(
        &store(&mut Bench::powered(), SECTOR_5, 4, 0).unwrap_err(),
        "locked",
    );
    assert_says(&store(&mut unlocked(), SECTOR_5, 4, 0).unwrap_err(), "PGSERR");
}

// 3.6.2, 3.6.4: PGPERR
#[test]
fn programming_needs_the_size_that_psize_says() {
    let mut bench = unlocked();
    bench.write(FLASH_CR, PG);
    assert_eq!(store(&mut bench, SECTOR_5, 1, 0x0F), Ok(0x0F));
    assert_says(&store(&mut bench, SECTOR_5, 4, 0).unwrap_err(), "PGPERR");
}

// 3.3, table 5
#[test]
fn only_flash_is_programmed() {
    let mut bench = unlocked();
    bench.write(FLASH_CR, PG | BY_WORDS);
    assert_says(&store(&mut bench, 0x0810_0000, 4, 0).unwrap_err(), "not in flash");
    assert_says(&store(&mut bench, 0x07FF_FFFC, 4, 0).unwrap_err(), "not in flash");
}

// 3.6.2
#[test]
fn programming_by_64_bits_needs_an_external_voltage() {
    let mut bench = unlocked();
    bench.write(FLASH_CR, PG | 3 << 8);
    assert_says(&store(&mut bench, SECTOR_5, 4, 0).unwrap_err(), "64 bits");
}

// 3.9.4: EOP
#[test]
fn the_end_of_an_operation_raises_an_interrupt_where_it_is_enabled() {
    let mut bench = unlocked();
    bench.write(FLASH_CR, PG | BY_WORDS | EOPIE);
    store(&mut bench, SECTOR_5, 4, 0).unwrap();
    bench.wait(16 * MICROSECOND);
    assert!(bench.requests(4));
    bench.write(FLASH_SR, 1);
    assert!(!bench.requests(4));
}

// 3.7.2
#[test]
fn option_bytes_are_locked_until_two_keys() {
    let mut bench = Bench::powered();
    assert_eq!(bench.read(FLASH_OPTCR), 0x0FFF_AAED);
    assert_says(&bench.refused(FLASH_OPTCR, 0), "locked");
    assert_says(&bench.refused(FLASH_OPTKEYR, 1), "not the key");
}

fn options_unlocked() -> Bench {
    let mut bench = Bench::powered();
    bench.write(FLASH_OPTKEYR, 0x0819_2A3B);
    bench.write(FLASH_OPTKEYR, 0x4C5D_6E7F);
    bench
}

// 3.7.2, 5.2.2
#[test]
fn the_brown_out_level_is_programmed_and_outlives_resets() {
    let mut bench = options_unlocked();
    assert_eq!(bench.board.brown_out_level(), 3);
    bench.write(FLASH_OPTCR, 0x0FFF_AAE0);
    bench.write(FLASH_OPTCR, 0x0FFF_AAE2);
    assert_eq!(bench.read(FLASH_SR), BSY);
    bench.wait(1000 * MILLISECOND);
    assert_eq!(bench.read(FLASH_OPTCR), 0x0FFF_AAE0);
    assert_eq!(bench.board.brown_out_level(), 0);
    bench.board.reset(bench.now, ResetCause::PowerOn);
    assert_eq!(bench.read(FLASH_OPTCR), 0x0FFF_AAE1);
}

// 3.7.2
#[test]
fn options_are_not_written_while_they_are_programmed() {
    let mut bench = options_unlocked();
    bench.write(FLASH_OPTCR, 0x0FFF_AAE2);
    assert_says(&bench.refused(FLASH_OPTCR, 0x0FFF_AAE2), "are programmed");
}

// 3.7.2
#[test]
fn options_that_are_not_started_are_lost() {
    let mut bench = options_unlocked();
    bench.write(FLASH_OPTCR, 0x0FFF_AAE0);
    bench.board.reset(0, ResetCause::Software);
    assert_eq!(bench.read(FLASH_OPTCR), 0x0FFF_AAED);
}

// 3.7.3
#[test]
fn read_protection_and_the_hardware_watchdog_are_refused() {
    assert_says(
        &options_unlocked().refused(FLASH_OPTCR, 0x0FFF_CCEC),
        "read-protect",
    );
    assert_says(&options_unlocked().refused(FLASH_OPTCR, 0x0FFF_AACC), "WDG_SW");
}

// 3.7.4: WRPERR
#[test]
fn a_protected_sector_is_neither_erased_nor_programmed() {
    let mut bench = options_unlocked();
    bench.write(FLASH_OPTCR, 0x0FDF_AAEE);
    bench.wait(1000 * MILLISECOND);
    bench.write(FLASH_KEYR, 0x4567_0123);
    bench.write(FLASH_KEYR, 0xCDEF_89AB);
    assert_says(&bench.refused(FLASH_CR, SER | STRT | 5 << 3), "WRPERR");
    bench.write(FLASH_CR, PG | BY_WORDS);
    assert_says(&store(&mut bench, SECTOR_5, 4, 0).unwrap_err(), "WRPERR");
    assert!(store(&mut bench, SECTOR_5 - 4, 4, 0).is_ok());
}

// 3.9.1
#[test]
fn a_cache_is_reset_only_while_it_is_disabled() {
    let mut bench = Bench::powered();
    bench.write(FLASH_ACR, 1 << 11 | 1 << 12);
    bench.write(FLASH_ACR, 1 << 9);
    assert_says(&bench.refused(FLASH_ACR, 1 << 9 | 1 << 11), "cache");
}

// 3.9.2
#[test]
fn key_registers_can_only_be_written() {
    assert!(Bench::powered().try_read(FLASH_KEYR).is_err());
    assert!(Bench::powered().try_read(FLASH_OPTKEYR).is_err());
}
