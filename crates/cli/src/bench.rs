//! `tdem bench`: how fast this machine is, as data.

use crate::bench_case;
use crate::bench_figures;
use crate::codes;
use crate::console::{data, say};
use crate::files;
use crate::machine::{instructions, processor, width};
use crate::render::{Report, Reports};
use clap::{Args, Subcommand, ValueEnum};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_engine::cpu;
use tdem_engine::physics::contact::Law;
use tdem_studies::bench::{ContactBlock, Measurement, contact};

#[derive(Args, Debug)]
#[command(arg_required_else_help = true, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, after_help = bench_figures::HELP)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    benchmark: Option<Benchmark>,
    #[command(flatten)]
    figures: bench_figures::Arguments,
}

#[derive(Debug, Subcommand)]
enum Benchmark {
    /// Contacts and motion of a block of touching spheres: particle-steps per second, bytes per particle
    Contact(Contact),
    /// Whole steps of a case on any device, and where their time goes
    Case(bench_case::Arguments),
}

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  tdem bench contact                        all models on one thread and on two
  tdem bench contact --model gntm --threads 1,2,4,8 --json contact.json

The scene: 64,000 spheres on a face-centred cubic lattice, pressed together by 0.1 %, about 11.2 contacts each (both \
ends counted), material of cases/packing.toml, steps of 1e-6 s. The neighbour list holds all the time, so the figure is \
that of contacts and motion. Hashes are those of the final states: the same on every machine and for any threads.")]
struct Contact {
    /// Models, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Model::Gn, Model::Gnt, Model::Gntm])]
    model: Vec<Model>,
    /// Numbers of threads, separated by commas
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,
    /// Lattice cells per direction, four spheres each
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', num_args = 1, default_value = "20,20,40", value_parser = clap::value_parser!(u16).range(1..=400))]
    cells: Vec<u16>,
    /// Steps per measurement
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..))]
    steps: u64,
    /// Measurements of each kind; best and median are reported
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    /// Contacts one by one instead of eight at a time
    #[arg(long)]
    scalar: bool,
    /// Book dissipated energy in every step, as runs do by default
    #[arg(long)]
    ledger: bool,
    /// Write the measurements to a JSON file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Model {
    /// Normal force
    Gn,
    /// Normal and tangential force
    Gnt,
    /// Normal and tangential force, moments
    Gntm,
}

impl Model {
    fn law(self) -> Law {
        match self {
            Model::Gn => Law::GN,
            Model::Gnt => Law::GNT,
            Model::Gntm => Law::GNTM,
        }
    }
    fn name(self) -> &'static str {
        match self {
            Model::Gn => "GN",
            Model::Gnt => "GNT",
            Model::Gntm => "GNTM",
        }
    }
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let arguments = match &arguments.benchmark {
        None => return bench_figures::execute(&arguments.figures),
        Some(Benchmark::Case(arguments)) => return bench_case::execute(arguments),
        Some(Benchmark::Contact(arguments)) => arguments,
    };
    let &[x, y, z] = &arguments.cells[..] else {
        return Err(Report::new(codes::BENCH_CELLS, "--cells takes three numbers, such as 20,20,40").into());
    };
    if let Some(path) = &arguments.json {
        files::try_to_write(path)?;
    }
    let mut rows = Vec::new();
    for &model in &arguments.model {
        for &threads in &arguments.threads {
            let block = ContactBlock {
                law: model.law(),
                cells: [x, y, z].map(usize::from),
                steps: arguments.steps,
                repeats: usize::from(arguments.repeats),
                ledger: arguments.ledger,
            };
            let options = cpu::Options {
                threads: Some(usize::from(threads)),
                width: width(arguments.scalar),
                ..cpu::Options::default()
            };
            say(format!("{} on {threads} ...", model.name()));
            let measured = contact(&block, &options.into())
                .map_err(|fault| Report::new(codes::BENCH_FAULT, format!("the benchmark broke: {fault}")))?;
            rows.push((model, measured));
        }
    }
    data(table(&rows))?;
    if let Some(path) = &arguments.json {
        files::write(path, json(arguments, &rows).as_bytes())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn table(rows: &[(Model, Measurement)]) -> String {
    let mut text = String::from(
        "model  threads  particles  contacts/particle  best, particle-steps/s  median     bytes/particle  hash",
    );
    for (model, m) in rows {
        let _ = write!(
            text,
            "\n{:<5}  {:>7}  {:>9}  {:>17.2}  {:>22.3e}  {:>9.3e}  {:>14.1}  {:032x}",
            model.name(),
            m.threads,
            m.particles,
            m.contacts_per_particle,
            m.best_rate,
            m.median_rate,
            m.bytes_per_particle,
            m.hash
        );
    }
    text
}

/// The measurements and what they were made on.
fn json(arguments: &Contact, rows: &[(Model, Measurement)]) -> String {
    let rows: Vec<serde_json::Value> = rows
        .iter()
        .map(|(model, m)| {
            serde_json::json!({
                "model": model.name(),
                "threads": m.threads,
                "particles": m.particles,
                "contacts_per_particle": m.contacts_per_particle,
                "steps": m.steps,
                "best_particle_steps_per_second": m.best_rate,
                "median_particle_steps_per_second": m.median_rate,
                "bytes_per_particle": m.bytes_per_particle,
                "hash": format!("{:032x}", m.hash),
            })
        })
        .collect();
    let document = serde_json::json!({
        "benchmark": "contact",
        "version": env!("CARGO_PKG_VERSION"),
        "precision": "f64",
        "device": "CPU",
        "processor": processor(),
        "instructions": if arguments.scalar { "one contact at a time" } else { instructions() },
        "ledger": arguments.ledger,
        "repeats": arguments.repeats,
        "measurements": rows,
    });
    format!("{document:#}\n")
}
