//! What programs get: JSON on standard output, and particles in formats of other programs.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod common;

use common::Room;
use serde_json::Value;
use std::path::Path;

/// The object that a command printed; nothing else may stand there.
fn object(out: &str) -> Value {
    serde_json::from_str(out).unwrap_or_else(|error| panic!("{error} in:\n{out}"))
}

/// Each key of an object is in the documentation.
fn documented(told: &Value) {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/json.md");
    let page = std::fs::read_to_string(page).unwrap();
    for key in told.as_object().unwrap().keys() {
        assert!(page.contains(&format!("`{key}`")), "docs/json.md does not tell of `{key}`");
    }
}

#[test]
fn commands_tell_programs_one_object_and_nothing_else() {
    let room = Room::new();
    let check = object(&room.tdem(&["check", "case.toml", "--json"]).exits(0).out);
    assert_eq!((check["particles"].as_u64(), check["ok"].as_bool()), (Some(150), Some(true)));
    assert!(check["limits"].as_array().unwrap().iter().any(|limit| limit["proven"] == true));
    let run = object(&room.tdem(&["run", "case.toml", "--json", "--hash"]).exits(0).out);
    assert_eq!((run["outcome"].as_str(), run["step"].as_u64()), (Some("finished"), check["steps"].as_u64()));
    assert_eq!(run["hash"].as_str().map(str::len), Some(32));
    assert!(run["ledger"]["kinetic_translation"].as_f64().is_some() && run["warnings"].as_array().is_some());
    let again = object(&room.tdem(&["resume", "runs/case", "--json", "--hash"]).exits(0).out);
    assert_eq!(again["hash"], run["hash"]);
    let info = object(&room.tdem(&["info", "runs/case", "--json"]).exits(0).out);
    assert_eq!(info["frames"].as_array().map(Vec::len), Some(6));
    assert_eq!(info["title"], "Test");
    let verify = object(&room.tdem(&["verify", "free-fall", "--json", "--device", "cpu"]).exits(0).out);
    assert!(verify["cases"][0]["checks"].as_array().is_some_and(|checks| !checks.is_empty()));
    let list = object(&room.tdem(&["verify", "--list", "--json"]).exits(0).out);
    assert!(list["cases"].as_array().unwrap().len() > 100);
    let machine = object(&room.tdem(&["info", "--json"]).exits(0).out);
    assert!(machine["cores"].as_u64() > Some(0));
    for told in [&check, &run, &again, &info, &verify, &list, &machine] {
        documented(told);
        assert!(told["tdem"].as_str().unwrap().starts_with(env!("CARGO_PKG_VERSION")) && told["ok"] == true);
    }
}

#[test]
fn what_is_wrong_is_told_to_programs_too() {
    let room = Room::new();
    room.write("bad.toml", &common::CASE.replace("density = 2500.0", "density = -1.0"));
    let said = room.tdem(&["check", "bad.toml", "--json"]).exits(1).complains(&["density"]);
    let told = object(&said.out);
    documented(&told);
    assert_eq!((told["ok"].as_bool(), told["command"].as_str()), (Some(false), Some("check")));
    let problem = &told["problems"][0];
    assert!(problem["code"].as_str().unwrap().starts_with("tdem::case::") && problem["severity"] == "error");
    let none = object(&room.tdem(&["info", "nowhere", "--json"]).exits(1).out);
    assert_eq!(none["problems"][0]["code"], "tdem::results::not-a-run");
}

#[test]
fn the_version_tells_the_commit() {
    let said = Room::new().tdem(&["--version"]).exits(0);
    let version = said.out.trim().strip_prefix("tdem ").unwrap();
    let (number, commit) = version.split_once(" (").unwrap_or((version, "0123456789)"));
    assert_eq!(number, env!("CARGO_PKG_VERSION"));
    assert!(commit.len() == 11 && commit[..10].bytes().all(|byte| byte.is_ascii_hexdigit()), "{version}");
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.git").exists();
    assert!(version.contains('(') || !repository, "a build from a repository knows its commit");
}

/// The numbers of `x,y,z` of the last instant of a CSV file, by id.
fn places(csv: &str) -> Vec<(u64, [f64; 3])> {
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    let (id, x) = (at("id"), at("x"));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), columns.len());
            (cells[id].parse().unwrap(), [0, 1, 2].map(|k| cells[x + k].parse().unwrap()))
        })
        .collect()
}

