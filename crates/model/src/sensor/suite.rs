//! All sensors of one vehicle, each at its own rate, with their faults.

use windhover_math::Vector3;

use super::barometer::{Barometer, BarometerCounts, BarometerErrors};
use super::battery::{Battery, BatteryCounts, BatteryErrors, CURRENT_SCALE, Pack, VOLTAGE_SCALE};
use super::compass::{Compass, CompassErrors, CompassPart, default_field};
use super::fault::{FaultSensor, SensorFault};
use super::gnss::{Gnss, GnssErrors, GnssSite};
use super::icm42688p::Measurement;
use super::inertial::{Inertial, InertialErrors};
use super::injection::{Injector, Raw, Unit};
use super::nav_pvt::NavPvt;
use super::rate::{Due, Rate, Rates};
use super::rc::{self, CHANNELS, Rc, RcErrors};
use super::spl06::Formula;
use crate::imu::{ACCEL_SCALE, GYRO_SCALE};
use crate::truth::Truth;

/// Errors of all sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorErrors {
    /// Inertial measurement unit.
    pub inertial: InertialErrors,
    /// Barometer.
    pub barometer: BarometerErrors,
    /// Compass.
    pub compass: CompassErrors,
    /// Satellite receiver.
    pub gnss: GnssErrors,
    /// Battery.
    pub battery: BatteryErrors,
    /// RC link.
    pub rc: RcErrors,
}

impl SensorErrors {
    /// The reference conditions (design §5) for an inertial measurement unit at `imu_rate` Hz in a
    /// vehicle whose rotors hover at `hover_speed` rad/s.
    pub fn reference(imu_rate: f64, hover_speed: f64) -> Self {
        Self {
            inertial: InertialErrors {
                vibration_speed: hover_speed,
                ..InertialErrors::reference(imu_rate)
            },
            ..Self::default()
        }
    }

    /// No errors anywhere, and no latency.
    pub const fn ideal() -> Self {
        Self {
            inertial: InertialErrors::ideal(),
            barometer: BarometerErrors::ideal(),
            compass: CompassErrors::ideal(),
            gnss: GnssErrors::ideal(),
            battery: BatteryErrors::ideal(),
            rc: RcErrors::ideal(),
        }
    }
}

/// What is fitted, and where the vehicle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitting {
    /// How often each measures.
    pub rates: Rates,
    /// Which compass.
    pub compass: CompassPart,
    /// The magnetic field in NED in µT.
    pub field: Vector3<f64>,
    /// The barometer's formula.
    pub formula: Formula,
    /// Home, geoid and time.
    pub site: GnssSite,
    /// The battery.
    pub pack: Pack,
}

impl Default for Fitting {
    fn default() -> Self {
        Self {
            rates: Rates::default(),
            compass: CompassPart::default(),
            field: default_field(),
            formula: Formula::default(),
            site: GnssSite::default(),
            pack: Pack::default(),
        }
    }
}

/// What came in at one moment: raw, as the parts' registers and messages hold it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Readings {
    /// Inertial measurement unit.
    pub imu: Option<Measurement>,
    /// Barometer.
    pub barometer: Option<BarometerCounts>,
    /// Compass, in the part's own axes.
    pub compass: Option<[i16; 3]>,
    /// Satellite receiver: of the past.
    pub gnss: Option<NavPvt>,
    /// Battery.
    pub battery: Option<BatteryCounts>,
    /// RC receiver.
    pub rc: Option<[u16; CHANNELS]>,
}

/// A sensor, when it is due, and what is wrong with it.
#[derive(Clone, Debug)]
struct Fitted<S, R> {
    sensor: S,
    due: Due,
    faults: Injector<R>,
}

impl<S, R: Raw> Fitted<S, R> {
    fn take(&mut self, time: u64, measure: impl FnOnce(&mut S) -> Option<R>) -> Option<R> {
        if !self.due.now(time) {
            return None;
        }
        self.measure(time, measure)
    }

