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

/// $L_0 = L_b(1 + \varepsilon)$, m, from the length $L_b$ at bonding and the free strain $\varepsilon$ of
/// [`crate::heat::Link::free_strain`].
///
/// # Numerics
/// In proportion to the bond's own length, not to $R_1+R_2$: a body that expands freely is then free of stress also where
/// bonds join particles that overlap or do not touch.
#[inline(always)]
pub fn rest_length<R: Real>(bonded_length: R, free_strain: R) -> R {
    bonded_length * (R::lit(1.0) + free_strain)
}
