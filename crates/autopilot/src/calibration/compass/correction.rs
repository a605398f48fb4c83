//! What a calibrated compass does to its samples.

use windhover_math::{Matrix3, Vector3};

use crate::sensing::CalibrationParameters;

/// `corrected = soft · (raw − offset)`, in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassCorrection {
    /// Hard iron: the field that turns with the vehicle, µT.
    pub offset: Vector3,
    /// Soft iron: symmetric; the mean of its diagonal is 1 as the calibration makes it.
    pub soft: Matrix3,
}

impl CompassCorrection {
    /// As the parameters say.
    pub fn new(parameters: &CalibrationParameters) -> Self {
        let p = parameters;
        let (xy, xz, yz) = (p.compass_cross_xy, p.compass_cross_xz, p.compass_cross_yz);
        let (x, y, z) = (p.compass_scale_x, p.compass_scale_y, p.compass_scale_z);
        Self {
            offset: Vector3::new(p.compass_x, p.compass_y, p.compass_z),
            soft: Matrix3::new(x, xy, xz, xy, y, yz, xz, yz, z),
        }
    }

    /// The field without the vehicle's iron, µT, body axes.
    #[inline]
    pub fn apply(&self, raw: Vector3) -> Vector3 {
        self.soft * (raw - self.offset)
    }

    /// Puts the correction into the parameters.
    pub fn write(&self, parameters: &mut CalibrationParameters) {
        let (p, soft) = (parameters, &self.soft);
        p.compass_x = self.offset.x;
        p.compass_y = self.offset.y;
        p.compass_z = self.offset.z;
        p.compass_scale_x = soft.m11;
        p.compass_scale_y = soft.m22;
        p.compass_scale_z = soft.m33;
        p.compass_cross_xy = soft.m12;
        p.compass_cross_xz = soft.m13;
        p.compass_cross_yz = soft.m23;
    }
}

/// What a calibration of the compass found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassCalibration {
    /// What corrects it.
    pub correction: CompassCorrection,
    /// Strength of the corrected field, µT. Its scale is the sensor's: soft iron cannot be told from
    /// a common scale factor.
    pub strength: f32,
    /// Root mean square distance of the best 85 of 100 samples from the ellipsoid, as a share of the
    /// strength.
    pub residual: f32,
}

impl CompassCalibration {
    /// Puts the correction into the parameters.
    pub fn write(&self, parameters: &mut CalibrationParameters) {
        self.correction.write(parameters);
    }
}
