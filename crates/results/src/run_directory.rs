//! The folder of a run: what is in it, and how it stays whole.
//!
//! The order of writing makes every moment a good one to die at. Frames and rows of a step come before its
//! checkpoint, and all three are on the disk before the next begins; a checkpoint is therefore never ahead of the
//! results. Opening a run throws away what came after the last good checkpoint, and computes it again.

use crate::blocks::{Contents, Scene, Start};
use crate::checkpoint::{self, Damaged};
use crate::curve;
use crate::error::{Action, Context, Error, FrameDamage};
use crate::files::{self, Seal};
use crate::frame_list::{self, Listed};
use crate::history::{self, History, HistoryDamage, Row};
use crate::lock::{self, Lock};
use crate::log::{self, Event};
use crate::picture::{self, Series};
use crate::start;
use crate::vtkhdf::about::{About, Names};
use crate::vtkhdf::frame::{Frame, Moment};
use crate::vtkhdf::master::{self, Numbers, Shown};
use crate::writer::Wanted;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tdem_engine::{Plan, State};

pub(crate) const CASE: &str = "case.toml";
pub(crate) const HISTORY: &str = "history.csv";
pub(crate) const FRAMES: &str = "frames";
pub(crate) const CHECKPOINTS: &str = "checkpoints";
pub(crate) const PICTURES: &str = "pictures";
pub(crate) const REPORT: &str = "report.html";
/// The case that ran, in the folder of checkpoints: what `case.toml` was before anybody edited it.
const CASE_THAT_RAN: &str = "case.toml";
const FRAME_ENDING: &str = "vtkhdf";

/// A master takes about 0.1 s at 600 frames, so it is not rewritten for every frame.
const MASTER_INTERVAL: Duration = Duration::from_secs(4);

/// Frames of a run that ends are copied into its masters if they take no more than this, bytes: such a run is soon packed, and
/// most users send such a file as it is.
const PACKED_AT_THE_END: u64 = 1_000_000_000;

/// The folder of a run, held by this process until dropped.
#[derive(Debug)]
pub struct RunDirectory {
    path: PathBuf,
    contents: Contents,
    names: Names,
    series: Vec<Series>,
    frames: Vec<Frame>,
    /// The frames in `frames.csv`, damaged ones too.
    listed: Vec<Listed>,
    /// Names of frames that masters do not show.
    left_out: Vec<String>,
    next_frame: u64,
    history: History,
    start: Origin,
    last_checkpoint: Option<u64>,
    masters_written: Instant,
    masters: Masters,
    _lock: Lock,
}

/// What masters are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Masters {
    /// Those of other frames, or none.
    Stale,
    /// Small ones that need the frames.
    Index,
    /// Such that hold the numbers themselves.
    Complete,
}

/// Where displacements count from.
#[derive(Debug)]
enum Origin {
    /// Nobody needed it so far; where a run goes on, it is there.
    NotSought,
    /// The file and the first checkpoint are damaged or gone: displacements are no longer known.
    Lost,
    Known(Start),
}

/// A run that was taken up again.
#[derive(Debug)]
pub struct Resumed {
    /// Its folder.
    pub directory: RunDirectory,
    /// The state of the newest checkpoint that is whole; `None` if the run died before its first, and has to begin
    /// from `case.toml`.
    pub state: Option<State>,
    /// Newer checkpoints that were passed over.
    pub damaged: Vec<Damaged>,
    /// Frames that are damaged, gone or cannot be read, and what is wrong with their list. They stay where they are, but the
    /// masters do not show them.
    pub unreadable_frames: Vec<Error>,
    /// Why displacements are not known any more, if they are not: from now on, they are not a number.
    pub start_lost: Option<Damaged>,
    /// What was wrong with the history.
    pub history: HistoryDamage,
}

/// The case that a run kept of what ran, whatever became of its `case.toml` since; `None` if it kept none, as older versions.
///
/// # Errors
/// If it cannot be read.
pub fn case_that_ran(run: &Path) -> Result<Option<String>, Error> {
    let path = run.join(CHECKPOINTS).join(CASE_THAT_RAN);
    match fs::read(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        // What is no text is no case either, and found out when it is read.
        read => read.map(|text| Some(String::from_utf8_lossy(&text).into_owned())).context(Action::Read, &path),
    }
}

