//! The verification catalogue: each case is physics run by the engine and judged against something known.
//!
//! A case is written once and takes the back end that runs it. [`catalogue`] lists all cases, [`run`] runs one,
//! [`table`] and [`markdown`] show what came out. Nothing here prints.
//!
//! # Example
//! ```
//! use tdem_studies::verify::{Backend, catalogue, run};
//! let cases = catalogue();
//! let case = cases.iter().find(|c| c.name == "plane/free-fall").expect("a case of that name");
//! let outcome = run(case, Backend::CpuLanes);
//! assert!(outcome.passed());
//! ```

mod block;
mod bond;
mod bonded;
mod bulk;
mod chain;
mod conservation;
mod format;
mod impact;
mod impulse;
mod incline;
mod integrators;
mod oblique;
mod plane;
mod prism;
mod scene;
mod search;
mod spring;
mod stability;
mod statics;
mod strength;
mod thermal;
mod turning;

pub use format::{escaped, markdown, table};

use scene::Bench;
use std::time::Instant;
use tdem_engine::cpu::{List, Options, Width};
use tdem_engine::gpu::{Api, devices};
use tdem_engine::{Device, Fault, Plan};

/// When a case is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// Under the tests, on every back end: seconds in all.
    Quick,
    /// Before a release: minutes in all.
    Full,
}

/// One entry of the catalogue.
#[derive(Clone, Copy)]
pub struct Case {
    /// Group and name, `contact/chung-ooi-4-aluminium-oxide`.
    pub name: &'static str,
    /// When it is run.
    pub tier: Tier,
    /// Where the expected values come from.
    pub source: &'static str,
    /// What happens and what is looked at.
    pub about: &'static str,
    /// The case itself.
    body: fn(&mut Bench) -> Result<(), Fault>,
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Case").field("name", &self.name).field("tier", &self.tier).finish_non_exhaustive()
    }
}

impl Case {
    /// What stands before the slash of the name.
    #[must_use]
    pub fn group(&self) -> &'static str {
        self.name.split_once('/').map_or(self.name, |(group, _)| group)
    }
}

/// Groups of cases, in the order of the catalogue, and what they are about.
pub const GROUPS: [(&str, &str); 16] = [
    ("contact", "impacts of two bodies, head-on and oblique, with damping and friction"),
    ("plane", "one sphere or two on a floor or an incline: falling, resting, bouncing, rolling, sliding"),
    ("spring", "the tangential spring of a contact by itself"),
    ("conservation", "what the laws of motion keep: momentum, angular momentum, energy"),
    ("integrators", "how fast errors fall with the step"),
    ("stability", "steps just below a proven bound are stable, steps above it are not"),
    ("search", "what may not depend on how neighbours are found, how particles are called, how space is turned"),
    ("bulk", "random packings: what many spheres show within their scatter"),
    ("bond", "single bonds: vibration, damping, objectivity, failure and what comes after"),
    ("turning", "bodies that turn freely: what rotation may not do to bonds, dashpots and springs of friction"),
    ("chain", "chains of bonds against the closed forms of the discrete chain"),
    ("block", "blocks on a face-centred lattice: elasticity, waves, strength, what motion keeps"),
    ("statics", "equilibrium without time, against closed forms, another program, and the engine at rest"),
    ("prism", "the reinforced prism of `cases/tension.toml`: its initial stiffness"),
    ("strength", "strength of bonded solids: what different tests on one material say of each other"),
    ("thermal", "heat: conduction, surfaces, expansion and its stresses, balance, heat of friction and of dashpots"),
];

/// How far a value may be from what is expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// In the unit of the value.
    Absolute(f64),
    /// As a fraction of the expected value.
    Relative(f64),
    /// The expected value is the largest allowed.
    AtMost,
    /// The expected value is the least allowed.
    AtLeast,
}

/// What an expected value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The solution of the model's equations, on paper.
    ClosedForm,
    /// Printed or plotted in the literature.
    Published,
    /// Computed by a program that shares nothing with the engine.
    Reference,
    /// How fast an error falls with the step.
    Order,
    /// What the laws of motion keep.
    Conservation,
    /// What may not depend on how the machine works or how space is turned.
    Invariance,
    /// What random packings, and bodies that tear, show within their scatter.
    Statistical,
}

