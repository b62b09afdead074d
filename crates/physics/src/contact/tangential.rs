//! Friction with history: a spring and a dashpot in the plane of contact, limited by Coulomb's cone.

use super::{Friction, Losses};
use crate::real::Branch;
use crate::{Real, Vec3};

/// How the surfaces move against each other, and what resists.
#[derive(Clone, Copy, Debug)]
pub struct Shear<R> {
    /// $\mathbf n$ of the end of the step.
    pub normal: Vec3<R>,
    /// Unit bisector of the normals of the beginning and the end of the step.
    pub bisector: Vec3<R>,
    /// Rate of rotation about the normal, rad/s: the mean of both bodies.
    pub mean_spin: R,
    /// $\mathbf v_t$, tangential velocity of the second surface relative to the first, m/s.
    pub velocity: Vec3<R>,
    /// $\mathbf v_c$ at the end of the step, for the losses, m/s; its normal part does not matter.
    pub settled_velocity: Vec3<R>,
    /// $k_t = c_tG^*\sqrt{R^*h}$, N/m.
    pub stiffness: R,
    /// $k_t$ at the overlap of the last step, N/m.
    pub earlier_stiffness: R,
    /// $\gamma_t m^*$, kg/s.
    pub damping: R,
    /// $\Delta t$, s.
    pub step: R,
}

/// What friction does in one step.
#[derive(Clone, Copy, Debug)]
pub struct Drag<R> {
    /// Force on the first body, N: it is dragged along with the second.
    pub force: Vec3<R>,
    /// Displacement to remember, m.
    pub displacement: Vec3<R>,
    /// Where energy went, J.
    pub losses: Losses<R>,
}

/// Friction with history.
///
/// 1. the stored displacement turns with the bodies, keeping its length: with the normal into the present plane of contact,
///    and about the normal at the mean spin $\tfrac12(\boldsymbol\omega_1+\boldsymbol\omega_2)\cdot\mathbf n$,
/// 2. $\boldsymbol\delta \leftarrow \boldsymbol\delta + \mathbf v_t\Delta t$,
/// 3. if the spring $k_t\boldsymbol\delta$, or its sum with the dashpot $\gamma_tm^*\mathbf v_t$, exceeds the stick limit
///    $\mu_sF_n$, the contact slides: $\boldsymbol\delta$ is shortened until $k_t|\boldsymbol\delta| \le \mu_dF_n$,
/// 4. $\mathbf F_t = k_t\boldsymbol\delta + \gamma_tm^*\mathbf v_t$, shortened to $\mu_dF_n$ while sliding.
///
/// With [`Friction::Rescaled`] a contact whose stiffness grows keeps its force: $\boldsymbol\delta$ shrinks by
/// $k_{t,old}/k_t$ before step 2.
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `displacement` | $\boldsymbol\delta$ of the last step | m |
/// | `stick_limit`, `slide_limit` | $\mu_sF_n$, $\mu_dF_n$ | N |
///
/// # Numerics
/// The spring is brought to the cone by itself and never stretched beyond what the surfaces did. Were it to hold all of
/// $\mathbf F_t$, or $\mathbf F_t$ less the dashpot, it would be stretched without bound at first touch, where $k_t$
/// vanishes but the dashpots do not (a packing dropped with the paper's $\gamma_t$ = 150 1/s gained half its kinetic
/// energy so).
///
/// The earlier stiffness is that of the overlap $h + v_n\Delta t$. The displacement form creates a little energy under
/// near-normal stick (0.65 % of the tangential part at 2 degrees); the ledger books it as `stiffening`.
///
/// # References
/// Džiugys & Peters, Granular Matter 3 (2001) 231; Mindlin & Deresiewicz, J. Appl. Mech. 20 (1953) 327 for $k_t$;
/// Thornton, Cummins & Cleary, Powder Technology 210 (2011) 189 for the rescaled form.
#[inline(always)]
pub fn friction<R: Real>(
    form: Friction,
    shear: &Shear<R>,
    displacement: Vec3<R>,
    stick_limit: R,
    slide_limit: R,
) -> Drag<R> {
    let &Shear { velocity, settled_velocity, stiffness, earlier_stiffness, damping, step, .. } = shear;
    let half = R::lit(0.5);

    let turned = turned(displacement, shear);
    let turned = match form {
        Friction::Rescaled => turned * (earlier_stiffness / stiffness).min(R::lit(1.0)),
        Friction::Off | Friction::Displacement => turned,
    }
    .named(["turned_x", "turned_y", "turned_z"]);
    let stored_before = half * earlier_stiffness * displacement.dot(displacement);
    let stiffening = half * stiffness * turned.dot(turned) - stored_before;

    let trial = (turned + velocity * step).named(["trial_x", "trial_y", "trial_z"]);
    let dashpot = (velocity * damping).named(["dashpot_x", "dashpot_y", "dashpot_z"]);
    let stretched = (trial * stiffness).named(["stretched_x", "stretched_y", "stretched_z"]);
    let stretched_squared = stretched.dot(stretched).named("stretched_squared");
    let sticking = (stretched + dashpot).named(["sticking_x", "sticking_y", "sticking_z"]);
    let slides = stretched_squared.max(sticking.dot(sticking)).gt(stick_limit * stick_limit);
    let slide = Slide { stretched, stretched_squared, dashpot, limit: slide_limit };
    let (force, kept) = R::when(slides, (sticking, trial), slide);
    let force = force.named(["tangential_x", "tangential_y", "tangential_z"]);
    let kept = kept.named(["kept_x", "kept_y", "kept_z"]);

    // Work of the force, less what the spring stored.
    let stored = half * stiffness * (kept + turned).dot(kept - turned);
    let lost = force.dot(settled_velocity) * step - stored;
    let zero = R::lit(0.0);
    Drag {
        force,
        displacement: kept,
        losses: Losses { friction: R::select(slides, lost, zero), damping: R::select(slides, zero, lost), stiffening },
    }
}

