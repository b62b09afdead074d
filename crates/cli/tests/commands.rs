//! The commands besides `run` and `resume` do what they say.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod common;

use common::Room;

#[test]
fn check_tells_limits_and_costs() {
    let room = Room::new();
    let said = room.tdem(&["check", "case.toml"]).exits(0);
    for part in ["`glass`", "proven", "estimate", "Rayleigh waves", "memory", "150", "6, one every", "they fill"] {
        assert!(said.out.contains(part), "`{part}` is not in:\n{}", said.out);
    }
    assert_eq!(said.err, "");
    let stiff = "[material.steel]\ndensity = 7800.0\nyoung_modulus = 2e11\npoisson_ratio = 0.3\n";
    let of_steel = common::CASE.replace("[[box]]\nmaterial = \"glass\"", "[[box]]\nmaterial = \"steel\"");
    let pair = "[[interaction]]\nbetween = [\"glass\", \"steel\"]\nnormal_damping = 2000.0\nstatic_friction = 0.5\n\
                dynamic_friction = 0.4\ntangential_damping = 20.0\n[[box]]";
    room.write("two.toml", &of_steel.replace("[[box]]", pair).replace("[material", &format!("{stiff}[material")));
    let said = room.tdem(&["check", "two.toml"]).exits(0);
    let first = said.out.lines().skip_while(|line| !line.contains("step/limit")).nth(1).unwrap();
    assert!(first.contains("`steel`"), "the limiting pair comes first: {first}");
}

#[test]
fn the_starter_case_is_good_and_never_replaces_another() {
    let room = Room::new();
    room.tdem(&["new", "silo"]).exits(0).complains(&["tdem run silo.toml"]);
    room.tdem(&["check", "silo.toml"]).exits(0);
    room.write("silo.toml", "mine");
    room.tdem(&["new", "silo"]).exits(1).complains(&["tdem::cli::file-exists"]);
    room.tdem(&["new", "silo.toml"]).exits(1);
    assert_eq!(std::fs::read_to_string(room.path("silo.toml")).unwrap(), "mine");
}

#[test]
fn a_run_can_be_looked_at_and_sent() {
    let room = Room::new();
    room.tdem(&["run", "case.toml"]).exits(0).complains(&["particles.vtkhdf", "ParaView", "energy error", " 100 %"]);
    let quiet = room.tdem(&["run", "case.toml", "--quiet", "--overwrite"]).exits(0);
    // But for what there is to be warned of: spheres this soft are pressed deep into the floor.
    assert_eq!((quiet.out.as_str(), quiet.err.matches("tdem::").count()), ("", 1));
    assert!(quiet.err.contains("tdem::run::large-overlap"), "{}", quiet.err);
    let info = room.tdem(&["info", "runs/case"]).exits(0);
    assert!(info.out.contains("150 particles"), "{}", info.out);
    let packed = room.tdem(&["pack", "runs/case"]).exits(0);
    assert!(
        packed.out.lines().count() == 2 && packed.out.lines().all(|file| room.path(file).exists()),
        "{}",
        packed.out
    );
    let picture = room.tdem(&["picture", "runs/case", "--size", "80x60"]).exits(0);
    let bytes = std::fs::read(room.path(picture.out.trim())).unwrap();
    assert!(bytes.starts_with(b"\x89PNG"));
    for view in ["top", "bottom", "front", "1,-1,0.5", "-1,0,0"] {
        let arguments = ["picture", "runs/case", "--view", view, "--field", "force", "--time", "0", "--out", "a.png"];
        room.tdem(&[&arguments[..], &["--size", "80x60", "--close"]].concat()).exits(0).complains(&["Step 0"]);
    }
    room.tdem(&["picture", "runs/case", "--size", "0x60"]).exits(1).complains(&["tdem::results::picture-size"]);
    room.tdem(&["picture", "runs/case", "--out", "no/where.png"]).exits(1).complains(&["tdem::cli::write"]);
}

