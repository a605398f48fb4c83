//! The report of a flight, made from its log, whichever machine flew it.
//!
//! A desktop's log holds the truth, the conditions and the figures; a board's log holds what the
//! vehicle believed, and the figures are counted from that.

use std::collections::BTreeMap;

use windhover_flight_log::View;
use windhover_flight_log::reader::{Entry, Log};
use windhover_flight_log::views::{Mission, Truth};
use windhover_math::{Quaternion, Vector3};

use crate::figures::{Axes, ErrorSum};
use crate::flight_log::parts;
use crate::report::{Event, Figure, Ned, PhotoMark, Report, Sample, ordered};

/// One moment of a flight, as far as the log tells.
#[derive(Clone, Default)]
struct Moment {
    believed: Option<(Vector3, Vector3)>,
    attitude: Option<Quaternion>,
    attitude_setpoint: Option<Quaternion>,
    setpoint: Option<Vector3>,
    rotors: Option<[f32; 4]>,
    truth: Option<Truth>,
    events: Vec<Mission>,
}

impl Moment {
    /// What is still the latest word at the next moment; the truth is of its moment only.
    fn carry_on(&mut self, next: &Self) {
        self.believed = next.believed.or(self.believed);
        self.attitude = next.attitude.or(self.attitude);
        self.attitude_setpoint = next.attitude_setpoint.or(self.attitude_setpoint);
        self.setpoint = next.setpoint.or(self.setpoint);
        self.rotors = next.rotors.or(self.rotors);
        self.truth = next.truth;
    }
}

/// Everything that the report shows. `title` names the flight, as its file does.
pub fn report(log: &Log<'_>, title: &str) -> Report {
    let mut moments: BTreeMap<u64, Moment> = BTreeMap::new();
    let mut report = Report {
        title: title.into(),
        ..Report::default()
    };
    let mut armed = false;
    let mut entries = log.entries();
    for entry in entries.by_ref() {
        match entry {
            Entry::View { time, view } => {
                if let View::Leg(leg) = view {
                    report.path.push(ned(leg.destination));
                }
                if let View::FlightPhase(phase) = view {
                    let is_armed = phase.phase != 0;
                    if is_armed != std::mem::replace(&mut armed, is_armed) {
                        let text = if is_armed { "armed" } else { "disarmed" };
                        report.events.push(Event {
                            time: seconds(time),
                            text: text.into(),
                        });
                    }
                }
                take(moments.entry(time).or_default(), view);
            }
            // What the mode is set back to on the ground is of no interest.
            Entry::Text { text, .. } if !armed && is_of_supervisor(text) => {}
            Entry::Text { time, text } => report.events.push(Event {
                time: seconds(time),
                text: text.into(),
            }),
            _ => {}
        }
    }
    for info in entries.infos() {
        let Some(text) = info.text() else { continue };
        let mut parts = parts(text).map(String::from);
        let mut part = || parts.next().unwrap_or_default();
        if info.name.starts_with("condition_") {
            report.conditions.push((part(), part()));
        } else if info.name.starts_with("figure_") {
            report.figures.push(Figure {
                label: part(),
                value: part(),
                unit: part(),
            });
        }
    }
    fill(&mut report, log, &moments);
    report
}

/// Whether the core tells of a mode, or of the end of a failsafe.
fn is_of_supervisor(text: &str) -> bool {
    text.starts_with("mode ") || text == "failsafe over"
}

fn take(moment: &mut Moment, view: View) {
    match view {
        View::VehicleLocalPosition(p) => {
            moment.believed = Some((Vector3::new(p.x, p.y, p.z), Vector3::new(p.vx, p.vy, p.vz)));
        }
        View::VehicleLocalPositionSetpoint(p) => moment.setpoint = Some(Vector3::new(p.x, p.y, p.z)),
        View::VehicleAttitude(a) => moment.attitude = Some(a.q),
        View::VehicleAttitudeSetpoint(a) => moment.attitude_setpoint = Some(a.q_d),
        View::ActuatorMotors(m) => moment.rotors = Some(m.control),
        View::Truth(truth) => moment.truth = Some(truth),
        View::Mission(event) => moment.events.push(event),
        _ => {}
    }
}

