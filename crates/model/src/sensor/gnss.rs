//! What a u-blox receiver reports: the fields of UBX-NAV-PVT, late.
//!
//! A message describes the moment at which it was measured,
//! and comes out the latency later; several may be under way. Horizontal and vertical position
//! carry a slow error (first-order Gauss–Markov) and a white one, velocity a white one.

use std::collections::VecDeque;

use windhover_math::Vector3;
use windhover_math::geodesy::{GlobalPosition, LocalFrame};

use super::injection::Unit;
use super::nav_pvt::{CARRIER_FIXED, DIFFERENTIAL, FIX_3D, GNSS_FIX_OK, NavPvt};
use super::noise::{GaussMarkov, gaussian3};
use super::{count, stream};
use crate::length::Length;
use crate::random::Random;
use crate::truth::Truth;

/// Milliseconds of a GPS week.
const WEEK_MS: u64 = 604_800_000;

/// Errors of the receiver: standard deviations per axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GnssErrors {
    /// Slow error of north and of east, in m.
    pub horizontal: f64,
    /// Slow error of the height, in m.
    pub vertical: f64,
    /// Time constant of the slow errors, in s.
    pub tau: f64,
    /// White error of north and of east, in m.
    pub horizontal_white: f64,
    /// White error of the height, in m.
    pub vertical_white: f64,
    /// White error of each axis of the velocity, in m/s.
    pub velocity: f64,
    /// From the moment described to the message, in µs.
    pub latency_us: u64,
    /// Whether carrier-phase corrections are there.
    pub rtk: bool,
}

impl GnssErrors {
    /// Standard positioning, design §5. The design gives no white error for the height: ours is
    /// in proportion to the horizontal one.
    pub const fn standard() -> Self {
        Self {
            horizontal: 1.5,
            vertical: 2.5,
            tau: 100.0,
            horizontal_white: 0.3,
            vertical_white: 0.5,
            velocity: 0.05,
            latency_us: 120_000,
            rtk: false,
        }
    }

    /// With carrier-phase corrections: 0.02 m in each axis (design §5), half of its variance
    /// slow and half white.
    pub const fn rtk() -> Self {
        let half = 0.02 * core::f64::consts::FRAC_1_SQRT_2;
        Self {
            horizontal: half,
            vertical: half,
            horizontal_white: half,
            vertical_white: half,
            rtk: true,
            ..Self::standard()
        }
    }

    /// Neither errors nor latency: only the rounding to the message's units is left.
    pub const fn ideal() -> Self {
        Self {
            horizontal: 0.0,
            vertical: 0.0,
            horizontal_white: 0.0,
            vertical_white: 0.0,
            velocity: 0.0,
            latency_us: 0,
            ..Self::standard()
        }
    }
}

impl Default for GnssErrors {
    fn default() -> Self {
        Self::standard()
    }
}

/// Where and when the receiver is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GnssSite {
    /// The origin of the truth's positions.
    pub home: GlobalPosition,
    /// Height of mean sea level above the ellipsoid there, in mm.
    pub geoid: i32,
    /// GPS time of week at time 0, in ms.
    pub time_of_week: u32,
}

impl Default for GnssSite {
    /// The home of `missions/monitoring.plan`; geoid of 47.3 m, as around Zürich.
    fn default() -> Self {
        Self {
            home: GlobalPosition {
                latitude: 473_977_419,
                longitude: 85_455_938,
                altitude: 488_000,
            },
            geoid: 47_300,
            time_of_week: 302_400_000,
        }
    }
}

/// One receiver.
#[derive(Clone, Debug)]
pub struct Gnss {
    errors: GnssErrors,
    site: GnssSite,
    frame: LocalFrame,
    random: Random,
    slow: GaussMarkov,
    /// Messages under way, with the times at which they come out.
    delayed: VecDeque<(u64, NavPvt)>,
    lost: u64,
}

impl Gnss {
    /// Messages that can be under way: older ones are lost beyond that.
    pub const DEPTH: usize = 32;

    /// The receiver that `seed` draws, measuring every `period_us` µs.
    pub fn new(errors: &GnssErrors, site: GnssSite, period_us: u64, seed: u64) -> Self {
        let mut random = Random::new(seed, stream::GNSS);
        let deviation = Vector3::new(errors.horizontal, errors.horizontal, errors.vertical);
        let slow = GaussMarkov::new(deviation, errors.tau, period_us as f64 * 1e-6, &mut random);
        Self {
            errors: *errors,
            site,
            frame: LocalFrame::new(site.home),
            random,
            slow,
            delayed: VecDeque::with_capacity(Self::DEPTH),
            lost: 0,
        }
    }

