//! How a particle moves under a force.

pub mod gear;
pub mod local_damping;
pub mod orientation;
pub mod ramp;
pub mod verlet;

use crate::Real;

/// Moment of inertia of a solid sphere, $I = \tfrac25mR^2$, kg m².
#[inline(always)]
pub fn sphere_inertia<R: Real>(mass: R, radius: R) -> R {
    R::lit(0.4) * mass * radius * radius
}
