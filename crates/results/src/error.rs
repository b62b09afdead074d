//! What can go wrong between a run and its files.

use crate::checkpoint::Damaged;
use crate::vtkhdf::FormatError;
use crate::words::bytes;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A file or folder of a run could not be written, read or trusted. The path stands last.
#[derive(Debug, Error)]
pub enum Error {
    /// No space is left. What was complete before is complete still.
    #[error("the disk is full, nothing was left half-written; free some space, then resume: {}", path.display())]
    DiskFull {
        /// What was being written.
        path: PathBuf,
    },
    /// A file would be longer than the process may make it. What was complete before is complete still.
    #[error("a file would be longer than the limit that this process has; raise it (`ulimit -f`), then resume: {}", path.display())]
    FileTooLarge {
        /// What was being written.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("cannot {action}: {source}: {}", path.display())]
    Io {
        /// What was tried.
        action: Action,
        /// Why it failed.
        source: io::Error,
        /// On what.
        path: PathBuf,
    },
    /// An HDF5 file could not be written or understood.
    #[error("cannot {action} as HDF5: {source}: {}", path.display())]
    Format {
        /// What was tried.
        action: Action,
        /// Why it failed.
        source: FormatError,
        /// On what.
        path: PathBuf,
    },
    /// Another process works in the folder.
    #[error("the run belongs to a live process{}; wait for it or stop it first: {}", process.map_or(String::new(), |id| format!(" ({id})")), path.display())]
    Locked {
        /// Its process id, if it left one.
        process: Option<u32>,
        /// The run.
        path: PathBuf,
    },
    /// A new run would mix with an old one.
    #[error("a run is there already; resume it, overwrite it, or choose another folder: {}", path.display())]
    RunExists {
        /// The run.
        path: PathBuf,
    },
    /// A new run would mix with files that are not a run's.
    #[error("the folder holds files that are not a run's, they are left alone; choose another folder: {}", path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
    },
    /// A symbolic link, or no file at all, stands where a run writes a file of its own.
    #[error("a file or folder of the run is a link or a device, and nothing is written through it: {}", path.display())]
    Linked {
        /// The link.
        path: PathBuf,
    },
    /// A frame is not as it was written.
    #[error("{damage}: {}", path.display())]
    Frame {
        /// What is wrong with it.
        damage: FrameDamage,
        /// The frame.
        path: PathBuf,
    },
    /// The list of frames, which holds their checksums, is not as it was written.
    #[error("{damage}: {}", path.display())]
    FrameList {
        /// What is wrong with it.
        damage: ListDamage,
        /// The list.
        path: PathBuf,
    },
    /// A run has no frame of a step.
    #[error("there is no frame of step {step}, the nearest is of step {nearest}: {}", path.display())]
    NoFrameOfStep {
        /// The step.
        step: u64,
        /// A step that has a frame.
        nearest: u64,
        /// The run.
        path: PathBuf,
    },
    /// There is no run.
    #[error("no run is there: `case.toml` is missing: {}", path.display())]
    NotARun {
        /// The folder.
        path: PathBuf,
    },
    /// No checkpoint can be used.
    #[error("no checkpoint can be used ({damaged} damaged); run the case again: {}", path.display())]
    NoCheckpoint {
        /// How many are there but damaged.
        damaged: usize,
        /// The run.
        path: PathBuf,
    },
    /// No checkpoint can be used; this is the newest.
    #[error(transparent)]
    Damaged(#[from] Damaged),
    /// The run has no frames yet.
    #[error("the run has no frames: {}", path.display())]
    NoFrames {
        /// The run.
        path: PathBuf,
    },
    /// A history was written by another version, so that rows cannot be added to it.
    #[error("the columns are not those of this version, so no rows can be added; run the case again: {}", path.display())]
    HistoryColumns {
        /// The history.
        path: PathBuf,
    },
    /// A history lacks a column that shall be drawn.
    #[error("there is no column `{column}`: {}", path.display())]
    NoColumn {
        /// The column.
        column: String,
        /// The history.
        path: PathBuf,
    },
    /// A curve could not be drawn.
    #[error("the curve `{curve}` cannot be drawn: {why}: {}", path.display())]
    Drawing {
        /// Its name.
        curve: String,
        /// Why, in words.
        why: String,
        /// Its file.
        path: PathBuf,
    },
    /// A picture has no pixels, or more than is sensible.
    #[error("a picture of {width} x {height} pixels, which takes some {} of memory, cannot be drawn; between 1 and 16384 are possible each way", bytes(*needed))]
    PictureSize {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Bytes it would take.
        needed: u64,
    },
    /// There is no memory for a picture.
    #[error("a picture of {width} x {height} pixels takes some {} of memory, of which {} are free", bytes(*needed), bytes(*free))]
    PictureMemory {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Bytes it would take.
        needed: u64,
        /// Bytes that are free.
        free: u64,
    },
    /// A picture could not be compressed.
    #[error("cannot compress a picture: {source}")]
    Picture {
        /// Why it failed.
        source: io::Error,
    },
}

/// What is wrong with a frame.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum FrameDamage {
    /// It was written, and is not there.
    #[error("the frame of step {step} is gone")]
    Gone {
        /// Its step.
        step: u64,
    },
    /// Its bytes are not those that were written.
    #[error("the frame of step {step} was changed: its bytes are not those that were written")]
    Changed {
        /// Its step.
        step: u64,
    },
    /// It is longer or shorter than what was written.
    #[error("the frame of step {step} has {bytes} bytes, of {expected} that were written")]
    Length {
        /// Its step.
        step: u64,
        /// Its length.
        bytes: u64,
        /// Its length as it was written.
        expected: u64,
    },
    /// Its step does not follow that of the frame before.
    #[error("the frame says that it is of step {step}, which is not later than that of the frame before it")]
    Order {
        /// The step.
        step: u64,
    },
}

