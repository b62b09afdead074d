//! The performance analysis of the paper, section 5, made on this machine: five models, three applications, four sizes, and
//! its figures 3 to 7 redrawn from what was measured, beside what it prints.
//!
//! A [`Scene`] is one of the paper's applications at one size and in one [`Mode`]; measured on a [`Machine`] it gives a
//! [`Measured`]. A [`Record`] holds them all: it is written as `bench.json`, as a table ([`table`]) and as one HTML page
//! ([`page`]) that needs nothing beside itself.
//!
//! How operations and bytes are counted stands in `docs/performance.md`.

mod chart;
mod counting;
mod figures;
mod measure;
mod page;
mod published;
mod table;

pub use counting::{Count, Work};
pub use measure::{Failure, Scene};
pub use page::page;
pub use published::{Published, Quantity, Value};
pub use table::table;

use serde::de::Error as _;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use tdem_engine::Device;

/// The paper's models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Model {
    /// Normal force.
    GN,
    /// Tangential force, too.
    GNT,
    /// Moments, too.
    GNTM,
    /// Bonds, too.
    BPM,
    /// Heat, too.
    TBPM,
}

impl Model {
    /// All of them, in the order of the paper.
    pub const ALL: [Model; 5] = [Model::GN, Model::GNT, Model::GNTM, Model::BPM, Model::TBPM];

    /// The file and the text of its application.
    #[must_use]
    pub fn case(self) -> (&'static str, &'static str) {
        match self {
            Model::GN | Model::GNT | Model::GNTM => ("packing.toml", include_str!("../cases/packing.toml")),
            Model::BPM => ("tension.toml", include_str!("../cases/tension.toml")),
            Model::TBPM => ("heating.toml", include_str!("../cases/heating.toml")),
        }
    }
    /// What the application is called.
    #[must_use]
    pub fn application(self) -> &'static str {
        match self {
            Model::GN | Model::GNT | Model::GNTM => "gravity packing",
            Model::BPM => "tension of reinforced concrete",
            Model::TBPM => "heating of refractory concrete",
        }
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Model::GN => "GN",
            Model::GNT => "GNT",
            Model::GNTM => "GNTM",
            Model::BPM => "BPM",
            Model::TBPM => "TBPM",
        })
    }
}

impl FromStr for Model {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let found = Model::ALL.into_iter().find(|model| model.to_string() == text);
        found.ok_or_else(|| "the models are GN, GNT, GNTM, BPM, TBPM".to_owned())
    }
}

/// The paper's sizes, about so many particles; each application has its own number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Size {
    /// What the cases have without a preset: several thousand.
    #[serde(rename = "small")]
    Small,
    /// 83,300 to 88,872.
    #[serde(rename = "88k")]
    K88,
    /// 627,264 to 686,000.
    #[serde(rename = "660k")]
    K660,
    /// 1,362,944 to 1,377,576.
    #[serde(rename = "1.4m")]
    M1,
    /// 3,000,848 to 3,015,300.
    #[serde(rename = "3m")]
    M3,
}

impl Size {
    /// All of them, the smallest first.
    pub const ALL: [Size; 5] = [Size::Small, Size::K88, Size::K660, Size::M1, Size::M3];

    /// The preset of the model's case; `None` is the case as it stands.
    #[must_use]
    pub fn preset(self, model: Model) -> Option<&'static str> {
        match (self, model) {
            (Size::Small, _) => None,
            (Size::K88, Model::GN | Model::GNT | Model::GNTM) => Some("83k"),
            (Size::K88, _) => Some("88k"),
            (Size::K660, Model::GN | Model::GNT | Model::GNTM) => Some("686k"),
            (Size::K660, Model::BPM) => Some("627k"),
            (Size::K660, Model::TBPM) => Some("666k"),
            (Size::M1, _) => Some("1.4m"),
            (Size::M3, _) => Some("3m"),
        }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Size::Small => "small",
            Size::K88 => "88k",
            Size::K660 => "660k",
            Size::M1 => "1.4m",
            Size::M3 => "3m",
        })
    }
}

impl FromStr for Size {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let found = Size::ALL.into_iter().find(|size| size.to_string() == text);
        found.ok_or_else(|| "the sizes are small, 88k, 660k, 1.4m, 3m".to_owned())
    }
}

/// How a step is computed. No ledger is kept in either.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// As the paper does: Gear's integrator, a search in every step.
    Paper,
    /// As this program does it by default: velocity Verlet, a search when something moved farther than half the skin.
    Best,
}

impl Mode {
    /// Both.
    pub const ALL: [Mode; 2] = [Mode::Paper, Mode::Best];
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Mode::Paper => "paper",
            Mode::Best => "best",
        })
    }
}

/// A device that is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// What computes.
    #[serde(skip)]
    pub device: Device,
    /// A short word: `cuda`, `opencl`, `16 threads`.
    pub word: String,
    /// What the vendor calls it.
    pub name: String,
    /// Name and version of the driver, or the instructions of the processor and its threads.
    pub driver: String,
    /// Whether it is a GPU.
    pub gpu: bool,
    /// Threads of a processor.
    #[serde(default)]
    pub threads: Option<usize>,
    /// Memory that can be used, bytes, if it is known.
    pub memory_bytes: Option<u64>,
    /// How fast it copies, bytes read and written per second; 0 before anything was measured.
    pub copy_bytes_per_second: f64,
    /// Additions and multiplications in 64 bits per second, at most.
    pub operations_per_second: f64,
}

