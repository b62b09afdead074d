//! Work that expansion does on springs, and temperature where it changes their stiffness.
//!
//! Where a body that is held becomes warmer, its springs are strained although nothing moves. With $U$ the energy in all
//! springs, the work in a step is $\int\sum_i\frac{\partial U}{\partial T_i}\,\mathrm dT_i$, which the ledger takes by the
//! trapezoidal rule.

use crate::Real;

/// $\partial U/\partial T_1 = -F_nL_b\,\alpha_1\frac{R_1}{R_1+R_2}$ of a bond, J/K.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `growth` | $\alpha_1R_1/(R_1+R_2)$, see [`super::Link`] | 1/K |
/// | `tension` | $F_n$, elastic, tension positive | N |
/// | `bonded_length` | $L_b$, at bonding | m |
///
/// # Example
/// ```
/// use tdem_physics::heat::expansion_work::of_bond;
/// // U = K/2 (L - L0)^2 with L0 = L (1 + 5e-6 T), K = 1e8 N/m, L = 1e-3 m, 10 K warmer.
/// let energy = |t: f64| 0.5 * 1e8 * (1e-3 * 5e-6 * t) * (1e-3 * 5e-6 * t);
/// let slope = of_bond(5e-6, -1e8 * (1e-3 * 5e-6 * 10.0), 1e-3);
/// assert!((slope / (energy(10.5) - energy(9.5)) - 1.0).abs() < 1e-12);
/// ```
#[inline(always)]
pub fn of_bond<R: Real>(growth: R, tension: R, bonded_length: R) -> R {
    -(growth * (tension * bonded_length))
}

/// $\partial U/\partial T_1 = \tfrac12\frac{f'}{f}U$ of a bond whose stiffness is multiplied by $f(\bar T)$, J/K: under the same
/// deformation $U \propto f$, and $\bar T$ is the mean temperature of its two bodies.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `energy` | $U$, in its springs | J |
/// | `factor`, `slope` | $f, f'$ at $\bar T$ | 1, 1/K |
#[inline(always)]
pub fn of_softening<R: Real>(energy: R, factor: R, slope: R) -> R {
    R::lit(0.5) * (slope / factor) * energy
}

/// $\partial U/\partial T = \alpha R_0\sum F_{el}$ of the contacts of a body, J/K.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `pressure` | $\sum F_{el}$, sum of the sizes of Hertz's forces | N |
/// | `expansion` | $\alpha$ | 1/K |
/// | `reference_radius` | $R_0$ | m |
///
/// # Validity
/// What the effective radius and tangential springs gain is left out: of order $h/R$ of this.
#[inline(always)]
pub fn of_contacts<R: Real>(pressure: R, expansion: R, reference_radius: R) -> R {
    pressure * (expansion * reference_radius)
}

/// $\tfrac12\frac{\partial U}{\partial T}\Delta T$, J: half of the work of a step, at one of its ends.
#[inline(always)]
pub fn half_step<R: Real>(work_per_kelvin: R, warming: R) -> R {
    R::lit(0.5) * work_per_kelvin * warming
}
