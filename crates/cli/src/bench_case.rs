//! `tdem bench case`: whole steps of a case on any device.

use crate::cases::{build, key_value, load};
use crate::console::{data, say};
use crate::device::Choice;
use crate::render::{Report, Reports};
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_engine::cpu;
use tdem_studies::bench::Phase;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  tdem bench case cases/packing.toml --set size=3m --device cuda --models GN,GNT,GNTM
  tdem bench case cases/packing.toml --set size=83k --device cpu,opencl --steps 100
  tdem bench case cases/packing.toml --set size=3m --device cuda --paper

Whole steps are measured: contacts, walls, motion, and search as often as it is due; nothing is written, and no ledger is
kept unless it is asked for. Hashes are those of the final states: the same on every device.")]
pub(crate) struct Arguments {
    /// The case
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// Replace a value of the case
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_value)]
    set: Vec<(String, String)>,
    /// Devices, separated by commas: auto, cpu, opencl, cuda, cuda:1
    #[arg(long, value_delimiter = ',', default_value = "auto")]
    device: Vec<Choice>,
    /// Models, separated by commas, instead of the case's
    #[arg(long, value_name = "MODEL,...", value_delimiter = ',')]
    models: Vec<String>,
    /// Threads of the CPU [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<u16>,
    /// Steps before the measurement
    #[arg(long, value_name = "N", default_value_t = 10)]
    after: u64,
    /// Steps per measurement
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..))]
    steps: u64,
    /// Measurements; best and median are reported
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    /// As the paper computes: Gear's integrator, a search in every step
    #[arg(long)]
    paper: bool,
    /// Book dissipated energy in every step, as runs do by default
    #[arg(long)]
    ledger: bool,
    /// Write the measurements to a JSON file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let models = if arguments.models.is_empty() { vec![None] } else { arguments.models.iter().map(Some).collect() };
    let phase = Phase { after: arguments.after, steps: arguments.steps, repeats: usize::from(arguments.repeats) };
    let mut rows = Vec::new();
    let mut table = String::from(
        "model  device                          particles  contacts/particle  best, particle-steps/s  median     \
         searches  bytes/particle  hash",
    );
    for model in models {
        let mut set = arguments.set.clone();
        set.extend(model.map(|model| ("model".to_owned(), model.clone())));
        if arguments.paper {
            set.push(("time.integrator".to_owned(), "gear".to_owned()));
        }
        let loaded = load(&arguments.case, &set)?;
        let built = build(&loaded)?;
        let model = format!("{:?}", loaded.case.model);
        for choice in &arguments.device {
            let options = cpu::Options { threads: arguments.threads.map(usize::from), ..cpu::Options::default() };
            let found = choice.find(options)?;
            let mut plan = built.plan.clone();
            plan.ledger = arguments.ledger;
            plan.search.every_step |= arguments.paper;
            say(format!("{model} on {} ...", found.name));
            let measured = phase
                .measure(built.state.clone(), plan, &found.device)
                .map_err(|fault| Report::new("tdem::bench::fault", format!("the benchmark broke: {fault}")))?;
            let _ = write!(
                table,
                "\n{model:<5}  {:<30}  {:>9}  {:>17.2}  {:>22.3e}  {:>9.3e}  {:>8}  {:>14.1}  {:032x}",
                found.name.chars().take(30).collect::<String>(),
                measured.particles,
                measured.contacts_per_particle,
                measured.best_rate,
                measured.median_rate,
                measured.searches,
                measured.bytes_per_particle,
                measured.hash
            );
            rows.push(serde_json::json!({
                "model": model,
                "device": found.name,
                "threads": measured.threads,
                "particles": measured.particles,
                "contacts_per_particle": measured.contacts_per_particle,
                "after": arguments.after,
                "steps": measured.steps,
                "searches": measured.searches,
                "best_particle_steps_per_second": measured.best_rate,
                "median_particle_steps_per_second": measured.median_rate,
                "bytes_per_particle": measured.bytes_per_particle,
                "hash": format!("{:032x}", measured.hash),
            }));
        }
    }
    data(table)?;
    if let Some(path) = &arguments.json {
        let document = serde_json::json!({
            "benchmark": "case",
            "case": arguments.case.display().to_string(),
            "set": arguments.set.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>(),
            "version": env!("CARGO_PKG_VERSION"),
            "precision": "f64",
            "paper_mode": arguments.paper,
            "ledger": arguments.ledger,
            "repeats": arguments.repeats,
            "measurements": rows,
        });
        std::fs::write(path, format!("{document:#}\n")).map_err(|error| {
            Report::new("tdem::bench::json", format!("cannot write the measurements: {error}: {}", path.display()))
        })?;
    }
    Ok(ExitCode::SUCCESS)
}
