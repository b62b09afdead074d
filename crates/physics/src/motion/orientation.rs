//! Which way a particle is turned: unit quaternions, lab from body.

use crate::{Real, Vec3};

/// A quaternion $q = (\mathbf u, w)$; a unit one is a rotation, here always `lab_from_body`: it takes a vector fixed in the
/// body to the laboratory. $q$ and $-q$ are the same rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion<R> {
    /// $\mathbf u$, the axis times the sine of half the angle.
    pub vector: Vec3<R>,
    /// $w$, the cosine of half the angle.
    pub scalar: R,
}

impl<R: Real> Quaternion<R> {
    /// No rotation.
    #[inline(always)]
    #[must_use]
    pub fn identity() -> Self {
        Quaternion { vector: Vec3::zero(), scalar: R::lit(1.0) }
    }

    /// A vector turned by a unit quaternion: $\mathbf v + 2w\,\mathbf u\times\mathbf v + 2\mathbf u\times(\mathbf
    /// u\times\mathbf v)$.
    ///
    /// # Numerics
    /// Exactly odd in `vector`.
    ///
    /// # Example
    /// ```
    /// use tdem_physics::{motion::orientation::Quaternion, vec3};
    /// // A third of a turn about the diagonal takes x to y.
    /// let third = Quaternion { vector: vec3(0.5, 0.5, 0.5), scalar: 0.5 };
    /// assert_eq!(third.rotate(vec3(1.0, 0.0, 0.0)), vec3(0.0, 1.0, 0.0));
    /// ```
    #[inline(always)]
    #[must_use]
    pub fn rotate(self, vector: Vec3<R>) -> Vec3<R> {
        let twice = (self.vector * R::lit(2.0)).cross(vector);
        vector + twice * self.scalar + self.vector.cross(twice)
    }

    /// The quaternion of $q\,p^*$, the rotation that takes `earlier` $p$ to this one, as seen in the laboratory.
    ///
    /// # Numerics
    /// Exchanging the two negates the vector part exactly and keeps the scalar part.
    #[inline(always)]
    #[must_use]
    pub fn from_earlier(self, earlier: Self) -> Self {
        let straight = self.vector * earlier.scalar - earlier.vector * self.scalar;
        Quaternion {
            vector: straight - self.vector.cross(earlier.vector),
            scalar: self.scalar * earlier.scalar + self.vector.dot(earlier.vector),
        }
    }

    /// The rotation vector $2\operatorname{sign}(w)\,\mathbf u$ of a small rotation, rad.
    ///
    /// # Validity
    /// Its length is $2\sin(\theta/2) = \theta - \theta^3/24 + \dots$: within 0.1 % up to 0.15 rad. It grows up to half a
    /// turn and falls beyond.
    #[inline(always)]
    #[must_use]
    pub fn rotation_vector(self) -> Vec3<R> {
        let two = R::lit(2.0);
        self.vector * R::select(self.scalar.lt(R::lit(0.0)), -two, two)
    }

    /// The orientation after a step at angular velocity $\boldsymbol\omega$ (in the laboratory):
    /// $q \leftarrow q + \tfrac{\Delta t}2(\boldsymbol\omega, 0)\,q$, then made a unit quaternion again.
    ///
    /// | argument | symbol | unit |
    /// |---|---|---|
    /// | `angular_velocity` | $\boldsymbol\omega$, best that of the middle of the step | rad/s |
    /// | `step` | $\Delta t$ | s |
    ///
    /// # Numerics
    /// A constant $\boldsymbol\omega$ turns about the right axis by $2\arctan(\omega\Delta t/2)$ instead of
    /// $\omega\Delta t$: second order. The length is restored with a square root, so it stays 1 to rounding however
    /// large a step is.
    #[inline(always)]
    #[must_use]
    pub fn turned(self, angular_velocity: Vec3<R>, step: R) -> Self {
        let half = angular_velocity * (R::lit(0.5) * step);
        let vector = self.vector + (half * self.scalar + half.cross(self.vector));
        let scalar = self.scalar - half.dot(self.vector);
        let inverse = R::lit(1.0) / (vector.dot(vector) + scalar * scalar).sqrt();
        Quaternion { vector: vector * inverse, scalar: scalar * inverse }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3;

    fn about(axis: Vec3<f64>, angle: f64) -> Quaternion<f64> {
        Quaternion { vector: axis * libm::sin(0.5 * angle), scalar: libm::cos(0.5 * angle) }
    }

    #[test]
    fn a_constant_spin_turns_by_twice_the_arc_tangent() {
        let (axis, rate, step) = (vec3(0.6, 0.0, 0.8), 3.0, 0.01);
        let mut orientation = Quaternion::identity();
        for _ in 0..1000 {
            orientation = orientation.turned(axis * rate, step);
        }
        let expected = about(axis, 1000.0 * 2.0 * libm::atan(0.5 * rate * step));
        let difference = orientation.from_earlier(expected).rotation_vector();
        assert!(difference.dot(difference).sqrt() < 1e-12, "{difference:?}");
        let length = orientation.vector.dot(orientation.vector) + orientation.scalar * orientation.scalar;
        assert!((length - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_rotation_vector_does_not_know_the_sign_of_the_quaternion() {
        let small = about(vec3(0.0, 1.0, 0.0), 1e-3);
        let other = Quaternion { vector: -small.vector, scalar: -small.scalar };
        assert_eq!(small.rotation_vector(), other.rotation_vector());
        assert!((small.rotation_vector().y - 1e-3).abs() < 1e-10);
    }

    #[test]
    fn what_leads_from_one_orientation_to_another() {
        let (first, second) = (about(vec3(0.6, 0.0, 0.8), 1.1), about(vec3(0.0, 0.8, -0.6), -0.7));
        let v = vec3(0.3, -0.2, 0.9);
        let difference = second.from_earlier(first).rotate(first.rotate(v)) - second.rotate(v);
        assert!(difference.dot(difference).sqrt() < 1e-15);
        let back = first.from_earlier(second);
        let there = second.from_earlier(first);
        assert_eq!((back.vector, back.scalar), (-there.vector, there.scalar));
    }
}
