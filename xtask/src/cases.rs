//! The cases of the repository, run by the program that users run, and what they wrote, read by other programs.

use crate::command::{Command, Failure, cargo, program_at};
use crate::workspace::Workspace;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Child;
use std::sync::Mutex;

/// The main job: this case runs to its end.
const WHOLE: &str = "packing";
/// The others only show that they run.
const STEPS: &str = "200";
/// Reports of these are opened in a browser: one of each kind, and one that is compared with a reference.
const SHOWN: &[&str] = &["packing", "tension", "heating", "furnace-temperature"];
/// What reads the results.
const READERS: &[&str] = &["vtk", "h5py", "numpy"];

/// The program as users have it. It has one unit of code per crate, so that building it leaves a core to others.
const BUILD: &str = "build --release --quiet --package tdem";

/// Begins to build the program, beside other parts. Whoever builds it later waits until this is done.
pub(crate) fn build_ahead() -> Result<Child, Failure> {
    cargo(BUILD).start()
}

pub(crate) fn run(workspace: &Workspace) -> Result<(), Failure> {
    cargo(BUILD).run()?;
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
    let script = program_at(python(&workspace.target)?).argument(workspace.root.join("scripts/check_results.py"));
    runs.iter().fold(script, Command::argument).run()
}

/// Opens reports in a browser.
pub(crate) fn show(workspace: &Workspace) -> Result<(), Failure> {
    let runs: Vec<PathBuf> = SHOWN.iter().map(|name| results(workspace).join(name)).collect();
    if let Some(missing) = runs.iter().find(|run| !run.exists()) {
        return Err(Failure(format!("the part `cases` makes what is to be shown: {}", missing.display())));
    }
    let script = program_at(system_python()).argument(workspace.root.join("scripts/check_report.py"));
    runs.iter().fold(script, Command::argument).run()
}

fn system_python() -> &'static str {
    if cfg!(windows) { "python" } else { "python3" }
}

/// Begins to install the readers, beside other parts: it takes the network more than a core.
pub(crate) fn readers_ahead(workspace: &Workspace) {
    let target = workspace.target.clone();
    // Where it fails, who needs them tries again and tells why.
    std::thread::spawn(move || python(&target).is_ok());
}

/// A Python that has the readers, installed on first use, by one thread.
fn python(target: &Path) -> Result<PathBuf, Failure> {
    static INSTALLING: Mutex<()> = Mutex::new(());
    let _one = INSTALLING.lock();
    let environment = target.join("venv");
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
