//! `tdem ladder`: what it costs to let the heat of a case go faster than its motion, or in long steps.

use crate::codes;
use crate::console::{data, say};
use crate::json::{self, Json};
use crate::machine::Machine;
use crate::progress::Meter;
use crate::render::{self, Report, Reports};
use crate::signals::{self, Signals};
use crate::units::{argument, bytes, clock, entry, grouped, number, short};
use crate::{cases, files, ladder_table, memory, summary};
use clap::Args;
use std::fmt::Write;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use tdem_case::{Loaded, Memory};
use tdem_engine::{Plan, Simulation, State};
use tdem_studies::ladder::{
    Earlier, Error, Failure, Halt, Halved, Progress, Rung, climb, folder_of, kept_bytes, prepare, rungs, step_seconds,
};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The case file: one whose heat goes faster than the motion, or advances by itself
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// How often the case runs, each time at half the pace of the heat, or with half its step
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(2..=8))]
    rungs: u32,
    /// Into how many equal parts the time of the heat is divided; at the end of each, runs are compared
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=1000))]
    instants: u32,
    /// Directory for the results [default: runs/NAME-ladder, after the case file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Go on with the ladder that is in the directory, if there is one: rungs that are complete are read, one that was stopped
    /// goes on at its last checkpoint
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Replace the ladder that is in the directory
    #[arg(long)]
    overwrite: bool,
    /// Change a line of the case, as for `tdem run`
    #[arg(long, value_name = "KEY=VALUE", value_parser = cases::key_value)]
    set: Vec<(String, String)>,
    /// Print the results, and say nothing else but warnings and errors
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    pub(crate) json: Json,
    #[command(flatten)]
    machine: Machine,
}

const EXAMPLES: &str = "\
Examples:
  tdem ladder cases/heating.toml
  tdem ladder cases/heating.toml --rungs 2 --set heat.duration=2000.0 --set time.end=0.004
  tdem ladder cases/heating.toml --set size=88k --device cuda --out runs/price
  tdem ladder cases/heating.toml --set size=88k --device cuda --out runs/price --resume

Heat that goes S times as fast as motion leaves bodies less time to follow. The case runs at S, S/2, S/4, ... with the same
step, so that each run takes twice as long as the one before, and runs are compared particle by particle and bond by bond
at equal times of the heat. Where differences halve from one pair to the next (order 1), the first run of a pair is twice
its difference away from what a run without acceleration gives, and the second once.

Heat that is \"frozen\" or in turns with the motion (\"quasi-static\") has its own time: the case then runs with steps of the heat
h, h/2, h/4, ...

Ctrl-C ends the run under way, and so does a fault; all is compared as far as it got. --resume then goes on, to the same
bits, and a script of a queue may always give it. Each run leaves checkpoints and what is compared in rung-1, rung-2, ... of
the directory; frames are not written. A ladder that is there may be given more rungs, or instants that divide the old.

What moves by the clock of the motion (prescribed motion, walls that move, forces along points) would be elsewhere on each rung
of S: such a case is refused. Gravity and constant forces may be there.";

