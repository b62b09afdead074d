//! The real command, run in a folder of its own.
#![allow(dead_code, reason = "each test file uses a part of it")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A box of spheres falling, small enough for many runs.
pub(crate) const CASE: &str = r#"
title = "Test"
model = "GNTM"
seed = 3
gravity = [0.0, 0.0, -9.81]
[time]
step = "auto"
end = 0.2
[domain]
min = [0.0, 0.0, 0.0]
max = [0.2, 0.2, 0.2]
[material.glass]
density = 2500.0
young_modulus = 5.0e6
poisson_ratio = 0.2
[[interaction]]
between = ["glass", "glass"]
normal_damping = 200.0
static_friction = 0.5
dynamic_friction = 0.4
tangential_damping = 20.0
[[box]]
material = "glass"
[[particles]]
material = "glass"
random_speed = [0.0, 0.5]
[particles.random]
count = 150
radius = { min = 0.008, max = 0.012, distribution = "number" }
[output]
frames = 5
"#;

/// A folder with a case in it.
pub(crate) struct Room {
    folder: TempDir,
}

impl Room {
    /// With the small case as `case.toml`.
    pub(crate) fn new() -> Self {
        let room = Room { folder: TempDir::new().unwrap() };
        room.write("case.toml", CASE);
        room
    }
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tdem"));
        command.args(arguments).current_dir(self.folder.path()).env_remove("NO_COLOR").stdin(Stdio::null());
        // Processes that run at the same time must not share PoCL's cache: each slot of nextest has its own.
        let slot = std::env::var("NEXTEST_TEST_GLOBAL_SLOT").unwrap_or_else(|_| "alone".to_owned());
        command.env("POCL_CACHE_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join("pocl").join(slot));
        command
    }
    pub(crate) fn tdem(&self, arguments: &[&str]) -> Said {
        Said::of(&self.command(arguments).output().unwrap())
    }
    /// Runs to the end and returns the line with the hash.
    pub(crate) fn hash(&self, arguments: &[&str]) -> String {
        let said = self.tdem(arguments).exits(0);
        let line = said.out.trim().to_owned();
        let digits = line.strip_prefix("hash ").unwrap_or_default();
        assert!(digits.len() == 32 && digits.chars().all(|c| c.is_ascii_hexdigit()), "{line}");
        line
    }
    /// Starts a command whose output nobody reads until it has ended.
    pub(crate) fn start(&self, arguments: &[&str]) -> Child {
        self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }
    /// The checkpoints of a run, ascending.
    pub(crate) fn checkpoints(&self, run: &str) -> Vec<PathBuf> {
        let Ok(entries) = std::fs::read_dir(self.path(run).join("checkpoints")) else { return Vec::new() };
        let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        paths.retain(|path| path.extension().is_some_and(|ending| ending == "safetensors"));
        paths.sort();
        paths
    }
}

/// What a command said.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Said {
    pub(crate) fn of(output: &Output) -> Self {
        Said {
            code: output.status.code(),
            out: String::from_utf8(output.stdout.clone()).unwrap(),
            err: String::from_utf8(output.stderr.clone()).unwrap(),
        }
    }
    #[track_caller]
    pub(crate) fn exits(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout:\n{}\nstderr:\n{}", self.out, self.err);
        assert!(!self.err.contains("panicked"), "{}", self.err);
        self
    }
    /// All of these stand in standard error.
    #[track_caller]
    pub(crate) fn complains(self, of: &[&str]) -> Self {
        for part in of {
            assert!(self.err.contains(part), "`{part}` is not in:\n{}", self.err);
        }
        self
    }
}

/// Waits until something holds; false after ten seconds.
pub(crate) fn eventually(mut holds: impl FnMut() -> bool) -> bool {
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(10) {
        if holds() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    false
}

/// Sends a signal.
#[cfg(unix)]
pub(crate) fn signal(process: &Child, name: &str) {
    let status = Command::new("kill").args([&format!("-{name}"), &process.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Steps of a history.
pub(crate) fn history_steps(run: &Path) -> Vec<u64> {
    let text = std::fs::read_to_string(run.join("history.csv")).unwrap();
    text.lines().skip(1).filter_map(|line| line.split(',').next()?.parse().ok()).collect()
}
