//! `tdem pack`: frames for sending.

use crate::codes;
use crate::console::data;
use crate::render::{self, Report, Reports};
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
    let packed = tdem_results::pack(run, &out, arguments.compression)?;
    warn_of(&packed.damaged);
    for file in packed.files {
        data(file.display())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Tells of frames that are left out, each by its name, but of no more than can be read; and of their list.
pub(crate) fn warn_of(damaged: &[Error]) {
    const SHOWN: usize = 20;
    let warn = |message: String| render::warn(&Report::new(codes::UNREADABLE_FRAME, message).into());
    damaged.iter().take(SHOWN).for_each(|error| warn(error.to_string()));
    if let more @ 1.. = damaged.len().saturating_sub(SHOWN) {
        warn(format!("{more} more frames are damaged or gone; `tdem info` lists them"));
    }
}
