//! The firmware's ELF: built as users build it, held against the memory map.

use std::ops::Range;
use std::path::PathBuf;

use crate::elf::Elf;
use crate::process::{Outcome, cargo, run, target_directory};
use crate::toolchain::BOARD;

/// Flash of the STM32F405RG.
const FLASH: Range<u64> = 0x0800_0000..0x0810_0000;

/// Sectors 1 to 3: parameters are stored there, so that nothing else may lie in them.
const STORAGE: Range<u64> = 0x0800_4000..0x0801_0000;

/// Builds the firmware and holds its layout against the memory map.
pub fn check() -> Outcome {
    let elf = Elf::read(&build()?)?;
    for section in elf.sections.iter().filter(|section| section.allocated) {
        println!(
            "{:16} {:#010x} {:8} bytes",
            section.name, section.address, section.size
        );
    }
    let problems = problems(&elf);
    match problems.is_empty() {
        true => Ok(()),
        false => Err(problems.join("\n")),
    }
}

/// Builds by the alias that users type, and says where the ELF is.
pub fn build() -> Result<PathBuf, String> {
    run(&mut cargo(["firmware", "--locked"]))?;
    Ok(target_directory()?
        .join(BOARD)
        .join("firmware/windhover-firmware"))
}

/// What in the layout would not boot, or would be lost when parameters are stored.
fn problems(elf: &Elf) -> Vec<String> {
    let mut problems = Vec::new();
    match elf.section(".vector_table") {
        Some(table) if u64::from(table.address) == FLASH.start => {}
        _ => problems.push(format!("the vector table is not at {:#010x}", FLASH.start)),
    }
    match elf.section(".text") {
        Some(text) if (STORAGE.end..FLASH.end).contains(&u64::from(text.address)) => {}
        _ => problems.push(format!(".text does not start at or above {:#010x}", STORAGE.end)),
    }
    for (name, address) in [("__storage_start", STORAGE.start), ("__storage_end", STORAGE.end)] {
        if elf.symbol(name).map(|symbol| u64::from(symbol.address)) != Some(address) {
            problems.push(format!("{name} is not {address:#010x}"));
        }
    }
    for segment in &elf.segments {
        let flashed = u64::from(segment.address)..u64::from(segment.address) + u64::from(segment.size);
        if flashed.start < FLASH.start || flashed.end > FLASH.end {
            problems.push(format!("{flashed:#010x?} does not lie in flash"));
        }
        if flashed.start < STORAGE.end && flashed.end > STORAGE.start {
            problems.push(format!("{flashed:#010x?} lies in the flash for storage"));
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elf::{Section, Segment, Symbol};

    fn section(name: &str, address: u32) -> Section {
        Section {
            name: name.into(),
            address,
            size: 0x188,
            allocated: true,
        }
    }

    fn symbol(name: &str, address: u32) -> Symbol {
        Symbol {
            name: name.into(),
            address,
            size: 0,
        }
    }

    fn good() -> Elf {
        Elf {
            sections: vec![
                section(".vector_table", 0x0800_0000),
                section(".text", 0x0801_0000),
            ],
            segments: vec![
                Segment {
                    address: 0x0800_0000,
                    size: 0x188,
                },
                Segment {
                    address: 0x0801_0000,
                    size: 0xf_0000,
                },
            ],
            symbols: vec![
                symbol("__storage_start", 0x0800_4000),
                symbol("__storage_end", 0x0801_0000),
            ],
        }
    }

    #[test]
    fn a_layout_as_planned_has_no_problem() {
        assert_eq!(problems(&good()), Vec::<String>::new());
    }

    #[test]
    fn each_departure_is_a_problem_of_its_own() {
        type Spoil = fn(&mut Elf);
        let spoilt: [(&str, Spoil); 7] = [
            ("vector table", |elf| elf.sections[0].address = 0x0800_0200),
            (".text", |elf| elf.sections[1].address = 0x0800_fffc),
            (".text", |elf| elf.sections.truncate(1)),
            ("__storage_end", |elf| elf.symbols[1].address = 0x0800_c000),
            ("for storage", |elf| elf.segments[0].size = 0x4001),
            ("for storage", |elf| elf.segments[1].address = 0x0800_fffc),
            ("not lie in flash", |elf| elf.segments[1].size = 0xf_0001),
        ];
        for (word, spoil) in spoilt {
            let mut elf = good();
            spoil(&mut elf);
            let found = problems(&elf);
            assert_eq!(found.len(), 1, "{word}: {found:?}");
            assert!(found[0].contains(word), "{word}: {found:?}");
        }
    }
}
