//! One process per run.

use crate::error::{Action, Error};
use crate::files;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

/// Name of the lock in a run.
pub(crate) const FILE: &str = ".lock";

/// The right to write into a run, until dropped. The system takes it back when the process dies, however it dies,
/// so that no lock is ever stale.
#[derive(Debug)]
pub(crate) struct Lock {
    _file: File,
}

impl Lock {
    pub(crate) fn take(run: &Path) -> Result<Self, Error> {
        let path = run.join(FILE);
        let mut file = files::open(&path, OpenOptions::new().read(true).write(true), true, Action::Lock)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut text = String::new();
                let process = file.read_to_string(&mut text).ok().and_then(|_| text.trim().parse().ok());
                return Err(Error::Locked { process, path: run.into() });
            }
            // A file system without locks: better to run unguarded than not at all.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(Error::io(Action::Lock, error, &path)),
        }
        // Only a courtesy to whoever finds the lock taken, so a full disk must not matter.
        let _ = file.set_len(0).and_then(|()| write!(file, "{}", std::process::id()));
        Ok(Lock { _file: file })
    }
}

/// Whether a process writes into a run at this moment.
pub(crate) fn is_taken(run: &Path) -> bool {
    File::open(run.join(FILE)).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}
