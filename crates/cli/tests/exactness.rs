//! The same case gives the same bits: on any number of threads, in any mode, and whatever happens in between.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod common;

use common::{Room, Said, history_steps};

const RUN: [&str; 4] = ["run", "case.toml", "--hash", "--out"];

fn run(out: &str) -> Vec<&str> {
    [&RUN[..], &[out]].concat()
}

#[test]
fn threads_lanes_and_lists_do_not_change_a_bit() {
    let room = Room::new();
    let expected = room.hash(&run("plain"));
    let modes: [(&str, &[&str]); 5] = [
        ("one", &["--threads", "1"]),
        ("two", &["--threads", "2", "--quiet"]),
        ("seven", &["--threads", "7"]),
        ("scalar", &["--scalar"]),
        ("full", &["--list", "full", "--device", "cpu"]),
    ];
    for (name, mode) in modes {
        assert_eq!(room.hash(&[&run(name), mode].concat()), expected, "{name}");
    }
}

#[test]
fn a_run_in_parts_is_the_run_in_one() {
    let room = Room::new();
    let whole = room.hash(&run("whole"));
    let part = room.hash(&[&run("parts")[..], &["--steps", "101"]].concat());
    assert_ne!(part, whole);
    assert_eq!(room.hash(&["resume", "parts", "--steps", "101", "--hash"]), part, "it is finished");
    room.tdem(&["resume", "parts", "--steps", "333", "--scalar"]).exits(0).complains(&["checkpoint of step 101"]);
    assert_eq!(room.hash(&["resume", "parts", "--threads", "1", "--hash"]), whole);
    let rest = room.tdem(&["resume", "parts", "--hash"]).exits(0).complains(&["is finished"]);
    assert_eq!(rest.out.trim(), whole);
    // What was written is the same as well.
    assert_eq!(history_steps(&room.path("parts")), history_steps(&room.path("whole")));
    let frames = |run: &str| std::fs::read_dir(room.path(run).join("frames")).unwrap().count();
    assert_eq!(frames("parts"), frames("whole"));
}

/// What is added to the small case: balls on the floor that are driven and pulled, watched, and drawn.
const DRIVEN: &str = r#"
[[zone]]
name = "low"
box = { max = [0.2, 0.2, 0.04] }
prescribed = { x = [[0.0, 0.0], [0.1, 0.02], [0.15, -0.02]], z = 0.0 }
[[zone]]
name = "high"
box = { min = [0.0, 0.0, 0.1] }
force = { z = [[0.05, 0.0], [0.15, -5.0]], y = 0.5 }
[[gauge]]
name = "low"
of = "low"
[[gauge]]
name = "apart"
between = ["low", "high"]
[[curve]]
name = "push"
x = "low_displacement_x"
y = "low_force_x"
y_factor = -1.0
"#;

#[test]
fn a_driven_run_in_parts_is_the_run_in_one_with_its_gauges_and_its_curve() {
    let room = Room::new();
    room.write("case.toml", &format!("{}{DRIVEN}", common::CASE));
    let whole = room.hash(&run("whole"));
    // Within both ramps.
    let step = 0.4 * history_steps(&room.path("whole")).into_iter().max().unwrap() as f64;
    let said = room.tdem(&["run", "case.toml", "--out", "parts", "--steps", &format!("{}", step as u64)]).exits(0);
    said.complains(&["curve-push.svg"]);
    std::fs::remove_file(room.path("parts").join("curve-push.svg")).unwrap();
    let said = room.tdem(&["resume", "parts", "--hash"]).exits(0).complains(&["curve-push.svg"]);
    assert_eq!(said.out.trim(), whole);
    let read = |run: &str, file: &str| std::fs::read_to_string(room.path(run).join(file)).unwrap();
    let history = read("whole", "history.csv");
    assert!(history.lines().next().unwrap().ends_with(",low_displacement_z,apart_elongation,apart_strain"));
    assert_eq!(read("parts", "history.csv"), history);
    assert_eq!(read("parts", "curve-push.svg"), read("whole", "curve-push.svg"));
}

/// Needs a device of OpenCL; PoCL will do.
#[test]
fn a_run_may_change_devices_on_its_way() {
    let room = Room::new();
    let whole = room.hash(&[&run("whole")[..], &["--device", "cpu"]].concat());
    room.tdem(&["run", "case.toml", "--out", "moved", "--steps", "201", "--device", "cpu"]).exits(0);
    let said = room.tdem(&["resume", "moved", "--steps", "533", "--device", "opencl"]).exits(0);
    said.complains(&["checkpoint of step 201", "through OpenCL"]);
    let said = room.tdem(&["resume", "moved", "--device", "cpu", "--hash"]).exits(0);
    let said = said.complains(&["checkpoint of step 533", "CPU"]);
    assert_eq!(said.out.trim(), whole);
    assert_eq!(history_steps(&room.path("moved")), history_steps(&room.path("whole")));
}

