//! A session: a simulation runs into a directory until it is done, stopped, or at fault.
//!
//! Results are written by a thread of their own while the simulation goes on, in the order in which they were taken
//! out of it. At most two moments are under way; then the simulation waits for the disk. Whatever ends a session, what
//! was taken before is written first.

use crate::error::Error;
use crate::history::Row;
use crate::log::Event;
use crate::pace::{Pace, Rate};
use crate::run_directory::RunDirectory;
use crate::writer::{Failure, LIMIT, Report, Sink, Wanted, Writer};
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};
use tdem_engine::{Capture, Fault, Ledger, Plan, Schedule, Simulation, State, Turns};
use thiserror::Error;

/// How a run is getting on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Steps done.
    pub step: u64,
    /// Steps at which the run ends.
    pub steps: u64,
    /// Time, s.
    pub time: f64,
    /// Time when the run ends, s.
    pub end_time: f64,
    /// Particles times steps per second of wall clock, lately.
    pub cundall_number: f64,
    /// Wall clock until the end, if the pace stays; `None` at the start.
    pub time_left: Option<Duration>,
    /// Energies and measures, not older than a few seconds unless the disk or the simulation is slow.
    pub ledger: Ledger,
    /// The step they belong to.
    pub ledger_step: u64,
    /// What heat and motion took since the simulation was opened, where they take turns.
    pub turns: Option<Turns>,
}

/// What an observer asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// Bring the masters up to date, so that the frames so far can be looked at, then go on.
    Publish,
    /// Write a checkpoint and stop.
    Stop,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// A frame was written.
    Frame {
        /// Its step.
        step: u64,
    },
    /// A checkpoint was written.
    Checkpoint {
        /// Its step.
        step: u64,
    },
}

/// Who watches a run, on the thread that runs it.
pub trait Observer {
    /// Called several times a second.
    fn progress(&mut self, progress: &Progress) -> Control;
    /// Called after something was written, in the order of writing.
    fn note(&mut self, note: &Note);
}

/// How a session ended, without an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All steps are done.
    Finished {
        /// Their number.
        step: u64,
    },
    /// The observer asked to stop; a checkpoint of this step was written.
    Interrupted {
        /// The step.
        step: u64,
    },
}

