//! A thread that writes what was taken out of a simulation, in the order in which it was taken.

use crate::error::Error;
use crate::history::Row;
use crate::run_directory::RunDirectory;
use crate::session::Note;
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, RecvError, SyncSender, TryRecvError, sync_channel};
use std::thread::{Builder, Scope, ScopedJoinHandle};
use std::time::{Duration, Instant};
use tdem_engine::{Capture, Fault, Ledger, Plan, State};

/// Moments on their way: one that is being written, and one that waits. More would only take memory: a disk that is
/// too slow for the run is too slow in the end.
pub(crate) const LIMIT: usize = 2;
/// A moment is reported by at most two notes, a ledger and its end.
const REPORTS: usize = 4;

/// Where results go: the folder of a run, or what a test puts in its place.
pub(crate) trait Sink: Send {
    /// Adds a row to the history.
    fn row(&mut self, row: &Row) -> Result<(), Error>;
    /// Writes a frame.
    fn frame(&mut self, state: &State, plan: &Plan) -> Result<(), Error>;
    /// Draws pictures.
    fn pictures(&mut self, state: &State, plan: &Plan) -> Result<(), Error>;
    /// Writes a checkpoint.
    fn checkpoint(&mut self, state: &State) -> Result<(), Error>;
    /// Whether there is a checkpoint.
    fn has_checkpoint(&self) -> bool;
    /// Brings the masters up to date.
    fn publish(&mut self) -> Result<(), Error>;
}

impl Sink for RunDirectory {
    fn row(&mut self, row: &Row) -> Result<(), Error> {
        self.row(row)
    }
    fn frame(&mut self, state: &State, plan: &Plan) -> Result<(), Error> {
        self.frame(state, plan)
    }
    fn pictures(&mut self, state: &State, plan: &Plan) -> Result<(), Error> {
        self.pictures(state, plan)
    }
    fn checkpoint(&mut self, state: &State) -> Result<(), Error> {
        self.checkpoint(state)
    }
    fn has_checkpoint(&self) -> bool {
        self.last_checkpoint().is_some()
    }
    fn publish(&mut self) -> Result<(), Error> {
        self.publish()
    }
}

/// What shall become of a moment. A ledger is drawn up for a row, and if nothing else is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each says whether one kind of file is written, in any combination")]
pub(crate) struct Wanted {
    pub(crate) row: bool,
    pub(crate) frame: bool,
    pub(crate) pictures: bool,
    pub(crate) checkpoint: bool,
}

impl Wanted {
    /// A ledger for the eye.
    pub(crate) const LEDGER: Wanted = Wanted { row: false, frame: false, pictures: false, checkpoint: false };

    /// Whether something shall be written.
    pub(crate) fn written(self) -> bool {
        self != Wanted::LEDGER
    }
}

/// What the thread does.
enum Job {
    /// A moment, how long it took to capture, and what shall become of it.
    Write(Capture, Duration, Wanted),
    Publish,
}

/// What the thread tells.
#[derive(Clone, Debug)]
pub(crate) enum Report {
    /// Something was written.
    Note(Note),
    /// A ledger was drawn up.
    Ledger { ledger: Box<Ledger>, step: u64, cost: Duration },
    /// A job is done.
    Done,
}

/// Why the thread gave up. It then leaves alone what still waits.
#[derive(Debug)]
pub(crate) enum Failure {
    Fault(Fault),
    Results(Error),
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Self {
        Failure::Fault(fault)
    }
}
impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Failure::Results(error)
    }
}

/// The other end of the thread. Dropped, it lets the thread write what waits, and end.
pub(crate) struct Writer<'scope> {
    jobs: SyncSender<Job>,
    reports: Receiver<Report>,
    thread: Option<ScopedJoinHandle<'scope, Result<(), Failure>>>,
    under_way: usize,
}

