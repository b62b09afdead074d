//! One self-contained file per block, for sending.

use crate::error::Error;
use crate::files;
use crate::run_directory::stored_frames;
use crate::vtkhdf::master::{self, Numbers};
use std::path::{Path, PathBuf};

/// What was packed.
#[derive(Debug)]
pub struct Packed {
    /// One file per block.
    pub files: Vec<PathBuf>,
    /// Frames that are not in them, because they are damaged or gone, and what is wrong with the list of frames.
    pub damaged: Vec<Error>,
}

/// Copies all frames of a run into one file per block in a folder. The run may go on meanwhile: what it wrote before is packed.
/// Frames that are damaged or gone are left out, and the files say so.
///
/// # Errors
/// [`Error::NoFrames`], and whatever the file system says.
pub fn pack(run: &Path, folder: &Path, compression: u32) -> Result<Packed, Error> {
    let stored = stored_frames(run)?;
    if stored.frames.is_empty() {
        return Err(stored.damaged.into_iter().next().unwrap_or_else(|| Error::NoFrames { path: run.into() }));
    }
    files::make_folder(folder)?;
    let files = master::write(run, folder, stored.shown(), Numbers::Copied(compression))?;
    Ok(Packed { files, damaged: stored.damaged })
}
