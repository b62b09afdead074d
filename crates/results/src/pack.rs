//! One self-contained file per block, for sending.

use crate::error::{Action, Context, Error};
use crate::run_directory::stored_frames;
use crate::vtkhdf::master::{self, Numbers};
use std::fs;
use std::path::{Path, PathBuf};

/// Copies all frames of a run into one file per block in a folder, and returns the files. The run may go on
/// meanwhile: what it wrote before is packed.
///
/// # Errors
/// [`Error::NoFrames`], a frame that cannot be read, and whatever the file system says.
pub fn pack(run: &Path, folder: &Path, compression: u32) -> Result<Vec<PathBuf>, Error> {
    let stored = stored_frames(run)?;
    if let Some(unreadable) = stored.unreadable.into_iter().next() {
        return Err(unreadable);
    }
    if stored.frames.is_empty() {
        return Err(Error::NoFrames { path: run.into() });
    }
    fs::create_dir_all(folder).context(Action::CreateFolder, folder)?;
    master::write(run, folder, &stored.frames, Numbers::Copied(compression))
}
