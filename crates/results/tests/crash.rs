//! `kill -9` at any moment never leaves a directory that cannot be read and resumed.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic like tests")]

mod common;

use std::env;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use tdem_engine::Schedule;
use tdem_results::{Error, RunDirectory};

const CHILD: &str = "TDEM_TEST_RUN";
const STEPS: u64 = 100_000;
const KILLS: u32 = 25;

/// Writes as densely as it can, so that a random moment is likely to be in the middle of a file.
fn schedule() -> Schedule {
    Schedule {
        steps: STEPS,
        frame_every: 20,
        history_every: 1,
        picture_every: 30,
        checkpoint_every: Some(7),
        ..Schedule::default()
    }
}

/// What a killed process does: begins a run or goes on with it. Without the variable it is no test of its own.
#[test]
fn child() {
    let Some(path) = env::var_os(CHILD) else { return };
    let path = Path::new(&path);
    let (mut directory, state) = match RunDirectory::open(path) {
        Ok(resumed) => (resumed.directory, resumed.state),
        Err(Error::NotARun { .. }) => (RunDirectory::create(path, "# a test\n", false).unwrap(), None),
        Err(error) => panic!("{error}"),
    };
    directory.set_contents(common::contents());
    directory.set_pictures(common::pictures());
    let simulation = common::simulation(state.unwrap_or_else(common::state));
    tdem_results::session::run(simulation, &mut directory, &schedule(), &mut common::Watcher::default()).unwrap();
}

#[test]
fn killed_at_random_moments_a_run_can_be_read_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut reached = 0;
    let mut torn = 0;
    for kill in 0..KILLS {
        let mut child = Command::new(env::current_exe().unwrap())
            .args(["--exact", "child", "--test-threads", "1"])
            .env(CHILD, &run)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        // The first few die while the run begins.
        let patience = if kill < 5 { 3_000 } else { 250_000 };
        sleep(Duration::from_micros(2_000 + random % patience));
        assert!(child.try_wait().unwrap().is_none(), "the child ended by itself at kill {kill}");
        child.kill().unwrap();
        child.wait().unwrap();
        torn += usize::from(has_unfinished(&run));

        // Read without resuming, as ParaView and Python would.
        if run.join("case.toml").exists() {
            let info = tdem_results::info(&run).unwrap();
            assert!(info.unreadable_frames.is_empty(), "kill {kill}: {:?}", info.unreadable_frames);
            assert!(info.checkpoints.iter().all(|checkpoint| checkpoint.particles.is_ok()), "kill {kill}");
            let newest = info.checkpoints.last().map_or(0, |checkpoint| checkpoint.step);
            assert!(newest >= reached, "kill {kill}: nothing that was reached may be lost");
            reached = newest;
            if !info.frames.is_empty() && kill % 6 == 0 {
                tdem_results::pack(&run, &folder.path().join("packed"), 0).unwrap();
            }
        }
    }
    assert!(reached > 0, "no child lived long enough");
    assert!(torn > 0, "no child died while it wrote: the test proves nothing");

    // The survivor equals a run that was never killed.
    let resumed = RunDirectory::open(&run).unwrap();
    let end = resumed.state.as_ref().unwrap().step + 20;
    drop(resumed);
    let straight = folder.path().join("straight");
    let finish = |path: &Path| {
        let (mut directory, state) = match RunDirectory::open(path) {
            Ok(resumed) => (resumed.directory, resumed.state.unwrap()),
            Err(_) => (RunDirectory::create(path, "# a test\n", false).unwrap(), common::state()),
        };
        directory.set_contents(common::contents());
        directory.set_pictures(common::pictures());
        let schedule = Schedule { steps: end, ..schedule() };
        let simulation = common::simulation(state);
        tdem_results::session::run(simulation, &mut directory, &schedule, &mut common::Watcher::default()).unwrap();
    };
    finish(&run);
    finish(&straight);
    common::assert_same_results(&straight, &run);
    assert!(!has_unfinished(&run));
}

fn has_unfinished(run: &Path) -> bool {
    ["", "frames", "checkpoints", "pictures"].iter().any(|folder| {
        let entries = std::fs::read_dir(run.join(folder)).into_iter().flatten().flatten();
        entries.into_iter().any(|entry| entry.path().extension().is_some_and(|ending| ending == "tmp"))
    })
}
