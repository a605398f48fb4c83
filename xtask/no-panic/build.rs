//! Links the probe by its own script, which names addresses only so that there are some.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=probe.x");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    // Copied, because cargo keeps track of OUT_DIR when a checkout or its target folder moves.
    let script = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("probe.x");
    fs::copy("probe.x", &script).expect("probe.x is beside build.rs");
    println!("cargo::rustc-link-arg-bins=-T{}", script.display());
}