/// What is wrong with the list of frames.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ListDamage {
    /// It is missing though there are frames.
    #[error("the list of frames is missing: whether frames were changed cannot be told")]
    Gone,
    /// Lines were changed.
    #[error("the list of frames was changed in line {line}, so that frames are taken as they are{}", if *more > 0 { format!(" (and in {more} more)") } else { String::new() })]
    Line {
        /// The first of them.
        line: usize,
        /// How many more.
        more: usize,
    },
    /// Its end is missing.
    #[error("the list of frames lacks the last {frames} frames, which are taken as they are")]
    CutOff {
        /// Frames that are not in it.
        frames: usize,
    },
}

/// What was tried when an error came up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Making a folder.
    CreateFolder,
    /// Writing a file.
    Write,
    /// Reading a file or listing a folder.
    Read,
    /// Giving a finished file its name.
    Rename,
    /// Removing a file or folder.
    Remove,
    /// Taking the lock of a run.
    Lock,
}

impl std::fmt::Display for Action {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Action::CreateFolder => "create the folder",
            Action::Write => "write the file",
            Action::Read => "read it",
            Action::Rename => "rename the finished file",
            Action::Remove => "remove it",
            Action::Lock => "lock the run",
        })
    }
}

impl Error {
    /// An error of the operating system, a full disk told apart.
    pub(crate) fn io(action: Action, source: io::Error, path: &Path) -> Self {
        match source.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Error::DiskFull { path: path.into() },
            io::ErrorKind::FileTooLarge => Error::FileTooLarge { path: path.into() },
            _ => Error::Io { action, source, path: path.into() },
        }
    }

    /// An error of the HDF5 library, the operating system's told apart.
    pub(crate) fn format(action: Action, source: FormatError, path: &Path) -> Self {
        match source.into_io() {
            Ok(source) => Error::io(action, source, path),
            Err(source) => Error::Format { action, source, path: path.into() },
        }
    }
}

/// Adds to an error of the operating system what was tried, and on what.
pub(crate) trait Context<T> {
    fn context(self, action: Action, path: &Path) -> Result<T, Error>;
}

impl<T> Context<T> for io::Result<T> {
    fn context(self, action: Action, path: &Path) -> Result<T, Error> {
        self.map_err(|source| Error::io(action, source, path))
    }
}

impl<T> Context<T> for Result<T, FormatError> {
    fn context(self, action: Action, path: &Path) -> Result<T, Error> {
        self.map_err(|source| Error::format(action, source, path))
    }
}
