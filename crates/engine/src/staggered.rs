//! Heat that advances by itself: a back end whose step is one of the heat, alone or in turns with the motion.
//!
//! What conducts is found on the processor, in the order of ids; temperatures lie on the device, and heat flows there.
//! Where particles move, they do so on a back end of the device, which is opened from the state for every turn.

mod relaxation;

pub(crate) use relaxation::without_heat;

use crate::network::{Field, Network, Processor, Span, Stuck, Surroundings};
use crate::step::Backend;
use crate::{Capture, Device, Fault, HeatPlan, Motion, Plan, Profile, Scheme, State, cpu, gpu};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::Arc;
use std::time::Instant;

/// What heat and motion took so far, since a simulation was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turns {
    /// Passes over the network: parts of explicit steps, or iterations of implicit ones.
    pub passes: u64,
    /// Steps of the motion.
    pub motion_steps: u64,
    /// Steps of the heat behind which particles were not at rest when heat went on.
    pub unrelaxed: u64,
    /// The last of these; 0 without any.
    pub last_unrelaxed: u64,
    /// The largest ratio of forces behind these; 0 without any.
    pub largest_ratio: f64,
}

/// A run in which heat advances by itself.
pub(crate) struct Staggered {
    device: Device,
    plan: Arc<Plan>,
    pool: Arc<ThreadPool>,
    /// Of the end of the last step, without what `field` holds; where particles move, with the temperatures they move under.
    state: State,
    /// Temperatures and heat accounts, and heat rates: those with which the step that follows begins; in the implicit scheme
    /// those of the present moment.
    field: Box<dyn Field>,
    /// Parts of the explicit step that follows.
    parts: u64,
    turns: Turns,
    searches: u64,
    /// By how much a radius shrank at most in this step of the heat, m.
    shrunk: f64,
    /// Bytes that the motion held in its last turn.
    motion_bytes: usize,
}

impl Staggered {
    /// Takes up a validated state, prepares it if it is fresh, and finds its heat rates.
    pub(crate) fn open(device: Device, state: State, plan: &Plan) -> Result<Self, Fault> {
        let options = match device {
            Device::Cpu(options) => options,
            Device::Gpu { .. } => cpu::Options::default(),
        };
        let threads = options.threads.unwrap_or(0);
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|_| Fault::Threads { threads })?;
        let pool = Arc::new(pool);
        let fresh = !state.forces_known;
        let mut motion = device.open(state, &without_heat(plan))?;
        if fresh {
            motion.prepare()?;
        }
        let (mut state, searches) = (relaxation::at_rest(motion.capture()?.state()?), motion.searches());
        // The device may have no room for both.
        drop(motion);
        let mut field = open_field(device, &state, plan, &pool)?;
        field.take_up(&state.temperature, std::mem::take(&mut state.heat_accounts))?;
        if matches!(plan.heat.as_ref().map(|heat| heat.motion), Some(Motion::Frozen(_))) {
            state.temperature = Vec::new();
        }
        let mut staggered = Staggered {
            device,
            plan: Arc::new(plan.clone()),
            pool,
            state,
            field,
            parts: 1,
            turns: Turns::default(),
            searches,
            shrunk: 0.0,
            motion_bytes: 0,
        };
        staggered.link()?;
        Ok(staggered)
    }

    /// Finds what conducts in the present state, and its heat rates.
    fn link(&mut self) -> Result<(), Fault> {
        let pool = Arc::clone(&self.pool);
        pool.install(|| {
            if let Some(heat) = &self.plan.heat {
                self.field.link(Network::of(&self.state, &self.plan, heat))?;
            }
            self.rate()
        })
    }

    /// Finds the heat rates that belong to the present moment: in the explicit scheme those with which the step that follows
    /// begins, and the number of its parts.
    fn rate(&mut self) -> Result<(), Fault> {
        let plan = Arc::clone(&self.plan);
        let Some((heat, scheme)) = advancing(&plan) else { return Ok(()) };
        let now = Span { from: self.span().from, until: self.span().from };
        if !heat.tables.is_empty() {
            self.field.surround(Surroundings::during(now, scheme, heat))?;
            self.field.temper()?;
        }
        let span = match scheme {
            Scheme::Explicit => {
                let span = self.span();
                self.field.surround(Surroundings::during(span, scheme, heat))?;
                let longest = self.field.longest_step()?;
                self.parts = ((span.until - span.from) / longest).ceil().max(1.0) as u64;
                span.part(0, self.parts)
            }
            Scheme::Implicit => now,
        };
        self.field.surround(Surroundings::during(span, scheme, heat))?;
        self.field.rate()
    }

    /// The time of the step that follows.
    fn span(&self) -> Span {
        Span { from: self.plan.heat_time(self.state.step), until: self.plan.heat_time(self.state.step + 1) }
    }

    /// One step of the heat, while nothing moves.
    fn heat(&mut self) -> Result<(), Fault> {
        let plan = Arc::clone(&self.plan);
        let Some((heat, scheme)) = advancing(&plan) else { return Ok(()) };
        let (span, parts) = (self.span(), self.parts);
        match scheme {
            Scheme::Explicit => {
                let step = if parts == 1 { plan.heat_step() } else { plan.heat_step() / parts as f64 };
                for part in 0..parts {
                    if part > 0 {
                        self.field.surround(Surroundings::during(span.part(part, parts), scheme, heat))?;
                        self.field.temper()?;
                        self.field.rate()?;
                    }
                    self.field.warm(step)?;
                }
                self.turns.passes += parts;
            }
            Scheme::Implicit => {
                self.field.surround(Surroundings::during(span, scheme, heat))?;
                let iterations = self.field.solve(plan.heat_step())?.map_err(|stuck| self.stuck(&stuck))?;
                self.turns.passes += iterations;
                self.field.warm(plan.heat_step())?;
            }
        }
        let Some((index, temperature)) = self.field.astray()? else { return Ok(()) };
        let step = self.state.step + 1;
        Err(Fault::Temperature { step, time: plan.time(step), particle: self.state.id[index], temperature })
    }

    fn stuck(&self, stuck: &Stuck) -> Fault {
        let step = self.state.step + 1;
        Fault::Conduction { step, time: self.plan.time(step), iterations: stuck.iterations, error: stuck.error }
    }

    /// One step of the simulation.
    fn step(&mut self) -> Result<(), Fault> {
        let pool = Arc::clone(&self.pool);
        pool.install(|| {
            let before = self.elastic_energy();
            self.heat()?;
            self.expand(before)
        })?;
        if self.relax()? {
            self.state.step += 1;
            self.link()
        } else {
            self.state.step += 1;
            pool.install(|| self.rate())
        }
    }
}

