//! Rotations between the body (FRD) and the world (NED).
//!
//! A [`Quaternion`] `q` turns body coordinates into world coordinates: `v_ned = q · v_frd · q*`.
//! [`Euler`] angles are the intrinsic sequence heading ψ about down, pitch θ about right, roll φ
//! about front: `q = q_z(ψ) q_y(θ) q_x(φ)`. Angles in radians.

use core::ops::{Add, Mul, Sub};

use nalgebra::{Matrix3, Vector3};

use crate::Real;

/// A rotation as a unit quaternion (Hamilton's product, scalar first), body to world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion<T = f32> {
    /// Scalar part.
    pub w: T,
    /// First component of the vector part.
    pub x: T,
    /// Second component of the vector part.
    pub y: T,
    /// Third component of the vector part.
    pub z: T,
}

/// Roll, pitch and heading in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Euler<T = f32> {
    /// Roll φ about the body's front axis, −π to π.
    pub roll: T,
    /// Pitch θ about the intermediate right axis, −π/2 to π/2.
    pub pitch: T,
    /// Heading ψ about down, −π to π; 0 is north.
    pub yaw: T,
}

impl<T: Real> Default for Quaternion<T> {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl<T: Real> Quaternion<T> {
    /// No rotation: level, facing north.
    pub const IDENTITY: Self = Self {
        w: T::ONE,
        x: T::ZERO,
        y: T::ZERO,
        z: T::ZERO,
    };

    /// A quaternion from its four components, which should have norm 1.
    #[inline(always)]
    pub const fn new(w: T, x: T, y: T, z: T) -> Self {
        Self { w, x, y, z }
    }

    /// The opposite rotation.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self::new(self.w, -self.x, -self.y, -self.z)
    }

    /// Inner product of the components.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.w * other.w + self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The same rotation with norm 1. A quaternion of zeros becomes the identity.
    #[inline]
    pub fn normalized(self) -> Self {
        let norm = self.dot(self).sqrt();
        if norm > T::ZERO {
            let s = T::ONE / norm;
            Self::new(self.w * s, self.x * s, self.y * s, self.z * s)
        } else {
            Self::IDENTITY
        }
    }

    /// The same rotation, pulled towards norm 1 by one Newton step: exact to second order when
    /// the norm is near 1, as after a step of integration, and cheaper than a square root.
    #[inline(always)]
    pub fn renormalized(self) -> Self {
        let s = (T::of(3.0) - self.dot(self)) * T::HALF;
        Self::new(self.w * s, self.x * s, self.y * s, self.z * s)
    }

    /// The same rotation with a scalar part that is not negative: the shorter way round.
    #[inline(always)]
    pub fn shortest(self) -> Self {
        if self.w < T::ZERO {
            Self::new(-self.w, -self.x, -self.y, -self.z)
        } else {
            self
        }
    }

    /// Turns a vector from body into world coordinates.
    #[inline(always)]
    pub fn rotate(self, v: Vector3<T>) -> Vector3<T> {
        // v + 2w (q × v) + 2 q × (q × v), with t = 2 q × v
        let tx = T::TWO * (self.y * v.z - self.z * v.y);
        let ty = T::TWO * (self.z * v.x - self.x * v.z);
        let tz = T::TWO * (self.x * v.y - self.y * v.x);
        Vector3::new(
            v.x + self.w * tx + (self.y * tz - self.z * ty),
            v.y + self.w * ty + (self.z * tx - self.x * tz),
            v.z + self.w * tz + (self.x * ty - self.y * tx),
        )
    }

    /// Turns a vector from world into body coordinates.
    #[inline(always)]
    pub fn inverse_rotate(self, v: Vector3<T>) -> Vector3<T> {
        self.conjugate().rotate(v)
    }

    /// The body's down axis in the world: thrust acts along its negative.
    #[inline(always)]
    pub fn down_axis(self) -> Vector3<T> {
        Vector3::new(
            T::TWO * (self.x * self.z + self.w * self.y),
            T::TWO * (self.y * self.z - self.w * self.x),
            T::ONE - T::TWO * (self.x * self.x + self.y * self.y),
        )
    }

