//! Height by air pressure: one direct scalar.
//!
//! A barometer measures height above a level that nobody knows: the pressure of the day. The
//! filter holds that level as a [`Datum`], set by the first measurement. It is no sixteenth state:
//! it drifts by decimetres an hour, a thirtieth of what a standard receiver's height errs by, so
//! there is nothing to learn it from in a flight; who has an RTK receiver lets its height lead and
//! gives the barometer a larger deviation. Errors of dynamic pressure are taken off before.
//!
//! A barometer that is rejected time and again is at fault if another sensor still vouches for the
//! height: then the datum moves and the height stays. Otherwise the height is set to it.

use crate::border::{DEVIATIONS, LARGEST_POSITION, Refusal, deviation, number};
use crate::covariance::{Axis, Group, Reference};
use crate::filter::Filter;
use crate::gate::Report;
use crate::health::{Health, Sensor};
use crate::history::Past;

/// A barometer's height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarometricHeight {
    /// When it was measured, µs.
    pub time: u64,
    /// Up, above whatever level, m.
    pub height: f32,
    /// Standard deviation, m.
    pub deviation: f32,
}

/// The level that barometric heights are referred to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Datum {
    /// Barometric height of the origin, m.
    pub height: f32,
    /// Variance of the height it was taken at, m². It is part of the declared accuracy.
    pub variance: f32,
}

impl Filter {
    /// Takes it in; the first one sets the datum, and tells nothing more.
    #[inline]
    pub fn fuse_barometer(&mut self, measured: &BarometricHeight) -> Result<Report<1>, Refusal> {
        let past = self.barometer_border(measured);
        let past = self.counted(Sensor::Barometer, past)?;
        let down = past.position(&self.state).z;
        let reference = Reference::Position { lag: past.lag };
        let datum = match self.datum {
            Some(datum) => datum,
            None => self.take_datum(measured.height + down, measured.deviation),
        };
        let noise = measured.deviation * measured.deviation;
        let wrong = datum.height - measured.height - down;
        let tests = [self.test_direct(reference, Axis::Z, wrong, noise)];
        Ok(self.decide(
            Sensor::Barometer,
            tests,
            |filter| filter.fuse_direct(reference, Axis::Z, wrong, noise),
            |filter| {
                if filter.has_other_height() {
                    filter.take_datum(measured.height + down, measured.deviation);
                } else {
                    filter.state.position.z += wrong;
                    filter.forget_position(Axis::Z, noise, past.lag);
                }
            },
        ))
    }

    /// Sets the level of barometric heights: what the barometer shows at the origin's height, m,
    /// and the standard deviation of that. A mean over the alignment is better than the first
    /// measurement that is taken otherwise: its noise stays for the whole flight.
    pub fn refer_barometer(&mut self, height: f32, claimed: f32) -> Result<(), Refusal> {
        number(height, LARGEST_POSITION)?;
        number(claimed, *DEVIATIONS.end())?;
        self.datum = Some(Datum {
            height,
            variance: claimed * claimed,
        });
        Ok(())
    }

    /// The level of barometric heights, once there was one.
    pub fn datum(&self) -> Option<Datum> {
        self.datum
    }

    fn barometer_border(&self, measured: &BarometricHeight) -> Result<Past, Refusal> {
        number(measured.height, LARGEST_POSITION)?;
        deviation(measured.deviation)?;
        self.past(measured.time)
    }

    /// Whether another sensor is believed about the height.
    fn has_other_height(&self) -> bool {
        [Sensor::GnssHeight, Sensor::Pose]
            .into_iter()
            .any(|sensor| matches!(self.health(sensor), Health::Good { .. }))
    }

    /// Refers the barometer to the height as believed now, by one measurement.
    fn take_datum(&mut self, height: f32, deviation: f32) -> Datum {
        let [_, _, variance] = self.covariance.variances(Group::Position);
        let variance = variance + deviation * deviation;
        let datum = Datum { height, variance };
        self.datum = Some(datum);
        datum
    }

    /// The height was set anew, by so much (down, m): the level goes along, or the barometer would
    /// be rejected from now on.
    pub(crate) fn shift_datum(&mut self, down: f32) {
        if let Some(datum) = &mut self.datum {
            datum.height += down;
        }
    }
}
