//! The command line.

pub const HELP: &str = "\
cargo xtask TASK

  test            every check there is, step by step; installs what it needs by rustup, and by apt
                  as root
    --only STEP     only this step (repeatable)
    --fail-fast     stop at the first step that fails
    --long          the tests' long flights too: sets WINDHOVER_LONG=1 for them;
                    property tests draw new cases
    --list          say what the steps are, and do nothing
  bench [ARGS]    the benchmarks of windhover-sim; ARGS go to them
  count           instructions of the firmware's steps and of the core's functions
  size            flash and RAM of the firmware by section and by crate
  link-size       flash and RAM of the ground link alone
  help            this text
";

/// What to do.
#[derive(Debug, PartialEq)]
pub enum Task {
    Help,
    List,
    Test {
        only: Vec<String>,
        fail_fast: bool,
        long: bool,
    },
    Bench(Vec<String>),
    Count,
    Size,
    LinkSize,
}

/// Reads the arguments that follow the program's name.
pub fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Task, String> {
    let task = match arguments.next().as_deref() {
        None => return Err("which task?".into()),
        Some("help" | "--help" | "-h") => Task::Help,
        Some("test") => return parse_test(arguments),
        Some("bench") => return Ok(Task::Bench(arguments.collect())),
        Some("count") => Task::Count,
        Some("size") => Task::Size,
        Some("link-size") => Task::LinkSize,
        Some(other) => return Err(format!("there is no task `{other}`")),
    };
    match arguments.next() {
        None => Ok(task),
        Some(extra) => Err(format!("`{extra}` is one argument too many")),
    }
}

fn parse_test(mut arguments: impl Iterator<Item = String>) -> Result<Task, String> {
    let (mut only, mut fail_fast, mut long) = (Vec::new(), false, false);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--only" => only.push(arguments.next().ok_or("--only needs the name of a step")?),
            "--fail-fast" => fail_fast = true,
            "--long" => long = true,
            "--list" => return Ok(Task::List),
            "--help" | "-h" => return Ok(Task::Help),
            other => return Err(format!("test has no option `{other}`")),
        }
    }
    Ok(Task::Test {
        only,
        fail_fast,
        long,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_line(line: &str) -> Result<Task, String> {
        parse(line.split_whitespace().map(String::from))
    }

    #[test]
    fn test_takes_its_options_in_any_order() {
        let task = parse_line("test --only fmt --fail-fast --only doc --long").unwrap();
        let only = vec!["fmt".to_string(), "doc".to_string()];
        assert_eq!(
            task,
            Task::Test {
                only,
                fail_fast: true,
                long: true,
            }
        );
    }

    #[test]
    fn bench_hands_its_arguments_on() {
        let arguments = vec!["--sample-count".to_string(), "3".to_string()];
        assert_eq!(parse_line("bench --sample-count 3"), Ok(Task::Bench(arguments)));
    }

    #[test]
    fn what_is_not_understood_is_named() {
        assert!(parse_line("fly").unwrap_err().contains("`fly`"));
        assert!(parse_line("size now").unwrap_err().contains("`now`"));
        assert!(parse_line("test --fast").unwrap_err().contains("`--fast`"));
        assert!(parse_line("test --only").unwrap_err().contains("--only"));
        assert!(parse_line("").is_err());
    }
}
