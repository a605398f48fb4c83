//! The sensors of a simulated vehicle, and what a driver makes of their registers.

use windhover_autopilot::battery::BatterySample;
use windhover_autopilot::sensing::BoardRotation;
use windhover_autopilot::{
    BarometerSample, CompassFitting, CompassSample, GnssSample, ImuCounts, Queues, RcFrame,
};
use windhover_math::Vector3;
use windhover_math::geodesy::GlobalPosition;
use windhover_model::sensor::compass::earth_field;
use windhover_model::sensor::fault::SensorFault;
use windhover_model::sensor::gnss::{GnssErrors, GnssSite};
use windhover_model::sensor::nav_pvt::{GNSS_FIX_OK, NavPvt};
use windhover_model::sensor::rate::Rate;
use windhover_model::sensor::suite::{Fitting, Readings, SensorErrors, SensorSuite};
use windhover_model::{Truth, Vehicle};
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::Date;
use world_magnetic_model::uom::si::angle::{degree, radian};
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;
use world_magnetic_model::uom::si::magnetic_flux_density::microtesla;

/// Which satellite receiver is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Receiver {
    /// Without corrections: metres.
    #[default]
    Standard,
    /// With carrier-phase corrections: centimetres.
    Rtk,
}

/// The sensors that a vehicle flies on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sensors {
    /// The receiver.
    pub receiver: Receiver,
    /// What fails, and when.
    pub faults: Vec<SensorFault>,
    /// Errors other than the reference conditions'; the receiver's are then in here too.
    pub errors: Option<SensorErrors>,
    /// A remote control is switched on, its sticks at rest and its throttle low.
    pub remote: bool,
    /// Charge of the battery at the start, 0 to 1; `None` is full.
    pub charge: Option<f64>,
    /// The core is not told the exact declination: it looks it up itself, as on a board.
    pub own_declination: bool,
}

/// Sticks at rest with the throttle low, switches off, the mode switch at a position that selects
/// nothing (second of six).
pub const RESTING: [f64; 16] = [
    0.0, 0.0, -1.0, 0.0, -1.0, -0.5, -1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
];

/// The Earth's magnetic field at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarthField {
    /// NED, µT.
    pub field: Vector3<f64>,
    /// Bearing of magnetic north, east positive, rad.
    pub declination: f32,
}

impl EarthField {
    /// By the world magnetic model of 2025, on the first day of 2026. `None` for what is no place.
    pub fn at(place: GlobalPosition) -> Option<Self> {
        let angle = |scaled: i32| Angle::new::<degree>((f64::from(scaled) * 1e-7) as f32);
        let field = GeomagneticField::new(
            Length::new::<meter>(place.altitude as f32 * 1e-3),
            angle(place.latitude),
            angle(place.longitude),
            Date::from_ordinal_date(2026, 1).ok()?,
        )
        .ok()?;
        let declination = field.declination().get::<radian>();
        Some(Self {
            field: earth_field(
                f64::from(declination),
                f64::from(field.inclination().get::<radian>()),
                f64::from(field.f().get::<microtesla>()),
            ),
            declination,
        })
    }
}

impl Sensors {
    /// The sensors of `vehicle` at `home` that `seed` draws, with sticks at rest.
    pub fn suite(&self, vehicle: &Vehicle, home: GlobalPosition, imu_rate: u32, seed: u64) -> SensorSuite {
        let mut fitting = Fitting {
            site: GnssSite {
                home,
                ..GnssSite::default()
            },
            ..Fitting::default()
        };
        fitting.rates.imu = Rate {
            period: 1_000_000 / u64::from(imu_rate),
            phase: 0,
        };
        if let Some(earth) = EarthField::at(home) {
            fitting.field = earth.field;
        }
        if let Some(charge) = self.charge {
            fitting.pack.charge = charge;
        }
        let reference = SensorErrors {
            gnss: match self.receiver {
                Receiver::Standard => GnssErrors::standard(),
                Receiver::Rtk => GnssErrors::rtk(),
            },
            ..SensorErrors::reference(f64::from(imu_rate), vehicle.plant.hover_speed())
        };
        let mut suite = SensorSuite::new(
            &fitting,
            self.errors.as_ref().unwrap_or(&reference),
            &self.faults,
            seed,
        );
        suite.set_sticks(RESTING);
        suite
    }
}

/// Sensors in the loop: from the truth to the core's queues.
#[derive(Clone, Debug)]
pub struct Sensing {
    suite: SensorSuite,
    remote: bool,
}

impl Sensing {
    /// The sensors of `vehicle` at `home` that `seed` draws.
    pub fn new(sensors: &Sensors, vehicle: &Vehicle, home: GlobalPosition, imu_rate: u32, seed: u64) -> Self {
        Self {
            suite: sensors.suite(vehicle, home, imu_rate, seed),
            remote: sensors.remote,
        }
    }

    /// Moves the pilot's sticks and switches, −1 to 1.
    pub fn set_sticks(&mut self, sticks: [f64; 16]) {
        self.suite.set_sticks(sticks);
    }

    /// What comes in at `time` µs: the inertial sample, and the rest into the queues.
    pub fn advance(&mut self, truth: &Truth, time: u64, queues: &mut Queues) -> Option<ImuCounts> {
        let Readings {
            imu,
            barometer,
            compass,
            gnss,
            battery,
            rc,
        } = self.suite.advance(truth, time);
        if let Some(counts) = barometer {
            let formula = self.suite.formula();
            queues.barometer.push(BarometerSample {
                time,
                pressure: formula.pressure(counts.pressure, counts.temperature) as f32,
            });
        }
        if let Some(counts) = compass {
            queues.compass.push(CompassSample { time, counts });
        }
        if let Some(message) = gnss {
            queues.gnss.push(gnss_sample(&message, time));
        }
        if let Some(counts) = battery {
            queues.battery.push(BatterySample {
                time,
                voltage: counts.voltage,
                current: counts.current,
            });
        }
        if let Some(frame) = rc.filter(|_| self.remote) {
            queues.rc.push(RcFrame {
                channels: frame.map(pulse),
            });
        }
        imu.map(|imu| ImuCounts {
            accel: imu.accel,
            gyro: imu.gyro,
        })
    }
}

/// The compass as [`Fitting`] fits it: an IST8310, whose axes are left-handed.
pub fn compass_fitting() -> CompassFitting {
    let part = Fitting::default().compass;
    CompassFitting {
        per_count: (1.0 / part.scale()) as f32,
        rotation: BoardRotation([[1, 0, 0], [0, 1, 0], [0, 0, part.z_sign() as i8]]),
    }
}

/// A channel of CRSF as a pulse, µs: 987 at 172, 2011 at 1811, cut to whole ones (CRSF,
/// RC_CHANNELS_PACKED).
fn pulse(channel: u16) -> u16 {
    (u32::from(channel) * 5 / 8 + 880) as u16
}

/// A receiver's message that came at `time` µs.
fn gnss_sample(message: &NavPvt, time: u64) -> GnssSample {
    GnssSample {
        time,
        position: GlobalPosition {
            latitude: message.latitude,
            longitude: message.longitude,
            altitude: message.height_msl,
        },
        velocity: message.velocity,
        horizontal_accuracy: message.horizontal_accuracy,
        vertical_accuracy: message.vertical_accuracy,
        speed_accuracy: message.speed_accuracy,
        fix: if message.flags & GNSS_FIX_OK != 0 {
            message.fix_type
        } else {
            0
        },
        satellites: message.satellites,
    }
}
