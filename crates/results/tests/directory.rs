//! What a run directory does with bad luck: damage, full disks, other processes, other people's files.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic like tests")]

mod common;

use common::{run_new, run_on};
use std::fs;
use std::path::Path;
use tdem_results::{Damage, Error, RunDirectory, checkpoint, load_final_state};

#[test]
fn a_state_comes_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let mut simulation = common::simulation(common::state());
    let mut state = simulation.state().unwrap();
    while state.contacts.is_empty() || state.wall_contacts.is_empty() {
        assert!(state.step < 20_000, "the test needs contacts");
        simulation.advance(100).unwrap();
        state = simulation.state().unwrap();
    }
    state.derivatives = vec![[[1.0, -0.0, 1.0 / 3.0]; 4]; state.len()];
    state.velocity[0] = [-0.0, 5e-324, f64::MAX];
    state.image[3] = [-1, i32::MAX, i32::MIN];
    let path = checkpoint::write(folder.path(), &state).unwrap();
    let read = checkpoint::read(&path).unwrap();
    assert_eq!(read, state);
    assert!(read.velocity[0][0].is_sign_negative() && read.derivatives[0][0][1].is_sign_negative());
    let empty = tdem_engine::State::default();
    assert_eq!(checkpoint::read(&checkpoint::write(folder.path(), &empty).unwrap()), Ok(empty));
}

#[test]
fn a_damaged_checkpoint_is_passed_over_and_told() {
    let (straight, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(straight.path(), 400);
    run_new(folder.path(), 400);
    let newest = tdem_results::info(folder.path()).unwrap().checkpoints.pop().unwrap();
    let mut bytes = fs::read(&newest.path).unwrap();
    let last = bytes.len() - 200;
    bytes[last] ^= 4;
    fs::write(&newest.path, bytes).unwrap();

    let final_state = load_final_state(folder.path()).unwrap();
    assert_eq!((final_state.state.step, final_state.damaged.len()), (350, 1));
    let resumed = RunDirectory::open(folder.path()).unwrap();
    assert_eq!(resumed.state.as_ref().unwrap().step, 350);
    let damaged = &resumed.damaged[0];
    assert!(matches!(damaged.damage, Damage::Tensor { .. }));
    assert!(damaged.to_string().ends_with("000000000400.safetensors"), "the path stands last: {damaged}");
    drop(resumed);
    run_on(folder.path(), 400);
    common::assert_same_results(straight.path(), folder.path());
}

#[test]
fn without_any_good_checkpoint_a_run_is_not_resumed_but_kept() {
    let folder = tempfile::tempdir().unwrap();
    run_new(folder.path(), 100);
    for checkpoint in tdem_results::info(folder.path()).unwrap().checkpoints {
        fs::write(checkpoint.path, "rubbish").unwrap();
    }
    let before = common::results(folder.path());
    assert!(matches!(RunDirectory::open(folder.path()), Err(Error::NoCheckpoint { damaged: 3, .. })));
    assert!(before == common::results(folder.path()));
}

#[test]
fn a_run_that_died_before_its_first_checkpoint_begins_again() {
    let (straight, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(straight.path(), 100);
    drop(RunDirectory::create(folder.path(), "# the case\n", false).unwrap());
    fs::remove_file(folder.path().join("history.csv")).unwrap();
    fs::remove_dir(folder.path().join("frames")).unwrap();
    let resumed = RunDirectory::open(folder.path()).unwrap();
    assert!(resumed.state.is_none());
    assert_eq!(resumed.directory.case_toml().unwrap(), "# the case\n");
    drop(resumed);
    run_on(folder.path(), 100);
    common::assert_same_results(straight.path(), folder.path());
}

#[test]
fn one_process_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let held = RunDirectory::create(folder.path(), "", false).unwrap();
    // A lock belongs to an open file, so that this process is as foreign as any other.
    let error = RunDirectory::open(folder.path()).unwrap_err();
    let own = std::process::id();
    assert!(matches!(error, Error::Locked { process: Some(process), .. } if process == own), "{error}");
    assert!(matches!(RunDirectory::create(folder.path(), "", true), Err(Error::Locked { .. })));
    drop(held);
    RunDirectory::open(folder.path()).unwrap();
}

#[test]
fn runs_and_other_files_are_not_overwritten_by_chance() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("thesis.tex"), "years of work").unwrap();
    for overwrite in [false, true] {
        assert!(matches!(RunDirectory::create(path, "", overwrite), Err(Error::Occupied { .. })));
    }
    assert_eq!(fs::read_dir(path).unwrap().count(), 1, "nothing was added");

    let run = path.join("deep/run");
    run_new(&run, 100);
    fs::write(run.join("notes.md"), "mine").unwrap();
    assert!(matches!(RunDirectory::create(&run, "", false), Err(Error::RunExists { .. })));
    drop(RunDirectory::create(&run, "# another\n", true).unwrap());
    assert_eq!(fs::read_to_string(run.join("notes.md")).unwrap(), "mine");
    assert_eq!(fs::read_to_string(run.join("case.toml")).unwrap(), "# another\n");
    assert!(!run.join("particles.vtkhdf").exists());
    assert_eq!(fs::read_dir(run.join("frames")).unwrap().count(), 0);
    assert!(matches!(RunDirectory::open(&path.join("nowhere")), Err(Error::NotARun { .. })));
    assert!(matches!(load_final_state(path), Err(Error::NotARun { .. })));
}

#[test]
fn an_unwritable_folder_is_told_with_its_path_last() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let error = RunDirectory::create(&file.join("run"), "", false).unwrap_err();
    assert!(matches!(error, Error::Io { .. }));
    assert!(error.to_string().ends_with("file/run"), "{error}");
}

/// Whatever is written under the temporary name goes to a device that is always full.
#[cfg(target_os = "linux")]
fn fill_disk(finished: &Path) {
    let mut name = finished.file_name().unwrap().to_os_string();
    name.push(".tmp");
    std::os::unix::fs::symlink("/dev/full", finished.with_file_name(name)).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_the_run_but_costs_nothing_that_was_written() {
    use tdem_results::RunError;
    for victim in ["frames/000003.vtkhdf", "checkpoints/000000000140.safetensors", "particles.vtkhdf"] {
        let (straight, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        run_new(straight.path(), 400);
        let mut directory = RunDirectory::create(folder.path(), "", false).unwrap();
        directory.set_contents(common::contents());
        directory.set_pictures(common::pictures());
        let victim = folder.path().join(victim);
        fill_disk(&victim);
        let simulation = common::simulation(common::state());
        let schedule = common::schedule(400);
        let error = tdem_results::session::run(simulation, &mut directory, &schedule, &mut common::Watcher::default())
            .unwrap_err();
        drop(directory);
        let RunError::Results(Error::DiskFull { path }) = &error else { panic!("{error}: {error:?}") };
        assert_eq!(*path, victim);
        assert!(error.to_string().ends_with(&victim.display().to_string()), "the path stands last");
        let folders = [folder.path(), &folder.path().join("frames"), &folder.path().join("checkpoints")];
        let unfinished = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap().flatten());
        assert!(unfinished.into_iter().all(|entry| entry.path().extension().is_none_or(|ending| ending != "tmp")));
        run_on(folder.path(), 400);
        common::assert_same_results(straight.path(), folder.path());
    }
}
