//! What the architecture promises and the compiler does not check.

use crate::command::{Failure, program_at};
use crate::workspace::Workspace;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Which of our crates a crate may use, tests included. ARCHITECTURE.md explains the table.
const MAY_USE: &[(&str, &[&str])] = &[
    ("tdem-physics", &[]),
    ("tdem-engine", &["tdem-physics"]),
    ("tdem-case", &["tdem-engine", "tdem-physics"]),
    ("tdem-results", &["tdem-engine"]),
    ("tdem-studies", &["tdem-engine", "tdem-case", "tdem-results", "tdem-physics"]),
    ("tdem", &["tdem-physics", "tdem-engine", "tdem-case", "tdem-results", "tdem-studies"]),
    ("xtask", &["tdem-case", "tdem-results", "tdem-studies"]),
];
/// Where `unsafe` may stand.
const UNSAFE: &[&str] = &["crates/engine/src/cpu/wide.rs", "crates/engine/src/gpu/", "crates/engine/src/gpu.rs"];
/// The crate that prints.
const PRINTS: &str = "crates/cli/";
const PRINTING: &[&str] = &["println!", "print!", "dbg!", "stdout(", "stderr("];
/// Stand where a measured number or an address is still missing.
const MISSING: &[&str] = &["TODO_NUMBER", "TODO_URL"];

pub(crate) fn check(workspace: &Workspace) -> Result<(), Failure> {
    let mut findings = Vec::new();
    rooms(workspace, &mut findings)?;
    let files = tracked(workspace)?;
    for file in &files {
        let ending = file.extension().unwrap_or_default();
        if ending == "rs" && file.starts_with("crates") {
            source(file, &read(&workspace.root.join(file))?, &mut findings);
        } else if ending == "md" {
            document(file, &read(&workspace.root.join(file))?, &files, &mut findings);
        }
    }
    if findings.is_empty() { Ok(()) } else { Err(Failure(format!("\n  {}", findings.join("\n  ")))) }
}

/// Files under version control, relative to the root: what a clone has.
pub(crate) fn tracked(workspace: &Workspace) -> Result<BTreeSet<PathBuf>, Failure> {
    let git = program_at("git").argument("-C").argument(&workspace.root).argument("ls-files");
    Ok(git.output()?.lines().map(PathBuf::from).collect())
}

fn read(path: &Path) -> Result<String, Failure> {
    fs::read_to_string(path).map_err(|error| Failure(format!("{error}: {}", path.display())))
}

/// Edges between our crates, and that all obey the lints of the workspace.
fn rooms(workspace: &Workspace, findings: &mut Vec<String>) -> Result<(), Failure> {
    let ours: Vec<&str> = workspace.members().map(|package| package.name.as_str()).collect();
    for package in workspace.members() {
        let name = &package.name;
        let Some((_, may_use)) = MAY_USE.iter().find(|(crate_name, _)| crate_name == name) else {
            findings.push(format!("{name} is not in the table of xtask/src/tidy.rs"));
            continue;
        };
        for used in package.dependencies.iter().filter(|used| ours.contains(&used.as_str())) {
            if !may_use.contains(&used.as_str()) {
                findings.push(format!("{name} must not use {used}: {}", package.manifest.display()));
            }
        }
        if !read(&package.manifest)?.contains("[lints]\nworkspace = true") {
            findings.push(format!("{name} does not take the lints of the workspace: {}", package.manifest.display()));
        }
    }
    Ok(())
}

/// Where `unsafe` stands, and who prints.
fn source(file: &Path, text: &str, findings: &mut Vec<String>) {
    let shown = shown(file);
    let may_be_unsafe = UNSAFE.iter().any(|place| shown.starts_with(place));
    let may_print = shown.starts_with(PRINTS) || !shown.contains("/src/");
    for (number, line) in (1..).zip(text.lines()) {
        let code = line.split("//").next().unwrap_or_default();
        if !may_be_unsafe && code.split(|c: char| !c.is_alphanumeric()).any(|word| word == "unsafe") {
            findings.push(format!("`unsafe` is only for {}: {shown}:{number}", UNSAFE.join(", ")));
        }
        if !may_print && PRINTING.iter().any(|printing| code.contains(printing)) {
            findings.push(format!("only {PRINTS} prints: {shown}:{number}"));
        }
    }
}

/// Paths that a document names must exist, and its numbers must be there.
fn document(file: &Path, text: &str, files: &BTreeSet<PathBuf>, findings: &mut Vec<String>) {
    let shown = shown(file);
    for (number, line) in (1..).zip(text.lines()) {
        for token in MISSING.iter().filter(|token| line.contains(**token)) {
            findings.push(format!("{token} is still to be filled in: {shown}:{number}"));
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        let links = links(line).map(|link| folder.join(link));
        let paths = quoted(line).map(PathBuf::from);
        for path in links.chain(paths) {
            if !exists(&path, files) {
                findings.push(format!("{} does not exist: {shown}:{number}", self::shown(&path)));
            }
        }
    }
}

/// Targets of links within the repository.
fn links(line: &str) -> impl Iterator<Item = &str> {
    line.split("](")
        .skip(1)
        .filter_map(|rest| rest.split([')', '#', ' ']).next())
        .filter(|target| !target.is_empty() && !target.contains("://") && !target.starts_with("mailto:"))
}

/// Paths in code marks, from the root: whatever begins with a top-level folder of the repository and holds no pattern.
fn quoted(line: &str) -> impl Iterator<Item = &str> {
    const TOPS: &[&str] =
        &["crates/", "cases/", "docs/", "scripts/", "xtask/", "benches/", ".ci/", ".config/", ".cargo/"];
    line.split('`')
        .skip(1)
        .step_by(2)
        .filter(|code| TOPS.iter().any(|top| code.starts_with(top)))
        .filter(|code| !code.contains([' ', '*', '{', '<']))
        .map(|code| code.split_once(':').map_or(code, |(path, _)| path))
}

/// Whether a file is tracked, or a folder holds one that is.
fn exists(path: &Path, files: &BTreeSet<PathBuf>) -> bool {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => drop(plain.pop()),
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    files.range(plain.clone()..).next().is_some_and(|first| first.starts_with(&plain))
}

fn shown(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_that_must_not_be_where_it_is() {
        let mut findings = Vec::new();
        let text = "fn f() { unsafe { g() } }\n// unsafe println!\n#![allow(unsafe_code)]\nprintln!(\"\");\n";
        source(Path::new("crates/physics/src/lib.rs"), text, &mut findings);
        assert_eq!(findings.len(), 3, "{findings:?}");
        findings.clear();
        source(Path::new("crates/engine/src/cpu/wide.rs"), "unsafe {}", &mut findings);
        source(Path::new("crates/cli/src/main.rs"), "println!();", &mut findings);
        source(Path::new("crates/engine/tests/bits.rs"), "println!();", &mut findings);
        assert!(findings.is_empty(), "{findings:?}");
    }

    #[test]
    fn paths_and_numbers_that_are_missing() {
        let files = ["README.md", "docs/physics.md", "crates/a/b.rs"].map(PathBuf::from).into();
        let check = |text: &str| {
            let mut findings = Vec::new();
            document(Path::new("docs/physics.md"), text, &files, &mut findings);
            findings.len()
        };
        assert_eq!(check("[r](../README.md#top) `crates/a` `crates/a/b.rs:3` [p](physics.md) [w](https://a.b/c)"), 0);
        assert_eq!(check("[r](README.md) `crates/c` `crates/a/b`"), 3);
        assert_eq!(check(&["TODO", "NUMBER"].join("_")), 1);
    }
}
