//! `tdem explain`: what the code of an error or a warning means, and what to do.

#[cfg(test)]
mod page;

use crate::codes;
use crate::command::EXIT_CODES;
use crate::console::data;
use crate::render::{Report, Reports};
use clap::Args;
use std::process::ExitCode;
use tdem_case::{Code, Severity};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The code, or its end; all codes without any
    #[arg(value_name = "CODE")]
    code: Option<String>,
}

const EXAMPLES: &str = "\
Examples:
  tdem explain tdem::case::through-wall
  tdem explain through-wall
  tdem explain                     all codes, a line each";

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let Some(name) = &arguments.code else {
        data(list().trim_end())?;
        return Ok(ExitCode::SUCCESS);
    };
    let found: Vec<String> = all().filter(|code| code.answers_to(name)).map(explained).collect();
    if found.is_empty() {
        return Err(Report::new(codes::UNKNOWN_CODE, format!("there is no code `{name}`"))
            .help("`tdem explain` lists all codes")
            .into());
    }
    data(found.join("\n\n"))?;
    Ok(ExitCode::SUCCESS)
}

/// All codes: those of cases, then the others, each in the order of the alphabet.
fn all() -> impl Iterator<Item = &'static Code> {
    tdem_case::codes::ALL.iter().chain(codes::ALL)
}

fn word(code: &Code) -> &'static str {
    match code.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}

/// One code in full.
fn explained(code: &Code) -> String {
    let paragraphs: Vec<String> = code.paragraphs().collect();
    format!("{} {}\n\n{}", word(code), code.name, paragraphs.join("\n\n"))
}

/// All codes with their first sentences, and how the program ends.
fn list() -> String {
    let first = |code: &Code| {
        let text = code.paragraphs().next().unwrap_or_default();
        text.split_inclusive(". ").next().unwrap_or_default().trim_end().to_owned()
    };
    let codes = all().map(|code| format!("{:<44} {}\n", code.name, first(code)));
    let exits = EXIT_CODES.iter().map(|(exit, what)| format!("exit code {exit:<34} {what}\n"));
    codes.chain(exits).collect()
}