#[test]
fn a_run_ends_in_a_page_with_pictures() {
    let room = Room::new();
    let asked = "\n[[picture]]\nname = \"cut\"\nfield = \"height\"\nview = \"front\"\nsize = [120, 90]\n\
                 clip = { point = [0.0, 0.1, 0.0], normal = [0.0, -1.0, 0.0] }\n";
    room.write("case.toml", &common::CASE.replace("frames = 5\n", &format!("frames = 5\npictures = 2\n{asked}")));
    room.tdem(&["run", "case.toml", "--hash"]).exits(0).complains(&["runs/case/report.html", "pictures/"]);
    let pictures = |run: &str| {
        let folder = std::fs::read_dir(room.path(run).join("pictures")).into_iter().flatten();
        let mut names: Vec<String> =
            folder.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    let names = pictures("runs/case");
    assert_eq!(names.len(), 3, "{names:?}");
    assert!(names.iter().all(|name| name.starts_with("cut-0000")), "{names:?}");
    let read = || std::fs::read_to_string(room.path("runs/case/report.html")).expect("the page is there");
    let page = read();
    for part in
        ["<strong>finished</strong>", "<h1>Test</h1>", "<dd>GNTM</dd>", "computed by", "CPU", "hash", "t = 0.2 s"]
    {
        assert!(page.contains(part), "`{part}` is not in the page");
    }
    assert_eq!(page.matches("data:image/png").count(), 3);
    // A picture that is drawn later is one more of them.
    room.tdem(&["picture", "runs/case", "--field", "force", "--clip", "0,0.1,0:0,-1,0", "--size", "120x90"]).exits(0);
    room.tdem(&["picture", "runs/case", "--clip", "0,0.1,0"]).exits(2);
    let said = room.tdem(&["report", "runs/case"]).exits(0);
    assert!(said.out.trim().ends_with("report.html"), "{}", said.out);
    assert_eq!(read().matches("data:image/png").count(), 4);
    room.tdem(&["report", "nowhere"]).exits(1).complains(&["tdem::results::not-a-run"]);
    // A case that can no longer be read does not hide what its run left.
    room.write("runs/case/case.toml", "model = 3");
    room.tdem(&["report", "runs/case", "--out", "b.html"]).exits(0);
    let without = std::fs::read_to_string(room.path("b.html")).expect("the page is there");
    assert!(without.contains("The case cannot be read any more") && without.contains("data:image/png"));

    room.tdem(&["run", "case.toml", "--set", "output.pictures=0", "--out", "bare", "--steps", "20"]).exits(0);
    assert!(pictures("bare").is_empty() && room.path("bare/report.html").exists());
}

#[test]
fn a_run_begins_where_another_ended() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--out", "first", "--steps", "300"]).exits(0);
    let group = "[particles.random]\ncount = 150\nradius = { min = 0.008, max = 0.012, distribution = \"number\" }\n";
    let next = common::CASE
        .replace(group, "[particles.run]\ndirectory = \"first\"\n")
        .replace("random_speed = [0.0, 0.5]\n", "");
    room.write("next.toml", &next);
    room.tdem(&["run", "next.toml", "--steps", "20"]).exits(0);
    room.tdem(&["resume", "runs/next", "--steps", "40"]).exits(0);
}

#[test]
fn machine_schema_shells_and_manual() {
    let room = Room::new();
    let info = room.tdem(&["info"]).exits(0);
    for part in ["core", "opencl:0", "OpenCL", "driver", "compute unit", "double precision", "self-test passed", "cuda"]
    {
        assert!(info.out.contains(part), "`{part}` is not in:\n{}", info.out);
    }
    let schema: serde_json::Value = serde_json::from_str(&room.tdem(&["schema"]).exits(0).out).unwrap();
    assert!(schema["properties"]["particles"].is_object());
    assert!(room.tdem(&["completions", "bash"]).exits(0).out.contains("tdem"));
    assert!(room.tdem(&["man"]).exits(0).out.contains(".TH"));
    room.tdem(&["man", "--out", "pages"]).exits(0);
    assert!(room.path("pages/tdem-run.1").exists());
    assert!(room.tdem(&["run", "--help"]).exits(0).out.contains("Examples:"));
}

