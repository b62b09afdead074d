//! Files that exist completely or not at all.

use crate::error::{Action, Context, Error};
use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::Xxh3;

/// Ending of a file that is being written.
const UNFINISHED: &str = "tmp";

/// Writes a file under a temporary name, then renames it: whoever looks, at whatever moment, sees the old file, or
/// the new one, or none. After a failure the temporary file is gone.
pub(crate) fn atomically(path: &Path, write: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".");
    name.push(UNFINISHED);
    let unfinished = path.with_file_name(name);
    // What stands there already may be a link, which would lead the new file elsewhere.
    remove(&unfinished)?;
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

/// Opens a file of a run to be changed as `options` say, which is made if `new` and need be. A symbolic link is refused: the
/// folder may come from elsewhere, and the link may lead to anything.
pub(crate) fn open(path: &Path, options: &OpenOptions, new: bool, action: Action) -> Result<File, Error> {
    let mut tries = 0;
    loop {
        tries += 1;
        let file = match fs::symlink_metadata(path) {
            Ok(named) if !named.is_file() => return Err(Error::Linked { path: path.into() }),
            Ok(named) => {
                let file = options.open(path).context(action, path)?;
                let opened = file.metadata().context(action, path)?;
                if !is_same(&named, &opened) {
                    return Err(Error::Linked { path: path.into() });
                }
                return Ok(file);
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound && new => options.clone().create_new(true).open(path),
            Err(error) => Err(error),
        };
        match file {
            // Another process made it in the meantime.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && tries < 2 => {}
            file => return file.context(action, path),
        }
    }
}

/// Whether a file that was opened is the one whose name was looked at before.
#[cfg(unix)]
fn is_same(named: &Metadata, opened: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (named.dev(), named.ino()) == (opened.dev(), opened.ino())
}

#[cfg(not(unix))]
fn is_same(_: &Metadata, opened: &Metadata) -> bool {
    opened.is_file()
}

/// Makes a folder of a run, if need be. A symbolic link is refused as one of a file is.
pub(crate) fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).context(Action::CreateFolder, path)?;
    refuse_link(path)
}

/// Refuses a symbolic link where a file or folder of a run belongs.
pub(crate) fn refuse_link(path: &Path) -> Result<(), Error> {
    if fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink()) {
        return Err(Error::Linked { path: path.into() });
    }
    Ok(())
}

/// Length and hash of a file: a change of any byte changes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Seal {
    pub(crate) bytes: u64,
    /// XXH3, 128 bits.
    pub(crate) hash: u128,
}

impl Seal {
    /// Reads a file from its first byte to its last.
    pub(crate) fn of(path: &Path) -> io::Result<Self> {
        let mut file = File::open(path)?;
        let mut hasher = Xxh3::new();
        let mut buffer = vec![0; 1 << 20];
        let mut bytes = 0;
        loop {
            match file.read(&mut buffer) {
                Ok(0) => return Ok(Seal { bytes, hash: hasher.digest128() }),
                Ok(count) => {
                    hasher.update(&buffer[..count]);
                    bytes += count as u64;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }
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