impl RunDirectory {
    /// Begins a run in a folder, which is made if need be. `overwrite` removes an old run there, and nothing else.
    ///
    /// # Errors
    /// [`Error::RunExists`], [`Error::Occupied`], [`Error::Locked`], and whatever the file system says.
    pub fn create(path: &Path, case_toml: &str, overwrite: bool) -> Result<Self, Error> {
        fs::create_dir_all(path).context(Action::CreateFolder, path)?;
        check_free(path, overwrite)?;
        let lock = Lock::take(path)?;
        // Another process may have begun a run, and ended, between the first look and the lock.
        check_free(path, overwrite)?;
        // Checkpoints go first: should this process die on the way, the old run can no longer be resumed from a
        // state to which its other files do not belong.
        for folder in [CHECKPOINTS, FRAMES, PICTURES] {
            files::remove_folder(&path.join(folder))?;
        }
        for file in [HISTORY, REPORT, log::FILE, frame_list::FILE, start::FILE] {
            files::remove(&path.join(file))?;
        }
        remove_masters(path)?;
        remove_curves(path)?;
        history::remove_aside(path)?;
        files::remove_unfinished(path)?;
        let case = path.join(CASE);
        files::atomically(&case, |unfinished| fs::write(unfinished, case_toml).context(Action::Write, &case))?;
        for folder in [FRAMES, CHECKPOINTS] {
            files::make_folder(&path.join(folder))?;
        }
        frame_list::write(path, &[])?;
        keep_case(path, case_toml)?;
        let history = History::create(path)?;
        log::append(path, &Event::Created)?;
        Ok(RunDirectory::assemble(path, Stored::default(), history, None, lock))
    }

    /// Takes a run up at its newest checkpoint that is whole. What came later is removed, masters are rewritten.
    ///
    /// # Errors
    /// [`Error::NotARun`], [`Error::Locked`], [`Error::NoCheckpoint`] if checkpoints exist but all are damaged, and
    /// whatever the file system says.
    pub fn open(path: &Path) -> Result<Resumed, Error> {
        if !path.join(CASE).exists() {
            return Err(Error::NotARun { path: path.into() });
        }
        let lock = Lock::take(path)?;
        let (frames, checkpoints) = (path.join(FRAMES), path.join(CHECKPOINTS));
        for folder in [&frames, &checkpoints] {
            files::make_folder(folder)?;
        }
        files::refuse_link(&path.join(PICTURES))?;
        for folder in [path, &frames, &checkpoints, &path.join(PICTURES)] {
            files::remove_unfinished(folder)?;
        }

        let checkpoint::Newest { state, damaged, .. } = checkpoint::newest(&checkpoints)?;
        if state.is_none() && (!damaged.is_empty() || has_results(path)?) {
            return Err(Error::NoCheckpoint { damaged: damaged.len(), path: path.into() });
        }
        let step = state.as_ref().map(|state| state.step);
        let (history, history_damage) = match step {
            Some(step) => History::open(path, step)?,
            None => (History::create(path)?, HistoryDamage::default()),
        };
        let mut frames = keep_frames(path, step)?;
        picture::keep(path, step)?;
        // A damaged checkpoint stays for whoever wants to look at it, under a name that no run goes on from.
        for Damaged { path, .. } in &damaged {
            let aside = path.with_extension("damaged");
            fs::rename(path, &aside).context(Action::Rename, path)?;
        }
        log::append(path, &step.map_or(Event::BeganAgain, |step| Event::Resumed { step }))?;
        for damaged in &damaged {
            log::append(path, &Event::Warning(damaged.to_string()))?;
        }
        for unreadable in &frames.damaged {
            log::append(path, &Event::Warning(unreadable.to_string()))?;
        }
        for told in history_damage.told() {
            log::append(path, &Event::Warning(told))?;
        }
        let start_lost = if step.is_some() { recover_start(path)? } else { None };
        if let Some(lost) = &start_lost {
            log::append(path, &Event::Warning(format!("displacements are not known any more, {lost}")))?;
        }

        let unreadable_frames = std::mem::take(&mut frames.damaged);
        let mut directory = RunDirectory::assemble(path, frames, history, step, lock);
        if start_lost.is_some() {
            directory.start = Origin::Lost;
        }
        // A run that was finished stays as it can be sent, until it has more frames.
        let complete = master::are_complete(path, directory.shown());
        directory.masters = if complete { Masters::Complete } else { Masters::Stale };
        directory.publish()?;
        Ok(Resumed { directory, state, damaged, unreadable_frames, start_lost, history: history_damage })
    }