/// Why a session could not go on. What was written up to the last good checkpoint is whole, in each case.
#[derive(Debug, Error)]
pub enum RunError {
    /// The engine met something it cannot compute.
    #[error("{fault}; the last good checkpoint is of step {checkpoint}: {}", path.display())]
    Fault {
        /// What it met.
        fault: Fault,
        /// Step of the last good checkpoint.
        checkpoint: u64,
        /// The run.
        path: PathBuf,
    },
    /// Results could not be written.
    #[error(transparent)]
    Results(#[from] Error),
}

/// Runs a simulation into a directory.
///
/// # Errors
/// [`RunError::Fault`] from the engine; [`RunError::Results`] if something cannot be written.
pub fn run(
    simulation: Simulation,
    directory: &mut RunDirectory,
    schedule: &Schedule,
    observer: &mut dyn Observer,
) -> Result<Outcome, RunError> {
    let result = run_into(simulation, directory, schedule, observer);
    result.map_err(|failure| {
        let error = match failure {
            Failure::Results(error) => RunError::Results(error),
            Failure::Fault(fault) => RunError::Fault {
                fault,
                checkpoint: directory.last_checkpoint().unwrap_or(0),
                path: directory.path().into(),
            },
        };
        // Whether or not the masters and the log can be written, the first error is what must be told.
        let _ = directory.publish();
        let _ = directory.log(&Event::Failed(error.to_string()));
        error
    })
}

fn run_into(
    simulation: Simulation,
    directory: &mut RunDirectory,
    schedule: &Schedule,
    observer: &mut dyn Observer,
) -> Result<Outcome, Failure> {
    let step = simulation.step();
    if step < schedule.steps {
        let due = due(step, schedule);
        let superfluous = Wanted { frame: !due.frame, row: !due.row, pictures: !due.pictures, checkpoint: false };
        directory.forget_end(step, superfluous)?;
    }
    let (particles, dt) = (simulation.particles() as u64, simulation.plan().dt);
    directory.log(&Event::Begins { step, steps: schedule.steps, particles, dt })?;
    let began = Instant::now();
    let last_checkpoint = directory.last_checkpoint();
    let mut witness = Witness { observer, turns: None };
    let outcome = carry_on(simulation, directory, last_checkpoint, schedule, &mut witness)?;
    match outcome {
        Outcome::Finished { .. } => directory.finish()?,
        Outcome::Interrupted { .. } => directory.publish()?,
    }
    directory.unify_pictures()?;
    if let Some(turns) = witness.turns.filter(|turns| turns.unrelaxed > 0) {
        directory.log(&Event::Warning(format!(
            "particles were not at rest behind {} steps of the heat, the last of them step {}; the ratio of forces was up \
             to {:.3e}",
            turns.unrelaxed, turns.last_unrelaxed, turns.largest_ratio
        )))?;
    }
    let secs = began.elapsed().as_secs_f64();
    directory.log(&match outcome {
        Outcome::Finished { step: end } => Event::Finished { step: end, done: end.saturating_sub(step), secs },
        Outcome::Interrupted { step: end } => Event::Interrupted { step: end, done: end.saturating_sub(step), secs },
    })?;
    Ok(outcome)
}

/// Writes what the end of a run writes, as far as it is not there: the last row, frame and pictures, and the masters. The run is
/// finished, and the state its last.
///
/// # Errors
/// Whatever the file system says.
pub fn complete(directory: &mut RunDirectory, state: &State, plan: &Plan, schedule: &Schedule) -> Result<(), Error> {
    let lacks = |last: Option<u64>| last.is_none_or(|last| last < state.step);
    if schedule.history_every > 0 && lacks(directory.last_row()) {
        directory.row(&Row::of(state, plan, Ledger::of(state, plan)))?;
    }
    if schedule.frame_every > 0 && lacks(directory.last_frame()) {
        directory.frame(state, plan)?;
    }
    if schedule.picture_every > 0 {
        directory.pictures(state, plan)?;
    }
    directory.finish()?;
    directory.unify_pictures()?;
    directory.log(&Event::Finished { step: state.step, done: 0, secs: 0.0 })
}

/// Passes on what an observer is told, and remembers what the log will say.
struct Witness<'a> {
    observer: &'a mut dyn Observer,
    turns: Option<Turns>,
}

impl Observer for Witness<'_> {
    fn progress(&mut self, progress: &Progress) -> Control {
        self.turns = progress.turns;
        self.observer.progress(progress)
    }
    fn note(&mut self, note: &Note) {
        self.observer.note(note);
    }
}

/// Runs a simulation beside the thread that writes. When it returns, all that was taken is written, or the writing
/// has failed.
fn carry_on(
    simulation: Simulation,
    sink: &mut dyn Sink,
    last_checkpoint: Option<u64>,
    schedule: &Schedule,
    observer: &mut dyn Observer,
) -> Result<Outcome, Failure> {
    let plan = simulation.plan().clone();
    thread::scope(|scope| {
        let writer = Writer::start(scope, sink, &plan)?;
        let mut session = Session::begin(simulation, writer, last_checkpoint, schedule, observer)?;
        let result = session.run();
        // An error of the writer belongs to an earlier step than what the simulation met meanwhile.
        session.settle().and(result)
    })
}

/// The least time between two calls of the observer.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(150);
/// The ledger shown is at least this old before it is drawn up anew,
const LEDGER_INTERVAL: Duration = Duration::from_secs(2);
/// and drawing it up takes at most one part in so many of the time.
const LEDGER_SHARE: u32 = 50;

