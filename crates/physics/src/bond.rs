//! Two particles that are bonded: the parallel bond of Potyondy and Cundall, a beam without mass that breaks.
//!
//! # Conventions
//! | symbol | meaning |
//! |---|---|
//! | $\mathbf n$ | unit normal from the first body to the second |
//! | $L$, $L_0$ | distance of the centres; the length at which the bond pulls on nobody |
//! | $d_1 = LR_1/(R_1+R_2),\ d_2 = LR_2/(R_1+R_2)$ | lever arms to the middle of the bond; $d_1 + d_2 = L$ |
//! | $F_n$ | **positive in tension**: the force on the first body is $+F_n\mathbf n$ |
//! | $\mathbf F_s$ | shear force **on the first body**, across $\mathbf n$ |
//! | $M_t$, $\mathbf M_b$ | moment of torsion about $\mathbf n$ and of bending across it, **on the first body** |
//! | $\mathbf F = F_n\mathbf n + \mathbf F_s$ | force on the first body; the second feels $-\mathbf F$ |
//! | $\mathbf M_1 = d_1\mathbf n\times\mathbf F_s + M_t\mathbf n + \mathbf M_b$ | moment on the first body |
//! | $\mathbf M_2 = d_2\mathbf n\times\mathbf F_s - M_t\mathbf n - \mathbf M_b$ | moment on the second body |
//!
//! A bond drags the first body along with the second: each of the four deformations is that of the second body relative
//! to the first, and its force on the first body has the same sign.
//!
//! Every expression is exactly odd or even under exchange of the bodies: a bond evaluated from either side gives the
//! same bits up to sign (zeros may have either sign), and one side's first moment is the other's second.
//!
//! # Two forms of one law
//! [`respond_total`] finds the deformation from places and orientations and remembers nothing ([`total`]);
//! [`respond_incremental`] advances stored forces by rates, as Potyondy and Cundall wrote it ([`incremental`]). They agree
//! to first order in the rotations. Both hand over to the same stress and strength ([`strength`]), dashpots ([`damping`])
//! and [`Reaction`].
//!
//! What breaks stays broken: the caller remembers a bit, as it remembers which particles touch. A bond of which
//! [`Reaction::failure`] is positive exerts nothing, already in this step.

pub mod axis;
pub mod damping;
pub mod expansion;
pub mod face_centred;
pub mod incremental;
pub mod mean_field;
pub mod modes;
pub mod section;
pub mod strength;
pub mod total;
pub mod turning;

pub use axis::{Axis, Ends};
pub use expansion::Rest;
pub use incremental::{Advance, History};
pub use modes::{Coefficients, Modes};
pub use section::{Bond, Cement, Joint, Section};
pub use strength::{Failure, Stress};
pub use total::Posture;

use crate::{Real, Vec3};

/// Which law acts, one axis per concern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// How forces follow from motion.
    pub form: Form,
    /// Whether bonds have dashpots.
    pub damping: Damping,
}

/// How forces follow from motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// From places and orientations; nothing is stored. No drift, exactly objective, independent of the step.
    Total,
    /// Shear force and moments are stored and advanced.
    Incremental(Tension),
}

/// Where the normal force of the incremental form comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tension {
    /// From the length of the bond: no drift.
    FromLength,
    /// It is stored and advanced like the others (the paper's). The length that it sees drifts: under rotation at
    /// $\omega$ by $\omega^2\Delta t\,L$ in a unit of time.
    Stored,
}

/// Whether bonds have dashpots; see [`damping`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damping {
    /// Elastic.
    Off,
    /// A dashpot beside each of the four springs, by damping ratio.
    Viscous,
}

/// What a bond does in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction<R> {
    /// $\mathbf F$ on the first body, N; the second feels its negative.
    pub force: Vec3<R>,
    /// $\mathbf M_1$ on the first body, N m.
    pub first_moment: Vec3<R>,
    /// $\mathbf M_2$ on the second body, N m.
    pub second_moment: Vec3<R>,
    /// What the springs hold, N and N m; dashpots are not in it.
    pub load: Modes<R>,
    /// $\sigma$, $\tau$, Pa.
    pub stress: Stress<R>,
    /// 0 while the bond holds; positive where it fails, and how: [`Failure::code`].
    pub failure: R,
}

