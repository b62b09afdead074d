//! `tdem resume`: a run goes on from its last good checkpoint.

use crate::cases;
use crate::codes;
use crate::console::say;
use crate::json;
use crate::pack;
use crate::render::{self, Report, Reports};
use crate::signals::Signals;
use crate::units::{argument, grouped, short};
use crate::work::{self, Work, print_hash};
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_engine::Simulation;
use tdem_results::{Error, Resumed, RunDirectory};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The directory of the run
    #[arg(value_name = "DIR")]
    run: PathBuf,
    #[command(flatten)]
    pub(crate) work: work::Arguments,
}

const EXAMPLES: &str = "\
Examples:
  tdem resume runs/packing
  tdem resume runs/packing --steps 50000 --hash
  tdem resume runs/packing --device cuda

The result is the same to the last bit as if the run had never been interrupted, on any device.";

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let run = &arguments.run;
    let case = run.join("case.toml");
    if !case.exists() {
        return Err(Error::NotARun { path: run.clone() }.into());
    }
    let loaded = cases::load(&case, &[])?;
    let signals = Signals::catch()?;
    arguments.work.machine.prepare()?;
    let device = arguments.work.machine.find()?;
    let built = cases::build(&loaded)?;
    let schedule = arguments.work.schedule(built.schedule);
    let Resumed { directory, state, damaged, unreadable_frames, start_lost } = RunDirectory::open(run)?;
    for damaged in &damaged {
        let told = Report::new(codes::DAMAGED_CHECKPOINT, damaged.to_string());
        render::warn(&told.help("the one before it is used; steps since then are computed again").into());
    }
    pack::warn_of(&unreadable_frames);
    if let Some(lost) = &start_lost {
        let told = Report::new(codes::START_LOST, format!("displacements are not known any more, {lost}"));
        render::warn(&told.help("frames from here on hold not a number for them; all else goes on as before").into());
    }
    let state = match state {
        Some(state) if !cases::belongs(&state, &built) => {
            return Err(Report::new(
                codes::RESULTS_OTHER_CASE,
                format!("the checkpoint of step {} does not belong to {}", state.step, argument(&case)),
            )
            .help(
                "a table or a run that the case names has changed since, or the case was edited; put the old one back, \
                 or run the case again",
            )
            .into());
        }
        Some(state) if state.step >= schedule.steps => {
            if !arguments.work.quiet {
                say(format!(
                    "{} is finished: its last step is {}, t = {} s. --steps N goes on to a later one.",
                    argument(run),
                    grouped(state.step),
                    short(built.plan.time(state.step))
                ));
            }
            if arguments.work.json.json {
                let told = serde_json::json!({
                    "ok": true,
                    "run": run.to_string_lossy(),
                    "outcome": "finished",
                    "step": state.step,
                    "time": built.plan.time(state.step),
                    "particles": state.len(),
                    "hash": arguments.work.hash.then(|| json::hash(state.hash())),
                });
                json::print("resume", told)?;
            } else if arguments.work.hash {
                print_hash(&state)?;
            }
            return Ok(ExitCode::SUCCESS);
        }
        Some(state) => state,
        None => built.state,
    };
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
