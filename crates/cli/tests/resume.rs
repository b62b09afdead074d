//! A run that is taken up goes on as what it was: every shipped case, runs whose case was edited, runs that lack what their end
//! writes, runs whose history is damaged.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod common;

use common::{Room, history_steps};
use std::fs;
use std::path::{Path, PathBuf};

#[cfg(unix)]
mod shipped {
    use super::*;
    use common::{Said, signal};
    use std::time::{Duration, Instant};

    fn cases() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases")
    }

    /// Stops a case by Ctrl-C wherever it is then, and another time in the middle; both go on to the end of an uninterrupted run.
    fn goes_on(case: &Path, set: &[&str]) {
        let room = Room::new();
        let case = case.display().to_string();
        let set: Vec<&str> =
            [&["output.pictures=0"], set].concat().into_iter().flat_map(|set| ["--set", set]).collect();
        let run = |out: &str, more: &[&str]| {
            let words = [&["run", &case, "--quiet", "--out", out], &set[..], more].concat();
            words.into_iter().map(str::to_owned).collect::<Vec<_>>()
        };
        let words = |words: &[String]| room.hash(&words.iter().map(String::as_str).collect::<Vec<_>>());

        let begun = run("cut", &[]);
        let process = room.start(&begun.iter().map(String::as_str).collect::<Vec<_>>());
        let began = Instant::now();
        while room.checkpoints("cut").is_empty() && began.elapsed() < Duration::from_mins(3) {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_millis(50));
        signal(&process, "INT");
        Said::of(&process.wait_with_output().unwrap()).exits(130).complains(&["Ctrl-C", "a checkpoint was written"]);
        let last = room.checkpoints("cut").pop().unwrap();
        let step: u64 = last.file_stem().unwrap().to_str().unwrap().parse().unwrap();

        let [middle, end] = [step.div_ceil(2).max(2), step + 5].map(|step| step.to_string());
        let whole = words(&run("whole", &["--steps", &end, "--hash"]));
        assert_eq!(room.hash(&["resume", "cut", "--steps", &end, "--hash"]), whole, "after Ctrl-C at step {step}");
        room.hash(&run("parts", &["--steps", &middle, "--hash"]).iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(room.hash(&["resume", "parts", "--steps", &end, "--hash"]), whole, "in the middle");
        for part in ["cut", "parts"] {
            assert_eq!(history_steps(&room.path(part)), history_steps(&room.path("whole")), "{part}");
        }
        room.tdem(&["check", "cut/case.toml"]).exits(0);
        room.tdem(&["picture", "parts", "--size", "60x40"]).exits(0);
    }

    /// What is over too soon to be stopped writes a checkpoint in every step.
    const SLOWLY: &str = "output.checkpoint_interval=1e-9";

    macro_rules! shipped {
        ($($name:ident $case:literal [$($set:expr),*])*) => {
            $(
                #[test]
                fn $name() {
                    goes_on(&cases().join($case), &[$($set),*]);
                }
            )*

            #[test]
            fn no_shipped_case_is_left_out() {
                let files = fs::read_dir(cases()).unwrap().map(|entry| entry.unwrap().path());
                for file in files.filter(|file| file.extension().is_some_and(|ending| ending == "toml")) {
                    let name = file.file_name().unwrap().to_str().unwrap();
                    assert!([$($case),*].contains(&name), "{name}");
                }
            }
        };
    }

    shipped! {
        bouncing_ball "bouncing-ball.toml" [SLOWLY]
        brazilian "brazilian.toml" []
        cantilever "cantilever.toml" []
        collision "collision.toml" [SLOWLY]
        compression "compression.toml" []
        direct_tension "direct-tension.toml" []
        frozen_heat "furnace-temperature.toml" ["particles.0.lattice.cells=[8, 8, 8]"]
        frozen_heat_implicit "furnace-temperature.toml"
            ["particles.0.lattice.cells=[8, 8, 8]", "heat.scheme=implicit", "heat.step=2.0"]
        staggered_heat "furnace-temperature.toml"
            ["particles.0.lattice.cells=[4, 4, 4]", "heat.motion=quasi-static", "heat.relaxation.at_most_steps=200"]
        heated_bed "heated-bed.toml" []
        heating "heating.toml" []
        mismatch "mismatch.toml" []
        packing "packing.toml" ["particles.0.random.count=2000"]
        periodic_shear "periodic-shear.toml" []
        quench "quench.toml" []
        restrained_bar "restrained-bar.toml" []
        rolling "rolling.toml" [SLOWLY]
        tension "tension.toml" []
        three_point_bending "three-point-bending.toml" []
    }

    /// Two spheres that conduct: their heat takes steps of 1 s, which would be far too long for motion.
    const FROZEN: &str = r#"
model = "GNTM"
gravity = [0.0, 0.0, 0.0]
[time]
step = "auto"
end = 100.0
[domain]
min = [0.0, 0.0, 0.0]
max = [1.0, 1.0, 1.0]
[material.m]
density = 1000.0
young_modulus = 1e7
poisson_ratio = 0.3
thermal_conductivity = 1.0
specific_heat = 900.0
thermal_expansion = 0.0
[[interaction]]
between = ["m", "m"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 100.0
tangential_damping = 10.0
[[particles]]
material = "m"
[particles.list]
positions = [[0.3, 0.5, 0.5], [0.4, 0.5, 0.5]]
radius = 0.05
[heat]
scale = "kelvin"
initial_temperature = 300.0
contacts = "bar"
bar_radius = 0.5
motion = "frozen"
step = 1.0
"#;

    #[test]
    fn a_frozen_run_with_a_step_of_the_heat_that_motion_could_not_take() {
        let room = Room::new();
        room.write("frozen.toml", FROZEN);
        goes_on(&room.path("frozen.toml"), &[SLOWLY]);
    }
}

fn edit(path: &Path, old: &str, new: &str) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(old), "`{old}` is not in:\n{text}");
    fs::write(path, text.replacen(old, new, 1)).unwrap();
}

