//! Bonded assemblies at rest: the linear equilibrium of particles with six components each.
//!
//! A bond from $i$ to $j$, with normal $\mathbf n$ and lever arms $d_i, d_j$ as it was made, gives way by
//!
//! $$\mathbf g = \mathbf u_j - \mathbf u_i - (d_i\boldsymbol\theta_i + d_j\boldsymbol\theta_j)\times\mathbf n,\qquad
//! \boldsymbol\varphi = \boldsymbol\theta_j - \boldsymbol\theta_i,$$
//!
//! and acts on $i$ with
//!
//! $$\mathbf F = K_n(\mathbf g\cdot\mathbf n)\,\mathbf n + K_s(\mathbf g - (\mathbf g\cdot\mathbf n)\,\mathbf n),\qquad
//! \mathbf M_i = d_i\,\mathbf n\times\mathbf F + K_t(\boldsymbol\varphi\cdot\mathbf n)\,\mathbf n
//! + K_b(\boldsymbol\varphi - (\boldsymbol\varphi\cdot\mathbf n)\,\mathbf n).$$
//!
//! Displacements $\mathbf u$ (m) and rotations $\boldsymbol\theta$ (rad) are those for which forces, moments and loads of
//! every component that is not held add up to nothing. Of the engine's law only the numbers of a bond go in; that the
//! two agree is a test.
//!
//! What is not there: contacts beside bonds, geometric stiffness (bonds are without force as they were made), breakage.
//!
//! # Numerics
//! Conjugate gradients, each particle's own 6 x 6 block as preconditioner, the matrix never assembled: a row is the bonds
//! of a particle. Sums have a fixed order, so results do not depend on the number of threads. Twenty lines more than a
//! call of a library, and no dependency; a direct solver would need gigabytes at 100,000 particles.
//!
//! # References
//! Hestenes & Stiefel, J. Res. Natl. Bur. Stand. 49 (1952) 409.

mod gradients;

use rayon::prelude::*;
use tdem_engine::physics::bond::Coefficients;
use tdem_engine::physics::{Vec3, vec3};
use tdem_engine::{Constraint, Driven, Plan, State};

/// Along x, y, z and about x, y, z: displacement and rotation (m, rad), or force and moment (N, N m).
pub type Six = [f64; 6];

/// Why there is no solution.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The state has no bonds that hold.
    #[error("nothing is bonded")]
    NoBonds,
    /// Something can move without resistance and is loaded, or the arithmetic is exhausted.
    #[error("the assembly does not come to rest: after {iterations} iterations {residual:.1e} of the load is left")]
    NotHeld {
        /// Iterations of conjugate gradients.
        iterations: usize,
        /// What is left of the unbalanced load, relative.
        residual: f64,
    },
}

/// A bond as one of its particles sees it.
#[derive(Clone, Copy, Debug)]
struct Link {
    other: u32,
    normal: Vec3<f64>,
    own_arm: f64,
    other_arm: f64,
    stiffness: Coefficients<f64>,
}

impl Link {
    /// Force and moment on the own particle.
    fn pull(&self, own: &Six, other: &Six) -> Six {
        let Link { normal, own_arm, other_arm, stiffness, .. } = self;
        let (moved, turned) = (shift(other) - shift(own), turn(other) - turn(own));
        let gap = moved - (turn(own) * *own_arm + turn(other) * *other_arm).cross(*normal);
        let force = gap * stiffness.shear + *normal * ((stiffness.normal - stiffness.shear) * gap.dot(*normal));
        let twist = (stiffness.torsion - stiffness.bending) * turned.dot(*normal);
        let moment = normal.cross(force) * *own_arm + turned * stiffness.bending + *normal * twist;
        [force.x, force.y, force.z, moment.x, moment.y, moment.z]
    }
}

fn shift(six: &Six) -> Vec3<f64> {
    vec3(six[0], six[1], six[2])
}
fn turn(six: &Six) -> Vec3<f64> {
    vec3(six[3], six[4], six[5])
}

/// Particles and the bonds that hold, as they were made.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// Where the links of each particle begin, `(N + 1,)`.
    start: Vec<usize>,
    links: Vec<Link>,
}

/// What is held and what is loaded.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Displacement and rotation that are prescribed, m and rad, `(N, 6)`; `None` is left to the forces.
    pub held: Vec<[Option<f64>; 6]>,
    /// Forces and moments from outside, N and N m, `(N, 6)`.
    pub loads: Vec<Six>,
}

impl Boundary {
    /// Nothing is held, nothing loaded.
    #[must_use]
    pub fn free(particles: usize) -> Self {
        Boundary { held: vec![[None; 6]; particles], loads: vec![[0.0; 6]; particles] }
    }

    /// The constraints of a plan after a time, s: each prescribed component as far as its rate has taken it, and the forces
    /// applied then.
    #[must_use]
    pub fn of_plan(state: &State, plan: &Plan, duration: f64) -> Self {
        let mut boundary = Boundary::free(state.len());
        let (ways, then) = (ways(plan, duration), plan.constraints_at(duration));
        for (k, &constraint) in state.constraint.iter().enumerate() {
            let constraint = usize::from(constraint);
            boundary.held[k] = ways[constraint];
            boundary.loads[k][..3].copy_from_slice(&then[constraint].force);
        }
        boundary
    }
}