    fn assemble(path: &Path, stored: Stored, history: History, last_checkpoint: Option<u64>, lock: Lock) -> Self {
        RunDirectory {
            path: path.into(),
            contents: Contents::default(),
            names: Names::default(),
            series: Vec::new(),
            next_frame: stored.next,
            frames: stored.frames,
            listed: stored.listed,
            left_out: stored.left_out,
            history,
            start: Origin::NotSought,
            last_checkpoint,
            masters_written: Instant::now(),
            masters: Masters::Index,
            _lock: lock,
        }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The case as run.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn case_toml(&self) -> Result<String, Error> {
        let path = self.path.join(CASE);
        fs::read_to_string(&path).context(Action::Read, &path)
    }

    /// From now on the present `case.toml` is the case that ran.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn accept_case(&self) -> Result<(), Error> {
        keep_case(&self.path, &self.case_toml()?)
    }

    /// Decides what frames hold from now on.
    pub fn set_contents(&mut self, contents: Contents) {
        self.contents = contents;
    }

    /// Decides which names frames tell from now on.
    pub fn set_names(&mut self, names: Names) {
        self.names = names;
    }

    /// Decides which pictures are drawn from now on.
    pub fn set_pictures(&mut self, series: Vec<Series>) {
        self.series = series;
    }

    /// Step of the newest checkpoint that is whole.
    #[must_use]
    pub fn last_checkpoint(&self) -> Option<u64> {
        self.last_checkpoint
    }

    /// Step of the last frame.
    #[must_use]
    pub fn last_frame(&self) -> Option<u64> {
        self.frames.last().map(|frame| frame.step)
    }

    /// Step of the last row of the history.
    #[must_use]
    pub fn last_row(&self) -> Option<u64> {
        self.history.last_step()
    }

    /// Writes a checkpoint. Those between the first and the last two are removed.
    ///
    /// # Errors
    /// Whatever the file system says; older checkpoints are then still there.
    pub fn checkpoint(&mut self, state: &State) -> Result<(), Error> {
        if self.last_checkpoint.is_none() {
            start::write(&self.path, state)?;
        }
        // Frames are on the disk since they were written; rows must be, before a checkpoint that counts on them.
        self.history.sync()?;
        frame_list::sync(&self.path)?;
        let folder = self.path.join(CHECKPOINTS);
        checkpoint::write(&folder, state)?;
        self.last_checkpoint = Some(state.step);
        checkpoint::thin_out(&folder)
    }

    /// Writes a frame, and now and then the masters. A step that has its frame already gets no other.
    ///
    /// # Errors
    /// Whatever the file system says; older frames are then still there.
    pub fn frame(&mut self, state: &State, plan: &Plan) -> Result<(), Error> {
        if self.last_frame().is_some_and(|last| last >= state.step) {
            return Ok(());
        }
        if matches!(self.start, Origin::NotSought) {
            self.start = self.find_start(state, plan)?;
        }
        let start = if let Origin::Known(start) = &self.start { Some(start) } else { None };
        let scene = Scene { state, plan, start };
        let (step, time) = (state.step, plan.time(state.step));
        // One that was lost takes its place again.
        let lost = self.listed.iter().position(|listed| listed.step == step);
        let number = lost.map_or(self.next_frame, |place| self.listed[place].number);
        let blocks = scene.blocks(self.contents);
        let heat_time = plan.heat.as_ref().map(|_| plan.heat_time(state.step));
        let about = About { heat_time, names: self.names.clone() };
        let moment = Moment { step, time, about };
        let (frame, seal) = Frame::write(&self.path, frame_name(number), moment, &blocks, self.contents.compression)?;
        let listed = Listed { number, step, time, seal };
        self.frames.push(frame);
        self.masters = Masters::Stale;
        if let Some(place) = lost {
            self.listed[place] = listed;
            self.left_out.retain(|file| *file != frame_name(number));
            frame_list::write(&self.path, &self.listed)?;
        } else {
            self.listed.push(listed);
            self.next_frame += 1;
            frame_list::append(&self.path, &self.listed)?;
        }
        if self.frames.len() == 1 || self.masters_written.elapsed() >= MASTER_INTERVAL {
            self.publish()?;
        }
        Ok(())
    }

