//! What only a case file says: masses that are scaled, open sides of a lattice, softened materials. The scenes are built from
//! cases.

use super::{ROOM, SOLID};
use crate::verify::Kind;
use crate::verify::bonded::{LATTICE_CONSTANT, RADIUS, SPACING};
use crate::verify::scene::{Bench, GRAVITY, Scene};
use std::f64::consts::PI;
use std::path::Path;
use tdem_engine::Fault;

/// What both cases are made of: SOLID, and bonds as stiff as [`STIFFNESS`] over their section.
const MATERIAL: &str = r#"
model = "TBPM"
[domain]
min = [-1.0, -1.0, -1.0]
max = [1.0, 1.0, 1.0]
[material.rock]
density = 2500.0
young_modulus = 1e7
poisson_ratio = 0.25
thermal_conductivity = 1.5
specific_heat = 900.0
thermal_expansion = 0.0
[[interaction]]
between = ["rock", "rock"]
static_friction = 0.5
dynamic_friction = 0.5
normal_damping = 0.0
tangential_damping = 0.0
[[bond]]
between = ["rock", "rock"]
tensile_strength = "unbreakable"
shear_strength = "unbreakable"
micro = { stiffness_per_area = 7.5e8, stiffness_ratio = 0.4 }
"#;
const DENSITY: f64 = 2500.0;
const STIFFNESS: f64 = 7.5e8;

/// The scene of a case.
fn built(head: &str, tail: &str) -> Result<Scene, Fault> {
    let built = tdem_case::parse("case.toml", &format!("{head}{MATERIAL}{tail}"), Path::new("."), &[])
        .and_then(|loaded| loaded.build())
        .map_err(|_| Fault::Inconsistent { what: "a case of the catalogue can be built" })?;
    Ok(Scene { state: built.state, plan: built.plan })
}

/// Bonds of [`chain`].
const LINKS: usize = 5;

/// A chain that hangs down from its first sphere, which is held.
fn chain(gravity: f64, time: &str, local_damping: f64) -> Result<Scene, Fault> {
    let positions: Vec<String> = (0..=LINKS).map(|k| format!("[0.0, 0.0, {}]", -SPACING * k as f64)).collect();
    let head = format!("gravity = [0.0, 0.0, {:?}]", -gravity);
    let tail = format!(
        r#"
[time]
end = 1.0
{time}
[heat]
initial_temperature = {ROOM}
scale = "kelvin"
contacts = "closed"
bar_radius = 1.0
[bonds]
local_damping = {local_damping:?}
[[particles]]
material = "rock"
list = {{ radius = {RADIUS:?}, positions = [{}] }}
[[zone]]
ball = {{ center = [0.0, 0.0, 0.0], radius = 0.001 }}
fixed = ["x", "y", "z", "rx", "ry", "rz"]
"#,
        positions.join(", ")
    );
    built(&head, &tail)
}

