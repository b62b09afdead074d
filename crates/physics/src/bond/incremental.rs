//! The load of a bond from stored forces and rates of deformation.

use super::turning::Turning;
use super::{Axis, Bond, Ends, Modes, Rest, Tension};
use crate::{Real, Vec3};

/// What an incremental bond remembers, as its first body sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct History<R> {
    /// The normal that the vectors refer to. It need not be kept where the offset of the last step can be found otherwise.
    pub normal: Vec3<R>,
    /// $F_n$, N, tension positive. Only [`Tension::Stored`] looks at it.
    pub tension: R,
    /// $\mathbf F_s$, N.
    pub shear: Vec3<R>,
    /// $M_t\mathbf n + \mathbf M_b$, N m: one vector, which `normal` takes apart.
    pub couple: Vec3<R>,
}

/// One step of an incremental bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance<R> {
    /// What was stored at the end of the last step.
    pub earlier: History<R>,
    /// $L_0$ and how it has grown in this step.
    pub rest: Rest<R>,
    /// $\Delta t$, s; 0 turns the forces without advancing them.
    pub step: R,
}

impl<R: Real> History<R> {
    /// To remember a load.
    #[inline(always)]
    #[must_use]
    pub fn of(axis: &Axis<R>, load: &Modes<R>) -> Self {
        History { normal: axis.normal, tension: load.normal, shear: load.shear, couple: axis.couple(load) }
    }
    /// A bond of which nothing is known yet but where it lies.
    #[inline(always)]
    #[must_use]
    pub fn unloaded(normal: Vec3<R>) -> Self {
        History { normal, tension: R::lit(0.0), shear: Vec3::zero(), couple: Vec3::zero() }
    }
    /// The same as the second body sees it.
    #[inline(always)]
    #[must_use]
    pub fn reversed(self) -> Self {
        History { normal: -self.normal, tension: self.tension, shear: -self.shear, couple: -self.couple }
    }
}

/// The load of a bond, incremental form.
///
/// 1. $\mathbf F_s$ and $\mathbf M_b$ are turned with the bond ([`Turning`]),
/// 2. $\mathbf F_s \leftarrow \mathbf F_s + K_s\mathbf v_t\Delta t$,
///    $M_t \leftarrow M_t + K_t(\boldsymbol\omega_r\cdot\mathbf n)\Delta t$,
///    $\mathbf M_b \leftarrow \mathbf M_b + K_b[\boldsymbol\omega_r - (\boldsymbol\omega_r\cdot\mathbf n)\mathbf n]\Delta t$,
/// 3. $F_n = K_n(L - L_0)$, or with [`Tension::Stored`] $F_n \leftarrow F_n + K_n[(\mathbf v_c\cdot\mathbf n)\Delta t
///    - \Delta L_0]$.
///
/// # Numerics
/// Rates are those of the geometry that the velocities belong to ([`Ends::rates`]): under velocity Verlet that of the middle of
/// the step, where a rigid rotation has none, and where the normal force of [`Tension::Stored`] and that of the length agree.
/// The increments are right to second order then; with the geometry of the end they would be right to first order, and a
/// rotation at $\omega$ would shorten the length that a stored normal force sees by $\tfrac12\omega^2\Delta t\,L$ in a unit
/// of time. The couple is
/// stored as one vector (48 bytes in place of 56 and a normal); after it was turned with the normal its part along the
/// normal is the torsion.
///
/// # References
/// Potyondy & Cundall (2004); Pacevič & Kačeniauskas (2022) algorithm 2.
#[inline(always)]
pub fn load<R: Real>(
    tension: Tension,
    axis: &Axis<R>,
    ends: &Ends<R>,
    advance: &Advance<R>,
    bond: &Bond<R>,
) -> Modes<R> {
    let Advance { earlier, rest, step } = *advance;
    let normal = axis.normal;
    let spins = [ends.first.angular_velocity, ends.second.angular_velocity];
    let turning = Turning::of([earlier.normal, normal], spins, step);
    let couple = turning.with_normal(earlier.couple).named(["turned_couple_x", "turned_couple_y", "turned_couple_z"]);
    let torsion = couple.dot(normal).named("turned_torsion");
    let turned = Modes {
        normal: earlier.tension,
        shear: turning.about_normal(turning.with_normal(earlier.shear)),
        torsion,
        bending: turning.about_normal(couple - normal * torsion),
    };

    let motion = axis.rates(ends);
    let stiffness = &bond.stiffness;
    let advanced = turned.plus(&motion.times(&stiffness.scaled(step, step)));
    let normal_force = match tension {
        Tension::FromLength => stiffness.normal * (axis.length - rest.length),
        Tension::Stored => advanced.normal - stiffness.normal * rest.growth,
    };
    Modes { normal: normal_force, ..advanced }
}