struct Session<'a, 'scope> {
    simulation: Simulation,
    writer: Writer<'scope>,
    schedule: Schedule,
    observer: &'a mut dyn Observer,
    ledger: Ledger,
    ledger_step: u64,
    ledger_drawn: Instant,
    ledger_cost: Duration,
    /// Step of the last checkpoint, written or on its way.
    last_checkpoint: Option<u64>,
    /// When it was written; `None` while it is on its way.
    checkpoint_written: Option<Instant>,
    observed: Instant,
}

impl<'a, 'scope> Session<'a, 'scope> {
    fn begin(
        mut simulation: Simulation,
        writer: Writer<'scope>,
        last_checkpoint: Option<u64>,
        schedule: &Schedule,
        observer: &'a mut dyn Observer,
    ) -> Result<Self, Failure> {
        let now = Instant::now();
        let state = simulation.state()?;
        let (step, ledger) = (state.step, Ledger::of(&state, simulation.plan()));
        let mut session = Session {
            ledger,
            ledger_step: step,
            ledger_drawn: Instant::now(),
            ledger_cost: now.elapsed(),
            last_checkpoint,
            checkpoint_written: Some(now),
            observed: now,
            simulation,
            writer,
            schedule: *schedule,
            observer,
        };
        let wanted = Wanted {
            // A run that was just created has none, and displacements count from the first.
            checkpoint: last_checkpoint.is_none(),
            ..due(step, schedule)
        };
        if wanted.written() {
            session.hand_over(state.into(), now.elapsed(), wanted);
        }
        Ok(session)
    }

    fn run(&mut self) -> Result<Outcome, Failure> {
        let mut pace = Pace::default();
        let mut rate = Rate::new(self.simulation.step());
        if self.observe(&rate)? == Control::Stop && self.simulation.step() < self.schedule.steps {
            return self.stop();
        }
        while self.simulation.step() < self.schedule.steps {
            let batch = pace.batch().min(self.next_stop() - self.simulation.step());
            let began = Instant::now();
            self.simulation.advance(batch)?;
            pace.took(batch, began.elapsed());
            rate.reached(self.simulation.step());
            self.hear()?;
            self.record()?;
            if self.observed.elapsed() >= PROGRESS_INTERVAL
                && self.observe(&rate)? == Control::Stop
                && self.simulation.step() < self.schedule.steps
            {
                return self.stop();
            }
        }
        self.settle()?;
        self.observe(&rate)?;
        Ok(Outcome::Finished { step: self.simulation.step() })
    }

    /// The next step at which something is due.
    fn next_stop(&self) -> u64 {
        let step = self.simulation.step();
        let Schedule { steps, frame_every, history_every, picture_every, checkpoint_every, .. } = self.schedule;
        [frame_every, history_every, picture_every, checkpoint_every.unwrap_or(0)]
            .into_iter()
            .filter(|&every| every > 0)
            .map(|every| (step / every).saturating_add(1).saturating_mul(every))
            .fold(steps, u64::min)
    }

    /// Takes out what is due at the present step.
    fn record(&mut self) -> Result<(), Failure> {
        let step = self.simulation.step();
        let end = step == self.schedule.steps;
        let interval = self.schedule.checkpoint_interval_secs;
        let due = due(step, &self.schedule);
        let wanted = Wanted {
            frame: due.frame || (end && self.schedule.frame_every > 0),
            row: due.row || (end && self.schedule.history_every > 0),
            pictures: due.pictures || (end && self.schedule.picture_every > 0),
            checkpoint: end
                || self.schedule.checkpoint_every.is_some_and(|every| falls_on(step, every))
                || self.checkpoint_written.is_some_and(|written| written.elapsed().as_secs_f64() >= interval),
        };
        if wanted.written() { self.take(wanted) } else { Ok(()) }
    }