/// How far each constraint takes a particle in a time, m and rad.
fn ways(plan: &Plan, duration: f64) -> Vec<[Option<f64>; 6]> {
    let constant = |constraint: &Constraint| {
        let Constraint { velocity: [x, y, z], angular_velocity: [a, b, c], .. } = *constraint;
        [x, y, z, a, b, c].map(|rate| rate.map(|rate| rate * duration))
    };
    let mut ways: Vec<_> = plan.constraints.iter().map(constant).collect();
    for ramp in &plan.ramps {
        let component = match ramp.drives {
            Driven::Velocity => ramp.axis,
            Driven::AngularVelocity => 3 + ramp.axis,
            Driven::Force => continue,
        };
        // Straight between these times.
        let mut times = vec![0.0];
        times.extend(ramp.points.iter().map(|point| point[0]).filter(|time| (0.0..duration).contains(time)));
        times.push(duration);
        let piece = |ends: &[f64]| 0.5 * (ends[1] - ends[0]) * (ramp.value(ends[0]) + ramp.value(ends[1]));
        ways[usize::from(ramp.constraint)][component] = Some(times.windows(2).map(piece).sum());
    }
    ways
}

/// An assembly at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Displacements and rotations, m and rad, `(N, 6)`.
    pub displacement: Vec<Six>,
    /// Forces and moments of what holds the particles, N and N m, `(N, 6)`; next to zero where nothing does.
    pub reaction: Vec<Six>,
    /// Iterations that it took.
    pub iterations: usize,
}

impl Solution {
    /// A state moved to where it is at rest, from where its bonds were made; velocities stay.
    #[must_use]
    pub fn applied_to(&self, state: &State) -> State {
        let mut moved = state.clone();
        for (k, six) in self.displacement.iter().enumerate() {
            moved.position[k] = std::array::from_fn(|d| state.bonded_position[k][d] + six[d]);
            let half = turn(six) * 0.5;
            let size = (1.0 + half.dot(half)).sqrt();
            moved.orientation[k] = [half.x / size, half.y / size, half.z / size, 1.0 / size];
        }
        moved
    }
}

impl Assembly {
    /// The bonds of a state that hold.
    ///
    /// # Errors
    /// [`Error::NoBonds`].
    pub fn of(state: &State, plan: &Plan) -> Result<Self, Error> {
        let mut rows = vec![Vec::new(); state.len()];
        for bond in state.bonds.iter().filter(|bond| bond.holds()) {
            let ends = (state.index_of(bond.first), state.index_of(bond.second));
            let (Some(i), Some(j)) = ends else { continue };
            let Some(joint) = plan.joint(state.material[i], state.material[j]) else { continue };
            let place = |k: usize| Vec3::from(state.bonded_position[k]);
            let offset = plan.domain.period().nearest(place(j) - place(i));
            let length = offset.dot(offset).sqrt();
            let radii = [state.radius[i], state.radius[j]];
            let stiffness = joint.bond(radii[0], radii[1], length, 1.0).stiffness;
            let [own_arm, other_arm] = radii.map(|radius| length * radius / (radii[0] + radii[1]));
            let link = Link { other: j as u32, normal: offset * (1.0 / length), own_arm, other_arm, stiffness };
            rows[i].push(link);
            let (own_arm, other_arm) = (other_arm, own_arm);
            rows[j].push(Link { other: i as u32, normal: -link.normal, own_arm, other_arm, stiffness });
        }
        let mut start = vec![0];
        start.extend(rows.iter().scan(0, |end, row| {
            *end += row.len();
            Some(*end)
        }));
        let links: Vec<Link> = rows.concat();
        if links.is_empty() { Err(Error::NoBonds) } else { Ok(Assembly { start, links }) }
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.start.len() - 1
    }

    /// The particles that a particle is bonded to, by index.
    pub fn bonded_to(&self, particle: usize) -> impl Iterator<Item = usize> {
        self.row(particle).iter().map(|link| link.other as usize)
    }

    fn row(&self, particle: usize) -> &[Link] {
        &self.links[self.start[particle]..self.start[particle + 1]]
    }

    /// What all bonds do to a particle.
    fn pull(&self, particle: usize, displacement: &[Six]) -> Six {
        let own = &displacement[particle];
        let mut sum = [0.0; 6];
        for link in self.row(particle) {
            let pull = link.pull(own, &displacement[link.other as usize]);
            (0..6).for_each(|k| sum[k] += pull[k]);
        }
        sum
    }

    /// Forces and moments of the bonds on all particles under given displacements and rotations, `(N, 6)`.
    #[must_use]
    pub fn forces(&self, displacement: &[Six]) -> Vec<Six> {
        (0..self.particles()).into_par_iter().map(|k| self.pull(k, displacement)).collect()
    }

    /// The assembly at rest.
    ///
    /// # Errors
    /// [`Error::NotHeld`].
    pub fn solve(&self, boundary: &Boundary) -> Result<Solution, Error> {
        let (displacement, iterations) = gradients::solve(self, boundary)?;
        let mut reaction = self.forces(&displacement);
        for (reaction, load) in reaction.iter_mut().zip(&boundary.loads) {
            (0..6).for_each(|k| reaction[k] = -reaction[k] - load[k]);
        }
        Ok(Solution { displacement, reaction, iterations })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_ramp_moves_as_far_as_the_area_under_it() {
        let text = include_str!("../cases/tension.toml");
        let ramp = ("zone.1.prescribed.y".to_owned(), "[[1.0e-4, 0.0], [3.0e-4, 0.05]]".to_owned());
        let built = tdem_case::parse("tension.toml", text, Path::new("."), &[ramp]).unwrap().build().unwrap();
        for (duration, way) in [(0.5e-4, 0.0), (2e-4, 0.5 * 1e-4 * 0.025), (4e-4, 0.5 * 2e-4 * 0.05 + 1e-4 * 0.05)] {
            let boundary = Boundary::of_plan(&built.state, &built.plan, duration);
            let farthest = boundary.held.iter().filter_map(|held| held[1]).fold(0.0, f64::max);
            assert!((farthest - way).abs() < 1e-18, "{duration}: {farthest} instead of {way}");
        }
    }
}
