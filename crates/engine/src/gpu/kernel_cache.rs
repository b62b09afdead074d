//! Compiled kernels on disk: a damaged, foreign or unreadable entry is as good as none, and no failure is an error.

use std::env;
use std::fs;
use std::path::PathBuf;
use xxhash_rust::xxh3::{xxh3_64, xxh3_128};

/// First bytes of an entry.
const MAGIC: &[u8; 8] = b"tdemknl1";

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
        let mut bytes = fs::read(self.path(origin)?).ok()?;
        let (head, code) = bytes.split_at_checked(16)?;
        (head[..8] == *MAGIC && head[8..] == xxh3_64(code).to_le_bytes()).then(|| bytes.split_off(16))
    }
    /// Keeps `code`; readers see all of it or nothing.
    pub(super) fn store(&self, origin: &[&str], code: &[u8]) {
        let Some(path) = self.path(origin) else { return };
        let temporary = path.with_extension(format!("{}.tmp", std::process::id()));
        let bytes = [MAGIC, &xxh3_64(code).to_le_bytes()[..], code].concat();
        let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
        if folder.and_then(|()| fs::write(&temporary, bytes)).and_then(|()| fs::rename(&temporary, &path)).is_err() {
            // Nothing to be done about a folder that cannot be written: the kernels are compiled next time, too.
            let _ = fs::remove_file(&temporary);
        }
    }
    fn path(&self, origin: &[&str]) -> Option<PathBuf> {
        let text: Vec<u8> = origin.iter().flat_map(|part| part.bytes().chain([0])).collect();
        Some(self.folder.as_ref()?.join(format!("{:032x}.cubin", xxh3_128(&text))))
    }
}
