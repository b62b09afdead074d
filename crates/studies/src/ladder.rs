//! The price of acceleration: one case with its heat $S$, $S/2$, $S/4$, ... times as fast as its motion, and how far what
//! comes out differs from rung to rung.
//!
//! Only a case that runs its heat faster than its motion can be afforded, and its bodies then have less time to follow: they
//! swing, dashpots push, cracks run while the heat goes on, and temperatures go in larger steps $S\,\Delta t$. All rungs take
//! the step $\Delta t$ of the first, so that nothing but $S$ tells them apart. Where a difference $d$ between $S$ and $S/2$
//! halves from rung to rung (first order), the first of the two is off by $2d$ and the second by $d$ from a run without
//! acceleration.
//!
//! Heat that advances by itself, alone or in turns with the motion, has no such scale; what it costs is the length of its steps.
//! The rungs of such a case have steps of $h$, $h/2$, $h/4$, ... for the same time.
//!
//! [`rungs()`] makes the rungs of a case, [`prepare()`] their folders, [`climb()`] runs and compares them. What compares does not
//! ask how rungs came about.

mod climb;
mod compare;
mod record;
mod rung;

pub use climb::{Failure, Ladder, Outcome, Progress, climb, kept_bytes, step_seconds};
pub use compare::{Difference, Pair, Spread};
pub use record::{Earlier, folder_of, prepare};
pub use rung::{Halved, Rung, rungs};

use std::fmt;
use std::path::PathBuf;
use tdem_case::Problems;
use tdem_case::schema::OutOfRange;

/// Why a case has no ladder.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The case has no heat.
    #[error("the case has no heat, so that there is nothing to accelerate")]
    NoHeat,
    /// The heat is not faster than the motion.
    #[error("heat goes {time_scale} times as fast as motion: nothing is accelerated")]
    NotAccelerated {
        /// Time of the heat over time of the motion.
        time_scale: f64,
    },
    /// Rungs would go on below the pace of nature.
    #[error(
        "on the last of {rungs} rungs heat would go {lowest} times as fast as motion, slower than it does by itself"
    )]
    TooManyRungs {
        /// How many were asked for.
        rungs: u32,
        /// Time of the heat over time of the motion on the last one.
        lowest: f64,
    },
    /// Something is told to move along with the time of the motion, which rungs have different amounts of.
    #[error("{what}, and on each rung of the ladder the motion takes twice as long as on the one before")]
    FollowsMotion {
        /// What it is.
        what: Follower,
    },
    /// The case cannot be built at this time scale, or with this step.
    #[error("the rung {label} is refused: {problems}")]
    Refused {
        /// Of the rung.
        label: String,
        /// Why.
        problems: Problems,
    },
    /// A duration or a step that cannot be written down.
    #[error("a rung would take a time that is no time: {0}")]
    OutOfRange(#[from] OutOfRange),
}

/// Why a climb has nothing to show.
#[derive(Debug, thiserror::Error)]
pub enum Halt {
    /// Rungs are not of one case.
    #[error("the rungs are not of the same particles and bonds")]
    Different,
    /// The folder of a rung holds another one.
    #[error("the rung {label} cannot go on: {} is of another case, of other settings or of another version", folder.display())]
    OtherCase {
        /// Of the rung.
        label: String,
        /// Of the other one.
        folder: PathBuf,
    },
    /// What rungs leave cannot be written or read.
    #[error(transparent)]
    Results(#[from] tdem_results::Error),
}

/// What depends on the time of the motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Follower {
    /// A wall of this name moves.
    Wall(String),
    /// Particles move as prescribed.
    Motion,
    /// A motion or a force goes along points of time.
    Course,
}

impl fmt::Display for Follower {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Follower::Wall(name) => write!(f, "the wall `{name}` moves"),
            Follower::Motion => f.write_str("particles move as prescribed"),
            Follower::Course => f.write_str("a prescribed motion or a force changes with time"),
        }
    }
}
