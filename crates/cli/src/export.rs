//! `tdem export`: particles of a run in formats of other programs.

use crate::cases;
use crate::console::data;
use crate::render::Reports;
use crate::units::argument;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_results::Error;
use tdem_results::export::{self, Instants, export};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The directory of the run
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// The format
    #[arg(long, value_enum)]
    format: Format,
    /// The frame of this step
    #[arg(long, value_name = "N", conflicts_with_all = ["last", "all"])]
    step: Option<u64>,
    /// The last frame, which is meant without any of these
    #[arg(long, conflicts_with = "all")]
    last: bool,
    /// All frames
    #[arg(long)]
    all: bool,
    /// The file; that of the list of files with vtp [default: DIR/export/particles and the ending of the format]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  tdem export runs/packing --format xyz --all        for OVITO, all instants in one file
  tdem export runs/packing --format lammps --all     a text dump, for what reads those of LAMMPS
  tdem export runs/packing --format vtp --all        a file per instant, and particles.pvd for ParaView and VisIt
  tdem export runs/packing --format csv --step 9320 --out settled.csv

What is exported are the particles of frames, with all fields that these have. Coordinates in SI units.";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// Extended XYZ, for OVITO
    Xyz,
    /// Text dump of LAMMPS
    Lammps,
    /// VTK's poly data in XML
    Vtp,
    /// Values separated by commas
    Csv,
}

impl Format {
    fn with_ending(self) -> (export::Format, &'static str) {
        match self {
            Format::Xyz => (export::Format::Xyz, "xyz"),
            Format::Lammps => (export::Format::Lammps, "dump"),
            Format::Vtp => (export::Format::Vtp, "pvd"),
            Format::Csv => (export::Format::Csv, "csv"),
        }
    }
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let run = &arguments.run;
    if !run.join("case.toml").exists() {
        return Err(Error::NotARun { path: run.clone() }.into());
    }
    let loaded = cases::load(&run.join("case.toml"), &[])?;
    let instants = match arguments.step {
        Some(step) => Instants::Step(step),
        None if arguments.all => Instants::All,
        None => Instants::Last,
    };
    let (format, ending) = arguments.format.with_ending();
    let default = || run.join("export").join("particles").with_extension(ending);
    let out = arguments.out.clone().unwrap_or_else(default);
    let files = export(run, format, instants, &cases::domain(&loaded.case), &out)?;
    for file in files {
        data(argument(&file))?;
    }
    Ok(ExitCode::SUCCESS)
}
