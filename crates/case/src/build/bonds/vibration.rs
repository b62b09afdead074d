//! How fast bonded particles can vibrate.

use super::{Bonded, offset};
use rayon::prelude::*;
use tdem_engine::physics::bond::Damping;
use tdem_engine::physics::motion::sphere_inertia;
use tdem_engine::physics::stability::BondedParticle;
use tdem_engine::{Constraint, Domain, State};

/// What the step limits need to know of bonds: the extremes over all particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vibration {
    /// No vibration is faster than this, rad/s, at any temperature.
    pub(crate) greatest_frequency: f64,
    /// No dashpots act faster than this, 1/s.
    pub(crate) greatest_damping_rate: f64,
    /// Velocity Verlet is stable up to this step, s.
    pub(crate) verlet_step: f64,
    /// Something vibrates at least so fast, rad/s: one particle alone, while its neighbours stand still, where temperature
    /// makes bonds softest.
    pub(crate) least_frequency: f64,
    /// The particle that sets the step.
    pub(crate) particle: usize,
}

impl Vibration {
    /// The more severe of each, the earlier particle where they are equal.
    fn or(self, other: Vibration) -> Vibration {
        let other_sets = (other.verlet_step, other.particle) < (self.verlet_step, self.particle);
        Vibration {
            greatest_frequency: self.greatest_frequency.max(other.greatest_frequency),
            greatest_damping_rate: self.greatest_damping_rate.max(other.greatest_damping_rate),
            verlet_step: self.verlet_step.min(other.verlet_step),
            least_frequency: self.least_frequency.max(other.least_frequency),
            particle: if other_sets { other.particle } else { self.particle },
        }
    }
    const NONE: Vibration = Vibration {
        greatest_frequency: 0.0,
        greatest_damping_rate: 0.0,
        verlet_step: f64::INFINITY,
        least_frequency: 0.0,
        particle: usize::MAX,
    };
}

impl Bonded {
    /// The fastest that can happen.
    pub(in crate::build) fn vibration(&self, domain: &Domain, state: &State, constraints: &[Constraint]) -> Vibration {
        let pairs = [self.pairs.as_slice(), &self.carried].concat();
        let rows = Rows::of(&pairs, state.len());
        (0..state.len())
            .into_par_iter()
            .with_min_len(1024)
            .map(|particle| self.of_particle(domain, state, constraints, particle, rows.of_particle(particle)))
            .reduce(|| Vibration::NONE, Vibration::or)
    }

    fn of_particle(
        &self,
        domain: &Domain,
        state: &State,
        constraints: &[Constraint],
        particle: usize,
        partners: &[u32],
    ) -> Vibration {
        let mut held = BondedParticle::default();
        let mut stiffness = [0.0; 3];
        let inertia = |index: usize| sphere_inertia(state.mass[index], state.radius[index]);
        for partner in partners.iter().map(|&partner| partner as usize) {
            let Some(joint) = self.joint(state, [particle, partner]) else { continue };
            let to = offset(domain, state, [particle, partner]);
            let length = to.dot(to).sqrt();
            let normal = to * (1.0 / length);
            let (here, there) = (state.radius[particle], state.radius[partner]);
            let [first, second] = [particle, partner].map(|index| state.sphere(index));
            let bond = joint.bond_of_spheres(Damping::Viscous, &first, &second, length, 1.0);
            let [softest, stiffest] = self.stiffness_factors(state, [particle, partner]);
            held.hold(&bond.tempered(stiffest, 1.0), normal, length * here / (here + there));
            let bond = bond.tempered(softest, 1.0);
            for (sum, cosine) in stiffness.iter_mut().zip([normal.x, normal.y, normal.z]) {
                *sum += bond.stiffness.shear + (bond.stiffness.normal - bond.stiffness.shear) * cosine * cosine;
            }
        }
        let mass = state.mass[particle];
        // What does not obey forces does not vibrate.
        let free = constraints[usize::from(state.constraint[particle])].velocity.map(|rate| rate.is_none());
        let most = stiffness.into_iter().zip(free).filter(|(_, free)| *free).map(|(sum, _)| sum).fold(0.0, f64::max);
        Vibration {
            greatest_frequency: held.greatest_frequency(mass, inertia(particle)),
            greatest_damping_rate: held.greatest_damping_rate(mass, inertia(particle)),
            verlet_step: held.verlet_step(mass, inertia(particle)),
            least_frequency: (most / mass).sqrt(),
            particle,
        }
    }
}

/// Whom each particle is bonded to.
struct Rows {
    starts: Vec<u32>,
    partners: Vec<u32>,
}

impl Rows {
    fn of(pairs: &[[u32; 2]], particles: usize) -> Self {
        let mut starts = vec![0_u32; particles + 1];
        pairs.iter().flatten().for_each(|&index| starts[index as usize + 1] += 1);
        for k in 0..particles {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let mut partners = vec![0; 2 * pairs.len()];
        for &[first, second] in pairs {
            for (from, to) in [(first, second), (second, first)] {
                let slot = &mut next[from as usize];
                partners[*slot as usize] = to;
                *slot += 1;
            }
        }
        Rows { starts, partners }
    }
    fn of_particle(&self, particle: usize) -> &[u32] {
        &self.partners[self.starts[particle] as usize..self.starts[particle + 1] as usize]
    }
}
