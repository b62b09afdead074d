//! `tdem new`: a case to begin with.

use crate::codes;
use crate::console::say;
use crate::files::refused;
use crate::render::{Report, Reports};
use crate::units::argument;
use clap::Args;
use std::fs::{OpenOptions, remove_file};
use std::io::{ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Name of the case; NAME.toml is written and never replaced
    #[arg(value_name = "NAME")]
    name: PathBuf,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let mut path = arguments.name.clone();
    if path.extension().is_none_or(|ending| ending != "toml") {
        path.as_mut_os_string().push(".toml");
    }
    let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Report::new(codes::FILE_EXISTS, format!("{} exists already", argument(&path)))
            .help("choose another name; no case is ever overwritten")
            .into(),
        _ => refused(&path, &error),
    })?;
    if let Err(error) = file.write_all(tdem_case::starter(&title).as_bytes()) {
        let _ = remove_file(&path);
        return Err(refused(&path, &error));
    }
    let case = argument(&path);
    say(format!("Wrote {case}.\n  tdem check {case}    shows what it costs\n  tdem run {case}      runs it"));
    Ok(ExitCode::SUCCESS)
}
