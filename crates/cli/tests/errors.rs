//! Bad input gets a clear error: what, where, why, what to do, and an exit code.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod common;

use common::{CASE, Room};

#[test]
fn wrong_usage_is_2() {
    let room = Room::new();
    room.tdem(&[]).exits(2);
    room.tdem(&["run"]).exits(2).complains(&["CASE.toml"]);
    room.tdem(&["run", "case.toml", "--set", "foo"]).exits(2).complains(&["write KEY=VALUE"]);
    room.tdem(&["run", "case.toml", "--threads", "0"]).exits(2);
    for device in ["gpu", "cpu:0", "opencl:first", "cuda:"] {
        room.tdem(&["run", "case.toml", "--device", device]).exits(2).complains(&["--device", device]);
    }
    room.tdem(&["picture", "x", "--view", "sideways"]).exits(2).complains(&["corner"]);
    assert!(!room.path("runs").exists());
}

#[test]
fn a_file_that_is_not_there() {
    let room = Room::new();
    room.tdem(&["run", "nope.toml"]).exits(1).complains(&["tdem::case::unreadable", "nope.toml", "tdem new"]);
    for command in ["resume", "info", "pack", "picture"] {
        room.tdem(&[command, "nowhere"]).exits(1).complains(&["tdem::results::not-a-run", "nowhere"]);
    }
}

#[test]
fn a_device_that_is_not_there() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--steps", "10"]).exits(0);
    for arguments in [&["run", "case.toml", "--out", "new"][..], &["resume", "runs/case"]] {
        let said = room.tdem(&[arguments, &["--device", "opencl:99"]].concat());
        said.exits(1).complains(&["tdem::device::missing", "opencl:99", "tdem info", "--device cpu"]);
    }
    assert!(!room.path("new").exists());
}

#[test]
fn everything_wrong_is_told_at_once() {
    let room = Room::new();
    let case = CASE.replace("density", "densty").replace("poisson_ratio = 0.2", "poisson_ratio = 0.7");
    room.write("bad.toml", &case.replace("seed = 3", "seed = \"x\""));
    let said = room.tdem(&["run", "bad.toml"]).exits(1).complains(&[
        "bad.toml:4:8",
        "unknown key `material.glass.densty`",
        "did you mean `density`?",
        "tdem::case::missing-key",
        "poisson_ratio = 0.7",
        "4 errors",
    ]);
    assert_eq!(said.out, "");
    assert!(!said.err.contains(['\u{1b}', '─', '×']), "plain without a terminal:\n{}", said.err);
    assert!(!room.path("runs").exists());
    room.write("cut.toml", &CASE[..CASE.len() / 2 + 3]);
    room.tdem(&["check", "cut.toml"]).exits(1);
    room.write("binary.toml", "\u{0}\u{1}[[[");
    room.tdem(&["check", "binary.toml"]).exits(1).complains(&["binary.toml:1"]);
    room.write("empty.toml", "");
    room.tdem(&["run", "empty.toml"]).exits(1).complains(&["tdem::case::missing-key"]);
}

#[test]
fn an_override_that_makes_no_sense() {
    let room = Room::new();
    let check = |set: &str| room.tdem(&["check", "case.toml", "--set", set]).exits(1);
    check("time.stp=1").complains(&["did you mean `step`?", "case.toml --set time.stp=1"]);
    check("interaction.4.static_friction=1").complains(&["tdem::case::bad-override", "there is no entry 4"]);
    check("size=huge").complains(&["tdem::case::unknown-size"]);
}

#[test]
fn a_step_too_large_is_refused_with_its_cause() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--set", "time.step=0.02"]).exits(1).complains(&[
        "tdem::case::step-unstable",
        "must be at most",
        "normal_damping = 200.0",
        "damping of this pair",
        "step = \"auto\"",
    ]);
    assert!(!room.path("runs").exists());
}

#[test]
fn a_run_is_not_mixed_with_another() {
    let room = Room::new();
    let run = ["run", "case.toml", "--steps", "10"];
    room.tdem(&run).exits(0);
    room.tdem(&run).exits(1).complains(&[
        "tdem::results::run-exists",
        "tdem resume runs/case",
        "--overwrite",
        "--out DIR",
    ]);
    room.tdem(&[&run[..], &["--overwrite"]].concat()).exits(0);
    std::fs::create_dir(room.path("mine")).unwrap();
    room.write("mine/thesis.tex", "years of work");
    let mine = [&run[..], &["--out", "mine", "--overwrite"]].concat();
    room.tdem(&mine).exits(1).complains(&["tdem::results::occupied", "left alone"]);
    assert_eq!(std::fs::read_dir(room.path("mine")).unwrap().count(), 1);
}

