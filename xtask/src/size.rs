//! Flash and RAM of the firmware, by section, by crate and by symbol.
//!
//! Flash holds code, constants, and the initial values of `.data`; RAM holds `.data`, `.bss` and
//! what starts unset. Each byte of these sections belongs to the symbol that covers it, or to
//! nobody, so that the sums of all tables are equal. Generic code counts for the crate that its
//! name begins with: a task's for `embassy_executor`. The stack is apart.
//!
//! The ground link has bounds of its own. They are held against its probe (`no_panic.rs`), a
//! program of nothing but the link: what the compiler adds for it, the firmware's other parts have
//! in common, so that it takes less there.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::elf::{Elf, Section};
use crate::process::Outcome;
use crate::{firmware, no_panic};

const FLASH: Range<u32> = 0x0800_0000..0x0810_0000;
const SRAM: Range<u32> = 0x2000_0000..0x2002_0000;
const CCM: Range<u32> = 0x1000_0000..0x1001_0000;

/// What the firmware may take, in bytes.
const BOUNDS: [(&str, u64); 3] = [("flash", 385_000), ("SRAM", 65_536), ("CCM", 24_000)];

/// What one ground link may take without its plans, the key and its table of senders included.
const LINK_BOUNDS: [(&str, u64); 2] = [("flash", 40_000), ("SRAM", 12_000)];

/// Crates that come with the compiler.
const COMPILER: &str = "core, alloc, compiler_builtins";

/// Constants to which the compiler gave a number or nothing instead of a name.
const CONSTANTS: &str = "nameless constants";

/// Where bytes go that belong to no symbol with a path: C names, padding.
const OTHER: &str = "other";

/// How many symbols are named.
const LARGEST: usize = 10;

/// Prints all tables; more than the bounds fails.
pub fn check() -> Outcome {
    report(&Elf::read(&firmware::build()?)?, &BOUNDS)
}

/// The same for the ground link.
pub fn check_link() -> Outcome {
    report(&no_panic::link()?, &LINK_BOUNDS)
}

fn report(elf: &Elf, bounds: &[(&str, u64)]) -> Outcome {
    print_sections(elf);
    let parts = parts(elf);
    print_crates(&parts);
    for (memory, size) in [
        ("flash", (|part| part.flash) as fn(&Part) -> u64),
        ("RAM", |part| part.ram),
    ] {
        print_largest(&parts, memory, size);
    }
    let used = [used(elf, &FLASH), used(elf, &SRAM), used(elf, &CCM)];
    println!();
    let mut missed = Vec::new();
    for ((memory, most), used) in bounds.iter().zip(used) {
        println!("{memory:6} {used:8} bytes, at most {most}");
        if used > *most {
            missed.push(format!("{memory}: {used} bytes are more than {most}"));
        }
    }
    match missed.is_empty() {
        true => Ok(()),
        false => Err(missed.join("\n")),
    }
}

/// The bytes of one symbol, or of none.
#[derive(Debug, PartialEq)]
struct Part {
    name: String,
    flash: u64,
    ram: u64,
}

/// Bytes that a section takes in flash and in RAM, per byte of it.
fn memories(section: &Section) -> (u64, u64) {
    let in_ram = SRAM.contains(&section.address) || CCM.contains(&section.address);
    // initial values of .data lie in flash and are copied to RAM
    let in_flash = FLASH.contains(&section.address) || section.name == ".data";
    (in_flash.into(), in_ram.into())
}

fn allocated(elf: &Elf) -> impl Iterator<Item = &Section> {
    let on_board = |section: &&Section| section.allocated && section.size > 0;
    elf.sections.iter().filter(on_board)
}

/// Bytes in a memory.
fn used(elf: &Elf, memory: &Range<u32>) -> u64 {
    let within = |section: &Section| match *memory == FLASH {
        true => memories(section).0,
        false => memory.contains(&section.address).into(),
    };
    allocated(elf)
        .map(|section| within(section) * u64::from(section.size))
        .sum()
}

/// Every byte of every section, by the symbol that covers it.
fn parts(elf: &Elf) -> Vec<Part> {
    let mut parts = Vec::new();
    for section in allocated(elf) {
        let end = section.address + section.size;
        let inside = |address| (section.address..end).contains(&address);
        let mut symbols: Vec<_> = elf
            .symbols
            .iter()
            .filter(|s| s.size > 0 && inside(s.address))
            .collect();
        // of several that begin at one place, the longest has it
        symbols.sort_by_key(|symbol| (symbol.address, u32::MAX - symbol.size));
        let (in_flash, in_ram) = memories(section);
        let mut part = |name: String, bytes: u32| {
            let bytes = u64::from(bytes);
            parts.push(Part {
                name,
                flash: in_flash * bytes,
                ram: in_ram * bytes,
            });
        };
        let mut next = section.address;
        for symbol in symbols {
            part(
                format!("({}, no symbol)", section.name),
                symbol.address.saturating_sub(next),
            );
            let (begin, stop) = (
                symbol.address.max(next),
                end.min(symbol.address.saturating_add(symbol.size)),
            );
            part(demangle(&symbol.name), stop.saturating_sub(begin));
            next = next.max(stop);
        }
        part(format!("({}, no symbol)", section.name), end - next);
    }
    parts
}

