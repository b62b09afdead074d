//! One step: the algorithm.

use crate::{Capture, Fault, Profile, Turns};

/// The stages of a step. Stage names are file names: `cpu/predict.rs`, `gpu/kernels/predict.cl` and so on; on a device
/// several may be one kernel.
pub(crate) trait Stages {
    /// Moves particles and walls to the end of the step, under the forces of its beginning; temperatures and radii follow
    /// the heat rates of its beginning.
    fn predict(&mut self) -> Result<(), Fault>;
    /// Lists neighbours anew if something moved too far since the last time, and carries histories over.
    fn search(&mut self) -> Result<(), Fault>;
    /// Forces and moments of bonded pairs; breaks those that fail.
    fn bond(&mut self);
    /// Forces and moments of touching pairs; a bond that broke just now no longer keeps contact off.
    fn contact(&mut self) -> Result<(), Fault>;
    /// Adds to each particle what others keep for it, then walls, then the sum of its bonds.
    fn gather(&mut self) -> Result<(), Fault>;
    /// Gravity, applied forces, local damping, and the work of applied forces and of prescribed motion; heat rates.
    fn boundary(&mut self);
    /// Corrects velocities by the forces of the end of the step.
    fn correct(&mut self);
}

/// One time step.
pub(crate) fn step(stages: &mut dyn Stages) -> Result<(), Fault> {
    stages.predict()?;
    stages.search()?;
    stages.bond();
    stages.contact()?;
    stages.gather()?;
    stages.boundary();
    stages.correct();
    Ok(())
}

/// What computes.
pub(crate) trait Backend: Send {
    /// Advances a number of steps.
    fn advance(&mut self, steps: u64) -> Result<(), Fault>;
    /// Forces for a state that has none yet: as in a step, but nothing moves and no history advances.
    fn prepare(&mut self) -> Result<(), Fault>;
    /// The present moment, without its initial energy, which the simulation knows. The sooner it returns the better:
    /// whatever can wait until the state is asked for should.
    fn capture(&mut self) -> Result<Capture, Fault>;
    /// Bytes held for the run, all arrays together.
    fn bytes(&self) -> usize;
    /// As [`Self::advance`], with a clock around each stage.
    fn profile(&mut self, steps: u64) -> Result<Profile, Fault>;
    /// How fast it copies large arrays, bytes per second, read and written.
    fn copy_bandwidth(&self) -> Result<f64, Fault>;
    /// How often neighbours were listed.
    fn searches(&self) -> u64;
    /// What heat and motion took, where they take turns.
    fn turns(&self) -> Option<Turns> {
        None
    }
}