/// One judged value.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// The quantity.
    pub what: String,
    /// Its unit, `1` for numbers.
    pub unit: &'static str,
    /// What it should be.
    pub expected: f64,
    /// What the engine computed.
    pub got: f64,
    /// How far the two may be apart.
    pub tolerance: Tolerance,
    /// What the expected value is.
    pub kind: Kind,
    /// The verdict.
    pub passed: bool,
}

/// What a case gave.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Where it ran.
    pub backend: Backend,
    /// Its judged values.
    pub checks: Vec<Check>,
    /// What stopped it before its end; such a case has failed.
    pub fault: Option<Fault>,
    /// A hash of its final states, equal on every back end; absent where a case keeps no state.
    pub hash: Option<u128>,
    /// Wall-clock time, s.
    pub seconds: f64,
}

impl Outcome {
    /// Whether it reached its end, judged something, and every value is within its tolerance.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.fault.is_none() && !self.checks.is_empty() && self.checks.iter().all(|check| check.passed)
    }
}

/// Who computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// The CPU, contacts one by one, each pair from both sides: the plain reference.
    CpuScalar,
    /// As `CpuLanes`, with the instructions of any machine of this kind.
    CpuPortable,
    /// The CPU, contacts eight at a time, each pair once.
    CpuLanes,
    /// A device of an interface for GPUs.
    Gpu {
        /// The interface.
        api: Api,
        /// The device's index within the interface.
        index: usize,
    },
}

impl Backend {
    /// The back ends of every machine.
    pub const CPU: [Backend; 3] = [Backend::CpuScalar, Backend::CpuPortable, Backend::CpuLanes];

    /// The back ends of this machine: those of the CPU, and every device that passes its self-test.
    #[must_use]
    pub fn all() -> Vec<Backend> {
        let usable = devices().into_iter().filter(|device| device.usable.is_ok());
        let gpus = usable.map(|device| Backend::Gpu { api: device.api, index: device.index });
        Backend::CPU.into_iter().chain(gpus).collect()
    }

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Backend::CpuScalar => "cpu".to_owned(),
            Backend::CpuPortable => "cpu with portable lanes".to_owned(),
            Backend::CpuLanes => "cpu with lanes".to_owned(),
            Backend::Gpu { api, index } => format!("{api} device {index}"),
        }
    }

    /// The same for the engine; a GPU has no use for the number of threads.
    fn device(self, threads: usize) -> Device {
        let (width, list) = match self {
            Backend::CpuScalar => (Width::One, List::Full),
            Backend::CpuPortable => (Width::Portable, List::Half),
            Backend::CpuLanes => (Width::Widest, List::Half),
            Backend::Gpu { api, index } => return Device::Gpu { api, index },
        };
        Options { threads: Some(threads), width, list, cell_factor: 1.0 }.into()
    }
}

/// All cases, group by group.
#[must_use]
pub fn catalogue() -> Vec<Case> {
    [
        impact::CASES,
        oblique::CASES,
        impulse::CASES,
        plane::CASES,
        incline::CASES,
        spring::CASES,
        conservation::CASES,
        integrators::CASES,
        stability::CASES,
        search::CASES,
        bulk::CASES,
        bond::CASES,
        turning::CASES,
        chain::CASES,
        block::CASES,
        statics::CASES,
        prism::CASES,
        strength::CASES,
        thermal::CASES,
    ]
    .concat()
}

/// Runs one case.
#[must_use]
pub fn run(case: &Case, backend: Backend) -> Outcome {
    run_altered(case, backend, |_| ())
}

/// Runs one case with every plan changed before the engine sees it: to show that a wrong law is caught.
#[must_use]
pub fn run_altered(case: &Case, backend: Backend, alter: fn(&mut Plan)) -> Outcome {
    let start = Instant::now();
    let mut bench = Bench::new(backend, alter);
    let fault = (case.body)(&mut bench).err();
    let (checks, hash) = bench.finish();
    Outcome { case: *case, backend, checks, fault, hash, seconds: start.elapsed().as_secs_f64() }
}
