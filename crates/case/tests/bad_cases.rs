//! Bad cases, each in a file with the expected codes beside the offending lines.
//!
//! A comment `# error: CODE` or `# warning: CODE` says that a problem of that code has its first label on that line.

use std::path::{Path, PathBuf};
use tdem_case::{Problems, Severity, load};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad")
}

/// All problems of a file, warnings included.
fn problems_of(file: &Path) -> Problems {
    match load(file, &[]) {
        Err(problems) => problems,
        Ok(loaded) => loaded.build().map_or_else(|problems| problems, |built| built.warnings),
    }
}

/// Line, severity and code of each problem, sorted.
type Marks = Vec<(usize, String)>;

fn expected(text: &str) -> Marks {
    let mut marks = Marks::new();
    for (number, line) in text.lines().enumerate() {
        for comment in line.split('#').skip(1) {
            let comment = comment.trim();
            if comment.starts_with("error: ") || comment.starts_with("warning: ") {
                marks.push((number + 1, comment.to_owned()));
            }
        }
    }
    marks.sort();
    marks
}

fn found(problems: &Problems) -> Marks {
    let mut marks: Marks = problems
        .problems
        .iter()
        .map(|p| {
            let start = p.labels.first().map_or(0, |label| label.span.start);
            let line = problems.source.text[..start].matches('\n').count() + 1;
            let word = if p.severity == Severity::Error { "error" } else { "warning" };
            (line, format!("{word}: {}", p.code))
        })
        .collect();
    marks.sort();
    marks
}

#[test]
fn every_bad_case_is_refused_on_its_line() {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    assert!(files.len() >= 32);
    let mut wrong = String::new();
    for file in &files {
        let text = std::fs::read_to_string(file).unwrap();
        let problems = problems_of(file);
        let (expected, found) = (expected(&text), found(&problems));
        if expected.is_empty() || expected != found {
            let name = file.file_name().unwrap().display();
            wrong = format!("{wrong}== {name}\nexpected {expected:?}\nfound    {found:?}\n{problems}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn every_problem_says_what_to_do_or_shows_what_is_allowed() {
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            for problem in problems_of(&path).problems {
                assert!(problem.code.starts_with("tdem::case::"));
                let label = problem.labels.first().unwrap_or_else(|| panic!("{} has no label", path.display()));
                assert!(!label.text.is_empty() && !problem.message.is_empty());
            }
        }
    }
}

/// Snapshots of what a user reads. The folder's name does not belong into them.
fn shown(file: &str) -> String {
    let path = folder().join(file);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{file}: {e}"));
    let problems = match tdem_case::parse(file, &text, Path::new("."), &[]) {
        Err(problems) => problems,
        Ok(loaded) => loaded.build().map_or_else(|problems| problems, |built| built.warnings),
    };
    problems.to_string()
}

#[test]
fn messages_as_a_user_reads_them() {
    for file in [
        "many-at-once",
        "friction-order",
        "missing-interaction",
        "missing-restitution",
        "step-unstable",
        "overlap",
        "unknown-size",
        "period-too-short",
        "csv-not-there",
        "contradictory-motion",
        "force-on-prescribed",
        "curve-of-no-column",
        "group-empty",
        "heat-open-sides-repeat",
        "mass-scaling-falls",
        "mass-scaling-frozen",
        "cut-idle",
        "bond-simple-cubic",
        "bond-out-of-reach",
        "bond-poisson",
        "heat-table-backwards",
        "heat-table-range",
        "heat-stiffness-incremental",
        "heat-factor-range",
        "heat-factor-without-heat",
        "heat-series-without-table",
        "picture-of-no-heat",
        "picture-directions",
        "picture-view-twice",
    ] {
        insta::assert_snapshot!(file, shown(&format!("{file}.toml")));
    }
}

#[test]
fn a_case_that_is_not_there() {
    let problems = load(Path::new("nowhere.toml"), &[]).unwrap_err();
    assert_eq!(problems.problems[0].code, "tdem::case::unreadable");
    assert!(problems.problems[0].help.as_deref().unwrap().contains("tdem new"));
}

#[test]
fn an_override_that_makes_the_case_bad_shows_its_effect() {
    let file = folder().join("../../../../cases/packing.toml");
    let bad = |key: &str, value: &str| load(&file, &[(key.to_owned(), value.to_owned())]).unwrap_err();
    let problems = bad("time.stp", "1e-6");
    assert_eq!(problems.problems[0].code, "tdem::case::unknown-key");
    assert_eq!(problems.problems[0].help.as_deref(), Some("did you mean `step`?"));
    let span = problems.problems[0].labels[0].span.clone();
    assert_eq!(&problems.source.text[span], "stp");
    assert_eq!(bad("size", "84k").problems[0].code, "tdem::case::unknown-size");
    assert_eq!(bad("material.plastic.density", "-1").problems[0].code, "tdem::case::out-of-range");
}
