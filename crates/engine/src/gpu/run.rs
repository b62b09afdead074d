//! A run on a device: steps are launched ahead, the device stops by itself when it needs a new list or meets a fault.
//!
//! Every kernel reads the flags that the one before it left; while one is up, nothing is computed. The host launches
//! batches of steps, looks at the status behind each, and only then lists anew or tells the fault.

use super::bodies::{Constants, Fields, Half, constraint_of, step_record, unpaired};
use super::bonds::Bonds;
use super::heat::Heat;
use super::layout::{Contact, Correct, EvaluateBonds, Fused, LinkOf, Predict, Step};
use super::memory::{Arriving, Buffer, Queue};
use super::program::Variant;
use super::runtime::{Error, Runtime};
use super::search::{Histories, Rows, Scratch};
use crate::cpu::second_derivative;
use crate::{Fault, Integrator, Plan, State};
use std::collections::VecDeque;
use tdem_physics::contact::Friction;

/// The words of the status, as in `kernels/particle.cl`.
const STATUS: usize = 4;
const DONE: usize = 2;
const FARTHEST_STEP: usize = 3;
const ASTRAY: u32 = 2;
const CRUSHED: u32 = 4;
const UNPHYSICAL: u32 = 8;

/// Steps launched before the status is looked at, at most: fewer where lists do not last as long, since what is launched
/// behind a halt does nothing. Two batches are under way, so that the device never waits.
const BATCH: u64 = 16;
const BATCHES: usize = 2;
/// Kernels of a step of which contact and motion are not one, besides that of bonds apart.
const KERNELS_APART: usize = 2;

/// A run on a device.
pub(crate) struct Gpu<R: Runtime> {
    pub(super) queue: Queue<R>,
    pub(super) plan: Plan,
    pub(super) step: u64,
    pub(super) particles: usize,
    /// Persistent ids by rank, `(N)`.
    pub(super) ids: Vec<u32>,
    /// Angular velocities by rank, in models that do not change them.
    pub(super) spins: Vec<[f64; 3]>,
    /// What touching pairs remember of particles.
    pub(super) friction: bool,
    pub(super) smallest: f64,
    pub(super) largest: f64,
    pub(super) halves: [Half<R::Memory>; 2],
    /// The half that holds the present.
    pub(super) now: usize,
    pub(super) fields: Fields<R::Memory>,
    pub(super) constants: Constants<R::Memory>,
    pub(super) rows: Rows<R::Memory>,
    pub(super) histories: Histories<R::Memory>,
    pub(super) scratch: Scratch<R::Memory>,
    pub(super) bonds: Bonds<R::Memory>,
    pub(super) heat: Heat<R::Memory>,
    status: Buffer<u32, R::Memory>,
    pub(super) step_record: Step,
    /// Whether a step is one kernel.
    pub(super) fused: bool,
    /// Steps of the next batch.
    batch: u64,
    pub(super) searches: u64,
    /// The longest way of a particle or wall in the last step, if it matters to the list, m.
    pub(super) step_way: f64,
}

impl<R: Runtime> Gpu<R> {
    /// Takes a validated state up.
    pub(crate) fn new(runtime: R, state: State, plan: &Plan) -> Result<Self, Fault> {
        let variant = Variant::of(plan, &state);
        let queue = Queue::new(runtime, variant)?;
        let n = state.len();
        let friction = plan.law.friction != Friction::Off;
        let fields = Fields::new(&queue, &state, plan)?;
        let mut pieces = Vec::new();
        let heat = Heat::of_state(&queue, &state, plan, &variant, &mut pieces)?;
        let speed_squared = state.velocity.iter().map(|v| v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).fold(0.0, f64::max);
        let mut gpu = Gpu {
            plan: plan.clone(),
            step: state.step,
            particles: n,
            friction,
            smallest: state.radius.iter().copied().fold(f64::INFINITY, f64::min),
            largest: state.radius.iter().copied().fold(0.0, f64::max),
            halves: [Half::new(&queue, &state, plan)?, Half::new(&queue, &state, plan)?],
            bonds: Bonds::of_state(&queue, &state, plan, &variant)?,
            now: 0,
            constants: Constants::new(&queue, plan, pieces)?,
            heat,
            rows: Rows::new(&queue, n, plan.walls.len())?,
            histories: Histories::of_state(&queue, &state, friction)?,
            scratch: Scratch::new(&queue, n)?,
            fields,
            status: queue.zeros(STATUS)?,
            step_record: step_record(plan, &state),
            fused: variant.fused(),
            batch: BATCH,
            searches: 0,
            step_way: if plan.ledger { speed_squared.sqrt() * plan.dt } else { 0.0 },
            queue,
            ids: Vec::new(),
            spins: Vec::new(),
        };
        gpu.step_record.bond_slots = gpu.bonds.slots;
        gpu.step_record.bonds = gpu.bonds.table.len() as u32;
        gpu.step_record.bond = gpu.bonds.only.unwrap_or_default();
        gpu.step_record.link = gpu.heat.only_link.as_ref().map(LinkOf::from).unwrap_or_default();
        gpu.halves[0].take_up(&gpu.queue, &state)?;
        if n > 0 {
            gpu.list_with(true)?;
            gpu.take_up_forces(&state)?;
        }
        gpu.ids = state.id;
        if !plan.law.moments {
            gpu.spins = state.angular_velocity;
        }
        Ok(gpu)
    }

