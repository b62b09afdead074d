//! What belongs to the repository itself: `cargo xtask ci` is all of CI, `cargo xtask docs` writes the generated
//! pages.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command talks to whoever typed it")]

mod cases;
mod command;
mod licences;
mod suite;
mod tidy;
mod workspace;

use command::{Failure, cargo};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use suite::Count;
use workspace::Workspace;

/// A part of CI.
struct Part {
    name: &'static str,
    what: &'static str,
    run: fn(&Workspace, &mut Count) -> Result<(), Failure>,
}

/// All of CI, the quick parts first and the tests last, so that their count ends the output.
const PARTS: &[Part] = &[
    Part { name: "fmt", what: "formatting", run: |_, _| cargo("fmt --all --check").run() },
    Part { name: "tidy", what: "rooms of the workspace, paths and numbers in documents", run: |w, _| tidy::check(w) },
    Part { name: "licences", what: "licences of all dependencies", run: |w, _| licences::check(w) },
    Part {
        name: "clippy",
        what: "lints",
        run: |_, _| cargo("clippy --workspace --all-targets --quiet -- -D warnings").run(),
    },
    Part {
        name: "docs",
        what: "documentation of the source",
        run: |_, _| cargo("doc --workspace --no-deps --quiet").variable("RUSTDOCFLAGS", "-D warnings").run(),
    },
    Part { name: "cases", what: "every case runs", run: |w, _| cases::run(w) },
    Part { name: "readers", what: "VTK and h5py read what the cases wrote", run: |w, _| cases::read(w) },
    Part { name: "reports", what: "a browser shows the reports of the cases", run: |w, _| cases::show(w) },
    Part { name: "doctests", what: "examples in the documentation", run: |_, count| suite::examples(count) },
    Part { name: "tests", what: "tests", run: |w, count| suite::all(w, count) },
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["ci"] => ci(PARTS.iter().collect()),
        ["ci", "--only", names] => match chosen(names) {
            Ok(parts) => ci(parts),
            Err(unknown) => {
                eprintln!("there is no part `{unknown}`\n\n{}", usage());
                ExitCode::from(2)
            }
        },
        ["docs"] => report("docs", write_pages()),
        ["verification"] => report("verification", verify().and_then(|()| write_pages())),
        _ => {
            eprintln!("{}", usage());
            ExitCode::from(2)
        }
    }
}

fn usage() -> String {
    let mut text = String::from(
        "cargo xtask ci                     all of CI\n\
         cargo xtask ci --only fmt,tests    some parts of it\n\
         cargo xtask docs                   write the generated pages of docs anew\n\
         cargo xtask verification           the same, with all values of docs/verification.md computed anew: minutes\n\nparts:\n",
    );
    for part in PARTS {
        // A string takes whatever is written to it.
        let _ = writeln!(text, "  {:<10} {}", part.name, part.what);
    }
    text
}

/// The parts of these names, in the order of CI.
fn chosen(names: &str) -> Result<Vec<&'static Part>, &str> {
    let names: Vec<&str> = names.split(',').map(str::trim).collect();
    match names.iter().find(|name| PARTS.iter().all(|part| part.name != **name)) {
        Some(unknown) => Err(unknown),
        None => Ok(PARTS.iter().filter(|part| names.contains(&part.name)).collect()),
    }
}

fn ci(parts: Vec<&Part>) -> ExitCode {
    let workspace = match Workspace::load() {
        Ok(workspace) => workspace,
        Err(failure) => return report("metadata", Err(failure)),
    };
    let mut count = Count::default();
    let mut code = ExitCode::SUCCESS;
    let has = |name: &str| parts.len() > 1 && parts.iter().any(|part| part.name == name);
    let ahead = has("cases").then(cases::build_ahead);
    if has("readers") {
        cases::readers_ahead(&workspace);
    }
    for part in parts {
        println!("=== {}: {}", part.name, part.what);
        let start = Instant::now();
        let outcome = (part.run)(&workspace, &mut count);
        let failed = outcome.is_err();
        if failed {
            code = report(part.name, outcome);
            break;
        }
        println!("=== {} took {:.0} s", part.name, start.elapsed().as_secs_f64());
    }
    // If a part failed before, this must not go on alone.
    if let Some(Ok(mut building)) = ahead {
        let _ = building.kill().and_then(|()| building.wait());
    }
    if count.ran {
        println!("{count}");
    }
    code
}

fn report(name: &str, outcome: Result<(), Failure>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            println!("=== {name} FAILED: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Runs both tiers of the verification. What it prints becomes the page, of which the test of pages keeps the tables.
fn verify() -> Result<(), Failure> {
    let values = cargo("run --release --quiet --package tdem -- verify --full --markdown --device cpu").output()?;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/verification.md");
    fs::write(&path, values).map_err(|error| Failure(format!("{error}: {}", path.display())))
}

/// The pages are compared by tests, which write them when they are told to.
fn write_pages() -> Result<(), Failure> {
    ["--package xtask --test pages", "--package tdem --bin tdem explain::page"]
        .into_iter()
        .try_for_each(|test| cargo(&format!("test --quiet {test}")).variable("WRITE_PAGES", "1").run())
}
