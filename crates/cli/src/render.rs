//! How errors and warnings look: what is wrong, where, why, and what to do.

use crate::console;
use crate::units::counted;
use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteHandler, MietteHandlerOpts, MietteSpanContents, ReportHandler,
    SourceCode, SourceSpan, SpanContents,
};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;
use tdem_case::{Code, Problem, Problems};
use tdem_results::words::{cut, plain as spelled};

pub(crate) use miette::Severity;

/// So many reports are shown; of more only the number is told.
const MOST: usize = 20;
/// Letters of a message, a remedy, or a remark on a place.
const LONGEST: usize = 2000;
/// Bytes of a line of a case that are shown,
const LINE: usize = 240;
/// and those of them that lie before the place that matters.
const BEFORE: usize = 80;
/// Lines of a place that are all shown; of a longer one the first is.
const LINES: usize = 8;
/// Letters of the name of a case.
const NAME: usize = 300;

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
#[derive(Debug, Default)]
pub(crate) struct Reports {
    shown: Vec<Report>,
    /// Errors and warnings that are only counted.
    more: [usize; 2],
}

impl Report {
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        let (severity, message) = (seen(code.severity), tidy(&message.into()));
        Report { code: code.name, severity, message, help: None, source: None, labels: Vec::new() }
    }
    pub(crate) fn message(&self) -> &str {
        &self.message
    }
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(tidy(&help.into()));
        self
    }

    /// A problem of a case; `shared` is its text, if it can be shown as it is.
    fn of_case(problem: &Problem, text: &str, name: &str, shared: Option<&Arc<Text>>) -> Self {
        let mut places: Vec<Range<usize>> = problem.labels.iter().map(|label| place(text, &label.span)).collect();
        let source = (!problem.labels.is_empty()).then(|| {
            let own = || Arc::new(Text { name: name.to_owned(), text: excerpt(text, &mut places) });
            shared.map_or_else(own, Arc::clone)
        });
        let labels = problem.labels.iter().zip(places).enumerate().map(|(index, (label, place))| {
            let remark = Some(tidy(&label.text));
            if index == 0 {
                LabeledSpan::new_primary_with_span(remark, place)
            } else {
                LabeledSpan::new_with_span(remark, place)
            }
        });
        Report {
            code: problem.code,
            severity: seen(problem.severity),
            message: tidy(&problem.message),
            help: problem.help.as_deref().map(tidy),
            labels: labels.collect(),
            source,
        }
    }
}

/// A text that a terminal shows as it is, and that is not too long.
fn tidy(text: &str) -> String {
    cut(&spelled(text), LONGEST).into_owned()
}

/// A place in a text, the first line of it if it is long.
fn place(text: &str, span: &Range<usize>) -> Range<usize> {
    let end = floor(text, span.end);
    let start = floor(text, span.start).min(end);
    let ends: Vec<usize> = text[start..end].match_indices('\n').map(|(at, _)| start + at).take(LINES).collect();
    start..if ends.len() == LINES { ends[0] } else { end }
}

/// Whether a text can be shown as it is.
fn is_plain(text: &str) -> bool {
    text.lines().all(|line| line.len() <= LINE) && spelled(text) == text
}

/// A text with long lines cut around places in them, and with everything spelled out that a terminal would obey. The places
/// move with it.
fn excerpt(text: &str, places: &mut [Range<usize>]) -> String {
    const GAP: &str = "... ";
    let mut shown = String::new();
    let mut moved: Vec<[Option<usize>; 2]> = vec![[None; 2]; places.len()];
    let mut begin = 0;
    for line in text.split_inclusive('\n') {
        let end = begin + line.len();
        let body = line.trim_end_matches(['\n', '\r']);
        let first = places.iter().map(|place| place.start).find(|start| (begin..end).contains(start));
        let from = if body.len() <= LINE { 0 } else { first.map_or(0, |at| (at - begin).saturating_sub(BEFORE)) };
        let from = floor(body, from);
        let to = floor(body, from + LINE);
        shown += if from > 0 { GAP } else { "" };
        let offset = shown.len();
        let at = |place: usize| offset + spelled(&body[from..floor(body, place - begin).clamp(from, to)]).len();
        for (place, moved) in places.iter().zip(&mut moved) {
            if (begin..end).contains(&place.start) {
                moved[0] = Some(at(place.start));
            }
            if (begin + 1..=end).contains(&place.end) {
                moved[1] = Some(at(place.end));
            }
        }
        shown += &spelled(&body[from..to]);
        shown += if to < body.len() { " ...\n" } else { "\n" };
        begin = end;
    }
    for (place, [start, end]) in places.iter_mut().zip(moved) {
        let start = start.unwrap_or(shown.len());
        *place = start..end.unwrap_or(start).max(start);
    }
    shown
}