pub(super) fn mass_scaling(bench: &mut Bench) -> Result<(), Fault> {
    // Of the true masses, and of a bond.
    let mass = DENSITY * 4.0 / 3.0 * PI * RADIUS * RADIUS * RADIUS;
    let stiffness = STIFFNESS * PI * RADIUS * RADIUS;
    let unit_of_time = (mass / stiffness).sqrt();
    let step = 0.3 * unit_of_time;
    let mut auto = Vec::new();
    for scaling in [1.0, 25.0] {
        let scaled = format!("mass_scaling = {scaling:?}");
        let root = f64::sqrt(scaling);
        auto.push(chain(GRAVITY, &format!("step = \"auto\"\n{scaled}"), 0.0)?.plan.dt);

        // At rest under its weight, in as many steps that are longer by the root.
        let mut hanging = chain(GRAVITY, &format!("step = {:e}\n{scaled}", root * step), 0.7)?;
        let end = bench.after(&hanging, 3000)?;
        let weights = (LINKS * (LINKS + 1) / 2) as f64;
        let sunk = -SPACING * LINKS as f64 - end.position[LINKS][2];
        let expected = Kind::ClosedForm.relative(weights * mass * GRAVITY / stiffness, 1e-6);
        bench.judge(format!("masses times {scaling}: the end hangs lower by"), "m", sunk, expected);

        // Along its slowest mode, in steps that are the same for both.
        let mut swinging = chain(0.0, &format!("step = {step:e}\n{scaled}"), 0.0)?;
        let (amplitude, phase, steps) = (1e-4 * SPACING, PI / (2 * LINKS + 1) as f64, 999);
        let shape = |k: usize| libm::sin(phase * k as f64);
        (0..=LINKS).for_each(|k| swinging.state.position[k][2] -= amplitude * shape(k));
        let end = bench.after(&swinging, steps)?;
        let way = |k: usize| -SPACING * k as f64 - end.position[k][2];
        let found = (0..=LINKS).map(|k| way(k) * shape(k)).sum::<f64>() / amplitude;
        let of_start = found / (0..=LINKS).map(|k| shape(k) * shape(k)).sum::<f64>();
        // The leapfrog's turn in a step, of masses that are so many times as large.
        let turn = 2.0 * libm::asin(step / unit_of_time / root * libm::sin(0.5 * phase));
        let expected = Kind::ClosedForm.within(libm::cos(steps as f64 * turn), 1e-8);
        bench.judge(format!("masses times {scaling}: amplitude after {steps} steps"), "1", of_start, expected);

        // Heat goes from the first sphere to the others as if nothing were scaled.
        let (conductance, capacity) = (SOLID.conductivity * PI * RADIUS * RADIUS / SPACING, mass * SOLID.specific_heat);
        let part = 0.2;
        hanging.heat_step(part * capacity / conductance);
        hanging.state.temperature[0] = ROOM + 100.0;
        let state = bench.after(&hanging, 30)?;
        let mut warmth = [0.0; LINKS + 1];
        warmth[0] = 100.0;
        for _ in 0..30 {
            let flow: Vec<f64> = warmth.windows(2).map(|two| part * (two[0] - two[1])).collect();
            flow.iter().enumerate().for_each(|(k, flow)| {
                warmth[k] -= flow;
                warmth[k + 1] += flow;
            });
        }
        let off = (0..=LINKS).map(|k| (state.temperature[k] - ROOM - warmth[k]).abs()).fold(0.0, f64::max);
        let expected = Kind::ClosedForm.at_most(1e-9);
        bench.judge(format!("masses times {scaling}: largest error of a temperature"), "K", off, expected);
    }
    bench.judge("step chosen with masses times 25, over that of true ones", "1", auto[1] / auto[0], {
        Kind::ClosedForm.relative(5.0, 1e-12)
    });
    Ok(())
}

/// Heat through a block between its lowest and its highest layer, whose temperatures are held, over that through as much of
/// the solid.
fn through_block(bench: &mut Bench, cells: [usize; 3], open_sides: &str) -> Result<f64, Fault> {
    let (last, difference) = (2 * cells[2] - 1, 100.0);
    let tail = format!(
        r#"
[time]
end = 1.0
step = 1e-6
[heat]
initial_temperature = {ROOM}
scale = "kelvin"
contacts = "closed"
bar_radius = "fcc"
open_sides = {open_sides}
[[particles]]
name = "block"
material = "rock"
fixed = ["x", "y", "z", "rx", "ry", "rz"]
lattice = {{ kind = "fcc", radius = {RADIUS:?}, cells = {cells:?}, origin = [0.0, 0.0, 0.0] }}
[[surface]]
face = "-z"
depth = 0.0
temperature = {:?}
[[surface]]
face = "+z"
depth = 0.0
temperature = {ROOM:?}
"#,
        ROOM + difference
    );
    let mut scene = built("gravity = [0.0, 0.0, 0.0]", &tail)?;
    // C/H of a particle with twelve bonds is C/(3 lambda a), and no bond conducts more than 3/2 times as much.
    scene.heat_step(0.6 * scene.capacity(0) / (3.0 * SOLID.conductivity * LATTICE_CONSTANT));
    let state = bench.after(&scene, 900)?;
    let half = 0.5 * LATTICE_CONSTANT;
    let highest = (0..state.len()).filter(|&k| state.position[k][2] > (last as f64 - 0.5) * half);
    let rate: f64 = highest.map(|k| state.heat_rate[k]).sum();
    let area = (cells[0] * cells[1]) as f64 * LATTICE_CONSTANT * LATTICE_CONSTANT;
    Ok(rate * last as f64 * half / (area * difference * SOLID.conductivity))
}

