//! `frames.csv`: the frames that a run wrote, with length and hash of each, so that damage and deletion are noticed.

use crate::error::{Action, Context, Error, ListDamage};
use crate::files::{self, Seal, atomically};
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// Name of the list in a run.
pub(crate) const FILE: &str = "frames.csv";
const HEADER: &str = "frame,step,time,bytes,xxh3,line_xxh3\n";

/// A frame as it was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Listed {
    pub(crate) number: u64,
    pub(crate) step: u64,
    /// s.
    pub(crate) time: f64,
    pub(crate) seal: Seal,
}

impl Listed {
    /// A line, whose last column is a hash of the columns before.
    fn text(&self) -> String {
        let Listed { number, step, time, seal: Seal { bytes, hash } } = self;
        let columns = format!("{number},{step},{time:e},{bytes},{hash:032x}");
        let check = xxh3_64(columns.as_bytes());
        format!("{columns},{check:016x}\n")
    }

    fn read(line: &str) -> Option<Self> {
        let mut columns = line.split(',');
        let listed = Listed {
            number: columns.next()?.parse().ok()?,
            step: columns.next()?.parse().ok()?,
            time: columns.next()?.parse().ok()?,
            seal: Seal { bytes: columns.next()?.parse().ok()?, hash: u128::from_str_radix(columns.next()?, 16).ok()? },
        };
        // One number may be written in many ways, and only one of them was.
        (listed.text().trim_end() == line).then_some(listed)
    }
}

/// What the list of a run holds.
#[derive(Debug, Default)]
pub(crate) struct FrameList {
    /// Ascending.
    pub(crate) frames: Vec<Listed>,
    /// Numbers of lines that were changed.
    pub(crate) changed: Vec<usize>,
    /// Whether there is one.
    pub(crate) exists: bool,
}

fn path_of(run: &Path) -> PathBuf {
    run.join(FILE)
}

/// Reads the list of a run. A last line that is not complete is on its way, or its writer died: its frame is not listed.
pub(crate) fn read(run: &Path) -> Result<FrameList, Error> {
    let path = path_of(run);
    let bytes = match fs::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(FrameList::default()),
        Err(error) => return Err(Error::io(Action::Read, error, &path)),
    };
    let mut list = FrameList { exists: true, ..FrameList::default() };
    for (index, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let Some(line) = line.strip_suffix(b"\n") else { break };
        let follows = |listed: &Listed| list.frames.last().is_none_or(|last| last.number < listed.number);
        match std::str::from_utf8(line).ok().and_then(Listed::read).filter(follows) {
            Some(listed) => list.frames.push(listed),
            None if index == 0 && line == HEADER.trim_end().as_bytes() => {}
            None => list.changed.push(index + 1),
        }
    }
    Ok(list)
}

impl FrameList {
    /// What is wrong with it, if so many frames are on the disk that come after the last that it holds.
    pub(crate) fn damage(&self, run: &Path, unlisted: usize) -> Option<Error> {
        let damage = match (self.changed.as_slice(), unlisted) {
            (_, 1..) if !self.exists => ListDamage::Gone,
            (&[line, ref more @ ..], _) => ListDamage::Line { line, more: more.len() },
            // A writer that died may have left one.
            (_, frames @ 2..) => ListDamage::CutOff { frames },
            _ => return None,
        };
        Some(Error::FrameList { damage, path: path_of(run) })
    }
}

/// Writes a list over an old one, if there is one.
pub(crate) fn write(run: &Path, frames: &[Listed]) -> Result<(), Error> {
    let path = path_of(run);
    let text: String = std::iter::once(HEADER.to_owned()).chain(frames.iter().map(Listed::text)).collect();
    atomically(&path, |unfinished| fs::write(unfinished, &text).context(Action::Write, &path))
}

/// Adds the last of some frames to the list of a run, or all of them to one that is not there.
pub(crate) fn append(run: &Path, frames: &[Listed]) -> Result<(), Error> {
    let path = path_of(run);
    let Some(last) = frames.last() else { return Ok(()) };
    if !path.exists() {
        return write(run, frames);
    }
    let mut file = files::open(&path, OpenOptions::new().append(true), false, Action::Write)?;
    let length = file.metadata().context(Action::Write, &path)?.len();
    file.write_all(last.text().as_bytes()).map_err(|error| {
        // Part of the line may be there. The first error is the one to tell.
        let _ = file.set_len(length);
        Error::io(Action::Write, error, &path)
    })
}

/// Makes all lines survive a power cut.
pub(crate) fn sync(run: &Path) -> Result<(), Error> {
    let path = path_of(run);
    if !path.exists() {
        return Ok(());
    }
    let file = files::open(&path, OpenOptions::new().append(true), false, Action::Write)?;
    file.sync_all().context(Action::Write, &path)
}

/// A hash of all that frames hold.
pub(crate) fn hash_of(frames: impl Iterator<Item = Listed>) -> u128 {
    let text: String = frames.map(|listed| listed.text()).collect();
    xxhash_rust::xxh3::xxh3_128(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(number: u64) -> Listed {
        Listed { number, step: 10 * number, time: 0.1 * number as f64, seal: Seal { bytes: 7, hash: 1 << 100 } }
    }

    #[test]
    fn a_change_of_any_byte_of_the_list_is_found_and_costs_one_line() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &[listed(0), listed(1)]).unwrap();
        append(folder.path(), &[listed(1), listed(12)]).unwrap();
        let whole = fs::read(path_of(folder.path())).unwrap();
        let read = || read(folder.path()).unwrap();
        assert_eq!((read().frames, read().changed), (vec![listed(0), listed(1), listed(12)], vec![]));
        for place in 0..whole.len() {
            for bit in 0..8 {
                let mut bad = whole.clone();
                bad[place] ^= 1 << bit;
                fs::write(path_of(folder.path()), &bad).unwrap();
                let list = read();
                // A line that ends elsewhere takes the next with it, or is not complete any more.
                let cut_off = place + 1 == whole.len();
                assert!(cut_off || !list.changed.is_empty(), "byte {place}, bit {bit}");
                assert!(list.frames.len() + 2 >= 3, "byte {place}, bit {bit}: {list:?}");
                assert!(list.frames.iter().all(|found| [listed(0), listed(1), listed(12)].contains(found)));
            }
        }
    }

    #[test]
    fn a_torn_last_line_is_not_listed() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &[listed(0), listed(1)]).unwrap();
        let whole = fs::read(path_of(folder.path())).unwrap();
        let line = listed(1).text().len();
        for length in whole.len() - line..whole.len() {
            fs::write(path_of(folder.path()), &whole[..length]).unwrap();
            let list = read(folder.path()).unwrap();
            assert_eq!((list.frames, list.changed), (vec![listed(0)], vec![]), "{length}");
        }
    }

    #[test]
    fn a_list_that_lacks_frames_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let damage = |list: &FrameList, unlisted| match list.damage(folder.path(), unlisted) {
            Some(Error::FrameList { damage, .. }) => Some(damage),
            _ => None,
        };
        let gone = FrameList::default();
        assert_eq!((damage(&gone, 0), damage(&gone, 1)), (None, Some(ListDamage::Gone)));
        let whole = FrameList { exists: true, ..FrameList::default() };
        assert_eq!((damage(&whole, 1), damage(&whole, 2)), (None, Some(ListDamage::CutOff { frames: 2 })));
        let changed = FrameList { changed: vec![3, 5], ..whole };
        assert_eq!(damage(&changed, 0), Some(ListDamage::Line { line: 3, more: 1 }));
    }
}
