//! What `run` and `resume` have in common: a simulation advances into its directory, watched.

use crate::cases;
use crate::codes;
use crate::console::{data, say};
use crate::json::{self, Json};
use crate::machine::Machine;
use crate::progress::Watch;
use crate::render::{self, Report, Reports};
use crate::report;
use crate::signals::{self, Signals};
use crate::summary;
use crate::units::{argument, bytes, counted, grouped, number, short};
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tdem_case::{Code, Fields, Loaded, Problems};
use tdem_engine::{Fault, Schedule, Simulation, State, Turns, gpu};
use tdem_results::curve::{self, Curve};
use tdem_results::{Error, Event, Outcome, Progress, RunDirectory, RunError, load_final_state, session};

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
    pub(crate) json: Json,
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
    pub(crate) loaded: &'a Loaded,
    /// What the case asks for.
    pub(crate) of_case: Schedule,
    pub(crate) fields: Fields,
    /// What computes.
    pub(crate) device: String,
    /// What the case was warned of.
    pub(crate) warnings: &'a Problems,
    pub(crate) arguments: &'a Arguments,
    /// The command, for programs.
    pub(crate) command: &'static str,
    pub(crate) signals: Signals,
}

impl Work<'_> {
    pub(crate) fn run(mut self, simulation: Simulation) -> Result<ExitCode, Reports> {
        let began = Instant::now();
        let first = simulation.step();
        let particles = simulation.particles();
        let dt = simulation.plan().dt;
        let schedule = self.arguments.schedule(self.of_case);
        self.signals.defer();
        self.directory.set_contents(cases::contents(self.fields));
        self.directory.set_names(cases::names(&self.loaded.case));
        self.directory.set_pictures(cases::pictures(&self.loaded.case));
        self.introduce()?;
        let mut watch = Watch::new(&self.signals, self.arguments.quiet);
        let outcome = session::run(simulation, &mut self.directory, &schedule, &mut watch);
        let took = began.elapsed();
        let last = watch.finish();
        if let Some(turns) = last.and_then(|last| last.turns).filter(|turns| turns.unrelaxed > 0) {
            render::warn(&Report::new(codes::UNRELAXED, unrelaxed(&turns)).into());
        }
        let path = self.directory.path().to_owned();
        let finished = matches!(outcome, Ok(Outcome::Finished { .. }));
        let overlap = largest_overlap(&path);
        if let Some([largest, time]) = overlap.filter(|[largest, _]| finished && *largest >= LARGE_OVERLAP) {
            render::warn(&Report::new(codes::LARGE_OVERLAP, large_overlap(largest, time)).into());
        }
        let hashed = if finished && self.arguments.hash { Some(load_final_state(&path)?.state) } else { None };
        let curves = if finished {
            conclude(&self.directory, self.loaded, hashed.as_ref())?
        } else {
            leave_page(&path, self.loaded);
            Vec::new()
        };
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
                        overlap,
                        curves: &curves,
                    }));
                    if step < self.of_case.steps {
                        say(format!(
                            "The case goes on to step {}: tdem resume {}",
                            grouped(self.of_case.steps),
                            argument(&path)
                        ));
                    }
                }
                if self.arguments.json.json {
                    let ended = Ended { outcome: "finished", step, first, particles, took, dt };
                    let hash = hashed.as_ref().map(|state| json::hash(state.hash()));
                    let case_ends = self.of_case.steps;
                    json::print(
                        self.command,
                        for_programs(&path, &ended, case_ends, last.as_ref(), self.warnings, hash.as_ref()),
                    )?;
                } else if let Some(state) = &hashed {
                    print_hash(state)?;
                }
                Ok(ExitCode::SUCCESS)
            }
            Outcome::Interrupted { step } => {
                let signal = self.signals.caught().unwrap_or(0);
                let steps = self.arguments.steps.map_or(String::new(), |steps| format!(" --steps {steps}"));
                say(format!(
                    "Stopped by {} at step {} of {}, t = {} s; a checkpoint was written.\nGo on with: tdem resume {}{steps}",
                    signals::name(signal),
                    grouped(step),
                    grouped(schedule.steps),
                    short(step as f64 * dt),
                    argument(&path)
                ));
                if self.arguments.json.json {
                    let ended = Ended { outcome: "interrupted", step, first, particles, took, dt };
                    let case_ends = self.of_case.steps;
                    json::print(
                        self.command,
                        for_programs(&path, &ended, case_ends, last.as_ref(), self.warnings, None),
                    )?;
                }
                Ok(ExitCode::from(128 + signal))
            }
        }
    }
}

