//! Case files of `tdem`: from TOML to a state and a plan, or to all that is wrong, each with its line.
//!
//! * [`load`], [`parse`] a file, with presets and overrides applied, as a checked [`Case`]
//! * [`Loaded::build`] places particles and walls, chooses the time step: a [`Built`] holds what the engine needs
//! * [`Problems`] what is wrong: codes, messages, labels on lines, remedies
//! * [`mod@codes`] what each code means
//! * [`json_schema`] for editors, [`starter()`] for newcomers
//!
//! ```
//! let text = tdem_case::starter(tdem_case::Starter::Packing, "my first case");
//! let loaded = tdem_case::parse("case.toml", &text, std::path::Path::new("."), &[])?;
//! let built = loaded.build()?;
//! assert_eq!(built.state.len(), 400);
//! # Ok::<(), tdem_case::Problems>(())
//! ```

mod build;
mod changes;
mod check;
mod code;
pub mod codes;
mod courses;
mod grid;
mod habits;
mod limits;
mod load;
mod materials;
mod overrides;
mod problem;
mod repair;
mod rng;
mod schedule;
pub mod schema;
mod starter;
mod structure;
mod table;
mod tree;
mod walls;

pub use build::{Built, Memory, NoRuns, RunLoader, SurfaceExtent};
pub use changes::Change;
pub use check::{HISTORY_COLUMNS, HISTORY_COLUMNS_OF_BONDS, HISTORY_COLUMNS_OF_HEAT};
pub use code::Code;
pub use habits::instead;
pub use limits::{StepLimit, StepLimits};
pub use load::{Loaded, load, parse};
pub use problem::{Label, Problem, Problems, Severity, Source};
pub use schedule::Fields;
pub use schema::{Case, json_schema};
pub use starter::{SCHEMA_FILE, Starter, starter};