    /// Displacements count from where the run began, so that a resumed run goes on counting from the same place.
    fn find_start(&self, state: &State, plan: &Plan) -> Result<Origin, Error> {
        if self.last_checkpoint.is_none() {
            start::write(&self.path, state)?;
            return Ok(Origin::Known(Start::of(state, plan)));
        }
        match start::read(&self.path) {
            Ok(first) => Ok(Origin::Known(Start::of(&first, plan))),
            Err(damage) => {
                let lost = Damaged { damage, path: start::path_of(&self.path) };
                self.log(&Event::Warning(format!("displacements are not known any more, {lost}")))?;
                Ok(Origin::Lost)
            }
        }
    }

    /// Draws all series of pictures. What is there already is drawn again, to the same bytes.
    ///
    /// # Errors
    /// Whatever the file system says; older pictures are then still there.
    pub fn pictures(&mut self, state: &State, plan: &Plan) -> Result<(), Error> {
        self.series.iter().try_for_each(|series| series.write(&self.path, state, plan).map(drop))
    }

    /// Gives all pictures of a series the same colours for the same values.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn unify_pictures(&self) -> Result<(), Error> {
        self.series.iter().try_for_each(|series| picture::unify(&self.path, series))
    }

    /// Adds a row to the history. A step that has its row already gets no other.
    ///
    /// # Errors
    /// Whatever the file system says; the row is then not there at all.
    pub fn row(&mut self, row: &Row) -> Result<(), Error> {
        if self.last_row().is_some_and(|last| last >= row.step) { Ok(()) } else { self.history.append(row) }
    }

    /// Removes the last frame, the last row and the last pictures if they are of this step: the end of a run gets them, also
    /// where the schedule asks for none, and a run that goes on must look as if it had never ended.
    pub(crate) fn forget_end(&mut self, step: u64, Wanted { frame, row, pictures, .. }: Wanted) -> Result<(), Error> {
        if pictures {
            for series in &self.series {
                files::remove(&picture::file_of(&self.path, &series.name, step))?;
            }
        }
        if frame && let Some(place) = self.listed.iter().position(|listed| listed.step == step) {
            let Listed { number, .. } = self.listed.remove(place);
            // Masters first: they must never name a frame that is not there.
            self.frames.pop_if(|last| last.step == step);
            self.left_out.retain(|file| *file != frame_name(number));
            self.masters = Masters::Stale;
            self.publish()?;
            frame_list::write(&self.path, &self.listed)?;
            files::remove(&self.path.join(frame_name(number)))?;
            self.next_frame = number;
        }
        if row && self.last_row() == Some(step) {
            self.history = History::open(&self.path, step.saturating_sub(1))?.0;
        }
        Ok(())
    }

    /// Brings the masters up to date, if they are not.
    ///
    /// # Errors
    /// Whatever the file system says; the old masters are then still there.
    pub fn publish(&mut self) -> Result<(), Error> {
        if self.masters == Masters::Stale {
            let written = master::write(&self.path, &self.path, self.shown(), Numbers::InFrames)?;
            if written.is_empty() {
                remove_masters(&self.path)?;
            }
            self.masters = Masters::Index;
            self.masters_written = Instant::now();
        }
        Ok(())
    }

    /// Brings the masters up to date at the end of a run. Those of a run that is not large then hold all numbers themselves,
    /// and can be sent; where there is no room for them, they stay as they are, and the log says so.
    ///
    /// # Errors
    /// Whatever the file system says; the old masters are then still there.
    pub fn finish(&mut self) -> Result<(), Error> {
        self.publish()?;
        let bytes: u64 = self.listed.iter().map(|listed| listed.seal.bytes).sum();
        if self.masters == Masters::Complete || self.frames.is_empty() || bytes > PACKED_AT_THE_END {
            return Ok(());
        }
        let numbers = Numbers::Copied(self.contents.compression);
        match master::write(&self.path, &self.path, self.shown(), numbers) {
            Ok(_) => self.masters = Masters::Complete,
            Err(error) => self.log(&Event::Warning(format!("frames are not copied into one file, {error}")))?,
        }
        Ok(())
    }

    fn shown(&self) -> Shown<'_> {
        shown(&self.frames, &self.listed, &self.left_out)
    }

    /// Adds a line to `log.txt`.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub fn log(&self, event: &Event) -> Result<(), Error> {
        log::append(&self.path, event)
    }
}

