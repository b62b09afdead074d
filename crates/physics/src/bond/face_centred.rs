//! From measured values to bonds, for touching spheres on a face-centred cubic lattice: exact, because every particle is
//! a centre of symmetry.
//!
//! Lattice constant $a$, bonds of length $a/\sqrt2 = 2R$, twelve to a particle; loads along a cube axis.
//! A Young's modulus, a Poisson's ratio and a tensile strength give a bond in four steps:
//!
//! ```
//! use tdem_physics::bond::{Bond, Cement, Section, face_centred};
//! let (young_modulus, poisson_ratio, tensile_strength) = (23.2e9, 0.2, 8.1e6); // refractory concrete
//! let lattice_constant = 0.2 / 28.0;
//! let radius = 0.5 * face_centred::bond_length(lattice_constant);
//! let ratio = face_centred::stiffness_ratio(poisson_ratio)?;
//! let cement = Cement {
//!     stiffness_ratio: ratio,
//!     radius_multiplier: 1.0,
//!     tensile_strength: face_centred::tensile_stress(tensile_strength, ratio, 1.0),
//!     shear_strength: 3.0 * face_centred::shear_stress(tensile_strength, ratio, 1.0),
//!     internal_friction: 0.0,
//!     moment_contribution: 1.0,
//!     damping_ratio: 0.05,
//! };
//! let section = Section::between(cement.radius_multiplier, radius, radius);
//! let stiffness = face_centred::normal_stiffness(young_modulus, ratio, lattice_constant);
//! let bond = Bond::new(&cement, &section, stiffness / section.area);
//! assert!((bond.stiffness.normal / (young_modulus * lattice_constant / 2.4) - 1.0).abs() < 1e-12);
//! assert!((bond.tensile_strength / 2.43e6 - 1.0).abs() < 1e-3);
//! # Ok::<(), face_centred::UnreachablePoisson>(())
//! ```
//!
//! # References
//! Sums over the lattice as in M. Born & K. Huang, *Dynamical Theory of Crystal Lattices* (1954).

use std::f64::consts::{PI, SQRT_2};

/// A Poisson's ratio that no bonds of this kind give.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a Poisson's ratio of {poisson_ratio} cannot be reached: allowed is {least} to {greatest:.4}")]
pub struct UnreachablePoisson {
    /// What was asked for.
    pub poisson_ratio: f64,
    /// The least that can be had, with shear springs as stiff as normal ones.
    pub least: f64,
    /// The greatest that can be had, without shear springs.
    pub greatest: f64,
}

impl UnreachablePoisson {
    /// `poisson_ratio`, if it lies between 0 and `greatest`.
    pub(super) fn check(poisson_ratio: f64, greatest: f64) -> Result<f64, UnreachablePoisson> {
        let least = 0.0;
        if (least..=greatest).contains(&poisson_ratio) {
            Ok(poisson_ratio)
        } else {
            Err(UnreachablePoisson { poisson_ratio, least, greatest })
        }
    }
}

/// $L_0 = a/\sqrt2$, m, twice the radius of the spheres.
#[must_use]
pub fn bond_length(lattice_constant: f64) -> f64 {
    lattice_constant / SQRT_2
}

/// The ratio of stiffnesses that gives a Poisson's ratio along the cube axes: $\kappa = (1-3\nu)/(1+\nu)$.
///
/// # Errors
/// [`UnreachablePoisson`] unless $0 \le \nu \le 1/3$ ($1 \ge \kappa \ge 0$).
///
/// # Example
/// ```
/// use tdem_physics::bond::face_centred::stiffness_ratio;
/// assert!((stiffness_ratio(0.2)? - 1.0 / 3.0).abs() < 1e-15); // concrete
/// assert!((stiffness_ratio(0.3)? - 0.076_923).abs() < 1e-6); // steel
/// assert!(stiffness_ratio(0.4).is_err());
/// # Ok::<(), tdem_physics::bond::face_centred::UnreachablePoisson>(())
/// ```
pub fn stiffness_ratio(poisson_ratio: f64) -> Result<f64, UnreachablePoisson> {
    let nu = UnreachablePoisson::check(poisson_ratio, 1.0 / 3.0)?;
    // At 1/3 rounding may leave less than nothing.
    Ok(((1.0 - 3.0 * nu) / (1.0 + nu)).max(0.0))
}

