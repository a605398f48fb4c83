//! Coverage-guided fuzzing of what reads bytes from outside (fuzz/README.md), for a short time.

use std::process::Command;

use crate::packages::{CXX, provide};
use crate::process::{Outcome, cargo, root, run, target_directory};

/// What makes a stable compiler count edges and comparisons.
const FLAGS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares";

/// What is fuzzed: the names of programs in `fuzz/`.
const TARGETS: [&str; 5] = ["flight_log", "frames", "link", "mission", "rc"];

const HOST: &str = "x86_64-unknown-linux-gnu";

/// Seconds a target is fuzzed: two minutes for all.
const SECONDS: u32 = 24;

/// Builds and runs every target; a finding fails.
pub fn targets() -> Outcome {
    provide(&[&CXX])?;
    let built = target_directory()?.join("fuzz");
    let mut build = cargo(["build", "--locked", "--release", "--target", HOST]);
    build
        .current_dir(root().join("fuzz"))
        .env("RUSTFLAGS", FLAGS)
        .env("CARGO_TARGET_DIR", &built);
    run(&mut build)?;
    for target in TARGETS {
        let (corpus, finds) = (built.join("corpus").join(target), built.join("finds"));
        for folder in [&corpus, &finds] {
            std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        let mut fuzz = Command::new(built.join(HOST).join("release").join(target));
        fuzz.arg(format!("-artifact_prefix={}/", finds.display()));
        fuzz.args([
            "-rss_limit_mb=200",
            "-max_len=16384",
            "-verbosity=0",
            "-print_final_stats=1",
        ]);
        fuzz.arg(format!("-max_total_time={SECONDS}"));
        run(fuzz
            .arg(corpus)
            .arg(root().join("fuzz").join("corpus").join(target)))?;
    }
    Ok(())
}
