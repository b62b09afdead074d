//! What can go wrong while a simulation runs.

use thiserror::Error;

/// The run cannot go on. The state of the last good step is the last one that the caller took.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Fault {
    /// A position is no longer a number.
    #[error("particle {particle} has no finite position at step {step} (t = {time:.6e} s)")]
    NotFinite {
        /// Step that found it.
        step: u64,
        /// Its time, s.
        time: f64,
        /// Persistent id.
        particle: u32,
    },
    /// A temperature is not above absolute zero, or not a number: the step of the heat is too large.
    #[error(
        "particle {particle} has a temperature of {temperature:.3e} K at step {step} (t = {time:.6e} s): the step of the heat is too large"
    )]
    Temperature {
        /// Step that found it.
        step: u64,
        /// Its time, s.
        time: f64,
        /// Persistent id.
        particle: u32,
        /// K.
        temperature: f64,
    },
    /// A sum over all particles is no number, or beyond all numbers.
    #[error("`{quantity}` is {value} {unit} at step {step} (t = {time:.6e} s)")]
    Unbounded {
        /// Step that found it.
        step: u64,
        /// Its time, s.
        time: f64,
        /// Its name, as `history.csv` has it.
        quantity: &'static str,
        /// What it is.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// The temperatures of the end of a step were not found.
    #[error(
        "the temperatures of step {step} (t = {time:.6e} s) were not found in {iterations} iterations: they are \
         {error:.3e} K from the balance of heat in the mean"
    )]
    Conduction {
        /// Step that was computed.
        step: u64,
        /// Its time, s.
        time: f64,
        /// Iterations done.
        iterations: u64,
        /// K.
        error: f64,
    },
    /// A particle left the domain in a direction that does not repeat.
    #[error("particle {particle} left the domain at step {step} (t = {time:.6e} s): it is at {position:?} m")]
    Escaped {
        /// Step that found it.
        step: u64,
        /// Its time, s.
        time: f64,
        /// Persistent id.
        particle: u32,
        /// Where it is, m.
        position: [f64; 3],
    },
    /// Two particles overlap by more than the limit.
    #[error(
        "particles {first} and {second} overlap by {ratio:.3} of the smaller radius at step {step} (t = {time:.6e} s); \
         the limit is {limit}"
    )]
    Overlap {
        /// Step that found it.
        step: u64,
        /// Its time, s.
        time: f64,
        /// The lower id.
        first: u32,
        /// The higher id.
        second: u32,
        /// Overlap over the smaller radius.
        ratio: f64,
        /// The limit it exceeds.
        limit: f64,
    },
    /// A particle and a wall overlap by more than the limit.
    #[error(
        "particle {particle} and wall {wall:?} overlap by {ratio:.3} of the particle's radius at step {step} \
         (t = {time:.6e} s); the limit is {limit}"
    )]
    WallOverlap {
        /// Step that found it.
        step: u64,
        /// Its time, s.
        time: f64,
        /// Persistent id.
        particle: u32,
        /// Name of the wall.
        wall: String,
        /// Overlap over the radius.
        ratio: f64,
        /// The limit it exceeds.
        limit: f64,
    },
    /// The neighbour list would need more entries than 32 bits can count.
    #[error("the neighbour list needs {entries} entries at step {step}; a 32-bit index counts 4294967295")]
    ListOverflow {
        /// Step that found it.
        step: u64,
        /// Entries needed.
        entries: u64,
    },
    /// A periodic box is too small: a particle would meet two images of another.
    #[error(
        "the domain is {length:.6e} m long in a direction that repeats, but neighbours reach {reach:.6e} m: it must be at least twice that"
    )]
    BoxTooSmall {
        /// Length of the box, m.
        length: f64,
        /// Largest distance of listed centres, m.
        reach: f64,
    },
    /// The operating system refused to start the threads asked for.
    #[error("the operating system refuses to start {threads} threads")]
    Threads {
        /// Threads asked for; 0 is one per core.
        threads: usize,
    },
    /// The fields of a state do not belong together, or not to the plan.
    #[error("the state is not consistent: {what}")]
    Inconsistent {
        /// What does not fit.
        what: &'static str,
    },
    /// The device cannot be used, or failed.
    #[error("{0}")]
    Device(#[from] crate::gpu::Error),
}

impl Fault {
    /// The same at another step: that of the simulation, where a fault was found in a step of its motion.
    pub(crate) fn at(mut self, now: u64, clock: f64) -> Self {
        match &mut self {
            Fault::NotFinite { step, time, .. }
            | Fault::Temperature { step, time, .. }
            | Fault::Unbounded { step, time, .. }
            | Fault::Conduction { step, time, .. }
            | Fault::Escaped { step, time, .. }
            | Fault::Overlap { step, time, .. }
            | Fault::WallOverlap { step, time, .. } => (*step, *time) = (now, clock),
            Fault::ListOverflow { step, .. } => *step = now,
            Fault::BoxTooSmall { .. } | Fault::Threads { .. } | Fault::Inconsistent { .. } | Fault::Device(_) => {}
        }
        self
    }
}
