//! The folder of a run: what is in it, and how it stays whole.
//!
//! The order of writing makes every moment a good one to die at. Frames and rows of a step come before its
//! checkpoint, and all three are on the disk before the next begins; a checkpoint is therefore never ahead of the
//! results. Opening a run throws away what came after the last good checkpoint, and computes it again.

use crate::blocks::{Contents, Scene, Start};
use crate::checkpoint::{self, Damaged};
use crate::curve;
use crate::error::{Action, Context, Error};
use crate::files;
use crate::history::{self, History, HistoryDamage, Row};
use crate::lock::{self, Lock};
use crate::log::{self, Event};
use crate::picture::{self, Series};
use crate::vtkhdf::frame::Frame;
use crate::vtkhdf::master::{self, Numbers};
use crate::writer::Wanted;
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

/// The folder of a run, held by this process until dropped.
#[derive(Debug)]
pub struct RunDirectory {
    path: PathBuf,
    contents: Contents,
    series: Vec<Series>,
    frames: Vec<Frame>,
    next_frame: u64,
    history: History,
    start: Origin,
    last_checkpoint: Option<u64>,
    masters_written: Instant,
    masters_current: bool,
    _lock: Lock,
}

/// Where displacements count from.
#[derive(Debug)]
enum Origin {
    /// Nobody needed it so far.
    NotSought,
    /// The first checkpoint is damaged: displacements are no longer known.
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
    /// Frames that cannot be read. They stay where they are, but the masters do not show them.
    pub unreadable_frames: Vec<Error>,
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
        for file in [HISTORY, REPORT, log::FILE] {
            files::remove(&path.join(file))?;
        }
        remove_masters(path)?;
        remove_curves(path)?;
        history::remove_aside(path)?;
        files::remove_unfinished(path)?;
        let case = path.join(CASE);
        files::atomically(&case, |unfinished| fs::write(unfinished, case_toml).context(Action::Write, &case))?;
        for folder in [FRAMES, CHECKPOINTS] {
            let folder = path.join(folder);
            fs::create_dir_all(&folder).context(Action::CreateFolder, &folder)?;
        }
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
            fs::create_dir_all(folder).context(Action::CreateFolder, folder)?;
        }
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
        for unreadable in &frames.unreadable {
            log::append(path, &Event::Warning(unreadable.to_string()))?;
        }
        for told in history_damage.told() {
            log::append(path, &Event::Warning(told))?;
        }

        let unreadable_frames = std::mem::take(&mut frames.unreadable);
        let mut directory = RunDirectory::assemble(path, frames, history, step, lock);
        directory.masters_current = false;
        directory.publish()?;
        Ok(Resumed { directory, state, damaged, unreadable_frames, history: history_damage })
    }

    fn assemble(path: &Path, stored: Stored, history: History, last_checkpoint: Option<u64>, lock: Lock) -> Self {
        RunDirectory {
            path: path.into(),
            contents: Contents::default(),
            series: Vec::new(),
            next_frame: stored.next,
            frames: stored.frames,
            history,
            start: Origin::NotSought,
            last_checkpoint,
            masters_written: Instant::now(),
            masters_current: true,
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
        // Frames are on the disk since they were written; rows must be, before a checkpoint that counts on them.
        self.history.sync()?;
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
        let file = frame_name(self.next_frame);
        let blocks = scene.blocks(self.contents);
        let time = plan.time(state.step);
        self.frames.push(Frame::write(&self.path, file, state.step, time, &blocks, self.contents.compression)?);
        self.next_frame += 1;
        self.masters_current = false;
        if self.frames.len() == 1 || self.masters_written.elapsed() >= MASTER_INTERVAL {
            self.publish()?;
        }
        Ok(())
    }

    /// Displacements count from the oldest checkpoint, so that a resumed run goes on counting from the same place.
    fn find_start(&self, state: &State, plan: &Plan) -> Result<Origin, Error> {
        let Some(oldest) = checkpoint::list(&self.path.join(CHECKPOINTS))?.into_iter().next() else {
            return Ok(Origin::Known(Start::of(state, plan)));
        };
        match checkpoint::read(&oldest) {
            Ok(first) => Ok(Origin::Known(Start::of(&first, plan))),
            Err(damage) => {
                let damaged = Damaged { damage, path: oldest };
                self.log(&Event::Warning(format!("displacements are not known any more, {damaged}")))?;
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
        if frame && self.last_frame() == Some(step) {
            // Masters first: they must never name a frame that is not there.
            let last = self.frames.pop();
            self.masters_current = false;
            self.publish()?;
            if let Some(last) = last {
                files::remove(&self.path.join(&last.file))?;
                self.next_frame = number_of(Path::new(&last.file)).unwrap_or(self.next_frame);
            }
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
        if !self.masters_current {
            let written = master::write(&self.path, &self.path, &self.frames, Numbers::InFrames)?;
            if written.is_empty() {
                remove_masters(&self.path)?;
            }
            self.masters_current = true;
            self.masters_written = Instant::now();
        }
        Ok(())
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
    let frames = stored_frames(run)?.frames;
    let there = |name: &String| run.join(name).with_extension(FRAME_ENDING).exists();
    if !master::block_names(&frames).iter().all(there) {
        master::write(run, run, &frames, Numbers::InFrames)?;
    }
    Ok(true)
}

/// Whether a run has what comes after its first checkpoint only: a frame, or a second row.
fn has_results(run: &Path) -> Result<bool, Error> {
    // A history that is not there has no rows.
    let history = fs::read(run.join(HISTORY)).unwrap_or_default();
    Ok(!frame_numbers(run)?.is_empty() || history.iter().filter(|&&byte| byte == b'\n').count() > 2)
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
    pub(crate) unreadable: Vec<Error>,
    /// Number of the next frame.
    next: u64,
}

/// Looks at the frames of a run.
pub(crate) fn stored_frames(run: &Path) -> Result<Stored, Error> {
    let mut stored = Stored::default();
    for number in frame_numbers(run)? {
        match Frame::read(run, frame_name(number)) {
            Ok(frame) => stored.frames.push(frame),
            Err(error) => stored.unreadable.push(error),
        }
        stored.next = number + 1;
    }
    Ok(stored)
}

fn frame_numbers(run: &Path) -> Result<Vec<u64>, Error> {
    let mut numbers: Vec<u64> =
        files::with_ending(&run.join(FRAMES), FRAME_ENDING)?.iter().filter_map(|path| number_of(path)).collect();
    numbers.sort_unstable();
    Ok(numbers)
}

/// Removes frames after a step, or all of them, and returns those that stay.
fn keep_frames(run: &Path, step: Option<u64>) -> Result<Stored, Error> {
    let mut stored = stored_frames(run)?;
    stored.frames.retain(|frame| step.is_some_and(|step| frame.step <= step));
    stored.next = stored.frames.last().and_then(|frame| number_of(Path::new(&frame.file))).map_or(0, |last| last + 1);
    let superfluous: Vec<u64> = frame_numbers(run)?.into_iter().filter(|&number| number >= stored.next).collect();
    if !superfluous.is_empty() {
        // Masters of a dead process may name frames that go now; until they are rewritten, no master is better.
        remove_masters(run)?;
        superfluous.into_iter().rev().try_for_each(|number| files::remove(&run.join(frame_name(number))))?;
        files::sync_folder(&run.join(FRAMES))?;
    }
    Ok(stored)
}

fn remove_masters(run: &Path) -> Result<(), Error> {
    files::with_ending(run, FRAME_ENDING)?.iter().try_for_each(|path| files::remove(path))
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