/// Where the time of a step goes, in the paper's words, s per step with stages apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Procedures {
    /// Prediction and correction.
    pub integration: f64,
    /// Detection of neighbours.
    pub search: f64,
    /// What pairs remember, carried over a search; on the CPU a part of `search`.
    pub history: f64,
    /// Forces and moments of contacts; on a GPU also what acts from outside, which is in the same kernel.
    pub contact: f64,
    /// Forces and moments of bonds.
    pub bonds: f64,
    /// Gravity and boundary conditions; on a GPU a part of `contact`.
    pub external: f64,
}

impl Procedures {
    /// What the paper calls them.
    pub const NAMES: [&'static str; 6] =
        ["integration", "search", "contact history", "contact forces", "bonds", "external and boundary"];

    /// In the order of [`Self::NAMES`], s.
    #[must_use]
    pub fn seconds(&self) -> [f64; 6] {
        [self.integration, self.search, self.history, self.contact, self.bonds, self.external]
    }
    /// Parts of the whole, in the same order.
    #[must_use]
    pub fn shares(&self) -> [f64; 6] {
        let sum: f64 = self.seconds().iter().sum();
        self.seconds().map(|seconds| if sum > 0.0 { seconds / sum } else { 0.0 })
    }
}

/// A kernel, a stage or a whole step in a roofline, per step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Of the kernel or stage; `step` is a whole step.
    pub name: String,
    /// Counted operations.
    pub operations: Count,
    /// The least bytes that it moves.
    pub bytes: f64,
    /// s.
    pub seconds: f64,
}

impl Point {
    /// Operations per byte.
    #[must_use]
    pub fn intensity(&self) -> f64 {
        self.operations.always / self.bytes
    }
    /// Operations per second.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.operations.always / self.seconds
    }
}

/// What was measured of one scene on one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Which model.
    pub model: Model,
    /// Which size.
    pub size: Size,
    /// How a step is computed.
    pub mode: Mode,
    /// Its place among the machines of the record.
    pub machine: usize,
    /// Number of particles.
    pub particles: usize,
    /// Touching pairs.
    pub contacts: usize,
    /// Bonds that hold.
    pub bonds: usize,
    /// Steps of each measurement.
    pub steps: u64,
    /// Measurements, of which the best counts.
    pub repeats: usize,
    /// Searches in all of them.
    pub searches: u64,
    /// A step at the best, s.
    pub seconds_per_step: f64,
    /// In the median, s.
    pub median_seconds_per_step: f64,
    /// Memory of the run, all arrays together.
    pub memory_bytes: f64,
    /// Steps of the profile.
    pub profiled_steps: u64,
    /// Where its time went.
    pub procedures: Procedures,
    /// Kernels and stages of the profile, and, where searches are rare, a whole step of the measurement.
    pub points: Vec<Point>,
    /// Hash of the state behind the measurement, before the profile.
    pub hash: String,
}

impl Measured {
    /// Particle-steps per second, at the best.
    #[must_use]
    pub fn cundall(&self) -> f64 {
        self.particles as f64 / self.seconds_per_step
    }
    /// Time of a step over the number of particles, s.
    #[must_use]
    pub fn seconds_per_particle(&self) -> f64 {
        self.seconds_per_step / self.particles as f64
    }
    /// Memory over the number of particles.
    #[must_use]
    pub fn bytes_per_particle(&self) -> f64 {
        self.memory_bytes / self.particles as f64
    }
}

/// All measurements, and on what they were made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// `paper-figures`.
    pub benchmark: String,
    /// Of this program.
    pub version: String,
    /// Bits of all reals.
    pub precision: String,
    /// The command that makes it again.
    pub command: String,
    /// Devices, the first of which is compared with the paper.
    pub machines: Vec<Machine>,
    /// Measurements, the smallest sizes first.
    pub measurements: Vec<Measured>,
    /// What was left out, and why.
    pub left_out: Vec<String>,
    /// How many measurements were asked for.
    pub planned: usize,
}

impl Record {
    /// A record without any measurement.
    #[must_use]
    pub fn new(version: &str, command: String, machines: Vec<Machine>, planned: usize) -> Self {
        Record {
            benchmark: "paper-figures".to_owned(),
            version: version.to_owned(),
            precision: "f64".to_owned(),
            command,
            machines,
            measurements: Vec::new(),
            left_out: Vec::new(),
            planned,
        }
    }
    /// From what [`Self::json`] gave.
    ///
    /// # Errors
    /// What is not as it should be, and where.
    pub fn read(text: &str) -> Result<Self, serde_json::Error> {
        let record: Record = serde_json::from_str(text)?;
        let machines = record.machines.len();
        if machines == 0 {
            return Err(serde_json::Error::custom("there are no machines"));
        }
        match record.measurements.iter().find(|measured| measured.machine >= machines) {
            Some(lost) => Err(serde_json::Error::custom(format!("there is no machine {}", lost.machine))),
            None => Ok(record),
        }
    }
    /// As JSON.
    ///
    /// # Errors
    /// Never but for numbers that JSON does not know, which are written as null.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}
