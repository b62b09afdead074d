//! `tdem resume`: a run goes on from its last good checkpoint.

use crate::cases;
use crate::codes;
use crate::console::say;
use crate::json;
use crate::render::{self, Report, Reports};
use crate::signals::Signals;
use crate::units::{argument, counted, grouped, short};
use crate::work::{self, Work, print_hash};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tdem_case::{Built, Change, Loaded};
use tdem_engine::{Schedule, Simulation, State};
use tdem_results::words::cut;
use tdem_results::{Error, Event, Resumed, RunDirectory, case_that_ran, session};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The directory of the run
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// Go on although case.toml was changed since the run began, with what it says now
    #[arg(long)]
    accept_changes: bool,
    #[command(flatten)]
    pub(crate) work: work::Arguments,
}

const EXAMPLES: &str = "\
Examples:
  tdem resume runs/packing
  tdem resume runs/packing --steps 50000 --hash
  tdem resume runs/packing --device cuda
  tdem resume runs/packing --accept-changes

The result is the same to the last bit as if the run had never been interrupted, on any device.";

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let run = &arguments.run;
    let case = run.join("case.toml");
    if !case.exists() {
        return Err(Error::NotARun { path: run.clone() }.into());
    }
    let loaded = cases::load(&case, &[])?;
    let ran = Ran::of(run, &loaded)?;
    if let (Some(told), false) = (ran.told(run), arguments.accept_changes) {
        return Err(told.into());
    }
    let signals = Signals::catch()?;
    arguments.work.machine.prepare()?;
    let device = arguments.work.machine.find()?;
    let built = cases::build(&loaded)?;
    let schedule = arguments.work.schedule(built.schedule);
    let mut resumed = RunDirectory::open(run)?;
    tell(&resumed, &schedule)?;
    if let Some(state) = resumed.state.as_ref().filter(|state| !cases::belongs(state, &built)) {
        let message = format!("the checkpoint of step {} does not belong to {}", state.step, argument(&case));
        return Err(Report::new(codes::RESULTS_OTHER_CASE, message)
            .help(
                "a table or a run that the case names has changed since, or the case was edited; put the old one back, \
                 or run the case again",
            )
            .into());
    }
    ran.accept(&resumed)?;
    let state = match resumed.state.take() {
        Some(state) if state.step >= schedule.steps => {
            return finished(arguments, resumed.directory, &loaded, &built, &state, &schedule);
        }
        Some(state) => state,
        None => built.state,
    };
    let directory = resumed.directory;
    if !arguments.work.quiet {
        let from = if directory.last_checkpoint().is_some() {
            format!("goes on from the checkpoint of step {}", grouped(state.step))
        } else {
            "had no checkpoint yet and begins again".to_owned()
        };
        say(format!(
            "{} {from}, t = {} s; {} particles, to step {}\n  {:<14} {}",
            argument(run),
            short(built.plan.time(state.step)),
            grouped(state.len() as u64),
            grouped(schedule.steps),
            "device",
            device.name
        ));
    }
    let machine = device.in_full();
    let simulation = Simulation::new(state, built.plan, device.device)?;
    let work = Work {
        directory,
        loaded: &loaded,
        of_case: built.schedule,
        fields: built.fields,
        device: machine,
        warnings: &built.warnings,
        arguments: &arguments.work,
        command: "resume",
        signals,
    };
    work.run(simulation)
}

/// Tells what was found wrong in the folder of a run, and the log what only the schedule shows.
fn tell(resumed: &Resumed, schedule: &Schedule) -> Result<(), Reports> {
    let damaged = resumed.damaged.iter().map(|damaged| {
        let told = Report::new(codes::DAMAGED_CHECKPOINT, damaged.to_string());
        told.help("the one before it is used; steps since then are computed again")
    });
    let frames = resumed.unreadable_frames.iter();
    let frames = frames.map(|unreadable| Report::new(codes::UNREADABLE_FRAME, unreadable.to_string()));
    let start = resumed.start_lost.iter().map(|lost| {
        let told = Report::new(codes::START_LOST, format!("displacements are not known any more, {lost}"));
        told.help("frames from here on hold not a number for them; all else goes on as before")
    });
    let before = resumed.state.as_ref().map_or(0, |state| state.step);
    let holes = resumed.history.holes(schedule.history_every, before);
    if let Some(holes) = &holes {
        resumed.directory.log(&Event::Warning(holes.clone()))?;
    }
    let rows = resumed.history.told().into_iter().chain(holes);
    let rows = rows.map(|told| Report::new(codes::DAMAGED_HISTORY, told));
    render::warn(&damaged.chain(frames).chain(start).chain(rows).collect());
    Ok(())
}

