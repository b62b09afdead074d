//! A moment of a simulation.

use crate::{Fault, State};

/// A moment of a simulation, taken quickly; the simulation goes on while it becomes a [`State`] on any thread.
pub struct Capture {
    assemble: Box<dyn FnOnce() -> Result<State, Fault> + Send>,
    /// J.
    initial_energy: f64,
}

impl std::fmt::Debug for Capture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Capture").finish_non_exhaustive()
    }
}

impl Capture {
    pub(crate) fn new(assemble: impl FnOnce() -> Result<State, Fault> + Send + 'static) -> Self {
        Capture { assemble: Box::new(assemble), initial_energy: 0.0 }
    }
    pub(crate) fn with_initial_energy(self, initial_energy: f64) -> Self {
        Capture { initial_energy, ..self }
    }
    /// The whole state, in the order of persistent ids.
    ///
    /// # Errors
    /// [`Fault::Device`] if it does not arrive from the device.
    pub fn state(self) -> Result<State, Fault> {
        let state = (self.assemble)()?;
        Ok(State { initial_energy: self.initial_energy, ..state })
    }
}
