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
    state.velocity[0] = [-0.0, 5e-324, 9.999_999_999_999_999e99];
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

/// What a process does that may not make files long: begins a run. Without the variable it is no test of its own.
#[cfg(unix)]
#[test]
fn child_with_a_full_disk() {
    let Some(path) = std::env::var_os(CHILD) else { return };
    let path = Path::new(&path);
    let error = begin(path).expect_err("no file may be as long as this run makes some");
    fs::write(path.with_extension("told"), error.to_string()).unwrap();
}

#[cfg(unix)]
const CHILD: &str = "TDEM_TEST_FULL_DISK";

#[cfg(unix)]
fn begin(path: &Path) -> Result<(), tdem_results::RunError> {
    let mut directory = RunDirectory::create(path, "# a test\n", false)?;
    directory.set_contents(common::contents());
    directory.set_pictures(common::pictures());
    let simulation = common::simulation(common::state());
    let mut watcher = common::Watcher::default();
    tdem_results::session::run(simulation, &mut directory, &common::schedule(400), &mut watcher).map(drop)
}

#[cfg(unix)]
#[test]
fn a_full_disk_ends_the_run_but_costs_nothing_that_was_written() {
    use std::process::{Command, Stdio};
    let straight = tempfile::tempdir().unwrap();
    run_new(straight.path(), 400);
    let mut victims = std::collections::BTreeSet::new();
    // Blocks of 512 bytes. Writing fails in the middle of a file, as on a disk that is full.
    for blocks in [2, 5, 12, 16, 24, 32, 40, 56, 72] {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        let ended = Command::new("sh")
            .args(["-c", "trap '' XFSZ; ulimit -f \"$0\"; exec \"$@\"", &blocks.to_string()])
            .arg(std::env::current_exe().unwrap())
            .args(["--exact", "child_with_a_full_disk", "--test-threads", "1"])
            .env(CHILD, &run)
            .stdout(Stdio::null())
            .status()
            .unwrap();
        assert!(ended.success(), "{blocks} blocks");
        let told = fs::read_to_string(run.with_extension("told")).unwrap();
        let victim = told.rsplit_once(": ").map(|(_, path)| path.to_owned()).unwrap();
        assert!(Path::new(&victim).starts_with(&run), "the path stands last: {told}");
        victims.insert(victim.strip_prefix(&run.display().to_string()).unwrap().split('/').nth(1).unwrap().to_owned());
        let folders = [run.clone(), run.join("frames"), run.join("checkpoints")];
        let unfinished = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap().flatten());
        assert!(unfinished.into_iter().all(|entry| entry.path().extension().is_none_or(|ending| ending != "tmp")));
        run_on(&run, 400);
        common::assert_same_results(straight.path(), &run);
    }
    let expected = ["checkpoints", "frames", "particles.vtkhdf", "start.safetensors"];
    assert!(expected.iter().all(|name| victims.contains(*name)), "{victims:?}");
}

