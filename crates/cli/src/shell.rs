//! What shells and editors ask for: the schema, completions, manual pages.

use crate::command::Cli;
use crate::console::data;
use crate::files::refused;
use crate::render::Reports;
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args, Debug)]
pub(crate) struct Completions {
    /// The shell
    shell: Shell,
}

#[derive(Args, Debug)]
pub(crate) struct Man {
    /// Write a page for each command into this folder instead
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

pub(crate) fn schema() -> Result<ExitCode, Reports> {
    data(format_args!("{:#}", tdem_case::json_schema()))?;
    Ok(ExitCode::SUCCESS)
}

pub(crate) fn completions(arguments: &Completions) -> Result<ExitCode, Reports> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "tdem", &mut text);
    data(String::from_utf8_lossy(&text).trim_end())?;
    Ok(ExitCode::SUCCESS)
}

pub(crate) fn man(arguments: &Man) -> Result<ExitCode, Reports> {
    if let Some(folder) = &arguments.out {
        fs::create_dir_all(folder)
            .and_then(|()| clap_mangen::generate_to(Cli::command(), folder))
            .map_err(|error| refused(folder, &error))?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut text = Vec::new();
    // Writing into memory cannot fail.
    let _ = clap_mangen::Man::new(Cli::command()).render(&mut text);
    data(String::from_utf8_lossy(&text).trim_end())?;
    Ok(ExitCode::SUCCESS)
}
