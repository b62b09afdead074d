//! The CPU back end: the stages of a step, one file each.
//!
//! Particles stand in the order of a space-filling curve and are renumbered now and then; a particle's persistent
//! `rank` (its place in the order of ids) decides every order that could change a bit.

mod arithmetic;
mod bodies;
mod bond;
mod bonds;
mod boundary;
mod contact;
mod correct;
mod gather;
mod grid;
mod heat;
mod neighbours;
mod pieces;
mod predict;
mod profile;
mod search;
mod snapshot;
mod wide;

use crate::step::{Backend, Stages, step};
use crate::{Capture, Fault, Plan, Profile, State};
pub(crate) use arithmetic::rate as arithmetic_rate;
pub(crate) use bodies::{Quad, second_derivative};
pub(crate) use grid::{Division, budget, class_of};
pub(crate) use neighbours::indices_by_rank;
pub(crate) use pieces::split;
pub(crate) use predict::optional;
pub(crate) use profile::copy_bandwidth;
pub(crate) use wide::{Eight, Loop, run_portable, run_widest};

use bodies::Bodies;
use bonds::Bonds;
use neighbours::Neighbours;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::Arc;

/// How the CPU works. None of these changes a bit of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Threads; `None` takes all cores.
    pub threads: Option<usize>,
    /// Contacts and bonds at a time.
    pub width: Width,
    /// Each contact once, or from both sides; bonds are always evaluated once.
    pub list: List,
    /// Width of a search cell relative to the reach of a contact, at least 1.
    pub cell_factor: f64,
}

/// How many contacts and bonds are evaluated at a time, and with which instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// One by one. The plain reference.
    One,
    /// Eight, with the instructions of any machine of this kind.
    Portable,
    /// Eight, with the widest instructions that this machine has.
    Widest,
}

impl Width {
    /// All of them.
    pub const ALL: [Width; 3] = [Width::One, Width::Portable, Width::Widest];
}

/// Whether a pair is listed once or twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum List {
    /// Once, by the particle of the lower id; the other particle gathers it.
    Half,
    /// By both particles: more work, nothing to gather. The plain reference.
    Full,
}

impl Default for Options {
    fn default() -> Self {
        Options { threads: None, width: Width::Widest, list: List::Half, cell_factor: 1.0 }
    }
}

/// How many bytes a run of default options will hold, all arrays together but for those of walls, with so many pairs in
/// its list and so many bonds; [`crate::Simulation::bytes`] tells it of a run that is there.
#[must_use]
pub fn bytes(plan: &Plan, particles: usize, pairs: usize, bonds: usize) -> usize {
    let [row, pair] = Neighbours::bytes_each(plan);
    let [bonded, bond] = Bonds::bytes_each(plan);
    particles * (size_of::<u32>() + Bodies::bytes_each(plan) + row + bonded) + pairs * pair + bonds * bond
}

/// Particles per task of a parallel loop. Results do not depend on it.
pub(crate) const CHUNK: usize = 512;

/// A run on the CPU.
pub(crate) struct Cpu {
    plan: Plan,
    options: Options,
    pool: Arc<ThreadPool>,
    step: u64,
    /// Persistent ids by rank, `(N)`.
    ids: Vec<u32>,
    bodies: Bodies,
    neighbours: Neighbours,
    bonds: Bonds,
    flows: heat::Flows,
    wall_position: Vec<[f64; 3]>,
    /// Whether something moved too far for the present list.
    search_due: bool,
    searches: u64,
    /// The longest way of a particle or wall in one step, m.
    step_way: f64,
    /// $\Delta t$ as forces see it: 0 while a fresh state is prepared.
    history_step: f64,
}

impl Cpu {
    pub(crate) fn new(state: State, plan: &Plan, options: &Options) -> Result<Self, Fault> {
        let threads = options.threads.unwrap_or(0);
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|_| Fault::Threads { threads })?;
        let mut cpu = Cpu {
            plan: plan.clone(),
            options: *options,
            pool: Arc::new(pool),
            step: state.step,
            ids: Vec::new(),
            bodies: Bodies::default(),
            neighbours: Neighbours::default(),
            bonds: Bonds::default(),
            flows: heat::Flows::default(),
            wall_position: Vec::new(),
            search_due: true,
            searches: 0,
            step_way: 0.0,
            history_step: plan.dt,
        };
        cpu.take_up(state)?;
        Ok(cpu)
    }
    /// Time by which positions are ahead of velocities while forces are computed, s: none while a fresh state is prepared.
    fn lead(&self) -> f64 {
        if self.history_step > 0.0 { self.plan.lead() } else { 0.0 }
    }
    /// Time of the step that is being computed, s.
    fn time(&self) -> f64 {
        self.plan.time(self.step)
    }
}

impl Stages for Cpu {
    fn predict(&mut self) -> Result<(), Fault> {
        self.step += 1;
        self.predict_all()
    }
    fn search(&mut self) -> Result<(), Fault> {
        if self.search_due || self.plan.search.every_step { self.list_anew() } else { Ok(()) }
    }
    fn bond(&mut self) {
        self.bond_all();
    }
    fn contact(&mut self) -> Result<(), Fault> {
        self.contact_all()
    }
    fn gather(&mut self) -> Result<(), Fault> {
        self.gather_all()
    }
    fn boundary(&mut self) {
        self.boundary_all();
        self.conduct_all();
    }
    fn correct(&mut self) {
        self.correct_all();
    }
}

impl Backend for Cpu {
    fn advance(&mut self, steps: u64) -> Result<(), Fault> {
        let pool = Arc::clone(&self.pool);
        pool.install(|| (0..steps).try_for_each(|_| step(self)))
    }
    fn prepare(&mut self) -> Result<(), Fault> {
        let pool = Arc::clone(&self.pool);
        pool.install(|| {
            let kept = (
                self.neighbours.displacement.clone(),
                self.neighbours.wall_displacements(),
                self.bodies.accounts.clone(),
                self.bonds.written.history.clone(),
            );
            self.history_step = 0.0;
            self.bond_all();
            self.contact_all()?;
            self.gather_all()?;
            self.boundary_all();
            self.conduct_all();
            self.history_step = self.plan.dt;
            let (displacement, wall_displacement, accounts, bond_histories) = kept;
            self.bonds.written.history = bond_histories;
            self.neighbours.displacement = displacement;
            self.neighbours.restore_wall_displacements(&wall_displacement);
            self.bodies.accounts = accounts;
            self.bodies.start_derivatives(&self.plan);
            Ok(())
        })
    }
    fn capture(&mut self) -> Result<Capture, Fault> {
        Ok(self.pool.install(|| self.state()).into())
    }
    fn bytes(&self) -> usize {
        self.bodies.bytes()
            + self.bonds.bytes(&self.plan)
            + self.neighbours.bytes()
            + self.flows.bytes()
            + std::mem::size_of_val(&self.ids[..])
    }
    fn profile(&mut self, steps: u64) -> Result<Profile, Fault> {
        self.profile_all(steps)
    }
    fn copy_bandwidth(&self) -> Result<f64, Fault> {
        copy_bandwidth(&self.pool)
    }
    fn searches(&self) -> u64 {
        self.searches
    }
}
