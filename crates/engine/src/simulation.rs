//! A state that advances.

use crate::step::Backend;
use crate::{Capture, Device, Fault, Ledger, Plan, Profile, State, Turns};

/// A state advanced by a back end under a plan.
pub struct Simulation {
    plan: Plan,
    backend: Box<dyn Backend>,
    step: u64,
    particles: usize,
    /// Mechanical energy at the start of the ledger, and heat, J.
    initial: [f64; 2],
}

impl std::fmt::Debug for Simulation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Simulation").field("plan", &self.plan).field("step", &self.step).finish_non_exhaustive()
    }
}

impl Simulation {
    /// Takes a state up. A state that was just built gets its forces and its initial energy here.
    ///
    /// # Errors
    /// [`Fault::Inconsistent`] if fields do not belong together, [`Fault::Device`] if the device cannot be used, and
    /// whatever the first search finds.
    pub fn new(state: State, plan: Plan, device: impl Into<Device>) -> Result<Self, Fault> {
        state.validate(&plan)?;
        let (step, fresh, particles) = (state.step, !state.forces_known, state.len());
        let initial = [state.initial_energy, state.initial_heat];
        let backend = device.into().open(state, &plan)?;
        let mut simulation = Simulation { plan, backend, step, particles, initial };
        if fresh {
            simulation.backend.prepare()?;
            if simulation.plan.ledger {
                // The ledger starts here: what the springs hold at the start is not created later.
                let state = simulation.state()?;
                let plan = &simulation.plan;
                simulation.initial = [Ledger::of(&state, plan).mechanical(), state.heat(plan)];
            }
        }
        Ok(simulation)
    }

    /// Advances a number of steps.
    ///
    /// # Errors
    /// A [`Fault`] stops the run; the state is then lost, go back to the last capture.
    pub fn advance(&mut self, steps: u64) -> Result<(), Fault> {
        self.backend.advance(steps)?;
        self.step += steps;
        Ok(())
    }

    /// Advances a number of steps, to the same bits as [`Self::advance`], and tells where their time went. A step that is
    /// one kernel otherwise is taken with its stages apart. It is meant for some hundred steps: on a device every launch is
    /// kept until the end.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn profile(&mut self, steps: u64) -> Result<Profile, Fault> {
        let profile = self.backend.profile(steps)?;
        self.step += steps;
        Ok(profile)
    }

    /// How fast the device copies, bytes per second, read and written: the best of several copies of 256 MiB, or of as much
    /// as fits beside the simulation. On the CPU its threads copy one piece each.
    ///
    /// # Errors
    /// [`Fault::Device`] if the device fails, or has no room at all.
    pub fn copy_bandwidth(&self) -> Result<f64, Fault> {
        self.backend.copy_bandwidth()
    }

    /// The present moment; the simulation may go on before it is looked at.
    ///
    /// # Errors
    /// [`Fault::Device`] if the device fails.
    pub fn capture(&mut self) -> Result<Capture, Fault> {
        let (capture, [initial_energy, initial_heat]) = (self.backend.capture()?, self.initial);
        Ok(Capture::new(move || Ok(State { initial_energy, initial_heat, ..capture.state()? })))
    }
    /// The whole state, in the order of persistent ids.
    ///
    /// # Errors
    /// As [`Self::capture`] and [`Capture::state`].
    pub fn state(&mut self) -> Result<State, Fault> {
        self.capture()?.state()
    }
    /// The plan it follows.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.particles
    }
    /// Steps done.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.step
    }
    /// Present time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.plan.time(self.step)
    }
    /// Bytes held for the run, all arrays together.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.backend.bytes()
    }
    /// What heat and motion took so far, where heat advances by itself; `None` where it goes along with the motion.
    #[must_use]
    pub fn turns(&self) -> Option<Turns> {
        self.backend.turns()
    }
    /// How often neighbours were listed so far.
    #[must_use]
    pub fn searches(&self) -> u64 {
        self.backend.searches()
    }
}
