//! Files that this program writes itself.

use crate::codes;
use crate::render::{Report, Reports};
use crate::units::argument;
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Where a file is written before it takes its name.
fn unfinished(path: &Path) -> PathBuf {
    let mut unfinished = path.as_os_str().to_owned();
    unfinished.push(".unfinished");
    unfinished.into()
}

/// Whether something other than a file or a folder stands there, such as a terminal: it is written to as it is.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Writes a file that is new: one that a link, left there by somebody else, leads to is not touched.
fn write_new(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if let Err(error) = fs::remove_file(path)
        && error.kind() != ErrorKind::NotFound
    {
        return Err(error);
    }
    OpenOptions::new().write(true).create_new(true).open(path)?.write_all(bytes)
}

/// Finds out before long work whether a file can be written behind it. What stands there is not touched.
pub(crate) fn try_to_write(path: &Path) -> Result<(), Reports> {
    let tried = if path.is_dir() {
        Err(ErrorKind::IsADirectory.into())
    } else if is_stream(path) {
        Ok(())
    } else {
        let unfinished = unfinished(path);
        write_new(&unfinished, &[]).and_then(|()| fs::remove_file(&unfinished))
    };
    tried.map_err(|error| refused(path, &error))
}

/// Writes a file whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Reports> {
    if is_stream(path) {
        return fs::write(path, bytes).map_err(|error| refused(path, &error));
    }
    let unfinished = unfinished(path);
    write_new(&unfinished, bytes).and_then(|()| fs::rename(&unfinished, path)).map_err(|error| {
        // What cannot be written can often not be removed either; the first error is what must be told.
        let _ = fs::remove_file(&unfinished);
        refused(path, &error)
    })
}

/// Removes a file, if it is there.
pub(crate) fn remove(path: &Path) -> Result<(), Reports> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(refused(path, &error)),
        _ => Ok(()),
    }
}

/// A file or folder could not be written.
pub(crate) fn refused(path: &Path, error: &std::io::Error) -> Reports {
    Report::new(codes::WRITE, format!("cannot write {}: {error}", argument(path)))
        .help("check that the folder exists and may be written, and that the disk is not full")
        .into()
}