/// The normal stiffness that gives a Young's modulus along the cube axes, N/m:
/// $K_n = \dfrac{Ea}4\,\dfrac{3+\kappa}{1+3\kappa}$. The radius of the bonds does not enter: it matters to moments and
/// stresses only.
#[must_use]
pub fn normal_stiffness(young_modulus: f64, stiffness_ratio: f64, lattice_constant: f64) -> f64 {
    young_modulus * lattice_constant * (3.0 + stiffness_ratio) / (4.0 * (1.0 + 3.0 * stiffness_ratio))
}

/// Elastic constants of a cubic crystal, Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicElasticity {
    /// $C_{11}$.
    pub c11: f64,
    /// $C_{12}$.
    pub c12: f64,
    /// $C_{44}$.
    pub c44: f64,
}

impl CubicElasticity {
    /// Of the lattice of bonds: $C_{11} = 2(K_n+K_s)/a$, $C_{12} = (K_n-K_s)/a$, $C_{44} = (K_n+K_s)/a$. Bending and
    /// torsion do not enter a uniform strain.
    #[must_use]
    pub fn of_bonds(normal_stiffness: f64, shear_stiffness: f64, lattice_constant: f64) -> Self {
        let (sum, difference) = (normal_stiffness + shear_stiffness, normal_stiffness - shear_stiffness);
        CubicElasticity {
            c11: 2.0 * sum / lattice_constant,
            c12: difference / lattice_constant,
            c44: sum / lattice_constant,
        }
    }
    /// $E_{100} = C_{11} - 2C_{12}^2/(C_{11}+C_{12})$, Pa.
    #[must_use]
    pub fn young_modulus(self) -> f64 {
        self.c11 - 2.0 * self.c12 * self.c12 / (self.c11 + self.c12)
    }
    /// $\nu_{100} = C_{12}/(C_{11}+C_{12})$.
    #[must_use]
    pub fn poisson_ratio(self) -> f64 {
        self.c12 / (self.c11 + self.c12)
    }
    /// $(C_{11}+2C_{12})/3$, Pa.
    #[must_use]
    pub fn bulk_modulus(self) -> f64 {
        (self.c11 + 2.0 * self.c12) / 3.0
    }
    /// Zener's $2C_{44}/(C_{11}-C_{12})$: 1 where all directions are alike, which takes $\kappa = 1$ and $\nu = 0$.
    #[must_use]
    pub fn anisotropy(self) -> f64 {
        2.0 * self.c44 / (self.c11 - self.c12)
    }
}

/// The tensile stress in the most loaded bonds under a uniform stress $\Sigma$ along a cube axis, Pa:
/// $\sigma = \dfrac{\sqrt2(1+\kappa)}{\pi\bar\lambda^2(1+3\kappa)}\,\Sigma$. With a tensile strength for $\Sigma$ it is the
/// strength that bonds must have, $\sigma_{lim}$.
///
/// # Validity
/// A perfect lattice, stress uniform. Grips, edges and notches concentrate stress: measured strengths are up to 20 % less.
///
/// # Example
/// ```
/// use tdem_physics::bond::face_centred::tensile_stress;
/// assert!((tensile_stress(1.0, 1.0 / 3.0, 1.0) - 0.300_105).abs() < 1e-6);
/// ```
#[must_use]
pub fn tensile_stress(stress: f64, stiffness_ratio: f64, radius_multiplier: f64) -> f64 {
    SQRT_2 * (1.0 + stiffness_ratio) * stress / per_stress(stiffness_ratio, radius_multiplier)
}

/// The shear stress in the same bonds, Pa: $\tau = \dfrac{2\sqrt2\,\kappa}{\pi\bar\lambda^2(1+3\kappa)}\,\Sigma$. For
/// tension to govern, bonds need a shear strength of several times this (3 to 10).
#[must_use]
pub fn shear_stress(stress: f64, stiffness_ratio: f64, radius_multiplier: f64) -> f64 {
    2.0 * SQRT_2 * stiffness_ratio * stress / per_stress(stiffness_ratio, radius_multiplier)
}

