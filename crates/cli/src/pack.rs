//! `tdem pack`: frames for sending.

use crate::console::data;
use crate::render::Reports;
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_results::Error;

#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The directory of the run
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// Folder for the files [default: DIR/packed]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// How hard the files are compressed, 0 to 9
    #[arg(long, value_name = "LEVEL", default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=9))]
    compression: u32,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let run = &arguments.run;
    if !run.join("case.toml").exists() {
        return Err(Error::NotARun { path: run.clone() }.into());
    }
    let out = arguments.out.clone().unwrap_or_else(|| run.join("packed"));
    for file in tdem_results::pack(run, &out, arguments.compression)? {
        data(file.display())?;
    }
    Ok(ExitCode::SUCCESS)
}
