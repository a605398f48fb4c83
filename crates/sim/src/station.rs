//! `windhover sitl`: the terminal around [`windhover_sim::sitl`].

use std::io::Write;

use windhover_sim::report::{Event, Figure};
use windhover_sim::sitl::served::Line;
use windhover_sim::sitl::{self, Ended};
use windhover_sim::terminal::{say, until_interrupted};

use crate::options::SitlArgs;
use crate::output;

/// Serves until it is stopped; whether the vehicle was whole then. The error is one line.
pub fn run(args: &SitlArgs) -> Result<bool, String> {
    let (setup, service, words) = (args.setup()?, args.service(), args.words());
    let conditions = output::world(&setup, &words);
    let served = sitl::vehicle(&setup, service.home, &conditions).map_err(|e| words.explain(&e))?;
    // Whoever reads the first line may connect at once.
    let net = sitl::open(&service)?;
    std::fs::create_dir_all(&args.out).map_err(|e| format!("{}: {e}", args.out.display()))?;
    let log_name = args.out.join("flight.ulg");
    let stop = until_interrupted()?;
    let tcp = service.tcp.map_or("none".into(), |address| address.to_string());
    say(&format!(
        "windhover sitl: {} as system {}, UDP to {}, TCP at {tcp}, speed {}, Ctrl-C ends it",
        setup.vehicle.name,
        served.vehicle().parameters().link.system,
        service.udp,
        service.speed
    ));
    let (log, ended) = sitl::serve(served, net, &service, &log_name, &stop, &mut |line: &Line| {
        say(&format!("{:9.1} s  {}", line.time, line.text));
    })?;
    let rest = log.finish(&figures(&ended), &events(&ended));
    append(&log_name, &rest)?;
    say(&format!(
        "{} at {:.1} s, {:.1} × real time",
        ended.why, ended.time, ended.speed
    ));
    say(&format!("log: {}", log_name.display()));
    let report = output::report(&log_name, Some(&args.out.join("report.html")))?;
    say(&format!("report: {}", report.display()));
    Ok(ended.stopped)
}

fn append(name: &std::path::Path, bytes: &[u8]) -> Result<(), String> {
    std::fs::OpenOptions::new()
        .append(true)
        .open(name)
        .and_then(|mut file| file.write_all(bytes))
        .map_err(|e| format!("{}: {e}", name.display()))
}

fn figures(ended: &Ended) -> Vec<Figure> {
    let figure = |label: &str, value: String, unit: &str| Figure {
        label: label.into(),
        value,
        unit: unit.into(),
    };
    vec![
        figure("ended", ended.why.clone(), ""),
        figure("simulated time", format!("{:.1}", ended.time), "s"),
        figure("speed", format!("{:.1}", ended.speed), "× real time"),
    ]
}

fn events(ended: &Ended) -> Vec<Event> {
    vec![Event {
        time: ended.time as f32,
        text: ended.why.clone(),
    }]
}
