//! `tdem bench case`: whole steps of a case on any device, and where their time goes.

use crate::bench_stages;
use crate::cases::{build, key_value, load};
use crate::codes;
use crate::console::{data, say};
use crate::device::{Choice, Found, word};
use crate::files;
use crate::machine::{instructions, processor};
use crate::render::{Report, Reports};
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tdem_case::Loaded;
use tdem_engine::cpu;
use tdem_studies::bench::{Measurement, Phase};

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  tdem bench case cases/packing.toml --set size=3m --device cuda --models GN,GNT,GNTM
  tdem bench case cases/packing.toml --set size=83k --device cpu,opencl --steps 100 --kernels
  tdem bench case cases/packing.toml --set size=3m --device cuda --paper
  tdem bench case cases/heating.toml --set size=3m --device cuda --models TBPM,BPM

Whole steps are measured: contacts, walls, motion, and search as often as it is due; nothing is written, and no ledger is \
kept unless it is asked for. Hashes are those of the final states: the same on every device.

Then some steps more are taken with a clock around each stage; what is one kernel otherwise is several then, so that the \
sum of the stages is more than a whole step. GB are the least that must be moved: all that is needed read once, all that \
changes written once, whatever caches make of it. They are compared with a copy of large arrays on the same device, bytes \
read and bytes written both counted: a case that fits into caches can be faster. Where steps take microseconds, launching \
and timing a kernel counts, too.")]
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
    /// Models, separated by commas, instead of the case's; BPM of a case with heat is the same without it
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
    /// Steps with stages apart, after the measurement; 0 leaves them out
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(..=100_000))]
    profile: u64,
    /// Show each kernel of a search
    #[arg(long)]
    kernels: bool,
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

/// A measurement and what it was made on.
struct Row {
    model: String,
    found: Found,
    measured: Measurement,
}

/// The case with another model, if one is wanted; BPM of a case with heat is the same without it.
fn of_model(case: &Path, mut set: Vec<(String, String)>, model: Option<&String>) -> Result<Loaded, Reports> {
    let Some(model) = model else { return load(case, &set) };
    if model == "BPM" {
        let given = load(case, &set)?;
        if given.case.heat.is_some() {
            return Ok(given.without_heat());
        }
    }
    set.push(("model".to_owned(), model.clone()));
    load(case, &set)
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    if let Some(path) = &arguments.json {
        files::try_to_write(path)?;
    }
    let models = if arguments.models.is_empty() { vec![None] } else { arguments.models.iter().map(Some).collect() };
    let phase = Phase {
        after: arguments.after,
        steps: arguments.steps,
        repeats: usize::from(arguments.repeats),
        profile: arguments.profile,
    };
    let mut rows = Vec::new();
    for model in models {
        let mut set = arguments.set.clone();
        if arguments.paper {
            set.push(("time.integrator".to_owned(), "gear".to_owned()));
        }
        let loaded = of_model(&arguments.case, set, model)?;
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
                .map_err(|fault| Report::new(codes::BENCH_FAULT, format!("the benchmark broke: {fault}")))?;
            rows.push(Row { model: model.clone(), found, measured });
        }
    }
    for row in &rows {
        if let Some(table) = bench_stages::table(&row.measured, arguments.kernels) {
            data(format!("{} on {}, {table}\n", row.model, row.found.name))?;
        }
    }
    data(table(&rows))?;
    if let Some(path) = &arguments.json {
        let document = json!({
            "benchmark": "case",
            "case": arguments.case.display().to_string(),
            "set": arguments.set.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>(),
            "version": env!("CARGO_PKG_VERSION"),
            "precision": "f64",
            "paper_mode": arguments.paper,
            "ledger": arguments.ledger,
            "repeats": arguments.repeats,
            "measurements": rows.iter().map(|row| entry(arguments, row)).collect::<Vec<_>>(),
        });
        files::write(path, format!("{document:#}\n").as_bytes())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// A line for each measurement.
fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "particle-steps/s of whole steps; contacts of a particle, both ends counted; memory of the run per particle\n\
         model  device                          particles  contacts       best     median  searches  B/particle  \
         GB/step  % of copy  hash",
    );
    for Row { model, found, measured } in rows {
        let gigabytes = measured.profiled.as_ref().map(|profiled| 1e-9 * profiled.profile.bytes_per_step);
        let _ = write!(
            text,
            "\n{model:<5}  {:<30}  {:>9}  {:>8.2}  {:>9.3e}  {:>9.3e}  {:>8}  {:>10.1}  {:>7}  {:>9}  {:032x}",
            label(found),
            measured.particles,
            measured.contacts_per_particle,
            measured.best_rate,
            measured.median_rate,
            measured.searches,
            measured.bytes_per_particle,
            gigabytes.map_or("-".to_owned(), bench_stages::gigabytes),
            measured.copy_fraction().map_or("-".to_owned(), |fraction| format!("{:.1}", 100.0 * fraction)),
            measured.hash
        );
    }
    text
}

/// A device in a narrow column: what tells it from others comes first.
fn label(found: &Found) -> String {
    let name = match &found.listing {
        Some(listing) => format!("{}:{} {}", word(listing.api), listing.index, listing.name),
        None => found.name.clone(),
    };
    name.chars().take(30).collect()
}

/// A measurement as data.
fn entry(arguments: &Arguments, Row { model, found, measured }: &Row) -> Value {
    let mut entry = json!({
        "model": model,
        "device": found.name,
        "machine": machine(found),
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
    });
    if let Some(profiled) = &measured.profiled {
        entry["bytes_per_step"] = profiled.profile.bytes_per_step.into();
        entry["copy_bytes_per_second"] = profiled.copy_bandwidth.into();
        entry["fraction_of_copy"] = measured.copy_fraction().into();
        entry["profile"] = bench_stages::json(&profiled.profile);
    }
    entry
}

/// What the device is, or the processor.
fn machine(found: &Found) -> Value {
    match &found.listing {
        Some(listing) => json!({
            "interface": word(listing.api),
            "index": listing.index,
            "name": listing.name,
            "driver": listing.driver,
            "memory_bytes": listing.memory,
            "compute_units": listing.compute_units,
        }),
        None => json!({ "processor": processor(), "instructions": instructions() }),
    }
}
