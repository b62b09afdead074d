//! What a simulation is: all that is needed to go on.

mod flaw;
mod hash;

pub use flaw::{Flaw, Wrong};

use crate::{Bond, BondHistory, Fault, Plan};

/// All that is needed to go on, in the order of persistent ids, whatever order a back end works in.
///
/// A state and its [`crate::Plan`] determine every later state to the last bit. `N` is the number of particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Steps done.
    pub step: u64,
    /// Whether `force` and `moment` belong to the present positions; false for a state just built.
    pub forces_known: bool,
    /// Mechanical energy at the start of the ledger, J.
    pub initial_energy: f64,
    /// Heat at the start of the ledger, over that of all particles at the reference temperature, J; 0 without heat.
    pub initial_heat: f64,
    /// Persistent ids, `(N)`, strictly ascending.
    pub id: Vec<u32>,
    /// Indices into the plan's materials, `(N)`.
    pub material: Vec<u16>,
    /// Indices into the plan's constraints, `(N)`; 0 is free.
    pub constraint: Vec<u16>,
    /// $R$, m, `(N)`.
    pub radius: Vec<f64>,
    /// $m$, kg, `(N)`.
    pub mass: Vec<f64>,
    /// $\mathbf x$, m, `(N, 3)`; inside the domain in directions that repeat.
    pub position: Vec<[f64; 3]>,
    /// How often a particle left the domain through each face that repeats, `(N, 3)`: the true position is
    /// `position + image * length`.
    pub image: Vec<[i32; 3]>,
    /// $\mathbf v$, m/s, `(N, 3)`.
    pub velocity: Vec<[f64; 3]>,
    /// $\boldsymbol\omega$, rad/s, `(N, 3)`.
    pub angular_velocity: Vec<[f64; 3]>,
    /// $\mathbf F$, gravity included, N, `(N, 3)`.
    pub force: Vec<[f64; 3]>,
    /// $\mathbf M$, N m, `(N, 3)`.
    pub moment: Vec<[f64; 3]>,
    /// Which way particles are turned since they were bonded, `(N, 4)`: a unit quaternion x, y, z, w, lab from body; empty
    /// without bonds.
    pub orientation: Vec<[f64; 4]>,
    /// $\mathbf x$ of each particle when bonds were made, inside the domain, m, `(N, 3)`: offsets between them are those
    /// of nearest images; empty without bonds.
    pub bonded_position: Vec<[f64; 3]>,
    /// Gear's scaled second to fifth derivatives, m, `(N, 4, 3)`; empty under velocity Verlet.
    pub derivatives: Vec<[[f64; 3]; 4]>,
    /// Energy accounts of each particle, J, `(N, 4)`, see [`energy_accounts`]; empty without ledger.
    pub accounts: Vec<[f64; 4]>,
    /// A point on each wall, m, `(walls, 3)`.
    pub wall_position: Vec<[f64; 3]>,
    /// Touching pairs, ascending by (first, second).
    pub contacts: Vec<Contact>,
    /// Particles that touch walls, ascending by (particle, wall).
    pub wall_contacts: Vec<WallContact>,
    /// Bonds, broken ones too, strictly ascending by (first, second).
    pub bonds: Vec<Bond>,
    /// What bonds remember, one for each; empty in the total form, and as long as no forces are known.
    pub bond_histories: Vec<BondHistory>,
    /// $T$, K, `(N)`; empty without heat.
    pub temperature: Vec<f64>,
    /// $Q$, into the particle, W, `(N)`, before the time scale; empty without heat. Like `force` it belongs to the present.
    pub heat_rate: Vec<f64>,
    /// Indices into the plan's exposures, `(N)`; 0 is insulated; empty without heat.
    pub exposure: Vec<u16>,
    /// $R_0$, m, `(N)`: the radius at the reference temperature; empty where nothing expands.
    pub reference_radius: Vec<f64>,
    /// Heat accounts of each particle, J, `(N, 4)`, see [`crate::heat_accounts`]; empty without ledger or heat.
    pub heat_accounts: Vec<[f64; 4]>,
    /// $\partial U/\partial T$: how much the energy in all springs grows per kelvin of a particle, J/K, `(N)`; for the
    /// ledger, empty where there is none or nothing expands or softens. Like `force` it belongs to the present.
    pub work_per_kelvin: Vec<f64>,
}

/// Columns of [`State::accounts`], each summed over all steps.
pub mod energy_accounts {
    /// Dissipated by sliding.
    pub const FRICTION: usize = 0;
    /// Dissipated by dashpots.
    pub const DAMPING: usize = 1;
    /// Put into tangential springs by a change of their stiffness.
    pub const STIFFENING: usize = 2;
    /// Work of moving walls, of prescribed motion and of applied forces.
    pub const EXTERNAL: usize = 3;
}

