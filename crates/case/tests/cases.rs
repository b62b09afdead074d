//! Every case of the repository loads and builds, and the paper's sizes have the paper's numbers.

use std::path::{Path, PathBuf};
use tdem_case::{Built, load};

fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases")
}

fn build(file: &str, overrides: &[(&str, &str)]) -> Built {
    let overrides: Vec<(String, String)> =
        overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let loaded = load(&cases().join(file), &overrides).unwrap_or_else(|p| panic!("{p}"));
    let built = loaded.build().unwrap_or_else(|p| panic!("{p}"));
    assert!(built.state.validate(&built.plan).is_ok());
    built
}

#[test]
fn every_case_builds_without_warning() {
    let mut count = 0;
    for entry in std::fs::read_dir(cases()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let built = build(path.file_name().unwrap().to_str().unwrap(), &[]);
            assert!(built.warnings.problems.is_empty(), "{}", built.warnings);
            assert!(built.schedule.steps > 100 && built.schedule.frame_every > 0);
            count += 1;
        }
    }
    assert!(count >= 9);
}

#[test]
fn pictures_are_as_many_as_a_case_asks_for() {
    let every = |set: &[(&str, &str)]| {
        let schedule = build("packing.toml", set).schedule;
        (schedule.steps, schedule.picture_every)
    };
    let (steps, often) = every(&[]);
    assert_eq!(often, steps.div_ceil(4));
    assert_eq!(every(&[("output.pictures", "10")]).1, steps.div_ceil(10));
    assert_eq!(every(&[("output.pictures", "0")]).1, 0);
    assert_eq!(every(&[("output.frames", "0")]).1, 0, "who wants no frames wants no pictures");
    assert_eq!(every(&[("output.frames", "0"), ("output.pictures", "2")]).1, steps.div_ceil(2));
    let names = |file: &str| {
        let loaded = load(&cases().join(file), &[]).expect("the case is good");
        loaded.case.pictures().into_iter().map(|picture| picture.name).collect::<Vec<_>>()
    };
    assert_eq!(names("packing.toml"), ["velocity"]);
    assert_eq!(names("tension.toml"), ["damage"]);
    assert_eq!(names("heated-bed.toml"), ["temperature"]);
    assert_eq!(names("heating.toml"), ["temperature", "cracks"], "those of the case");
}

#[test]
fn every_case_survives_being_written_out() {
    for file in [
        "packing.toml",
        "bouncing-ball.toml",
        "rolling.toml",
        "periodic-shear.toml",
        "collision.toml",
        "tension.toml",
        "brazilian.toml",
        "compression.toml",
        "cantilever.toml",
    ] {
        let loaded = load(&cases().join(file), &[]).unwrap();
        let written = loaded.effective_toml();
        let again = tdem_case::parse("written", &written, Path::new("/nowhere"), &[]).unwrap_or_else(|p| panic!("{p}"));
        assert_eq!(again.effective_toml(), written, "{file}");
        let (first, second) = (loaded.build().unwrap(), again.build().unwrap());
        assert_eq!(first.state.hash(), second.state.hash(), "{file}");
        assert_eq!(first.plan, second.plan, "{file}");
    }
}

#[test]
fn a_preset_that_was_written_out_is_not_applied_again() {
    let loaded = load(
        &cases().join("packing.toml"),
        &[("size".into(), "83k".into()), ("particles.0.lattice.cells".into(), "[3, 3, 3]".into())],
    )
    .unwrap();
    let again = tdem_case::parse("written", &loaded.effective_toml(), Path::new(""), &[]).unwrap();
    assert_eq!(again.build().unwrap().state.len(), 108);
}

#[test]
fn the_papers_sizes_are_exact() {
    for (size, count) in [("83k", 83_300), ("686k", 686_000), ("1.4m", 1_362_944), ("3m", 3_015_300)] {
        let built = build("packing.toml", &[("size", size)]);
        assert_eq!(built.state.len(), count);
        assert_eq!(built.memory.particles, count);
        assert_eq!(built.plan.dt, 1.5e-5);
        assert_eq!(built.schedule.steps, 100_000);
        assert!(built.warnings.problems.is_empty(), "{}", built.warnings);
    }
}

#[test]
fn the_papers_lattice_has_the_papers_contacts() {
    let built = build("packing.toml", &[("size", "83k")]);
    // Cells as wide as a diameter; each pair is counted from its lower index.
    let radius = 0.02;
    let key = |p: &[f64; 3]| p.map(|c| (c / (2.0 * radius)) as i64);
    let mut cells = std::collections::BTreeMap::<[i64; 3], Vec<usize>>::new();
    for (k, p) in built.state.position.iter().enumerate() {
        cells.entry(key(p)).or_default().push(k);
    }
    let mut touching = 0;
    for (k, p) in built.state.position.iter().enumerate() {
        let at = key(p);
        for n in 0..27 {
            let cell = [at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1];
            for &other in cells.get(&cell).into_iter().flatten() {
                let q = built.state.position[other];
                let distance = (0..3).map(|d| (p[d] - q[d]) * (p[d] - q[d])).sum::<f64>().sqrt();
                touching += usize::from(other > k && distance < 2.0 * radius);
            }
        }
    }
    assert_eq!(touching, 480_654);
}