fn per_stress(stiffness_ratio: f64, radius_multiplier: f64) -> f64 {
    PI * radius_multiplier * radius_multiplier * (1.0 + 3.0 * stiffness_ratio)
}

/// How much softer a block with open sides is than the lattice: $1 - 1/(4n_x) - 1/(4n_y)$ for a section of
/// $n_x\times n_y$ cells of area $n_xn_ya^2$, loaded along the third axis. It is the part of the bonds across a layer that
/// exist. Dividing stiffnesses by it restores the modulus, dividing conductances the conductivity.
///
/// # Validity
/// Exact for a block that cannot move sideways, and for the flow of heat between layers of given temperature. A block
/// in simple tension is another 0.4 % ($n = 5$) to 0.8 % ($n = 3$) softer at a stiffness ratio of 1/3.
///
/// # Panics
/// In debug builds, if there are no cells.
#[must_use]
pub fn open_sides(cells: [u32; 2]) -> f64 {
    debug_assert!(cells.iter().all(|&count| count > 0), "a section has cells");
    cells.iter().fold(1.0, |factor, &count| factor - 0.25 / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Golden: lattice_checks.out, direct sums over the bonds with $K_n = a = 1$.
    #[test]
    fn elastic_constants_of_the_lattice() {
        for (ratio, c11, c12, c44, young, poisson, zener) in [
            (1.0, 4.0, 0.0, 2.0, 4.0, 0.0, 1.0),
            (1.0 / 3.0, 2.666_667, 0.666_667, 1.333_333, 2.4, 0.2, 1.3333),
            (0.25, 2.5, 0.75, 1.25, 2.153_846, 0.230_769, 1.4286),
            (0.1, 2.2, 0.9, 1.1, 1.677_419, 0.290_323, 1.6923),
            (0.0, 2.0, 1.0, 1.0, 1.333_333, 0.333_333, 2.0),
        ] {
            let elasticity = CubicElasticity::of_bonds(1.0, ratio, 1.0);
            let close = |a: f64, b: f64, tolerance: f64| assert!((a - b).abs() < tolerance, "{ratio}: {a} {b}");
            close(elasticity.c11, c11, 1e-6);
            close(elasticity.c12, c12, 1e-6);
            close(elasticity.c44, c44, 1e-6);
            close(elasticity.young_modulus(), young, 1e-6);
            close(elasticity.poisson_ratio(), poisson, 1e-6);
            close(elasticity.anisotropy(), zener, 1e-4);
            close(elasticity.bulk_modulus(), 4.0 / 3.0, 1e-12);
            // And back.
            close(normal_stiffness(young, ratio, 1.0), 1.0, 1e-6);
            close(stiffness_ratio(elasticity.poisson_ratio()).unwrap(), ratio, 1e-12);
        }
    }

    /// Golden: lattice_checks.out.
    #[test]
    fn stresses_of_bonds_under_uniaxial_load() {
        for (ratio, tensile, shear) in [(1.0 / 3.0, 0.300_11, 0.150_05), (1.0, 0.225_08, 0.225_08)] {
            assert!((tensile_stress(1.0, ratio, 1.0) - tensile).abs() < 1e-5);
            assert!((shear_stress(1.0, ratio, 1.0) - shear).abs() < 1e-5);
            assert!((tensile_stress(1.0, ratio, 0.5) / tensile_stress(1.0, ratio, 1.0) - 4.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_poisson_ratio_out_of_reach_names_the_range() {
        let error = stiffness_ratio(0.4).unwrap_err();
        assert_eq!(error, UnreachablePoisson { poisson_ratio: 0.4, least: 0.0, greatest: 1.0 / 3.0 });
        assert_eq!(error.to_string(), "a Poisson's ratio of 0.4 cannot be reached: allowed is 0 to 0.3333");
        assert!(stiffness_ratio(-0.01).is_err() && stiffness_ratio(f64::NAN).is_err());
        assert_eq!(stiffness_ratio(0.0), Ok(1.0));
        assert_eq!(stiffness_ratio(1.0 / 3.0), Ok(0.0));
    }
}