#[test]
fn verify_judges() {
    let room = Room::new();
    let list = room.tdem(&["verify", "--list"]).exits(0);
    let name = list.out.lines().find(|line| line.contains(" quick ")).and_then(|line| line.split(' ').next()).unwrap();
    let said = room.tdem(&["verify", name, "--device", "all", "--markdown"]).exits(0);
    assert!(said.out.contains('|') && said.err.contains("ok "), "{}\n{}", said.out, said.err);
    room.tdem(&["verify", "nonsense"]).exits(1).complains(&["tdem::verify::unknown-name", "--list"]);
}

#[test]
fn codes_are_explained() {
    let room = Room::new();
    let all = room.tdem(&["explain"]).exits(0).out;
    for part in ["tdem::case::through-wall", "tdem::run::escaped", "tdem::results::locked", "exit code 128 + signal"] {
        assert!(all.lines().any(|line| line.starts_with(part)), "`{part}` is not in:\n{all}");
    }
    let one = room.tdem(&["explain", "through-wall"]).exits(0).out;
    assert!(one.starts_with("error tdem::case::through-wall\n\n") && one.contains("normal of a wall"), "{one}");
    let both = room.tdem(&["explain", "overlap"]).exits(0).out;
    assert!(both.contains("tdem::case::overlap") && both.contains("tdem::run::overlap"), "{both}");
    let by_word = room.tdem(&["explain", "behind", "wall"]).exits(0).out;
    assert!(by_word.contains("tdem::case::through-wall") && !by_word.contains("tdem::results::locked"), "{by_word}");
    let instead = room.tdem(&["explain", "stl"]).exits(0).out;
    assert!(instead.contains("no meshes") && instead.contains("[[box]]"), "{instead}");
    room.tdem(&["explain", "mushroom"]).exits(1).complains(&["tdem::cli::unknown-code", "tdem explain"]);
}

