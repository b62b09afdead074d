//! The particles, walls and constants of a run on a device, and what kernels are told.

use super::layout::{Beam, Box3, ConductorOf, Constraint, LinkOf, Pair, Piece, Step, Vector, Wall};
use super::memory::{Buffer, Queue};
use super::program::only_of_pairs;
use super::runtime::{Error, Runtime};
use crate::cpu::Quad;
use crate::{Course, Driven, Integrator, Plan, State, Table, plan};

/// What neighbours see of particles and walls, in working order. There are two, so that a step can read one and write
/// the other; between steps the other one holds forces and heat rates in `place` and moments in `spin`. While a list is made, it is room
/// for the search.
pub(super) struct Half<M> {
    /// Position and radius.
    pub(super) place: Buffer<Quad, M>,
    /// Velocity and mass.
    pub(super) motion: Buffer<Quad, M>,
    /// Angular velocity and, with heat, temperature; empty without moments.
    pub(super) spin: Buffer<Quad, M>,
    /// Which way particles are turned; empty without bonds.
    pub(super) orientation: Buffer<Quad, M>,
    /// K; empty without heat, and with moments: then it stands in `spin`.
    pub(super) temperature: Buffer<f64, M>,
    /// A point on each wall.
    pub(super) wall_place: Buffer<Quad, M>,
}

/// What only the particle itself needs, in working order; fields that the plan does without are empty.
pub(super) struct Fields<M> {
    /// Place in the order of persistent ids.
    pub(super) rank: Buffer<u32, M>,
    /// See [`kind`].
    pub(super) kind: Buffer<u32, M>,
    /// 3 planes of one number each.
    pub(super) image: Buffer<i32, M>,
    /// The four of x, of y, of z.
    pub(super) derivatives: [Buffer<Quad, M>; 3],
    pub(super) accounts: Buffer<Quad, M>,
    pub(super) kick_by_half: Buffer<Quad, M>,
    pub(super) twist_by_half: Buffer<Quad, M>,
}

/// What stays the same during a run.
pub(super) struct Constants<M> {
    pub(super) interactions: Buffer<Pair, M>,
    pub(super) constraints: Buffer<Constraint, M>,
    /// Pieces of ramps and courses, those of one constraint or course side by side.
    pub(super) pieces: Buffer<Piece, M>,
    pub(super) walls: Buffer<Wall, M>,
}

impl<M> Half<M> {
    pub(super) fn new<R: Runtime<Memory = M>>(queue: &Queue<R>, state: &State, plan: &Plan) -> Result<Self, Error> {
        let n = state.len();
        Ok(Half {
            place: queue.buffer(n)?,
            motion: queue.buffer(n)?,
            spin: queue.buffer(if plan.law.moments { n } else { 0 })?,
            orientation: queue.buffer(state.orientation.len())?,
            temperature: queue.buffer(if plan.law.moments { 0 } else { state.temperature.len() })?,
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
            let temperatures = if state.temperature.is_empty() { &vec![0.0; state.len()] } else { &state.temperature };
            queue.upload(&self.spin, &quads(&state.angular_velocity, temperatures))?;
        }
        let orientation: Vec<Quad> = state.orientation.iter().map(|&q| Quad(q)).collect();
        queue.upload(&self.orientation, &orientation)?;
        if self.temperature.len() > 0 {
            queue.upload(&self.temperature, &state.temperature)?;
        }
        queue.upload(&self.wall_place, &unpaired(&state.wall_position))
    }
}

/// Bytes of the halves and fields, per particle.
pub(super) fn bytes_each(plan: &Plan) -> usize {
    let quad = size_of::<Quad>();
    let (moments, gear) = (usize::from(plan.law.moments), plan.integrator == Integrator::Gear);
    let kicks = if plan.ledger && !gear { 1 + moments } else { 0 };
    let quads = 2 * (2 + moments) + if gear { 3 } else { 0 } + usize::from(plan.ledger) + kicks;
    let words = 2 + if plan.domain.period().any() { 3 } else { 0 };
    quads * quad + words * size_of::<u32>()
}

/// Vectors with nothing in the fourth place.
pub(super) fn unpaired(vectors: &[[f64; 3]]) -> Vec<Quad> {
    vectors.iter().map(|&v| Quad::new(v, 0.0)).collect()
}

/// A word of a particle: its material, above 16 bits its constraint, and the highest bit if that keeps it where it is.
fn kind(plan: &Plan, material: u16, constraint: u16) -> u32 {
    u32::from(material) | u32::from(constraint) << 16 | u32::from(plan.holds(constraint.into())) << 31
}

/// The constraint in such a word.
pub(super) fn constraint_of(kind: u32) -> u16 {
    (kind >> 16) as u16 & 0x7fff
}

/// Whether the particle of such a word stays where it is.
pub(super) fn is_held(kind: u32) -> bool {
    kind >> 31 != 0
}

impl<M> Fields<M> {
    pub(super) fn new<R: Runtime<Memory = M>>(queue: &Queue<R>, state: &State, plan: &Plan) -> Result<Self, Error> {
        let n = state.len();
        let gear = plan.integrator == Integrator::Gear;
        let kinds: Vec<u32> = state.material.iter().zip(&state.constraint).map(|(&m, &c)| kind(plan, m, c)).collect();
        let quads = |wanted: bool, given: bool, value: &dyn Fn(usize) -> [f64; 4]| -> Vec<Quad> {
            match (wanted, given) {
                (false, _) => Vec::new(),
                (true, false) => vec![Quad::default(); n],
                (true, true) => (0..n).map(|i| Quad(value(i))).collect(),
            }
        };
        let derivatives = |k: usize| {
            quads(gear, !state.derivatives.is_empty(), &|i| state.derivatives[i].map(|derivative| derivative[k]))
        };
        let accounts = quads(plan.ledger, !state.accounts.is_empty(), &|i| state.accounts[i]);
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
            derivatives: [
                queue.buffer_of(&derivatives(0))?,
                queue.buffer_of(&derivatives(1))?,
                queue.buffer_of(&derivatives(2))?,
            ],
            accounts: queue.buffer_of(&accounts)?,
            kick_by_half: queue.zeros(kicks)?,
            twist_by_half: queue.zeros(if plan.law.moments { kicks } else { 0 })?,
        })
    }
}

