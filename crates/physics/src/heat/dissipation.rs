//! Heat that motion turns into: of sliding, and of dashpots.

use crate::Real;

/// Which parts of the energy that contacts and bonds dissipate become heat of their bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dissipation<R> {
    /// $\eta_f$: of what sliding dissipates, 0 to 1.
    pub friction: R,
    /// $\eta_d$: of what dashpots dissipate, 0 to 1.
    pub damping: R,
}

impl<R: Real> Dissipation<R> {
    /// $W = \eta_f W_f + \eta_d W_d$: heat that two bodies make in one step, J. Each of them gets half of it; at a wall that
    /// has no temperature, the one that there is gets all.
    ///
    /// | argument | symbol | unit |
    /// |---|---|---|
    /// | `friction` | $W_f$, dissipated by sliding | J |
    /// | `damping` | $W_d$, dissipated by dashpots | J |
    ///
    /// # Validity
    /// Energy of an event of the motion, whatever the time scale of the heat. Halves are right for bodies of one material,
    /// else the share of a body grows with its effusivity $\sqrt{\lambda\rho c}$.
    ///
    /// # Example
    /// ```
    /// use tdem_physics::heat::Dissipation;
    /// let metal = Dissipation { friction: 0.9, damping: 0.0 };
    /// assert_eq!(metal.heat(2.0, 5.0), 1.8);
    /// ```
    #[inline(always)]
    pub fn heat(&self, friction: R, damping: R) -> R {
        self.friction * friction + self.damping * damping
    }
}

/// $Q = W/\Delta t$, W: the heat rate that brings an energy (J) into a body within a step of the heat (s).
#[inline(always)]
pub fn heat_rate<R: Real>(energy: R, step: R) -> R {
    energy / step
}
