//! What `run` and `resume` have in common: a simulation advances into its directory, watched.

use crate::cases;
use crate::console::{data, say};
use crate::machine::Machine;
use crate::progress::Watch;
use crate::render::{Report, Reports};
use crate::signals::{self, Signals};
use crate::summary;
use crate::units::{argument, grouped, short};
use clap::Args;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use tdem_case::Fields;
use tdem_engine::{Fault, Schedule, Simulation, State, gpu};
use tdem_results::{Error, Outcome, RunDirectory, RunError, load_final_state, session};

#[derive(Args, Debug)]
#[group(skip)]
pub(crate) struct Arguments {
    /// End after N steps in all, instead of at the end of the case
    #[arg(long, value_name = "N")]
    pub(crate) steps: Option<u64>,
    /// Print a hash of the final state: the proof that two runs are the same
    #[arg(long)]
    pub(crate) hash: bool,
    /// Say nothing but warnings and errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

impl Arguments {
    /// When a run writes, and where it ends: at the end of the case unless told otherwise.
    pub(crate) fn schedule(&self, of_case: Schedule) -> Schedule {
        Schedule { steps: self.steps.unwrap_or(of_case.steps), ..of_case }
    }
}

/// A run about to be carried on.
#[derive(Debug)]
pub(crate) struct Work<'a> {
    pub(crate) directory: RunDirectory,
    /// What the case asks for.
    pub(crate) of_case: Schedule,
    pub(crate) fields: Fields,
    pub(crate) arguments: &'a Arguments,
}

impl Work<'_> {
    pub(crate) fn run(mut self, simulation: Simulation) -> Result<ExitCode, Reports> {
        let began = Instant::now();
        let first = simulation.step();
        let particles = simulation.particles();
        let dt = simulation.plan().dt;
        let schedule = self.arguments.schedule(self.of_case);
        let signals = Signals::catch()?;
        self.directory.set_contents(cases::contents(self.fields));
        let mut watch = Watch::new(&signals, self.arguments.quiet);
        let outcome = session::run(simulation, &mut self.directory, &schedule, &mut watch);
        let took = began.elapsed();
        let last = watch.finish();
        let path = self.directory.path().to_owned();
        // The lock is given back before anything else is read.
        drop(self.directory);
        match outcome.map_err(|error| fault_report(error, dt))? {
            Outcome::Finished { step } => {
                if !self.arguments.quiet {
                    say(summary::after(&summary::Ended {
                        path: &path,
                        step,
                        first,
                        particles,
                        took,
                        last: last.as_ref(),
                    }));
                    if step < self.of_case.steps {
                        say(format!(
                            "The case goes on to step {}: tdem resume {}",
                            grouped(self.of_case.steps),
                            argument(&path)
                        ));
                    }
                }
                if self.arguments.hash {
                    print_hash(&load_final_state(&path)?.state)?;
                }
                Ok(ExitCode::SUCCESS)
            }
            Outcome::Interrupted { step } => {
                let signal = signals.caught().unwrap_or(0);
                let steps = self.arguments.steps.map_or(String::new(), |steps| format!(" --steps {steps}"));
                say(format!(
                    "Stopped by {} at step {} of {}, t = {} s; a checkpoint was written.\nGo on with: tdem resume {}{steps}",
                    signals::name(signal),
                    grouped(step),
                    grouped(schedule.steps),
                    short(step as f64 * dt),
                    argument(&path)
                ));
                Ok(ExitCode::from(128 + signal))
            }
        }
    }
}

/// The line that `--hash` promises.
pub(crate) fn print_hash(state: &State) -> Result<(), Reports> {
    data(format!("hash {:032x}", state.hash()))
}

