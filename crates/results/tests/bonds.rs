//! What runs with bonds leave.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic like tests")]

mod common;

use common::{Watcher, assert_same_results, bonded, contents, schedule};
use std::fs;
use std::path::Path;
use tdem_engine::{Simulation, State, cpu};
use tdem_results::{RunDirectory, checkpoint, session};

fn run_to(directory: &mut RunDirectory, state: State, steps: u64) {
    let (_, plan) = bonded();
    directory.set_contents(contents());
    let options = cpu::Options { threads: Some(1), ..cpu::Options::default() };
    let simulation = Simulation::new(state, plan, options).unwrap();
    session::run(simulation, directory, &schedule(steps), &mut Watcher::default()).unwrap();
}

fn begin(path: &Path, steps: u64) {
    run_to(&mut RunDirectory::create(path, "# a test\n", false).unwrap(), bonded().0, steps);
}

fn go_on(path: &Path, steps: u64) {
    let mut resumed = RunDirectory::open(path).unwrap();
    run_to(&mut resumed.directory, resumed.state.unwrap(), steps);
}

/// Columns of a history, by name.
fn column(path: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(path.join("history.csv")).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let place = lines.next().unwrap().iter().position(|&column| column == name).unwrap();
    lines.map(|cells| cells[place].parse().unwrap()).collect()
}

#[test]
fn a_run_with_bonds_has_blocks_and_columns_for_them() {
    let folder = tempfile::tempdir().unwrap();
    begin(folder.path(), 400);
    let info = tdem_results::info(folder.path()).unwrap();
    assert_eq!(info.blocks, ["bonds", "contacts", "cracks", "particles", "walls"]);
    let (holding, broken) = (column(folder.path(), "bonds"), column(folder.path(), "broken_bonds"));
    let all = bonded().0.bonds.len() as f64;
    assert!(holding.iter().zip(&broken).all(|(holding, broken)| holding + broken == all));
    let end = *broken.last().unwrap();
    assert!(broken[0] == 0.0 && end > 0.0 && end < all, "{end} of {all} broke");
    assert!(column(folder.path(), "elastic_bonds").iter().any(|&energy| energy > 0.0));
    let last = checkpoint::read(&info.checkpoints.last().unwrap().path).unwrap();
    let released: f64 = last.bonds.iter().filter_map(|bond| bond.breakage).map(|breakage| breakage.energy).sum();
    let dissipated = *column(folder.path(), "breakage_dissipated").last().unwrap();
    assert!((dissipated / released - 1.0).abs() < 1e-12);
}

#[test]
fn a_run_with_bonds_that_goes_on_looks_as_if_it_had_never_ended() {
    let (straight, extended) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    begin(straight.path(), 300);
    begin(extended.path(), 133);
    go_on(extended.path(), 300);
    assert_same_results(straight.path(), extended.path());
}

#[test]
fn a_history_that_was_lost_gets_its_columns_again() {
    let (straight, broken) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    begin(straight.path(), 150);
    begin(broken.path(), 150);
    for checkpoint in tdem_results::info(broken.path()).unwrap().checkpoints {
        if checkpoint.step > 0 {
            fs::remove_file(checkpoint.path).unwrap();
        }
    }
    fs::remove_file(broken.path().join("history.csv")).unwrap();
    go_on(broken.path(), 150);
    assert_same_results(straight.path(), broken.path());
}