/// Steps 3 and 4 while sliding: first the spring is brought to the cone, then its sum with the dashpot.
struct Slide<R> {
    stretched: Vec3<R>,
    stretched_squared: R,
    dashpot: Vec3<R>,
    limit: R,
}

impl<R: Real> Branch<(Vec3<R>, Vec3<R>)> for Slide<R> {
    #[inline(always)]
    fn taken(self, (_, trial): (Vec3<R>, Vec3<R>)) -> (Vec3<R>, Vec3<R>) {
        let one = R::lit(1.0);
        // A size of 0 gives 0/0 or infinity, and `min` then takes 1.
        let shortening = (self.limit / self.stretched_squared.sqrt()).min(one);
        let total = self.stretched * shortening + self.dashpot;
        let force = total * (self.limit / total.dot(total).sqrt()).min(one);
        (force, trial * shortening)
    }
}

/// A stored displacement turned by one step, at its full length.
///
/// With $\mathbf m$ the unit bisector of both normals and $t = \tfrac14\Delta t(\boldsymbol\omega_1+\boldsymbol\omega_2)
/// \cdot\mathbf n$,
///
/// $$\boldsymbol\delta' = \boldsymbol\delta - 2(\mathbf m\cdot\boldsymbol\delta)\mathbf m,\qquad
/// \boldsymbol\delta \leftarrow \frac{(1-t^2)\boldsymbol\delta' + 2t\,\mathbf n\times\boldsymbol\delta'}{1+t^2}$$
///
/// # Numerics
/// The first is the rotation by the shortest arc from the earlier normal to the present one, exact for a vector across the
/// earlier normal; the second is Cayley's form of a rotation about the normal. Both are exact in a body that turns rigidly
/// under velocity Verlet, whatever the step: where angular velocities are constant they turn by
/// $2\arctan(\omega\Delta t/2)$ in a step, as orientations do. What rounding, or a bisector that is not known (Gear's
/// integrator takes the normal itself), leaves along the normal is taken out, and the length is restored; a displacement that
/// had no part across the normal becomes zero.
#[inline(always)]
fn turned<R: Real>(displacement: Vec3<R>, shear: &Shear<R>) -> Vec3<R> {
    let &Shear { normal, bisector, mean_spin, step, .. } = shear;
    let (one, two) = (R::lit(1.0), R::lit(2.0));
    let carried = displacement - bisector * (two * bisector.dot(displacement));
    let across = carried - normal * carried.dot(normal);
    let tangent = (R::lit(0.5) * step * mean_spin).named("tangent");
    let spun = across * (one - tangent * tangent) + normal.cross(across) * (two * tangent);
    let remaining = spun.dot(spun);
    let something = remaining.gt(R::lit(0.0));
    let length = displacement.dot(displacement);
    spun * (R::select(something, length, one) / R::select(something, remaining, one)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::orientation::Quaternion;
    use crate::vec3;

    fn shear(speed: f64) -> Shear<f64> {
        Shear {
            normal: vec3(0.0, 0.0, 1.0),
            bisector: vec3(0.0, 0.0, 1.0),
            mean_spin: 0.0,
            velocity: vec3(speed, 0.0, 0.0),
            settled_velocity: vec3(speed, 0.0, 0.0),
            stiffness: 1e6,
            earlier_stiffness: 1e6,
            damping: 0.0,
            step: 1e-6,
        }
    }

    #[test]
    fn sticks_below_the_limit_and_slides_on_the_cone_above_it() {
        let (stick, slide) = (1.0, 0.8);
        let drag = friction(Friction::Displacement, &shear(0.5), Vec3::zero(), stick, slide);
        assert!((drag.force.x - 0.5).abs() < 1e-12 && drag.losses.friction == 0.0);
        let drag = friction(Friction::Displacement, &shear(2.0), Vec3::zero(), stick, slide);
        assert!((drag.force.x - slide).abs() < 1e-12);
        assert!((drag.displacement.x - 0.8e-6).abs() < 1e-18);
        // Work 0.8 N over 2 um, of which 0.5 * 1e6 N/m * (0.8 um)^2 is stored.
        assert!((drag.losses.friction - (1.6e-6 - 0.32e-6)).abs() < 1e-18);
    }

    #[test]
    fn a_turned_displacement_keeps_its_length_and_lies_in_the_plane() {
        let normal = vec3(0.6, 0.0, 0.8);
        let shear = Shear { normal, bisector: normal, ..shear(0.0) };
        let across = turned(vec3(1e-6, 2e-6, 0.0), &shear);
        assert!(across.dot(normal).abs() < 1e-21);
        assert!((across.dot(across) - 5e-12).abs() < 1e-26);
        assert_eq!(turned(Vec3::zero(), &shear), Vec3::zero());
    }

    /// A rigid rotation about an axis oblique to normal and displacement, in steps of any size: the displacement stays where
    /// the body carries it.
    #[test]
    fn a_held_spring_turns_with_its_bodies_about_any_axis() {
        let axis = vec3(2.0, -1.0, 2.0) * (1.0 / 3.0);
        for (steps, rate) in [(7_u32, 0.9), (1000, 0.02)] {
            let step = 0.5;
            // An angular velocity that turns by `2 atan(rate step / 2)` in a step.
            let half = libm::atan(0.5 * rate * step);
            let body = Quaternion { vector: axis * libm::sin(half), scalar: libm::cos(half) };
            let (mut normal, mut carried) = (vec3(0.6, 0.0, 0.8), vec3(0.0, 3e-7, 0.0) + vec3(0.8, 0.0, -0.6) * 1e-6);
            let mut stored = carried;
            for _ in 0..steps {
                let next = body.rotate(normal);
                let mean_spin = rate * axis.dot(next);
                let middle = normal + next;
                let bisector = middle * (1.0 / middle.dot(middle).sqrt());
                let shear = Shear { normal: next, bisector, mean_spin, step, ..shear(0.0) };
                stored = turned(stored, &shear);
                (normal, carried) = (next, body.rotate(carried));
            }
            let error = stored - carried;
            assert!(error.dot(error).sqrt() < 1e-18, "{steps} steps: {stored:?}, not {carried:?}");
        }
    }

    #[test]
    fn loading_creates_energy_only_in_the_displacement_form() {
        let shear = Shear { earlier_stiffness: 0.5e6, ..shear(0.0) };
        let stored = vec3(1e-6, 0.0, 0.0);
        let limit = f64::INFINITY;
        assert!(friction(Friction::Displacement, &shear, stored, limit, limit).losses.stiffening > 0.0);
        let rescaled = friction(Friction::Rescaled, &shear, stored, limit, limit);
        assert!(rescaled.losses.stiffening < 0.0);
        assert!((rescaled.force.x - 0.5).abs() < 1e-12, "the force is kept");
    }
}
