//! Length of a vector: nalgebra's own needs a mathematical library that we keep out.

use windhover_math::Vector3;

pub(crate) trait Length {
    /// Euclidean length.
    fn length(&self) -> f64;
    /// Its square.
    fn length_squared(&self) -> f64;
}

impl Length for Vector3<f64> {
    #[inline(always)]
    fn length(&self) -> f64 {
        self.length_squared().sqrt()
    }
    #[inline(always)]
    fn length_squared(&self) -> f64 {
        self.x * self.x + self.y * self.y + self.z * self.z
    }
}
