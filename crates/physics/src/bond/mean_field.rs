//! From measured values to bonds, for random packings that are alike in all directions: an upper bound.
//!
//! All particles are taken to move as the mean does (Voigt). Real packings are softer by 10 to 40 % and have a larger
//! Poisson's ratio; one uniaxial test then corrects all stiffnesses, because the modulus is in proportion to them at a
//! fixed ratio, and the strength to the strengths of the bonds.
//!
//! # References
//! Bathurst & Rothenburg, J. Appl. Mech. 55 (1988) 17; Chang & Misra, J. Eng. Mech. 116 (1990) 1077.

use super::face_centred::UnreachablePoisson;
use std::f64::consts::PI;

/// A random packing of equal bonded spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packing {
    /// $\phi$, the part of the volume that is solid, in (0, 1).
    pub solid_fraction: f64,
    /// $Z$, bonds to a particle.
    pub coordination: f64,
    /// $R$, m; bonds are $2R$ long.
    pub radius: f64,
}

impl Packing {
    /// $\phi Z/(\pi R)$, 1/m.
    fn density(self) -> f64 {
        self.solid_fraction * self.coordination / (PI * self.radius)
    }
    /// $K = \phi ZK_n/(6\pi R)$, Pa.
    #[must_use]
    pub fn bulk_modulus(self, normal_stiffness: f64) -> f64 {
        self.density() * normal_stiffness / 6.0
    }
    /// $G = \phi Z(2K_n + 3K_s)/(20\pi R)$, Pa.
    #[must_use]
    pub fn shear_modulus(self, normal_stiffness: f64, stiffness_ratio: f64) -> f64 {
        self.density() * normal_stiffness * (2.0 + 3.0 * stiffness_ratio) / 20.0
    }
    /// $E = \phi ZK_n(2+3\kappa)/(2\pi R(4+\kappa))$, Pa.
    #[must_use]
    pub fn young_modulus(self, normal_stiffness: f64, stiffness_ratio: f64) -> f64 {
        normal_stiffness * self.young_modulus_per_stiffness(stiffness_ratio)
    }
    /// The normal stiffness that gives a Young's modulus, N/m.
    #[must_use]
    pub fn normal_stiffness(self, young_modulus: f64, stiffness_ratio: f64) -> f64 {
        young_modulus / self.young_modulus_per_stiffness(stiffness_ratio)
    }
    fn young_modulus_per_stiffness(self, stiffness_ratio: f64) -> f64 {
        self.density() * (2.0 + 3.0 * stiffness_ratio) / (2.0 * (4.0 + stiffness_ratio))
    }
}

/// $\nu = (1-\kappa)/(4+\kappa)$.
#[must_use]
pub fn poisson_ratio(stiffness_ratio: f64) -> f64 {
    (1.0 - stiffness_ratio) / (4.0 + stiffness_ratio)
}

/// The ratio of stiffnesses that gives a Poisson's ratio: $\kappa = (1-4\nu)/(1+\nu)$.
///
/// # Errors
/// [`UnreachablePoisson`] unless $0 \le \nu \le 1/4$ ($1 \ge \kappa \ge 0$).
pub fn stiffness_ratio(poisson_ratio: f64) -> Result<f64, UnreachablePoisson> {
    let nu = UnreachablePoisson::check(poisson_ratio, 0.25)?;
    Ok((1.0 - 4.0 * nu) / (1.0 + nu))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PACKING: Packing = Packing { solid_fraction: 0.6, coordination: 6.0, radius: 1e-3 };

    #[test]
    fn moduli_belong_together() {
        for ratio in [0.0, 0.2, 0.4, 1.0] {
            let stiffness = 1e7;
            let (bulk, shear) = (PACKING.bulk_modulus(stiffness), PACKING.shear_modulus(stiffness, ratio));
            let young = PACKING.young_modulus(stiffness, ratio);
            let nu = poisson_ratio(ratio);
            assert!((young / (9.0 * bulk * shear / (3.0 * bulk + shear)) - 1.0).abs() < 1e-14);
            assert!((nu - (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear))).abs() < 1e-15);
            assert!((PACKING.normal_stiffness(young, ratio) / stiffness - 1.0).abs() < 1e-14);
            assert!((stiffness_ratio(nu).unwrap() - ratio).abs() < 1e-14);
        }
        assert_eq!(stiffness_ratio(0.3).unwrap_err().greatest, 0.25);
    }

    /// The mean over all directions of the same sum over bonds that is exact for the lattice: $K$ depends on the solid
    /// fraction and the coordination only, so the lattice's must come out.
    #[test]
    fn bulk_modulus_of_the_lattice() {
        let lattice_constant = 2.0 * std::f64::consts::SQRT_2 * 1e-3;
        let lattice =
            Packing { solid_fraction: PI / (3.0 * std::f64::consts::SQRT_2), coordination: 12.0, radius: 1e-3 };
        let exact = super::super::face_centred::CubicElasticity::of_bonds(1e7, 3e6, lattice_constant).bulk_modulus();
        assert!((lattice.bulk_modulus(1e7) / exact - 1.0).abs() < 1e-14);
    }
}
