//! A session: a simulation runs into a directory until it is done, stopped, or at fault.

use crate::error::Error;
use crate::history::Row;
use crate::pace::{Pace, Rate};
use crate::run_directory::RunDirectory;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tdem_engine::{Fault, Ledger, Schedule, Simulation, State};
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
    /// Energies and measures, not older than a few seconds.
    pub ledger: Ledger,
    /// The step they belong to.
    pub ledger_step: u64,
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

/// Who watches a run.
pub trait Observer {
    /// Called several times a second.
    fn progress(&mut self, progress: &Progress) -> Control;
    /// Called when something was written.
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
    let mut session = Session::begin(simulation, directory, schedule, observer)?;
    let result = session.run();
    if let Err(error) = &result {
        // Whether or not the masters and the log can be written, the first error is what must be told.
        let _ = session.directory.publish();
        let _ = session.directory.log(&error.to_string());
    }
    result
}

/// The least time between two calls of the observer.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(150);
/// The ledger shown is at least this old before it is drawn up anew,
const LEDGER_INTERVAL: Duration = Duration::from_secs(2);
/// and drawing it up takes at most one part in so many of the time.
const LEDGER_SHARE: u32 = 50;

/// A state that was taken out of the simulation, with what shall become of it.
///
/// It owns all that the writing needs: the simulation may go on while it is written.
struct Snapshot {
    state: State,
    ledger: Ledger,
    frame: bool,
    row: bool,
    checkpoint: bool,
}

struct Session<'a> {
    simulation: Simulation,
    directory: &'a mut RunDirectory,
    schedule: Schedule,
    observer: &'a mut dyn Observer,
    particles: usize,
    ledger: Ledger,
    ledger_step: u64,
    ledger_drawn: Instant,
    ledger_cost: Duration,
    checkpoint_written: Instant,
    observed: Instant,
}

impl<'a> Session<'a> {
    fn begin(
        simulation: Simulation,
        directory: &'a mut RunDirectory,
        schedule: &Schedule,
        observer: &'a mut dyn Observer,
    ) -> Result<Self, RunError> {
        let now = Instant::now();
        let state = simulation.state();
        let step = state.step;
        let ledger = Ledger::of(&state, simulation.plan());
        let mut session = Session {
            particles: state.len(),
            ledger,
            ledger_step: step,
            ledger_drawn: Instant::now(),
            ledger_cost: now.elapsed(),
            checkpoint_written: now,
            observed: now,
            simulation,
            directory,
            schedule: *schedule,
            observer,
        };
        if step < schedule.steps {
            let (frame, row) = (!falls_on(step, schedule.frame_every), !falls_on(step, schedule.history_every));
            session.directory.forget_end(step, frame, row)?;
        }
        let snapshot = Snapshot {
            ledger,
            frame: falls_on(step, schedule.frame_every),
            row: falls_on(step, schedule.history_every),
            // A run that was just created has none, and displacements count from the first.
            checkpoint: session.directory.last_checkpoint().is_none(),
            state,
        };
        // The first checkpoint comes before the first frame, which counts its displacements from it.
        if snapshot.checkpoint {
            session.checkpoint(&snapshot.state)?;
        }
        session.write(&Snapshot { checkpoint: false, ..snapshot })?;
        Ok(session)
    }

    fn run(&mut self) -> Result<Outcome, RunError> {
        let mut pace = Pace::new();
        let mut rate = Rate::new(self.simulation.step());
        if self.observe(&rate)? == Control::Stop && self.simulation.step() < self.schedule.steps {
            return self.stop();
        }
        while self.simulation.step() < self.schedule.steps {
            let batch = pace.batch().min(self.next_stop() - self.simulation.step());
            let began = Instant::now();
            if let Err(fault) = self.simulation.advance(batch) {
                return Err(self.fault(fault));
            }
            pace.took(batch, began.elapsed());
            rate.reached(self.simulation.step());
            self.record()?;
            if self.observed.elapsed() >= PROGRESS_INTERVAL
                && self.observe(&rate)? == Control::Stop
                && self.simulation.step() < self.schedule.steps
            {
                return self.stop();
            }
        }
        self.observe(&rate)?;
        self.directory.publish()?;
        let step = self.simulation.step();
        self.directory.log(&format!("finished at step {step}"))?;
        Ok(Outcome::Finished { step })
    }

