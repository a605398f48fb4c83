//! The state of the vehicle as ground stations are told.

use windhover_autopilot::{
    Blocker, Charge as CoreCharge, GnssSample, Mode, OuterReport, Parameters, Phase, Row,
};
use windhover_ground_link::Telemetry;
use windhover_ground_link::telemetry::{Battery, Charge, Fix, Gnss, Health, Landed, Part};
use windhover_math::geodesy::LocalFrame;
use windhover_math::{atan2, min, sqrt};

use crate::Told;
use crate::command::link_mode;

/// Slower than this a course over ground means nothing, m/s.
const AT_REST: f32 = 0.3;

/// Writes what the core has told into the telemetry; the mission's progress is left.
pub fn fill(t: &mut Telemetry, told: &Told, parameters: &Parameters, load: f32) {
    let Some(report) = told.report() else {
        return;
    };
    let (estimate, known) = (&report.estimate, &report.estimate.known);
    let frame = report.origin.map(LocalFrame::new);
    let global = |local| frame.map(|frame| frame.to_global(local));
    t.time = Some(told.time);
    t.attitude = known.attitude.then_some(estimate.attitude);
    t.rate = told.rate;
    t.position = known.position.then(|| estimate.position - report.home);
    t.velocity = known.position.then_some(estimate.velocity);
    t.global = global(estimate.position).filter(|_| known.position);
    t.home = global(report.home);
    t.gnss = told.gnss.map(|sample| gnss(&sample));
    t.battery = battery(report);
    t.mode = link_mode(report.mode);
    t.armed = report.phase != Phase::Disarmed;
    t.failsafe = report.failsafe.is_some();
    t.landed = landed(report);
    t.health = health(report, told.radio().is_some());
    t.load = load;
    let most = 4.0 * parameters.vehicle.rotor_thrust_max();
    let runs = told.motors != [0; 4];
    t.throttle = if runs && most > 0.0 {
        min(told.thrust / most, 1.0)
    } else {
        0.0
    };
    t.motors = told.motors;
}

fn gnss(sample: &GnssSample) -> Gnss {
    let [north, east, _] = sample.velocity.map(|axis| axis as f32 * 1e-3);
    let speed = sqrt(north * north + east * east);
    let metres = |mm: u32| mm as f32 * 1e-3;
    Gnss {
        fix: match sample.fix {
            2 => Fix::Flat,
            3 | 4 => Fix::Full,
            _ => Fix::None,
        },
        satellites: sample.satellites,
        position: sample.position,
        speed,
        course: (speed > AT_REST).then(|| atan2(east, north)),
        dilution: [None; 2],
        accuracy: [
            metres(sample.horizontal_accuracy),
            metres(sample.vertical_accuracy),
        ],
        speed_accuracy: metres(sample.speed_accuracy),
    }
}

fn battery(report: &OuterReport) -> Battery {
    let battery = &report.battery;
    Battery {
        voltage: battery.voltage,
        current: battery.current,
        consumed: battery.voltage.map(|_| battery.drawn),
        remaining: battery.remaining,
        charge: match battery.charge {
            CoreCharge::Low => Charge::Low,
            CoreCharge::Critical | CoreCharge::Emergency => Charge::Critical,
            _ => Charge::Enough,
        },
    }
}

fn landed(report: &OuterReport) -> Landed {
    match (report.phase, report.mode) {
        (Phase::Flying, Mode::Takeoff) => Landed::TakingOff,
        (Phase::Flying, Mode::Land | Mode::Descend) => Landed::Landing,
        (Phase::Flying, _) => Landed::InAir,
        _ => Landed::OnGround,
    }
}

fn health(report: &OuterReport, remote: bool) -> Health {
    let blocked = |blocker| report.blockers.contains(blocker);
    let part = |good: bool| if good { Part::Good } else { Part::Bad };
    // Told the truth from outside, it needs no sensors: they are as good as there.
    let outside = report.sensors.health == [0; _] && report.estimate.known.position;
    let sensor = |index: usize, bad: bool| match report.sensors.health.get(index) {
        _ if outside => Part::Good,
        Some(1 | 2) => part(!bad),
        Some(3) => Part::Bad,
        _ => Part::Absent,
    };
    let inertial = !report.active.contains(Row::ImuUnreliable) && !blocked(Blocker::ImuUnreliable);
    let [position, barometer, compass] = [0, 3, 4];
    Health {
        gyro: part(inertial && !blocked(Blocker::GyroUncalibrated)),
        accelerometer: part(inertial && !blocked(Blocker::AccelerometerUncalibrated)),
        compass: sensor(
            compass,
            blocked(Blocker::CompassFault) || blocked(Blocker::CompassUncalibrated),
        ),
        barometer: sensor(barometer, blocked(Blocker::BarometerFault)),
        gnss: sensor(position, blocked(Blocker::PositionUnknown)),
        radio: match remote {
            false => Part::Absent,
            true => part(!blocked(Blocker::RcLost)),
        },
        battery: match report.battery.voltage {
            None => Part::Absent,
            Some(_) => part(!blocked(Blocker::BatteryLow)),
        },
        estimate: part(report.estimate.known.attitude && report.estimate.known.position),
        log: Part::Good,
        motors: part(!report.active.contains(Row::MotorSaturated)),
        fence: part(!blocked(Blocker::FenceInvalid) && !blocked(Blocker::OutsideFence)),
        can_arm: report.blockers.is_empty(),
    }
}
