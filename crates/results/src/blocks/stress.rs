//! Stress of particles.

use super::Scene;
use rayon::prelude::*;
use std::f64::consts::PI;
use tdem_engine::physics::Vec3;
use tdem_engine::physics::bond::Axis;
use tdem_engine::{Evaluated, Plan, State};

/// A symmetric tensor in VTK's order: xx, yy, zz, xy, yz, xz.
type Symmetric = [f64; 6];
/// What a contact or a bond adds to each of its particles, N m, by index; a wall is none.
type Share = [Option<(usize, Symmetric)>; 2];

/// Contacts whose shares are held at a time: those of all would take more memory than the state.
const CHUNK: usize = 65_536;

/// Mean of the three normal stresses in each particle from its contacts and bonds, Pa, `(N)`, tension positive: a third of
/// the trace of what frames show as `stress`.
#[must_use]
pub fn mean_stress(state: &State, plan: &Plan) -> Vec<f64> {
    let scene = Scene { state, plan, start: None };
    scene.stress().iter().map(|[xx, yy, zz, ..]| (xx + yy + zz) / 3.0).collect()
}

impl Scene<'_> {
    /// Mean stress in each sphere, Pa, `(N, 6)`, tension positive:
    ///
    /// $$\boldsymbol\sigma_i = \frac1{V_i}\sum_c\operatorname{sym}(\mathbf r_c\otimes\mathbf f_c),\qquad
    /// V_i = \tfrac43\pi R_i^3$$
    ///
    /// with $\mathbf r_c$ from the centre to the point where the lever arms of a contact or bond meet and $\mathbf f_c$ the
    /// force there on the particle, dashpots included.
    ///
    /// # Validity
    /// The mean over the sphere itself if it is at rest or accelerated evenly; bending and torsion of bonds add nothing.
    /// The sphere's own volume needs no choice of a packing fraction: the mean over a region is the sum of $V_i
    /// \boldsymbol\sigma_i$ over its particles, divided by its volume.
    ///
    /// # Numerics
    /// Shares are added in the order of the state, not of the threads: the same bits for any number of them.
    pub(crate) fn stress(&self) -> Vec<Symmetric> {
        let state = self.state;
        let mut sums = vec![[0.0; 6]; state.len()];
        add(&mut sums, state.contacts.len(), |k| {
            let contact = &state.contacts[k];
            let (i, j) = (state.index_of(contact.first)?, state.index_of(contact.second)?);
            let found = state.evaluate(self.plan, contact)?;
            // Seen from the second particle both arm and force are reversed.
            Some([i, j].map(|index| Some((index, product(arm(&found, state.radius[index]), found.force)))))
        });
        add(&mut sums, state.wall_contacts.len(), |k| {
            let contact = &state.wall_contacts[k];
            let i = state.index_of(contact.particle)?;
            let found = state.evaluate_at_wall(self.plan, contact)?;
            Some([Some((i, product(arm(&found, state.radius[i]), found.force))), None])
        });
        add(&mut sums, state.bonds.len(), |k| {
            let bond = &state.bonds[k];
            let (i, j) = (state.index_of(bond.first)?, state.index_of(bond.second)?);
            let found = state.evaluate_bond(self.plan, k)?;
            let (axis, force) = (Axis::of(&found.ends), found.reaction.force);
            let share = |index, arm| Some((index, product(axis.normal * arm, force)));
            Some([share(i, axis.first_arm), share(j, axis.second_arm)])
        });
        let volume = |radius: f64| 4.0 / 3.0 * PI * (radius * radius * radius);
        let per_volume = |(sum, &radius): (Symmetric, &f64)| sum.map(|part| part / volume(radius));
        sums.into_par_iter().zip(&state.radius).map(per_volume).collect()
    }
}

/// Along the normal to where the lever arms of a contact meet, m.
fn arm(found: &Evaluated<'_>, radius: f64) -> Vec3<f64> {
    found.encounter.normal * (radius - 0.5 * found.touch.overlap)
}

/// The symmetric part of a dyadic product.
fn product(r: Vec3<f64>, f: Vec3<f64>) -> Symmetric {
    let mixed = |a: f64, b: f64| 0.5 * (a + b);
    let (xy, yz, xz) = (mixed(r.x * f.y, r.y * f.x), mixed(r.y * f.z, r.z * f.y), mixed(r.x * f.z, r.z * f.x));
    [r.x * f.x, r.y * f.y, r.z * f.z, xy, yz, xz]
}

/// Computes shares on all cores and adds them one after the other.
fn add(sums: &mut [Symmetric], count: usize, share: impl Fn(usize) -> Option<Share> + Sync) {
    for begin in (0..count).step_by(CHUNK) {
        let shares: Vec<Option<Share>> = (begin..count.min(begin + CHUNK)).into_par_iter().map(&share).collect();
        for (index, product) in shares.into_iter().flatten().flatten().flatten() {
            sums[index].iter_mut().zip(product).for_each(|(sum, part)| *sum += part);
        }
    }
}
