//! The particles in working order.

use super::correct::hold;
use crate::{Constraint, Integrator, Plan, State};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use tdem_physics::contact::Sphere;
use tdem_physics::motion::gear::{Derivatives, Trajectory};
use tdem_physics::{Vec3, vec3};

/// Four numbers that are used together and loaded at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Quad(pub(crate) [f64; 4]);

impl Quad {
    pub(crate) fn new(vector: [f64; 3], scalar: f64) -> Self {
        Quad([vector[0], vector[1], vector[2], scalar])
    }
    /// The first three.
    #[inline(always)]
    pub(crate) fn vector(&self) -> Vec3<f64> {
        vec3(self.0[0], self.0[1], self.0[2])
    }
    #[inline(always)]
    pub(crate) fn set_vector(&mut self, vector: Vec3<f64>) {
        [self.0[0], self.0[1], self.0[2]] = vector.into();
    }
    /// The last one.
    #[inline(always)]
    pub(crate) fn scalar(&self) -> f64 {
        self.0[3]
    }
}

/// The particles in working order, `N` of each; optional fields are empty where the plan does not need them.
#[derive(Default)]
pub(crate) struct Bodies {
    /// Place in the order of persistent ids.
    pub(crate) rank: Vec<u32>,
    /// Position and radius, m.
    pub(crate) place: Vec<Quad>,
    /// Velocity, m/s, and mass, kg.
    pub(crate) motion: Vec<Quad>,
    /// Angular velocity, rad/s; the fourth number is not used.
    pub(crate) spin: Vec<Quad>,
    /// Which way particles are turned, a quaternion x, y, z, w; optional.
    pub(crate) orientation: Vec<Quad>,
    /// N, and the heat rate into the particle, W; 0 without heat.
    pub(crate) force: Vec<Quad>,
    /// N m; optional; the fourth number is not used.
    pub(crate) moment: Vec<Quad>,
    pub(crate) material: Vec<u16>,
    pub(crate) constraint: Vec<u16>,
    /// Optional.
    pub(crate) image: Vec<[i32; 3]>,
    /// Optional.
    pub(crate) derivatives: Vec<[[f64; 3]; 4]>,
    /// Optional.
    pub(crate) accounts: Vec<[f64; 4]>,
    /// How the last half kick changed the velocity, m/s; optional, for the ledger.
    pub(crate) kick: Vec<Quad>,
    /// How it changed the angular velocity, rad/s; optional, for the ledger.
    pub(crate) twist: Vec<Quad>,
    /// K; optional.
    pub(crate) temperature: Vec<f64>,
    /// Optional.
    pub(crate) exposure: Vec<u16>,
    /// Radius at the reference temperature, m; optional.
    pub(crate) reference_radius: Vec<f64>,
    /// Optional.
    pub(crate) heat_accounts: Vec<[f64; 4]>,
    /// J/K; optional, for the ledger of what expands.
    pub(crate) work_per_kelvin: Vec<f64>,
    /// How much warmer a particle became in this step, K; optional, for the same.
    pub(crate) warming: Vec<f64>,
}

