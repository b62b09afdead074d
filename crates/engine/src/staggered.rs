//! Heat that advances by itself: a back end whose step is one of the heat, alone or in turns with the motion.
//!
//! The network of what conducts lies on the processor, in the order of ids, whatever the device; where particles move,
//! they do so on a back end of the device, which is opened from the state for every turn.

mod relaxation;

use crate::cpu::{self, CHUNK, optional};
use crate::heat::book;
use crate::network::{Network, Rates, Span, Stuck, Surroundings};
use crate::step::Backend;
use crate::{Capture, Device, Fault, HeatPlan, Motion, Plan, Profile, Scheme, State};
use rayon::prelude::*;
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
    /// Of the end of the last step; heat rates stand in `rates`.
    state: State,
    network: Network,
    /// With which the step that follows begins; in the implicit scheme those of the present moment.
    rates: Rates,
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
        let relaxes = plan.heat.as_ref().is_some_and(|heat| matches!(heat.motion, Motion::QuasiStatic(_)));
        let device = if relaxes { device } else { Device::Cpu(options) };
        let fresh = !state.forces_known;
        let mut motion = device.open(state, &relaxation::without_heat(plan))?;
        if fresh {
            motion.prepare()?;
        }
        let mut staggered = Staggered {
            device,
            plan: Arc::new(plan.clone()),
            pool: Arc::new(pool),
            state: relaxation::at_rest(motion.capture()?.state()?),
            network: Network::default(),
            rates: Rates::default(),
            parts: 1,
            turns: Turns::default(),
            searches: motion.searches(),
            shrunk: 0.0,
            motion_bytes: 0,
        };
        staggered.link();
        Ok(staggered)
    }

    /// Finds what conducts in the present state, and its heat rates.
    fn link(&mut self) {
        let pool = Arc::clone(&self.pool);
        pool.install(|| {
            if let Some(heat) = &self.plan.heat {
                self.network = Network::of(&self.state, &self.plan, heat);
            }
            self.rate();
        });
    }

    /// Finds the heat rates that belong to the present moment: in the explicit scheme those with which the step that follows
    /// begins, and the number of its parts.
    fn rate(&mut self) {
        let plan = Arc::clone(&self.plan);
        let Some((heat, scheme)) = advancing(&plan) else { return };
        let now = Span { from: self.span().from, until: self.span().from };
        if !heat.tables.is_empty() {
            self.network.temper(&self.state, &plan, heat, &Surroundings::during(now, scheme, heat));
        }
        let (temperature, exposure) = (&self.state.temperature, &self.state.exposure);
        let span = match scheme {
            Scheme::Explicit => {
                let span = self.span();
                let around = Surroundings::during(span, scheme, heat);
                let longest = self.network.longest_step(temperature, exposure, heat, &around);
                self.parts = ((span.until - span.from) / longest).ceil().max(1.0) as u64;
                span.part(0, self.parts)
            }
            Scheme::Implicit => now,
        };
        self.rates = self.network.rates(temperature, exposure, heat, &Surroundings::during(span, scheme, heat));
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
                for part in 0..parts {
                    let around = Surroundings::during(span.part(part, parts), scheme, heat);
                    if part > 0 {
                        self.network.temper(&self.state, &plan, heat, &around);
                        let (temperature, exposure) = (&self.state.temperature, &self.state.exposure);
                        self.rates = self.network.rates(temperature, exposure, heat, &around);
                    }
                    let step = if parts == 1 { plan.heat_step() } else { plan.heat_step() / parts as f64 };
                    self.warm(heat, &around.prescribed, step)?;
                    self.turns.passes += 1;
                }
            }
            Scheme::Implicit => {
                let (around, step) = (Surroundings::during(span, scheme, heat), plan.heat_step());
                let (temperature, exposure) = (&self.state.temperature, &self.state.exposure);
                let solved = self.network.implicit(temperature, exposure, heat, &around, step);
                let (rates, iterations) = solved.map_err(|stuck| self.stuck(&stuck))?;
                self.rates = rates;
                self.turns.passes += iterations;
                self.warm(heat, &around.prescribed, step)?;
            }
        }
        Ok(())
    }

    /// Lets temperatures follow the heat rates over some time, s, and books what came in and out meanwhile.
    fn warm(&mut self, heat: &HeatPlan, prescribed: &[Option<f64>], step: f64) -> Result<(), Fault> {
        let (State { exposure, material, mass, temperature, heat_accounts, .. }, rates) =
            (&mut self.state, &self.rates);
        let wrong = temperature
            .par_chunks_mut(CHUNK)
            .zip(optional(heat_accounts))
            .enumerate()
            .filter_map(|(chunk, (temperature, accounts))| {
                let mut wrong = None;
                for k in 0..temperature.len() {
                    let i = chunk * CHUNK + k;
                    let free = heat.warmed(material[i], mass[i], temperature[k], rates.total[i], step);
                    let now = prescribed[usize::from(exposure[i])].unwrap_or(free);
                    if let Some(account) = accounts.get_mut(k) {
                        book(account, rates.foreign[i] * step);
                        book(account, heat.heat_between(material[i], mass[i], free, now));
                    }
                    temperature[k] = now;
                    if !(now > 0.0 && now.is_finite()) {
                        wrong = wrong.or(Some(i));
                    }
                }
                wrong
            })
            .min();
        let Some(index) = wrong else { return Ok(()) };
        let step = self.state.step + 1;
        Err(Fault::Temperature {
            step,
            time: self.plan.time(step),
            particle: self.state.id[index],
            temperature: self.state.temperature[index],
        })
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
            self.heat().map(|()| self.expand(before))
        })?;
        if self.relax()? {
            self.state.step += 1;
            self.link();
        } else {
            self.state.step += 1;
            pool.install(|| self.rate());
        }
        Ok(())
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
        Ok(State { heat_rate: self.rates.total.clone(), ..self.state.clone() }.into())
    }
    fn bytes(&self) -> usize {
        self.state.bytes() + self.network.bytes() + self.rates.bytes() + self.motion_bytes
    }
    fn profile(&mut self, steps: u64) -> Result<Profile, Fault> {
        let (start, searches) = (Instant::now(), self.searches);
        self.advance(steps)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(Profile { steps, searches: self.searches - searches, seconds, ..Profile::empty() })
    }
    fn copy_bandwidth(&self) -> Result<f64, Fault> {
        cpu::copy_bandwidth(&self.pool)
    }
    fn searches(&self) -> u64 {
        self.searches
    }
    fn turns(&self) -> Option<Turns> {
        Some(self.turns)
    }
}
