//! Tells the program the commit that it was built from, for the header of its logs.

use std::path::Path;
use std::process::Command;

fn main() {
    // The log of HEAD grows with every commit and checkout.
    for file in ["../../.git/HEAD", "../../.git/logs/HEAD"] {
        if Path::new(file).exists() {
            println!("cargo::rerun-if-changed={file}");
        }
    }
    println!("cargo::rerun-if-changed=build.rs");
    let said = Command::new("git").args(["rev-parse", "HEAD"]).output();
    let commit = said.ok().filter(|output| output.status.success());
    let commit = commit.and_then(|output| String::from_utf8(output.stdout).ok());
    let commit = commit.unwrap_or_else(|| "unknown".into());
    println!("cargo::rustc-env=WINDHOVER_COMMIT={}", commit.trim());
}