    /// Rotation about the vector's direction by its length in radians, by series: the error is
    /// below 1e-7 up to 1 rad, and below 1e-16 up to 0.05 rad. For steps of integration.
    #[inline(always)]
    pub fn from_small_rotation(v: Vector3<T>) -> Self {
        let half = T::HALF;
        let q = (v.x * v.x + v.y * v.y + v.z * v.z) * T::of(0.25);
        // cos and sinc of half the angle, q its square
        let c =
            T::ONE - q * half * (T::ONE - q * (T::ONE / T::of(12.0)) * (T::ONE - q * (T::ONE / T::of(30.0))));
        let s = half
            * (T::ONE
                - q * (T::ONE / T::of(6.0))
                    * (T::ONE - q * (T::ONE / T::of(20.0)) * (T::ONE - q * (T::ONE / T::of(42.0)))));
        Self::new(c, v.x * s, v.y * s, v.z * s)
    }

    /// Rotation about the vector's direction by its length in radians, of any length.
    pub fn from_rotation_vector(v: Vector3<T>) -> Self {
        let angle = (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
        if angle > T::HALF {
            let (s, c) = (angle * T::HALF).sin_cos();
            let s = s / angle;
            Self::new(c, v.x * s, v.y * s, v.z * s)
        } else {
            Self::from_small_rotation(v)
        }
    }

    /// The rotation of roll, pitch and heading.
    pub fn from_euler(e: Euler<T>) -> Self {
        let (sr, cr) = (e.roll * T::HALF).sin_cos();
        let (sp, cp) = (e.pitch * T::HALF).sin_cos();
        let (sy, cy) = (e.yaw * T::HALF).sin_cos();
        Self::new(
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        )
    }

    /// A rotation about down by `yaw` radians.
    pub fn from_heading(yaw: T) -> Self {
        let (s, c) = (yaw * T::HALF).sin_cos();
        Self::new(c, T::ZERO, T::ZERO, s)
    }

    /// Roll, pitch and heading. At a pitch of ±90° roll and heading turn about the same axis;
    /// some division between them comes out, and together the three still give the rotation.
    ///
    /// Half the sum and half the difference of roll and heading are found apart, each of which
    /// stays sharp where the other fades (Bernardes and Viollet, *Quaternion to Euler angles
    /// conversion*, 2022).
    pub fn to_euler(self) -> Euler<T> {
        let Self { w, x, y, z } = self;
        // (cos θ/2 + sin θ/2) times cosine and sine of (φ − ψ)/2
        let (c_less, s_less) = (w + y, x - z);
        // (cos θ/2 − sin θ/2) times cosine and sine of (φ + ψ)/2
        let (c_plus, s_plus) = (w - y, x + z);
        let less = c_less * c_less + s_less * s_less;
        let plus = c_plus * c_plus + s_plus * s_plus;
        let half_difference = s_less.atan2(c_less);
        let half_sum = s_plus.atan2(c_plus);
        Euler {
            roll: wrap_once(half_sum + half_difference),
            pitch: (T::TWO * (w * y - z * x)).atan2((less * plus).sqrt()),
            yaw: wrap_once(half_sum - half_difference),
        }
    }

    /// Heading ψ in radians, −π to π; with the nose straight up or down it means nothing.
    #[inline]
    pub fn heading(self) -> T {
        let Self { w, x, y, z } = self;
        (T::TWO * (w * z + x * y)).atan2(T::ONE - T::TWO * (y * y + z * z))
    }

    /// Cosine of the angle between the body's down axis and the world's.
    #[inline(always)]
    pub fn cos_tilt(self) -> T {
        T::ONE - T::TWO * (self.x * self.x + self.y * self.y)
    }

    /// The matrix that turns body into world coordinates.
    #[rustfmt::skip]
    pub fn to_matrix(self) -> Matrix3<T> {
        let Self { w, x, y, z } = self;
        let (one, two) = (T::ONE, T::TWO);
        Matrix3::new(
            one - two * (y * y + z * z), two * (x * y - w * z),       two * (x * z + w * y),
            two * (x * y + w * z),       one - two * (x * x + z * z), two * (y * z - w * x),
            two * (x * z - w * y),       two * (y * z + w * x),       one - two * (x * x + y * y),
        )
    }

    /// Whether every component is finite.
    pub fn is_finite(self) -> bool {
        // Zero times infinity or NaN is NaN, and equal to nothing.
        let zero = T::ZERO;
        self.w * zero == zero && self.x * zero == zero && self.y * zero == zero && self.z * zero == zero
    }
}

impl<T: Real> Mul for Quaternion<T> {
    type Output = Self;

