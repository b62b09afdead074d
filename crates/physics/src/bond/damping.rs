//! Dashpots beside the springs of a bond.

use super::{Axis, Bond, Ends, Modes};
use crate::Real;
use crate::motion::sphere_inertia;

/// Viscous damping of a bond by damping ratio, the load it adds to that of the springs.
///
/// $$2\zeta_b\sqrt{m^*K_n}\,v_n,\quad 2\zeta_b\sqrt{m^*K_s}\,\mathbf v_t,\quad 2\zeta_b\sqrt{I^*K_t}\,\omega_t,\quad
/// 2\zeta_b\sqrt{I^*K_b}\,\boldsymbol\omega_b$$
///
/// with $m^* = m_1m_2/(m_1+m_2)$, $I^* = I_1I_2/(I_1+I_2)$ and the rates of deformation of [`Axis::motion`].
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `ends` | masses and radii | kg, m |
/// | `motion` | $v_n, \mathbf v_t, \omega_t, \boldsymbol\omega_b$ | m/s, rad/s |
/// | `bond` | $2\zeta_b\sqrt K$ for each spring | |
///
/// # Returns
/// Forces and moments on the first body, N and N m: they drag it along with the second. They do not count as stress.
///
/// # Validity
/// $\zeta_b$ of 0.01 to 0.3. Two particles and a bond alone have a damping ratio of $\zeta_b$; the stiffest waves of a
/// dense lattice have about $2.8\zeta_b$, and the largest stable step falls accordingly
/// ([`crate::stability::verlet_damped_oscillator_limit`]).
#[inline(always)]
pub fn load<R: Real>(ends: &Ends<R>, motion: &Modes<R>, bond: &Bond<R>) -> Modes<R> {
    let (first, second) = (&ends.first, &ends.second);
    let eff = |a: R, b: R| a * b / (a + b);
    let mass = eff(first.mass, second.mass).named("mass_eff");
    let inertia =
        eff(sphere_inertia(first.mass, first.radius), sphere_inertia(second.mass, second.radius)).named("inertia_eff");
    motion.times(&bond.damping.scaled(mass.sqrt(), inertia.sqrt()))
}

/// Energy that the dashpots of a bond take during a step, J: the work of their forces, which see the velocities of
/// `ends`, at the velocities of `settled`, those at the end of the step as well as they are known
/// ([`crate::contact::Encounter::settled_velocity`] tells why).
#[inline(always)]
pub fn loss<R: Real>(ends: &Ends<R>, settled: &Ends<R>, bond: &Bond<R>, step: R) -> R {
    let axis = Axis::of(ends);
    load(ends, &axis.motion(ends), bond).dot(&axis.motion(settled)) * step
}