/// A run that has no steps left: what its end writes is written, as far as it is not there.
fn finished(
    arguments: &Arguments,
    mut directory: RunDirectory,
    loaded: &Loaded,
    built: &Built,
    state: &State,
    schedule: &Schedule,
) -> Result<ExitCode, Reports> {
    directory.set_contents(cases::contents(built.fields));
    directory.set_names(cases::names(&loaded.case));
    directory.set_pictures(cases::pictures(&loaded.case));
    // One that went further than is asked for ended elsewhere.
    if state.step == schedule.steps {
        session::complete(&mut directory, state, &built.plan, schedule)?;
    }
    let hashed = arguments.work.hash.then_some(state);
    work::conclude(&directory, loaded, hashed)?;
    if !arguments.work.quiet {
        say(format!(
            "{} is finished: its last step is {}, t = {} s. --steps N goes on to a later one.",
            argument(&arguments.run),
            grouped(state.step),
            short(built.plan.time(state.step))
        ));
    }
    if arguments.work.json.json {
        let told = serde_json::json!({
            "ok": true,
            "run": arguments.run.to_string_lossy(),
            "outcome": "finished",
            "step": state.step,
            "time": built.plan.time(state.step),
            "particles": state.len(),
            "hash": hashed.map(|state| json::hash(state.hash())),
        });
        json::print("resume", told)?;
    } else if let Some(state) = hashed {
        print_hash(state)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// How the case of a run compares with what ran.
enum Ran {
    Same,
    /// It is not known what ran, and why.
    Unknown(&'static str),
    Changed(Vec<Change>),
}

impl Ran {
    fn of(run: &Path, loaded: &Loaded) -> Result<Self, Reports> {
        let Some(text) = case_that_ran(run)? else {
            return Ok(Ran::Unknown("the run has no checkpoints/case.toml"));
        };
        let Ok(ran) = tdem_case::parse("case.toml", &text, run, &[]) else {
            return Ok(Ran::Unknown("its checkpoints/case.toml cannot be read"));
        };
        let changes = loaded.changes_since(&ran);
        Ok(if changes.is_empty() { Ran::Same } else { Ran::Changed(changes) })
    }

    /// What was changed, if that is known, and what to do.
    fn told(&self, run: &Path) -> Option<Report> {
        let Ran::Changed(changes) = self else { return None };
        let keys = counted(changes.len() as u64, "value");
        let message = format!("the case of {} was changed in {keys} since it ran", argument(run));
        let help = format!(
            "{}\nput the old back, as checkpoints/case.toml has it, or go on with the new: `tdem resume {} --accept-changes`",
            listed(changes, "\n"),
            argument(run)
        );
        Some(Report::new(codes::CASE_CHANGED, message).help(help))
    }

    /// From here on the present case is what ran.
    fn accept(&self, resumed: &Resumed) -> Result<(), Reports> {
        let told = match self {
            Ran::Same => return Ok(()),
            Ran::Changed(changes) => {
                let told = format!("goes on with a changed case: {}", listed(changes, "; "));
                Some(Report::new(codes::CHANGES_ACCEPTED, told))
            }
            // Nothing was computed yet that another case could belong to.
            Ran::Unknown(_) if resumed.state.is_none() => None,
            Ran::Unknown(why) => {
                let told = format!("{why}: whether its case was changed since it ran is not known");
                Some(Report::new(codes::CASE_UNKNOWN, told))
            }
        };
        if let Some(told) = told {
            resumed.directory.log(&Event::Warning(told.message().to_owned()))?;
            render::warn(&told.into());
        }
        Ok(resumed.directory.accept_case()?)
    }
}

/// Changes that are named; of more only the number is told.
const NAMED: usize = 20;
/// Letters of a value.
const VALUE: usize = 60;

fn listed(changes: &[Change], between: &str) -> String {
    let value =
        |value: &Option<String>| value.as_deref().map_or("nothing".into(), |value| cut(value, VALUE).into_owned());
    let change = |change: &Change| format!("{}: {} -> {}", change.key, value(&change.old), value(&change.new));
    let mut named: Vec<String> = changes.iter().take(NAMED).map(change).collect();
    if changes.len() > NAMED {
        named.push(format!("and {} more", grouped((changes.len() - NAMED) as u64)));
    }
    named.join(between)
}
