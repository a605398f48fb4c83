//! Power that fails, and resets, in the middle of an operation of the flash.

use super::bench::Bench;
use super::flash::*;
use super::registers::*;
use windhover_hil::board::ResetCause;
use windhover_hil::machine::Bus;
use windhover_hil::time::MICROSECOND;

/// A board on which power fails in the middle of this operation.
fn failing(operation: u64) -> Bench {
    let mut bench = unlocked();
    bench.board.cut_power_at(operation);
    bench
}

fn boot(bench: &mut Bench) {
    bench.board.reset(bench.now, ResetCause::PowerOn);
    bench.wait(0);
}

#[test]
fn power_fails_in_the_middle_of_the_operation_that_was_asked_for() {
    let mut bench = failing(2);
    bench.write(FLASH_CR, PG | BY_WORDS);
    for word in 0..3 {
        assert_eq!(bench.board.flash_operations(), u64::from(word));
        assert!(!bench.board.take_power_failure());
        store(&mut bench, SECTOR_5 + 4 * word, 4, 0).unwrap();
        bench.wait(8 * MICROSECOND - 1);
        assert!(!bench.board.take_power_failure());
        bench.wait(1);
        assert_eq!(bench.board.take_power_failure(), word == 2);
        bench.wait(8 * MICROSECOND);
    }
}

/// Bits that are to be cleared are cleared or not, others stay; over many words both happen.
#[test]
fn a_word_that_power_left_has_some_of_its_bits() {
    let mut seen = [0; 3];
    for operation in 0..60 {
        let mut bench = failing(operation);
        bench.write(FLASH_CR, PG | BY_WORDS);
        for word in 0..u32::try_from(operation).unwrap() {
            store(&mut bench, SECTOR_5 + 4 * word, 4, 0).unwrap();
            bench.wait(16 * MICROSECOND);
        }
        bench.set_bytes(SECTOR_5, &0xFF00_FF0F_u32.to_le_bytes());
        let is = store(&mut bench, SECTOR_5, 4, 0x1234_5678).unwrap();
        assert_eq!(is & !0xFF00_FF0F, 0, "no bit is set");
        assert_eq!(is & 0x1200_5608, 0x1200_5608, "no bit is cleared that stays");
        seen[match is {
            0x1200_5608 => 0,
            0xFF00_FF0F => 1,
            _ => 2,
        }] += 1;
    }
    assert!(seen.iter().all(|times| *times > 3), "{seen:?}");
}

/// The sector is old, or erased, or anything in between; the others are untouched.
#[test]
fn a_sector_that_power_left_is_partly_erased() {
    let mut shares = vec![];
    for operation in 0..20 {
        let mut bench = failing(operation);
        bench.write(FLASH_CR, PG | BY_WORDS);
        for word in 0..u32::try_from(operation).unwrap() {
            store(&mut bench, SECTOR_5 + 4 * word, 4, 0).unwrap();
            bench.wait(16 * MICROSECOND);
        }
        bench.memory.flash.fill(0);
        bench.write(FLASH_CR, SER | BY_WORDS | 1 << 3 | STRT);
        bench.wait(125 * MILLISECOND);
        assert!(bench.board.take_power_failure());
        boot(&mut bench);
        let ones = |bytes: &[u8]| bytes.iter().map(|byte| byte.count_ones()).sum::<u32>();
        shares.push(ones(&bench.memory.flash[0x4000..0x8000]) / (0x4000 * 8 / 100));
        assert_eq!(
            ones(&bench.memory.flash),
            ones(&bench.memory.flash[0x4000..0x8000])
        );
    }
    shares.sort_unstable();
    shares.dedup_by_key(|share| *share / 20);
    assert!(shares.len() >= 4, "{shares:?}");
}

// 3.6: a reset during an operation leaves its content undefined
#[test]
fn a_reset_aborts_an_erasure() {
    let mut bench = unlocked();
    bench.memory.flash.fill(0);
    bench.write(FLASH_CR, SER | BY_WORDS | 1 << 3 | STRT);
    bench.wait(100 * MILLISECOND);
    bench.board.reset(bench.now, ResetCause::IndependentWatchdog);
    bench.wait(1000 * MILLISECOND);
    assert_ne!(bench.bytes(0x0800_4000, 0x4000), [0xFF; 0x4000]);
    bench.write(RCC_AHB1ENR, 0);
    assert_eq!(bench.read(FLASH_SR), 0);
}