const ROCK: &str = r#"
model = "BPM"
gravity = [0.0, 0.0, 0.0]
[time]
step = "auto"
end = 1e-5
[domain]
min = [-0.1, -0.1, -0.1]
max = [0.2, 0.2, 0.2]
[material.rock]
density = 3000.0
young_modulus = 30e9
poisson_ratio = 0.2
[[interaction]]
between = ["rock", "rock"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 1000.0
tangential_damping = 100.0
[[particles]]
name = "block"
material = "rock"
lattice = { kind = "fcc", radius = 0.005, cells = [3, 3, 4], origin = [0.0, 0.0, 0.0] }
[[bond]]
between = ["rock", "rock"]
tensile_strength = 1e6
shear_strength = 4e6
moment_contribution = 0.0
[bond.micro]
young_modulus = 10e9
stiffness_ratio = 0.6
"#;

/// The number behind a key, or the last number of a comment.
fn value(text: &str, key: &str) -> f64 {
    let line = text.lines().find(|line| line.contains(key)).unwrap_or_else(|| panic!("no `{key}` in:\n{text}"));
    line.split_whitespace().filter_map(|word| word.parse().ok()).next_back().unwrap()
}

#[test]
fn calibrate_gives_bonds_that_do_what_was_asked() {
    let room = Room::new();
    room.write("rock.toml", ROCK);
    let asked = ["--young-modulus", "25e9", "--poisson-ratio", "0.15"];
    let torn = room.tdem(&[&["calibrate", "rock.toml"], &asked[..], &["--tensile-strength", "2e6"]].concat()).exits(0);
    assert!((value(&torn.out, "# Poisson's ratio") - 0.15).abs() < 2e-5, "{}", torn.out);
    // Torn along a lattice: what was asked for to the part that calibration stops at.
    let strength = torn.out.lines().find(|line| line.contains("# tensile strength")).unwrap();
    let strength: f64 = strength.split_whitespace().nth(4).unwrap().parse().unwrap();
    assert!((strength / 2e6 - 1.0).abs() <= 0.01, "{}", torn.out);
    assert!((value(&torn.out, "shear_strength") / value(&torn.out, "tensile_strength") - 4.0).abs() < 1e-5);
    // What is printed takes the place of the [[bond]] and needs no correction.
    let before = ROCK.split("[[bond]]").next().unwrap();
    room.write("found.toml", &format!("{before}{}", torn.out));
    let again = room.tdem(&["calibrate", "found.toml", "--young-modulus", "25e9"]).exits(0);
    for key in ["young_modulus", "stiffness_ratio", "tensile_strength"] {
        assert!((value(&again.out, key) / value(&torn.out, key) - 1.0).abs() < 1e-5, "{key}:\n{}", again.out);
    }
}

#[test]
fn calibrate_says_what_cannot_be_had() {
    let room = Room::new();
    room.write("rock.toml", ROCK);
    let calibrate = |set: &[&str], asked: &[&str]| {
        let sets: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        room.tdem(&[&["calibrate", "rock.toml", "--young-modulus", "25e9"], &sets[..], asked].concat()).exits(1)
    };
    calibrate(&[], &["--poisson-ratio", "0.45"]).complains(&["tdem::calibrate::poisson-out-of-reach", "it goes from"]);
    let unbreakable = ["bond.0.tensile_strength=unbreakable", "bond.0.shear_strength=unbreakable"];
    calibrate(&unbreakable, &["--tensile-strength", "1e6"]).complains(&["tdem::calibrate::unbreakable"]);
    let closed =
        ["domain.min=[0.0, -0.1, -0.1]", "domain.max=[0.04243, 0.2, 0.2]", "domain.periodic=[true, false, false]"];
    calibrate(&closed, &[]).complains(&["tdem::calibrate::periodic"]);
    let (before, after) = ROCK.split_once("[[bond]]").unwrap();
    let apart = "[[particles]]\nname = \"apart\"\nmaterial = \"rock\"\n\
                 lattice = { kind = \"fcc\", radius = 0.005, cells = [3, 3, 3], origin = [0.0, 0.0, 0.1] }\n";
    room.write("apart.toml", &format!("{before}{apart}[[bond]]{after}"));
    room.tdem(&["calibrate", "apart.toml", "--young-modulus", "1e9"])
        .exits(1)
        .complains(&["tdem::calibrate::not-spanning"]);
    room.tdem(&["calibrate", "case.toml", "--young-modulus", "1e9"])
        .exits(1)
        .complains(&["tdem::calibrate::not-bonded"]);
    room.tdem(&["calibrate", "rock.toml", "--young-modulus", "-1"]).exits(2);
}

#[test]
fn bench_draws_the_figures_of_the_paper() {
    let room = Room::new();
    let bench = ["bench", "--paper-figures", "--device", "cpu,opencl", "--threads", "2", "--sizes", "small"];
    let few = ["--models", "GN,TBPM", "--seconds", "1e-6", "--out", "figures"];
    let said = room.tdem(&[&bench[..], &few].concat()).exits(0);
    for part in ["| GN | paper | 8000 |", "| TBPM | best | 5324 |", "P100, scaled", "a copy moves"] {
        assert!(said.out.contains(part), "`{part}` is not in:\n{}", said.out);
    }
    let read = |name: &str| std::fs::read_to_string(room.path(name)).expect("it was written");
    let found: serde_json::Value = serde_json::from_str(&read("figures/bench.json")).unwrap();
    let rows = found["measurements"].as_array().unwrap();
    assert_eq!((rows.len(), found["planned"].as_u64()), (8, Some(8)));
    for row in rows {
        // Measurements of one step each end in the same state on every device.
        let same = |other: &&serde_json::Value| ["model", "mode", "hash"].iter().all(|key| row[key] == other[key]);
        assert_eq!(rows.iter().filter(same).count(), 2, "{row}");
    }
    for machine in found["machines"].as_array().unwrap() {
        assert!(machine["operations_per_second"].as_f64().unwrap() > 1e8, "{machine}");
    }
    let page = read("figures/index.html");
    assert!(page.contains("--models GN,TBPM") && page.contains("Figure 7: roofline"));
    assert!(said.out.trim_end().ends_with(read("figures/table.md").trim_end()));
    std::fs::remove_file(room.path("figures/index.html")).expect("it was there");
    let again = room.tdem(&["bench", "--paper-figures", "--redraw", "--out", "figures"]).exits(0);
    assert!(read("figures/index.html") == page, "the page of the same measurements is another");
    assert_eq!(again.out.trim_end(), read("figures/table.md").trim_end());
    room.write("figures/bench.json", "{}");
    let none = ["bench", "--paper-figures", "--redraw", "--out"];
    room.tdem(&[&none[..], &["figures"]].concat()).exits(1).complains(&["bench.json", "benchmark"]);
    room.tdem(&[&none[..], &["nowhere"]].concat()).exits(1).complains(&["cannot read", "--out"]);
    room.tdem(&["bench"]).exits(2);
    room.tdem(&["bench", "--sizes", "small"]).exits(2);
    room.tdem(&["bench", "--paper-figures", "--sizes", "7k"]).exits(2);
    room.write("file", "");
    room.tdem(&["bench", "--paper-figures", "--out", "file"]).exits(1).complains(&["tdem::cli::write"]);
}

#[test]
fn bench_case_tells_where_the_time_goes() {
    let room = Room::new();
    let bench = ["bench", "case", "case.toml", "--threads", "1", "--paper", "--steps", "5", "--repeats", "1"];
    let with_stages = ["--device", "cpu,opencl", "--profile", "6", "--kernels", "--json", "found.json"];
    room.write("found.json", "older");
    let said = room.tdem(&[&bench[..], &with_stages].concat()).exits(0);
    for part in ["GNTM on CPU", "6 steps with stages apart", "% of copy", "gather", "rows_fill", "sum is", "GB/step"] {
        assert!(said.out.contains(part), "`{part}` is not in:\n{}", said.out);
    }
    assert!(said.out.lines().all(|line| line.chars().count() < 160), "{}", said.out);
    let found: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(room.path("found.json")).unwrap()).unwrap();
    let rows = found["measurements"].as_array().unwrap();
    let [processor, device] = &rows[..] else { panic!("two devices were asked for") };
    assert_eq!(processor["hash"], device["hash"]);
    assert!(processor["machine"]["processor"].is_string());
    for key in ["interface", "name", "driver", "memory_bytes", "compute_units"] {
        assert!(!device["machine"][key].is_null(), "{key}");
    }
    for row in rows {
        let number = |key: &str| row[key].as_f64().filter(|&n| n > 0.0).expect(key);
        let whole = 150.0 / number("best_particle_steps_per_second");
        let expected = number("bytes_per_step") / whole / number("copy_bytes_per_second");
        assert!((number("fraction_of_copy") / expected - 1.0).abs() < 1e-9);
        let profile = &row["profile"];
        assert_eq!(profile["searches"], 6);
        let seconds = |part: &serde_json::Value| part["seconds"].as_f64().unwrap();
        let stages: f64 = profile["stages"].as_array().unwrap().iter().map(seconds).sum();
        let sum = profile["seconds_of_parts"].as_f64().unwrap();
        assert!((stages / sum - 1.0).abs() < 1e-9 && stages > 0.0);
    }
    let plain = room.tdem(&[&bench[..], &["--device", "cpu", "--profile", "0"]].concat()).exits(0);
    assert!(!plain.out.contains("stages apart"), "{}", plain.out);
    let hash = processor["hash"].as_str().unwrap();
    assert!(plain.out.contains(hash), "a profile changed the measurement:\n{}", plain.out);
}
