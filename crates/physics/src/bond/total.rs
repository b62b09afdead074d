//! The deformation of a bond from places and orientations alone.

use super::{Axis, Modes, expansion};
use crate::motion::orientation::Quaternion;
use crate::{Real, Vec3};

/// How the bodies lay when they were bonded, and how they have turned since.
#[derive(Clone, Copy, Debug)]
pub struct Posture<R> {
    /// From the first centre to the second at bonding, the nearest image, m.
    pub bonded_offset: Vec3<R>,
    /// Of the first body, lab from body, the identity at bonding.
    pub first_orientation: Quaternion<R>,
    /// Of the second body.
    pub second_orientation: Quaternion<R>,
    /// Strain that the bond takes up without force, see [`crate::heat::Link::free_strain`].
    pub free_strain: R,
}

impl<R: Real> Posture<R> {
    /// $L_b$, m.
    #[inline(always)]
    pub(super) fn bonded_length(&self) -> R {
        self.bonded_offset.dot(self.bonded_offset).sqrt().named("bonded_length")
    }
}

/// The deformation of a bond, total form.
///
/// With $\mathbf n_b, L_b$ the bond at bonding and $q\mathbf n_b$ that direction carried along by a body,
///
/// $$u_n = L - L_b(1+\varepsilon),\qquad
/// \mathbf u_s = (\mathbf m\cdot\mathbf n)\mathbf n - \mathbf m,\quad \mathbf m = d_1\,q_1\mathbf n_b + d_2\,q_2\mathbf n_b,$$
/// $$\boldsymbol\theta = 2\operatorname{sign}(w)\operatorname{vec}(q_2q_1^*),\qquad
/// \theta_t = \boldsymbol\theta\cdot\mathbf n,\quad \boldsymbol\theta_b = \boldsymbol\theta - \theta_t\mathbf n.$$
///
/// | argument | symbol | unit |
/// |---|---|---|
/// | `axis` | $\mathbf n, L, d_1, d_2$ | m |
/// | `posture` | $L_b\mathbf n_b, q_1, q_2, \varepsilon$ | m |
/// | `bonded_length` | $L_b$ and its inverse | m, 1/m |
///
/// # Returns
/// $u_n, \mathbf u_s$ in m, $\theta_t, \boldsymbol\theta_b$ in rad, of the second body relative to the first.
///
/// # Validity
/// Shear and rotations are right to first order in the angle between the bond and what its bodies carry along, the
/// rotation itself to third order. Up to half a turn the moments grow with the rotation.
///
/// # Numerics
/// No drift, unchanged by rigid motion to rounding, independent of the step; agrees with the stored forces of
/// [`super::incremental`] to first order in the rotations. Exactly odd or even under exchange of the bodies: products
/// within sums are the same numbers from either side, and sums of two do not mind the order.
///
/// # References
/// Orientations in place of stored moments: Wang, Acta Geotechnica 4 (2009) 117; the deformations here are those whose
/// rates are those of Potyondy & Cundall (2004).
#[inline(always)]
pub fn deformation<R: Real>(axis: &Axis<R>, posture: &Posture<R>, bonded_length: [R; 2]) -> Modes<R> {
    let &Posture { bonded_offset, first_orientation, second_orientation, free_strain } = posture;
    let normal = axis.normal;
    let [bonded_length, inverse] = bonded_length;

    let first_carried = first_orientation.rotate(bonded_offset) * (axis.first_arm * inverse);
    let second_carried = second_orientation.rotate(bonded_offset) * (axis.second_arm * inverse);
    let carried = (first_carried + second_carried).named(["carried_x", "carried_y", "carried_z"]);
    let turn = second_orientation.from_earlier(first_orientation).rotation_vector();
    let turn = turn.named(["turn_x", "turn_y", "turn_z"]);
    let twist = turn.dot(normal).named("twist");
    Modes {
        normal: axis.length - expansion::rest_length(bonded_length, free_strain),
        shear: normal * carried.dot(normal) - carried,
        torsion: twist,
        bending: turn - normal * twist,
    }
}
