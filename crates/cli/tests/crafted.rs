//! Checkpoints with right checksums and wrong contents: every command that reads one says what is wrong with which file.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

mod common;

use common::Room;
use tdem_engine::{Contact, State};
use tdem_results::{checkpoint, load_final_state};

/// What is done to a state, and the field that must be named.
type Harm = (&'static str, fn(&mut State));

const HARMS: [Harm; 14] = [
    ("position", |state| state.position.truncate(3)),
    ("position", |state| state.position[7][1] = f64::NAN),
    ("position", |state| state.position[7][1] = 1e300),
    ("velocity", |state| state.velocity[0][2] = f64::INFINITY),
    ("velocity", |state| state.velocity.clear()),
    ("radius", |state| state.radius[3] = -0.01),
    ("radius", |state| state.radius.push(0.01)),
    ("mass", |state| state.mass[3] = 0.0),
    ("material", |state| state.material.truncate(1)),
    ("image", |state| state.image.truncate(149)),
    ("id", |state| state.id.swap(0, 1)),
    ("contacts.pair", |state| {
        state.contacts = vec![Contact { first: 0, second: 4_000_000_000, displacement: [0.0; 3] }];
    }),
    ("wall_contacts.pair", |state| state.wall_position.clear()),
    ("initial_energy", |state| state.initial_energy = f64::NEG_INFINITY),
];

const FROM: &str = "[particles.run]\ndirectory = \"runs/case\"";

#[test]
fn a_crafted_checkpoint_is_refused_by_every_command_that_reads_it() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--quiet"]).exits(0);
    let random = "random_speed = [0.0, 0.5]\n[particles.random]\ncount = 150\nradius = { min = 0.008, max = 0.012, distribution = \"number\" }";
    assert!(common::CASE.contains(random));
    room.write("next.toml", &common::CASE.replace(random, FROM));
    let whole = load_final_state(&room.path("runs/case")).unwrap();
    let last = whole.path.file_name().unwrap().to_str().unwrap().to_owned();
    let checkpoints = room.path("runs/case/checkpoints");
    for path in room.checkpoints("runs/case").into_iter().filter(|path| *path != whole.path) {
        std::fs::remove_file(path).unwrap();
    }
    for (field, harm) in HARMS {
        let mut state = whole.state.clone();
        harm(&mut state);
        checkpoint::write(&checkpoints, &state).unwrap();
        for arguments in
            [&["picture", "runs/case"][..], &["picture", "runs/case", "--field", "force"], &["check", "next.toml"]]
        {
            let said = room.tdem(arguments).exits(1);
            let quoted = format!("`{field}`");
            assert!(said.err.contains(&last) && said.err.contains(&quoted), "{field}, {arguments:?}: {}", said.err);
        }
        room.tdem(&["resume", "runs/case"]).exits(1).complains(&["tdem::results::no-checkpoint", "tdem info"]);
        let said = room.tdem(&["info", "runs/case"]).exits(0);
        assert!(said.out.contains(&format!("`{field}`")), "{field}: {}", said.out);
    }

    // Sound in itself, but not of this case.
    let harms: [fn(&mut State); 3] = [
        |state| state.material[5] = 7,
        |state| state.constraint[5] = 9,
        |state| state.wall_position.truncate(state.wall_position.len() - 1),
    ];
    for harm in harms {
        let mut state = whole.state.clone();
        state.wall_contacts.clear();
        harm(&mut state);
        checkpoint::write(&checkpoints, &state).unwrap();
        room.tdem(&["picture", "runs/case"]).exits(1).complains(&["tdem::results::other-case", &last]);
    }
    checkpoint::write(&checkpoints, &whole.state).unwrap();
    room.tdem(&["picture", "runs/case", "--size", "80x60"]).exits(0);
    room.tdem(&["check", "next.toml"]).exits(0);
}

#[test]
fn a_damaged_frame_is_named_by_every_command_and_the_run_goes_on() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--quiet", "--steps", "300"]).exits(0);
    let info = room.tdem(&["info", "runs/case"]).exits(0);
    assert!(info.out.contains("can be sent by itself"), "{}", info.out);
    let frame = room.path("runs/case/frames/000000.vtkhdf");
    let mut bytes = std::fs::read(&frame).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&frame, bytes).unwrap();
    let named = ["000000.vtkhdf", "the frame of step 0"];
    let info = room.tdem(&["info", "runs/case"]).exits(0);
    assert!(named.iter().all(|name| info.out.contains(name)), "{}", info.out);
    let told = ["tdem::results::unreadable-frame", named[0], named[1]];
    room.tdem(&["pack", "runs/case"]).exits(0).complains(&told);
    room.tdem(&["resume", "runs/case", "--quiet"]).exits(0).complains(&told);
    room.tdem(&["report", "runs/case"]).exits(0);
}

#[test]
fn a_start_that_is_lost_is_told_on_the_console() {
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--quiet", "--steps", "300"]).exits(0);
    std::fs::remove_file(&room.checkpoints("runs/case")[0]).unwrap();
    room.tdem(&["resume", "runs/case", "--quiet", "--steps", "400"]).exits(0);
    std::fs::remove_file(room.path("runs/case/start.safetensors")).unwrap();
    let said = room.tdem(&["resume", "runs/case", "--quiet", "--steps", "500"]).exits(0);
    said.complains(&["tdem::results::start-lost", "displacements are not known any more", "start.safetensors"]);
}

#[cfg(unix)]
#[test]
fn no_command_writes_through_a_link_in_a_run() {
    use std::os::unix::fs::symlink;
    let room = Room::new();
    room.tdem(&["run", "case.toml", "--quiet", "--steps", "300"]).exits(0);
    let victim = room.path("victim");
    std::fs::write(&victim, "precious").unwrap();
    for name in ["log.txt", "history.csv", ".lock"] {
        let path = room.path(&format!("runs/case/{name}"));
        let whole = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        symlink(&victim, &path).unwrap();
        let arguments = ["resume", "runs/case", "--quiet", "--steps", "400"];
        room.tdem(&arguments).exits(1).complains(&["tdem::results::linked", name]);
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, whole).unwrap();
    }
    let link = room.path("runs/case/pictures/a.png.unfinished");
    symlink(&victim, &link).unwrap();
    room.tdem(&["picture", "runs/case", "--size", "80x60", "--out", "runs/case/pictures/a.png"]).exits(0);
    assert_eq!(std::fs::read_to_string(victim).unwrap(), "precious");
    room.tdem(&["picture", "runs/case", "--size", "100000x100000"]).exits(1).complains(&["450 GB", "picture-size"]);
}
