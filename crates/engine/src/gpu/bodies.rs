//! The particles, walls and constants of a run on a device, and what kernels are told.

use super::layout::{Box3, Constraint, Pair, Step, Vector, Wall};
use super::memory::{Buffer, Queue};
use super::program::only_interaction;
use super::runtime::{Error, Runtime};
use crate::cpu::Quad;
use crate::{Plan, State};

/// What neighbours see of particles and walls, in working order. There are two, so that a step can read one and write
/// the other; between steps the other one holds forces in `place` and moments in `spin`.
pub(super) struct Half<M> {
    /// Position and radius.
    pub(super) place: Buffer<Quad, M>,
    /// Velocity and mass.
    pub(super) motion: Buffer<Quad, M>,
    /// Angular velocity; empty without moments.
    pub(super) spin: Buffer<Quad, M>,
    /// A point on each wall.
    pub(super) wall_place: Buffer<Quad, M>,
}

/// What only the particle itself needs, in working order; fields that the plan does without are empty. Fields of several
/// numbers stand in planes of one number each.
pub(super) struct Fields<M> {
    /// Place in the order of persistent ids.
    pub(super) rank: Buffer<u32, M>,
    /// Material, and above 16 bits the constraint.
    pub(super) kind: Buffer<u32, M>,
    /// 3 planes.
    pub(super) image: Buffer<i32, M>,
    /// 12 planes.
    pub(super) derivatives: Buffer<f64, M>,
    /// 4 planes.
    pub(super) accounts: Buffer<f64, M>,
    pub(super) kick_by_half: Buffer<Quad, M>,
    pub(super) twist_by_half: Buffer<Quad, M>,
}

/// What stays the same during a run.
pub(super) struct Constants<M> {
    pub(super) interactions: Buffer<Pair, M>,
    pub(super) constraints: Buffer<Constraint, M>,
    pub(super) walls: Buffer<Wall, M>,
}

impl<M> Half<M> {
    pub(super) fn new<R: Runtime<Memory = M>>(queue: &Queue<R>, n: usize, plan: &Plan) -> Result<Self, Error> {
        Ok(Half {
            place: queue.buffer(n)?,
            motion: queue.buffer(n)?,
            spin: queue.buffer(if plan.law.moments { n } else { 0 })?,
            wall_place: queue.buffer(plan.walls.len())?,
        })
    }
    pub(super) fn take_up<R: Runtime<Memory = M>>(&self, queue: &Queue<R>, state: &State) -> Result<(), Error> {
        let quads = |vectors: &[[f64; 3]], scalars: &[f64]| -> Vec<Quad> {
            vectors.iter().zip(scalars).map(|(&v, &s)| Quad::new(v, s)).collect()
        };
        queue.upload(&self.place, &quads(&state.position, &state.radius))?;
        queue.upload(&self.motion, &quads(&state.velocity, &state.mass))?;
        if self.spin.len() > 0 {
            queue.upload(&self.spin, &unpaired(&state.angular_velocity))?;
        }
        queue.upload(&self.wall_place, &unpaired(&state.wall_position))
    }
}

/// Vectors with nothing in the fourth place.
pub(super) fn unpaired(vectors: &[[f64; 3]]) -> Vec<Quad> {
    vectors.iter().map(|&v| Quad::new(v, 0.0)).collect()
}

impl<M> Fields<M> {
    pub(super) fn new<R: Runtime<Memory = M>>(queue: &Queue<R>, state: &State, plan: &Plan) -> Result<Self, Error> {
        let n = state.len();
        let gear = plan.integrator == crate::Integrator::Gear;
        let kinds: Vec<u32> =
            state.material.iter().zip(&state.constraint).map(|(&m, &c)| u32::from(m) | u32::from(c) << 16).collect();
        let planes = |count: usize, wanted: bool, given: bool, value: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            match (wanted, given) {
                (false, _) => Vec::new(),
                (true, false) => vec![0.0; count * n],
                (true, true) => (0..count).flat_map(|c| (0..n).map(move |i| value(c, i))).collect(),
            }
        };
        let derivatives = planes(12, gear, !state.derivatives.is_empty(), &|c, i| state.derivatives[i][c / 3][c % 3]);
        let accounts = planes(4, plan.ledger, !state.accounts.is_empty(), &|c, i| state.accounts[i][c]);
        let image: Vec<i32> = if plan.domain.period().any() {
            (0..3).flat_map(|k| state.image.iter().map(move |image| image[k])).collect()
        } else {
            Vec::new()
        };
        let kicks = if plan.ledger && !gear { n } else { 0 };
        Ok(Fields {
            rank: queue.buffer_of(&(0..n as u32).collect::<Vec<_>>())?,
            kind: queue.buffer_of(&kinds)?,
            image: queue.buffer_of(&image)?,
            derivatives: queue.buffer_of(&derivatives)?,
            accounts: queue.buffer_of(&accounts)?,
            kick_by_half: queue.zeros(kicks)?,
            twist_by_half: queue.zeros(if plan.law.moments { kicks } else { 0 })?,
        })
    }
}

impl<M> Constants<M> {
    pub(super) fn new<R: Runtime<Memory = M>>(queue: &Queue<R>, plan: &Plan) -> Result<Self, Error> {
        let pairs: Vec<Pair> = plan.interactions.iter().map(Pair::from).collect();
        let walls: Vec<Wall> = plan
            .walls
            .iter()
            .map(|wall| Wall {
                normal: Vector(wall.normal),
                velocity: Vector(wall.velocity),
                material: wall.material.into(),
                padding: 0,
            })
            .collect();
        let constraints: Vec<Constraint> = plan
            .constraints
            .iter()
            .map(|constraint| {
                let given = [constraint.velocity, constraint.angular_velocity];
                let held = given.iter().flatten().enumerate();
                Constraint {
                    velocity: Vector(given[0].map(Option::unwrap_or_default)),
                    angular_velocity: Vector(given[1].map(Option::unwrap_or_default)),
                    components: held.fold(0, |bits, (k, value)| bits | u32::from(value.is_some()) << k),
                    padding: 0,
                }
            })
            .collect();
        Ok(Constants {
            interactions: queue.buffer_of(&pairs)?,
            constraints: queue.buffer_of(&constraints)?,
            walls: queue.buffer_of(&walls)?,
        })
    }
}

/// What the kernels of a step are told.
pub(super) fn step_record(plan: &Plan, state: &State) -> Step {
    let particles = state.len();
    let half_skin = 0.5 * plan.search.skin;
    let period = plan.domain.period();
    // Bounds of directions that repeat are not a limit: a centre is brought back in before it is looked at.
    Step {
        dt: plan.dt,
        half_dt: 0.5 * plan.dt,
        history_dt: plan.dt,
        half_skin_squared: if plan.search.every_step { f64::INFINITY } else { half_skin * half_skin },
        noted_way_squared: if plan.ledger { half_skin * half_skin } else { f64::INFINITY },
        overlap_limit: 0.5 * plan.overlap_limit,
        gravity: Vector(plan.gravity),
        domain_min: Vector(plan.domain.min),
        domain_max: Vector(plan.domain.max),
        period: Box3::from(&period),
        pair: only_interaction(plan, state).map(Pair::from).unwrap_or_default(),
        particles: particles as u32,
        walls: plan.walls.len() as u32,
        items: particles.max(plan.walls.len()) as u32,
        materials: plan.materials as u32,
        parity: 0,
        frozen: 0,
        corrects: 0,
        padding: 0,
    }
}