#[test]
fn a_damaged_checkpoint_is_passed_over() {
    let room = Room::new();
    let expected = room.hash(&run("whole"));
    room.tdem(&["run", "case.toml", "--out", "hurt", "--steps", "200"]).exits(0);
    room.tdem(&["resume", "hurt", "--steps", "400"]).exits(0);
    let newest = room.checkpoints("hurt").pop().unwrap();
    let mut bytes = std::fs::read(&newest).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&newest, bytes).unwrap();
    let info = room.tdem(&["info", "hurt"]).exits(0);
    assert!(info.out.contains("cannot be used"), "{}", info.out);
    let said = room.tdem(&["resume", "hurt", "--hash"]).exits(0);
    let said = said.complains(&["tdem::results::damaged-checkpoint", "warning", "checkpoint of step 200"]);
    assert_eq!(said.out.trim(), expected);
}

#[cfg(unix)]
mod unix {
    use super::*;
    use common::{eventually, signal};
    use std::process::{Command, Stdio};
    use std::time::Duration;

    /// Long enough to be interrupted.
    const LONG: [&str; 2] = ["--set", "time.end=2.0"];

    fn a_signal_leaves_a_checkpoint_and_the_same_end(name: &str, number: i32, device: &str) {
        let room = Room::new();
        let expected = room.hash(&[&run("whole")[..], &LONG].concat());
        let process = room.start(&[&run("cut")[..], &LONG, &["--device", device]].concat());
        assert!(eventually(|| !room.checkpoints("cut").is_empty()));
        // `timeout`, shells and batch systems let one request arrive twice.
        signal(&process, name);
        signal(&process, name);
        let said = Said::of(&process.wait_with_output().unwrap()).exits(128 + number);
        let named = if name == "INT" { "Ctrl-C".to_owned() } else { format!("SIG{name}") };
        let said = said.complains(&[&named, "a checkpoint was written", "tdem resume cut"]);
        assert_eq!(said.out, "");
        assert_eq!(room.hash(&["resume", "cut", "--hash"]), expected);
    }

    #[test]
    fn sigterm_leaves_a_checkpoint_and_the_same_end() {
        a_signal_leaves_a_checkpoint_and_the_same_end("TERM", 15, "auto");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_terminal_that_closes_leaves_a_checkpoint_and_the_same_end() {
        a_signal_leaves_a_checkpoint_and_the_same_end("HUP", 1, "auto");
    }

    /// Drivers of devices may handle signals in their own way.
    #[test]
    fn ctrl_c_on_a_device_leaves_a_checkpoint_and_the_same_end() {
        a_signal_leaves_a_checkpoint_and_the_same_end("INT", 2, "opencl");
    }

    #[test]
    fn a_run_under_nohup_goes_on_when_its_terminal_closes() {
        let room = Room::new();
        let plain = room.command(&[&run("kept")[..], &LONG].concat());
        let mut command = Command::new("nohup");
        command.arg(plain.get_program()).args(plain.get_args()).current_dir(room.path(""));
        let process = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        assert!(eventually(|| !room.checkpoints("kept").is_empty()));
        signal(&process, "HUP");
        Said::of(&process.wait_with_output().unwrap()).exits(0).complains(&["Finished"]);
    }

    #[test]
    fn kill_at_any_moment_loses_nothing() {
        let room = Room::new();
        // Checkpoints, rows and frames are written all the time, so that the end often comes amid writing.
        let busy = ["--set", "output.checkpoint_interval=0.002", "--set", "output.frames=100"];
        let expected = room.hash(&[&run("whole")[..], &busy].concat());
        let mut moment: u64 = 12_345;
        for trial in 0..6 {
            let out = format!("trial{trial}");
            let mut process = room.start(&[&run(&out)[..], &busy].concat());
            // Before its case is written there is no run to go on with.
            assert!(eventually(|| room.path(&out).join("case.toml").exists()));
            for _ in 0..2 {
                moment = moment.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                std::thread::sleep(Duration::from_millis((moment >> 33) % 120));
                // It may have come to its end meanwhile.
                let _ = process.kill();
                process.wait().unwrap();
                room.tdem(&["info", &out]).exits(0);
                process = room.start(&["resume", &out]);
            }
            let _ = process.kill();
            process.wait().unwrap();
            assert_eq!(room.hash(&["resume", &out, "--hash"]), expected, "trial {trial}");
            assert_eq!(history_steps(&room.path(&out)), history_steps(&room.path("whole")));
        }
    }

    #[test]
    fn a_second_process_is_refused() {
        let room = Room::new();
        let mut process = room.start(&["run", "case.toml", "--out", "busy", "--set", "time.end=1000.0"]);
        assert!(eventually(|| !room.checkpoints("busy").is_empty()));
        let said = room.tdem(&["resume", "busy"]);
        process.kill().unwrap();
        process.wait().unwrap();
        said.exits(1).complains(&["tdem::results::locked", "live process"]);
    }
}
