//! Where the time of a step goes, and how many bytes it moves at least.

use crate::Fault;
use crate::step::Stages;
use std::time::Instant;

/// Steps that were taken with their stages apart, each with a clock around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Steps it took.
    pub steps: u64,
    /// How often neighbours were listed meanwhile.
    pub searches: u64,
    /// Time of all steps together by the host's clock, s.
    pub seconds: f64,
    /// Where that time went, in the order of a step. On a device the rest is waiting for the host, and what lies between
    /// two kernels.
    pub parts: Vec<Part>,
    /// Bytes that a step moves at least when [`crate::Simulation::advance`] takes it, in which several stages may be one
    /// kernel; searches are shared among all steps.
    pub bytes_per_step: f64,
}

/// A stage on the CPU, a kernel on a device.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The stage it belongs to: a name of [`STAGES`].
    pub stage: &'static str,
    /// The kernel's name; the stage's on the CPU.
    pub name: &'static str,
    /// How often it ran.
    pub calls: u64,
    /// All calls together, s.
    pub seconds: f64,
    /// Bytes that all calls together move at least: whatever is needed is read once in each call, and whatever changes is
    /// written once. A word that several particles need counts once; caches decide how often it is fetched. What touching
    /// pairs remember is counted with the pairs that touch at the end of the profile.
    pub bytes: u64,
}

/// The stages, in the order of a step.
pub const STAGES: [&str; 7] = ["predict", "search", "bond", "contact", "gather", "boundary", "correct"];

impl Profile {
    /// A profile without any step.
    pub(crate) fn empty() -> Self {
        Profile { steps: 0, searches: 0, seconds: 0.0, parts: Vec::new(), bytes_per_step: 0.0 }
    }
    /// The stages that ran, each with all its parts together, in the order of a step. A search is called as often as
    /// neighbours were listed, whatever kernels that takes.
    #[must_use]
    pub fn stages(&self) -> Vec<Part> {
        let together = |stage| {
            let mut parts = self.parts.iter().filter(move |part| part.stage == stage);
            let first = Part { name: stage, ..parts.next()?.clone() };
            let sum = parts.fold(first, |sum, part| Part {
                seconds: sum.seconds + part.seconds,
                bytes: sum.bytes + part.bytes,
                ..sum
            });
            Some(Part { calls: if stage == "search" { self.searches } else { sum.calls }, ..sum })
        };
        STAGES.into_iter().filter_map(together).collect()
    }
    /// Time of all parts together, s.
    #[must_use]
    pub fn seconds_of_parts(&self) -> f64 {
        // From 0: the sum of nothing would be -0.
        self.parts.iter().fold(0.0, |sum, part| sum + part.seconds)
    }
}

/// Stages with a clock around each.
pub(crate) struct Timed<'a> {
    stages: &'a mut dyn Stages,
    /// In the order of [`STAGES`], s.
    pub(crate) seconds: [f64; STAGES.len()],
}

impl<'a> Timed<'a> {
    pub(crate) fn new(stages: &'a mut dyn Stages) -> Self {
        Timed { stages, seconds: [0.0; STAGES.len()] }
    }
    fn time<T>(&mut self, stage: usize, work: impl FnOnce(&mut dyn Stages) -> T) -> T {
        let start = Instant::now();
        let done = work(self.stages);
        self.seconds[stage] += start.elapsed().as_secs_f64();
        done
    }
}

impl Stages for Timed<'_> {
    fn predict(&mut self) -> Result<(), Fault> {
        self.time(0, |stages| stages.predict())
    }
    fn search(&mut self) -> Result<(), Fault> {
        self.time(1, |stages| stages.search())
    }
    fn bond(&mut self) {
        self.time(2, |stages| stages.bond());
    }
    fn contact(&mut self) -> Result<(), Fault> {
        self.time(3, |stages| stages.contact())
    }
    fn gather(&mut self) -> Result<(), Fault> {
        self.time(4, |stages| stages.gather())
    }
    fn boundary(&mut self) {
        self.time(5, |stages| stages.boundary());
    }
    fn correct(&mut self) {
        self.time(6, |stages| stages.correct());
    }
}

/// What is copied to measure how fast memory is, bytes: more than caches hold.
pub(crate) const COPY_BYTES: usize = 256 << 20;
/// Measurements, of which the best counts.
const MEASUREMENTS: usize = 5;
/// Each takes at least so long, s, so that starting it does not count.
const LEAST_SECONDS: f64 = 0.005;

/// Bytes per second, read and written, of copies of so many bytes: the best of several measurements. `copy` starts the
/// given number of copies and waits for them.
pub(crate) fn best_copy<E>(bytes: usize, copy: impl FnMut(usize) -> Result<(), E>) -> Result<f64, E> {
    Ok(2.0 * bytes as f64 / shortest(copy)?)
}

/// How long some work takes, s: the best of several measurements. `work` does it so many times and waits for the end.
pub(crate) fn shortest<E>(mut work: impl FnMut(usize) -> Result<(), E>) -> Result<f64, E> {
    let mut time = |times: usize| {
        let start = Instant::now();
        work(times).map(|()| start.elapsed().as_secs_f64() / times as f64)
    };
    // The first one touches memory and code that was never used.
    time(1)?;
    let times = (LEAST_SECONDS / time(1)?).ceil().clamp(1.0, 1e4) as usize;
    let mut best = f64::INFINITY;
    for _ in 0..MEASUREMENTS {
        best = best.min(time(times)?);
    }
    Ok(best)
}