/// A symbol's path without the compiler's hash; tables of a function count as the function.
fn demangle(name: &str) -> String {
    let path = name.trim_start_matches(".Lswitch.table.");
    format!("{:#}", rustc_demangle::demangle(path))
}

/// The crate that a path names first: `a` for `a::b`, `<a::B as c::D>::e` and `<&mut a::B>::f`,
/// and `c` for `<u8 as c::D>::e`.
fn crate_of(path: &str) -> &str {
    if path.starts_with(".L") || path.starts_with("(.rodata") {
        return CONSTANTS;
    }
    if path.starts_with("__aeabi_") || path.starts_with("mem") {
        return COMPILER;
    }
    let Some((head, _)) = path.split_once("::") else {
        return OTHER;
    };
    let of_a_trait = head.rsplit(" as ").next().unwrap_or(head);
    let word = of_a_trait
        .rsplit(|c: char| !c.is_alphanumeric() && c != '_')
        .next();
    match word.unwrap_or_default() {
        "core" | "alloc" | "std" | "compiler_builtins" => COMPILER,
        "" => OTHER,
        word => word,
    }
}

fn print_sections(elf: &Elf) {
    println!("\n{:16} {:>10} {:>8}", "section", "address", "bytes");
    for section in allocated(elf) {
        println!("{:16} {:#010x} {:8}", section.name, section.address, section.size);
    }
}

/// Flash and RAM of each crate, the largest first.
fn crates(parts: &[Part]) -> Vec<(&str, u64, u64)> {
    let mut sums = BTreeMap::new();
    for part in parts {
        let (flash, ram) = sums.entry(crate_of(&part.name)).or_insert((0, 0));
        *flash += part.flash;
        *ram += part.ram;
    }
    let mut crates: Vec<_> = sums
        .into_iter()
        .map(|(name, (flash, ram))| (name, flash, ram))
        .collect();
    crates.sort_by_key(|(_, flash, ram)| u64::MAX - flash - ram);
    crates
}

fn print_crates(parts: &[Part]) {
    let crates = crates(parts);
    println!("\n{:32} {:>8} {:>8}", "crate", "flash", "RAM");
    for (name, flash, ram) in &crates {
        println!("{name:32} {flash:8} {ram:8}");
    }
    let flash: u64 = crates.iter().map(|(_, flash, _)| flash).sum();
    let ram: u64 = crates.iter().map(|(_, _, ram)| ram).sum();
    println!("{:32} {flash:8} {ram:8}", "sum");
}

fn print_largest(parts: &[Part], memory: &str, size: fn(&Part) -> u64) {
    let mut parts: Vec<&Part> = parts.iter().collect();
    parts.sort_by_key(|part| u64::MAX - size(part));
    println!("\nlargest in {memory}");
    for part in parts.iter().take(LARGEST).filter(|part| size(part) > 0) {
        let name: String = part.name.chars().take(100).collect();
        println!("{:8} {name}", size(part));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elf::Symbol;

    fn section(name: &str, address: u32, size: u32) -> Section {
        Section {
            name: name.into(),
            address,
            size,
            allocated: true,
        }
    }

    fn symbol(name: &str, address: u32, size: u32) -> Symbol {
        Symbol {
            name: name.into(),
            address,
            size,
        }
    }

    #[test]
    fn the_crate_is_the_first_that_a_symbol_names() {
        for (path, name) in [
            ("windhover_math::trig::sin", "windhover_math"),
            (
                "<windhover_math::Real as core::fmt::Debug>::fmt",
                "windhover_math",
            ),
            ("<&mut heapless::Vec<T> as core::fmt::Write>::w", "heapless"),
            ("core::ptr::drop_in_place<embassy_stm32::Pin>", COMPILER),
            ("<&usize as core::fmt::Display>::fmt", COMPILER),
            ("<[T] as defmt::traits::Format>::format", "defmt"),
            ("memcpy", COMPILER),
            (".Lanon.5a8b13d985c23a99bb43b78dffdda6dd.162", CONSTANTS),
            ("TIM5", OTHER),
            ("(.text, no symbol)", OTHER),
        ] {
            assert_eq!(crate_of(path), name, "{path}");
        }
        assert_eq!(
            crate_of(&demangle(".Lswitch.table._ZN4core3fmt5write17h0123456789abcdefE")),
            COMPILER
        );
    }

    #[test]
    fn every_byte_counts_once_and_initial_values_in_both_memories() {
        let elf = Elf {
            sections: vec![
                section(".text", 0x0801_0000, 100),
                section(".data", 0x2000_0000, 8),
                section(".bss", 0x1000_0000, 16),
            ],
            segments: Vec::new(),
            symbols: vec![
                symbol("a::f", 0x0801_0004, 40),
                symbol("a::alias", 0x0801_0004, 20),
                symbol("b::overlaps", 0x0801_0020, 20),
                symbol("b::X", 0x2000_0000, 8),
                symbol("b::BEYOND", 0x1000_0008, 99),
            ],
        };
        let parts = parts(&elf);
        let crates = crates(&parts);
        assert_eq!(crates, [("other", 52, 8), ("a", 40, 0), ("b", 16, 16)]);
        assert_eq!(used(&elf, &FLASH), 108);
        assert_eq!((used(&elf, &SRAM), used(&elf, &CCM)), (8, 16));
    }
}