/// Writes the masters of a run that lacks some: its process died before it could. A run at which a process is writes its own.
/// Whether the run was free.
///
/// # Errors
/// Whatever the file system says.
pub fn restore_masters(run: &Path) -> Result<bool, Error> {
    let Ok(_lock) = Lock::take(run) else { return Ok(false) };
    let stored = stored_frames(run)?;
    let there = |name: &String| run.join(name).with_extension(FRAME_ENDING).exists();
    if !master::block_names(&stored.frames).iter().all(there) {
        master::write(run, run, stored.shown(), Numbers::InFrames)?;
    }
    Ok(true)
}

/// Whether a run has what comes after its first checkpoint only: a frame, or a second row.
fn has_results(run: &Path) -> Result<bool, Error> {
    // A history that is not there has no rows.
    let history = fs::read(run.join(HISTORY)).unwrap_or_default();
    Ok(!frame_numbers(run)?.is_empty() || history.split_inclusive(|&byte| byte == b'\n').count() > 2)
}

fn keep_case(run: &Path, text: &str) -> Result<(), Error> {
    let path = run.join(CHECKPOINTS).join(CASE_THAT_RAN);
    files::atomically(&path, |unfinished| fs::write(unfinished, text).context(Action::Write, &path))
}

/// Where a frame is, relative to the run.
fn frame_name(number: u64) -> String {
    format!("{FRAMES}/{number:06}.{FRAME_ENDING}")
}

fn number_of(frame: &Path) -> Option<u64> {
    frame.file_stem()?.to_str()?.parse().ok()
}

/// The frames that a run has on the disk.
#[derive(Default)]
pub(crate) struct Stored {
    /// Ascending.
    pub(crate) frames: Vec<Frame>,
    /// What is wrong with frames that are not among these, and with the list.
    pub(crate) damaged: Vec<Error>,
    /// The list, ascending.
    listed: Vec<Listed>,
    /// Names of frames that are damaged or gone.
    left_out: Vec<String>,
    /// Numbers of frames that are not wanted.
    superfluous: Vec<u64>,
    /// Number of the next frame.
    next: u64,
}

impl Stored {
    pub(crate) fn shown(&self) -> Shown<'_> {
        shown(&self.frames, &self.listed, &self.left_out)
    }
}

fn shown<'a>(frames: &'a [Frame], listed: &[Listed], left_out: &'a [String]) -> Shown<'a> {
    let steps: BTreeSet<u64> = frames.iter().map(|frame| frame.step).collect();
    let hash = frame_list::hash_of(listed.iter().filter(|listed| steps.contains(&listed.step)).copied());
    Shown { frames, left_out, hash }
}

/// Looks at the frames of a run: all of them are read from the first byte to the last.
pub(crate) fn stored_frames(run: &Path) -> Result<Stored, Error> {
    look_at_frames(run, |_| true)
}

/// Looks at those frames of a run whose steps are wanted, as far as steps are known.
fn look_at_frames(run: &Path, wanted: impl Fn(u64) -> bool) -> Result<Stored, Error> {
    // The list first: a run that goes on may write a frame meanwhile.
    let list = frame_list::read(run)?;
    let there: BTreeSet<u64> = frame_numbers(run)?.into_iter().collect();
    let last_listed = list.frames.last().map(|last| last.number);
    let unlisted = there.iter().filter(|&&number| last_listed.is_none_or(|last| number > last)).count();
    let mut candidates: BTreeMap<u64, Option<Listed>> = there.iter().map(|&number| (number, None)).collect();
    candidates.extend(list.frames.iter().map(|listed| (listed.number, Some(*listed))));
    let (candidates, later): (Vec<(u64, Option<Listed>)>, Vec<_>) =
        candidates.into_iter().partition(|(_, listed)| listed.is_none_or(|listed| wanted(listed.step)));

    let looked_at: Vec<_> = candidates
        .into_par_iter()
        .map(|(number, listed)| (number, listed, look_at(run, number, listed, there.contains(&number))))
        .collect();
    let mut stored = Stored {
        damaged: list.damage(run, unlisted).into_iter().collect(),
        superfluous: later.into_iter().map(|(number, _)| number).collect(),
        ..Stored::default()
    };
    for (number, listed, frame) in looked_at {
        let follows = |frame: &Frame| stored.frames.last().is_none_or(|last| last.step < frame.step);
        let out_of_order =
            |step| Error::Frame { damage: FrameDamage::Order { step }, path: run.join(frame_name(number)) };
        let frame = frame.and_then(
            |(frame, listed)| {
                if follows(&frame) { Ok((frame, listed)) } else { Err(out_of_order(frame.step)) }
            },
        );
        match frame {
            Ok((frame, _)) if !wanted(frame.step) => {
                stored.superfluous.push(number);
                continue;
            }
            Ok((frame, listed)) => {
                stored.frames.push(frame);
                stored.listed.push(listed);
            }
            Err(error) => {
                stored.damaged.push(error);
                stored.left_out.push(frame_name(number));
                stored.listed.extend(listed);
            }
        }
        stored.next = number + 1;
    }
    Ok(stored)
}