    /// Forces, heat rates and moments of the state, into the half that is free between steps.
    fn take_up_forces(&mut self, state: &State) -> Result<(), Fault> {
        let rank = self.queue.read(&self.fields.rank, self.particles)?;
        let by_rank = |field: &[[f64; 3]]| -> Vec<[f64; 3]> { rank.iter().map(|&r| field[r as usize]).collect() };
        let free = &self.halves[1 - self.now];
        let mut forces = unpaired(&by_rank(&state.force));
        if self.plan.heat.is_some() {
            forces.iter_mut().zip(&rank).for_each(|(force, &rank)| force.0[3] = state.heat_rate[rank as usize]);
        }
        self.queue.upload(&free.place, &forces)?;
        if self.plan.law.moments {
            self.queue.upload(&free.spin, &unpaired(&by_rank(&state.moment)))?;
        }
        Ok(())
    }

    /// Advances a number of steps.
    pub(super) fn advance_all(&mut self, steps: u64) -> Result<(), Fault> {
        if steps == 0 || self.particles == 0 {
            self.step += steps;
            return Ok(());
        }
        if self.bonds.number(self.step + steps).is_none() {
            self.bonds.begin_records(&self.queue, self.step)?;
        }
        self.queue.clear(&self.status, STATUS)?;
        self.step_record.set_clock(&self.plan, self.step);
        self.launch_predict(false)?;
        let mut done = 0;
        if self.plan.search.every_step {
            while done < steps {
                // The status arrives while histories are put aside, which changes nothing that a fault is worked out from.
                let status = self.queue.fetch(&self.status, STATUS)?;
                let histories = self.carry_histories()?;
                let status = words(status.take()?);
                self.fault_in(status, done, steps)?;
                self.note_way(status);
                self.list_with(histories)?;
                self.launch_step(done + 1, done + 1 == steps)?;
                done += 1;
            }
            let status = self.status()?;
            self.fault_in(status, done, steps)?;
        } else {
            while done < steps {
                done = self.launch_until_halted(done, steps)?;
            }
        }
        self.step += steps;
        Ok(())
    }

    /// Launches steps until all are done or the device halts; lists anew if that is why. The number of steps done.
    fn launch_until_halted(&mut self, done: u64, steps: u64) -> Result<u64, Fault> {
        let start = self.now;
        let mut launched = done;
        let mut pending: VecDeque<Arriving<u32, R>> = VecDeque::new();
        loop {
            while launched < steps && pending.len() < BATCHES {
                for _ in 0..self.batch.min(steps - launched) {
                    launched += 1;
                    self.launch_step(launched, launched == steps)?;
                }
                pending.push_back(self.queue.fetch(&self.status, STATUS)?);
                self.queue.flush()?;
            }
            let Some(arriving) = pending.pop_front() else { return Ok(steps) };
            let status = words(arriving.take()?);
            if status[0] | status[1] != 0 {
                let reached = u64::from(status[DONE]);
                // What was launched beyond did nothing: the halves are as the last step that was done left them.
                let fused = if self.fused { reached - done - u64::from(reached == steps) } else { 0 };
                self.now = (start + fused as usize) % 2;
                self.fault_in(status, reached, steps)?;
                let kernels = KERNELS_APART + usize::from(self.bonds.are_apart());
                self.queue.forget_launches(kernels * (launched - reached) as usize);
                self.batch = (reached - done).clamp(1, BATCH);
                self.note_way(status);
                let histories = self.carry_histories()?;
                self.list_with(histories)?;
                self.queue.upload(&self.status, &[0, 0, reached as u32, 0])?;
                return Ok(reached);
            }
            self.batch = (2 * self.batch).min(BATCH);
        }
    }