    /// Takes the present moment out of the simulation as soon as there is room for it.
    fn take(&mut self, wanted: Wanted) -> Result<(), Failure> {
        self.wait_for(LIMIT - 1)?;
        let began = Instant::now();
        let capture = self.simulation.capture()?;
        self.hand_over(capture, began.elapsed(), wanted);
        Ok(())
    }

    fn hand_over(&mut self, capture: Capture, took: Duration, wanted: Wanted) {
        if wanted.checkpoint {
            self.last_checkpoint = Some(self.simulation.step());
            self.checkpoint_written = None;
        }
        self.writer.write(capture, took, wanted);
    }

    /// Hears what the writer has to tell.
    fn hear(&mut self) -> Result<(), Failure> {
        while let Some(report) = self.writer.told()? {
            self.heard(report);
        }
        Ok(())
    }

    /// Waits until the writer has done all that was handed over.
    fn settle(&mut self) -> Result<(), Failure> {
        self.wait_for(0)
    }

    /// Waits until no more than so many jobs are under way.
    fn wait_for(&mut self, under_way: usize) -> Result<(), Failure> {
        self.hear()?;
        while self.writer.under_way() > under_way {
            if let Some(report) = self.writer.listen()? {
                self.heard(report);
            }
        }
        Ok(())
    }

    fn heard(&mut self, report: Report) {
        match report {
            Report::Note(note) => {
                if matches!(note, Note::Checkpoint { step } if self.last_checkpoint == Some(step)) {
                    self.checkpoint_written = Some(Instant::now());
                }
                self.observer.note(&note);
            }
            Report::Ledger { ledger, step, cost } => {
                self.ledger = *ledger;
                self.ledger_step = step;
                self.ledger_cost = cost;
                self.ledger_drawn = Instant::now();
            }
            Report::Done => {}
        }
    }

    fn observe(&mut self, rate: &Rate) -> Result<Control, Failure> {
        let step = self.simulation.step();
        let patience = LEDGER_INTERVAL.max(self.ledger_cost * LEDGER_SHARE);
        // A ledger for the eye is no reason to wait: it is drawn up when the writer has nothing else to do.
        if self.ledger_step < step && self.ledger_drawn.elapsed() >= patience && self.writer.under_way() == 0 {
            self.take(Wanted::LEDGER)?;
        }
        let left = self.schedule.steps.saturating_sub(step);
        let progress = Progress {
            step,
            steps: self.schedule.steps,
            time: self.simulation.time(),
            end_time: self.simulation.plan().time(self.schedule.steps),
            cundall_number: rate.steps_per_second().unwrap_or(0.0) * self.simulation.particles() as f64,
            time_left: rate.time_for(left),
            ledger: self.ledger,
            ledger_step: self.ledger_step,
            turns: self.simulation.turns(),
        };
        let control = self.observer.progress(&progress);
        self.observed = Instant::now();
        if control == Control::Publish {
            self.wait_for(LIMIT - 1)?;
            self.writer.publish();
            self.settle()?;
        }
        Ok(control)
    }

    /// Leaves a checkpoint of the present step.
    fn stop(&mut self) -> Result<Outcome, Failure> {
        let step = self.simulation.step();
        if self.last_checkpoint != Some(step) {
            self.take(Wanted { checkpoint: true, ..Wanted::default() })?;
        }
        self.settle()?;
        Ok(Outcome::Interrupted { step })
    }
}

/// What a schedule asks for at a step, wherever a run ends.
fn due(step: u64, schedule: &Schedule) -> Wanted {
    Wanted {
        frame: falls_on(step, schedule.frame_every),
        row: falls_on(step, schedule.history_every),
        pictures: falls_on(step, schedule.picture_every),
        checkpoint: false,
    }
}

fn falls_on(step: u64, every: u64) -> bool {
    every > 0 && step.is_multiple_of(every)
}

#[cfg(test)]
mod tests;