#[test]
fn an_edited_case_is_told_and_goes_on_only_if_that_is_accepted() {
    let room = Room::new();
    let whole = room.hash(&["run", "case.toml", "--out", "whole", "--hash"]);
    room.tdem(&["run", "case.toml", "--out", "run", "--steps", "100"]).exits(0);
    let case = room.path("run/case.toml");
    edit(&case, "dynamic_friction = 0.4", "dynamic_friction = 0.1");
    edit(&case, "tangential_damping = 20.0", "# a remark\ntangential_damping   =   30");
    let before = fs::read(room.path("run/history.csv")).unwrap();
    let said = room.tdem(&["resume", "run", "--steps", "200"]).exits(1).complains(&[
        "tdem::results::case-changed",
        "the case of run was changed in 2 values since it ran",
        "interaction.0.dynamic_friction: 0.4 -> 0.1",
        "interaction.0.tangential_damping: 20.0 -> 30.0",
        "tdem resume run --accept-changes",
    ]);
    assert_eq!(said.out, "");
    assert!(fs::read(room.path("run/history.csv")).unwrap() == before && room.checkpoints("run").len() == 2);
    let accepted = ["resume", "run", "--steps", "200", "--accept-changes"];
    let told = "interaction.0.dynamic_friction: 0.4 -> 0.1; interaction.0.tangential_damping: 20.0 -> 30.0";
    room.tdem(&accepted).exits(0).complains(&["tdem::results::changes-accepted", told]);
    assert!(fs::read_to_string(room.path("run/log.txt")).unwrap().contains(told));
    // From there on the new case is the one that ran.
    let said = room.tdem(&["resume", "run", "--steps", "300"]).exits(0);
    assert!(!said.err.contains("changed"), "{}", said.err);
    assert_ne!(room.hash(&["resume", "run", "--hash"]), whole);
}

#[test]
fn remarks_more_steps_and_another_device_are_no_change_of_the_case() {
    let room = Room::new();
    let whole = room.hash(&["run", "case.toml", "--out", "whole", "--hash"]);
    room.tdem(&["run", "case.toml", "--out", "run", "--steps", "100"]).exits(0);
    let case = room.path("run/case.toml");
    edit(&case, "[domain]", "\n# Looked at and found good.\n[domain] # m");
    edit(&case, "static_friction = 0.5", "static_friction = 5.0e-1");
    let said = room.tdem(&["resume", "run", "--steps", "200", "--device", "cpu"]).exits(0);
    assert!(!said.err.contains("changed"), "{}", said.err);
    assert_eq!(room.hash(&["resume", "run", "--hash"]), whole);
}