    fn status(&self) -> Result<[u32; STATUS], Error> {
        Ok(words(self.queue.read(&self.status, STATUS)?))
    }

    /// The longest way in one step, if any was long enough to matter.
    fn note_way(&mut self, status: [u32; STATUS]) {
        self.step_way = f64::from(f32::from_bits(status[FARTHEST_STEP])).sqrt();
    }

    /// The next launch reads the flags that the last one raised.
    fn next_step(&mut self) -> Step {
        self.step_record.parity = 1 - self.step_record.parity;
        self.step_record
    }

    /// Predicts the next step; the end of the step before may be part of it.
    fn launch_predict(&mut self, corrects: bool) -> Result<(), Error> {
        let step = Step { corrects: corrects.into(), ..self.next_step() };
        let (half, free, fields) = (&self.halves[self.now], &self.halves[1 - self.now], &self.fields);
        let [derivatives_x, derivatives_y, derivatives_z] = &fields.derivatives;
        self.queue.run(
            &Predict {
                step,
                status: &self.status,
                place: &half.place,
                motion: &half.motion,
                spin: &half.spin,
                force: &free.place,
                moment: &free.spin,
                derivatives_x,
                derivatives_y,
                derivatives_z,
                image: &fields.image,
                kind: &fields.kind,
                constraints: &self.constants.constraints,
                pieces: &self.constants.pieces,
                reference: &self.rows.reference,
                walls: &self.constants.walls,
                wall_place: &half.wall_place,
                wall_reference: &self.rows.wall_reference,
                kick_by_half: &fields.kick_by_half,
                twist_by_half: &fields.twist_by_half,
                orientation: &half.orientation,
                temperature: &half.temperature,
                reference_radius: &self.heat.reference_radius,
                listed_radius: &self.heat.listed_radius,
                thermals: &self.heat.thermals,
                exposure: &self.heat.exposure,
                exposures: &self.heat.exposures,
                specific_heats: &self.heat.specific_heats,
                heat_accounts: &self.heat.accounts,
                work_per_kelvin: &self.heat.work_per_kelvin,
                warming: &self.heat.warming,
            },
            step.items as usize,
        )
    }

    /// From one prediction to the next, or to the end of the last step: the `count`-th of a call.
    fn launch_step(&mut self, count: u64, last: bool) -> Result<(), Error> {
        self.step_record.number = self.bonds.number(self.step + count).unwrap_or(0);
        self.step_record.set_clock(&self.plan, self.step + count);
        self.launch_bonds()?;
        if self.fused && !last {
            return self.launch_fused();
        }
        self.launch_contact()?;
        if last { self.launch_correct() } else { self.launch_predict(true) }
    }

    /// Evaluates bonds that are evaluated apart.
    fn launch_bonds(&mut self) -> Result<(), Error> {
        if !self.bonds.are_apart() {
            return Ok(());
        }
        self.next_step();
        self.queue.run(&self.bonds_call(), self.bonds.table.len())
    }

