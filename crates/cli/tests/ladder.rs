//! `tdem ladder` compares runs of a case, writes what it found, and says what it cannot compare.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod common;

use common::Room;
use std::fs;

/// 32 spheres that are heated from above, in some hundred steps.
const WARM: &str = r#"
title = "Warm"
model = "TBPM"
gravity = [0.0, 0.0, 0.0]
[time]
step = "auto"
end = 1e-3
[domain]
min = [-0.05, -0.05, -0.05]
max = [0.1, 0.1, 0.1]
[material.rock]
density = 3000.0
young_modulus = 20e9
poisson_ratio = 0.2
thermal_conductivity = 2.0
specific_heat = 900.0
thermal_expansion = 8e-6
[[interaction]]
between = ["rock", "rock"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 1000.0
tangential_damping = 100.0
[heat]
scale = "celsius"
initial_temperature = 20.0
contacts = "closed"
bar_radius = "fcc"
duration = 400.0
[bonds]
local_damping = 0.5
[[bond]]
between = ["rock", "rock"]
damping_ratio = 0.05
moment_contribution = 0.0
[bond.lattice]
young_modulus = 20e9
poisson_ratio = 0.2
tensile_strength = 1e12
shear_factor = 3.0
[[particles]]
material = "rock"
lattice = { kind = "fcc", radius = 0.005, cells = [2, 2, 2], origin = [0.0, 0.0, 0.0] }
[[surface]]
face = "+z"
temperature = [[0.0, 20.0], [200.0, 120.0]]
"#;

const LADDER: [&str; 6] = ["ladder", "warm.toml", "--device", "cpu", "--threads", "1"];

#[test]
fn a_ladder_is_shown_and_written() {
    let room = Room::new();
    room.write("warm.toml", WARM);
    let said = room.tdem(&[&LADDER[..], &["--instants", "4"]].concat()).exits(0);
    for part in
        ["S = 4e5 against S/2 = 2e5", "S/2 = 2e5 against S/4 = 1e5", "T rms K", "S/4 in place of S/2: at the end"]
    {
        assert!(said.out.contains(part), "`{part}` is not in:\n{}", said.out);
    }
    let said =
        said.complains(&["Warm", "4e5, 2e5, 1e5 times as fast as motion", "about", "runs/warm-ladder", " 100 %"]);
    assert!(said.out.contains("no bond is broken"), "{}", said.out);
    let table = fs::read_to_string(room.path("runs/warm-ladder/ladder.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 2 * 4, "{table}");
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{table}");
    let number = |row: usize, name: &str| -> f64 {
        let column = rows[0].iter().position(|column| *column == name).unwrap();
        rows[row][column].parse().unwrap()
    };
    // Two pairs at the same times of the heat, the second nearer to each other and with an order.
    for instant in 1..=4 {
        assert_eq!(number(instant, "heat_time"), number(instant + 4, "heat_time"));
        assert!(number(instant + 4, "temperature_rms") < number(instant, "temperature_rms"));
    }
    assert!((number(8, "temperature_order") - 1.0).abs() < 0.2, "{table}");
    assert_eq!(number(8, "finer_time_scale"), 1e5);
    let document = fs::read_to_string(room.path("runs/warm-ladder/ladder.md")).unwrap();
    assert!(document.starts_with("# The price of acceleration: Warm\n"), "{document}");
    assert!(document.contains("| rung | time scale |") && document.contains("## S/2 = 2e5 against S/4 = 1e5"));
}

#[test]
fn results_that_are_there_are_kept() {
    let room = Room::new();
    room.write("warm.toml", WARM);
    let short = [&LADDER[..], &["--rungs", "2", "--instants", "1", "--quiet", "--out", "price"]].concat();
    let said = room.tdem(&short).exits(0);
    assert_eq!(said.err, "");
    room.write("price/ladder.csv", "mine");
    room.tdem(&short).exits(1).complains(&["tdem::ladder::exists", "--overwrite"]);
    assert_eq!(fs::read_to_string(room.path("price/ladder.csv")).unwrap(), "mine");
    room.tdem(&[&short[..], &["--overwrite"]].concat()).exits(0);
    assert!(fs::read_to_string(room.path("price/ladder.csv")).unwrap().starts_with("rung,"));
}

#[test]
fn heat_by_itself_has_rungs_of_its_steps() {
    let room = Room::new();
    let by_itself =
        WARM.replace("duration = 400.0", "motion = \"frozen\"\nstep = 20.0").replace("end = 1e-3", "end = 80.0");
    room.write("warm.toml", &by_itself);
    let said = room.tdem(&[&LADDER[..], &["--instants", "2", "--rungs", "3"]].concat()).exits(0);
    for part in ["h = 20 against h/2 = 10", "heat step s", "h/4 in place of h/2: at the end"] {
        assert!(said.out.contains(part), "`{part}` is not in:\n{}", said.out);
    }
    said.complains(&["in steps of 20, 10, 5 s"]);
    let table = fs::read_to_string(room.path("runs/warm-ladder/ladder.csv")).unwrap();
    assert!(
        table.lines().nth(4).is_some_and(|row| row.starts_with("h/2,h/4,") && row.ends_with(",1e1,5e0")),
        "{table}"
    );
    let document = fs::read_to_string(room.path("runs/warm-ladder/ladder.md")).unwrap();
    assert!(document.starts_with("# The price of long steps of the heat: Warm\n"), "{document}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_compares_the_rungs_that_are_complete() {
    use std::io::{BufRead, BufReader};
    let room = Room::new();
    room.write("warm.toml", WARM);
    let mut process = room.start(&[&LADDER[..], &["--instants", "2", "--set", "time.end=0.02"]].concat());
    let mut lines = BufReader::new(process.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.any(|line| line.contains("rung 3 of 3")), "the third rung begins");
    common::signal(&process, "INT");
    let told: Vec<String> = lines.collect();
    let said = common::Said::of(&process.wait_with_output().unwrap()).exits(128 + 2);
    assert!(told.iter().any(|line| line.contains("Stopped by Ctrl-C: 2 of 3 rungs are complete")), "{told:?}");
    assert!(told.iter().any(|line| line.contains("--resume")), "{told:?}");
    assert!(said.out.contains("against S/2") && !said.out.contains("S/4"), "{}", said.out);
    let table = fs::read_to_string(room.path("runs/warm-ladder/ladder.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 2, "{table}");

    let again = [&LADDER[..], &["--instants", "2", "--set", "time.end=0.02"]].concat();
    room.tdem(&again).exits(1).complains(&["tdem::ladder::exists", "--resume", "--overwrite", "--out"]);
    let resumed = room.tdem(&[&again[..], &["--resume"]].concat()).exits(0);
    assert!(resumed.out.contains("S/2 = 10000 against S/4 = 5000"), "{}", resumed.out);
    resumed.complains(&["there already", "rung 3 of 3"]);
    let longer = fs::read_to_string(room.path("runs/warm-ladder/ladder.csv")).unwrap();
    assert!(longer.starts_with(&table) && longer.lines().count() == 1 + 2 * 2, "{longer}");
    let other = [&LADDER[..], &["--instants", "2", "--set", "time.end=0.01", "--resume"]].concat();
    room.tdem(&other).exits(1).complains(&["tdem::ladder::other-case", "rung-1", "--overwrite"]);
}

#[test]
fn a_fault_leaves_the_table_of_what_ended_before() {
    let room = Room::new();
    // A grain leaves the domain when the second rung is at three quarters.
    let grain = "[[particles]]\nmaterial = \"rock\"\nloose = true\nvelocity = [16.0, 0.0, 0.0]\n\
                 list = { radius = 0.005, positions = [[0.05, 0.05, 0.0]] }\n";
    room.write("warm.toml", &WARM.replace("[[surface]]", &format!("{grain}[[surface]]")));
    let ladder = [&LADDER[..], &["--instants", "4", "--set", "time.end=2e-3"]].concat();
    let said = room.tdem(&ladder).exits(1);
    for part in ["S = 2e5 against S/2 = 1e5", "S/2 in place of S: after"] {
        assert!(said.out.contains(part), "`{part}` is not in:\n{}", said.out);
    }
    let fault = ["left the domain", "tdem::ladder::fault", "rung S/2 of the ladder", "1 of 3 rungs are complete"];
    let said = said.complains(&fault);
    let table = fs::read_to_string(room.path("runs/warm-ladder/ladder.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 3, "{table}");
    // It goes on behind the last instant, to the same fault.
    let again = room.tdem(&[&ladder[..], &["--resume"]].concat()).exits(1).complains(&fault);
    assert_eq!(fs::read_to_string(room.path("runs/warm-ladder/ladder.csv")).unwrap(), table);
    let at = |said: &common::Said| said.err.lines().find(|line| line.contains("left the domain")).map(str::to_owned);
    assert_eq!(at(&again), at(&said));
}

#[test]
fn what_has_no_ladder_is_told() {
    let room = Room::new();
    room.write("warm.toml", WARM);
    room.tdem(&["ladder", "case.toml", "--device", "cpu"]).exits(1).complains(&["tdem::ladder::no-heat", "[heat]"]);
    let ladder = |more: &[&str]| room.tdem(&[&LADDER[..], more].concat());
    ladder(&["--set", "heat.duration=1e-3"]).exits(1).complains(&["tdem::ladder::not-accelerated", "time_scale"]);
    ladder(&["--set", "heat.duration=2e-3"]).exits(1).complains(&["tdem::ladder::too-many-rungs", "--rungs"]);
    ladder(&["--rungs", "1"]).exits(2);
    // What the case itself is refused for is said as by `tdem check`, with the rung.
    ladder(&["--set", "time.end=1e-5"]).exits(1).complains(&["tdem::case::time-scale", "rung S of the ladder"]);
    room.write(
        "pressed.toml",
        &format!(
            "{WARM}[[wall]]\nname = \"press\"\npoint = [0.0, 0.0, 0.08]\n\
                                         normal = [0.0, 0.0, -1.0]\nvelocity = [0.0, 0.0, -0.1]\nmaterial = \"rock\"\n"
        ),
    );
    let pressed = room.tdem(&["ladder", "pressed.toml", "--device", "cpu"]).exits(1);
    pressed.complains(&["tdem::ladder::follows-motion", "`press` moves"]);
}
