//! As much of an ELF file (32 bits, little-endian) as the checks need: sections, loaded segments
//! and symbols. Layout as in the System V ABI, chapters 4 and 5.

use std::path::Path;

/// A part of the file with a name.
#[derive(Debug)]
pub struct Section {
    pub name: String,
    pub address: u32,
    pub size: u32,
    /// Whether it takes memory on the target.
    pub allocated: bool,
}

/// Bytes that are put into memory at `address`: flashed, on a microcontroller.
#[derive(Debug)]
pub struct Segment {
    pub address: u32,
    pub size: u32,
}

/// A named address.
#[derive(Debug)]
pub struct Symbol {
    pub name: String,
    pub address: u32,
    pub size: u32,
}

#[derive(Debug, Default)]
pub struct Elf {
    pub sections: Vec<Section>,
    pub segments: Vec<Segment>,
    pub symbols: Vec<Symbol>,
}

const SHT_SYMTAB: u32 = 2;
const SHF_ALLOC: u32 = 2;
const PT_LOAD: u32 = 1;
const STT_FUNC: u16 = 2;
const SYMBOL_SIZE: usize = 16;

impl Elf {
    pub fn read(path: &Path) -> Result<Self, String> {
        let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Self::parse(&bytes).ok_or_else(|| format!("{}: not a whole 32-bit ELF file", path.display()))
    }

    pub fn parse(bytes: &[u8]) -> Option<Self> {
        // magic number, class 32 bits, data little-endian
        if bytes.get(..6)? != b"\x7fELF\x01\x01" {
            return None;
        }
        let file = File(bytes);
        let headers = file.section_headers()?;
        let names = headers.get(usize::from(file.half(0x32)?))?;
        let sections = headers
            .iter()
            .map(|header| header.section(&file, names))
            .collect::<Option<_>>()?;
        let mut symbols = Vec::new();
        for table in headers.iter().filter(|header| header.kind == SHT_SYMTAB) {
            let strings = headers.get(table.link as usize)?;
            symbols.append(&mut file.symbols(table, strings)?);
        }
        Some(Self {
            sections,
            segments: file.segments()?,
            symbols,
        })
    }

    pub fn section(&self, name: &str) -> Option<&Section> {
        self.sections.iter().find(|section| section.name == name)
    }

    pub fn symbol(&self, name: &str) -> Option<&Symbol> {
        self.symbols.iter().find(|symbol| symbol.name == name)
    }
}

/// An entry of the section header table.
struct Header {
    name: u32,
    kind: u32,
    flags: u32,
    address: u32,
    offset: usize,
    size: u32,
    link: u32,
}

impl Header {
    fn section(&self, file: &File, names: &Header) -> Option<Section> {
        Some(Section {
            name: file.text(names.offset.checked_add(self.name as usize)?)?,
            address: self.address,
            size: self.size,
            allocated: self.flags & SHF_ALLOC != 0,
        })
    }
}

/// The file's bytes; what lies beyond their end is `None`.
struct File<'a>(&'a [u8]);