#[test]
fn a_bad_case_does_not_cost_the_old_run() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--steps", "10", "--out", "old"]).exits(0);
    room.tdem(&["run", "case.toml", "--set", "time.end=-1", "--out", "old", "--overwrite"]).exits(1);
    room.tdem(&["resume", "old", "--steps", "20"]).exits(0);
}

#[test]
fn a_folder_that_cannot_be_written() {
    let room = Room::new();
    room.write("file", "not a folder");
    for out in ["file", "file/run", "/proc/nothing/run"] {
        room.tdem(&["run", "case.toml", "--out", out]).exits(1).complains(&["tdem::results::", out]);
    }
    room.tdem(&["new", "file/case"]).exits(1).complains(&["tdem::cli::write"]);
}

#[test]
fn measurements_that_could_not_be_written_are_not_made() {
    let room = Room::new();
    room.write("file", "not a folder");
    std::fs::create_dir(room.path("folder")).unwrap();
    for bench in [&["bench", "case", "case.toml", "--device", "cpu"][..], &["bench", "contact"]] {
        for json in ["file/new.json", "nowhere/new.json", "folder"] {
            let said = room.tdem(&[bench, &["--json", json]].concat()).exits(1);
            assert_eq!(said.out, "");
            assert!(!said.err.contains(" on "), "something was measured:\n{}", said.err);
            said.complains(&["tdem::cli::write", json]);
        }
    }
    // What stands there is safe until there is something to put in its place.
    room.write("kept.json", "old measurements");
    for arguments in [&["bench", "case", "nope.toml"][..], &["bench", "contact", "--cells", "1,2"]] {
        room.tdem(&[arguments, &["--json", "kept.json"]].concat()).exits(1);
    }
    assert_eq!(std::fs::read_to_string(room.path("kept.json")).unwrap(), "old measurements");
    assert!(!room.path("kept.json.unfinished").exists());
}

/// A step five times as large as stiff springs allow: damping by restitution has no proven limit, so that the case
/// is warned of, and let go.
fn exploding() -> String {
    CASE.replace("[[interaction]]", "[contact]\ndamping = \"restitution\"\noverlap_limit = 0.3\n[[interaction]]")
        .replace("normal_damping = 200.0", "restitution = 0.9")
        .replace("step = \"auto\"", "step = 4e-3")
        .replace("end = 0.2", "end = 4.0")
        .replace("frames = 5", "frames = 5\ncheckpoint_interval = 0.008")
}

#[test]
fn a_run_that_blows_up_names_the_fault_and_can_be_looked_at() {
    let room = Room::new();
    room.write("boom.toml", &exploding());
    let said = room.tdem(&["run", "boom.toml"]).exits(1).complains(&[
        "warning",
        "tdem::case::step-large",
        "tdem::run::",
        "particle",
        "at step",
        "(t = ",
        "last good checkpoint is of step",
        "tdem resume runs/boom",
    ]);
    assert_eq!(said.out, "");
    let info = room.tdem(&["info", "runs/boom"]).exits(0);
    assert!(info.out.contains("checkpoints"), "{}", info.out);
    let fault = |err: &str| err.lines().find(|line| line.contains("last good checkpoint")).map(str::to_owned);
    let again = room.tdem(&["resume", "runs/boom"]).exits(1);
    assert_eq!(fault(&again.err), fault(&said.err), "the same fault, exactly");
}

#[test]
fn another_case_in_the_directory_is_noticed() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--steps", "10", "--out", "run"]).exits(0);
    let kept = std::fs::read_to_string(room.path("run/case.toml")).unwrap();
    std::fs::write(room.path("run/case.toml"), kept.replace("density = 2500.0", "density = 2600.0")).unwrap();
    room.tdem(&["resume", "run"]).exits(1).complains(&["tdem::results::case-changed", "material.glass.density"]);
    room.tdem(&["resume", "run", "--accept-changes"]).exits(1).complains(&["tdem::results::other-case"]);
    std::fs::write(room.path("run/case.toml"), "model = 7").unwrap();
    room.tdem(&["resume", "run"]).exits(1).complains(&["run/case.toml"]);
    room.tdem(&["info", "run"]).exits(0);
}

/// What would clear a screen, change colours or ring a bell.
const ESCAPE: &str = "\u{1b}[2J\u{7}\u{9b}31m";