/// A touching pair and its history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The lower id.
    pub first: u32,
    /// The higher id.
    pub second: u32,
    /// Tangential displacement of the second surface relative to the first, m.
    pub displacement: [f64; 3],
}

/// A particle that touches a wall, and its history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallContact {
    /// Id of the particle.
    pub particle: u32,
    /// Index of the wall.
    pub wall: u32,
    /// Tangential displacement of the wall relative to the particle's surface, m.
    pub displacement: [f64; 3],
}

impl State {
    /// Number of particles, `N`.
    #[must_use]
    pub fn len(&self) -> usize {
        self.id.len()
    }
    /// Whether there are no particles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }
    /// Where a particle would be if nothing brought it back into a domain of these lengths, m.
    pub(crate) fn true_position(&self, index: usize, length: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.position[index][k] + f64::from(self.image[index][k]) * length[k])
    }
    /// Index of a persistent id.
    #[must_use]
    pub fn index_of(&self, id: u32) -> Option<usize> {
        // As long as nothing was removed, ids are indices.
        let guess = id as usize;
        if self.id.get(guess) == Some(&id) { Some(guess) } else { self.id.binary_search(&id).ok() }
    }

    /// Bytes of all arrays.
    pub(crate) fn bytes(&self) -> usize {
        fn size<T>(field: &[T]) -> usize {
            size_of_val(field)
        }
        [&self.position, &self.velocity, &self.angular_velocity, &self.force, &self.moment, &self.bonded_position]
            .into_iter()
            .map(|field| size(field))
            .chain([&self.radius, &self.mass, &self.temperature, &self.heat_rate].map(|field| size(field)))
            .chain([&self.reference_radius, &self.work_per_kelvin].map(|field| size(field)))
            .chain([&self.material, &self.constraint, &self.exposure].map(|field| size(field)))
            .sum::<usize>()
            + size(&self.id)
            + size(&self.image)
            + size(&self.orientation)
            + size(&self.derivatives)
            + size(&self.accounts)
            + size(&self.heat_accounts)
            + size(&self.contacts)
            + size(&self.wall_contacts)
            + size(&self.bonds)
            + size(&self.bond_histories)
    }
}

impl State {
    /// Checks that the fields belong together and to the plan.
    ///
    /// # Errors
    /// [`Fault::Inconsistent`] names what does not fit.
    pub fn validate(&self, plan: &Plan) -> Result<(), Fault> {
        let n = self.len();
        let check = |holds: bool, what| if holds { Ok(()) } else { Err(Fault::Inconsistent { what }) };
        check(self.id.is_sorted_by(|a, b| a < b), "ids ascend strictly")?;
        check(
            [self.material.len(), self.constraint.len(), self.radius.len(), self.mass.len()].iter().all(|&l| l == n),
            "material, constraint, radius and mass have one entry per particle",
        )?;
        check(
            [&self.position, &self.velocity, &self.angular_velocity, &self.force, &self.moment]
                .iter()
                .all(|field| field.len() == n)
                && self.image.len() == n,
            "position, image, velocity, angular velocity, force and moment have one entry per particle",
        )?;
        check(self.derivatives.is_empty() || self.derivatives.len() == n, "derivatives are for all particles or none")?;
        check(self.accounts.is_empty() || self.accounts.len() == n, "energy accounts are for all particles or none")?;
        check(self.material.iter().all(|&m| usize::from(m) < plan.materials), "every material is in the plan")?;
        check(plan.interactions.len() == plan.materials * plan.materials, "every pair of materials has parameters")?;
        check(plan.constraints.len() <= 1 << 15, "there are at most 32,768 constraints")?;
        check(
            self.constraint.iter().all(|&c| usize::from(c) < plan.constraints.len()),
            "every constraint is in the plan",
        )?;
        check(plan.ramps_are_sound(), "ramps ascend in time and drive components that constraints prescribe")?;
        check(plan.gauges.iter().all(|gauge| gauge.is_sound(self)), "gauges name particles that exist")?;
        check(self.wall_position.len() == plan.walls.len(), "every wall has a position")?;
        check(
            plan.walls.iter().all(|w| usize::from(w.material) < plan.materials),
            "every wall's material is in the plan",
        )?;
        check(
            self.contacts.is_sorted_by(|a, b| (a.first, a.second) < (b.first, b.second))
                && self.contacts.iter().all(|c| {
                    c.first < c.second && self.index_of(c.first).is_some() && self.index_of(c.second).is_some()
                }),
            "contacts ascend and name particles that exist",
        )?;
        check(
            self.wall_contacts.is_sorted_by(|a, b| (a.particle, a.wall) < (b.particle, b.wall))
                && self
                    .wall_contacts
                    .iter()
                    .all(|c| (c.wall as usize) < plan.walls.len() && self.index_of(c.particle).is_some()),
            "wall contacts ascend and name particles and walls that exist",
        )?;
        self.validate_bonds(plan)?;
        self.validate_heat(plan)
    }
}