impl<M> Constants<M> {
    /// The pieces of courses that are known already stay where they are.
    pub(super) fn new<R: Runtime<Memory = M>>(
        queue: &Queue<R>,
        plan: &Plan,
        mut pieces: Vec<Piece>,
    ) -> Result<Self, Error> {
        let pairs: Vec<Pair> = plan.interactions.iter().map(Pair::from).collect();
        let temperature = |wall: usize| plan.heat.as_ref().and_then(|heat| heat.walls[wall].as_ref());
        let walls = plan.walls.iter().enumerate().map(|(index, wall)| {
            let [first_piece, end_piece] = course_record(temperature(index), &mut pieces);
            Wall {
                normal: Vector(wall.normal),
                velocity: Vector(wall.velocity),
                material: wall.material.into(),
                first_piece,
                end_piece,
                padding: 0,
            }
        });
        let walls: Vec<Wall> = walls.collect();
        let constraints: Vec<Constraint> =
            (0..plan.constraints.len()).map(|index| constraint_record(plan, index, &mut pieces)).collect();
        Ok(Constants {
            interactions: queue.buffer_of(&pairs)?,
            constraints: queue.buffer_of(&constraints)?,
            pieces: queue.buffer_of(&pieces)?,
            walls: queue.buffer_of(&walls)?,
        })
    }
}

/// A constraint of the plan; the pieces of its ramps are added to those of others.
fn constraint_record(plan: &Plan, index: usize, pieces: &mut Vec<Piece>) -> Constraint {
    let constraint = &plan.constraints[index];
    let given = [constraint.velocity, constraint.angular_velocity];
    let held = given.iter().flatten().enumerate();
    let first_piece = pieces.len() as u32;
    for ramp in plan.ramps.iter().filter(|ramp| usize::from(ramp.constraint) == index) {
        let vector = match ramp.drives {
            Driven::Velocity => 0,
            Driven::AngularVelocity => 1,
            Driven::Force => 2,
        };
        pieces.extend(ramp.pieces().map(|piece| piece_record(&piece, 3 * vector + ramp.axis as u32)));
    }
    Constraint {
        velocity: Vector(given[0].map(Option::unwrap_or_default)),
        angular_velocity: Vector(given[1].map(Option::unwrap_or_default)),
        force: Vector(constraint.force),
        components: held.fold(0, |bits, (k, value)| bits | u32::from(value.is_some()) << k),
        first_piece,
        end_piece: pieces.len() as u32,
        padding: 0,
    }
}

fn piece_record(piece: &plan::Piece, number: u32) -> Piece {
    Piece {
        from: piece.from,
        until: piece.until,
        start: piece.start[0],
        start_value: piece.start[1],
        end: piece.end[0],
        end_value: piece.end[1],
        number,
        padding: 0,
    }
}