/// How a run ended, for programs.
struct Ended {
    outcome: &'static str,
    step: u64,
    /// The step at which this process took it up.
    first: u64,
    particles: usize,
    took: Duration,
    dt: f64,
}

fn for_programs(
    run: &Path,
    ended: &Ended,
    case_ends: u64,
    last: Option<&Progress>,
    warnings: &Problems,
    hash: Option<&Value>,
) -> Value {
    let steps = ended.step.saturating_sub(ended.first);
    let secs = ended.took.as_secs_f64();
    json!({
        "ok": ended.outcome == "finished",
        "run": run.to_string_lossy(),
        "outcome": ended.outcome,
        "step": ended.step,
        "steps_of_case": case_ends,
        "time": last.map_or(ended.step as f64 * ended.dt, |last| last.time),
        "step_seconds": ended.dt,
        "particles": ended.particles,
        "steps_done": steps,
        "wall_clock_secs": json::seconds(ended.took),
        "particle_steps_per_second": ended.particles as f64 * steps as f64 / secs.max(1e-9),
        "ledger": last.map(|last| json::ledger(&last.ledger)),
        "ledger_step": last.map(|last| last.ledger_step),
        "hash": hash,
        "warnings": Reports::from(warnings).json(),
    })
}

impl Work<'_> {
    /// Tells the log what computes, and what the case was warned of.
    fn introduce(&self) -> Result<(), Reports> {
        let machine = format!("tdem {} on {}", env!("TDEM_VERSION"), self.device);
        self.directory.log(&Event::Machine(machine))?;
        let (first, rest) = self.warnings.problems.split_at(self.warnings.problems.len().min(LOGGED));
        for warning in first {
            self.directory.log(&Event::Warning(warning.message.clone()))?;
        }
        if !rest.is_empty() {
            let more =
                format!("and {} more warnings of the case, which `tdem check` shows", grouped(rest.len() as u64));
            self.directory.log(&Event::Warning(more))?;
        }
        Ok(())
    }
}

/// Overlap over the smaller radius from which on it is warned of: the contact radius is then 0.16 of the radius, no
/// longer small.
const LARGE_OVERLAP: f64 = 0.05;

/// The largest overlap in the rows of a run's history and its time, if it has rows.
fn largest_overlap(run: &Path) -> Option<[f64; 2]> {
    let column = |name| curve::history_column(run, name).ok();
    let rows = column("largest_overlap")?.into_iter().zip(column("time")?);
    rows.filter(|(overlap, _)| overlap.is_finite())
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(overlap, time)| [overlap, time])
}

/// That spheres overlapped more than a law of small overlaps is for.
fn large_overlap(largest: f64, time: f64) -> String {
    format!(
        "particles overlapped by up to {} % of the smaller radius of a pair or of the radius at a wall, at t = {} s",
        number(100.0 * largest, 3),
        short(time)
    )
}

/// Warnings of a case that the log takes.
const LOGGED: usize = 20;

/// Leaves what belongs to the end of a run beside its results: the curves, whose files are returned, the hash in the log, and the
/// page.
pub(crate) fn conclude(
    directory: &RunDirectory,
    loaded: &Loaded,
    hashed: Option<&State>,
) -> Result<Vec<PathBuf>, Reports> {
    let curves = draw(directory.path(), &cases::curves(&loaded.case));
    if let Some(state) = hashed {
        directory.log(&Event::Hash { step: state.step, hash: hash(state) })?;
    }
    leave_page(directory.path(), loaded);
    Ok(curves)
}

fn leave_page(run: &Path, loaded: &Loaded) {
    if let Err(error) = report::at_the_end(run, loaded) {
        render::warn(&Report::new(codes::REPORT, error.to_string()).into());
    }
}

