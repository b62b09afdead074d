//! Pictures that a run writes as it goes on: `pictures/NAME-STEP.png`.
//!
//! The step is in the name, so that a run that goes on knows which of them to draw again, and nothing has to be counted.

use super::shaded::{CHUNK, Shaded, chunk};
use super::{Drawing, Options, Stamp};
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
        // Without a range, the colours are not known before the last picture of the series.
        let drawing = Drawing::of(state, plan, &self.options)?;
        let picture = drawing.png(&self.options, drawing.shaded.extent, self.options.range.is_none())?;
        atomically(&path, |unfinished| fs::write(unfinished, &picture).context(Action::Write, &path))?;
        Ok(path)
    }
}

/// Colours the pictures of a series anew, so that a colour is the same value in all of them: the range goes from the smallest
/// to the largest value of the series, and times have the unit of the last.
///
/// # Errors
/// Whatever the file system says. Pictures that do not carry their values are left as they are.
pub(crate) fn unify(run: &Path, series: &Series) -> Result<(), Error> {
    if series.options.range.is_some() {
        return Ok(());
    }
    let mut drawings = Vec::new();
    for stored in list(run)?.into_iter().filter(|stored| stored.name == series.name) {
        let bytes = fs::read(&stored.path).context(Action::Read, &stored.path)?;
        let time = super::told(&bytes, "time").and_then(|time| time.parse().ok());
        if let (Some(time), Some(shaded)) = (time, chunk(&bytes, CHUNK).and_then(Shaded::unpack)) {
            drawings.push((
                stored.path,
                bytes,
                Drawing { shaded, stamp: Stamp { step: stored.step, time, longest: None } },
            ));
        }
    }
    let ends = |pick: fn(f64, f64) -> f64, k: usize| {
        drawings.iter().map(|(_, _, drawing)| drawing.shaded.extent[k]).reduce(pick)
    };
    let (Some(low), Some(high)) = (ends(f64::min, 0), ends(f64::max, 1)) else { return Ok(()) };
    let longest = drawings.iter().map(|(_, _, drawing)| drawing.stamp.time).reduce(f64::max);
    for (path, bytes, mut drawing) in drawings {
        drawing.stamp.longest = longest;
        let fits = drawing.shaded.rows == series.options.height as usize
            && drawing.shaded.columns + super::beside(&series.options) == series.options.width as usize;
        if fits {
            let picture = drawing.png(&series.options, [low, high], true)?;
            if picture != bytes {
                atomically(&path, |unfinished| fs::write(unfinished, &picture).context(Action::Write, &path))?;
            }
        }
    }
    Ok(())
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