/// Adds the pieces of a course to those of others: the first, and the end; none of no course.
pub(super) fn course_record(course: Option<&Course>, pieces: &mut Vec<Piece>) -> [u32; 2] {
    let first = pieces.len() as u32;
    pieces.extend(course.into_iter().flat_map(Course::pieces).map(|piece| piece_record(&piece, 0)));
    [first, pieces.len() as u32]
}

/// Adds the pieces of a table over temperature to those of others: the first, and the end.
pub(super) fn table_record(table: &Table, pieces: &mut Vec<Piece>) -> [u32; 2] {
    let first = pieces.len() as u32;
    pieces.extend(table.pieces().map(|piece| piece_record(&piece, 0)));
    [first, pieces.len() as u32]
}

impl Step {
    /// Tells it that so many steps are done when the present one is.
    pub(super) fn set_clock(&mut self, plan: &Plan, steps: u64) {
        self.former_time = plan.time(steps.saturating_sub(1));
        self.time = plan.time(steps);
        self.middle_time = plan.middle(steps);
        self.next_time = plan.time(steps + 1);
        self.heat_time = plan.heat_time(steps);
        self.heat_middle_time = plan.heat_middle(steps);
        self.next_heat_time = plan.heat_time(steps + 1);
    }
}

/// What the kernels of a step are told.
pub(super) fn step_record(plan: &Plan, state: &State) -> Step {
    let particles = state.len();
    let half_skin = 0.5 * plan.search.skin;
    let period = plan.domain.period();
    let ticks = Ticks::of(plan);
    let conductor = plan.heat.as_ref().and_then(|heat| only_of_pairs(plan, state, |a, b| heat.conductor(a, b)));
    // Bounds of directions that repeat are not a limit: a centre is brought back in before it is looked at.
    let mut step = Step {
        dt: plan.dt,
        half_dt: 0.5 * plan.dt,
        history_dt: plan.dt,
        lead: plan.lead(),
        former_time: 0.0,
        time: 0.0,
        middle_time: 0.0,
        next_time: 0.0,
        half_skin_squared: if plan.search.every_step { f64::INFINITY } else { half_skin * half_skin },
        ticks_per_metre: ticks.per_metre,
        noted_way_squared: if plan.ledger { half_skin * half_skin } else { f64::INFINITY },
        overlap_limit: plan.overlap_limit,
        gravity: Vector(plan.gravity),
        domain_min: Vector(plan.domain.min),
        domain_max: Vector(plan.domain.max),
        period: Box3::from(&period),
        pair: only_of_pairs(plan, state, |a, b| plan.interaction(a, b)).map(Pair::from).unwrap_or_default(),
        bond: Beam::default(),
        local_damping: plan.bonds.as_ref().map_or(0.0, |bonds| bonds.local_damping),
        heat_dt: plan.heat_step(),
        heat_time: 0.0,
        heat_middle_time: 0.0,
        next_heat_time: 0.0,
        reference_temperature: plan.heat.as_ref().map_or(0.0, |heat| heat.reference_temperature),
        conductor: conductor.map(ConductorOf::from).unwrap_or_default(),
        link: LinkOf::default(),
        dissipation: plan.heat.as_ref().map(|heat| (&heat.dissipation).into()).unwrap_or_default(),
        particles: particles as u32,
        walls: plan.walls.len() as u32,
        items: particles.max(plan.walls.len()) as u32,
        materials: plan.materials as u32,
        parity: 0,
        frozen: 0,
        corrects: 0,
        ticks_allowed: ticks.allowed,
        bond_slots: 0,
        number: 0,
        bonds: 0,
        padding: 0,
    };
    step.set_clock(plan, state.step);
    step
}

/// How ways are measured that decide when a list is due, see `kernels/particle.cl`.
struct Ticks {
    per_metre: f64,
    /// Squared ticks.
    allowed: u32,
}

impl Ticks {
    /// Ticks of a skin: a way of 2,048 skins within one step would be taken for none.
    const OF_SKIN: f64 = 512.0;
    /// Up to how many ticks a way may be longer than it seems: each coordinate is cut off at both ends, and a period is
    /// not a whole number of ticks.
    const UNSEEN: f64 = 4.0;

    fn of(plan: &Plan) -> Self {
        let per_metre = Self::OF_SKIN / plan.search.skin;
        let farthest = plan.domain.length().into_iter().fold(0.0, f64::max) * per_metre;
        if plan.search.every_step {
            // No way has any length.
            Ticks { per_metre: 0.0, allowed: 1 }
        } else if farthest < 1e15 {
            let half = 0.5 * Self::OF_SKIN - Self::UNSEEN;
            Ticks { per_metre, allowed: (half * half) as u32 }
        } else {
            // No skin, or hardly any: the list is always due.
            Ticks { per_metre: 0.0, allowed: 0 }
        }
    }
}