#[test]
fn a_run_that_does_not_know_what_ran_says_so_once() {
    let room = Room::new();
    let whole = room.hash(&["run", "case.toml", "--out", "whole", "--hash"]);
    room.tdem(&["run", "case.toml", "--out", "run", "--steps", "100"]).exits(0);
    fs::remove_file(room.path("run/checkpoints/case.toml")).unwrap();
    room.tdem(&["resume", "run", "--steps", "200"]).exits(0).complains(&["tdem::results::case-unknown"]);
    let said = room.tdem(&["resume", "run", "--hash"]).exits(0);
    assert!(!said.err.contains("case-unknown") && said.out.trim() == whole, "{said:?}");
}

const CURVE: &str = "[[curve]]\nname = \"fall\"\nx = \"time\"\ny = \"kinetic_translation\"\n";

#[test]
fn a_finished_run_gets_what_its_end_could_not_write() {
    let room = Room::new();
    room.write("case.toml", &format!("{}pictures = 1\n{CURVE}", common::CASE));
    let whole = room.hash(&["run", "case.toml", "--out", "whole", "--hash"]);
    let files = |run: &str| {
        let mut names = Vec::new();
        for folder in ["", "frames", "pictures"] {
            let entries = fs::read_dir(room.path(run).join(folder)).unwrap().map(|entry| entry.unwrap().path());
            names.extend(entries.map(|path| path.strip_prefix(room.path(run)).unwrap().display().to_string()));
        }
        names.sort();
        names
    };
    let expected = files("whole");
    let read = |name: &str| fs::read(room.path("whole").join(name)).unwrap();
    let results = ["curve-fall.svg", "history.csv"];
    let before = results.map(read);
    let missing = [
        "curve-fall.svg",
        "report.html",
        "particles.vtkhdf",
        "walls.vtkhdf",
        expected.iter().rfind(|name| name.starts_with("pictures/")).unwrap(),
        expected.iter().rfind(|name| name.starts_with("frames/")).unwrap(),
    ];
    for name in missing {
        fs::remove_file(room.path("whole").join(name)).unwrap();
    }
    // Its process died before it could say that it had finished.
    let log = fs::read_to_string(room.path("whole/log.txt")).unwrap();
    fs::write(room.path("whole/log.txt"), &log[..log.find("finished").unwrap()]).unwrap();
    let said = room.tdem(&["resume", "whole", "--hash"]).exits(0).complains(&["is finished"]);
    assert_eq!(said.out.trim(), whole);
    assert_eq!(files("whole"), expected);
    assert!(results.map(read) == before);
    assert!(read("particles.vtkhdf").starts_with(b"\x89HDF"));
    let page = String::from_utf8(read("report.html")).unwrap();
    assert!(page.contains("<strong>finished</strong>"));

    // A report makes what needs no computing.
    let made = ["curve-fall.svg", "report.html", "particles.vtkhdf"];
    for name in made {
        fs::remove_file(room.path("whole").join(name)).unwrap();
    }
    room.tdem(&["report", "whole"]).exits(0);
    assert_eq!(files("whole"), expected);
    assert!(results.map(read) == before);
}

#[test]
fn a_damaged_history_is_told_with_its_lines_and_steps() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--out", "run", "--steps", "100", "--set", "output.history_interval=1e-9"])
        .exits(0);
    let path = room.path("run/history.csv");
    let mut lines: Vec<String> = fs::read_to_string(&path).unwrap().lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 102);
    lines[11] = lines[11].replacen(',', ",9", 1);
    lines.drain(50..60);
    fs::write(&path, lines.join("\n") + "\n").unwrap();
    room.tdem(&["resume", "run", "--steps", "120"]).exits(0).complains(&[
        "tdem::results::damaged-history",
        "line 12 (step 10) is not as written",
        "history.damaged.csv",
        "lacks 11 rows",
        "of steps 10, 49 to 58",
    ]);
    let expected: Vec<u64> = (0..=120).filter(|step| *step != 10 && !(49..59).contains(step)).collect();
    assert_eq!(history_steps(&room.path("run")), expected);
    // A file that is gone leaves a hole that is told.
    fs::remove_file(&path).unwrap();
    room.tdem(&["resume", "run", "--steps", "130"]).exits(0).complains(&["history.csv is missing", "0 to 119"]);
    assert_eq!(history_steps(&room.path("run")), (120..=130).collect::<Vec<_>>());
    fs::remove_file(&path).unwrap();
    fs::remove_file(room.path("run/checkpoints/history.sums")).unwrap();
    let said = room.tdem(&["resume", "run", "--steps", "131"]).exits(0);
    said.complains(&["history.csv is missing", "asked for by the case and are not there, of steps 0 to 129"]);
}
