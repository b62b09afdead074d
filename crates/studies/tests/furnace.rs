//! What `cases/furnace-temperature.toml` is drawn against.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use tdem_case::load;
use tdem_engine::{Course, Reading, Simulation, cpu};
use tdem_studies::slab::{Heating, Slab};

/// Rows a quarter of an hour apart, and the end.
const STEP: f64 = 900.0;
const END: f64 = 20_280.0;

fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases")
}

fn times() -> impl Iterator<Item = f64> {
    (0..).map(|k| f64::from(k) * STEP).take_while(|&time| time < END).chain([END])
}

/// Temperature of the bottom of the slab, °C.
fn exact(time: f64) -> f64 {
    let slab = Slab { thickness: 0.2, diffusivity: 1.5 / (2250.0 * 900.0), conductivity: 1.5, film_coefficient: 10.0 };
    let top = Course(vec![[0.0, 20.0], [10_560.0, 900.0], [12_360.0, 900.0], [END, 20.0]]);
    slab.temperature(&Heating { initial: 20.0, surroundings: 20.0, top }, slab.thickness, time)
}

/// Temperature of the bottom of the block as the case computes it, °C, at the times of the rows.
fn computed(overrides: &[(&str, &str)]) -> Vec<f64> {
    let overrides: Vec<(String, String)> =
        overrides.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
    let loaded = load(&cases().join("furnace-temperature.toml"), &overrides).expect("the case is right");
    let built = loaded.build().expect("the case can be built");
    let bottom = built.plan.gauges.iter().find(|gauge| gauge.name == "bottom").cloned().expect("the bottom is watched");
    let plan = built.plan.clone();
    let mut simulation = Simulation::new(built.state, built.plan, cpu::Options::default()).expect("the case starts");
    let temperature = |simulation: &mut Simulation| {
        let state = simulation.state().expect("a state can be taken");
        let Reading::Surface { temperature, .. } = bottom.read(&state, &plan) else { panic!("a surface is watched") };
        temperature - 273.15
    };
    let mut rows = Vec::new();
    for time in times() {
        // Straight between the steps before and after.
        let steps = (time / plan.dt).floor() as u64 - simulation.step();
        simulation.advance(steps).expect("the case runs through");
        let before = (simulation.time(), temperature(&mut simulation));
        simulation.advance(1).expect("the case runs through");
        let after = (simulation.time(), temperature(&mut simulation));
        rows.push(before.1 + (after.1 - before.1) * (time - before.0) / (after.0 - before.0));
    }
    rows
}

#[test]
fn the_exact_column_is_exact() {
    let text = std::fs::read_to_string(cases().join("furnace-temperature.csv")).expect("the table is there");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    assert_eq!(rows.len(), times().count());
    for (row, time) in rows.iter().zip(times()) {
        assert!((row[0] - time / 3600.0).abs() < 1e-4, "{row:?}");
        assert!((row[1] - exact(time)).abs() < 1e-3, "{row:?} {}", exact(time));
    }
}

/// The block has far fewer cells here than in the case: errors fall with their square.
#[test]
fn a_coarse_block_follows_the_slab() {
    let (cells, constant) = (10, 0.02);
    let radius = constant / (2.0 * std::f64::consts::SQRT_2);
    let lattice = format!(
        "{{ kind = \"fcc\", radius = {radius}, cells = [{cells}, {cells}, {cells}], origin = [0.005, 0.005, 0.005] }}"
    );
    let coarse = computed(&[("particles.0.lattice", &lattice), ("heat.open_sides", "[10, 10]")]);
    let error = coarse.iter().zip(times()).map(|(found, time)| (found - exact(time)).abs()).fold(0.0, f64::max);
    assert!(error < 0.4, "{error} K");
}

#[test]
#[ignore = "takes a minute; writes cases/furnace-temperature.csv anew"]
fn write_the_table() {
    let plain = computed(&[("surface.0.depth", "0.0"), ("surface.1.depth", "0.0")]);
    let fine = computed(&[]);
    let largest = fine.iter().zip(times()).map(|(found, time)| (found - exact(time)).abs()).fold(0.0, f64::max);
    let mut text = String::from(
        "# Temperature of the bottom of the block of furnace-temperature.toml, degrees Celsius: the exact solution of a slab\n\
         # (crates/studies/src/slab.rs), and the block with surfaces that have the temperature of their particles. Written by\n\
         # crates/studies/tests/furnace.rs.\nhours,exact,without_depth\n",
    );
    for (time, plain) in times().zip(plain) {
        writeln!(text, "{:.6},{:.4},{plain:.4}", time / 3600.0, exact(time)).expect("text can be written");
    }
    std::fs::write(cases().join("furnace-temperature.csv"), text).expect("the table can be written");
    assert!(largest < 0.04, "the block of the case is {largest} K off");
}