    pub(super) fn bonds_call(&self) -> EvaluateBonds<'_, R::Memory> {
        let (half, fields, bonds) = (&self.halves[self.now], &self.fields, &self.bonds);
        EvaluateBonds {
            step: self.step_record,
            status: &self.status,
            place: &half.place,
            motion: &half.motion,
            spin: &half.spin,
            orientation: &half.orientation,
            bonded_place: &bonds.place,
            kind: &fields.kind,
            interactions: &self.constants.interactions,
            joints: &bonds.joints,
            beams: &bonds.beams,
            slice: &self.rows.slice,
            other: &self.rows.other,
            bond_other: &bonds.other,
            bond_ends: &bonds.apart.ends,
            exposure: &self.heat.exposure,
            exposures: &self.heat.exposures,
            bond_length: &bonds.apart.length,
            bond_strength: &bonds.strength,
            bond_history: &bonds.apart.history,
            reaction: &bonds.apart.reaction,
            bond_lost: &bonds.apart.lost,
            broken: &bonds.broken,
            released: &bonds.released,
            kick_by_half: &fields.kick_by_half,
            twist_by_half: &fields.twist_by_half,
            temperature: &half.temperature,
            reference_radius: &self.heat.reference_radius,
            thermals: &self.heat.thermals,
            conductors: &self.heat.conductors,
            links: &self.heat.links,
            bond_flow: &bonds.apart.flow,
            bond_work: &bonds.apart.work,
            pieces: &self.constants.pieces,
            conductivities: &self.heat.conductivities,
            factors: &self.heat.factors,
        }
    }

    fn launch_contact(&mut self) -> Result<(), Error> {
        let step = self.next_step();
        let (half, free, fields) = (&self.halves[self.now], &self.halves[1 - self.now], &self.fields);
        self.queue.run(
            &Contact {
                step,
                status: &self.status,
                place: &half.place,
                motion: &half.motion,
                spin: &half.spin,
                force: &free.place,
                moment: &free.spin,
                kind: &fields.kind,
                rank: &fields.rank,
                interactions: &self.constants.interactions,
                constraints: &self.constants.constraints,
                pieces: &self.constants.pieces,
                slice: &self.rows.slice,
                other: &self.rows.other,
                displacement: &self.rows.displacement,
                walls: &self.constants.walls,
                wall_place: &half.wall_place,
                kick_by_half: &fields.kick_by_half,
                twist_by_half: &fields.twist_by_half,
                accounts: &fields.accounts,
                orientation: &half.orientation,
                bonded_place: &self.bonds.place,
                joints: &self.bonds.joints,
                beams: &self.bonds.beams,
                bond_other: &self.bonds.other,
                bond_start: &self.bonds.start,
                bond_strength: &self.bonds.strength,
                broken: &self.bonds.broken,
                released: &self.bonds.released,
                bond_number: &self.bonds.apart.number,
                reaction: &self.bonds.apart.reaction,
                bond_lost: &self.bonds.apart.lost,
                bond_flow: &self.bonds.apart.flow,
                bond_work: &self.bonds.apart.work,
                temperature: &half.temperature,
                reference_radius: &self.heat.reference_radius,
                thermals: &self.heat.thermals,
                conductors: &self.heat.conductors,
                links: &self.heat.links,
                exposure: &self.heat.exposure,
                exposures: &self.heat.exposures,
                exchanges: &self.heat.exchanges,
                conductivities: &self.heat.conductivities,
                factors: &self.heat.factors,
                heat_accounts: &self.heat.accounts,
                work_per_kelvin: &self.heat.work_per_kelvin,
                warming: &self.heat.warming,
            },
            self.particles,
        )
    }

    fn launch_correct(&mut self) -> Result<(), Error> {
        let step = self.next_step();
        let (half, free, fields) = (&self.halves[self.now], &self.halves[1 - self.now], &self.fields);
        let [derivatives_x, derivatives_y, derivatives_z] = &fields.derivatives;
        self.queue.run(
            &Correct {
                step,
                status: &self.status,
                place: &half.place,
                motion: &half.motion,
                spin: &half.spin,
                force: &free.place,
                moment: &free.spin,
                derivatives_x,
                derivatives_y,
                derivatives_z,
                kind: &fields.kind,
                constraints: &self.constants.constraints,
                pieces: &self.constants.pieces,
            },
            self.particles,
        )
    }

    fn launch_fused(&mut self) -> Result<(), Error> {
        let items = self.next_step().items as usize;
        self.queue.run(&self.fused_call(), items)?;
        self.now = 1 - self.now;
        Ok(())
    }

    /// From the present prediction to the next.
    pub(super) fn fused_call(&self) -> Fused<'_, R::Memory> {
        let (half, next, fields) = (&self.halves[self.now], &self.halves[1 - self.now], &self.fields);
        Fused {
            step: self.step_record,
            status: &self.status,
            place: &half.place,
            motion: &half.motion,
            spin: &half.spin,
            next_place: &next.place,
            next_motion: &next.motion,
            next_spin: &next.spin,
            image: &fields.image,
            kind: &fields.kind,
            interactions: &self.constants.interactions,
            constraints: &self.constants.constraints,
            pieces: &self.constants.pieces,
            reference: &self.rows.reference,
            slice: &self.rows.slice,
            other: &self.rows.other,
            displacement: &self.rows.displacement,
            walls: &self.constants.walls,
            wall_place: &half.wall_place,
            next_wall_place: &next.wall_place,
            wall_reference: &self.rows.wall_reference,
            rank: &fields.rank,
            orientation: &half.orientation,
            next_orientation: &next.orientation,
            bonded_place: &self.bonds.place,
            joints: &self.bonds.joints,
            beams: &self.bonds.beams,
            bond_other: &self.bonds.other,
            bond_start: &self.bonds.start,
            bond_strength: &self.bonds.strength,
            broken: &self.bonds.broken,
            released: &self.bonds.released,
            bond_number: &self.bonds.apart.number,
            reaction: &self.bonds.apart.reaction,
            bond_flow: &self.bonds.apart.flow,
            temperature: &half.temperature,
            next_temperature: &next.temperature,
            reference_radius: &self.heat.reference_radius,
            listed_radius: &self.heat.listed_radius,
            thermals: &self.heat.thermals,
            conductors: &self.heat.conductors,
            links: &self.heat.links,
            exposure: &self.heat.exposure,
            exposures: &self.heat.exposures,
            exchanges: &self.heat.exchanges,
            conductivities: &self.heat.conductivities,
            specific_heats: &self.heat.specific_heats,
            factors: &self.heat.factors,
        }
    }

    /// Forces for a fresh state: nothing moves, no history advances.
    pub(super) fn prepare_all(&mut self) -> Result<(), Fault> {
        if self.particles == 0 {
            return Ok(());
        }
        self.queue.clear(&self.status, STATUS)?;
        self.step_record.set_clock(&self.plan, self.step);
        let record = self.step_record;
        self.step_record = Step { history_dt: 0.0, lead: 0.0, frozen: 1, ..record };
        self.launch_bonds()?;
        self.launch_contact()?;
        self.step_record = record;
        let status = self.status()?;
        self.step_record.parity = 0;
        self.fault_in(status, 0, 0)?;
        if self.plan.integrator == Integrator::Gear {
            self.start_derivatives()?;
        }
        Ok(())
    }

    /// Gear's second derivative from the forces of a fresh state, none of prescribed components; the higher ones are what the
    /// state says.
    fn start_derivatives(&mut self) -> Result<(), Error> {
        let n = self.particles;
        let force = self.queue.read(&self.halves[1 - self.now].place, n)?;
        let motion = self.queue.read(&self.halves[self.now].motion, n)?;
        let kind = self.queue.read(&self.fields.kind, n)?;
        let constraint = |kind: u32| &self.plan.constraints[usize::from(constraint_of(kind))];
        let second = force.iter().zip(&motion).zip(&kind);
        let second =
            second.map(|((force, motion), &kind)| second_derivative(force, motion, constraint(kind), self.plan.dt));
        let second: Vec<[f64; 3]> = second.collect();
        for (k, derivatives) in self.fields.derivatives.iter().enumerate() {
            let mut of_coordinate = self.queue.read(derivatives, n)?;
            for (derivatives, second) in of_coordinate.iter_mut().zip(&second) {
                derivatives.0[0] = second[k];
            }
            self.queue.upload(derivatives, &of_coordinate)?;
        }
        Ok(())
    }

    /// The fault that the flags tell of, after so many of the steps of a call.
    fn fault_in(&self, status: [u32; STATUS], done: u64, steps: u64) -> Result<(), Fault> {
        let flags = status[0] | status[1];
        if flags & CRUSHED != 0 {
            // A step that is one kernel has gone on to the next prediction; what it read is in the other half.
            let half = if self.fused && done < steps { 1 - self.now } else { self.now };
            Err(self.crushed(half, done)?)
        } else if flags & ASTRAY != 0 {
            Err(self.astray(done)?)
        } else if flags & UNPHYSICAL != 0 {
            Err(self.unphysical(done)?)
        } else {
            Ok(())
        }
    }
}

fn words(values: Vec<u32>) -> [u32; STATUS] {
    values.try_into().expect("a status has its words")
}
