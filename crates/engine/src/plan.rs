//! What stays the same during a run.

use crate::BondPlan;
use tdem_physics::contact::{Interaction, Law, Period};

/// Laws, walls, boundary conditions and step of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// $\Delta t$, s.
    pub dt: f64,
    /// How particles move.
    pub integrator: Integrator,
    /// Which contact law acts.
    pub law: Law,
    /// Number of materials, walls' included.
    pub materials: usize,
    /// Parameters of each pair of materials, `(materials, materials)`, symmetric, row by row.
    pub interactions: Vec<Interaction<f64>>,
    /// How bonded particles hold together; `None` if none are.
    pub bonds: Option<BondPlan>,
    /// Walls; their present positions are in [`crate::State::wall_position`].
    pub walls: Vec<Wall>,
    /// $\mathbf g$, m/s².
    pub gravity: [f64; 3],
    /// What particles may be forbidden or ordered to do; the first entry is [`Constraint::FREE`].
    pub constraints: Vec<Constraint>,
    /// Where particles may be.
    pub domain: Domain,
    /// How neighbours are found.
    pub search: Search,
    /// Largest overlap, as a fraction of the mean radius of the pair; a larger one is a fault.
    pub overlap_limit: f64,
    /// Whether dissipated energy is accounted for, step by step.
    pub ledger: bool,
}

impl Plan {
    /// Parameters of a pair of materials.
    #[must_use]
    pub fn interaction(&self, first: u16, second: u16) -> &Interaction<f64> {
        &self.interactions[usize::from(first) * self.materials + usize::from(second)]
    }
    /// Time after a number of steps, s.
    #[must_use]
    pub fn time(&self, step: u64) -> f64 {
        step as f64 * self.dt
    }
}

/// How particles move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Velocity Verlet, angular velocity kicked by halves.
    VelocityVerlet,
    /// Gear's fifth-order predictor-corrector, angular velocity by Euler's rule (the paper's).
    Gear,
}

/// A plane wall, infinite, moving in a straight line.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Its name in the case and in messages.
    pub name: String,
    /// Unit normal, towards the particles.
    pub normal: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Index of its material.
    pub material: u16,
}

/// Components of motion that forces do not govern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// Prescribed velocity per component, m/s; `None` leaves the component to the forces.
    pub velocity: [Option<f64>; 3],
    /// Prescribed angular velocity per component, rad/s.
    pub angular_velocity: [Option<f64>; 3],
}

impl Constraint {
    /// Everything is left to the forces.
    pub const FREE: Constraint = Constraint { velocity: [None; 3], angular_velocity: [None; 3] };
}

/// Where particles may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Lower corner, m.
    pub min: [f64; 3],
    /// Upper corner, m.
    pub max: [f64; 3],
    /// Directions in which the box repeats; in the others, a centre outside it is a fault.
    pub periodic: [bool; 3],
}

impl Domain {
    /// Extent, m.
    #[must_use]
    pub fn length(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.max[k] - self.min[k])
    }
    /// The lengths that repeat.
    #[must_use]
    pub fn period(&self) -> Period<f64> {
        let length = self.length();
        Period::new(std::array::from_fn(|k| self.periodic[k].then_some(length[k])))
    }
}

/// How neighbours are found. None of these changes a bit of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Pairs are listed up to this gap, m; the list holds until something has moved half of it.
    pub skin: f64,
    /// List anew in every step, as the paper does.
    pub every_step: bool,
}