impl Bodies {
    /// Particles in the order of ids.
    pub(crate) fn from_state(state: &State, plan: &Plan) -> Self {
        let n = state.len();
        let (gear, periodic) = (plan.integrator == Integrator::Gear, plan.domain.period().any());
        let quads = |vectors: &[[f64; 3]], scalars: &[f64]| -> Vec<Quad> {
            vectors.iter().zip(scalars).map(|(&v, &s)| Quad::new(v, s)).collect()
        };
        Bodies {
            rank: (0..n as u32).collect(),
            place: quads(&state.position, &state.radius),
            motion: quads(&state.velocity, &state.mass),
            spin: state.angular_velocity.iter().map(|&v| Quad::new(v, 0.0)).collect(),
            orientation: state.orientation.iter().map(|&orientation| Quad(orientation)).collect(),
            force: heat_rates(state).zip(&state.force).map(|(rate, &v)| Quad::new(v, rate)).collect(),
            moment: if plan.law.moments {
                state.moment.iter().map(|&v| Quad::new(v, 0.0)).collect()
            } else {
                Vec::new()
            },
            material: state.material.clone(),
            constraint: state.constraint.clone(),
            image: if periodic { state.image.clone() } else { Vec::new() },
            derivatives: match (gear, state.derivatives.is_empty()) {
                (false, _) => Vec::new(),
                (true, true) => vec![[[0.0; 3]; 4]; n],
                (true, false) => state.derivatives.clone(),
            },
            accounts: match (plan.ledger, state.accounts.is_empty()) {
                (false, _) => Vec::new(),
                (true, true) => vec![[0.0; 4]; n],
                (true, false) => state.accounts.clone(),
            },
            kick: vec![Quad::default(); if plan.ledger && !gear { n } else { 0 }],
            twist: vec![Quad::default(); if plan.ledger && !gear && plan.law.moments { n } else { 0 }],
            temperature: state.temperature.clone(),
            exposure: state.exposure.clone(),
            reference_radius: state.reference_radius.clone(),
            heat_accounts: match (plan.ledger && plan.heat.is_some(), state.heat_accounts.is_empty()) {
                (false, _) => Vec::new(),
                (true, true) => vec![[0.0; 4]; n],
                (true, false) => state.heat_accounts.clone(),
            },
            work_per_kelvin: match (plan.books_expansion(), state.work_per_kelvin.is_empty()) {
                (false, _) => Vec::new(),
                (true, true) => vec![0.0; n],
                (true, false) => state.work_per_kelvin.clone(),
            },
            warming: vec![0.0; if plan.books_expansion() { n } else { 0 }],
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.rank.len()
    }

    /// Puts the particles in another order: the new particle `k` is the old `order[k]`.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        fn take<T: Copy + Send + Sync>(field: &mut Vec<T>, order: &[u32]) {
            if !field.is_empty() {
                *field = order.par_iter().map(|&from| field[from as usize]).collect();
            }
        }
        take(&mut self.rank, order);
        take(&mut self.place, order);
        take(&mut self.motion, order);
        take(&mut self.spin, order);
        take(&mut self.orientation, order);
        take(&mut self.force, order);
        take(&mut self.moment, order);
        take(&mut self.material, order);
        take(&mut self.constraint, order);
        take(&mut self.image, order);
        take(&mut self.derivatives, order);
        take(&mut self.accounts, order);
        take(&mut self.kick, order);
        take(&mut self.twist, order);
        take(&mut self.temperature, order);
        take(&mut self.exposure, order);
        take(&mut self.reference_radius, order);
        take(&mut self.heat_accounts, order);
        take(&mut self.work_per_kelvin, order);
        take(&mut self.warming, order);
    }

    /// Gear's second derivative from the forces of a fresh state, none of prescribed components; the higher ones are what
    /// the state says.
    pub(crate) fn start_derivatives(&mut self, plan: &Plan) {
        for (i, derivatives) in self.derivatives.iter_mut().enumerate() {
            let constraint = &plan.constraints[usize::from(self.constraint[i])];
            derivatives[0] = second_derivative(&self.force[i], &self.motion[i], constraint, plan.dt);
        }
    }

    /// Bytes per particle of what [`Bodies::from_state`] makes.
    pub(crate) fn bytes_each(plan: &Plan) -> usize {
        let (gear, moments) = (plan.integrator == Integrator::Gear, plan.law.moments);
        let optional = [
            (moments, size_of::<Quad>()),
            (plan.bonds.is_some(), size_of::<Quad>()),
            (plan.domain.period().any(), size_of::<[i32; 3]>()),
            (gear, size_of::<[[f64; 3]; 4]>()),
            (plan.ledger, size_of::<[f64; 4]>()),
            (plan.ledger && !gear, size_of::<Quad>()),
            (plan.ledger && !gear && moments, size_of::<Quad>()),
            (plan.heat.is_some(), size_of::<f64>() + size_of::<u16>()),
            (plan.expands(), size_of::<f64>()),
            (plan.ledger && plan.heat.is_some(), size_of::<[f64; 4]>()),
            (plan.books_expansion(), 2 * size_of::<f64>()),
        ];
        let optional: usize = optional.iter().filter(|(there, _)| *there).map(|(_, size)| size).sum();
        size_of::<u32>() + 4 * size_of::<Quad>() + 2 * size_of::<u16>() + optional
    }
    pub(crate) fn bytes(&self) -> usize {
        fn size<T>(field: &[T]) -> usize {
            std::mem::size_of_val(field)
        }
        size(&self.rank)
            + size(&self.place)
            + size(&self.motion)
            + size(&self.spin)
            + size(&self.orientation)
            + size(&self.force)
            + size(&self.moment)
            + size(&self.material)
            + size(&self.constraint)
            + size(&self.image)
            + size(&self.derivatives)
            + size(&self.accounts)
            + size(&self.kick)
            + size(&self.twist)
            + size(&self.temperature)
            + size(&self.exposure)
            + size(&self.reference_radius)
            + size(&self.heat_accounts)
            + size(&self.work_per_kelvin)
            + size(&self.warming)
    }
}

/// Heat rates of a state, zeros without heat.
fn heat_rates(state: &State) -> impl Iterator<Item = f64> + '_ {
    (0..state.len()).map(|i| state.heat_rate.get(i).copied().unwrap_or(0.0))
}

/// $\mathbf r_2 = \frac{\Delta t^2}{2m}\mathbf F$, m, but 0 in components that are prescribed.
pub(crate) fn second_derivative(force: &Quad, motion: &Quad, constraint: &Constraint, dt: f64) -> [f64; 3] {
    let free = force.vector() * (0.5 * dt * dt / motion.scalar());
    hold(free, Vec3::zero(), &constraint.velocity).into()
}

#[inline(always)]
pub(crate) fn sphere(place: &Quad, motion: &Quad, spin: &Quad) -> Sphere<f64> {
    Sphere {
        position: place.vector(),
        radius: place.scalar(),
        velocity: motion.vector(),
        mass: motion.scalar(),
        angular_velocity: spin.vector(),
    }
}

/// A particle as Gear's method sees it.
#[inline(always)]
pub(crate) fn trajectory(place: &Quad, motion: &Quad, derivatives: &[[f64; 3]; 4]) -> Trajectory<f64> {
    let derivatives: Derivatives<f64> = derivatives.map(Vec3::from);
    Trajectory { position: place.vector(), velocity: motion.vector(), derivatives }
}