fn fault_report(error: RunError, dt: f64) -> Reports {
    match error {
        RunError::Results(error) => error.into(),
        RunError::Fault { fault, checkpoint, path } => {
            let cause = match &fault {
                Fault::NotFinite { .. } | Fault::Escaped { .. } | Fault::Overlap { .. } => format!(
                    "most often the time step is too large (it is {} s; `tdem check` shows the limits), or something was \
                     prescribed that pushes particles into each other or through walls\n",
                    short(dt)
                ),
                Fault::Device(error) => format!("{}\n", device_remedy(error)),
                _ => String::new(),
            };
            let run = argument(&path);
            Report::new(fault_code(&fault), format!("{fault}; the last good checkpoint is of step {checkpoint}"))
                .help(format!(
                    "{cause}what was written is whole: `tdem info {run}` lists it\n\
                     `tdem resume {run}` goes on from step {checkpoint}, and meets the same fault unless --steps ends \
                     before it; after changing the case: `tdem run CASE.toml --overwrite`"
                ))
                .into()
        }
    }
}

fn fault_code(fault: &Fault) -> &'static str {
    match fault {
        Fault::NotFinite { .. } => "tdem::run::not-finite",
        Fault::Escaped { .. } => "tdem::run::escaped",
        Fault::Overlap { .. } => "tdem::run::overlap",
        Fault::ListOverflow { .. } => "tdem::run::list-overflow",
        Fault::BoxTooSmall { .. } => "tdem::run::box-too-small",
        Fault::Threads { .. } => "tdem::run::threads",
        Fault::Inconsistent { .. } => "tdem::run::inconsistent",
        Fault::Device(_) => "tdem::run::device",
    }
}

/// What can be done about a device that refuses.
fn device_remedy(error: &gpu::Error) -> &'static str {
    match error {
        gpu::Error::OutOfMemory { .. } => {
            "`tdem check` says what the case needs; take fewer particles, a device with more memory, or --device cpu"
        }
        gpu::Error::Compile { .. } => {
            "the driver's compiler may be too old or at fault: try a newer driver, the other interface, or --device cpu; \
             `tdem kernels CASE.toml` prints what it was given"
        }
        gpu::Error::Missing { .. } => "`tdem info` lists the devices; --device cpu always works",
        gpu::Error::Call { .. } => {
            "the device may have been reset or lost; `tdem info` tests it, and a run can go on with another one: \
             `tdem resume DIR --device cpu`"
        }
    }
}

impl From<Fault> for Reports {
    fn from(fault: Fault) -> Self {
        let report = Report::new(fault_code(&fault), fault.to_string());
        match &fault {
            Fault::Device(error) => report.help(device_remedy(error)).into(),
            _ => report.into(),
        }
    }
}

impl From<Error> for Reports {
    fn from(error: Error) -> Self {
        let run = |path: &Path| argument(path);
        let (code, help) = match &error {
            Error::RunExists { path } => {
                let path = run(path);
                let help = format!(
                    "go on with it: `tdem resume {path}`\nreplace it: add --overwrite\nkeep both: add --out DIR"
                );
                return Report::new("tdem::results::run-exists", format!("{path} holds a run already"))
                    .help(help)
                    .into();
            }
            Error::NotARun { path } => {
                return Report::new(
                    "tdem::results::not-a-run",
                    format!("{} is not a run: there is no `case.toml` in it", run(path)),
                )
                .help("name the directory that `tdem run` made; without --out it is runs/<name of the case file>")
                .into();
            }
            Error::DiskFull { .. } => ("tdem::results::disk-full", None),
            Error::Io { .. } => (
                "tdem::results::io",
                Some("check that the path exists, that it may be written, and that the disk is there"),
            ),
            Error::Format { .. } => ("tdem::results::format", None),
            Error::Locked { .. } => ("tdem::results::locked", None),
            Error::Occupied { .. } => ("tdem::results::occupied", Some("choose another directory with --out")),
            Error::NoCheckpoint { .. } => ("tdem::results::no-checkpoint", None),
            Error::NoFrames { .. } => {
                ("tdem::results::no-frames", Some("a case writes frames unless it says output.frames = 0"))
            }
            Error::HistoryColumns { .. } => ("tdem::results::history-columns", None),
            Error::PictureSize { .. } => ("tdem::results::picture-size", None),
            Error::Picture { .. } => ("tdem::results::picture", None),
        };
        let report = Report::new(code, error.to_string());
        match help {
            Some(help) => report.help(help).into(),
            None => report.into(),
        }
    }
}
