//! What a run directory holds, without changing it.

use crate::checkpoint::{self, Damaged};
use crate::error::Error;
use crate::files::entries;
use crate::frame_list;
use crate::run_directory::{CASE, CHECKPOINTS, HISTORY, masters, stored_frames};
use crate::tensors::Damage;
use crate::vtkhdf::master::{block_names, file_of, is_complete};
use std::fs;
use std::path::{Path, PathBuf};
use tdem_engine::State;

/// What a run directory holds.
#[derive(Debug)]
pub struct Info {
    /// Its frames, ascending.
    pub frames: Vec<FrameInfo>,
    /// Frames that are damaged, gone or cannot be read, and what is wrong with their list.
    pub unreadable_frames: Vec<Error>,
    /// Blocks that its masters show.
    pub blocks: Vec<String>,
    /// Whether its masters need no other file; `None` where they do not say.
    pub complete: Option<bool>,
    /// Its checkpoints, ascending by step.
    pub checkpoints: Vec<CheckpointInfo>,
    /// Number of complete rows of its history.
    pub history_rows: usize,
    /// Bytes of all its files.
    pub bytes: u64,
}

/// A frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameInfo {
    /// Its file.
    pub path: PathBuf,
    /// Its step.
    pub step: u64,
    /// Its time, s.
    pub time: f64,
    /// Number of particles it shows.
    pub particles: usize,
}

/// A checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckpointInfo {
    /// Its file.
    pub path: PathBuf,
    /// Its step.
    pub step: u64,
    /// Number of particles, or why it cannot be used.
    pub particles: Result<usize, Damage>,
}

/// Looks at a run. Every checkpoint and every frame is read from its first byte to its last, and hashes are checked.
///
/// # Errors
/// [`Error::NotARun`], and whatever the file system says.
pub fn info(run: &Path) -> Result<Info, Error> {
    require_run(run)?;
    let stored = stored_frames(run)?;
    let blocks = block_names(&stored.frames);
    let frames = stored.frames.into_iter().map(|frame| FrameInfo {
        path: run.join(&frame.file),
        step: frame.step,
        time: frame.time,
        particles: frame.blocks.iter().find(|block| block.name == "particles").map_or(0, |block| block.points),
    });
    let checkpoints = checkpoint::list(&run.join(CHECKPOINTS))?.into_iter().map(|path| CheckpointInfo {
        step: checkpoint::step_of(&path).unwrap_or(0),
        particles: checkpoint::read(&path).map(|state| state.len()),
        path,
    });
    // Complete lines end with a line feed, the first is the header.
    let history = fs::read(run.join(HISTORY)).unwrap_or_default();
    let lines = history.split(|&byte| byte == b'\n').count() - 1;
    Ok(Info {
        frames: frames.collect(),
        unreadable_frames: stored.damaged,
        complete: blocks.first().and_then(|name| is_complete(&file_of(run, name))),
        blocks,
        checkpoints: checkpoints.collect(),
        history_rows: lines.saturating_sub(1),
        bytes: bytes(run)?,
    })
}

/// What a run shows without any of its numbers being read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Glance {
    /// Number of frames that were written.
    pub frames: usize,
    /// Names of its masters.
    pub masters: Vec<String>,
    /// Whether they need no other file.
    pub complete: bool,
}

/// Glances at a run, which takes no longer for a large one.
///
/// # Errors
/// Whatever the file system says.
pub fn glance(run: &Path) -> Result<Glance, Error> {
    let masters = masters(run)?;
    Ok(Glance {
        frames: frame_list::read(run)?.frames.len(),
        complete: !masters.is_empty() && masters.iter().all(|master| is_complete(master) == Some(true)),
        masters: masters.iter().filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect(),
    })
}

/// The newest state of a run that can be trusted.
#[derive(Debug)]
pub struct FinalState {
    /// The state.
    pub state: State,
    /// The checkpoint it comes from.
    pub path: PathBuf,
    /// Newer checkpoints that were passed over.
    pub damaged: Vec<Damaged>,
}

/// Loads the newest state of a run, to begin another run from it. The run itself is left alone.
///
/// # Errors
/// [`Error::NotARun`]; [`Error::NoCheckpoint`] if there is no checkpoint, [`Error::Damaged`] if none is whole.
pub fn load_final_state(run: &Path) -> Result<FinalState, Error> {
    require_run(run)?;
    let newest = checkpoint::newest(&run.join(CHECKPOINTS))?;
    match (newest.state, newest.path) {
        (Some(state), Some(path)) => Ok(FinalState { state, path, damaged: newest.damaged }),
        _ => Err(newest
            .damaged
            .into_iter()
            .next()
            .map_or_else(|| Error::NoCheckpoint { damaged: 0, path: run.into() }, Error::Damaged)),
    }
}

/// Step of the newest checkpoint of a run, by its name: whether it is whole is not looked at. `None` where there is none.
///
/// # Errors
/// [`Error::NotARun`], and whatever the file system says.
pub fn newest_step(run: &Path) -> Result<Option<u64>, Error> {
    require_run(run)?;
    Ok(checkpoint::list(&run.join(CHECKPOINTS))?.last().and_then(|path| checkpoint::step_of(path)))
}

pub(crate) fn require_run(run: &Path) -> Result<(), Error> {
    if run.join(CASE).exists() { Ok(()) } else { Err(Error::NotARun { path: run.into() }) }
}

fn bytes(folder: &Path) -> Result<u64, Error> {
    let mut total = 0;
    for path in entries(folder)? {
        // A run that goes on may remove a file at any moment.
        let Ok(metadata) = fs::symlink_metadata(&path) else { continue };
        total += if metadata.is_dir() { bytes(&path)? } else { metadata.len() };
    }
    Ok(total)
}