impl<'scope> Writer<'scope> {
    /// Starts the thread.
    pub(crate) fn start<'env>(
        scope: &'scope Scope<'scope, 'env>,
        sink: &'env mut dyn Sink,
        plan: &'env Plan,
    ) -> Result<Self, Failure> {
        // Neither end ever waits to get rid of something: there are never more than LIMIT jobs.
        let (jobs, incoming) = sync_channel(LIMIT);
        let (outgoing, reports) = sync_channel(LIMIT * REPORTS);
        let thread = Builder::new()
            .name("writer".to_owned())
            .spawn_scoped(scope, move || Desk { sink, plan, reports: outgoing }.work(&incoming))
            .map_err(|_| Fault::Threads { threads: 1 })?;
        Ok(Writer { jobs, reports, thread: Some(thread), under_way: 0 })
    }

    /// Jobs that are not done.
    pub(crate) fn under_way(&self) -> usize {
        self.under_way
    }

    /// Hands a moment over. There must be room for it: less than [`LIMIT`] under way.
    pub(crate) fn write(&mut self, capture: Capture, took: Duration, wanted: Wanted) {
        self.hand_over(Job::Write(capture, took, wanted));
    }

    /// Has the masters brought up to date. There must be room as for a moment.
    pub(crate) fn publish(&mut self) {
        self.hand_over(Job::Publish);
    }

    fn hand_over(&mut self, job: Job) {
        assert!(self.under_way < LIMIT, "whoever hands over waits for room first");
        self.under_way += 1;
        // A thread that gave up says so when it is listened to.
        let _ = self.jobs.send(job);
    }

    /// What the thread told, if anything.
    ///
    /// # Errors
    /// Why it gave up, after all that it told before.
    pub(crate) fn told(&mut self) -> Result<Option<Report>, Failure> {
        match self.reports.try_recv() {
            Ok(report) => Ok(Some(self.note(report))),
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => self.gave_up(),
        }
    }

    /// The same, but waits for it; `None` if nothing is under way.
    pub(crate) fn listen(&mut self) -> Result<Option<Report>, Failure> {
        if self.under_way == 0 {
            return Ok(None);
        }
        match self.reports.recv() {
            Ok(report) => Ok(Some(self.note(report))),
            Err(RecvError) => self.gave_up(),
        }
    }

    fn note(&mut self, report: Report) -> Report {
        self.under_way -= usize::from(matches!(report, Report::Done));
        report
    }

    fn gave_up(&mut self) -> Result<Option<Report>, Failure> {
        self.under_way = 0;
        match self.thread.take().map(ScopedJoinHandle::join) {
            Some(Ok(result)) => result.map(|()| None),
            Some(Err(panic)) => resume_unwind(panic),
            None => Ok(None),
        }
    }
}

/// What the thread works with.
struct Desk<'a> {
    sink: &'a mut dyn Sink,
    plan: &'a Plan,
    reports: SyncSender<Report>,
}

impl Desk<'_> {
    fn work(mut self, jobs: &Receiver<Job>) -> Result<(), Failure> {
        for job in jobs {
            match job {
                Job::Write(capture, took, wanted) => self.write(capture, took, wanted)?,
                Job::Publish => self.sink.publish()?,
            }
            self.tell(Report::Done);
        }
        Ok(())
    }

    /// Writes a moment: what a checkpoint counts on comes before it.
    fn write(&mut self, capture: Capture, took: Duration, wanted: Wanted) -> Result<(), Failure> {
        let began = Instant::now();
        let state = capture.state()?;
        let step = state.step;
        if wanted.row || !wanted.written() {
            let ledger = Ledger::of(&state, self.plan);
            let row = Row::of(&state, self.plan, ledger);
            if let Some((quantity, value, unit)) = row.unbounded().filter(|_| !state.is_empty()) {
                return Err(Fault::Unbounded { step, time: self.plan.time(step), quantity, value, unit }.into());
            }
            self.tell(Report::Ledger { ledger: Box::new(ledger), step, cost: took + began.elapsed() });
            if wanted.row {
                self.sink.row(&row)?;
            }
        }
        // The first checkpoint comes before the first frame, which counts its displacements from it.
        let first = wanted.checkpoint && !self.sink.has_checkpoint();
        if first {
            self.checkpoint(&state)?;
        }
        if wanted.frame {
            self.sink.frame(&state, self.plan)?;
            self.tell(Report::Note(Note::Frame { step }));
        }
        if wanted.pictures {
            self.sink.pictures(&state, self.plan)?;
        }
        if wanted.checkpoint && !first {
            self.checkpoint(&state)?;
        }
        Ok(())
    }

    fn checkpoint(&mut self, state: &State) -> Result<(), Error> {
        self.sink.checkpoint(state)?;
        self.tell(Report::Note(Note::Checkpoint { step: state.step }));
        Ok(())
    }

    fn tell(&self, report: Report) {
        // Nobody listens any more after an error of theirs; what waits is written all the same.
        let _ = self.reports.send(report);
    }
}
