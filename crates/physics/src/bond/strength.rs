//! When a bond breaks.

use super::{Bond, Modes};
use crate::Real;

/// Greatest stresses in a bond, Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress<R> {
    /// $F_n/A$, the mean over the section, positive in tension.
    pub axial: R,
    /// $\sigma$, at the edge that bending stretches, positive in tension.
    pub tensile: R,
    /// $\tau$, at the edge.
    pub shear: R,
}

/// How a bond fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// $\sigma > \sigma_{lim}$.
    Tension,
    /// $\tau > \tau_{lim}$, and not the other.
    Shear,
}

impl Failure {
    /// What [`super::Reaction::failure`] is then: 1 for tension, 2 for shear.
    #[must_use]
    pub const fn code(self) -> f64 {
        match self {
            Failure::Tension => 1.0,
            Failure::Shear => 2.0,
        }
    }
    /// What a code stands for; `None` for a bond that holds.
    #[must_use]
    pub fn of_code(code: f64) -> Option<Failure> {
        [Failure::Tension, Failure::Shear].into_iter().find(|failure| failure.code() == code)
    }
}

/// The greatest stresses of beam theory.
///
/// $$\sigma = \frac{F_n}A + \bar\beta\frac{|\mathbf M_b|\bar R}I,\qquad
/// \tau = \frac{|\mathbf F_s|}A + \bar\beta\frac{|M_t|\bar R}J$$
///
/// # References
/// Potyondy & Cundall (2004), there with compression positive; Potyondy (2011) for $\bar\beta$.
#[inline(always)]
pub fn stress<R: Real>(load: &Modes<R>, bond: &Bond<R>) -> Stress<R> {
    let axial = (load.normal * bond.stress_per_force).named("axial_stress");
    let bending = load.bending.dot(load.bending).sqrt() * bond.stress_per_bending;
    let shear = load.shear.dot(load.shear).sqrt() * bond.stress_per_force;
    let torsion = load.torsion.abs() * bond.stress_per_torsion;
    Stress { axial, tensile: (axial + bending).named("tensile_stress"), shear: (shear + torsion).named("shear_stress") }
}

/// Shear strength under an axial stress of $F_n/A$, Pa: $\tau_{lim} = \bar c - (F_n/A)\tan\bar\varphi$. Pressure raises it,
/// tension lowers it; without internal friction it is $\bar c$.
#[inline(always)]
pub fn shear_limit<R: Real>(axial: R, bond: &Bond<R>) -> R {
    bond.shear_strength - axial * bond.internal_friction
}

/// Whether a bond fails, and how: 0 while it holds, else the code of a [`Failure`]. Tension is asked for first.
///
/// $$\sigma > \sigma_{lim},\qquad \tau > \tau_{lim}$$
///
/// with the stresses of [`stress`] and the limits of [`Bond`] and [`shear_limit`].
///
/// # Numerics
/// What bending may add to the axial stress, and shearing to that of torsion, is compared by squares: no root is drawn. A
/// stress that is not a number breaks nothing; the force then is none either, and the fault is found.
///
/// # References
/// Potyondy & Cundall (2004); the order and the criterion of Mohr and Coulomb are those of PFC.
#[inline(always)]
pub fn failure<R: Real>(load: &Modes<R>, bond: &Bond<R>) -> R {
    let axial = (load.normal * bond.stress_per_force).named("axial_stress");
    let bending = load.bending.dot(load.bending) * (bond.stress_per_bending * bond.stress_per_bending);
    let shear = load.shear.dot(load.shear) * (bond.stress_per_force * bond.stress_per_force);
    let torsion = load.torsion.abs() * bond.stress_per_torsion;
    let (holds, sheared) = (R::lit(0.0), R::lit(Failure::Shear.code()));
    let torn = R::lit(Failure::Tension.code());
    let otherwise = exceeds(shear, shear_limit(axial, bond) - torsion, sheared, holds);
    exceeds(bending, bond.tensile_strength - axial, torn, otherwise).named("failure")
}

/// `then` where the root of `square` is above `limit`, else `otherwise`. Nothing is below a negative limit.
#[inline(always)]
fn exceeds<R: Real>(square: R, limit: R, then: R, otherwise: R) -> R {
    R::select(limit.lt(R::lit(0.0)), then, R::select(square.gt(limit * limit), then, otherwise))
}

/// A strength of Weibull's distribution: $x = s\,(-\ln(1-u))^{1/m}$, the number that a part $u$ of all bonds stays below.
///
/// | argument | symbol | range |
/// |---|---|---|
/// | `uniform` | $u$, a random number | [0, 1) |
/// | `shape` | $m$, the larger the narrower | > 0 |
/// | `scale` | $s$, see [`weibull_scale`] | > 0, any unit |
///
/// # Example
/// ```
/// use tdem_physics::bond::strength::weibull;
/// // At the scale itself, 1 - 1/e of all bonds are weaker, whatever the shape.
/// let part = 1.0 - libm::exp(-1.0);
/// assert!((weibull(part, 3.0, 2e6) / 2e6 - 1.0).abs() < 1e-15);
/// ```
///
/// # References
/// W. Weibull, J. Appl. Mech. 18 (1951) 293.
#[must_use]
pub fn weibull(uniform: f64, shape: f64, scale: f64) -> f64 {
    scale * libm::pow(-libm::log1p(-uniform), 1.0 / shape)
}

/// The scale of a Weibull distribution with the given mean: $s = \bar x/\Gamma(1 + 1/m)$.
#[must_use]
pub fn weibull_scale(mean: f64, shape: f64) -> f64 {
    mean / libm::tgamma(1.0 + 1.0 / shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weibull_strengths_have_their_mean() {
        let (mean, shape, count) = (5e6, 4.0, 20_000);
        let scale = weibull_scale(mean, shape);
        let sum: f64 = (0..count).map(|k| weibull((f64::from(k) + 0.5) / f64::from(count), shape, scale)).sum();
        assert!((sum / f64::from(count) / mean - 1.0).abs() < 1e-5);
        assert_eq!(weibull(0.0, shape, scale), 0.0);
    }

    #[test]
    fn codes_come_back() {
        for failure in [Failure::Tension, Failure::Shear] {
            assert_eq!(Failure::of_code(failure.code()), Some(failure));
        }
        assert_eq!(Failure::of_code(0.0), None);
    }
}
