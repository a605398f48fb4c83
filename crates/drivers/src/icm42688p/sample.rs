//! What a burst brings.

use super::error::Error;

/// Bytes of a sample in the registers: temperature, three axes of acceleration, three of rate.
pub(super) const SAMPLE_BYTES: usize = 14;

/// One sample as the registers hold it: raw counts in the part's own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    /// Accelerometer, 2048 counts per g.
    pub accel: [i16; 3],
    /// Gyroscope, 16.4 counts per °/s.
    pub gyro: [i16; 3],
    /// Thermometer, 132.48 counts per °C from 25 °C.
    pub temperature: i16,
}

impl Sample {
    /// Temperature of the part in °C (data sheet, section 4.13).
    pub fn celsius(&self) -> f32 {
        f32::from(self.temperature) / 132.48 + 25.0
    }

    /// The sample in the bytes of a burst, high bytes first.
    ///
    /// # Errors
    /// [`Error::Stuck`] if all bytes are the same, [`Error::NotReady`] if an axis of
    /// accelerometer or gyroscope is −32768, by which the part marks the lack of a sample.
    pub(super) fn decode<E>(bytes: &[u8; SAMPLE_BYTES]) -> Result<Self, Error<E>> {
        let [t1, t0, ax1, ax0, ay1, ay0, az1, az0, gx1, gx0, gy1, gy0, gz1, gz0] = *bytes;
        if bytes.iter().all(|byte| *byte == t1) {
            return Err(Error::Stuck { byte: t1 });
        }
        let word = |high, low| i16::from_be_bytes([high, low]);
        let sample = Self {
            accel: [word(ax1, ax0), word(ay1, ay0), word(az1, az0)],
            gyro: [word(gx1, gx0), word(gy1, gy0), word(gz1, gz0)],
            temperature: word(t1, t0),
        };
        if sample.accel.contains(&i16::MIN) || sample.gyro.contains(&i16::MIN) {
            return Err(Error::NotReady);
        }
        Ok(sample)
    }
}
