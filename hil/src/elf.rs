//! A program for the board: what goes into flash, and the names of its functions.

use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol, SymbolKind};
use std::fs;
use std::path::{Path, PathBuf};

/// A function or a variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Demangled name, without the compiler's hash.
    pub name: String,
    /// Address, without the bit that says Thumb.
    pub address: u32,
    /// Its size in bytes, 0 if unknown.
    pub size: u32,
    /// Whether it is code.
    pub is_function: bool,
}

/// A program as the linker left it.
#[derive(Clone, Debug)]
pub struct Elf {
    /// What is to be in flash: addresses and bytes.
    pub segments: Vec<(u32, Vec<u8>)>,
    /// The whole file.
    pub file: Vec<u8>,
    /// By address.
    symbols: Vec<Symbol>,
}

/// Why a program cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ElfError {
    /// It cannot be read.
    #[error("{0}: {1}")]
    Read(PathBuf, std::io::Error),
    /// It is no 32-bit ELF file.
    #[error("not a program for this processor: {0}")]
    Parse(#[from] object::Error),
    /// No symbol has this name.
    #[error("no symbol is called {0}")]
    NoSymbol(String),
    /// Several symbols have this name.
    #[error("{0} is ambiguous: {1:?}")]
    Ambiguous(String, Vec<String>),
}

impl Elf {
    /// Reads a program from a file.
    pub fn load(path: &Path) -> Result<Self, ElfError> {
        Self::parse(fs::read(path).map_err(|error| ElfError::Read(path.into(), error))?)
    }

    /// A program from the bytes of its file.
    pub fn parse(file: Vec<u8>) -> Result<Self, ElfError> {
        let elf = ElfFile32::<Endianness>::parse(file.as_slice())?;
        let endian = elf.endian();
        let mut segments = Vec::new();
        for header in elf.elf_program_headers() {
            let bytes = header.data(endian, file.as_slice()).unwrap_or_default();
            if header.p_type(endian) == object::elf::PT_LOAD && !bytes.is_empty() {
                segments.push((header.p_paddr(endian), bytes.to_vec()));
            }
        }
        let mut symbols: Vec<Symbol> = elf.symbols().filter_map(|symbol| named(&symbol)).collect();
        symbols
            .sort_by(|a, b| (a.address, !a.is_function, &a.name).cmp(&(b.address, !b.is_function, &b.name)));
        Ok(Self {
            segments,
            symbols,
            file,
        })
    }

    /// All symbols, by address.
    pub fn symbols(&self) -> &[Symbol] {
        &self.symbols
    }

    /// The symbol with this demangled path or end of a path: `main`, `schedule::Schedule::step`.
    pub fn find(&self, path: &str) -> Result<&Symbol, ElfError> {
        let mut found: Vec<&Symbol> = self.symbols.iter().filter(|symbol| symbol.name == path).collect();
        if found.is_empty() {
            found = self
                .symbols
                .iter()
                .filter(|symbol| ends_with_path(&symbol.name, path))
                .collect();
        }
        found.dedup_by_key(|symbol| symbol.address);
        match found.as_slice() {
            [] => Err(ElfError::NoSymbol(path.into())),
            [one] => Ok(one),
            several => {
                let names = several.iter().map(|symbol| symbol.name.clone()).collect();
                Err(ElfError::Ambiguous(path.into(), names))
            }
        }
    }

    /// The function that contains an address, and how far into it.
    pub fn function_at(&self, address: u32) -> Option<(&Symbol, u32)> {
        let address = address & !1;
        let behind = self.symbols.partition_point(|symbol| symbol.address <= address);
        let symbol = self.symbols[..behind]
            .iter()
            .rev()
            .find(|symbol| symbol.is_function)?;
        let offset = address - symbol.address;
        (offset < symbol.size.max(1)).then_some((symbol, offset))
    }

    /// `function+0x12` for an address.
    pub fn name_of(&self, address: u32) -> Option<String> {
        self.function_at(address)
            .map(|(symbol, offset)| format!("{}+{offset:#x}", symbol.name))
    }
}

fn named<'data>(symbol: &impl ObjectSymbol<'data>) -> Option<Symbol> {
    let name = symbol
        .name()
        .ok()
        .filter(|name| !name.is_empty() && !name.starts_with('$'))?;
    let is_function = symbol.kind() == SymbolKind::Text;
    if symbol.is_undefined()
        || !matches!(
            symbol.kind(),
            SymbolKind::Text | SymbolKind::Data | SymbolKind::Unknown
        )
    {
        return None;
    }
    let address = symbol.address() as u32;
    Some(Symbol {
        name: format!("{:#}", rustc_demangle::demangle(name)),
        address: if is_function { address & !1 } else { address },
        size: symbol.size() as u32,
        is_function,
    })
}

fn ends_with_path(name: &str, path: &str) -> bool {
    name.strip_suffix(path)
        .is_some_and(|rest| !rest.ends_with(|last: char| last.is_alphanumeric() || last == '_'))
}