    fn measure(&mut self, time: u64, measure: impl FnOnce(&mut S) -> Option<R>) -> Option<R> {
        let output = measure(&mut self.sensor)?;
        self.faults.apply(time, output)
    }
}

/// The faults of a flight.
struct Faults<'a> {
    all: &'a [SensorFault],
    seed: u64,
}

impl Faults<'_> {
    fn of<R: Raw>(&self, sensor: FaultSensor, units: Vec<Unit>) -> Injector<R> {
        Injector::new(sensor, units, self.all, self.seed)
    }

    fn fit<S, R: Raw>(&self, name: FaultSensor, sensor: S, rate: Rate, units: Vec<Unit>) -> Fitted<S, R> {
        Fitted {
            sensor,
            due: Due::new(rate),
            faults: self.of(name, units),
        }
    }
}

fn barometer(fitting: &Fitting, errors: &BarometerErrors, seed: u64) -> Barometer {
    let home = f64::from(fitting.site.home.altitude) * 1e-3;
    let period = fitting.rates.barometer.period;
    Barometer::new(errors, fitting.formula, home, period, seed)
}

/// All sensors of one vehicle. Deterministic: equal arguments give equal integers.
///
/// [`Self::advance`] lets each measure at its rate. Where a part has an oscillator of its own, its
/// owner asks each sensor at its time instead, about as often as its rate says, by which drifts are
/// scaled.
#[derive(Clone, Debug)]
pub struct SensorSuite {
    imu: Fitted<Inertial, Measurement>,
    gyro: Injector<[i16; 3]>,
    accel: Injector<[i16; 3]>,
    barometer: Fitted<Barometer, BarometerCounts>,
    compass: Fitted<Compass, [i16; 3]>,
    gnss: Fitted<Gnss, NavPvt>,
    battery: Fitted<Battery, BatteryCounts>,
    rc: Fitted<Rc, [u16; CHANNELS]>,
    sticks: [f64; CHANNELS],
}

impl SensorSuite {
    /// The sensors that `seed` draws, with sticks in the middle.
    pub fn new(fitting: &Fitting, errors: &SensorErrors, faults: &[SensorFault], seed: u64) -> Self {
        let (rates, faults) = (&fitting.rates, Faults { all: faults, seed });
        let imu = Inertial::new(&errors.inertial, 1e6 / rates.imu.period as f64, seed);
        let barometer = barometer(fitting, &errors.barometer, seed);
        let metre = vec![Unit::from_first(barometer.counts_per_metre())];
        let compass = Compass::new(fitting.compass, &errors.compass, fitting.field, seed);
        let field = vec![Unit::of(fitting.compass.scale()); 3];
        let gnss = Gnss::new(&errors.gnss, fitting.site, rates.gnss.period, seed);
        let place = gnss.units();
        let battery = Battery::new(&fitting.pack, &errors.battery, seed);
        let load = vec![Unit::of(VOLTAGE_SCALE), Unit::of(CURRENT_SCALE)];
        let rc = Rc::new(&errors.rc, seed);
        let stick = Unit {
            zero: rc::MIDDLE.into(),
            ..Unit::of(rc::SCALE)
        };
        Self {
            imu: faults.fit(FaultSensor::Imu, imu, rates.imu, vec![]),
            gyro: faults.of(FaultSensor::Gyro, vec![Unit::of(GYRO_SCALE); 3]),
            accel: faults.of(FaultSensor::Accel, vec![Unit::of(ACCEL_SCALE); 3]),
            barometer: faults.fit(FaultSensor::Barometer, barometer, rates.barometer, metre),
            compass: faults.fit(FaultSensor::Compass, compass, rates.compass, field),
            gnss: faults.fit(FaultSensor::Gnss, gnss, rates.gnss, place),
            battery: faults.fit(FaultSensor::Battery, battery, rates.battery, load),
            rc: faults.fit(FaultSensor::Rc, rc, rates.rc, vec![stick; CHANNELS]),
            sticks: [0.0; CHANNELS],
        }
    }

