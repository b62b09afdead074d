//! How heat changes the length at which a bond pulls on nobody.

use crate::Real;

/// The length at which a bond pulls on nobody.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest<R> {
    /// $L_0$ now, m.
    pub length: R,
    /// How much it has grown in this step, m.
    pub growth: R,
}

impl<R: Real> Rest<R> {
    /// Of a bond of the given length at bonding, m, under free strains now and one step before.
    #[inline(always)]
    #[must_use]
    pub fn of(bonded_length: R, free_strain: R, earlier_free_strain: R) -> Self {
        Rest {
            length: rest_length(bonded_length, free_strain),
            growth: bonded_length * (free_strain - earlier_free_strain),
        }
    }
}

/// $L_0 = L_b(1 + \varepsilon)$, m, from the length $L_b$ at bonding and the free strain $\varepsilon$.
///
/// # Numerics
/// In proportion to the bond's own length, not to $R_1+R_2$: a body that expands freely is then free of stress also where
/// bonds join particles that overlap or do not touch.
#[inline(always)]
pub fn rest_length<R: Real>(bonded_length: R, free_strain: R) -> R {
    bonded_length * (R::lit(1.0) + free_strain)
}

/// The strain $\varepsilon$ that a bond takes up without force when its bodies expand by $\varepsilon_1$ and
/// $\varepsilon_2$.
///
/// $$\varepsilon = \frac{R_1\varepsilon_1 + R_2\varepsilon_2}{R_1+R_2},\qquad \varepsilon_k = \alpha_k(T_k - T_{k,b})$$
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `first_radius`, `second_radius` | $R_1, R_2$ at bonding | m |
/// | `first_strain`, `second_strain` | $\varepsilon_1, \varepsilon_2$, counted from the temperatures at bonding | 1 |
///
/// # Example
/// ```
/// use tdem_physics::bond::expansion::{free_strain, rest_length};
/// // Steel and concrete of equal radius, 100 K warmer than when they were bonded.
/// let strain = free_strain(5e-4, 12e-6 * 100.0, 5e-4, 10e-6 * 100.0);
/// assert!((rest_length(1e-3, strain) - 1.0011e-3).abs() < 1e-15);
/// ```
///
/// # References
/// Wanne & Young, Int. J. Rock Mech. Min. Sci. 45 (2008) 789, where $\Delta F_n = -\bar k_nA\bar\alpha L\Delta T$; the
/// particles' part is eq. 7 of Pacevič & Kačeniauskas (2022) with the sign of an expansion.
#[inline(always)]
pub fn free_strain<R: Real>(first_radius: R, first_strain: R, second_radius: R, second_strain: R) -> R {
    (first_radius * first_strain + second_radius * second_strain) / (first_radius + second_radius)
}
