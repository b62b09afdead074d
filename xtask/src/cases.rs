//! The cases of the repository, run by the program that users run, and what they wrote, read by other programs.

use crate::command::{Command, Failure, cargo, program_at};
use crate::workspace::Workspace;
use std::fs;
use std::path::{Path, PathBuf};

/// The main job: this case runs to its end.
const WHOLE: &str = "packing";
/// The others only show that they run.
const STEPS: &str = "200";
/// What reads the results.
const READERS: &[&str] = &["vtk", "h5py", "numpy"];

pub(crate) fn run(workspace: &Workspace) -> Result<(), Failure> {
    cargo("build --release --quiet --package tdem").run()?;
    let program = workspace.target.join("release").join(format!("tdem{}", std::env::consts::EXE_SUFFIX));
    let results = results(workspace);
    if results.exists() {
        fs::remove_dir_all(&results).map_err(|error| unreadable(&results, &error))?;
    }
    fs::create_dir_all(&results).map_err(|error| unreadable(&results, &error))?;
    for case in entries(&workspace.root.join("cases"))? {
        let name = case.file_stem().unwrap_or_default().to_owned();
        if case.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let run = program_at(&program).argument("run").argument(&case).argument("--out").argument(results.join(&name));
        if name == WHOLE { run.run()? } else { run.argument("--steps").argument(STEPS).run()? }
    }
    Ok(())
}

pub(crate) fn read(workspace: &Workspace) -> Result<(), Failure> {
    let runs = entries(&results(workspace))?;
    if runs.is_empty() {
        return Err(Failure("there are no results to read; the part `cases` makes them".into()));
    }
    let script = program_at(python(workspace)?).argument(workspace.root.join("scripts/check_results.py"));
    runs.iter().fold(script, Command::argument).run()
}

/// Opens the reports of all runs in a browser.
pub(crate) fn show(workspace: &Workspace) -> Result<(), Failure> {
    let runs = entries(&results(workspace))?;
    if runs.is_empty() {
        return Err(Failure("there are no reports to show; the part `cases` makes them".into()));
    }
    let script = program_at(system_python()).argument(workspace.root.join("scripts/check_report.py"));
    runs.iter().fold(script, Command::argument).run()
}

fn system_python() -> &'static str {
    if cfg!(windows) { "python" } else { "python3" }
}

/// A Python that has the readers, installed on first use.
fn python(workspace: &Workspace) -> Result<PathBuf, Failure> {
    let environment = workspace.target.join("venv");
    let python = environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let import = format!("import {}", READERS.join(", "));
    if !program_at(&python).argument("-c").argument(import).succeeds() {
        program_at(system_python()).argument("-m").argument("venv").argument(&environment).run()?;
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        let install = pip.iter().chain(READERS).fold(program_at(&python), Command::argument);
        install.run()?;
    }
    Ok(python)
}

fn results(workspace: &Workspace) -> PathBuf {
    workspace.target.join("cases")
}

/// What a folder holds, ascending.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries = fs::read_dir(folder).map_err(|error| unreadable(folder, &error))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(Result::ok).map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    Failure(format!("{error}: {}", path.display()))
}