/// That heat went on although particles were not at rest.
fn unrelaxed(turns: &Turns) -> String {
    format!(
        "particles were not at rest behind {}, the last of them step {}: heat went on with a ratio of forces of up to {}",
        counted(turns.unrelaxed, "step"),
        grouped(turns.last_unrelaxed),
        number(turns.largest_ratio, 3)
    )
}

/// Draws all curves that can be drawn, and returns their files. The rest of the run is whole without them.
pub(crate) fn draw(run: &Path, curves: &[Curve]) -> Vec<PathBuf> {
    let (drawn, failed): (Vec<_>, Vec<_>) = curves.iter().map(|curve| curve::draw(run, curve)).partition(Result::is_ok);
    let failed = failed.into_iter().filter_map(Result::err);
    render::warn(&failed.map(|error| Report::new(codes::CURVE, error.to_string())).collect());
    drawn.into_iter().flatten().collect()
}

/// The line that `--hash` promises.
pub(crate) fn print_hash(state: &State) -> Result<(), Reports> {
    data(format!("hash {}", hash(state)))
}

fn hash(state: &State) -> String {
    format!("{:032x}", state.hash())
}

/// A run that stopped amid its steps.
pub(crate) fn fault_report(error: RunError, dt: f64) -> Reports {
    match error {
        RunError::Results(error) => error.into(),
        RunError::Fault { fault, checkpoint, path } => {
            let run = argument(&path);
            let whole = format!("what was written is whole: `tdem info {run}` lists it");
            let help = match &fault {
                Fault::Device(error) => format!(
                    "{}\n{whole}\n`tdem resume {run} --device cpu` goes on from step {checkpoint}, to the same bits",
                    device_help(error)
                ),
                _ => format!(
                    "{}{whole}\n`tdem resume {run}` goes on from step {checkpoint}, and meets the same fault unless \
                     --steps ends before it; after changing the case: `tdem run CASE.toml --overwrite`",
                    cause(&fault, dt)
                ),
            };
            let message = format!("{}; the last good checkpoint is of step {checkpoint}", told(&fault));
            Report::new(fault_code(&fault), message).help(help).into()
        }
    }
}

/// What most often is behind a fault.
fn cause(fault: &Fault, dt: f64) -> String {
    match fault {
        Fault::NotFinite { .. }
        | Fault::Unbounded { .. }
        | Fault::Escaped { .. }
        | Fault::Overlap { .. }
        | Fault::WallOverlap { .. } => format!(
            "most often the time step is too large (it is {} s; `tdem check` shows the limits), or something was \
             prescribed that pushes particles into each other or through walls\n",
            short(dt)
        ),
        Fault::Temperature { .. } => {
            "the time scale of the heat is too large for this step, or the surroundings are\n".to_owned()
        }
        _ => String::new(),
    }
}

/// The fault in words.
fn told(fault: &Fault) -> String {
    match fault {
        Fault::Device(gpu::Error::OutOfMemory { bytes: asked }) => {
            format!("the device has no room for {} more", bytes(*asked as u64))
        }
        fault => fault.to_string(),
    }
}

/// What to do about a device.
fn device_help(error: &gpu::Error) -> &'static str {
    match error {
        gpu::Error::Missing { .. } => "`tdem info` lists the devices that there are",
        gpu::Error::OutOfMemory { .. } => {
            "`tdem check` tells how much memory a case takes in all, `tdem info` how much a device has; other programs \
             may hold some of it\ntake fewer particles, a model without moments, output.ledger = false, or another device"
        }
        gpu::Error::Compile { .. } => {
            "no case should cause this: please report it with what the compiler said, the lines of `tdem info`, and the \
             output of `tdem kernels CASE.toml`"
        }
        gpu::Error::Call { .. } => {
            "most often the device or its driver has failed, or another program has taken the device down: `tdem info` \
             tests it"
        }
    }
}

