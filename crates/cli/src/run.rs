//! `tdem run`: a case from its file to its last step.

use crate::console::say;
use crate::render::{self, Reports};
use crate::signals::Signals;
use crate::work::{self, Work};
use crate::{cases, memory, summary};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tdem_engine::Simulation;
use tdem_results::{Error, RunDirectory};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The case file
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// Directory for the results [default: runs/NAME, after the case file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Remove the run that is in the directory, and begin anew
    #[arg(long)]
    overwrite: bool,
    /// Change a line of the case; a preset of the case is chosen with size=NAME
    #[arg(long, value_name = "KEY=VALUE", value_parser = cases::key_value)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    pub(crate) work: work::Arguments,
}

const EXAMPLES: &str = "\
Examples:
  tdem run cases/packing.toml
  tdem run cases/packing.toml --set size=83k --out runs/crystal
  tdem run cases/packing.toml --set time.end=0.5 --set interaction.0.static_friction=0.3
  tdem run cases/packing.toml --set size=3m --device cuda
  tdem run cases/packing.toml --steps 1000 --hash --overwrite

Ctrl-C writes a checkpoint and ends, and so does a terminal that closes; `tdem resume` goes on. A second Ctrl-C ends
at once.";

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let out = arguments.out.clone().unwrap_or_else(|| default_directory(&arguments.case));
    let loaded = cases::load(&arguments.case, &arguments.set)?;
    // Long before anything is built: whoever forgot --out learns it at once.
    if !arguments.overwrite && out.join("case.toml").exists() {
        return Err(Error::RunExists { path: out }.into());
    }
    let signals = Signals::catch()?;
    arguments.work.machine.prepare()?;
    let device = arguments.work.machine.find()?;
    let built = cases::build(&loaded)?;
    render::warn(&Reports::from(&built.warnings));
    memory::warn(&built.memory);
    if !arguments.work.quiet {
        let schedule = arguments.work.schedule(built.schedule);
        say(summary::before(&loaded, &built, &schedule, &device.name, &out));
    }
    let kept = cases::kept(&loaded, &built)?;
    let machine = device.in_full();
    let simulation = Simulation::new(built.state, built.plan, device.device)?;
    let directory = RunDirectory::create(&out, &kept, arguments.overwrite)?;
    let work = Work {
        directory,
        loaded: &loaded,
        of_case: built.schedule,
        fields: built.fields,
        device: machine,
        warnings: &built.warnings,
        arguments: &arguments.work,
        command: "run",
        signals,
    };
    work.run(simulation)
}

fn default_directory(case: &Path) -> PathBuf {
    Path::new("runs").join(case.file_stem().unwrap_or(case.as_os_str()))
}
