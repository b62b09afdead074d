//! Stored vectors go along when a bond turns.

use crate::{Real, Vec3};

/// How a bond turned in one step: first the normal, by the shortest way, then about the normal, with the mean spin of
/// the bodies.
#[derive(Clone, Copy, Debug)]
pub struct Turning<R> {
    normal: Vec3<R>,
    /// $\mathbf n_{old}\times\mathbf n$.
    axis: Vec3<R>,
    /// $c = \mathbf n_{old}\cdot\mathbf n$.
    cosine: R,
    /// $1/(1+c)$.
    straightening: R,
    /// Cosine and sine of the angle about the normal.
    spin: (R, R),
}

impl<R: Real> Turning<R> {
    /// From the earlier normal to the present one, with the angular velocities of both bodies (rad/s) over a step (s).
    ///
    /// # Numerics
    /// Exact in a rigid rotation at a constant angular velocity that turns by $2\arctan(\omega\Delta t/2)$ in a step: both
    /// normals have the same component of it.
    #[inline(always)]
    #[must_use]
    pub fn of([earlier_normal, normal]: [Vec3<R>; 2], [first_spin, second_spin]: [Vec3<R>; 2], step: R) -> Self {
        let one = R::lit(1.0);
        let cosine = earlier_normal.dot(normal).named("cosine");
        // The tangent of half the angle.
        let tangent = (R::lit(0.25) * step * (first_spin + second_spin).dot(normal)).named("tangent");
        let square = tangent * tangent;
        let inverse = one / (one + square);
        Turning {
            normal,
            axis: earlier_normal.cross(normal).named(["axis_x", "axis_y", "axis_z"]),
            cosine,
            straightening: (one / (one + cosine)).named("straightening"),
            spin: (((one - square) * inverse).named("spin_cosine"), ((tangent + tangent) * inverse).named("spin_sine")),
        }
    }

    /// A vector turned with the normal, by Rodrigues' formula.
    ///
    /// $$\mathbf F \leftarrow c\,\mathbf F + \mathbf v\times\mathbf F + \frac{\mathbf v\cdot\mathbf F}{1+c}\,\mathbf v,\qquad
    /// \mathbf v = \mathbf n_{old}\times\mathbf n,\ c = \mathbf n_{old}\cdot\mathbf n$$
    ///
    /// # Numerics
    /// Exact for any vector and angle below half a turn. Projection loses $2\pi^2/N$ of a vector per revolution in $N$
    /// steps, projection and rescaling turns what is not in the plane of rotation, and Potyondy & Cundall's cross
    /// product gains $2\pi^2/N$.
    #[inline(always)]
    #[must_use]
    pub fn with_normal(&self, vector: Vec3<R>) -> Vec3<R> {
        let along = self.axis.dot(vector) * self.straightening;
        vector * self.cosine + self.axis.cross(vector) + self.axis * along
    }

    /// A vector across the normal turned about it, and what rounding left along the normal taken out.
    ///
    /// $$\mathbf F \leftarrow \frac{(1-t^2)\mathbf F + 2t\,\mathbf n\times\mathbf F}{1+t^2},\qquad
    /// t = \tfrac14\Delta t(\boldsymbol\omega_1+\boldsymbol\omega_2)\cdot\mathbf n$$
    ///
    /// # Numerics
    /// Cayley's form of a rotation: the length is kept whatever $t$ is, the angle is right to third order, and no sine is
    /// needed.
    #[inline(always)]
    #[must_use]
    pub fn about_normal(&self, vector: Vec3<R>) -> Vec3<R> {
        let (cosine, sine) = self.spin;
        let spun = vector * cosine + self.normal.cross(vector) * sine;
        spun - self.normal * spun.dot(self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3;
    use std::f64::consts::PI;

    /// One revolution about z of a force (0, 1, 0.5) across a bond along x. Golden: `rodrigues` in
    /// gear_bond_reference.out gives (0, 1, 0.5) for 100, 1000 and 10000 steps.
    #[test]
    fn a_revolution_brings_a_stored_force_back() {
        for steps in [100, 1000, 10_000] {
            let mut force = vec3(0.0, 1.0, 0.5);
            let mut normal = vec3(1.0, 0.0, 0.0);
            for k in 1..=steps {
                let angle = 2.0 * PI * f64::from(k) / f64::from(steps);
                let next = vec3(libm::cos(angle), libm::sin(angle), 0.0);
                let spin = vec3(0.0, 0.0, 2.0 * PI);
                let turning = Turning::of([normal, next], [spin, spin], 1.0 / f64::from(steps));
                force = turning.about_normal(turning.with_normal(force));
                normal = next;
            }
            let error = force - vec3(0.0, 1.0, 0.5);
            assert!(error.dot(error).sqrt() < 1e-11, "{steps}: {force:?}");
        }
    }

    #[test]
    fn spin_about_the_normal_keeps_the_length_and_turns_by_the_angle() {
        let normal = vec3(0.0, 0.0, 1.0);
        let (rate, step) = (0.1, 1.0);
        let spin = normal * rate;
        let turned = Turning::of([normal, normal], [spin, spin], step).about_normal(vec3(2.0, 0.0, 0.0));
        assert!((turned.dot(turned).sqrt() - 2.0).abs() < 1e-15);
        let angle = libm::atan2(turned.y, turned.x);
        assert!((angle - 2.0 * libm::atan(0.05)).abs() < 1e-15 && (angle - 0.1).abs() < 0.1 * 0.1 * 0.1 / 11.0);
    }
}