#[test]
fn escape_sequences_of_a_case_never_reach_a_terminal() {
    let room = Room::new();
    let in_toml = ESCAPE.replace('\u{1b}', "\\u001b").replace('\u{7}', "\\u0007");
    let titled = CASE.replace("title = \"Test\"", &format!("title = \"{in_toml}\"")).replace("glass", "gla\u{9b}31mss");
    let titled = titled.replace("[material.gla\u{9b}31mss]", "[material.\"gla\u{9b}31mss\"]");
    let asked =
        format!("[[curve]]\nname = \"fall\"\nx = \"time\"\nx_title = \"{in_toml}\"\ny = \"kinetic_translation\"\n");
    room.write("case.toml", &format!("{titled}pictures = 1\n{asked}"));
    let bad = titled.replace("density", &format!("\"den{in_toml}sity\"")).replace("seed = 3", "seed = \"\u{9b}31m\"");
    room.write("bad.toml", &bad);
    room.write(&format!("a{ESCAPE}.toml"), "model = 3");
    let file = format!("a{ESCAPE}.toml");
    let commands: [(&[&str], i32); 11] = [
        (&["check", "case.toml"], 0),
        (&["run", "case.toml", "--out", "run", "--steps", "20"], 0),
        (&["info", "run"], 0),
        (&["resume", "run", "--steps", "40"], 0),
        (&["report", "run"], 0),
        (&["check", "bad.toml"], 1),
        (&["check", &file], 1),
        (&["run", "case.toml", "--set", "time.\u{1b}[2J=1"], 1),
        (&["run", "case.toml", "--set", "\u{1b}[2J"], 2),
        (&["\u{1b}[2J"], 2),
        (&["run", "case.toml", "--out", "run", "\u{1b}[2J"], 2),
    ];
    let acts = |text: &str| text.contains(|letter: char| letter.is_control() && letter != '\n');
    let mut spelled = 0;
    for (command, code) in commands {
        let said = room.tdem(command).exits(code);
        assert!(!acts(&said.err) && !acts(&said.out), "{command:?}: {said:?}");
        spelled += usize::from([said.out, said.err].iter().any(|text| text.contains("\\u{1b}[2J")));
    }
    assert_eq!(spelled, 8, "titles, keys and names are shown all the same");
    for file in ["log.txt", "report.html", "curve-fall.svg"] {
        let text = std::fs::read_to_string(room.path("run").join(file)).unwrap();
        assert!(!acts(&text.replace('\t', "")), "{file}");
    }
}

#[test]
fn a_line_of_a_megabyte_is_cut_in_messages() {
    let room = Room::new();
    let name = "n".repeat(1 << 20);
    room.write("key.toml", &CASE.replace("density", &name));
    room.write("value.toml", &CASE.replace("seed = 3", &format!("seed = \"{name}\"")));
    room.write("title.toml", &CASE.replace("Test", &name));
    room.write("material.toml", &CASE.replace("glass", &name));
    let many = format!("count = 150\nwrong = [{}]\n", "1.0,\n".repeat(100_000));
    room.write("lines.toml", &CASE.replace("count = 150\n", &many));
    for (file, code) in [("key", 1), ("value", 1), ("title", 0), ("material", 0), ("lines", 1)] {
        let said = room.tdem(&["check", &format!("{file}.toml")]).exits(code);
        assert!(said.err.len() + said.out.len() < 40_000, "{file}: {}", said.err.len() + said.out.len());
    }
    room.tdem(&["check", "value.toml"]).exits(1).complains(&["value.toml:4", "..."]);
    let said = room.tdem(&["run", "title.toml", "--steps", "10", "--out", "run"]).exits(0);
    assert!(said.err.len() < 10_000);
    assert!(room.tdem(&["info", "run"]).exits(0).out.len() < 10_000);
}

#[test]
fn of_many_problems_twenty_are_shown_and_the_others_counted() {
    let room = Room::new();
    let keys: Vec<String> = (0..500).map(|k| format!("wrong_{k} = 1\n")).collect();
    room.write("bad.toml", &format!("{}{CASE}", keys.concat()));
    let said = room.tdem(&["check", "bad.toml"]).exits(1).complains(&["wrong_19`", "and 480 more"]);
    assert!(!said.err.contains("`wrong_20`"), "{}", said.err);
}

#[cfg(unix)]
#[test]
fn a_limit_on_the_size_of_files_is_an_error_with_a_message() {
    let room = Room::new();
    let often = ["--set", "output.history_interval=1e-9", "--set", "output.pictures=0"];
    let plain = room.command(&[&["run", "case.toml", "--out", "run"], &often[..]].concat());
    let words: Vec<String> = plain.get_args().map(|word| format!("'{}'", word.to_str().unwrap())).collect();
    // Blocks of 512 or 1,024 bytes: frames have room, the history does not.
    let line = format!("ulimit -f 200; exec '{}' {}", plain.get_program().to_str().unwrap(), words.join(" "));
    let mut shell = std::process::Command::new("sh");
    let output = shell.args(["-c", &line]).current_dir(room.path("")).output().unwrap();
    common::Said::of(&output).exits(1).complains(&["tdem::results::file-too-large", "ulimit -f", "history.csv"]);
    room.tdem(&["resume", "run"]).exits(0);
    let last = room.checkpoints("run").pop().unwrap();
    let last: u64 = last.file_stem().unwrap().to_str().unwrap().parse().unwrap();
    assert_eq!(common::history_steps(&room.path("run")), (0..=last).collect::<Vec<_>>());
}
