//! Files that exist completely or not at all.

use crate::error::{Action, Context, Error};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Ending of a file that is being written.
const UNFINISHED: &str = "tmp";

/// Writes a file under a temporary name, then renames it: whoever looks, at whatever moment, sees the old file, or
/// the new one, or none. After a failure the temporary file is gone.
pub(crate) fn atomically(path: &Path, write: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".");
    name.push(UNFINISHED);
    let unfinished = path.with_file_name(name);
    let result = write(&unfinished)
        .and_then(|()| File::open(&unfinished).and_then(|file| file.sync_all()).context(Action::Write, path))
        .and_then(|()| fs::rename(&unfinished, path).context(Action::Rename, path));
    if result.is_err() {
        // The first error is the one to tell; that a file which may not exist cannot be removed adds nothing.
        let _ = fs::remove_file(&unfinished);
    }
    result?;
    sync_folder(parent(path))
}

/// The folder of a file.
pub(crate) fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Makes renames and removals in a folder survive a power cut.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), Error> {
    // Elsewhere a folder cannot be opened as a file; its entries are then as durable as the system makes them.
    if cfg!(unix) { File::open(folder).and_then(|file| file.sync_all()).context(Action::Write, folder) } else { Ok(()) }
}

/// The entries of a folder with a given ending, ascending by name. A folder that does not exist has none.
pub(crate) fn with_ending(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, Error> {
    let mut found: Vec<PathBuf> =
        entries(folder)?.into_iter().filter(|path| path.extension() == Some(OsStr::new(ending))).collect();
    found.sort();
    Ok(found)
}

/// The entries of a folder. A folder that does not exist has none.
pub(crate) fn entries(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    match fs::read_dir(folder) {
        Ok(entries) => entries
            .map(|entry| entry.map(|entry| entry.path()))
            .collect::<io::Result<_>>()
            .context(Action::Read, folder),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(Error::io(Action::Read, error, folder)),
    }
}

/// Removes files that a process left unfinished when it died.
pub(crate) fn remove_unfinished(folder: &Path) -> Result<(), Error> {
    with_ending(folder, UNFINISHED)?.iter().try_for_each(|path| remove(path))
}

/// Whether a file is one that a process left unfinished.
pub(crate) fn is_unfinished(path: &Path) -> bool {
    path.extension() == Some(OsStr::new(UNFINISHED))
}

/// Removes a file if it exists.
pub(crate) fn remove(path: &Path) -> Result<(), Error> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(Error::io(Action::Remove, error, path)),
        _ => Ok(()),
    }
}

/// Removes a folder and what is in it, if it exists.
pub(crate) fn remove_folder(path: &Path) -> Result<(), Error> {
    match fs::remove_dir_all(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(Error::io(Action::Remove, error, path)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        fs::write(&path, "old").unwrap();
        let result = atomically(&path, |unfinished| {
            fs::write(unfinished, "half of the n").unwrap();
            Err(Error::DiskFull { path: unfinished.into() })
        });
        assert!(matches!(result, Err(Error::DiskFull { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(entries(folder.path()).unwrap(), [path]);
    }
}