/// Where the temperatures of a run lie: with its device, but on the processor where properties depend on temperature.
fn open_field(device: Device, state: &State, plan: &Plan, pool: &Arc<ThreadPool>) -> Result<Box<dyn Field>, Fault> {
    let heat = plan.heat.as_ref().ok_or(Fault::Inconsistent { what: "heat that advances by itself is in the plan" })?;
    match device {
        Device::Gpu { api, index } if heat.tables.is_empty() => gpu::open_field(api, index, state, plan, heat),
        Device::Cpu(_) | Device::Gpu { .. } => Ok(Box::new(Processor::new(pool, plan, heat, state))),
    }
}

/// The heat of a plan, and how it advances by itself.
fn advancing(plan: &Plan) -> Option<(&HeatPlan, Scheme)> {
    let heat = plan.heat.as_ref()?;
    Some((heat, heat.motion.scheme()?))
}

impl Backend for Staggered {
    fn advance(&mut self, steps: u64) -> Result<(), Fault> {
        (0..steps).try_for_each(|_| self.step())
    }
    fn prepare(&mut self) -> Result<(), Fault> {
        // A fresh state was prepared when it was taken up.
        Ok(())
    }
    fn capture(&mut self) -> Result<Capture, Fault> {
        let mut state = self.state.clone();
        self.field.put(&mut state)?;
        Ok(state.into())
    }
    fn bytes(&self) -> usize {
        self.state.bytes() + self.field.bytes() + self.motion_bytes
    }
    fn profile(&mut self, steps: u64) -> Result<Profile, Fault> {
        let (start, searches) = (Instant::now(), self.searches);
        self.advance(steps)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(Profile { steps, searches: self.searches - searches, seconds, ..Profile::empty() })
    }
    fn copy_bandwidth(&self) -> Result<f64, Fault> {
        self.field.copy_bandwidth()
    }
    fn searches(&self) -> u64 {
        self.searches
    }
    fn turns(&self) -> Option<Turns> {
        Some(self.turns)
    }
}
