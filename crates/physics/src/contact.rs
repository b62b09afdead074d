//! Two bodies that touch: sphere and sphere, or sphere and plane wall.
//!
//! # Conventions
//! | symbol | meaning |
//! |---|---|
//! | $\mathbf n$ | unit normal from the first body to the second |
//! | $h$ | overlap, positive in contact |
//! | $d_1 = R_1 - h/2,\ d_2 = R_2 - h/2$ | lever arms to the common contact point |
//! | $\mathbf v_c$ | velocity of the second surface relative to the first at the contact point |
//! | $v_n = \mathbf v_c\cdot\mathbf n$ | negative while the bodies approach |
//! | $\mathbf F$ | force on the first body; the second feels $-\mathbf F$ |
//!
//! Every expression is exactly odd or even under exchange of the bodies: a pair evaluated from either side gives the
//! same bits up to sign. [`respond`] is the whole law; what it is made of stands in [`normal`], [`damping`] and
//! [`tangential`].

pub mod damping;
pub mod encounter;
pub mod normal;
pub mod tangential;

pub use encounter::{Encounter, Kick, Period, Sphere, Touch, touch_spheres, touch_wall};

use crate::{Real, Vec3};

/// Which law acts, one axis per concern. The models of the paper are [`Law::GN`], [`Law::GNT`] and [`Law::GNTM`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// How the normal force dissipates.
    pub damping: Damping,
    /// How the bodies resist sliding.
    pub friction: Friction,
    /// Whether the tangential force turns the bodies.
    pub moments: bool,
}

/// How the normal force dissipates; see [`damping`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damping {
    /// $\gamma_n m^* v_n$, the coefficient in 1/s (the paper's).
    Viscous,
    /// Tsuji's form, which gives the same restitution at every impact speed.
    Restitution,
}

/// How the bodies resist sliding; see [`tangential`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Friction {
    /// Frictionless.
    Off,
    /// The stored tangential displacement times the present stiffness (the paper's).
    Displacement,
    /// As `Displacement`, but a contact that is being loaded keeps its force, not its displacement: no energy is
    /// created.
    Rescaled,
}

impl Law {
    /// Normal force only, viscous damping.
    pub const GN: Law = Law { damping: Damping::Viscous, friction: Friction::Off, moments: false };
    /// Normal and tangential force, no rotation.
    pub const GNT: Law = Law { friction: Friction::Displacement, ..Law::GN };
    /// Normal and tangential force and moments.
    pub const GNTM: Law = Law { moments: true, ..Law::GNT };
}

/// The numbers of the law for one pair of materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction<R> {
    /// $\tfrac43 E^*$, Pa.
    pub normal_stiffness: R,
    /// $c_t G^*$ with $c_t = 8$ (Mindlin, no slip) or $16/3$, Pa.
    pub tangential_stiffness: R,
    /// $\gamma_n$ in 1/s ([`Damping::Viscous`]) or $2\sqrt{5/6}\,\beta$ ([`Damping::Restitution`]), see
    /// [`damping::restitution_factor`].
    pub normal_damping: R,
    /// $\gamma_t$, 1/s.
    pub tangential_damping: R,
    /// $\mu_s$: the bodies stick up to this multiple of the normal force.
    pub static_friction: R,
    /// $\mu_d \le \mu_s$: and slide at this multiple beyond it.
    pub dynamic_friction: R,
    /// Least normal force, N: 0 forbids attraction by the dashpot, $-\infty$ allows it.
    pub least_normal_force: R,
}

/// What the contact does in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<R> {
    /// Force on the first body, N.
    pub force: Vec3<R>,
    /// $\mathbf n\times\mathbf F$: times a body's lever arm, its moment. The same for both bodies.
    pub moment_per_arm: Vec3<R>,
    /// Tangential displacement to remember, m.
    pub displacement: Vec3<R>,
    /// Where energy went during the step.
    pub losses: Losses<R>,
}

/// Energy that left the mechanical ledger during one step, J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Losses<R> {
    /// Dissipated by sliding, never negative.
    pub friction: R,
    /// Dissipated by the dashpots, and by the clamp of the normal force.
    pub damping: R,
    /// Put into tangential springs by a change of their stiffness under a stored displacement; either sign.
    pub stiffening: R,
}

