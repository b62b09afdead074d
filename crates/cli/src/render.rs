//! How errors and warnings look: what is wrong, where, why, and what to do.

use crate::console;
use crate::units::counted;
use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteHandler, MietteHandlerOpts, MietteSpanContents, ReportHandler,
    SourceCode, SourceSpan, SpanContents,
};
use std::fmt;
use std::sync::Arc;
use tdem_case::{Code, Problem, Problems};

pub(crate) use miette::Severity;

/// One thing to tell.
#[derive(Debug)]
pub(crate) struct Report {
    code: &'static str,
    severity: Severity,
    message: String,
    help: Option<String>,
    source: Option<Arc<Text>>,
    labels: Vec<LabeledSpan>,
}

/// The text of a case. It counts the lines of what is shown, where miette's own sources count those of the whole
/// text, so that two labels far apart become two excerpts instead of one with everything between them.
#[derive(Debug)]
struct Text {
    name: String,
    text: String,
}

impl SourceCode for Text {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let found = self.text.read_span(span, lines_before, lines_after)?;
        let lines = found.data().split(|&byte| byte == b'\n').count();
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            found.data(),
            *found.span(),
            found.line(),
            found.column(),
            lines,
        )))
    }
}

/// All there is to tell, when a command cannot do what it was asked for.
#[derive(Debug)]
pub(crate) struct Reports(Vec<Report>);

impl Report {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        let (severity, message) = (seen(code.severity), message.into());
        Report { code: code.name, severity, message, help: None, source: None, labels: Vec::new() }
    }
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    fn of_case(problem: &Problem, source: &Arc<Text>) -> Self {
        let text = &source.text;
        let labels = problem.labels.iter().enumerate().map(|(index, label)| {
            let end = floor(text, label.span.end);
            let start = floor(text, label.span.start).min(end);
            let remark = Some(label.text.clone());
            if index == 0 {
                LabeledSpan::new_primary_with_span(remark, start..end)
            } else {
                LabeledSpan::new_with_span(remark, start..end)
            }
        });
        Report {
            code: problem.code,
            severity: seen(problem.severity),
            message: problem.message.clone(),
            help: problem.help.clone(),
            source: (!problem.labels.is_empty()).then(|| Arc::clone(source)),
            labels: labels.collect(),
        }
    }
}

impl Reports {
    /// The code of the first.
    #[cfg(test)]
    pub(crate) fn first_code(&self) -> Option<&'static str> {
        self.0.first().map(|report| report.code)
    }
    /// The same with one more behind.
    pub(crate) fn and(mut self, report: Report) -> Self {
        self.0.push(report);
        self
    }
}

/// A severity as miette has it.
fn seen(severity: tdem_case::Severity) -> Severity {
    match severity {
        tdem_case::Severity::Error => Severity::Error,
        tdem_case::Severity::Warning => Severity::Warning,
    }
}

/// The nearest character boundary at or before an index.
fn floor(text: &str, index: usize) -> usize {
    text.floor_char_boundary(index)
}

impl From<Report> for Reports {
    fn from(report: Report) -> Self {
        Reports(vec![report])
    }
}

impl From<&Problems> for Reports {
    fn from(problems: &Problems) -> Self {
        let source = Arc::new(Text { name: problems.source.name.clone(), text: problems.source.text.clone() });
        Reports(problems.problems.iter().map(|problem| Report::of_case(problem, &source)).collect())
    }
}

impl From<Problems> for Reports {
    fn from(problems: Problems) -> Self {
        Reports::from(&problems)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = if self.severity == Severity::Warning { "warning" } else { "error" };
        write!(f, "{word}: {}", self.message)
    }
}

impl std::error::Error for Report {}

impl Diagnostic for Report {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.code))
    }
    fn severity(&self) -> Option<Severity> {
        Some(self.severity)
    }
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as _)
    }
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_deref().map(|source| source as _)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }
}

struct Shown<'a>(&'a MietteHandler, &'a Report);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.debug(self.1, f)
    }
}

/// Reports as they are shown: with lines and colours on a terminal, plain and unbroken elsewhere. Without any
/// report there is no text.
pub(crate) fn text(reports: &Reports) -> String {
    drawn(reports, console::watched(), console::colours())
}

/// Reports as they are shown where nobody watches.
#[cfg(test)]
pub(crate) fn plain(reports: &Reports) -> String {
    drawn(reports, false, false)
}

fn drawn(reports: &Reports, watched: bool, colours: bool) -> String {
    let options = MietteHandlerOpts::new()
        .unicode(watched)
        .color(colours)
        .terminal_links(false)
        .wrap_lines(watched)
        .context_lines(1);
    let handler = if watched { options.build() } else { options.width(1000).build() };
    let shown: Vec<String> = reports.0.iter().map(|report| Shown(&handler, report).to_string()).collect();
    let count = |severity| reports.0.iter().filter(|report| report.severity == severity).count();
    let mut text = shown.join("\n");
    if reports.0.len() > 1 {
        let counts = [(count(Severity::Error), "error"), (count(Severity::Warning), "warning")];
        let counts = counts.iter().filter(|(count, _)| *count > 0).map(|&(count, thing)| counted(count as u64, thing));
        text.push('\n');
        text += &counts.collect::<Vec<_>>().join(", ");
    }
    text.trim_end().to_owned()
}

impl Reports {
    /// For programs.
    pub(crate) fn json(&self) -> serde_json::Value {
        let told = |report: &Report| {
            let severity = if report.severity == Severity::Error { "error" } else { "warning" };
            serde_json::json!({
                "code": report.code,
                "severity": severity,
                "message": report.message,
                "help": report.help,
            })
        };
        self.0.iter().map(told).collect()
    }
}

/// Tells warnings, if there are any.
pub(crate) fn warn(reports: &Reports) {
    if !reports.0.is_empty() {
        console::say(text(reports));
    }
}