fn fault_code(fault: &Fault) -> Code {
    match fault {
        Fault::NotFinite { .. } => codes::NOT_FINITE,
        Fault::Escaped { .. } => codes::ESCAPED,
        Fault::Temperature { .. } => codes::TEMPERATURE,
        Fault::Unbounded { .. } => codes::UNBOUNDED,
        Fault::Conduction { .. } => codes::CONDUCTION,
        Fault::Overlap { .. } | Fault::WallOverlap { .. } => codes::OVERLAP,
        Fault::ListOverflow { .. } => codes::LIST_OVERFLOW,
        Fault::BoxTooSmall { .. } => codes::BOX_TOO_SMALL,
        Fault::Threads { .. } => codes::RUN_THREADS,
        Fault::Inconsistent { .. } => codes::INCONSISTENT,
        Fault::Device(gpu::Error::Missing { .. }) => codes::DEVICE_MISSING,
        Fault::Device(gpu::Error::OutOfMemory { .. }) => codes::OUT_OF_MEMORY,
        Fault::Device(gpu::Error::Compile { .. }) => codes::DEVICE_COMPILE,
        Fault::Device(gpu::Error::Call { .. }) => codes::DEVICE_CALL,
    }
}

impl From<Fault> for Reports {
    /// A fault before the first step.
    fn from(fault: Fault) -> Self {
        let report = Report::new(fault_code(&fault), told(&fault));
        match &fault {
            Fault::Device(error) => {
                report.help(format!("{}\n`--device cpu` works everywhere, with the same bits", device_help(error)))
            }
            _ => report,
        }
        .into()
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
                return Report::new(codes::RUN_EXISTS, format!("{path} holds a run already")).help(help).into();
            }
            Error::NotARun { path } => {
                return Report::new(
                    codes::NOT_A_RUN,
                    format!("{} is not a run: there is no `case.toml` in it", run(path)),
                )
                .help("name the directory that `tdem run` made; without --out it is runs/<name of the case file>")
                .into();
            }
            Error::DiskFull { .. } => (codes::DISK_FULL, None),
            Error::FileTooLarge { .. } => (codes::FILE_TOO_LARGE, None),
            Error::Io { .. } => {
                (codes::IO, Some("check that the path exists, that it may be written, and that the disk is there"))
            }
            Error::Format { .. } => (codes::FORMAT, None),
            Error::Locked { .. } => (codes::LOCKED, None),
            Error::Linked { .. } => {
                (codes::LINKED, Some("remove the link; to keep a run elsewhere, link its whole directory"))
            }
            Error::Frame { .. } | Error::FrameList { .. } => (codes::NO_GOOD_FRAME, None),
            Error::Occupied { .. } => (codes::OCCUPIED, Some("choose another directory with --out")),
            Error::NoCheckpoint { .. } | Error::Damaged(_) => {
                (codes::NO_CHECKPOINT, Some("`tdem info` on the run tells what is wrong with each checkpoint"))
            }
            Error::NoFrames { .. } => (codes::NO_FRAMES, Some("a case writes frames unless it says output.frames = 0")),
            Error::NoFrameOfStep { .. } => (codes::NO_FRAMES, Some("`tdem info` lists the frames that there are")),
            Error::HistoryColumns { .. } => (codes::HISTORY_COLUMNS, None),
            Error::PictureSize { .. } | Error::PictureMemory { .. } => (codes::PICTURE_SIZE, None),
            Error::Picture { .. } => (codes::PICTURE, None),
            Error::NoColumn { .. } | Error::Drawing { .. } => (codes::CURVE, None),
        };
        let report = Report::new(code, error.to_string());
        match help {
            Some(help) => report.help(help).into(),
            None => report.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render;

    #[test]
    fn a_device_that_fails_is_told_with_its_size_and_a_way_on() {
        let full = || Fault::Device(gpu::Error::OutOfMemory { bytes: 3_200_000_000 });
        let before = render::text(&full().into());
        for part in ["tdem::device::out-of-memory", "no room for 3.2 GB more", "tdem check", "--device cpu"] {
            assert!(before.contains(part), "`{part}` is not in:\n{before}");
        }
        let amid = RunError::Fault { fault: full(), checkpoint: 700, path: "runs/silo".into() };
        let amid = render::text(&fault_report(amid, 1e-5));
        assert!(amid.contains("tdem resume runs/silo --device cpu` goes on from step 700"), "{amid}");
        assert!(!amid.contains("meets the same fault"), "{amid}");
        let call = gpu::Error::Call { call: "cuLaunchKernel", message: "an illegal access".to_owned() };
        let call = render::text(&Fault::Device(call).into());
        assert!(call.contains("tdem::device::call") && call.contains("cuLaunchKernel"), "{call}");
    }
}
