//! Outcomes as text.

use super::{Check, Kind, Outcome, Tier, Tolerance};
use std::fmt::Write;

impl Kind {
    /// All of them.
    pub const ALL: [Kind; 7] = [
        Kind::ClosedForm,
        Kind::Published,
        Kind::Reference,
        Kind::Order,
        Kind::Conservation,
        Kind::Invariance,
        Kind::Statistical,
    ];

    /// What that means, in a sentence.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Kind::ClosedForm => "the solution of the model's equations, on paper",
            Kind::Published => "printed or plotted in the literature",
            Kind::Reference => "computed by a program that shares nothing with the engine",
            Kind::Order => "how fast an error falls with the step",
            Kind::Conservation => "what the laws of motion keep",
            Kind::Invariance => "what may not depend on how the machine works or how space is turned",
            Kind::Statistical => "what random packings, and bodies that tear, show within their scatter",
        }
    }

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Kind::ClosedForm => "closed form",
            Kind::Published => "published",
            Kind::Reference => "reference program",
            Kind::Order => "order of convergence",
            Kind::Conservation => "conservation",
            Kind::Invariance => "invariance",
            Kind::Statistical => "statistical",
        }
    }
}

/// Seven digits, in plain notation where that is readable.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".into()
    } else if (1e-3..1e5).contains(&size) {
        let digits = 6 - libm::floor(libm::log10(size)).max(0.0) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
    } else {
        format!("{value:.6e}")
    }
}

fn tolerance(check: &Check) -> String {
    match check.tolerance {
        Tolerance::Absolute(width) => format!("+- {}", short(width)),
        Tolerance::Relative(part) => format!("+- {} of it", short(part)),
        Tolerance::AtMost => "at most".into(),
        Tolerance::AtLeast => "at least".into(),
    }
}

/// A tolerance, which has few digits.
fn short(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value) { number(value) } else { format!("{value:.0e}") }
}

fn tier(tier: Tier) -> &'static str {
    match tier {
        Tier::Quick => "quick",
        Tier::Full => "full",
    }
}

const HEADER: [&str; 7] = ["", "quantity", "expected", "got", "tolerance", "unit", "what is expected"];

fn cells(check: &Check) -> [String; 7] {
    [
        if check.passed { "ok" } else { "FAILED" }.into(),
        check.what.clone(),
        number(check.expected),
        number(check.got),
        tolerance(check),
        check.unit.into(),
        check.kind.name().into(),
    ]
}

/// A line that sums up.
fn summary(outcomes: &[Outcome]) -> String {
    let checks: usize = outcomes.iter().map(|o| o.checks.len()).sum();
    let failed = outcomes.iter().flat_map(|o| &o.checks).filter(|c| !c.passed).count();
    let broken = outcomes.iter().filter(|o| !o.passed()).count();
    let seconds: f64 = outcomes.iter().map(|o| o.seconds).sum();
    format!(
        "{} cases, {checks} values judged in {seconds:.1} s: {broken} cases and {failed} values failed",
        outcomes.len()
    )
}

/// Outcomes as plain text, in aligned columns that read without colour.
#[must_use]
pub fn table(outcomes: &[Outcome]) -> String {
    let rows: Vec<[String; 7]> = outcomes.iter().flat_map(|o| &o.checks).map(cells).collect();
    let width: [usize; 7] = std::array::from_fn(|k| {
        rows.iter().map(|row| row[k].chars().count()).chain([HEADER[k].len()]).max().unwrap_or(0)
    });
    let mut text = String::new();
    let line = |text: &mut String, cells: [&str; 7]| {
        let mut line = String::from(" ");
        for k in 0..7 {
            let right = k == 2 || k == 3;
            let pad = " ".repeat(width[k].saturating_sub(cells[k].chars().count()));
            let _ = if right { write!(line, " {pad}{}", cells[k]) } else { write!(line, " {}{pad}", cells[k]) };
            line.push(' ');
        }
        text.push_str(line.trim_end());
        text.push('\n');
    };
    let mut rows = rows.iter();
    for outcome in outcomes {
        let case = &outcome.case;
        let verdict = if outcome.passed() { "passed" } else { "FAILED" };
        let _ = writeln!(
            text,
            "{} [{}, {}, {:.2} s] {verdict}",
            case.name,
            tier(case.tier),
            outcome.backend.name(),
            outcome.seconds
        );
        let _ = writeln!(text, "  {}\n  Source: {}", case.about, case.source);
        line(&mut text, HEADER);
        for row in rows.by_ref().take(outcome.checks.len()) {
            line(&mut text, std::array::from_fn(|k| row[k].as_str()));
        }
        if let Some(fault) = &outcome.fault {
            let _ = writeln!(text, "  stopped: {fault}");
        }
        text.push('\n');
    }
    text.push_str(&summary(outcomes));
    text.push('\n');
    text
}

/// Text whose bars, stars and angles Markdown takes as they are.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut shown = String::new();
    for letter in text.chars() {
        if matches!(letter, '|' | '*' | '<') {
            shown.push('\\');
        }
        shown.push(letter);
    }
    shown
}

/// Outcomes as Markdown, one section per case.
#[must_use]
pub fn markdown(outcomes: &[Outcome]) -> String {
    let mut text = String::new();
    for outcome in outcomes {
        let case = &outcome.case;
        let _ = writeln!(text, "### {}\n\n{}\n", case.name, escaped(case.about));
        let _ = writeln!(text, "Tier: {}. Source: {}\n", tier(case.tier), escaped(case.source));
        text.push_str("| quantity | unit | expected | got | tolerance | what is expected | verdict |\n");
        text.push_str("|---|---|---:|---:|---|---|---|\n");
        for check in &outcome.checks {
            let [verdict, what, expected, got, tolerance, unit, kind] = cells(check).map(|cell| escaped(&cell));
            let _ = writeln!(text, "| {what} | {unit} | {expected} | {got} | {tolerance} | {kind} | {verdict} |");
        }
        if let Some(fault) = &outcome.fault {
            let _ = writeln!(text, "\nStopped: {fault}");
        }
        text.push('\n');
    }
    text.push_str(&summary(outcomes));
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_seven_digits() {
        assert_eq!(number(0.75), "0.75");
        assert_eq!(number(10_696.89), "10696.89");
        assert_eq!(number(2.741_127e-4), "2.741127e-4");
        assert_eq!(number(-600.0), "-600");
        assert_eq!(number(90_000.0), "90000");
        assert_eq!(number(f64::NAN), "NaN");
    }
}
