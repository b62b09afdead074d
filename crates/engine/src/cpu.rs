//! The CPU back end.

use crate::step::Backend;
use crate::{Fault, Plan, State};

/// How the CPU works. None of these changes a bit of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Threads; `None` takes all cores.
    pub threads: Option<usize>,
    /// Contacts eight at a time instead of one by one.
    pub lanes: bool,
    /// Each pair once, or from both sides.
    pub list: List,
    /// Width of a search cell relative to the reach of a contact, at least 1.
    pub cell_factor: f64,
}

/// Whether a pair is listed once or twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum List {
    /// Once, by the particle of the lower id; the other particle gathers it.
    Half,
    /// By both particles: more work, no gathering. The plain reference.
    Full,
}

impl Default for Options {
    fn default() -> Self {
        Options { threads: None, lanes: true, list: List::Half, cell_factor: 1.0 }
    }
}

pub(crate) struct Cpu {
    state: State,
}

impl Cpu {
    pub(crate) fn new(state: State, _plan: &Plan, _options: &Options) -> Result<Self, Fault> {
        Ok(Cpu { state })
    }
}

impl Backend for Cpu {
    fn predict(&mut self) -> Result<(), Fault> {
        Ok(())
    }
    fn search(&mut self) -> Result<(), Fault> {
        Ok(())
    }
    fn contact(&mut self) -> Result<(), Fault> {
        Ok(())
    }
    fn gather(&mut self) {}
    fn boundary(&mut self) {}
    fn correct(&mut self) {}
    fn prepare(&mut self) -> Result<(), Fault> {
        Ok(())
    }
    fn snapshot(&self) -> State {
        self.state.clone()
    }
    fn bytes(&self) -> usize {
        0
    }
    fn searches(&self) -> u64 {
        0
    }
}