    /// First the rotation on the right, then the one on the left.
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let a = self;
        Self::new(
            a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        )
    }
}

/// An angle of at most a turn either way, in radians, brought within ±π.
#[inline(always)]
fn wrap_once<T: Real>(angle: T) -> T {
    if angle > T::PI {
        angle - T::TWO * T::PI
    } else if angle < -T::PI {
        angle + T::TWO * T::PI
    } else {
        angle
    }
}

/// Body rate W(φ, θ)·(φ̇, θ̇, ψ̇), in rad/s, from the rates of change of the Euler angles.
#[inline]
pub fn body_rate_from_euler_rate<T: Real>(attitude: Euler<T>, rate: Euler<T>) -> Vector3<T> {
    let (sr, cr) = attitude.roll.sin_cos();
    let (sp, cp) = attitude.pitch.sin_cos();
    Vector3::new(
        rate.roll - sp * rate.yaw,
        cr * rate.pitch + sr * cp * rate.yaw,
        cr * cp * rate.yaw - sr * rate.pitch,
    )
}

impl<T: Real> Add for Euler<T> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            roll: self.roll + o.roll,
            pitch: self.pitch + o.pitch,
            yaw: self.yaw + o.yaw,
        }
    }
}

impl<T: Real> Sub for Euler<T> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self {
            roll: self.roll - o.roll,
            pitch: self.pitch - o.pitch,
            yaw: self.yaw - o.yaw,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use core::f64::consts::{FRAC_PI_2, PI};

    use proptest::num;
    use proptest::prelude::*;

    use super::*;

    /// The matrices of the three elementary rotations, body to world, written out.
    mod matrix {
        use nalgebra::Matrix3;

        #[rustfmt::skip]
        fn about_front(roll: f64) -> Matrix3<f64> {
            let (s, c) = libm::sincos(roll);
            Matrix3::new(
                1.0, 0.0, 0.0,
                0.0, c, -s,
                0.0, s, c,
            )
        }

        #[rustfmt::skip]
        fn about_right(pitch: f64) -> Matrix3<f64> {
            let (s, c) = libm::sincos(pitch);
            Matrix3::new(
                c, 0.0, s,
                0.0, 1.0, 0.0,
                -s, 0.0, c,
            )
        }

        #[rustfmt::skip]
        fn about_down(yaw: f64) -> Matrix3<f64> {
            let (s, c) = libm::sincos(yaw);
            Matrix3::new(
                c, -s, 0.0,
                s, c, 0.0,
                0.0, 0.0, 1.0,
            )
        }

        pub fn of_euler(e: super::Euler<f64>) -> Matrix3<f64> {
            about_down(e.yaw) * about_right(e.pitch) * about_front(e.roll)
        }

        /// Rodrigues' formula: I + sin(a) K + (1 − cos(a)) K², K the cross product by the axis.
        #[rustfmt::skip]
        pub fn of_rotation_vector(v: super::Vector3<f64>) -> Matrix3<f64> {
            let angle = v.dot(&v);
            let angle = libm::sqrt(angle);
            if angle == 0.0 {
                return Matrix3::identity();
            }
            let (s, c) = libm::sincos(angle);
            let u = v / angle;
            let k = Matrix3::new(
                0.0, -u.z, u.y,
                u.z, 0.0, -u.x,
                -u.y, u.x, 0.0,
            );
            Matrix3::identity() + k * s + k * k * (1.0 - c)
        }
    }

    fn euler(roll: f64, pitch: f64, yaw: f64) -> Euler<f64> {
        Euler { roll, pitch, yaw }
    }

    fn single(e: Euler<f64>) -> Euler<f32> {
        Euler {
            roll: e.roll as f32,
            pitch: e.pitch as f32,
            yaw: e.yaw as f32,
        }
    }