pub(super) fn open_sides(bench: &mut Bench) -> Result<(), Fault> {
    let cells = [3, 2, 3];
    // Every particle has as many bonds ahead as behind, so that temperatures lie on a line, whatever bonds conduct.
    let by_cells = through_block(bench, cells, "[3, 2]")?;
    bench.judge("thicker bars: heat over lambda A/L dT", "1", by_cells, Kind::ClosedForm.relative(1.0, 1e-9));
    // Of 8 nx ny bonds between two layers, 2 nx + 2 ny are missing, and 4 nx + 4 ny - 4 count half as much again.
    let by_sides = through_block(bench, cells, r#"["-x", "+x", "-y", "+y"]"#)?;
    let expected = 1.0 - 1.0 / (4 * cells[0] * cells[1]) as f64;
    bench.judge(
        "bonds within sides: heat over lambda A/L dT",
        "1",
        by_sides,
        Kind::ClosedForm.relative(expected, 1e-9),
    );
    Ok(())
}

/// Two spheres, the first on a floor, where each contact bears [`LOAD`]: of glass, or of glass softened by a
/// factor that its case states or conceals.
fn pressed(softening: f64, stated: bool, table: bool) -> Result<Scene, Fault> {
    let modulus = GLASS / softening;
    // F = 4/3 E* sqrt(R*) h^(3/2), with the same material on both sides.
    let modulus_eff = modulus / (2.0 * (1.0 - 0.25 * 0.25));
    let overlap = |radius_eff: f64| libm::pow(0.75 * LOAD / (modulus_eff * radius_eff.sqrt()), 2.0 / 3.0);
    let low = RADIUS - overlap(RADIUS);
    let high = low + 2.0 * RADIUS - overlap(0.5 * RADIUS);
    let original = if stated { format!("original_young_modulus = {GLASS:?}") } else { String::new() };
    let conductivity = if table { "[[200.0, 1.5], [400.0, 1.5]]" } else { "1.5" };
    let text = format!(
        r#"
model = "GN"
gravity = [0.0, 0.0, 0.0]
domain = {{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 1.0] }}
time = {{ end = 1.0, step = 1e-7 }}
[material.glass]
density = 2500.0
young_modulus = {modulus:?}
{original}
poisson_ratio = 0.25
thermal_conductivity = {conductivity}
specific_heat = 900.0
thermal_expansion = 0.0
[[interaction]]
between = ["glass", "glass"]
normal_damping = 0.0
[heat]
initial_temperature = 300.0
scale = "kelvin"
contacts = "circle"
bar_radius = 1.0
[[wall]]
name = "floor"
point = [0.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
material = "glass"
temperature = 400.0
[[particles]]
material = "glass"
allow_overlap = true
list = {{ radius = {RADIUS:?}, positions = [[0.0, 0.0, {low:?}], [0.0, 0.0, {high:?}]] }}
"#
    );
    let built = tdem_case::parse("case.toml", &text, Path::new("."), &[])
        .and_then(|loaded| loaded.build())
        .map_err(|_| Fault::Inconsistent { what: "a case of the catalogue can be built" })?;
    let mut scene = Scene { state: built.state, plan: built.plan };
    scene.state.temperature[1] = 250.0;
    Ok(scene)
}

/// Load of each contact of [`pressed`], N.
const LOAD: f64 = 1e-3;
/// Young's modulus, Pa.
const GLASS: f64 = 6e10;

pub(super) fn softened(bench: &mut Bench) -> Result<(), Fault> {
    let glass = bench.after(&pressed(1.0, false, false)?, 0)?;
    for (softening, table) in [(1e3, false), (1e3, true), (30.0, false)] {
        let soft = bench.after(&pressed(softening, true, table)?, 0)?;
        let what = |what: &str| {
            let how = if table { ", conductivity over temperature" } else { "" };
            format!("{softening:?} times softer{how}: {what}")
        };
        bench.judge(what("load"), "N", soft.force[1][2], Kind::ClosedForm.relative(LOAD, 1e-9));
        let [rate, expected] = [&soft, &glass].map(|state| state.heat_rate[1]);
        bench.judge(what("from sphere to sphere"), "W", rate, Kind::ClosedForm.relative(expected, 1e-9));
        let [rate, expected] = [&soft, &glass].map(|state| state.heat_rate[0] + state.heat_rate[1]);
        bench.judge(what("from the floor"), "W", rate, Kind::ClosedForm.relative(expected, 1e-9));
    }
    // a = (3 F R*/(4 E*))^(1/3), by itself.
    let radius = libm::cbrt(0.75 * LOAD * 0.5 * RADIUS / (GLASS / (2.0 * (1.0 - 0.25 * 0.25))));
    let expected = 2.0 * 1.5 * radius * (glass.temperature[0] - glass.temperature[1]);
    bench.judge("glass: from sphere to sphere", "W", glass.heat_rate[1], Kind::ClosedForm.relative(expected, 1e-9));
    let concealed = bench.after(&pressed(1e3, false, false)?, 0)?;
    let ratio = concealed.heat_rate[1] / glass.heat_rate[1];
    bench.judge("1000 times softer and not stated", "1", ratio, Kind::ClosedForm.relative(10.0, 1e-9));
    Ok(())
}
