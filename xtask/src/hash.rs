//! Equal bits from every build: one flight, flown by differently compiled programs.

use std::path::Path;

use crate::process::{Outcome, cargo, json_string, read};

/// The builds, by cargo's name of their profile.
const PROFILES: [&str; 4] = ["dev", "release", "lto", "units"];

/// The mission that is flown, with seed 1 in the reference conditions.
const MISSION: &str = "missions/monitoring.plan";

/// Every build gives the same motor commands; prints their hash.
pub fn is_equal() -> Outcome {
    let mut found: Vec<(&str, String)> = Vec::new();
    for profile in PROFILES {
        found.push((profile, fly(profile, MISSION, "hash", &[])?));
    }
    println!("motor hash of {MISSION}, seed 1: {}", found[0].1);
    match found.iter().all(|(_, hash)| *hash == found[0].1) {
        true => Ok(()),
        false => Err(format!("the builds differ: {found:?}")),
    }
}

/// Flies a mission with the program built in this profile; its motor hash. What it writes lies in
/// a folder of that name, see [`folder`].
pub fn fly(profile: &str, mission: &str, name: &str, options: &[&str]) -> Result<String, String> {
    let out = folder(name)?;
    let mut command = cargo(["run", "--locked", "--quiet", "--profile", profile]);
    command.args(["--package", "windhover-sim", "--bin", "windhover", "--"]);
    command
        .args(["fly", mission, "--json", "--out"])
        .arg(&out)
        .args(options);
    let figures = read(&mut command)?;
    json_string(&figures, "motor_hash").ok_or_else(|| format!("no motor_hash in {figures}"))
}

/// Where flights of this program's go.
pub fn folder(name: &str) -> Result<std::path::PathBuf, String> {
    let folder = crate::process::target_directory()?
        .join("xtask")
        .join(Path::new(name));
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    Ok(folder)
}
