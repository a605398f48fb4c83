//! How a part sits on the vehicle.

use windhover_math::Vector3;

/// A part's axes in the body: body axes (FRD) are these rows of the part's axes, each entry −1,
/// 0 or 1, as in the autopilot's board rotation, which undoes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mounting(pub [[i8; 3]; 3]);

impl Default for Mounting {
    /// The part's axes are the body's.
    fn default() -> Self {
        Self([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    }
}

impl Mounting {
    /// A vector of the body in the part's axes. Exact.
    pub fn to_part(&self, body: Vector3<f64>) -> Vector3<f64> {
        let row = |[x, y, z]: [i8; 3], along: f64| {
            Vector3::new(f64::from(x) * along, f64::from(y) * along, f64::from(z) * along)
        };
        row(self.0[0], body.x) + row(self.0[1], body.y) + row(self.0[2], body.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_part_sees_the_body_turned_back() {
        // Turned by 90° about down: the part's x is the body's right.
        let mounting = Mounting([[0, -1, 0], [1, 0, 0], [0, 0, 1]]);
        assert_eq!(
            mounting.to_part(Vector3::new(1.0, 2.0, 3.0)),
            Vector3::new(2.0, -1.0, 3.0)
        );
        let body = Vector3::new(0.1, -0.2, 0.3);
        assert_eq!(Mounting::default().to_part(body), body);
    }
}
