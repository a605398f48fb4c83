//! Independent readers and ground stations, from PyPI: installed into an environment of their own below
//! target/.

use std::path::PathBuf;
use std::process::Command;

use crate::firmware;
use crate::hash;
use crate::packages::install_debian;
use crate::process::{Outcome, cargo, root, run, target_directory};

/// The packages with their exact versions: all that they need, and nothing that only windows, maps and
/// plots of theirs would.
const PACKAGES: [&str; 9] = [
    "pyulog==1.3.0",
    "numpy==2.4.6",
    "pymavlink==2.4.50",
    "lxml==6.1.3",
    "fastcrc==0.5.0",
    "MAVProxy==1.8.75",
    "pyserial==3.5",
    "defusedxml==0.7.1",
    "mavsdk==4.1.0",
];

/// What ground stations do with the simulated vehicle, a program each.
const CLIENTS: [&str; 6] = [
    "pymavlink_monitoring.py",
    "pymavlink_services.py",
    "pymavlink_plans.py",
    "pymavlink_flight.py",
    "mavsdk_flight.py",
    "mavproxy_flight.py",
];

/// pyulog reads every topic of every log that is written here.
pub fn reads_logs() -> Outcome {
    let python = environment()?;
    let logs = logs()?;
    let script = root().join("tests").join("clients").join("pyulog_read.py");
    run(Command::new(python).arg(script).args(logs))
}

/// Ground stations that nobody here wrote connect to the simulated vehicle, upload, fly and land.
pub fn fly() -> Outcome {
    let python = environment()?;
    run(cargo(["build", "--locked", "--release", "--package", "windhover-sim"]).arg("--quiet"))?;
    let program = target_directory()?.join("release").join("windhover");
    for client in CLIENTS {
        let script = root().join("tests").join("clients").join(client);
        run(Command::new(&python).arg(script).env("WINDHOVER", &program))?;
    }
    Ok(())
}

/// A ground station uploads to the flashed firmware on the emulated board, which keeps it and flies it; where
/// it may take `long`, from the upload and from flash, and then another one.
pub fn fly_board(long: bool) -> Outcome {
    let python = environment()?;
    let elf = firmware::build()?;
    run(cargo(["build", "--locked", "--release", "--package", "windhover-hil"]).arg("--quiet"))?;
    let target = target_directory()?;
    let client = |script: &str, options: &[&str]| {
        let mut client = Command::new(&python);
        client.arg(root().join("tests").join("clients").join(script));
        client.args(options).env("WINDHOVER_ELF", &elf);
        run(client.env("WINDHOVER_HIL", target.join("release").join("windhover-hil")))
    };
    if !long {
        return client("hil_monitoring.py", &[]);
    }
    client("hil_monitoring.py", &["--twice"])?;
    client("hil_mavsdk.py", &[])
}

/// Logs of whole flights, and the small ones of the log's own tests.
fn logs() -> Result<Vec<PathBuf>, String> {
    let mut logs = Vec::new();
    for (name, mission, options) in [
        ("monitoring", "missions/monitoring.plan", &[] as &[&str]),
        ("survey", "missions/survey.plan", &["--vehicle", "x450"]),
        (
            "paper",
            "missions/monitoring.plan",
            &["--preset", "paper", "--model", "paper"],
        ),
        ("crash", "missions/monitoring.plan", &["--push", "10,0,0,60,9"]),
    ] {
        // Not every one of them is completed: the log is there all the same.
        let _ = hash::fly("release", mission, name, options);
        logs.push(hash::folder(name)?.join("flight.ulg"));
    }
    let samples = hash::folder("samples")?;
    let mut command = cargo(["run", "--locked", "--quiet", "--package", "windhover-flight-log"]);
    command.args(["--features", "reader", "--example", "sample", "--"]);
    run(command.arg(&samples).arg("2000"))?;
    let files = std::fs::read_dir(&samples).map_err(|error| format!("{}: {error}", samples.display()))?;
    logs.extend(files.filter_map(|file| Some(file.ok()?.path())));
    Ok(logs)
}

/// The environment's python; made and filled when it is not there.
fn environment() -> Result<PathBuf, String> {
    let folder = target_directory()?.join("python");
    let python = folder.join("bin").join("python");
    if !python.is_file() {
        let make = || run(Command::new("python3").args(["-m", "venv"]).arg(&folder));
        if make().is_err() {
            install_debian(&["python3", "python3-venv"])?;
            make()?;
        }
    }
    let mut pip = Command::new(&python);
    run(pip
        .args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--no-deps",
        ])
        .args(PACKAGES))?;
    Ok(python)
}