/// The contact law: Hertz, damping, friction with history, moments.
///
/// $$\mathbf F = -F_n\mathbf n + \mathbf F_t,\qquad F_n = \max(F_{el} + F_{vis}, F_{min})$$
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `encounter` | $\mathbf n, h, v_n, \mathbf v_t, R^*, m^*$ | m, m/s, kg |
/// | `displacement` | $\boldsymbol\delta$ of the last step, zero at first touch | m |
/// | `interaction` | the pair's parameters | |
/// | `step` | $\Delta t$; 0 evaluates the force without advancing the history | s |
///
/// # Validity
/// `encounter.overlap` must be positive; the caller decides who touches.
///
/// # References
/// Pacevič & Kačeniauskas (2022) section 2.1; Džiugys & Peters, Granular Matter 3 (2001) 231.
#[inline(always)]
pub fn respond<R: Real>(
    law: Law,
    encounter: &Encounter<R>,
    displacement: Vec3<R>,
    interaction: &Interaction<R>,
    step: R,
) -> Response<R> {
    let &Encounter { normal, overlap, normal_speed, settled_velocity, radius_eff, mass_eff, .. } = encounter;
    let contact_radius = (radius_eff * overlap).sqrt().named("contact_radius");

    let elastic = normal::hertz(interaction.normal_stiffness, contact_radius, overlap).named("elastic");
    let viscous = match law.damping {
        Damping::Viscous => damping::viscous(interaction.normal_damping, mass_eff, normal_speed),
        Damping::Restitution => {
            let stiffness = normal::hertz_stiffness(interaction.normal_stiffness, contact_radius);
            damping::restitution(interaction.normal_damping, stiffness, mass_eff, normal_speed)
        }
    };
    // In this order a force that is not a number stays one, and the fault is found.
    let normal_force = interaction.least_normal_force.max(elastic + viscous).named("normal_force");
    let normal_loss = (elastic - normal_force) * settled_velocity.dot(normal) * step;

    if law.friction == Friction::Off {
        let zero = R::lit(0.0);
        return Response {
            force: -(normal * normal_force),
            moment_per_arm: Vec3::zero(),
            displacement: Vec3::zero(),
            losses: Losses { friction: zero, damping: normal_loss, stiffening: zero },
        };
    }
    let earlier_overlap = (overlap + normal_speed * step).max(R::lit(0.0));
    let shear = tangential::Shear {
        normal,
        bisector: encounter.bisector,
        mean_spin: encounter.mean_spin,
        velocity: encounter.tangential_velocity,
        settled_velocity,
        stiffness: (interaction.tangential_stiffness * contact_radius).named("stiffness"),
        earlier_stiffness: (interaction.tangential_stiffness * (radius_eff * earlier_overlap).sqrt())
            .named("earlier_stiffness"),
        damping: (interaction.tangential_damping * mass_eff).named("damping"),
        step,
    };
    let pressed = normal_force.max(R::lit(0.0));
    let stick_limit = (interaction.static_friction * pressed).named("stick_limit");
    let slide_limit = (interaction.dynamic_friction * pressed).named("slide_limit");
    let friction = tangential::friction(law.friction, &shear, displacement, stick_limit, slide_limit);
    Response {
        force: friction.force - normal * normal_force,
        moment_per_arm: if law.moments { normal.cross(friction.force) } else { Vec3::zero() },
        displacement: friction.displacement,
        losses: Losses { damping: normal_loss + friction.losses.damping, ..friction.losses },
    }
}

/// Elastic energy stored in a contact, J: $\tfrac25\,\tfrac43E^*\sqrt{R^*}\,h^{5/2} + \tfrac12 k_t\delta^2$, as
/// (normal, tangential).
#[inline(always)]
pub fn stored_energy<R: Real>(
    radius_eff: R,
    overlap: R,
    displacement: Vec3<R>,
    interaction: &Interaction<R>,
) -> (R, R) {
    let contact_radius = (radius_eff * overlap).sqrt();
    let normal = R::lit(0.4) * (interaction.normal_stiffness * contact_radius) * (overlap * overlap);
    let tangential = R::lit(0.5) * (interaction.tangential_stiffness * contact_radius) * displacement.dot(displacement);
    (normal, tangential)
}

/// $F_{el} = \tfrac43E^*\sqrt{R^*}\,h^{3/2}$, N: what the normal spring of a contact presses with.
#[inline(always)]
pub fn elastic_force<R: Real>(radius_eff: R, overlap: R, interaction: &Interaction<R>) -> R {
    normal::hertz(interaction.normal_stiffness, (radius_eff * overlap).sqrt(), overlap)
}

/// Energy that a tangential spring still held when its contact opened during the step, J:
/// $\tfrac12k_t\delta^2$ at the overlap of the last step.
#[inline(always)]
pub fn released_energy<R: Real>(
    encounter: &Encounter<R>,
    displacement: Vec3<R>,
    interaction: &Interaction<R>,
    step: R,
) -> R {
    let earlier_overlap = (encounter.overlap + encounter.normal_speed * step).max(R::lit(0.0));
    let stiffness = interaction.tangential_stiffness * (encounter.radius_eff * earlier_overlap).sqrt();
    R::lit(0.5) * stiffness * displacement.dot(displacement)
}

/// Elastic energy of a contact that begins at a finite overlap, because the bond breaks that kept it off, J:
/// $\tfrac25\,\tfrac43E^*\sqrt{R^*}\,h^{5/2}$ at the overlap of the middle of the step, as
/// [`crate::bond::released_energy`] has it.
#[inline(always)]
pub fn begun_energy<R: Real>(encounter: &Encounter<R>, interaction: &Interaction<R>, step: R) -> R {
    let overlap = (encounter.overlap + R::lit(0.5) * step * encounter.normal_speed).max(R::lit(0.0));
    stored_energy(encounter.radius_eff, overlap, Vec3::zero(), interaction).0
}