    fn double(q: Quaternion<f32>) -> Quaternion<f64> {
        Quaternion::new(q.w.into(), q.x.into(), q.y.into(), q.z.into())
    }

    fn vector(v: [f64; 3]) -> Vector3<f64> {
        Vector3::new(v[0], v[1], v[2])
    }

    /// Largest difference between the components of two quaternions.
    fn distance(a: Quaternion<f64>, b: Quaternion<f64>) -> f64 {
        let d = [a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z];
        d.iter().fold(0.0, |m, v| crate::max(m, v.abs()))
    }

    fn any_euler() -> impl Strategy<Value = Euler<f64>> {
        (-PI..PI, -FRAC_PI_2..FRAC_PI_2, -PI..PI).prop_map(|(roll, pitch, yaw)| euler(roll, pitch, yaw))
    }

    /// Euler angles of which the pitch is far enough from ±90° for the others to be sharp.
    fn sharp_euler() -> impl Strategy<Value = Euler<f64>> {
        (-3.1..3.1, -1.4..1.4, -3.1..3.1).prop_map(|(roll, pitch, yaw)| euler(roll, pitch, yaw))
    }

    fn any_vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
        [-size..size, -size..size, -size..size].prop_map(vector)
    }

    #[test]
    fn quarter_turns_go_where_the_frames_say() {
        let front = Vector3::new(1.0, 0.0, 0.0);
        let right = Vector3::new(0.0, 1.0, 0.0);
        let down = Vector3::new(0.0, 0.0, 1.0);
        let rolled = Quaternion::from_euler(euler(FRAC_PI_2, 0.0, 0.0));
        let pitched = Quaternion::from_euler(euler(0.0, FRAC_PI_2, 0.0));
        let turned = Quaternion::from_euler(euler(0.0, 0.0, FRAC_PI_2));
        // Rolled right, the right side points down; pitched up, the nose points up; turned by
        // 90° from north, the nose points east.
        assert!((rolled.rotate(right) - down).amax() < 1e-15);
        assert!((rolled.rotate(down) + right).amax() < 1e-15);
        assert!((pitched.rotate(front) + down).amax() < 1e-15);
        assert!((pitched.rotate(down) - front).amax() < 1e-15);
        assert!((turned.rotate(front) - right).amax() < 1e-15);
        assert!((turned.rotate(right) + front).amax() < 1e-15);
        assert_eq!(Quaternion::from_heading(FRAC_PI_2), turned);
        assert_eq!(Quaternion::<f64>::default().rotate(right), right);
    }

    #[test]
    fn normalising_nothing_gives_the_identity() {
        let zero = Quaternion::new(0.0_f32, 0.0, 0.0, 0.0);
        assert_eq!(zero.normalized(), Quaternion::IDENTITY);
        let q = Quaternion::new(2.0, -4.0, 4.0, 8.0).normalized();
        assert_eq!(q, Quaternion::new(0.2, -0.4, 0.4, 0.8));
    }

    #[test]
    fn renormalising_is_exact_to_second_order() {
        let q = Quaternion::from_euler(euler(0.3, -0.7, 2.0));
        for excess in [-1e-3, -1e-5, 1e-5, 1e-3] {
            let s = 1.0 + excess;
            let grown = Quaternion::new(q.w * s, q.x * s, q.y * s, q.z * s);
            let error = libm::sqrt(grown.renormalized().dot(grown.renormalized())) - 1.0;
            // (1 + e)(3 − (1 + e)²)/2 = 1 − 3/2 e² − e³/2
            assert!((error + 1.5 * excess * excess).abs() <= excess.abs() * excess * excess + 1e-15);
        }
    }

    #[test]
    fn the_shortest_of_two_has_a_positive_scalar_part() {
        let q = Quaternion::new(-0.2_f32, -0.4, 0.4, 0.8);
        assert_eq!(q.shortest(), Quaternion::new(0.2, 0.4, -0.4, -0.8));
        assert_eq!(q.shortest().shortest(), q.shortest());
        let flat = Quaternion::new(0.0, -1.0, 0.0, 0.0);
        assert_eq!(flat.shortest(), flat);
    }

    #[test]
    fn finite_is_every_component() {
        assert!(Quaternion::new(f32::MAX, f32::MAX, f32::MAX, f32::MIN).is_finite());
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(!Quaternion::new(bad, 0.0, 0.0, 0.0).is_finite());
            assert!(!Quaternion::new(0.0, bad, 0.0, 0.0).is_finite());
            assert!(!Quaternion::new(0.0, 0.0, bad, 0.0).is_finite());
            assert!(!Quaternion::new(0.0, 0.0, 0.0, bad).is_finite());
        }
    }

    #[test]
    fn a_small_rotation_is_as_accurate_as_it_says() {
        let axis = Vector3::new(0.6, -0.48, 0.64);
        let error = |angle: f64| {
            let (s, c) = libm::sincos(0.5 * angle);
            let exact = Quaternion::new(c, axis.x * s, axis.y * s, axis.z * s);
            distance(Quaternion::from_small_rotation(axis * angle), exact)
        };
        for i in 0..=1000 {
            let share = f64::from(i) / 1000.0;
            assert!(error(share) < 1e-7, "{:e} at {share}", error(share));
            // 1.1e-16 is half the spacing of f64 below 1
            assert!(
                error(0.05 * share) < 2.3e-16,
                "{:e} at {}",
                error(0.05 * share),
                0.05 * share
            );
        }
        assert_eq!(
            Quaternion::from_small_rotation(Vector3::<f32>::zeros()),
            Quaternion::IDENTITY
        );
    }

    #[test]
    fn near_a_right_angle_of_pitch_the_euler_angles_still_give_the_rotation() {
        for distance in [0.0, 1e-8, 1e-6, 1e-4, 1e-3, 1e-2] {
            for pitch in [FRAC_PI_2 - distance, distance - FRAC_PI_2] {
                for i in 0..100 {
                    let e = euler(0.06 * f64::from(i) - 3.0, pitch, 0.05 * f64::from(i) - 2.5);
                    let exact = matrix::of_euler(e);
                    let again = Quaternion::from_euler(e).to_euler();
                    let error = (matrix::of_euler(again) - exact).amax();
                    assert!(error < 1e-14, "{e:?} {again:?} {error:e}");
                    let again = Quaternion::from_euler(single(e)).to_euler();
                    let error = (Quaternion::from_euler(again).to_matrix().map(f64::from) - exact).amax();
                    assert!(error < 2e-6, "{e:?} {again:?} {error:e}");
                }
            }
        }
    }

    #[test]
    fn angles_add_and_subtract_one_by_one() {
        let a = euler(1.0, 2.0, 3.0);
        let b = euler(0.5, 0.25, -0.125);
        assert_eq!(a + b, euler(1.5, 2.25, 2.875));
        assert_eq!(a - b, euler(0.5, 1.75, 3.125));
    }

    proptest! {
        #[test]
        fn euler_angles_are_the_product_of_three_matrices(e in any_euler(), v in any_vector(10.0)) {
            let exact = matrix::of_euler(e);
            let q = Quaternion::from_euler(e);
            // some ten roundings of 1.1e-16 each, on both sides
            prop_assert!((q.to_matrix() - exact).amax() < 4e-15);
            prop_assert!((q.rotate(v) - exact * v).amax() < 1e-13);
            prop_assert!((q.inverse_rotate(v) - exact.transpose() * v).amax() < 1e-13);
            prop_assert!((q.down_axis() - exact.column(2)).amax() < 4e-15);
            prop_assert!((q.cos_tilt() - exact[(2, 2)]).abs() < 4e-15);
        }

        #[test]
        fn single_precision_is_right_to_its_last_digits(e in any_euler(), v in any_vector(10.0)) {
            let q = Quaternion::from_euler(single(e));
            let exact = matrix::of_euler(e);
            prop_assert!((q.to_matrix().map(f64::from) - exact).amax() < 1e-6);
            prop_assert!((q.rotate(v.map(|x| x as f32)).map(f64::from) - exact * v).amax() < 1e-5);
            prop_assert!((q.down_axis().map(f64::from) - exact.column(2)).amax() < 1e-6);
        }

        #[test]
        fn there_and_back_by_euler_angles(e in sharp_euler()) {
            let again = Quaternion::from_euler(e).to_euler();
            let d = again - e;
            prop_assert!(d.roll.abs() < 1e-14 && d.pitch.abs() < 1e-14 && d.yaw.abs() < 1e-14);
            prop_assert!((Quaternion::from_euler(e).heading() - again.yaw).abs() < 1e-14);
            let d = Quaternion::from_euler(single(e)).to_euler() - single(e);
            prop_assert!(d.roll.abs() < 5e-6 && d.pitch.abs() < 5e-6 && d.yaw.abs() < 5e-6, "{:?}", d);
        }

        #[test]
        fn euler_angles_stay_in_their_ranges(q in [num::f32::ANY; 4]) {
            // whatever the bits, even of norm other than 1, no panic and no NaN
            let q = Quaternion::new(q[0], q[1], q[2], q[3]);
            let e = q.to_euler();
            prop_assert!(e.roll.abs() <= core::f32::consts::PI);
            prop_assert!(e.pitch.abs() <= core::f32::consts::FRAC_PI_2);
            prop_assert!(e.yaw.abs() <= core::f32::consts::PI);
        }

        #[test]
        fn product_is_one_rotation_after_the_other(a in any_euler(), b in any_euler()) {
            let p = Quaternion::from_euler(a);
            let q = Quaternion::from_euler(b);
            let exact = matrix::of_euler(a) * matrix::of_euler(b);
            prop_assert!(((p * q).to_matrix() - exact).amax() < 1e-14);
            prop_assert!(distance(p * p.conjugate(), Quaternion::IDENTITY) < 4e-15);
            prop_assert!(distance((p * q).conjugate(), q.conjugate() * p.conjugate()) < 4e-15);
        }

        #[test]
        fn rotation_vectors_follow_rodrigues(v in any_vector(4.0), small in any_vector(0.2)) {
            for v in [v, small] {
                let exact = matrix::of_rotation_vector(v);
                // up to 0.5 rad the series, h = 0.25 half of it: the first neglected term of the
                // cosine is h⁸/8! = 3.8e-10, and the matrix has four times a quaternion's error
                let q = Quaternion::from_rotation_vector(v);
                prop_assert!((q.to_matrix() - exact).amax() < 1.6e-9);
                let q = Quaternion::from_rotation_vector(v.map(|x| x as f32));
                prop_assert!((double(q).to_matrix() - exact).amax() < 2e-6);
            }
        }

        #[test]
        fn heading_is_where_the_nose_points(e in sharp_euler()) {
            let q = Quaternion::from_euler(e);
            let nose = matrix::of_euler(e).column(0).into_owned();
            prop_assert!((q.heading() - libm::atan2(nose.y, nose.x)).abs() < 1e-14);
            prop_assert!((Quaternion::from_heading(e.yaw).heading() - e.yaw).abs() < 1e-15);
        }

        #[test]
        fn body_rate_is_the_rate_of_the_quaternion(e in any_euler(), r in any_vector(3.0)) {
            // dq/dt = q (0, w)/2, so w = 2 q* dq/dt: by a central difference
            let rate = euler(r.x, r.y, r.z);
            let h = 1e-5;
            let step = euler(r.x * h, r.y * h, r.z * h);
            let after = Quaternion::from_euler(e + step);
            let before = Quaternion::from_euler(e - step);
            let change = Quaternion::new(
                after.w - before.w,
                after.x - before.x,
                after.y - before.y,
                after.z - before.z,
            );
            let w = Quaternion::from_euler(e).conjugate() * change;
            let expected = Vector3::new(w.x, w.y, w.z) / h;
            let computed = body_rate_from_euler_rate(e, rate);
            prop_assert!((computed - expected).amax() < 1e-8, "{} {}", computed, expected);
        }

        #[test]
        fn normalised_is_of_norm_one(q in [-9.0_f32..9.0, -9.0_f32..9.0, -9.0_f32..9.0, 0.1_f32..9.0]) {
            let q = Quaternion::new(q[0], q[1], q[2], q[3]);
            let n = double(q.normalized());
            prop_assert!((n.dot(n) - 1.0).abs() < 5e-7);
            prop_assert!(n.dot(double(q)) > 0.0);
        }
    }
}
