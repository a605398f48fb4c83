//! What the operating system has to provide: compilers and libraries that cargo does not bring.

use std::env;
use std::path::PathBuf;
use std::process::Command;

use crate::process::{Outcome, read, run};

/// Something that a step needs, and the Debian package that has it.
#[derive(Debug)]
pub struct Need {
    what: &'static str,
    package: &'static str,
    is_there: fn() -> bool,
}

const C: Need = Need {
    what: "a C compiler (cc)",
    package: "build-essential",
    is_there: || answers("cc"),
};

/// A C++ compiler.
pub const CXX: Need = Need {
    what: "a C++ compiler (c++)",
    package: "build-essential",
    is_there: || answers("c++"),
};

const MAKE: Need = Need {
    what: "make or ninja",
    package: "build-essential",
    is_there: || answers("make") || answers("ninja"),
};

const CMAKE: Need = Need {
    what: "cmake",
    package: "cmake",
    is_there: || answers("cmake"),
};

const LIBCLANG: Need = Need {
    what: "libclang (LIBCLANG_PATH says where, if it is in an unusual folder)",
    package: "libclang-dev",
    is_there: has_libclang,
};

/// What the emulated board's processor is built with: its engine is C, and bindgen reads its headers.
const HIL: [&Need; 5] = [&C, &CXX, &MAKE, &CMAKE, &LIBCLANG];

const INSTALL: [&str; 4] = ["install", "--yes", "--quiet", "--no-install-recommends"];

/// Installs what `hil` needs.
pub fn install() -> Outcome {
    provide(&HIL)
}

/// Installs what is missing of these; where that cannot be done, names it and how to install it.
pub fn provide(needs: &[&Need]) -> Outcome {
    let missing: Vec<&&Need> = needs.iter().filter(|need| !(need.is_there)()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut packages: Vec<&str> = missing.iter().map(|need| need.package).collect();
    packages.dedup();
    install_debian(&packages).map_err(|error| {
        let missing: String = missing.iter().map(|need| format!("  {}\n", need.what)).collect();
        format!("Missing:\n{missing}{error}")
    })
}

/// Installs packages by apt as root; elsewhere names the command that would.
pub fn install_debian(packages: &[&str]) -> Outcome {
    if !is_root() || !answers("apt-get") {
        return Err(format!(
            "Please install it. On Debian and Ubuntu:\n  sudo apt-get {} {}",
            INSTALL.join(" "),
            packages.join(" ")
        ));
    }
    run(Command::new("apt-get").args(["update", "--quiet"]))?;
    run(Command::new("apt-get").args(INSTALL).args(packages))
}

fn is_root() -> bool {
    read(Command::new("id").arg("--user")).is_ok_and(|user| user.trim() == "0")
}

/// Whether a program can be run.
fn answers(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// Whether the library lies where bindgen looks for it. Its name without a version belongs to the
/// package that also has clang's own headers, which bindgen needs as well.
fn has_libclang() -> bool {
    let is_in = |folder: PathBuf| {
        let mut names = ["libclang.so", "libclang.dylib", "libclang.dll"].iter();
        names.any(|name| folder.join(name).exists())
    };
    env::var_os("LIBCLANG_PATH").is_some() || library_folders().into_iter().any(is_in)
}

/// Folders of libraries on Linux and macOS, those of each LLVM version among them.
fn library_folders() -> Vec<PathBuf> {
    const FOLDERS: [&str; 8] = [
        "/usr/lib",
        "/usr/lib64",
        "/usr/local/lib",
        "/usr/lib/x86_64-linux-gnu",
        "/usr/lib/aarch64-linux-gnu",
        "/Library/Developer/CommandLineTools/usr/lib",
        "/opt/homebrew/opt/llvm/lib",
        "/usr/local/opt/llvm/lib",
    ];
    let versions = std::fs::read_dir("/usr/lib").into_iter().flatten().flatten();
    let versions = versions.filter(|entry| entry.file_name().to_string_lossy().starts_with("llvm"));
    let mut folders: Vec<PathBuf> = versions.map(|entry| entry.path().join("lib")).collect();
    folders.extend(FOLDERS.iter().map(PathBuf::from));
    folders
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_done_when_nothing_is_missing() {
        let there = Need {
            what: "nothing",
            package: "no-such-package",
            is_there: || true,
        };
        assert_eq!(provide(&[&there, &there]), Ok(()));
    }

    #[test]
    fn what_cannot_be_run_is_not_there() {
        assert!(!answers("windhover-no-such-program"));
    }
}