    /// Measures at `time` µs: once a period. The message comes out of [`Self::receive`].
    pub fn measure(&mut self, truth: &Truth, time: u64) {
        if self.delayed.len() == Self::DEPTH {
            self.delayed.pop_front();
            self.lost += 1;
        }
        let message = self.message(truth, time);
        self.delayed
            .push_back((time.saturating_add(self.errors.latency_us), message));
    }

    /// The message that has come out by `time` µs, oldest first; `None` if there is none.
    pub fn receive(&mut self, time: u64) -> Option<NavPvt> {
        match self.delayed.front() {
            Some(&(due, message)) if due <= time => {
                self.delayed.pop_front();
                Some(message)
            }
            _ => None,
        }
    }

    /// Messages lost because nobody received them.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// What a metre is in latitude, longitude and height, and that velocities have no part in it.
    pub fn units(&self) -> Vec<Unit> {
        let far = self.frame.to_global(Vector3::new(1e3, 1e3, 0.0));
        let per_metre = |to: i32, from: i32| f64::from(to.wrapping_sub(from)) * 1e-3;
        let home = &self.site.home;
        let north = per_metre(far.latitude, home.latitude);
        let east = per_metre(far.longitude, home.longitude);
        let still = Unit::of(0.0);
        [north, east, 1e3]
            .map(Unit::from_first)
            .into_iter()
            .chain([still; 3])
            .collect()
    }

    fn message(&mut self, truth: &Truth, time: u64) -> NavPvt {
        let e = &self.errors;
        let white = gaussian3(&mut self.random, 1.0);
        let white = white.component_mul(&Vector3::new(
            e.horizontal_white,
            e.horizontal_white,
            e.vertical_white,
        ));
        let position = truth.position + self.slow.next(&mut self.random) + white;
        let velocity = truth.velocity + gaussian3(&mut self.random, e.velocity);
        let global = self.frame.to_global(position.map(|axis| axis as f32));
        let speed = libm::hypot(velocity.x, velocity.y);
        let mut message = NavPvt {
            time_of_week: self.time_of_week(time),
            latitude: global.latitude,
            longitude: global.longitude,
            height: global.altitude.saturating_add(self.site.geoid),
            height_msl: global.altitude,
            velocity: [velocity.x, velocity.y, velocity.z].map(millis),
            ground_speed: millis(speed),
            heading_of_motion: heading(velocity),
            fix_type: FIX_3D,
            satellites: 16,
            position_dop: 130,
            flags: GNSS_FIX_OK,
            ..NavPvt::default()
        };
        if e.rtk {
            message.flags |= DIFFERENTIAL | CARRIER_FIXED;
        }
        self.declare(&mut message, speed);
        message
    }

    /// What the receiver says of its own accuracy: the truth about its errors.
    fn declare(&self, message: &mut NavPvt, speed: f64) {
        let e = &self.errors;
        let horizontal = Vector3::new(e.horizontal, e.horizontal_white, 0.0).length();
        let vertical = Vector3::new(e.vertical, e.vertical_white, 0.0).length();
        message.horizontal_accuracy = millis(horizontal * core::f64::consts::SQRT_2) as u32;
        message.vertical_accuracy = millis(vertical) as u32;
        message.speed_accuracy = millis(e.velocity * 3.0_f64.sqrt()) as u32;
        let across = libm::atan2(e.velocity, speed) * 180.0 / core::f64::consts::PI;
        message.heading_accuracy = count(across * 1e5, 0, 18_000_000) as u32;
    }

    fn time_of_week(&self, time: u64) -> u32 {
        let ms = u64::from(self.site.time_of_week) + (time + 500) / 1000;
        (ms % WEEK_MS) as u32
    }
}

/// Thousandths, to the nearest.
fn millis(value: f64) -> i32 {
    count(value * 1e3, i32::MIN, i32::MAX)
}

/// Heading of a motion in 1e-5 degrees, from 0 to just under 360°.
fn heading(velocity: Vector3<f64>) -> i32 {
    let degrees = libm::atan2(velocity.y, velocity.x) * 180.0 / core::f64::consts::PI;
    count(degrees * 1e5, -18_000_000, 18_000_000).rem_euclid(36_000_000)
}
