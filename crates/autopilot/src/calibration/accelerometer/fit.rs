//! The ellipsoid through six points, its axes along the coordinates.

use windhover_math::{GRAVITY, Vector3, sqrt};

use super::AccelerometerCalibration;
use crate::calibration::solve::NormalEquations;

/// Offset and scale that give all these forces, m/s², the length of gravity; `None` where there are
/// none.
pub(super) fn ellipsoid(forces: &[Vector3; 6]) -> Option<AccelerometerCalibration> {
    let mut equations = NormalEquations::<6>::new();
    for force in forces {
        // In units of gravity, so that all unknowns are near 1 or small.
        let v = force / GRAVITY;
        let row = [v.x * v.x, v.y * v.y, v.z * v.z, v.x, v.y, v.z];
        equations.add(&row, 1.0, 1.0);
    }
    let [a, b, c, d, e, f] = equations.solve()?;
    if !(a > 0.0 && b > 0.0 && c > 0.0) {
        return None;
    }
    // a·(x + d/2a)² + … = 1 + d²/4a + …
    let centre = Vector3::new(-0.5 * d / a, -0.5 * e / b, -0.5 * f / c);
    let size = 1.0 - 0.5 * (d * centre.x + e * centre.y + f * centre.z);
    Some(AccelerometerCalibration {
        offset: centre * GRAVITY,
        scale: Vector3::new(sqrt(a / size), sqrt(b / size), sqrt(c / size)),
    })
}
