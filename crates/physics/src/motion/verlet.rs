//! Velocity Verlet: half kick, drift, new forces, half kick.

use crate::{Real, Vec3};

/// A kick: $\mathbf v \leftarrow \mathbf v + \frac{\Delta t}{m}\,\mathbf F$; with a moment, an inertia and an angular
/// velocity the same for rotation.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `velocity` | $\mathbf v$ or $\boldsymbol\omega$ | m/s or rad/s |
/// | `force` | $\mathbf F$ or $\mathbf M$ | N or N m |
/// | `mass` | $m$ or $I$ | kg or kg m² |
/// | `step` | the part of the step to advance, usually $\Delta t/2$ | s |
///
/// # Numerics
/// Angular velocity is kicked by halves exactly like velocity; Euler's rule for it would lose angular momentum
/// (7e-3 relative in a bonded pair, against 1e-14).
///
/// # References
/// Swope, Andersen, Berens & Wilson, J. Chem. Phys. 76 (1982) 637.
#[inline(always)]
#[must_use]
pub fn kick<R: Real>(velocity: Vec3<R>, force: Vec3<R>, mass: R, step: R) -> Vec3<R> {
    velocity + force * (step / mass)
}

/// The drift: $\mathbf x \leftarrow \mathbf x + \mathbf v\,\Delta t$.
#[inline(always)]
#[must_use]
pub fn drift<R: Real>(position: Vec3<R>, velocity: Vec3<R>, step: R) -> Vec3<R> {
    position + velocity * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3;

    #[test]
    fn constant_acceleration_is_exact() {
        let (step, g) = (0.125, -9.5);
        let (mut x, mut v) = (Vec3::zero(), vec3(0.0, 0.0, 2.0));
        let force = vec3(0.0, 0.0, 3.0 * g);
        for _ in 0..64 {
            v = kick(v, force, 3.0, 0.5 * step);
            x = drift(x, v, step);
            v = kick(v, force, 3.0, 0.5 * step);
        }
        let t = 64.0 * step;
        assert!((x.z - (2.0 * t + 0.5 * g * t * t)).abs() < 1e-11);
    }
}
