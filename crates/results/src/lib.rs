//! What a run of `tdem` leaves on the disk: frames for ParaView, a history for Python, checkpoints for the next run.
//!
//! * [`RunDirectory`] the folder of a run; `kill -9` at any moment leaves one that can be read and resumed
//! * [`session`] runs a simulation into it
//! * [`checkpoint`] the complete state, exact to the bit
//! * [`columns`] named reals in a file of their own, as exact
//! * [`glossary`] names, units and meanings of everything that is written
//! * [`pack`] one self-contained file per block
//! * [`export`] particles of frames in formats of other programs
//! * [`info`] what a folder holds, and the state to begin another run from
//! * [`curve`] two columns of the history against each other
//! * [`picture`] spheres as pixels, without a GPU; series of them are drawn while a run goes on
//! * [`report`] a page about a run, in one file
//! * [`Event`] what happens to a run, as its log tells it
//! * [`mean_stress`] of particles, [`Pace`] and [`Rate`] of a run: for whoever watches a simulation without a folder

mod axis;
mod blocks;
pub mod checkpoint;
pub mod columns;
pub mod curve;
mod error;
pub mod export;
mod files;
mod frame_list;
pub mod glossary;
mod history;
mod info;
mod lock;
mod log;
mod pace;
mod pack;
pub mod picture;
pub mod report;
mod run_directory;
pub mod session;
mod start;
mod tensors;
mod vtkhdf;
pub mod words;
mod writer;

pub use blocks::{Contents, Precision, mean_stress};
pub use checkpoint::Damaged;
pub use error::{Action, Error, FrameDamage, ListDamage};
pub use history::{HistoryDamage, Row};
pub use info::{CheckpointInfo, FinalState, FrameInfo, Glance, Info, glance, info, load_final_state, newest_step};
pub use log::Event;
pub use pace::{Pace, Rate};
pub use pack::{Packed, pack};
pub use run_directory::{Resumed, RunDirectory, case_that_ran, restore_masters};
pub use session::{Control, Note, Observer, Outcome, Progress, RunError};
pub use tensors::Damage;
pub use vtkhdf::{FormatError, Names};
