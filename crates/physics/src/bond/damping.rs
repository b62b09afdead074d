//! Dashpots beside the springs of a bond.

use super::{Axis, Bond, Coefficients, Ends, Modes};
use crate::Real;
use crate::contact::Sphere;
use crate::motion::sphere_inertia;

/// Viscous damping of a bond by damping ratio: the coefficients of its dashpots, N s/m and N m s.
///
/// $$2\zeta_b\sqrt{m^*K_n},\quad 2\zeta_b\sqrt{m^*K_s},\quad 2\zeta_b\sqrt{I^*K_t},\quad 2\zeta_b\sqrt{I^*K_b}$$
///
/// with $m^* = m_1m_2/(m_1+m_2)$ and $I^* = I_1I_2/(I_1+I_2)$.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `ratio` | $\zeta_b$ | 1 |
/// | `stiffness` | $K_n, K_s, K_t, K_b$ | N/m, N m |
/// | `first`, `second` | masses and radii | kg, m |
///
/// # Validity
/// $\zeta_b$ of 0.01 to 0.3. Two particles and a bond alone have a damping ratio of $\zeta_b$; the stiffest waves of a
/// dense lattice have about $2.8\zeta_b$, and the largest stable step falls accordingly
/// ([`crate::stability::verlet_damped_oscillator_limit`]).
///
/// # Numerics
/// Masses and radii do not change, so a bond keeps its coefficients: six roots that a step need not draw.
#[inline(always)]
pub fn coefficients<R: Real>(
    ratio: R,
    stiffness: &Coefficients<R>,
    first: &Sphere<R>,
    second: &Sphere<R>,
) -> Coefficients<R> {
    let eff = |a: R, b: R| a * b / (a + b);
    let mass = eff(first.mass, second.mass).named("mass_eff");
    let inertia =
        eff(sphere_inertia(first.mass, first.radius), sphere_inertia(second.mass, second.radius)).named("inertia_eff");
    let twice_ratio = R::lit(2.0) * ratio;
    let roots = Coefficients {
        normal: twice_ratio * stiffness.normal.sqrt(),
        shear: twice_ratio * stiffness.shear.sqrt(),
        torsion: twice_ratio * stiffness.torsion.sqrt(),
        bending: twice_ratio * stiffness.bending.sqrt(),
    };
    roots.scaled(mass.sqrt(), inertia.sqrt())
}

/// What the dashpots of a bond add to the load of its springs: each coefficient times its rate of deformation
/// ([`Axis::rates`]), N and N m on the first body, which they drag along with the second. They do not count as stress.
#[inline(always)]
pub fn load<R: Real>(motion: &Modes<R>, bond: &Bond<R>) -> Modes<R> {
    motion.times(&bond.damping)
}

/// Energy that the dashpots of a bond take during a step, J: the work of their forces, which see the velocities of
/// `ends`, at the velocities of `settled`, those at the end of the step as well as they are known
/// with the geometry of the end ([`crate::contact::Encounter::settled_velocity`] tells why).
#[inline(always)]
pub fn loss<R: Real>(ends: &Ends<R>, settled: &Ends<R>, bond: &Bond<R>, step: R) -> R {
    let axis = Axis::of(ends);
    load(&axis.rates(ends), bond).dot(&axis.motion(settled)) * step
}