/// The file that stands for the results.
const TABLE: &str = "ladder.csv";
const REPORT: &str = "ladder.md";
/// Steps are timed for about so long before all begins.
const TRIAL: Duration = Duration::from_millis(500);

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let signals = Signals::catch()?;
    let out = arguments.out.clone().unwrap_or_else(|| default_directory(&arguments.case));
    let loaded = cases::load(&arguments.case, &arguments.set)?;
    let (table, document) = (out.join(TABLE), out.join(REPORT));
    let earlier = arguments.earlier();
    if earlier == Earlier::Refuse && is_there(&out, arguments.rungs) {
        let out = argument(&out);
        let help = "go on with it: add --resume\nreplace it: add --overwrite\nkeep both: add --out DIR";
        return Err(Report::new(codes::LADDER_EXISTS, format!("{out} holds a ladder already")).help(help).into());
    }
    arguments.machine.prepare()?;
    let device = arguments.machine.find()?;
    let rungs = rungs(&loaded, arguments.rungs, &cases::run).map_err(report)?;
    let first = &rungs[0].built;
    render::warn(&Reports::from(&first.warnings));
    let needed = first.memory.run_bytes + kept_bytes(&rungs, arguments.instants);
    memory::warn(&Memory { run_bytes: needed, ..first.memory });
    fs::create_dir_all(&out).map_err(|error| files::refused(&out, &error))?;
    files::try_to_write(&table)?;
    files::try_to_write(&document)?;
    if earlier == Earlier::Remove {
        // A ladder that is stopped early writes no table, and the old one would seem to be its own.
        [&table, &document].into_iter().try_for_each(|path| files::remove(path))?;
    }
    let there = prepare(&out, &rungs, earlier).map_err(halted)?;
    let start = |state: State, plan: Plan| Simulation::new(state, plan, device.device);
    if !arguments.quiet {
        // What a trial meets, the first rung will meet and tell.
        let step = step_seconds(&rungs[0], TRIAL, start).ok();
        let machine = entry("device", &device.name) + entry("results in", argument(&out)).trim_end();
        say(before(&loaded, &rungs, &there, step, needed) + &machine);
    }
    let mut meter = Meter::new(arguments.quiet);
    signals.defer();
    let climbed = climb(rungs, arguments.instants, Some(&out), start, &mut |progress: &Progress<'_>| {
        meter.show(progress.done, progress.steps, || line(progress));
        if signals.caught().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    meter.finish();
    let ladder = climbed.map_err(halted)?;
    if arguments.json.json && ladder.failure.is_none() {
        json::print("ladder", ladder_table::for_programs(&ladder, arguments.rungs as usize))?;
    } else if !arguments.json.json && !ladder.rungs.is_empty() {
        data(ladder_table::text(&ladder))?;
    }
    // Where nothing is compared, nothing is worth a file.
    if !ladder.pairs.is_empty() {
        let title = if loaded.case.title.is_empty() { &loaded.source.name } else { &loaded.case.title };
        files::write(&table, ladder_table::csv(&ladder).as_bytes())?;
        files::write(&document, ladder_table::markdown(title, &loaded.source.name, &ladder).as_bytes())?;
        if !arguments.quiet {
            say(format!("Written: {}, {}", argument(&table), argument(&document)));
        }
    }
    let complete = format!("{} of {} rungs are complete", ladder.complete(), arguments.rungs);
    if let Some(Failure { label, fault }) = ladder.failure {
        let message = format!("rung {label} of the ladder came to no end, as above; {complete}");
        let stopped = Report::new(codes::LADDER_FAULT, message);
        return Err(Reports::from(fault).and(stopped.help("`tdem run` shows how far the case gets by itself")));
    }
    let stopped = signals.caught().filter(|_| ladder.complete() < arguments.rungs as usize);
    if let Some(signal) = stopped {
        say(format!("Stopped by {}: {complete}. The same command with --resume goes on.", signals::name(signal)));
    }
    Ok(stopped.map_or(ExitCode::SUCCESS, |signal| ExitCode::from(128 + signal)))
}

impl Arguments {
    fn earlier(&self) -> Earlier {
        match (self.resume, self.overwrite) {
            (true, _) => Earlier::GoOn,
            (_, true) => Earlier::Remove,
            _ => Earlier::Refuse,
        }
    }
}

/// Whether a directory holds anything of a ladder.
fn is_there(out: &Path, rungs: u32) -> bool {
    let files = [out.join(TABLE), out.join(REPORT)].into_iter();
    files.chain((0..rungs as usize).map(|rung| folder_of(out, rung).join("case.toml"))).any(|path| path.exists())
}

fn default_directory(case: &Path) -> PathBuf {
    let mut name = case.file_stem().unwrap_or(case.as_os_str()).to_owned();
    name.push("-ladder");
    Path::new("runs").join(name)
}

