//! `report.html`: what became of a run, on one page that needs nothing but itself.
//!
//! The page is made of what lies in the folder of the run, so that it can be made at any time, also of a run that goes on or
//! that broke off. It loads nothing: style, script and pictures are in it. Without scripts all is there but zooming.

mod chart;
mod figures;
mod history;
mod html;
mod images;
mod page;
mod story;

pub(crate) use html::base64;

use crate::curve::Curve;
use crate::error::{Action, Context, Error};
use crate::files::atomically;
use crate::run_directory::{CASE, REPORT};
use std::fs;
use std::path::{Path, PathBuf};

/// What the folder of a run does not say in numbers, but its case does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Subject {
    /// What the case is about.
    pub title: String,
    /// Names and values of what should be known, such as the model.
    pub facts: Vec<(String, String)>,
    /// Curves that it asks for.
    pub curves: Vec<Curve>,
    /// Names of materials by their index.
    pub materials: Vec<String>,
    /// What is wrong with the case by now: the page is then made without the rest.
    pub problem: Option<String>,
}

/// Writes the page of a run, to `report.html` in its folder if nothing else is asked for, and returns its path.
///
/// # Errors
/// [`Error::NotARun`], and whatever the file system says. What is missing in the folder is missing in the page.
pub fn write(run: &Path, subject: &Subject, out: Option<&Path>) -> Result<PathBuf, Error> {
    if !run.join(CASE).exists() {
        return Err(Error::NotARun { path: run.into() });
    }
    let page = page::page(run, subject)?;
    let path = out.map_or_else(|| run.join(REPORT), Path::to_owned);
    atomically(&path, |unfinished| fs::write(unfinished, &page).context(Action::Write, &path))?;
    Ok(path)
}