    /// Moves the pilot's sticks and switches, −1 to 1.
    pub fn set_sticks(&mut self, sticks: [f64; CHANNELS]) {
        self.sticks = sticks;
    }

    /// What comes in at `time` µs, with the world as `truth` says: once after every step of the
    /// world.
    pub fn advance(&mut self, truth: &Truth, time: u64) -> Readings {
        Readings {
            imu: if self.imu.due.now(time) {
                self.measure_imu(truth, time)
            } else {
                None
            },
            barometer: self.barometer.take(time, |part| Some(part.measure(truth))),
            compass: self.compass.take(time, |part| Some(part.measure(truth))),
            gnss: self.gnss(truth, time),
            battery: self.battery.take(time, |part| Some(part.measure(truth, time))),
            rc: self.rc.take(time, |part| part.measure(&self.sticks)),
        }
    }

    /// The inertial measurement unit takes a sample at `time` µs; `None` if it gives none.
    pub fn measure_imu(&mut self, truth: &Truth, time: u64) -> Option<Measurement> {
        /// How the part marks a sample that is not valid.
        const INVALID: [i16; 3] = [i16::MIN; 3];
        let (gyro, accel) = (&mut self.gyro, &mut self.accel);
        self.imu.measure(time, |part| {
            let measured = part.sample(truth);
            Some(Measurement {
                gyro: gyro.apply(time, measured.gyro).unwrap_or(INVALID),
                accel: accel.apply(time, measured.accel).unwrap_or(INVALID),
                ..measured
            })
        })
    }

    /// The barometer measures at `time` µs; `None` if it gives nothing.
    pub fn measure_barometer(&mut self, truth: &Truth, time: u64) -> Option<BarometerCounts> {
        self.barometer.measure(time, |part| Some(part.measure(truth)))
    }

    /// The compass measures at `time` µs; `None` if it gives nothing.
    pub fn measure_compass(&mut self, truth: &Truth, time: u64) -> Option<[i16; 3]> {
        self.compass.measure(time, |part| Some(part.measure(truth)))
    }

    /// The battery's voltages are measured at `time` µs; `None` if they are not there.
    pub fn measure_battery(&mut self, truth: &Truth, time: u64) -> Option<BatteryCounts> {
        self.battery.measure(time, |part| Some(part.measure(truth, time)))
    }

    /// The RC receiver's frame at `time` µs; `None` if none came.
    pub fn measure_rc(&mut self, time: u64) -> Option<[u16; CHANNELS]> {
        let sticks = &self.sticks;
        self.rc.measure(time, |part| part.measure(sticks))
    }

    /// The satellite receiver measures at `time` µs. Its message comes out of
    /// [`Self::receive_gnss`], later.
    pub fn measure_gnss(&mut self, truth: &Truth, time: u64) {
        self.gnss.sensor.measure(truth, time);
    }

    /// A message of the satellite receiver that has come out by `time` µs. Faults are of the
    /// messages.
    pub fn receive_gnss(&mut self, time: u64) -> Option<NavPvt> {
        let message = self.gnss.sensor.receive(time)?;
        self.gnss.faults.apply(time, message)
    }

    fn gnss(&mut self, truth: &Truth, time: u64) -> Option<NavPvt> {
        if self.gnss.due.now(time) {
            self.measure_gnss(truth, time);
        }
        self.receive_gnss(time)
    }

    /// What a driver has to know of the barometer.
    pub fn formula(&self) -> &Formula {
        self.barometer.sensor.formula()
    }

    /// Charge left in the battery, 0 to 1.
    pub fn charge(&self) -> f64 {
        self.battery.sensor.charge()
    }
}