#[test]
fn every_format_tells_the_same_places() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--quiet", "--steps", "40"]).exits(0);
    let export = |arguments: &[&str]| {
        let said = room.tdem(&[&["export", "runs/case"], arguments].concat()).exits(0);
        said.out.lines().map(|line| room.path(line)).collect::<Vec<_>>()
    };
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    let csv = export(&["--format", "csv"]);
    assert!(csv[0].ends_with("runs/case/export/particles.csv"));
    let expected = places(&read(&csv[0]));
    assert_eq!(expected.len(), 150);

    // Extended XYZ: a count, a comment with the columns, and the particles.
    let xyz = read(&export(&["--format", "xyz", "--out", "a/b.xyz"])[0]);
    let mut lines = xyz.lines();
    assert_eq!(lines.next(), Some("150"));
    let comment = lines.next().unwrap();
    for part in [
        "Lattice=\"0.2 0.0 0.0 0.0 0.2",
        "pbc=\"F F F\"",
        "species:S:1:pos:R:3:id:I:1:radius:R:1",
        ":velo:R:3:",
        "Step=40",
    ] {
        assert!(comment.contains(part), "`{part}` is not in {comment}");
    }
    let width: usize = comment
        .split("Properties=")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap()
        .split(':')
        .skip(2)
        .step_by(3)
        .map(|n| n.parse::<usize>().unwrap())
        .sum();
    for (line, (id, place)) in lines.zip(&expected) {
        let cells: Vec<&str> = line.split(' ').collect();
        assert_eq!((cells.len(), cells[0], cells[4].parse()), (width, "glass", Ok(*id)));
        assert_eq!([1, 2, 3].map(|k| cells[k].parse::<f64>().unwrap()), *place);
    }

    // A dump of LAMMPS: all instants one after the other.
    let dump = read(&export(&["--format", "lammps", "--all"])[0]);
    assert_eq!(dump.matches("ITEM: TIMESTEP").count(), 2);
    assert_eq!(dump.matches("ITEM: UNITS").count(), 1, "readers take another one for the end");
    let last = dump.rsplit("ITEM: ATOMS ").next().unwrap();
    let (columns, rows) = last.split_once('\n').unwrap();
    assert!(columns.starts_with("id type x y z radius") && columns.contains(" vx vy vz "), "{columns}");
    for (line, (id, place)) in rows.lines().zip(&expected) {
        let cells: Vec<&str> = line.split(' ').collect();
        assert_eq!((cells.len(), cells[0].parse(), cells[1]), (columns.split(' ').count(), Ok(id + 1), "1"));
        assert_eq!([2, 3, 4].map(|k| cells[k].parse::<f64>().unwrap()), *place);
    }

    // VTP: a file per instant, whose numbers are bytes as text.
    let files = export(&["--format", "vtp", "--all", "--out", "vtk/all.pvd"]);
    assert_eq!(files.len(), 3);
    let list = read(&files[2]);
    assert!(list.contains("timestep=\"0.0\" file=\"all-000000000000.vtp\""), "{list}");
    let points = read(&files[1]);
    let text = points.split("Name=\"Points\"").nth(1).unwrap().split(['>', '<']).nth(1).unwrap();
    let bytes = decoded(text);
    assert_eq!(u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize, bytes.len() - 8);
    let numbers: Vec<f32> =
        bytes[8..].chunks_exact(4).map(|number| f32::from_le_bytes(number.try_into().unwrap())).collect();
    assert_eq!(numbers, expected.iter().flat_map(|(_, place)| place.map(|x| x as f32)).collect::<Vec<f32>>());
}

#[test]
fn a_step_without_a_frame_is_refused_with_the_nearest() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--quiet", "--steps", "40"]).exits(0);
    room.tdem(&["export", "runs/case", "--format", "csv", "--step", "39"]).exits(1).complains(&["of step 40"]);
    room.tdem(&["export", "runs/case", "--format", "csv", "--step", "0"]).exits(0);
    room.tdem(&["export", "runs/case", "--format", "csv", "--all", "--last"]).exits(2);
}

/// Bytes of a text in base 64.
fn decoded(text: &str) -> Vec<u8> {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits: Vec<u32> =
        text.bytes().filter_map(|byte| DIGITS.iter().position(|digit| *digit == byte)).map(|d| d as u32).collect();
    let mut bytes = Vec::new();
    for group in digits.chunks(4) {
        let bits = group.iter().fold(0, |bits, digit| bits << 6 | digit) << (6 * (4 - group.len()));
        bytes.extend(&bits.to_be_bytes()[1..group.len()]);
    }
    bytes
}