/// What is about to run, and how long it will take.
fn before(loaded: &Loaded, rungs: &[Rung], there: &[u64], step_seconds: Option<f64>, needed: u64) -> String {
    let (case, first) = (&loaded.case, &rungs[0].built);
    let steps: Vec<u64> = rungs.iter().map(|rung| rung.built.schedule.steps).collect();
    let listed = |cells: Vec<String>| cells.join(", ");
    let values = listed(rungs.iter().map(|rung| short(rung.value())).collect());
    let pace = match rungs[0].halved {
        Halved::TimeScale => format!("{values} times as fast as motion"),
        Halved::HeatStep => format!("in steps of {values} s"),
    };
    let mut text = format!("{}\n", if case.title.is_empty() { &loaded.source.name } else { &case.title });
    text += &entry("particles", format!("{}, model {:?}", grouped(first.state.len() as u64), case.model));
    text += &entry("heat", format!("{} s, {pace}", short(rungs[0].heat_end())));
    text += &entry("step", summary::step(first));
    text += &entry("steps", listed(steps.iter().map(|&steps| grouped(steps)).collect()));
    text += &entry("memory", format!("about {}", bytes(needed)));
    let done: u64 = there.iter().sum();
    if done > 0 {
        text += &entry("there already", listed(there.iter().map(|&steps| grouped(steps)).collect()) + " steps");
    }
    if let Some(step_seconds) = step_seconds {
        let left = step_seconds * steps.iter().sum::<u64>().saturating_sub(done) as f64;
        let time = Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX);
        text += &entry("time", format!("about {}, by the first steps", clock(time)));
    }
    text
}

/// What matters, the most wanted first.
fn line(progress: &Progress<'_>) -> String {
    let mut line = String::new();
    if let Some(left) = progress.time_left.filter(|_| progress.done < progress.steps) {
        let _ = write!(line, "{} left  ", clock(left));
    }
    let _ = write!(line, "rung {} of {}, {}  ", progress.rung + 1, progress.rungs, progress.label);
    let _ = write!(line, "heat {}/{} s  ", number(progress.heat_time, 3), number(progress.heat_end, 3));
    if progress.cundall_number > 0.0 {
        let _ = write!(line, "{} particle-steps/s", number(progress.cundall_number, 3));
    }
    line.trim_end().to_owned()
}

/// What stands in the way, and what to do.
fn report(error: Error) -> Reports {
    let message = error.to_string();
    let (code, help) = match error {
        Error::NoHeat => (codes::LADDER_NO_HEAT, "a case with a table [heat] is needed, such as cases/heating.toml"),
        Error::NotAccelerated { .. } => (
            codes::LADDER_NOT_ACCELERATED,
            "give the heat a `time_scale` above 1, or a `duration` longer than time.end",
        ),
        Error::TooManyRungs { .. } => (codes::LADDER_TOO_MANY_RUNGS, "ask for fewer with --rungs"),
        Error::FollowsMotion { .. } => (
            codes::LADDER_FOLLOWS_MOTION,
            "hold it still or make it constant, with --set if only for this; constant forces and gravity may be there",
        ),
        Error::Refused { label, problems } => {
            let message = format!("the case is refused on rung {label} of the ladder, as above");
            return Reports::from(problems).and(Report::new(codes::LADDER_REFUSED, message));
        }
        Error::OutOfRange(_) => (codes::LADDER_OUT_OF_RANGE, "ask for fewer rungs with --rungs"),
    };
    Report::new(code, message).help(help).into()
}

/// Why there is nothing to show.
fn halted(halt: Halt) -> Reports {
    let message = halt.to_string();
    let (code, help) = match halt {
        Halt::Different => {
            (codes::LADDER_DIFFERENT, "no case should cause this: please report it with the case and the command")
        }
        Halt::OtherCase { .. } => {
            (codes::LADDER_OTHER_CASE, "begin anew: add --overwrite in place of --resume\nkeep both: add --out DIR")
        }
        Halt::Results(error) => return error.into(),
    };
    Report::new(code, message).help(help).into()
}
