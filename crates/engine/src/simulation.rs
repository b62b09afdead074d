//! A state that advances.

use crate::{Fault, Ledger, Plan, State, cpu, step};

/// A state advanced by a back end under a plan.
pub struct Simulation {
    plan: Plan,
    backend: Box<dyn step::Backend>,
    step: u64,
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
    /// [`Fault::Inconsistent`] if fields do not belong together, and whatever the first search finds.
    pub fn new(state: State, plan: Plan, options: &cpu::Options) -> Result<Self, Fault> {
        state.validate(&plan)?;
        let (step, fresh) = (state.step, !state.forces_known);
        let mut backend: Box<dyn step::Backend> = Box::new(cpu::Cpu::new(state, &plan, options)?);
        if fresh {
            backend.prepare()?;
            if plan.ledger {
                // The ledger starts here: what the springs hold at the start is not created later.
                let mut state = backend.snapshot();
                state.initial_energy = Ledger::of(&state, &plan).mechanical();
                backend = Box::new(cpu::Cpu::new(state, &plan, options)?);
            }
        }
        Ok(Simulation { plan, backend, step })
    }

    /// Advances a number of steps.
    ///
    /// # Errors
    /// A [`Fault`] stops the run; the state is then lost, go back to the last snapshot.
    pub fn advance(&mut self, steps: u64) -> Result<(), Fault> {
        self.backend.advance(steps)?;
        self.step += steps;
        Ok(())
    }

    /// The whole state, in the order of persistent ids.
    #[must_use]
    pub fn state(&self) -> State {
        self.backend.snapshot()
    }
    /// The plan it follows.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
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
    /// How often neighbours were listed so far.
    #[must_use]
    pub fn searches(&self) -> u64 {
        self.backend.searches()
    }
}