#[test]
fn the_papers_prism_has_the_papers_particles_and_the_lattices_bonds() {
    for (size, particles, bonds) in [("88k", 88_872, 513_720), ("627k", 627_264, 3_691_410)] {
        let built = build("tension.toml", &[("size", size)]);
        assert_eq!((built.state.len(), built.state.bonds.len()), (particles, bonds));
        let steel = built.state.material.iter().filter(|&&material| material == 1).count();
        // A quarter of a bar of 10 mm radius in a quarter of 75 x 75 mm; ribs and whole layers on the mirrors add.
        let part = steel as f64 / particles as f64;
        assert!((0.0139..0.02).contains(&part), "{part}");
        assert!(built.warnings.problems.is_empty(), "{}", built.warnings);
    }
}

#[test]
fn the_default_packing_is_what_it_says() {
    let built = build("packing.toml", &[]);
    assert_eq!(built.state.len(), 8000);
    assert!(built.state.position.iter().all(|p| p[2] > 1.0));
    let speed = |v: &[f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    assert!(built.state.velocity.iter().all(|v| speed(v) <= 0.1 + 1e-12));
    assert!(built.plan.dt > 8e-5, "{}", built.plan.dt);
    assert_eq!(built.plan.walls.len(), 6);
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_others() {
    let first = build("packing.toml", &[("particles.0.random.count", "500")]);
    let again = build("packing.toml", &[("particles.0.random.count", "500")]);
    assert_eq!(first.state.hash(), again.state.hash());
    let other = build("packing.toml", &[("particles.0.random.count", "500"), ("seed", "3")]);
    assert_ne!(first.state.hash(), other.state.hash());
}

#[test]
fn bodies_of_the_tests_are_what_their_cases_say() {
    for (file, particles, held) in
        [("brazilian.toml", 3493, 18), ("compression.toml", 3509, 18), ("cantilever.toml", 3000, 100)]
    {
        let built = build(file, &[]);
        assert_eq!(built.state.len(), particles, "{file}");
        let ordered = built.state.constraint.iter().filter(|&&constraint| constraint > 0).count();
        assert!(ordered >= held && ordered < particles / 10, "{file}: {ordered}");
        // Inside, twelve; less where faces are.
        let per_particle = 2.0 * built.state.bonds.len() as f64 / particles as f64;
        assert!((9.0..12.0).contains(&per_particle), "{file}: {per_particle}");
    }
}

/// What a run keeps of a case is read by `resume`, `picture`, `report` and `check`: it must be the case that ran.
#[test]
fn the_case_that_a_run_keeps_is_read_back_as_what_ran() {
    let files = std::fs::read_dir(cases()).unwrap().map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let mut variants: Vec<(PathBuf, Vec<(&str, &str)>)> = files.map(|path| (path, Vec::new())).collect();
    assert!(variants.len() >= 16);
    let furnace = cases().join("furnace-temperature.toml");
    let staggered = ("heat.motion", "quasi-static");
    let (implicit, step) = (("heat.scheme", "implicit"), ("heat.step", "60.0"));
    variants.extend([
        (furnace.clone(), vec![implicit, step]),
        (furnace.clone(), vec![("time.step", "1e-3")]),
        (furnace.clone(), vec![staggered]),
        (furnace.clone(), vec![staggered, implicit, step]),
        (furnace, vec![staggered, ("time.end", "1.0")]),
    ]);
    for (path, overrides) in variants {
        let named = format!("{} {overrides:?}", path.display());
        let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let loaded = load(&path, &overrides).unwrap_or_else(|problems| panic!("{named}: {problems}"));
        let ran = loaded.build().unwrap_or_else(|problems| panic!("{named}: {problems}"));
        let kept = loaded.kept(&ran).unwrap();
        let again = tdem_case::parse("kept", &kept, Path::new("/nowhere"), &[]);
        let again = again.and_then(|again| again.build()).unwrap_or_else(|problems| panic!("{named}: {problems}"));
        assert_eq!(again.plan, ran.plan, "{named}");
        assert_eq!((again.schedule, again.fields), (ran.schedule, ran.fields), "{named}");
        assert_eq!(again.state.hash(), ran.state.hash(), "{named}");
        let problems = |built: &Built| built.warnings.problems.iter().map(|found| found.code).collect::<Vec<_>>();
        assert_eq!(problems(&again), problems(&ran), "{named}");
    }
}
