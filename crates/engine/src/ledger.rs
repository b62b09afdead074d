//! Where the energy is, where it went, and whether the sum closes.

mod heat;

pub use heat::HeatLedger;

use crate::exact::{ExactSum, accumulate, exact_sums, tally};
use crate::{Contact, Plan, State, WallContact, heat_accounts};
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::motion::sphere_inertia;

/// Energies and measures of one instant, as a row of `history.csv` shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ledger {
    /// $\sum\tfrac12mv^2$, J.
    pub kinetic_translation: f64,
    /// $\sum\tfrac12I\omega^2$, J.
    pub kinetic_rotation: f64,
    /// Stored in normal springs, J.
    pub elastic_normal: f64,
    /// Stored in tangential springs, J.
    pub elastic_tangential: f64,
    /// Stored in bonds, J.
    pub elastic_bonds: f64,
    /// $-\sum m\,\mathbf g\cdot\mathbf x$, images counted, J.
    pub gravitational: f64,
    /// Dissipated by sliding since the start, J.
    pub friction_dissipated: f64,
    /// Dissipated by dashpots since the start, J.
    pub damping_dissipated: f64,
    /// Gone with bonds that broke, since the start, J.
    pub breakage_dissipated: f64,
    /// Put into tangential springs by a change of their stiffness since the start, J.
    pub stiffening_work: f64,
    /// Work of walls, prescribed motion and applied forces since the start, J.
    pub external_work: f64,
    /// Work that expansion did on springs since the start, and temperature where it changed their stiffness, J.
    pub expansion_work: f64,
    /// What the ledger does not explain: present + dissipated - work - initial, J; 0 without ledger.
    pub energy_error: f64,
    /// Touching pairs of particles.
    pub contacts: u64,
    /// Particles touching walls, counted per wall.
    pub wall_contacts: u64,
    /// Bonds that hold.
    pub bonds: u64,
    /// Bonds that broke.
    pub broken_bonds: u64,
    /// Largest speed, m/s.
    pub largest_speed: f64,
    /// Largest overlap of a pair as a fraction of its smaller radius, or at a wall as a fraction of the radius.
    pub largest_overlap: f64,
    /// Mean size of the resultant force on a particle over mean size of a force of contacts and bonds; 0 without any.
    /// Components that are prescribed do not count: something holds them.
    pub unbalanced_force_ratio: f64,
    /// Where the heat is; `None` without heat.
    pub heat: Option<HeatLedger>,
    /// Force of the particles on each wall would need a table of its own; this is the sum over all walls, N.
    pub wall_force: [f64; 3],
}

/// Lowest and highest value; infinite if there are none.
pub(crate) fn extremes(values: &[f64]) -> [f64; 2] {
    let fold = || [f64::INFINITY, f64::NEG_INFINITY];
    let wider = |[low, high]: [f64; 2], [a, b]: [f64; 2]| [low.min(a), high.max(b)];
    values.par_iter().fold(fold, |range, &value| wider(range, [value; 2])).reduce(fold, wider)
}

impl Ledger {
    /// Takes stock of a state. Sums over particles, contacts and bonds are exact, see [`ExactSum`].
    #[must_use]
    pub fn of(state: &State, plan: &Plan) -> Ledger {
        let gravity: Vec3<f64> = plan.gravity.into();
        let length = plan.domain.length();
        let (of_particles, largest_speed) = tally(state.len(), |i| {
            let (velocity, spin): (Vec3<f64>, Vec3<f64>) = (state.velocity[i].into(), state.angular_velocity[i].into());
            let mass = state.mass[i];
            let unfolded = state.true_position(i, length);
            let terms = [
                0.5 * mass * velocity.dot(velocity),
                0.5 * sphere_inertia(mass, state.radius[i]) * spin.dot(spin),
                -(mass * gravity.dot(unfolded.into())),
                resultant_of(state, plan, i),
            ];
            (terms, velocity.dot(velocity).sqrt())
        });
        let [kinetic_translation, kinetic_rotation, gravitational, resultant] = of_particles.map(|sum| sum.value());
        let ([pair_normal, pair_tangential, pair_force], largest_overlap) =
            tally(state.contacts.len(), |k| of_pair(state, plan, &state.contacts[k]));
        let ([wall_normal, wall_tangential, wall_size, fx, fy, fz], largest_wall_overlap) =
            tally(state.wall_contacts.len(), |k| at_wall(state, plan, &state.wall_contacts[k]));
        let [friction, damping, stiffening, external] = exact_sums(state.accounts.len(), |i| state.accounts[i]);

        let [expansion] = exact_sums(state.heat_accounts.len(), |i| [state.heat_accounts[i][heat_accounts::EXPANSION]]);
        let [elastic_bonds, bond_force, bonds, released] = accumulate(state.bonds.len(), |k| of_bond(state, plan, k));
        let (holding, released) = (bonds.value() as usize, released.value());
        let imbalance = Imbalance::mean(state, resultant, &[pair_force, wall_size, bond_force], holding);
        let mut ledger = Ledger {
            kinetic_translation,
            kinetic_rotation,
            elastic_normal: together(&[pair_normal, wall_normal]),
            elastic_tangential: together(&[pair_tangential, wall_tangential]),
            elastic_bonds: elastic_bonds.value(),
            gravitational,
            friction_dissipated: friction,
            damping_dissipated: damping,
            breakage_dissipated: released,
            stiffening_work: stiffening,
            external_work: external,
            expansion_work: expansion,
            energy_error: 0.0,
            contacts: state.contacts.len() as u64,
            wall_contacts: state.wall_contacts.len() as u64,
            bonds: holding as u64,
            broken_bonds: (state.bonds.len() - holding) as u64,
            largest_speed,
            largest_overlap: largest_overlap.max(largest_wall_overlap),
            unbalanced_force_ratio: imbalance.ratio(0.0),
            heat: HeatLedger::of(state, plan),
            wall_force: [fx, fy, fz].map(|sum| sum.value()),
        };
        if plan.ledger && state.accounts.len() == state.len() {
            let left = ledger.mechanical() + (friction + damping + released);
            ledger.energy_error = left - stiffening - external - expansion - state.initial_energy;
        }
        ledger
    }