fn fill(report: &mut Report, log: &Log<'_>, moments: &BTreeMap<u64, Moment>) {
    let speed_max = log
        .parameters()
        .iter()
        .find(|(name, _)| *name == "ROTOR_SPEED_MAX");
    let speed_max = speed_max.map_or(f32::NAN, |(_, value)| *value);
    let mut ended = "the log ends in flight".to_string();
    let mut last = Moment::default();
    for (&time, moment) in moments {
        last.carry_on(moment);
        let Some(sample) = sample(time, &last, speed_max) else {
            continue;
        };
        if moment.setpoint.is_some() {
            report.samples.push(sample);
        }
        for event in &moment.events {
            mission_event(report, event, &sample, &mut ended);
        }
    }
    report.events = ordered(std::mem::take(&mut report.events));
    if let Some(first) = report.samples.first() {
        report.path.insert(0, first.position);
    }
    if report.figures.is_empty() {
        report.figures = counted(report);
    }
    let told = report.figures.iter().find(|figure| figure.label == "ended");
    report.subtitle = told.map_or(ended, |figure| figure.value.clone());
    report.figures.retain(|figure| figure.label != "ended");
}

fn mission_event(report: &mut Report, event: &Mission, sample: &Sample, ended: &mut String) {
    match event.kind {
        2 => report.events.push(Event {
            time: sample.time,
            text: format!("item {} was not reached", event.item + 1),
        }),
        3 => report.photos.push(photo(event, sample)),
        4 => report.events.push(Event {
            time: sample.time,
            text: "landed".into(),
        }),
        5 => *ended = format!("mission completed at {:.1} s", sample.time),
        _ => {}
    }
}

fn photo(event: &Mission, sample: &Sample) -> PhotoMark {
    let wanted = if event.has_target {
        ned(event.target)
    } else {
        sample.position_setpoint
    };
    let off: Vec<f32> = sample.position.iter().zip(wanted).map(|(a, b)| a - b).collect();
    let [roll, pitch, _] = sample.attitude.map(|angle| f64::from(angle).to_radians());
    PhotoMark {
        time: sample.time,
        position: sample.position,
        position_error: length(&off),
        speed: length(&sample.velocity),
        tilt: libm::acos(libm::cos(roll) * libm::cos(pitch)).to_degrees() as f32,
    }
}

/// A sample with the truth where the log has it, else with what the vehicle believed.
fn sample(time: u64, moment: &Moment, speed_max: f32) -> Option<Sample> {
    let gap = [f32::NAN; 3];
    let mut sample = Sample {
        time: seconds(time),
        position: gap,
        position_setpoint: moment.setpoint.map_or(gap, ned),
        velocity: gap,
        attitude: moment.attitude.map_or(gap, degrees),
        attitude_setpoint: moment.attitude_setpoint.map_or(gap, degrees),
        rotor_speed: moment
            .rotors
            .map_or([f32::NAN; 4], |rotors| rotors.map(|share| share * speed_max)),
        wind: gap,
    };
    if let Some((position, velocity)) = moment.believed {
        sample.position = ned(position);
        sample.velocity = ned(velocity);
    }
    if let Some(truth) = &moment.truth {
        let [w, x, y, z] = truth.q.map(|part| part as f32);
        sample.position = truth.position.map(|x| x as f32);
        sample.velocity = truth.velocity.map(|x| x as f32);
        sample.attitude = degrees(Quaternion::new(w, x, y, z));
        sample.rotor_speed = truth.rotor_speed;
        sample.wind = truth.wind;
    }
    (moment.believed.is_some() || moment.truth.is_some()).then_some(sample)
}

/// Figures of a log that brings none: of what the vehicle believed.
fn counted(report: &Report) -> Vec<Figure> {
    let mut errors = ErrorSum::default();
    for sample in &report.samples {
        let off = |n: usize| f64::from(sample.position[n] - sample.position_setpoint[n]);
        let error = Vector3::new(off(0), off(1), off(2));
        if error.iter().all(|e| e.is_finite()) {
            errors.add(error);
        }
    }
    let times = report.samples.first().zip(report.samples.last());
    let duration = times.map_or(0.0, |(first, last)| last.time - first.time);
    let Axes { north, east, down } = errors.rms();
    let figure = |label: &str, value: String, unit: &str| Figure {
        label: label.into(),
        value,
        unit: unit.into(),
    };
    vec![
        figure("duration", format!("{duration:.1}"), "s"),
        figure("photos", report.photos.len().to_string(), ""),
        figure(
            "RMSE north / east / down, as believed",
            format!("{north:.3} / {east:.3} / {down:.3}"),
            "m",
        ),
    ]
}

fn seconds(time: u64) -> f32 {
    (time as f64 * 1e-6) as f32
}

fn ned(v: Vector3) -> Ned {
    [v.x, v.y, v.z]
}

fn degrees(attitude: Quaternion) -> [f32; 3] {
    let euler = attitude.to_euler();
    [euler.roll, euler.pitch, euler.yaw].map(f32::to_degrees)
}

fn length(v: &[f32]) -> f32 {
    windhover_math::sqrt(v.iter().map(|x| x * x).sum())
}
