//! The heading itself, from two antennas or from outside: the bearing of the nose.

use core::f32::consts::PI;

use windhover_math::Vector3;

use super::bearing::Bearing;
use crate::border::{Refusal, deviation, number};
use crate::filter::Filter;
use crate::gate::Report;
use crate::health::Sensor;
use crate::history::Past;

/// A measured heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// When it was measured, µs.
    pub time: u64,
    /// From true north, east positive, −π to π rad.
    pub heading: f32,
    /// Standard deviation, rad.
    pub deviation: f32,
}

impl Filter {
    /// Takes it in.
    #[inline]
    pub fn fuse_heading(&mut self, measured: &Heading) -> Result<Report<1>, Refusal> {
        let past = self.heading_border(measured);
        let past = self.counted(Sensor::Heading, past)?;
        let bearing = Bearing {
            direction: Vector3::new(1.0, 0.0, 0.0),
            bearing: measured.heading,
            noise: 0.0,
            bearing_noise: measured.deviation * measured.deviation,
            repeats: 1.0,
            is_bearing_exact: false,
            attitude: past.attitude(&self.state),
        };
        self.fuse_bearing(Sensor::Heading, &bearing)
    }

    fn heading_border(&self, measured: &Heading) -> Result<Past, Refusal> {
        number(measured.heading, PI)?;
        deviation(measured.deviation)?;
        self.past(measured.time)
    }
}