/// The law in its total form: deformation from places and orientations.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `damping` | whether there are dashpots; only they look at velocities | |
/// | `ends` | $R, \mathbf v, m, \boldsymbol\omega$ of both bodies, and where the second lies | m, m/s, kg, rad/s |
/// | `posture` | how the bodies lay when they were bonded, and how they have turned since | m |
/// | `bond` | the bond's parameters | |
///
/// # Validity
/// Relative rotations well below half a turn; see [`total::deformation`].
///
/// # References
/// Potyondy & Cundall, Int. J. Rock Mech. Min. Sci. 41 (2004) 1329, in another form; see [`total`].
#[inline(always)]
pub fn respond_total<R: Real>(damping: Damping, ends: &Ends<R>, posture: &Posture<R>, bond: &Bond<R>) -> Reaction<R> {
    let (length, bonded_length) = (ends.length(), posture.bonded_length());
    // One division finds both inverses.
    let inverse = R::lit(1.0) / (length * bonded_length);
    let axis = Axis::along(ends, length, inverse * bonded_length);
    let deformation = total::deformation(&axis, posture, [bonded_length, inverse * length]);
    let load = deformation.times(&bond.stiffness);
    react(damping, ends, &axis, load, bond)
}

/// The law in its incremental form: stored forces are turned with the bond and advanced by the rates of deformation.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `tension` | where the normal force comes from | |
/// | `damping` | whether there are dashpots | |
/// | `ends` | as for [`respond_total`]; the velocities are those that led to the present positions | |
/// | `advance` | what was stored, the rest length, and the step | N, N m, m, s |
/// | `bond` | the bond's parameters | |
///
/// # Returns
/// What is to be stored, and the reaction.
///
/// # References
/// Potyondy & Cundall, Int. J. Rock Mech. Min. Sci. 41 (2004) 1329, `doi:10.1016/j.ijrmms.2004.09.011`; their signs of
/// shear and moments are those on the other body.
#[inline(always)]
pub fn respond_incremental<R: Real>(
    tension: Tension,
    damping: Damping,
    ends: &Ends<R>,
    advance: &Advance<R>,
    bond: &Bond<R>,
) -> (History<R>, Reaction<R>) {
    let axis = Axis::of(ends);
    let load = incremental::load(tension, &axis, ends, advance, bond);
    (History::of(&axis, &load), react(damping, ends, &axis, load, bond))
}

/// What both forms share: forces and moments of springs and dashpots, stress and failure of the springs.
#[inline(always)]
fn react<R: Real>(damping: Damping, ends: &Ends<R>, axis: &Axis<R>, load: Modes<R>, bond: &Bond<R>) -> Reaction<R> {
    let load = load.named_load();
    let exerted = match damping {
        Damping::Off => load,
        Damping::Viscous => load.plus(&damping::load(&axis.rates(ends), bond)),
    };
    let turning = axis.normal.cross(exerted.shear).named(["turning_x", "turning_y", "turning_z"]);
    let couple = axis.couple(&exerted).named(["couple_x", "couple_y", "couple_z"]);
    Reaction {
        force: axis.normal * exerted.normal + exerted.shear,
        first_moment: turning * axis.first_arm + couple,
        second_moment: turning * axis.second_arm - couple,
        load,
        stress: strength::stress(&load, bond),
        failure: strength::failure(&load, bond),
    }
}

/// Elastic energy stored in a bond under the given load, J:
/// $\tfrac12(F_n^2/K_n + F_s^2/K_s + M_t^2/K_t + M_b^2/K_b)$; a mode without stiffness stores nothing. A bond that breaks
/// releases it.
#[inline(always)]
pub fn stored_energy<R: Real>(load: &Modes<R>, bond: &Bond<R>) -> R {
    let (zero, one) = (R::lit(0.0), R::lit(1.0));
    let squares = Coefficients {
        normal: load.normal * load.normal,
        shear: load.shear.dot(load.shear),
        torsion: load.torsion * load.torsion,
        bending: load.bending.dot(load.bending),
    };
    let spring = |square: R, stiffness: R| {
        let elastic = stiffness.gt(zero);
        R::select(elastic, square / R::select(elastic, stiffness, one), zero)
    };
    let stiffness = &bond.stiffness;
    let forces = spring(squares.normal, stiffness.normal) + spring(squares.shear, stiffness.shear);
    let moments = spring(squares.torsion, stiffness.torsion) + spring(squares.bending, stiffness.bending);
    R::lit(0.5) * (forces + moments)
}

/// Energy that leaves with a bond that breaks, J: what its springs would hold, less their work in the second half of the
/// step, $U - \tfrac12\Delta t\,\mathbf F\cdot\dot{\mathbf u}$ summed over the four modes.
///
/// # Numerics
/// A bond that breaks in a step exerts nothing at its end, but under velocity Verlet it did at its beginning, half a step
/// long: in the ledger it parts in the middle of the step. Without the second term every breakage would leave an error of
/// first order in the step.
#[inline(always)]
pub fn released_energy<R: Real>(ends: &Ends<R>, load: &Modes<R>, bond: &Bond<R>, step: R) -> R {
    let power = load.dot(&Axis::of(ends).rates(ends));
    stored_energy(load, bond) - R::lit(0.5) * step * power
}