    /// Kinetic, elastic and gravitational energy together, J.
    #[must_use]
    pub fn mechanical(&self) -> f64 {
        self.kinetic_translation
            + self.kinetic_rotation
            + self.elastic_normal
            + self.elastic_tangential
            + self.elastic_bonds
            + self.gravitational
    }
    /// Kinetic energy, J.
    #[must_use]
    pub fn kinetic(&self) -> f64 {
        self.kinetic_translation + self.kinetic_rotation
    }
}

/// The sum of all terms of several sums, rounded once.
fn together(sums: &[ExactSum]) -> f64 {
    let mut all = ExactSum::default();
    for sum in sums {
        all.merge(sum);
    }
    all.value()
}

/// Energy in all springs, J: an exact sum.
pub(crate) fn elastic_energy(state: &State, plan: &Plan) -> f64 {
    let [normal, tangential, _] = tally(state.contacts.len(), |k| of_pair(state, plan, &state.contacts[k])).0;
    let [wall_normal, wall_tangential] = accumulate(state.wall_contacts.len(), |k| {
        let ([normal, tangential, ..], _) = at_wall(state, plan, &state.wall_contacts[k]);
        [normal, tangential]
    });
    let [bonds] = accumulate(state.bonds.len(), |k| [of_bond(state, plan, k)[0]]);
    together(&[normal, tangential, wall_normal, wall_tangential, bonds])
}

/// How far from equilibrium particles are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Imbalance {
    /// Mean size of the resultant force on a particle without prescribed components, N.
    resultant: f64,
    /// Mean size of a force of contacts and bonds, N.
    force: f64,
}

impl Imbalance {
    /// That of a state, from exact sums.
    pub(crate) fn of(state: &State, plan: &Plan) -> Self {
        let [resultant] = exact_sums(state.len(), |i| [resultant_of(state, plan, i)]);
        let [pair] = accumulate(state.contacts.len(), |k| [of_pair(state, plan, &state.contacts[k]).0[2]]);
        let [wall] = accumulate(state.wall_contacts.len(), |k| [at_wall(state, plan, &state.wall_contacts[k]).0[2]]);
        let [bond, holding] = accumulate(state.bonds.len(), |k| {
            let [_, force, holds, _] = of_bond(state, plan, k);
            [force, holds]
        });
        Imbalance::mean(state, resultant, &[pair, wall, bond], holding.value() as usize)
    }
    /// From sums, and the number of bonds that hold.
    fn mean(state: &State, resultant: f64, forces: &[ExactSum; 3], holding: usize) -> Self {
        let contacts = state.contacts.len() + state.wall_contacts.len() + holding;
        Imbalance { resultant: resultant / state.len().max(1) as f64, force: together(forces) / contacts.max(1) as f64 }
    }
    /// Mean resultant over mean force, or over a force that counts as small if that is more; 0 without forces.
    pub(crate) fn ratio(&self, small: f64) -> f64 {
        let force = self.force.max(small);
        if force > 0.0 { self.resultant / force } else { 0.0 }
    }
}

/// Size of the resultant force on a particle without its prescribed components, N.
fn resultant_of(state: &State, plan: &Plan, particle: usize) -> f64 {
    let force: Vec3<f64> = state.force[particle].into();
    let prescribed = &plan.constraints[usize::from(state.constraint[particle])].velocity;
    let [x, y, z] = prescribed.map(|rate| f64::from(u8::from(rate.is_none())));
    let unbalanced = Vec3 { x: force.x * x, y: force.y * y, z: force.z * z };
    unbalanced.dot(unbalanced).sqrt()
}

/// Normal and tangential energy and size of the force of a pair, and its overlap as a fraction of the smaller radius.
fn of_pair(state: &State, plan: &Plan, contact: &Contact) -> ([f64; 3], f64) {
    state.evaluate(plan, contact).map_or(([0.0; 3], 0.0), |found| {
        let [normal, tangential] = found.stored_energy();
        ([normal, tangential, found.force.dot(found.force).sqrt()], found.overlap_ratio())
    })
}

/// Elastic energy and size of the force of a bond, 1 if it holds, and the energy that left with it if not.
fn of_bond(state: &State, plan: &Plan, bond: usize) -> [f64; 4] {
    match (state.bonds[bond].breakage, state.evaluate_bond(plan, bond)) {
        (Some(breakage), _) => [0.0, 0.0, 0.0, breakage.energy],
        (None, Some(found)) => {
            let force = found.reaction.force;
            [found.stored_energy(), force.dot(force).sqrt(), 1.0, 0.0]
        }
        (None, None) => [0.0; 4],
    }
}

/// Energies and size of the force of a particle at a wall, the force on the wall, and the overlap as a fraction of the radius.
fn at_wall(state: &State, plan: &Plan, contact: &WallContact) -> ([f64; 6], f64) {
    state.evaluate_at_wall(plan, contact).map_or(([0.0; 6], 0.0), |found| {
        let ([normal, tangential], force) = (found.stored_energy(), found.force);
        ([normal, tangential, force.dot(force).sqrt(), -force.x, -force.y, -force.z], found.overlap_ratio())
    })
}