    /// The next step at which something is due.
    fn next_stop(&self) -> u64 {
        let step = self.simulation.step();
        let Schedule { steps, frame_every, history_every, checkpoint_every, .. } = self.schedule;
        [frame_every, history_every, checkpoint_every.unwrap_or(0)]
            .into_iter()
            .filter(|&every| every > 0)
            .map(|every| (step / every).saturating_add(1).saturating_mul(every))
            .fold(steps, u64::min)
    }

    /// Writes what is due at the present step.
    fn record(&mut self) -> Result<(), RunError> {
        let step = self.simulation.step();
        let end = step == self.schedule.steps;
        let frame = falls_on(step, self.schedule.frame_every) || (end && self.schedule.frame_every > 0);
        let row = falls_on(step, self.schedule.history_every) || (end && self.schedule.history_every > 0);
        let checkpoint = end
            || self.schedule.checkpoint_every.is_some_and(|every| falls_on(step, every))
            || self.checkpoint_written.elapsed().as_secs_f64() >= self.schedule.checkpoint_interval_secs;
        if frame || row || checkpoint {
            let began = Instant::now();
            let state = self.simulation.state();
            let ledger = if row { Ledger::of(&state, self.simulation.plan()) } else { self.ledger };
            if row {
                self.drew(ledger, step, began);
            }
            self.write(&Snapshot { state, ledger, frame, row, checkpoint })?;
        }
        Ok(())
    }

    /// Writes a snapshot: what a checkpoint counts on comes before it.
    fn write(&mut self, snapshot: &Snapshot) -> Result<(), RunError> {
        let plan = self.simulation.plan();
        let step = snapshot.state.step;
        if snapshot.row {
            self.directory.row(&Row { step, time: plan.time(step), ledger: snapshot.ledger })?;
        }
        if snapshot.frame {
            self.directory.frame(&snapshot.state, plan)?;
            self.observer.note(&Note::Frame { step });
        }
        if snapshot.checkpoint {
            self.checkpoint(&snapshot.state)?;
        }
        Ok(())
    }

    fn checkpoint(&mut self, state: &State) -> Result<(), RunError> {
        self.directory.checkpoint(state)?;
        self.checkpoint_written = Instant::now();
        self.observer.note(&Note::Checkpoint { step: state.step });
        Ok(())
    }

    fn drew(&mut self, ledger: Ledger, step: u64, began: Instant) {
        self.ledger = ledger;
        self.ledger_step = step;
        self.ledger_cost = began.elapsed();
        self.ledger_drawn = Instant::now();
    }

    fn observe(&mut self, rate: &Rate) -> Result<Control, RunError> {
        let step = self.simulation.step();
        let patience = LEDGER_INTERVAL.max(self.ledger_cost * LEDGER_SHARE);
        if self.ledger_step < step && self.ledger_drawn.elapsed() >= patience {
            let began = Instant::now();
            let ledger = Ledger::of(&self.simulation.state(), self.simulation.plan());
            self.drew(ledger, step, began);
        }
        let left = self.schedule.steps.saturating_sub(step);
        let progress = Progress {
            step,
            steps: self.schedule.steps,
            time: self.simulation.time(),
            end_time: self.simulation.plan().time(self.schedule.steps),
            cundall_number: rate.steps_per_second().unwrap_or(0.0) * self.particles as f64,
            time_left: rate.time_for(left),
            ledger: self.ledger,
            ledger_step: self.ledger_step,
        };
        let control = self.observer.progress(&progress);
        self.observed = Instant::now();
        if control == Control::Publish {
            self.directory.publish()?;
        }
        Ok(control)
    }

    fn stop(&mut self) -> Result<Outcome, RunError> {
        let step = self.simulation.step();
        if self.directory.last_checkpoint() != Some(step) {
            let state = self.simulation.state();
            self.checkpoint(&state)?;
        }
        self.directory.publish()?;
        self.directory.log(&format!("interrupted at step {step}"))?;
        Ok(Outcome::Interrupted { step })
    }

    fn fault(&self, fault: Fault) -> RunError {
        RunError::Fault {
            fault,
            checkpoint: self.directory.last_checkpoint().unwrap_or(0),
            path: self.directory.path().into(),
        }
    }
}

fn falls_on(step: u64, every: u64) -> bool {
    every > 0 && step.is_multiple_of(every)
}