impl File<'_> {
    fn half(&self, at: usize) -> Option<u16> {
        let bytes = self.0.get(at..at.checked_add(2)?)?;
        Some(u16::from_le_bytes(bytes.try_into().ok()?))
    }

    fn word(&self, at: usize) -> Option<u32> {
        let bytes = self.0.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    }

    /// A string that ends with a zero.
    fn text(&self, at: usize) -> Option<String> {
        let bytes = self.0.get(at..)?;
        let end = bytes.iter().position(|&byte| byte == 0)?;
        String::from_utf8(bytes[..end].to_vec()).ok()
    }

    fn section_headers(&self) -> Option<Vec<Header>> {
        let (table, size, count) = (self.word(0x20)? as usize, self.half(0x2e)?, self.half(0x30)?);
        let header = |index: u16| {
            let at = table.checked_add(usize::from(index) * usize::from(size))?;
            Some(Header {
                name: self.word(at)?,
                kind: self.word(at + 4)?,
                flags: self.word(at + 8)?,
                address: self.word(at + 12)?,
                offset: self.word(at + 16)? as usize,
                size: self.word(at + 20)?,
                link: self.word(at + 24)?,
            })
        };
        (0..count).map(header).collect()
    }

    fn segments(&self) -> Option<Vec<Segment>> {
        let (table, size, count) = (self.word(0x1c)? as usize, self.half(0x2a)?, self.half(0x2c)?);
        let mut segments = Vec::new();
        for index in 0..usize::from(count) {
            let at = table.checked_add(index * usize::from(size))?;
            // a segment without bytes in the file is memory that starts empty
            let segment = Segment {
                address: self.word(at + 12)?,
                size: self.word(at + 16)?,
            };
            if self.word(at)? == PT_LOAD && segment.size > 0 {
                segments.push(segment);
            }
        }
        Some(segments)
    }

    fn symbols(&self, table: &Header, strings: &Header) -> Option<Vec<Symbol>> {
        let symbol = |index: usize| {
            let at = table.offset.checked_add(index * SYMBOL_SIZE)?;
            // a function's address has a bit that says Thumb
            let is_function = self.half(at + 12)? & 0xf == STT_FUNC;
            Some(Symbol {
                name: self.text(strings.offset.checked_add(self.word(at)? as usize)?)?,
                address: self.word(at + 4)? & !u32::from(is_function),
                size: self.word(at + 8)?,
            })
        };
        (0..table.size as usize / SYMBOL_SIZE).map(symbol).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One segment, one section with code, one symbol `step` in it; tables in a fixed order.
    fn sample() -> Vec<u8> {
        let strings = b"\0.text\0.symtab\0.strtab\0step\0"; // at 0, 1, 7, 15, 23
        let (segments, symbols) = (0x34u32, 0x34 + 32);
        let names = symbols + 16;
        let headers = names + strings.len() as u32;
        let mut file = b"\x7fELF\x01\x01\x01".to_vec();
        file.resize(0x1c, 0);
        put(&mut file, &[segments, headers, 0]);
        for half in [0x34u16, 32, 1, 40, 4, 3] {
            file.extend(half.to_le_bytes());
        }
        put(&mut file, &[PT_LOAD, 0, 0x2000_0000, 0x0801_0000, 8, 8, 5, 4]);
        put(&mut file, &[23, 0x0801_0005, 4, STT_FUNC.into()]);
        file.extend(strings);
        put(&mut file, &[0; 10]);
        put(&mut file, &[1, 1, SHF_ALLOC, 0x0801_0000, 0, 8, 0, 0, 4, 0]);
        put(&mut file, &[7, SHT_SYMTAB, 0, 0, symbols, 16, 3, 0, 4, 16]);
        put(&mut file, &[15, 3, 0, 0, names, strings.len() as u32, 0, 0, 1, 0]);
        file
    }

    fn put(file: &mut Vec<u8>, words: &[u32]) {
        words.iter().for_each(|word| file.extend(word.to_le_bytes()));
    }

    #[test]
    fn sections_segments_and_symbols_are_read() {
        let elf = Elf::parse(&sample()).unwrap();
        let text = elf.section(".text").unwrap();
        assert_eq!((text.address, text.size, text.allocated), (0x0801_0000, 8, true));
        assert!(!elf.section(".symtab").unwrap().allocated);
        let step = elf.symbol("step").unwrap();
        assert_eq!((step.address, step.size), (0x0801_0004, 4));
        assert_eq!(elf.segments.len(), 1);
        assert_eq!(
            (elf.segments[0].address, elf.segments[0].size),
            (0x0801_0000, 8),
            "where it is flashed"
        );
        assert!(elf.symbol("stop").is_none());
    }

    #[test]
    fn a_file_cut_short_is_refused_wherever_it_ends() {
        let whole = sample();
        for length in 0..whole.len() - 12 {
            assert!(Elf::parse(&whole[..length]).is_none(), "{length} bytes");
        }
        assert!(Elf::parse(b"\x7fELF\x02\x01 and 64 bits").is_none());
    }
}
