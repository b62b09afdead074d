//! What a bond is made of: the section of the beam, its stiffnesses, and what its strength needs.

use super::{Coefficients, Damping, damping};
use crate::Real;
use crate::contact::Sphere;
use std::f64::consts::PI;

/// What bonds of one kind have in common, whatever their size. P&C's cement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cement<R> {
    /// $\kappa = \bar k_s/\bar k_n$, at least 0 (PFC's `kratio` is $1/\kappa$).
    pub stiffness_ratio: R,
    /// $\bar\lambda$: bond radius over the smaller particle radius, positive.
    pub radius_multiplier: R,
    /// $\sigma_{lim}$, Pa; infinite forbids this failure.
    pub tensile_strength: R,
    /// $\tau_{lim}$ where nothing presses or pulls (cohesion $\bar c$), Pa; infinite forbids this failure.
    pub shear_strength: R,
    /// $\tan\bar\varphi$ of Mohr and Coulomb, at least 0; 0 gives the same shear strength under any pressure.
    pub internal_friction: R,
    /// $\bar\beta$ in [0, 1]: how much moments add to stresses. 1 is Potyondy & Cundall (2004).
    pub moment_contribution: R,
    /// $\zeta_b$ of the dashpots, at least 0; see [`super::damping`].
    pub damping_ratio: R,
}

/// What joins two materials: a cement, and how stiff it is under tension.
///
/// A bond of length $L_b$ has $\bar k_n = \bar k + \bar E/L_b$; usually one of the two is 0. The first is for lattices,
/// whose bonds are then alike to the last bit whatever rounding did to their lengths, the second for packings with bonds
/// of many lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<R> {
    /// All but the normal stiffness.
    pub cement: Cement<R>,
    /// $\bar k$, Pa/m, at least 0: the same for bonds of any length.
    pub stiffness_per_area: R,
    /// $\bar E$, Pa, at least 0: Young's modulus.
    pub young_modulus: R,
}

impl<R: Real> Joint<R> {
    /// The bond between two particles, without dashpots.
    ///
    /// | argument | symbol | unit |
    /// |---|---|---|
    /// | `first_radius`, `second_radius` | $R_1, R_2$ | m |
    /// | `bonded_length` | $L_b$, the length at bonding | m |
    /// | `strength` | factor on both strengths, 1 without scatter | 1 |
    ///
    /// # Example
    /// ```
    /// use tdem_physics::bond::{Cement, Joint};
    /// let cement = Cement {
    ///     stiffness_ratio: 0.4,
    ///     radius_multiplier: 1.0,
    ///     tensile_strength: 10e6,
    ///     shear_strength: 30e6,
    ///     internal_friction: 0.0,
    ///     moment_contribution: 1.0,
    ///     damping_ratio: 0.0,
    /// };
    /// let joint = Joint { cement, stiffness_per_area: 0.0, young_modulus: 30e9 };
    /// let bond = joint.bond(1e-3, 2e-3, 3e-3, 0.5);
    /// assert!((bond.stiffness.normal / (30e9 * std::f64::consts::PI * 1e-6 / 3e-3) - 1.0).abs() < 1e-15);
    /// assert_eq!(bond.tensile_strength, 5e6);
    /// ```
    #[inline(always)]
    #[must_use]
    pub fn bond(&self, first_radius: R, second_radius: R, bonded_length: R, strength: R) -> Bond<R> {
        let section = Section::between(self.cement.radius_multiplier, first_radius, second_radius);
        let per_area = self.stiffness_per_area + stiffness_per_area(self.young_modulus, bonded_length);
        Bond::new(&self.cement, &section, per_area).with_strength_times(strength)
    }

    /// The same with dashpots, if the law has any: see [`damping::coefficients`]. Only they look at masses.
    #[inline(always)]
    #[must_use]
    pub fn bond_of_spheres(
        &self,
        damping: Damping,
        first: &Sphere<R>,
        second: &Sphere<R>,
        bonded_length: R,
        strength: R,
    ) -> Bond<R> {
        let bond = self.bond(first.radius, second.radius, bonded_length, strength);
        match damping {
            Damping::Off => bond,
            Damping::Viscous => {
                let dashpots = damping::coefficients(self.cement.damping_ratio, &bond.stiffness, first, second);
                Bond { damping: dashpots, ..bond }
            }
        }
    }
}

/// The round section of a bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section<R> {
    /// $\bar R = \bar\lambda\min(R_1,R_2)$, m.
    pub radius: R,
    /// $A = \pi\bar R^2$, m².
    pub area: R,
    /// $I = \tfrac14\pi\bar R^4$, m⁴: for bending.
    pub second_moment: R,
    /// $J = \tfrac12\pi\bar R^4$, m⁴: for torsion.
    pub polar_moment: R,
}

