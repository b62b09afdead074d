//! Where the energy is, where it went, and whether the sum closes.

use crate::{Plan, State};
use rayon::prelude::*;
use tdem_physics::contact::{Encounter, Sphere, Touch, respond, stored_energy, touch_spheres, touch_wall};
use tdem_physics::motion::sphere_inertia;
use tdem_physics::{Vec3, vec3};

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
    /// $-\sum m\,\mathbf g\cdot\mathbf x$, images counted, J.
    pub gravitational: f64,
    /// Dissipated by sliding since the start, J.
    pub friction_dissipated: f64,
    /// Dissipated by dashpots since the start, J.
    pub damping_dissipated: f64,
    /// Put into tangential springs by a change of their stiffness since the start, J.
    pub stiffening_work: f64,
    /// Work of walls and prescribed motion since the start, J.
    pub external_work: f64,
    /// What the ledger does not explain: present + dissipated - work - initial, J; 0 without ledger.
    pub energy_error: f64,
    /// Touching pairs of particles.
    pub contacts: u64,
    /// Particles touching walls, counted per wall.
    pub wall_contacts: u64,
    /// Largest speed, m/s.
    pub largest_speed: f64,
    /// Largest overlap of a pair, as a fraction of its mean radius.
    pub largest_overlap: f64,
    /// Mean size of the resultant force on a particle over mean size of a contact force; 0 without contacts.
    pub unbalanced_force_ratio: f64,
    /// Force of the particles on each wall would need a table of its own; this is the sum over all walls, N.
    pub wall_force: [f64; 3],
}

/// Particles or contacts per partial sum. Fixed, so that sums have the same bits for any number of threads.
const CHUNK: usize = 1024;

/// Sums `K` quantities over `0..count`: within chunks in order, then the chunks in order.
fn sum<const K: usize>(count: usize, term: impl Fn(usize) -> [f64; K] + Sync) -> [f64; K] {
    let partial: Vec<[f64; K]> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut total = [0.0; K];
            for index in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                let term = term(index);
                for k in 0..K {
                    total[k] += term[k];
                }
            }
            total
        })
        .collect();
    let mut total = [0.0; K];
    for chunk in partial {
        for k in 0..K {
            total[k] += chunk[k];
        }
    }
    total
}

/// The largest of a quantity over `0..count`, 0 if there are none.
fn largest(count: usize, value: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
    (0..count).into_par_iter().map(value).reduce(|| 0.0, f64::max)
}

impl Ledger {
    /// Takes stock of a state. The result has the same bits for any number of threads.
    #[must_use]
    pub fn of(state: &State, plan: &Plan) -> Ledger {
        let gravity: Vec3<f64> = plan.gravity.into();
        let length = plan.domain.length();
        let [kinetic_translation, kinetic_rotation, gravitational, resultant] = sum(state.len(), |i| {
            let (velocity, spin): (Vec3<f64>, Vec3<f64>) = (state.velocity[i].into(), state.angular_velocity[i].into());
            let (mass, force): (f64, Vec3<f64>) = (state.mass[i], state.force[i].into());
            let unfolded: [f64; 3] =
                std::array::from_fn(|k| state.position[i][k] + f64::from(state.image[i][k]) * length[k]);
            [
                0.5 * mass * velocity.dot(velocity),
                0.5 * sphere_inertia(mass, state.radius[i]) * spin.dot(spin),
                -(mass * gravity.dot(unfolded.into())),
                force.dot(force).sqrt(),
            ]
        });
        let pairs = Pairs { state, plan };
        let [pair_normal, pair_tangential, pair_force] = sum(state.contacts.len(), |k| pairs.of_particles(k));
        let [wall_normal, wall_tangential, wall_size, fx, fy, fz] =
            sum(state.wall_contacts.len(), |k| pairs.of_wall(k));
        let [friction, damping, stiffening, external] = sum(state.accounts.len(), |i| state.accounts[i]);

        let contacts = state.contacts.len() + state.wall_contacts.len();
        let mean_contact = (pair_force + wall_size) / contacts.max(1) as f64;
        let mean_resultant = resultant / state.len().max(1) as f64;
        let mut ledger = Ledger {
            kinetic_translation,
            kinetic_rotation,
            elastic_normal: pair_normal + wall_normal,
            elastic_tangential: pair_tangential + wall_tangential,
            gravitational,
            friction_dissipated: friction,
            damping_dissipated: damping,
            stiffening_work: stiffening,
            external_work: external,
            energy_error: 0.0,
            contacts: state.contacts.len() as u64,
            wall_contacts: state.wall_contacts.len() as u64,
            largest_speed: largest(state.len(), |i| {
                let velocity: Vec3<f64> = state.velocity[i].into();
                velocity.dot(velocity).sqrt()
            }),
            largest_overlap: largest(state.contacts.len(), |k| pairs.overlap_ratio(k)),
            unbalanced_force_ratio: if mean_contact > 0.0 { mean_resultant / mean_contact } else { 0.0 },
            wall_force: [fx, fy, fz],
        };
        if plan.ledger && state.accounts.len() == state.len() {
            ledger.energy_error =
                ledger.mechanical() + (friction + damping) - stiffening - external - state.initial_energy;
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
            + self.gravitational
    }
    /// Kinetic energy, J.
    #[must_use]
    pub fn kinetic(&self) -> f64 {
        self.kinetic_translation + self.kinetic_rotation
    }
}

/// The contacts of a state, looked at once more.
struct Pairs<'a> {
    state: &'a State,
    plan: &'a Plan,
}

