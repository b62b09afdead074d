//! Files that this program writes itself.

use crate::render::{Report, Reports};
use crate::units::argument;
use std::fs;
use std::path::Path;

/// Writes a file whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Reports> {
    let mut unfinished = path.as_os_str().to_owned();
    unfinished.push(".unfinished");
    fs::write(&unfinished, bytes).and_then(|()| fs::rename(&unfinished, path)).map_err(|error| {
        // What cannot be written can often not be removed either; the first error is what must be told.
        let _ = fs::remove_file(&unfinished);
        refused(path, &error)
    })
}

/// A file or folder could not be written.
pub(crate) fn refused(path: &Path, error: &std::io::Error) -> Reports {
    Report::new("tdem::cli::write", format!("cannot write {}: {error}", argument(path)))
        .help("check that the folder exists and may be written, and that the disk is not full")
        .into()
}