impl<R: Real> Section<R> {
    /// The section of a bond between particles of the given radii, m.
    #[inline(always)]
    #[must_use]
    pub fn between(radius_multiplier: R, first_radius: R, second_radius: R) -> Self {
        let radius = (radius_multiplier * first_radius.min(second_radius)).named("bond_radius");
        let square = radius * radius;
        let area = (R::lit(PI) * square).named("area");
        let second_moment = (R::lit(0.25) * area * square).named("second_moment");
        Section { radius, area, second_moment, polar_moment: second_moment + second_moment }
    }
}

/// The numbers of one bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond<R> {
    /// $K_n = \bar k_nA$, $K_s = \bar k_sA$ in N/m; $K_t = \bar k_sJ$, $K_b = \bar k_nI$ in N m.
    pub stiffness: Coefficients<R>,
    /// Of the dashpots, N s/m and N m s: [`damping::coefficients`].
    pub damping: Coefficients<R>,
    /// $1/A$, 1/m².
    pub stress_per_force: R,
    /// $\bar\beta\bar R/J$, 1/m³: the inverse of the section modulus of torsion.
    pub stress_per_torsion: R,
    /// $\bar\beta\bar R/I$, 1/m³: the inverse of the section modulus of bending.
    pub stress_per_bending: R,
    /// $\sigma_{lim}$, Pa.
    pub tensile_strength: R,
    /// $\bar c$, Pa.
    pub shear_strength: R,
    /// $\tan\bar\varphi$.
    pub internal_friction: R,
}

impl<R: Real> Bond<R> {
    /// A bond of the given cement and section, without dashpots.
    ///
    /// | argument | symbol | unit | range |
    /// |---|---|---|---|
    /// | `stiffness_per_area` | $\bar k_n$, see [`stiffness_per_area`] | Pa/m | > 0 |
    ///
    /// # Example
    /// ```
    /// use tdem_physics::bond::{Bond, Cement, Section, section::stiffness_per_area};
    /// let cement = Cement {
    ///     stiffness_ratio: 0.4,
    ///     radius_multiplier: 1.0,
    ///     tensile_strength: 10e6,
    ///     shear_strength: 30e6,
    ///     internal_friction: 0.0,
    ///     moment_contribution: 1.0,
    ///     damping_ratio: 0.0,
    /// };
    /// let section = Section::between(cement.radius_multiplier, 1e-3, 2e-3);
    /// let bond = Bond::new(&cement, &section, stiffness_per_area(30e9, 3e-3));
    /// // E A / L of a beam of 1 mm radius and 3 mm length.
    /// assert!((bond.stiffness.normal / (30e9 * std::f64::consts::PI * 1e-6 / 3e-3) - 1.0).abs() < 1e-15);
    /// ```
    ///
    /// # References
    /// Potyondy & Cundall (2004); Potyondy, *Parallel-bond refinements to match macroproperties of hard rock*
    /// (2011) for $\bar\beta$.
    #[inline(always)]
    #[must_use]
    pub fn new(cement: &Cement<R>, section: &Section<R>, stiffness_per_area: R) -> Self {
        let shear_per_area = cement.stiffness_ratio * stiffness_per_area;
        let stiffness = Coefficients {
            normal: (stiffness_per_area * section.area).named("normal_stiffness"),
            shear: (shear_per_area * section.area).named("shear_stiffness"),
            torsion: (shear_per_area * section.polar_moment).named("torsion_stiffness"),
            bending: (stiffness_per_area * section.second_moment).named("bending_stiffness"),
        };
        let zero = R::lit(0.0);
        let outermost = cement.moment_contribution * section.radius;
        Bond {
            stiffness,
            damping: Coefficients { normal: zero, shear: zero, torsion: zero, bending: zero },
            stress_per_force: R::lit(1.0) / section.area,
            stress_per_torsion: outermost / section.polar_moment,
            stress_per_bending: outermost / section.second_moment,
            tensile_strength: cement.tensile_strength,
            shear_strength: cement.shear_strength,
            internal_friction: cement.internal_friction,
        }
    }

    /// The same bond, both strengths times a factor (a random one, see [`super::strength::weibull`]).
    #[inline(always)]
    #[must_use]
    pub fn with_strength_times(self, factor: R) -> Self {
        Bond { tensile_strength: self.tensile_strength * factor, shear_strength: self.shear_strength * factor, ..self }
    }

    /// The same bond at another temperature: all four stiffnesses and both strengths times their factors.
    ///
    /// # Validity
    /// Stiffness for bonds that remember no forces only: a force that is remembered stays what it was when its spring
    /// becomes softer. Dashpots keep their coefficients, and so does internal friction.
    #[inline(always)]
    #[must_use]
    pub fn tempered(self, stiffness: R, strength: R) -> Self {
        Bond { stiffness: self.stiffness.scaled(stiffness, stiffness), ..self.with_strength_times(strength) }
    }
}

/// $\bar k_n = \bar E/L_0$, Pa/m, of a bond of Young's modulus $\bar E$ (Pa) and length $L_0$ (m). Potyondy & Cundall
/// (2004) take $L_0 = R_1 + R_2$.
#[inline(always)]
pub fn stiffness_per_area<R: Real>(young_modulus: R, length: R) -> R {
    young_modulus / length
}