/// Looks at a frame. One that is not in the list is taken as it is.
fn look_at(run: &Path, number: u64, listed: Option<Listed>, is_there: bool) -> Result<(Frame, Listed), Error> {
    let file = frame_name(number);
    let path = run.join(&file);
    let damaged = |damage| Err(Error::Frame { damage, path: path.clone() });
    if let Some(Listed { step, .. }) = listed.filter(|_| !is_there) {
        return damaged(FrameDamage::Gone { step });
    }
    let seal = Seal::of(&path).context(Action::Read, &path)?;
    if let Some(Listed { step, seal: expected, .. }) = listed.filter(|listed| listed.seal != seal) {
        let (bytes, expected) = (seal.bytes, expected.bytes);
        let changed = FrameDamage::Changed { step };
        return damaged(if bytes == expected { changed } else { FrameDamage::Length { step, bytes, expected } });
    }
    let frame = Frame::read(run, file)?;
    let listed = Listed { number, step: frame.step, time: frame.time, seal };
    Ok((frame, listed))
}

fn frame_numbers(run: &Path) -> Result<Vec<u64>, Error> {
    let mut numbers: Vec<u64> =
        files::with_ending(&run.join(FRAMES), FRAME_ENDING)?.iter().filter_map(|path| number_of(path)).collect();
    numbers.sort_unstable();
    Ok(numbers)
}

/// Removes frames after a step, or all of them, and returns those that stay. Their list is written anew.
fn keep_frames(run: &Path, step: Option<u64>) -> Result<Stored, Error> {
    let mut stored = match step {
        Some(step) => look_at_frames(run, |of_frame| of_frame <= step)?,
        None => Stored { superfluous: frame_numbers(run)?, ..Stored::default() },
    };
    let superfluous = std::mem::take(&mut stored.superfluous);
    if !superfluous.is_empty() {
        // Masters of a dead process may name frames that go now; until they are rewritten, no master is better.
        remove_masters(run)?;
        superfluous.into_iter().rev().try_for_each(|number| files::remove(&run.join(frame_name(number))))?;
        files::sync_folder(&run.join(FRAMES))?;
    }
    frame_list::write(run, &stored.listed)?;
    Ok(stored)
}

/// Sees to it that the places of the start are there, from the first checkpoint if need be. What is wrong with both, if there is
/// no way back.
fn recover_start(run: &Path) -> Result<Option<Damaged>, Error> {
    let Err(damage) = start::read(run) else { return Ok(None) };
    match checkpoint::read(&checkpoint::path_of(&run.join(CHECKPOINTS), 0)) {
        Ok(first) => start::write(run, &first).map(|()| None),
        Err(_) => Ok(Some(Damaged { damage, path: start::path_of(run) })),
    }
}

/// The masters in the folder of a run, by name.
pub(crate) fn masters(run: &Path) -> Result<Vec<PathBuf>, Error> {
    files::with_ending(run, FRAME_ENDING)
}

fn remove_masters(run: &Path) -> Result<(), Error> {
    masters(run)?.iter().try_for_each(|path| files::remove(path))
}

fn remove_curves(run: &Path) -> Result<(), Error> {
    let name = |path: &Path| path.file_name().and_then(|name| name.to_str()).map(str::to_owned).unwrap_or_default();
    let ours = files::with_ending(run, curve::ENDING)?.into_iter().filter(|path| name(path).starts_with(curve::PREFIX));
    ours.into_iter().try_for_each(|path| files::remove(&path))
}

/// Refuses to begin a run over another, or among files that are not a run's.
fn check_free(path: &Path, overwrite: bool) -> Result<(), Error> {
    if path.join(CASE).exists() {
        return if overwrite { Ok(()) } else { Err(Error::RunExists { path: path.into() }) };
    }
    let ours = |entry: &PathBuf| files::is_unfinished(entry) || entry.ends_with(lock::FILE);
    if files::entries(path)?.iter().all(ours) { Ok(()) } else { Err(Error::Occupied { path: path.into() }) }
}
