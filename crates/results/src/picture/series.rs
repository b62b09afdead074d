//! Pictures that a run writes as it goes on: `pictures/NAME-STEP.png`.
//!
//! The step is in the name, so that a run that goes on knows which of them to draw again, and nothing has to be counted.

use super::{Options, render};
use crate::error::{Action, Context, Error};
use crate::files::{self, atomically};
use crate::run_directory::PICTURES;
use std::fs;
use std::path::{Path, PathBuf};
use tdem_engine::{Plan, State};

const ENDING: &str = "png";
/// Digits of a step, as many as names of checkpoints have: names ascend with time.
const DIGITS: usize = 12;

/// Pictures of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// First part of the names of its files: letters, digits, `_` and `-`.
    pub name: String,
    /// What they look like.
    pub options: Options,
}

impl Series {
    /// Draws a state into the folder of a run.
    ///
    /// # Errors
    /// As [`render`], and whatever the file system says.
    pub(crate) fn write(&self, run: &Path, state: &State, plan: &Plan) -> Result<PathBuf, Error> {
        let path = file_of(run, &self.name, state.step);
        let folder = files::parent(&path);
        files::make_folder(folder)?;
        let picture = render(state, plan, &self.options)?;
        atomically(&path, |unfinished| fs::write(unfinished, &picture).context(Action::Write, &path))?;
        Ok(path)
    }
}

/// The file of a picture in the folder of a run.
#[must_use]
pub fn file_of(run: &Path, name: &str, step: u64) -> PathBuf {
    run.join(PICTURES).join(format!("{name}-{step:0DIGITS$}.{ENDING}"))
}

/// A picture on the disk.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Stored {
    pub(crate) name: String,
    pub(crate) step: u64,
    pub(crate) path: PathBuf,
}

/// A picture whose file has a name as [`file_of`] gives them.
pub(crate) fn stored(path: &Path) -> Option<Stored> {
    let (name, digits) = path.file_stem()?.to_str()?.rsplit_once('-')?;
    let ours = !name.is_empty() && digits.len() == DIGITS && path.extension()? == ENDING;
    ours.then_some(Stored { name: name.into(), step: digits.parse().ok()?, path: path.into() })
}

/// The pictures of a run, by name and ascending by step.
pub(crate) fn list(run: &Path) -> Result<Vec<Stored>, Error> {
    let files = files::with_ending(&run.join(PICTURES), ENDING)?;
    let mut all: Vec<Stored> = files.iter().filter_map(|path| stored(path)).collect();
    all.sort();
    Ok(all)
}

/// Removes pictures after a step, or all of them.
pub(crate) fn keep(run: &Path, step: Option<u64>) -> Result<(), Error> {
    list(run)?
        .iter()
        .filter(|picture| step.is_none_or(|step| picture.step > step))
        .try_for_each(|picture| files::remove(&picture.path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_series_and_step() {
        let path = file_of(Path::new("run"), "from-above", 1250);
        assert_eq!(path, Path::new("run/pictures/from-above-000000001250.png"));
        let found = stored(&path).expect("it is one of ours");
        assert_eq!((found.name.as_str(), found.step), ("from-above", 1250));
        for other in ["notes.png", "a-12.png", "-000000001250.png", "a-000000001250.jpg"] {
            assert_eq!(stored(Path::new(other)), None, "{other}");
        }
    }
}