#[cfg(unix)]
#[test]
fn nothing_is_written_through_a_link() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let (whole, victim) = (folder.path().join("whole"), folder.path().join("victim"));
    run_new(&whole, 100);
    let secrets = folder.path().join("secrets");
    let forget = || {
        fs::write(&victim, "precious").unwrap();
        fs::create_dir_all(&secrets).unwrap();
        for name in ["thesis.tmp", "000000.vtkhdf", "000000000100.safetensors", "speed-000000000120.png"] {
            fs::write(secrets.join(name), "precious").unwrap();
        }
    };
    let is_whole = || {
        fs::read_to_string(&victim).unwrap() == "precious"
            && fs::read_dir(&secrets)
                .unwrap()
                .all(|file| fs::read_to_string(file.unwrap().path()).unwrap() == "precious")
            && fs::read_dir(&secrets).unwrap().count() == 4
    };
    forget();
    let files =
        [".lock", "log.txt", "history.csv", "frames.csv", "start.safetensors", "particles.vtkhdf", "report.html"];
    let unfinished =
        ["history.csv.tmp", "frames.csv.tmp", "particles.vtkhdf.tmp", "checkpoints/000000000150.safetensors.tmp"];
    let folders = ["frames", "checkpoints", "pictures"];
    let mut refused = Vec::new();
    for name in files.into_iter().chain(unfinished).chain(folders) {
        let run = folder.path().join("run");
        common::copy(&whole, &run);
        let link = run.join(name);
        let target = if folders.contains(&name) { &secrets } else { &victim };
        let _ = if link.is_dir() { fs::remove_dir_all(&link) } else { fs::remove_file(&link) };
        symlink(target, &link).unwrap();
        match RunDirectory::open(&run) {
            Err(Error::Linked { path }) => {
                assert_eq!(path, link);
                refused.push(name);
            }
            Err(error) => panic!("{name}: {error}"),
            Ok(resumed) => {
                drop(resumed);
                run_on(&run, 200);
            }
        }
        let _ = tdem_results::report::write(&run, &tdem_results::report::Subject::default(), None);
        let _ = tdem_results::pack(&run, &run.join("packed"), 0);
        assert!(is_whole(), "{name}");
        // A run that begins anew puts files of its own in the place of links.
        match RunDirectory::create(&run, "# a test\n", true) {
            Ok(_) => assert!(name == ".lock" || !link.is_symlink(), "{name}"),
            Err(Error::Linked { path }) => assert_eq!((name, path), (".lock", link)),
            Err(error) => panic!("{name}: {error}"),
        }
        assert!(is_whole(), "{name}");
        fs::remove_dir_all(&run).unwrap();
    }
    assert_eq!(refused, [".lock", "log.txt", "history.csv", "frames", "checkpoints", "pictures"]);

    // Where packed files go, too.
    symlink(&secrets, whole.join("packed")).unwrap();
    assert!(matches!(tdem_results::pack(&whole, &whole.join("packed"), 0), Err(Error::Linked { .. })));
    assert!(is_whole());
}

/// What is done to a run.
type Harm = fn(&Path);

#[test]
fn displacements_go_on_counting_from_the_start_when_the_first_checkpoint_is_gone() {
    let straight = tempfile::tempdir().unwrap();
    run_new(straight.path(), 400);
    let harms: [(&str, Harm, bool); 5] = [
        (
            "the first checkpoint deleted",
            |run| fs::remove_file(run.join("checkpoints/000000000000.safetensors")).unwrap(),
            true,
        ),
        ("the first checkpoint damaged", |run| spoil(&run.join("checkpoints/000000000000.safetensors")), true),
        ("the places deleted", |run| fs::remove_file(run.join("start.safetensors")).unwrap(), true),
        ("the places damaged", |run| spoil(&run.join("start.safetensors")), true),
        (
            "both gone",
            |run| {
                fs::remove_file(run.join("checkpoints/000000000000.safetensors")).unwrap();
                fs::remove_file(run.join("start.safetensors")).unwrap();
            },
            false,
        ),
    ];
    for (name, harm, recovers) in harms {
        let folder = tempfile::tempdir().unwrap();
        run_new(folder.path(), 250);
        harm(folder.path());
        let lost = RunDirectory::open(folder.path()).unwrap().start_lost;
        assert_eq!(lost.is_none(), recovers, "{name}: {lost:?}");
        let log = fs::read_to_string(folder.path().join("log.txt")).unwrap();
        assert_eq!(log.contains("displacements are not known any more"), !recovers, "{name}");
        run_on(folder.path(), 400);
        if recovers {
            common::assert_same_results(straight.path(), folder.path());
        } else {
            assert!(tdem_results::info(folder.path()).unwrap().unreadable_frames.is_empty());
        }
    }
}

fn spoil(path: &Path) {
    let mut bytes = fs::read(path).unwrap();
    let last = bytes.len() - 9;
    bytes[last] ^= 16;
    fs::write(path, bytes).unwrap();
}
