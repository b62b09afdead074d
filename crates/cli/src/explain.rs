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
    /// A code, its end, or words to look for; all codes without any
    #[arg(value_name = "CODE or WORDS")]
    words: Vec<String>,
}

const EXAMPLES: &str = "\
Examples:
  tdem explain tdem::case::through-wall
  tdem explain through-wall
  tdem explain time step           codes in whose explanation both words stand
  tdem explain stl                 what stands in the place of a word of other programs
  tdem explain                     all codes, a line each";

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let name = arguments.words.join(" ");
    if name.is_empty() {
        data(list().trim_end())?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut found: Vec<String> = all().filter(|code| code.answers_to(&name)).map(explained).collect();
    if found.is_empty() {
        found = search(&name);
    }
    if found.is_empty() {
        return Err(Report::new(
            codes::UNKNOWN_CODE,
            format!("there is no code `{name}`, and none whose explanation has it"),
        )
        .help("`tdem explain` lists all codes")
        .into());
    }
    data(found.join("\n\n"))?;
    Ok(ExitCode::SUCCESS)
}

/// What stands in the place of a word of other programs, and the codes whose explanations have all words: one in full,
/// several a line each.
fn search(words: &str) -> Vec<String> {
    let lower = words.to_lowercase();
    let has_all = |code: &&Code| {
        let text = format!("{} {}", code.name, code.paragraphs().collect::<Vec<_>>().join(" ")).to_lowercase();
        lower.split_whitespace().all(|word| text.contains(word))
    };
    let codes: Vec<&Code> = all().filter(has_all).collect();
    let told = match codes.as_slice() {
        [] => None,
        [one] => Some(explained(one)),
        several => Some(several.iter().map(|code| line(code)).collect::<String>().trim_end().to_owned()),
    };
    let instead = tdem_case::instead(words).map(|instead| format!("{words}: {instead}"));
    instead.into_iter().chain(told).collect()
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

/// A code with its first sentence.
fn line(code: &Code) -> String {
    let text = code.paragraphs().next().unwrap_or_default();
    let first = text.split_inclusive(". ").next().unwrap_or_default().trim_end();
    format!("{:<44} {first}\n", code.name)
}

/// All codes with their first sentences, and how the program ends.
fn list() -> String {
    let codes = all().map(line);
    let exits = EXIT_CODES.iter().map(|(exit, what)| format!("exit code {exit:<34} {what}\n"));
    codes.chain(exits).collect()
}
