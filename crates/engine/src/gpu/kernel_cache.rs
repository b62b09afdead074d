//! Compiled kernels on disk: a damaged, foreign or unreadable entry is as good as none, and no failure is an error.

use std::env;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::{xxh3_64, xxh3_128};

/// First bytes of an entry; the hash of its origin and that of its code follow.
const MAGIC: &[u8; 8] = b"tdemknl2";

/// A folder of compiled kernels; without one, nothing is kept.
#[derive(Clone, Debug)]
pub(super) struct KernelCache {
    folder: Option<PathBuf>,
}

impl KernelCache {
    /// `TDEM_CACHE_DIR`, else `tdem` in the user's folder of caches.
    pub(super) fn of_the_user() -> Self {
        let variable = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let folder = variable("TDEM_CACHE_DIR")
            .or_else(|| variable("XDG_CACHE_HOME").map(|folder| folder.join("tdem")))
            .or_else(|| env::home_dir().map(|home| home.join(".cache").join("tdem")));
        KernelCache { folder }
    }
    #[cfg(test)]
    pub(super) fn at(folder: PathBuf) -> Self {
        KernelCache { folder: Some(folder) }
    }
    /// The code kept under what it was made from.
    pub(super) fn load(&self, origin: &[&str]) -> Option<Vec<u8>> {
        let (path, origin) = self.path(origin)?;
        let mut bytes = trusted(&path)?;
        let code = bytes.get(head(origin, &[]).len()..)?;
        let head = head(origin, code);
        bytes.starts_with(&head).then(|| bytes.split_off(head.len()))
    }
    /// Keeps `code`; readers see all of it or nothing.
    pub(super) fn store(&self, origin: &[&str], code: &[u8]) {
        let Some((path, origin)) = self.path(origin) else { return };
        let temporary = path.with_extension(format!("{}.tmp", std::process::id()));
        let write = || -> std::io::Result<()> {
            fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
            // A file that is new is no link to another.
            let _ = fs::remove_file(&temporary);
            let mut file = only_mine().open(&temporary)?;
            file.write_all(&head(origin, code))?;
            file.write_all(code)?;
            fs::rename(&temporary, &path)
        };
        if write().is_err() {
            // Nothing to be done about a folder that cannot be written: the kernels are compiled next time, too.
            let _ = fs::remove_file(&temporary);
        }
    }
    /// The file of an origin, and the hash of the origin.
    fn path(&self, origin: &[&str]) -> Option<(PathBuf, u128)> {
        let text: Vec<u8> = origin.iter().flat_map(|part| part.bytes().chain([0])).collect();
        let hash = xxh3_128(&text);
        Some((self.folder.as_ref()?.join(format!("{hash:032x}.cubin")), hash))
    }
}

/// What stands before the code in its file: an entry under the name of another is found out.
fn head(origin: u128, code: &[u8]) -> Vec<u8> {
    [&MAGIC[..], &origin.to_le_bytes(), &xxh3_64(code).to_le_bytes()].concat()
}

/// A new file that only this user can write, whatever others may do in its folder.
fn only_mine() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options
}

/// The bytes of a file of this user that no other user can write. Code is run, so that a link is not followed.
fn trusted(path: &Path) -> Option<Vec<u8>> {
    let named = fs::symlink_metadata(path).ok().filter(Metadata::is_file)?;
    let mut file = File::open(path).ok()?;
    if !is_mine(&named, &file.metadata().ok()?) {
        return None;
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// Whether the file that was opened is the one that was looked at before, and this user's alone. Where the system does not
/// tell who this user is, no file is.
#[cfg(unix)]
fn is_mine(named: &Metadata, opened: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    let same = (named.dev(), named.ino()) == (opened.dev(), opened.ino());
    let user = fs::metadata("/proc/self").ok().map(|process| process.uid());
    same && user == Some(opened.uid()) && opened.mode() & 0o022 == 0
}

/// Elsewhere folders of users belong to them.
#[cfg(not(unix))]
fn is_mine(_: &Metadata, _: &Metadata) -> bool {
    true
}
