//! The four ways in which a bond gives way: stretching, shearing, twisting, bending.

use crate::{Real, Vec3};

/// One quantity for each way in which a bond gives way: deformations (m, m, rad, rad), their rates, or the forces and
/// moments on the first body (N, N, N m, N m). Deformations and rates are those of the second body relative to the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modes<R> {
    /// Along the normal; positive when stretched or in tension. Even under exchange of the bodies.
    pub normal: R,
    /// Across the normal. Odd.
    pub shear: Vec3<R>,
    /// About the normal. Even.
    pub torsion: R,
    /// About an axis across the normal. Odd.
    pub bending: Vec3<R>,
}

/// One coefficient for each way: stiffnesses (N/m, N/m, N m, N m), or coefficients of dashpots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<R> {
    /// Along the normal.
    pub normal: R,
    /// Across the normal.
    pub shear: R,
    /// About the normal.
    pub torsion: R,
    /// About an axis across the normal.
    pub bending: R,
}

impl<R: Real> Modes<R> {
    /// Each way with its coefficient: deformation and stiffness give the load.
    #[inline(always)]
    #[must_use]
    pub fn times(&self, coefficients: &Coefficients<R>) -> Self {
        Modes {
            normal: self.normal * coefficients.normal,
            shear: self.shear * coefficients.shear,
            torsion: self.torsion * coefficients.torsion,
            bending: self.bending * coefficients.bending,
        }
    }
    /// The sum, way by way.
    #[inline(always)]
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Modes {
            normal: self.normal + other.normal,
            shear: self.shear + other.shear,
            torsion: self.torsion + other.torsion,
            bending: self.bending + other.bending,
        }
    }
    /// What a load does per unit of its motion: the power (W) of a load (N, N m) at rates (m/s, rad/s).
    #[inline(always)]
    #[must_use]
    pub fn dot(&self, motion: &Self) -> R {
        let forces = self.normal * motion.normal + self.shear.dot(motion.shear);
        let moments = self.torsion * motion.torsion + self.bending.dot(motion.bending);
        forces + moments
    }
    /// The same, remembered where names exist as the load of a bond.
    #[inline(always)]
    #[must_use]
    pub(super) fn named_load(self) -> Self {
        Modes {
            normal: self.normal.named("normal_force"),
            shear: self.shear.named(["shear_force_x", "shear_force_y", "shear_force_z"]),
            torsion: self.torsion.named("torsion_moment"),
            bending: self.bending.named(["bending_moment_x", "bending_moment_y", "bending_moment_z"]),
        }
    }
}

impl<R: Real> Coefficients<R> {
    /// The same factor for both forces, another for both moments.
    #[inline(always)]
    #[must_use]
    pub fn scaled(&self, forces: R, moments: R) -> Self {
        Coefficients {
            normal: self.normal * forces,
            shear: self.shear * forces,
            torsion: self.torsion * moments,
            bending: self.bending * moments,
        }
    }
}
