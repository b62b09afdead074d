//! What is wrong with a case, and where.

use crate::code::Code;
use std::collections::BTreeMap;
use std::fmt::{self, Write};
use std::ops::Range;

/// A named text that spans point into: the case with its preset and its overrides applied.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Name for messages, usually the path.
    pub name: String,
    /// The effective text.
    pub text: String,
}

/// How bad a problem is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The case cannot run.
    Error,
    /// The case can run, and the result may not be what is wanted.
    Warning,
}

/// A remark on a place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Bytes of the text.
    pub span: Range<usize>,
    /// The remark.
    pub text: String,
}

/// One thing that is wrong: what, where, why, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Stable code, such as `tdem::case::unknown-key`; [`codes`](mod@crate::codes) explains it.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, with the value, its unit, and what is allowed.
    pub message: String,
    /// The first is the place to change; others show what sets the limit. Empty if the text has no such place.
    pub labels: Vec<Label>,
    /// What to do.
    pub help: Option<String>,
}

impl Problem {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        let Code { name, severity, .. } = code;
        Problem { code: name, severity, message: message.into(), labels: Vec::new(), help: None }
    }
    pub(crate) fn at(mut self, span: Range<usize>, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// Problems of one code that are told; of more, their number.
const MOST_OF_A_CODE: usize = 20;

/// All problems of a case at once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems {
    /// What the labels point into.
    pub source: Source,
    /// The problems: errors, then warnings, each in the order of the text.
    pub problems: Vec<Problem>,
}

impl Problems {
    pub(crate) fn new(source: &Source, mut problems: Vec<Problem>) -> Self {
        let place = |problem: &Problem| problem.labels.first().map_or(0, |label| label.span.start);
        problems.sort_by_key(|problem| (problem.severity == Severity::Warning, place(problem)));
        let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
        problems.retain(|problem| {
            let count = counts.entry(problem.code).or_insert(0);
            *count += 1;
            *count <= MOST_OF_A_CODE
        });
        for (code, count) in counts.into_iter().filter(|(_, count)| *count > MOST_OF_A_CODE) {
            // The last of them that is told says how many more there are.
            if let Some(last) = problems.iter_mut().rfind(|problem| problem.code == code) {
                let _ = write!(last.message, " (and {} more with this code)", count - MOST_OF_A_CODE);
            }
        }
        Problems { source: source.clone(), problems }
    }
    /// Whether any of them keeps the case from running.
    #[must_use]
    pub fn any_error(&self) -> bool {
        self.problems.iter().any(|p| p.severity == Severity::Error)
    }
}

/// The value if no problem is an error; the problems otherwise.
pub(crate) fn unless_error<T>(source: &Source, problems: Vec<Problem>, value: T) -> Result<(T, Problems), Problems> {
    let problems = Problems::new(source, problems);
    if problems.any_error() { Err(problems) } else { Ok((value, problems)) }
}

impl std::error::Error for Problems {}

/// A number as a message shows it: at most five digits, no exponent where it is easy to read without.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let scientific = format!("{value:.4e}");
    if (1e-3..1e5).contains(&size) {
        // Rounded to five digits first, then written plainly without trailing zeros.
        return scientific.parse::<f64>().map_or(scientific, |rounded| format!("{rounded}"));
    }
    match scientific.split_once('e') {
        Some((digits, exponent)) => format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.')),
        None => scientific,
    }
}

/// A number of things: "1 particle", "3 particles".
pub(crate) fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            let word = if problem.severity == Severity::Error { "error" } else { "warning" };
            writeln!(f, "{word}[{}]: {}", problem.code, problem.message)?;
            if problem.labels.is_empty() {
                writeln!(f, "  --> {}", self.source.name)?;
            }
            for label in &problem.labels {
                write_label(f, &self.source, label)?;
            }
            if let Some(help) = &problem.help {
                writeln!(f, "  = help: {help}")?;
            }
        }
        Ok(())
    }
}

/// One line of the text with its number, and the place underlined.
fn write_label(f: &mut fmt::Formatter<'_>, source: &Source, label: &Label) -> fmt::Result {
    let text = &source.text;
    let start = floor_boundary(text, label.span.start);
    let line_start = text[..start].rfind('\n').map_or(0, |k| k + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |k| start + k);
    let number = text[..line_start].matches('\n').count() + 1;
    let column = text[line_start..start].chars().count();
    let end = floor_boundary(text, label.span.end.clamp(start, line_end));
    let width = text[start..end].chars().count().max(1);
    let line = text[line_start..line_end].trim_end();
    let gutter = number.to_string().len();
    writeln!(f, "  --> {}:{number}:{}", source.name, column + 1)?;
    writeln!(f, "  {number} | {line}")?;
    writeln!(f, "  {:gutter$} | {:column$}{} {}", "", "", "^".repeat(width), label.text)
}

/// The nearest character boundary at or before an index, so that a span never splits a character.
fn floor_boundary(text: &str, index: usize) -> usize {
    let mut index = index.min(text.len());
    while !text.is_char_boundary(index) {
        index -= 1;
    }
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let shown: Vec<String> = [0.0, 0.22, 1.0 / 3.0, 2.0e-5, 123_456.0, 1.5e-5].map(number).into();
        assert_eq!(shown, ["0", "0.22", "0.33333", "2e-5", "1.2346e5", "1.5e-5"]);
    }

    #[test]
    fn labels_underline_their_place() {
        let source = Source { name: "a.toml".into(), text: "x = 1\ny = 22\n".into() };
        let problem = Problem::new(crate::codes::SYNTAX, "bad").at(10..12, "here").help("do this");
        let shown = Problems::new(&source, vec![problem]).to_string();
        assert!(shown.contains("a.toml:2:5"), "{shown}");
        assert!(shown.contains("^^ here"), "{shown}");
    }
}
