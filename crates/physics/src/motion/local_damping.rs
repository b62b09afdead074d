//! Damping that needs no neighbours: every component of force loses a part of itself where it does work.

use crate::{Real, Vec3};

/// Local, non-viscous damping: $F_c \leftarrow F_c - \alpha|F_c|\operatorname{sign}(v_c)$ for each component $c$; with a
/// moment and an angular velocity the same for rotation.
///
/// | argument | symbol | unit | range |
/// |---|---|---|---|
/// | `force` | $\mathbf F$, the sum of everything, or $\mathbf M$ | N or N m | |
/// | `velocity` | $\mathbf v$ or $\boldsymbol\omega$ | m/s or rad/s | |
/// | `coefficient` | $\alpha$, usually 0.7 | 1 | [0, 1) |
///
/// # Returns
/// The damped force. The power it takes is $(\mathbf F - \mathbf F_{damped})\cdot\mathbf v \ge 0$.
///
/// # Validity
/// For states that are sought, not ways that lead there: it takes the same part of every mode per cycle, also of rigid
/// motion, it depends on the frame, and on the axes. Not for impacts or waves.
///
/// # Example
/// ```
/// use tdem_physics::{motion::local_damping::damped, vec3};
/// // Reduced along the motion, raised against it, whole where nothing moves.
/// let force = damped(vec3(10.0, -10.0, 10.0), vec3(1.0, 1.0, 0.0), 0.5);
/// assert_eq!(force, vec3(5.0, -15.0, 10.0));
/// ```
///
/// # References
/// Cundall, in *Analytical and Computational Methods in Engineering Rock Mechanics* (1987) 129; Potyondy & Cundall,
/// Int. J. Rock Mech. Min. Sci. 41 (2004) 1329.
#[inline(always)]
#[must_use]
pub fn damped<R: Real>(force: Vec3<R>, velocity: Vec3<R>, coefficient: R) -> Vec3<R> {
    let zero = R::lit(0.0);
    let one = |force: R, velocity: R| {
        let taken = coefficient * force.abs();
        let against = R::select(velocity.lt(zero), force + taken, force);
        R::select(velocity.gt(zero), force - taken, against)
    };
    Vec3 { x: one(force.x, velocity.x), y: one(force.y, velocity.y), z: one(force.z, velocity.z) }
}
