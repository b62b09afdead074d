//! A moment of a simulation, on its way to a state.

use crate::{Fault, State};

/// A moment of a simulation: taken quickly, made a [`State`] later, on any thread, while the simulation goes on.
pub struct Capture(Box<dyn FnOnce() -> Result<State, Fault> + Send>);

impl Capture {
    /// What is left to do until there is a state. It owns all that it needs.
    pub fn new(finish: impl FnOnce() -> Result<State, Fault> + Send + 'static) -> Self {
        Capture(Box::new(finish))
    }

    /// The state of that moment, in the order of persistent ids.
    ///
    /// # Errors
    /// Whatever a back end meets when it fetches what it set aside.
    pub fn state(self) -> Result<State, Fault> {
        (self.0)()
    }
}

impl From<State> for Capture {
    /// A state that is there already.
    fn from(state: State) -> Self {
        Capture::new(move || Ok(state))
    }
}

impl std::fmt::Debug for Capture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Capture").finish_non_exhaustive()
    }
}
