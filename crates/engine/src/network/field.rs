//! Temperatures that advance by themselves, wherever they lie.

use super::{Network, Surroundings};
use crate::{Fault, State};

/// Why an implicit step has no solution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stuck {
    pub(crate) iterations: u64,
    /// How far temperatures are from the balance of heat, in the mean, K.
    pub(crate) error: f64,
}

/// The temperatures of a run, by the order of ids, and what changes them. Where they lie does not change a bit.
pub(crate) trait Field: Send {
    /// Takes up temperatures, K, and heat accounts of a state.
    fn take_up(&mut self, temperature: &[f64], accounts: Vec<[f64; 4]>) -> Result<(), Fault>;
    /// Puts temperatures, heat rates and heat accounts into a state.
    fn put(&mut self, state: &mut State) -> Result<(), Fault>;
    /// The present temperatures, K, `(N)`.
    fn temperatures(&mut self) -> Result<Vec<f64>, Fault>;
    /// Conducts through this network from now on.
    fn link(&mut self, network: Network) -> Result<(), Fault>;
    /// Stands in these surroundings from now on.
    fn surround(&mut self, around: Surroundings) -> Result<(), Fault>;
    /// Lets conductances and capacities follow the present temperatures, where properties depend on them.
    fn temper(&mut self) -> Result<(), Fault>;
    /// The longest explicit step in which no particle is carried beyond its neighbours, s; those of prescribed temperature
    /// do not count.
    fn longest_step(&mut self) -> Result<f64, Fault>;
    /// Finds the heat rates at the present temperatures.
    fn rate(&mut self) -> Result<(), Fault>;
    /// Finds the heat rates at the temperatures of the end of an implicit step, s. The iterations that it took.
    fn solve(&mut self, step: f64) -> Result<Result<u64, Stuck>, Fault>;
    /// Lets temperatures follow the heat rates over a step or a part of it, s, and books what came in and out meanwhile.
    /// Where one has become none, nothing more is done until [`Field::astray`] tells of it.
    fn warm(&mut self, step: f64) -> Result<(), Fault>;
    /// Books an amount, J, that is one of all particles: with the first, if there are accounts. Not what comes in or goes out.
    fn book(&mut self, column: usize, amount: f64);
    /// The lowest index of those that have no temperature since the last step, and what they have, K.
    fn astray(&mut self) -> Result<Option<(usize, f64)>, Fault>;
    /// Bytes of all arrays together.
    fn bytes(&self) -> usize;
    /// How fast large arrays are copied where it lies, bytes per second, read and written.
    fn copy_bandwidth(&self) -> Result<f64, Fault>;
}

/// Whether that is a temperature, K.
pub(crate) fn is_temperature(kelvins: f64) -> bool {
    kelvins > 0.0 && kelvins.is_finite()
}