impl Pairs<'_> {
    fn sphere(&self, index: usize) -> Sphere<f64> {
        Sphere {
            position: self.state.position[index].into(),
            radius: self.state.radius[index],
            velocity: self.state.velocity[index].into(),
            mass: self.state.mass[index],
            angular_velocity: self.state.angular_velocity[index].into(),
        }
    }
    /// Indices of a pair. An id that is missing cannot occur in a validated state; it then counts as the first.
    fn indices(&self, contact: usize) -> (usize, usize) {
        let contact = self.state.contacts[contact];
        let index = |id| self.state.index_of(id).unwrap_or(0);
        (index(contact.first), index(contact.second))
    }
    fn touch(&self, first: usize, second: usize) -> Touch<f64> {
        let position = |index: usize| -> Vec3<f64> { self.state.position[index].into() };
        let offset = self.plan.domain.period().nearest(position(second) - position(first));
        touch_spheres(offset, self.state.radius[first] + self.state.radius[second])
    }
    fn overlap_ratio(&self, contact: usize) -> f64 {
        let (first, second) = self.indices(contact);
        2.0 * self.touch(first, second).overlap / (self.state.radius[first] + self.state.radius[second])
    }
    /// Normal and tangential energy, size of the force.
    fn of_particles(&self, contact: usize) -> [f64; 3] {
        let (first, second) = self.indices(contact);
        let touch = self.touch(first, second);
        if touch.overlap <= 0.0 {
            // Gear's corrector moves particles after forces were computed, and may part them.
            return [0.0; 3];
        }
        let (a, b) = (self.sphere(first), self.sphere(second));
        let encounter = Encounter::of_spheres(&a, &b, &touch, self.plan.law.moments);
        let interaction = self.plan.interaction(self.state.material[first], self.state.material[second]);
        let displacement = self.state.contacts[contact].displacement.into();
        let (normal, tangential) = stored_energy(encounter.radius_eff, touch.overlap, displacement, interaction);
        let force = respond(self.plan.law, &encounter, displacement, interaction, 0.0).force;
        [normal, tangential, force.dot(force).sqrt()]
    }
    /// Normal and tangential energy, size of the force, force on the wall.
    fn of_wall(&self, contact: usize) -> [f64; 6] {
        let contact = self.state.wall_contacts[contact];
        let index = self.state.index_of(contact.particle).unwrap_or(0);
        let wall = &self.plan.walls[contact.wall as usize];
        let sphere = self.sphere(index);
        let normal: Vec3<f64> = wall.normal.into();
        let point = self.state.wall_position[contact.wall as usize].into();
        let touch = touch_wall(sphere.position, sphere.radius, point, normal);
        if touch.overlap <= 0.0 {
            return [0.0; 6];
        }
        let encounter = Encounter::with_wall(&sphere, &touch, normal, wall.velocity.into(), self.plan.law.moments);
        let interaction = self.plan.interaction(self.state.material[index], wall.material);
        let displacement = contact.displacement.into();
        let (stored, sheared) = stored_energy(encounter.radius_eff, touch.overlap, displacement, interaction);
        let force = respond(self.plan.law, &encounter, displacement, interaction, 0.0).force;
        let on_wall = vec3(-force.x, -force.y, -force.z);
        [stored, sheared, force.dot(force).sqrt(), on_wall.x, on_wall.y, on_wall.z]
    }
}
