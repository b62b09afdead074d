//! What a rung leaves on the disk, so that a ladder can go on: a run's folder with its case and its checkpoints, and what is
//! compared, instant by instant.

use super::compare::Sample;
use super::{Halt, Rung};
use std::fs;
use std::path::{Path, PathBuf};
use tdem_engine::State;
use tdem_results::{Action, Error, Event, Resumed, RunDirectory, columns, newest_step};

const CASE: &str = "case.toml";
const INSTANTS: &str = "instants";
const CLOCK: &str = "clock";
const ENDING: &str = "safetensors";

/// What becomes of rungs that are on the disk already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Earlier {
    /// They are in the way: [`Error::RunExists`].
    Refuse,
    /// They are removed.
    Remove,
    /// They go on, if they are of the same case: what is complete is read, what was stopped goes on at its last checkpoint.
    GoOn,
}

/// The folder of a rung, counted from 0.
#[must_use]
pub fn folder_of(ladder: &Path, rung: usize) -> PathBuf {
    ladder.join(format!("rung-{}", rung + 1))
}

/// Makes the folders of all rungs, before anything runs. Returns how many steps of each are there already.
///
/// # Errors
/// [`Halt::OtherCase`], [`Halt::Results`].
pub fn prepare(ladder: &Path, rungs: &[Rung], earlier: Earlier) -> Result<Vec<u64>, Halt> {
    let ready = |(index, rung): (usize, &Rung)| {
        let folder = folder_of(ladder, index);
        if earlier == Earlier::GoOn && folder.join(CASE).exists() {
            if !is_of(&folder, rung)? {
                return Err(Halt::OtherCase { label: rung.label.clone(), folder });
            }
            return Ok(newest_step(&folder)?.unwrap_or(0).min(rung.built.schedule.steps));
        }
        begin(&folder, rung, earlier == Earlier::Remove)?;
        Ok(0)
    };
    rungs.iter().enumerate().map(ready).collect()
}

/// Whether a folder is of this rung, to the letter.
fn is_of(folder: &Path, rung: &Rung) -> Result<bool, Error> {
    let path = folder.join(CASE);
    let there = fs::read_to_string(&path).map_err(|source| Error::Io { action: Action::Read, source, path })?;
    Ok(there == rung.case_toml)
}

/// Begins a rung anew.
fn begin(folder: &Path, rung: &Rung, overwrite: bool) -> Result<RunDirectory, Error> {
    let instants = folder.join(INSTANTS);
    if overwrite && folder.join(CASE).exists() && instants.exists() {
        fs::remove_dir_all(&instants).map_err(|source| Error::Io {
            action: Action::Remove,
            source,
            path: instants.clone(),
        })?;
    }
    let directory = RunDirectory::create(folder, &rung.case_toml, overwrite)?;
    fs::create_dir_all(&instants).map_err(|source| Error::Io {
        action: Action::CreateFolder,
        source,
        path: instants,
    })?;
    Ok(directory)
}

/// How far a rung got before.
pub(super) struct Reached {
    pub(super) state: State,
    /// Of all instants until then.
    pub(super) samples: Vec<Sample>,
    /// Time on the clock, s.
    pub(super) clock_secs: f64,
}

/// The folder of a rung that runs.
pub(super) struct Record {
    directory: RunDirectory,
}

impl Record {
    /// Opens the folder of a rung, which [`prepare`] made, and looks how far it got. Where anything is missing or damaged that
    /// its instants need, it begins anew.
    pub(super) fn open(folder: &Path, rung: &Rung, targets: &[u64]) -> Result<(Self, Option<Reached>), Halt> {
        if !is_of(folder, rung)? {
            return Err(Halt::OtherCase { label: rung.label.clone(), folder: folder.into() });
        }
        let opened = RunDirectory::open(folder);
        if let Err(Error::NoCheckpoint { .. }) = opened {
            return Ok((Record { directory: begin(folder, rung, true)? }, None));
        }
        let Resumed { directory, state, .. } = opened?;
        let record = Record { directory };
        let Some(state) = state else { return Ok((record, None)) };
        let last = targets.last().copied().unwrap_or(0);
        let passed = targets.iter().take_while(|&&target| target <= state.step);
        let samples: Option<Vec<Sample>> = passed.map(|&target| record.sample(target)).collect();
        match samples {
            Some(samples) if state.step <= last => {
                let clock_secs = record.clock_secs(state.step);
                Ok((record, Some(Reached { state, samples, clock_secs })))
            }
            _ => {
                drop(record);
                Ok((Record { directory: begin(folder, rung, true)? }, None))
            }
        }
    }

    fn instant(&self, step: u64) -> PathBuf {
        self.directory.path().join(INSTANTS).join(format!("{step:012}.{ENDING}"))
    }

    fn sample(&self, step: u64) -> Option<Sample> {
        let names = ["temperature", "mean_stress", "kinetic_over_elastic"];
        let [temperature, stress, kinetic] = columns::read(&self.instant(step), names).ok()?;
        Some(Sample { temperature, stress, kinetic_over_elastic: kinetic.first().copied() })
    }

    /// Keeps what is compared of an instant. The checkpoint of its step comes after, so that it is there whenever a rung goes
    /// on behind it.
    pub(super) fn keep(&self, step: u64, sample: &Sample) -> Result<(), Error> {
        let kinetic = sample.kinetic_over_elastic.map_or(Vec::new(), |ratio| vec![ratio]);
        let [temperature, stress] = [&sample.temperature, &sample.stress];
        let columns: [(&str, &[f64]); 3] =
            [("temperature", temperature), ("mean_stress", stress), ("kinetic_over_elastic", &kinetic)];
        columns::write(&self.instant(step), &columns)
    }

    /// Writes a checkpoint, and how long the rung has taken until then.
    pub(super) fn checkpoint(&mut self, state: &State, clock_secs: f64) -> Result<(), Error> {
        columns::write(&self.clock(), &[("step", &[state.step as f64]), ("seconds", &[clock_secs])])?;
        self.directory.checkpoint(state)
    }

    /// Tells the log why the rung could not go on.
    pub(super) fn log(&self, why: &str) -> Result<(), Error> {
        self.directory.log(&Event::Failed(why.to_owned()))
    }

    fn clock(&self) -> PathBuf {
        self.directory.path().join(format!("{CLOCK}.{ENDING}"))
    }

    /// Only a courtesy: where it is lost, the clock begins at 0.
    fn clock_secs(&self, step: u64) -> f64 {
        let read = columns::read(&self.clock(), ["step", "seconds"]).ok();
        read.filter(|[at, _]| at.first().is_some_and(|&at| at >= step as f64))
            .and_then(|[_, seconds]| seconds.first().copied())
            .unwrap_or(0.0)
    }
}
