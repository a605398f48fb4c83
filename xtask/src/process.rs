//! Other programs: run so that they are seen, or so that their words can be read.

use std::env;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Done, or one line or more that say why not.
pub type Outcome = Result<(), String>;

/// The workspace's folder: as `cargo run` says, or where this program was built.
pub fn root() -> PathBuf {
    let here = env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    Path::new(&here)
        .parent()
        .expect("xtask lies in the workspace")
        .into()
}

/// The same cargo that runs this program, at the workspace's root.
pub fn cargo<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).args(arguments);
    command
}

/// Runs a command with its output shown as it comes.
pub fn run(command: &mut Command) -> Outcome {
    announce(command);
    let status = command.status().map_err(|error| describe(command, &error))?;
    match status.success() {
        true => Ok(()),
        false => Err(format!("`{}` failed: {status}", line(command))),
    }
}

/// Runs a command that may fail and returns what it wrote.
pub fn capture(command: &mut Command) -> Result<Output, String> {
    announce(command);
    command.env("CARGO_TERM_COLOR", "never");
    command.output().map_err(|error| describe(command, &error))
}

/// Runs a command that has to succeed and returns its standard output.
pub fn read(command: &mut Command) -> Result<String, String> {
    let output = capture(command)?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr);
        return Err(format!("`{}` failed: {}\n{words}", line(command), output.status));
    }
    String::from_utf8(output.stdout).map_err(|error| describe(command, &error))
}

/// Where cargo puts what it builds.
pub fn target_directory() -> Result<PathBuf, String> {
    let metadata = read(&mut cargo([
        "metadata",
        "--locked",
        "--no-deps",
        "--format-version=1",
    ]))?;
    let path = json_string(&metadata, "target_directory");
    path.map(PathBuf::from)
        .ok_or_else(|| "cargo metadata names no target_directory".into())
}

/// The value of a key whose value is a string, in JSON without blanks.
pub fn json_string(json: &str, key: &str) -> Option<String> {
    let start = json.find(&format!("\"{key}\":\""))? + key.len() + 4;
    let mut value = String::new();
    let mut characters = json[start..].chars();
    loop {
        match characters.next()? {
            '"' => return Some(value),
            '\\' => value.push(characters.next()?),
            other => value.push(other),
        }
    }
}

fn announce(command: &Command) {
    println!("$ {}", line(command));
    std::io::stdout().flush().ok(); // the program that follows writes to the same terminal
}

fn describe(command: &Command, error: &dyn std::error::Error) -> String {
    format!("`{}`: {error}", line(command))
}

/// A command as one would type it; the program without its folder.
fn line(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_stem().unwrap_or_default();
    let words = std::iter::once(program).chain(command.get_args());
    words
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_json_string_is_found_and_unescaped() {
        let json = r#"{"a":1,"target_directory":"C:\\fly\\target","b":"c"}"#;
        assert_eq!(
            json_string(json, "target_directory").as_deref(),
            Some(r"C:\fly\target")
        );
        assert_eq!(json_string(json, "b").as_deref(), Some("c"));
        assert_eq!(json_string(json, "a"), None);
        assert_eq!(json_string(r#"{"a":"cut"#, "a"), None);
    }

    #[test]
    fn a_command_is_shown_as_typed() {
        let mut command = Command::new("/usr/bin/cargo");
        command.args(["fmt", "--all"]);
        assert_eq!(line(&command), "cargo fmt --all");
    }

    #[test]
    fn the_root_holds_the_lock_file() {
        assert!(root().join("Cargo.lock").is_file());
    }
}