impl Reports {
    /// The code of the first.
    #[cfg(test)]
    pub(crate) fn first_code(&self) -> Option<&'static str> {
        self.shown.first().map(|report| report.code)
    }
    /// The same with one more behind.
    pub(crate) fn and(mut self, report: Report) -> Self {
        self.shown.push(report);
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
        Reports { shown: vec![report], ..Reports::default() }
    }
}

impl From<&Problems> for Reports {
    fn from(problems: &Problems) -> Self {
        let (text, name) = (&problems.source.text, cut(&spelled(&problems.source.name), NAME).into_owned());
        let shared = is_plain(text).then(|| Arc::new(Text { name: name.clone(), text: text.clone() }));
        let (first, rest) = problems.problems.split_at(problems.problems.len().min(MOST));
        let errors = rest.iter().filter(|problem| problem.severity == tdem_case::Severity::Error).count();
        Reports {
            shown: first.iter().map(|problem| Report::of_case(problem, text, &name, shared.as_ref())).collect(),
            more: [errors, rest.len() - errors],
        }
    }
}

impl FromIterator<Report> for Reports {
    fn from_iter<I: IntoIterator<Item = Report>>(reports: I) -> Self {
        let mut all = Reports::default();
        for report in reports {
            if all.shown.len() < MOST {
                all.shown.push(report);
            } else {
                all.more[usize::from(report.severity == Severity::Warning)] += 1;
            }
        }
        all
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
    let shown: Vec<String> = reports.shown.iter().map(|report| Shown(&handler, report).to_string()).collect();
    let count = |severity| reports.shown.iter().filter(|report| report.severity == severity).count();
    let mut text = shown.join("\n");
    let more: usize = reports.more.iter().sum();
    if more > 0 {
        text = format!("{}\n\nand {more} more\n", text.trim_end());
    }
    if reports.shown.len() + more > 1 {
        let [errors, warnings] = reports.more;
        let counts = [(count(Severity::Error) + errors, "error"), (count(Severity::Warning) + warnings, "warning")];
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
        self.shown.iter().map(told).collect()
    }
}

/// Tells warnings, if there are any.
pub(crate) fn warn(reports: &Reports) {
    if !reports.shown.is_empty() {
        tell(reports);
    }
}

/// Tells all there is to tell.
pub(crate) fn tell(reports: &Reports) {
    console::say_drawn(text(reports));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marked(text: &str, places: &[Range<usize>]) -> Vec<String> {
        let mut places = places.to_vec();
        let shown = excerpt(text, &mut places);
        let found = places.into_iter().map(|place| shown[place].to_owned()).collect::<Vec<_>>();
        [found, vec![shown]].concat()
    }

    #[test]
    fn places_move_with_what_is_spelled_out() {
        let text = "a = 1\r\n\u{1b}[2Jb\u{7} = 22\r\nc";
        let at = |of: &str| text.find(of).map(|start| start..start + of.len()).unwrap_or_default();
        let found = marked(text, &[at("1"), at("\u{1b}[2Jb\u{7}"), at("22"), at("c"), text.len()..text.len()]);
        let whole = "a = 1\n\\u{1b}[2Jb\\u{7} = 22\nc\n";
        assert_eq!(found, ["1", "\\u{1b}[2Jb\\u{7}", "22", "c", "", whole]);
    }

    #[test]
    fn a_long_line_is_cut_around_its_place() {
        let text = format!("x = [{}wrong, {}]\ny = 1\n", "1.0, ".repeat(100_000), "ä".repeat(1000));
        let start = text.find("wrong").unwrap_or_default();
        let found = marked(&text, &[start..start + 5, 0..1, start..text.len() - 9]);
        assert_eq!(found[..2], ["wrong".to_owned(), String::new()], "what lies outside is not shown");
        assert!(found[2].starts_with("wrong, ää"), "{found:?}");
        let [first, second] = found[3].lines().collect::<Vec<_>>()[..] else { panic!("{}", found[3]) };
        assert!(first.starts_with("... ") && first.ends_with(" ...") && first.len() < 300, "{first}");
        assert_eq!(second, "y = 1");
    }

    #[test]
    fn of_many_problems_twenty_are_shown() {
        let warnings = (0..1000).map(|k| Report::new(crate::codes::CURVE, format!("curve {k}")));
        let shown = plain(&warnings.collect());
        assert!(shown.contains("curve 19") && !shown.contains("curve 20"), "{shown}");
        assert!(shown.ends_with("and 980 more\n\n1,000 warnings"), "{shown}");
    }
}
