//! `tdem kernels`: what a device's compiler is given.

use crate::cases::{build, key_value, load};
use crate::console::data;
use crate::render::Reports;
use clap::Args;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The case
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// Replace a value of the case
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_value)]
    set: Vec<(String, String)>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let built = build(&load(&arguments.case, &arguments.set)?)?;
    data(tdem_engine::gpu::source(&built.state, &built.plan).trim_end())?;
    Ok(ExitCode::SUCCESS)
}
