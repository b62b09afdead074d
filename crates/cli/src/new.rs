//! `tdem new`: a case to begin with.

use crate::codes;
use crate::console::say;
use crate::files::refused;
use crate::picture::one_of;
use crate::render::{self, Report, Reports};
use crate::units::argument;
use clap::Args;
use std::fs::{OpenOptions, remove_file};
use std::io::{ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_case::{SCHEMA_FILE, Starter, json_schema, starter};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Name of the case; NAME.toml is written and never replaced
    #[arg(value_name = "NAME")]
    name: PathBuf,
    /// What it is about
    #[arg(long, value_name = "STARTER", default_value = "packing", value_parser = one_of(&STARTERS))]
    from: Starter,
}

/// Starters with what they are about.
static STARTERS: [(Starter, &str, &str); 4] =
    [of(Starter::Packing), of(Starter::Heating), of(Starter::Bonded), of(Starter::Quench)];

const fn of(starter: Starter) -> (Starter, &'static str, &'static str) {
    let (word, about) = starter.told();
    (starter, word, about)
}

const EXAMPLES: &str = "\
Examples:
  tdem new silo                    spheres that fall into a box
  tdem new disc --from quench      a ceramic disc that cracks from its rim

The JSON schema of case files is written beside it, for editors that complete and explain keys; see docs/case-file.md.";

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
    if let Err(error) = file.write_all(starter(arguments.from, &title).as_bytes()) {
        let _ = remove_file(&path);
        return Err(refused(&path, &error));
    }
    // Whoever has no editor that reads it misses nothing without it.
    let schema = path.with_file_name(SCHEMA_FILE);
    if !schema.exists()
        && let Err(error) = std::fs::write(&schema, format!("{:#}\n", json_schema()))
    {
        render::warn(&refused(&schema, &error));
    }
    let case = argument(&path);
    say(format!("Wrote {case}.\n  tdem check {case}    shows what it costs\n  tdem run {case}      runs it"));
    Ok(ExitCode::SUCCESS)
}
