//! A case of quasi-static heat with a table of each kind, from its file to its results: conductivity, specific heat, stiffness
//! and strength over temperature.

use std::path::Path;
use tdem_engine::{Simulation, State, cpu};
use tdem_results::session::run;
use tdem_results::{Control, Note, Observer, Outcome, Progress, RunDirectory, load_final_state};

/// A bar is held at its ends, and the ends are cooled to 160 and 80 °C, so slowly that nothing cracks by the haste: it is pulled
/// by its own contraction. The strength is half again what the mean contraction asks for, or two thirds of it, where bonds
/// are cold.
const BAR: &str = r#"
model = "TBPM"
gravity = [0.0, 0.0, 0.0]
[time]
step = "auto"
end = 10000.0
[domain]
min = [-0.1, -0.1, -0.1]
max = [0.1, 0.1, 0.1]
[material.concrete]
density = 3241.0
young_modulus = 30e9
poisson_ratio = 0.2
thermal_conductivity = [[0.0, 2.0], [400.0, 1.0]]
specific_heat = [[0.0, 800.0], [150.0, 1100.0], [400.0, 1000.0]]
thermal_expansion = 1e-5
[[interaction]]
between = ["concrete", "concrete"]
static_friction = 0.6
dynamic_friction = 0.6
normal_damping = 1500.0
tangential_damping = 150.0
[heat]
scale = "celsius"
initial_temperature = 220.0
contacts = "closed"
bar_radius = "fcc"
motion = "quasi-static"
step = 500.0
relaxation = { at_most_steps = 4000 }
[bonds]
local_damping = 0.7
[[bond]]
between = ["concrete", "concrete"]
damping_ratio = 0.05
moment_contribution = 0.0
stiffness_over_temperature = [[0.0, 1.2], [400.0, 0.8]]
strength_over_temperature = STRENGTH
lattice = { young_modulus = 30e9, poisson_ratio = 0.2, tensile_strength = 30e6, shear_factor = 3.0 }
[[particles]]
name = "bar"
material = "concrete"
lattice = { kind = "fcc", radius = 0.0024, cells = [3, 3, 5], origin = [0.0, 0.0, 0.0] }
[[zone]]
name = "foot"
box = { min = [-1.0, -1.0, -0.001], max = [1.0, 1.0, 0.001] }
fixed = ["z"]
[[zone]]
name = "grip"
box = { min = [-1.0, -1.0, 0.0305], max = [1.0, 1.0, 0.031] }
fixed = ["z"]
[[surface]]
face = "-z"
depth = 0.0
temperature = [[0.0, 220.0], [5000.0, 160.0]]
[[surface]]
face = "+z"
depth = 0.0
temperature = [[0.0, 220.0], [5000.0, 80.0]]
[[gauge]]
name = "grip"
of = "grip"
[output]
frames = 1
"#;
/// Lattice constant, m.
const CELL: f64 = 0.0024 * 2.0 * std::f64::consts::SQRT_2;
const ACROSS: usize = 3;
const LAYERS: usize = 10;
const CELSIUS: f64 = 273.15;
/// Stress of a lattice with open sides of 3 x 3 x 3 cells over that of the solid, by the static solution in
/// crates/studies/reference/bonded.py.
const OPEN: f64 = 0.826_802;

struct Deaf;

impl Observer for Deaf {
    fn progress(&mut self, _: &Progress) -> Control {
        Control::Continue
    }
    fn note(&mut self, _: &Note) {}
}

/// Runs the case; its last state, and the last row of its history by names.
fn bar(strength: &str) -> (State, impl Fn(&str) -> f64) {
    let text = BAR.replace("STRENGTH", strength);
    let loaded =
        tdem_case::parse("bar.toml", &text, Path::new("."), &[]).unwrap_or_else(|problems| panic!("{problems}"));
    let built = loaded.build().unwrap_or_else(|problems| panic!("{problems}"));
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    let mut directory = RunDirectory::create(folder.path(), &text, false).expect("the folder is empty");
    let simulation =
        Simulation::new(built.state, built.plan, cpu::Options { threads: Some(1), ..cpu::Options::default() });
    let ended = run(simulation.expect("the case starts"), &mut directory, &built.schedule, &mut Deaf);
    assert!(matches!(ended, Ok(Outcome::Finished { step: 20 })), "{ended:?}");
    let state = load_final_state(folder.path()).expect("there is a checkpoint").state;
    let history = std::fs::read_to_string(folder.path().join("history.csv")).expect("there is a history");
    let mut lines = history.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let (names, last) = (lines.next().expect("it has a head"), lines.next_back().expect("it has rows"));
    let column = move |name: &str| {
        let place = names.iter().position(|of| of == name).unwrap_or_else(|| panic!("no column {name} in {names:?}"));
        last[place].parse().expect("a number")
    };
    (state, column)
}

/// A table, straight between its points, and its integral from its first point on.
fn straight(table: &[[f64; 2]], at: f64) -> [f64; 2] {
    let mut integral = 0.0;
    for two in table.windows(2) {
        let ([from, first], [to, last]) = (two[0], two[1]);
        let value = first + (last - first) * (at - from) / (to - from);
        if at <= to {
            return [value, integral + 0.5 * (first + value) * (at - from)];
        }
        integral += 0.5 * (first + last) * (to - from);
    }
    panic!("{at} °C is beyond the table");
}

/// Temperatures of the layers, °C.
fn layers(state: &State) -> Vec<f64> {
    let mut sums = [[0.0; 2]; LAYERS];
    for (place, temperature) in state.position.iter().zip(&state.temperature) {
        let layer = libm::round(place[2] / (0.5 * CELL)) as usize;
        sums[layer][0] += temperature - CELSIUS;
        sums[layer][1] += 1.0;
    }
    sums.iter().map(|[sum, count]| sum / count).collect()
}

#[test]
fn a_bar_with_four_tables_is_cooled_between_grips() {
    let (state, column) = bar("[[0.0, 1.5], [400.0, 1.5]]");
    let temperatures = layers(&state);

    // Kirchhoff: at rest the integral of the conductivity is straight.
    let conducted = |temperature: f64| straight(&[[0.0, 2.0], [400.0, 1.0]], temperature)[1];
    let [hot, cold] = [160.0, 80.0].map(conducted);
    for (layer, &temperature) in temperatures.iter().enumerate() {
        let line = hot + (cold - hot) * layer as f64 / (LAYERS - 1) as f64;
        let off = (conducted(temperature) - line) / (hot - cold);
        assert!(off.abs() < 1e-5, "layer {layer} has {temperature} °C, {off} from the line");
    }

    // What went out is what the specific heat says of both temperatures.
    let held = |temperature: f64| straight(&[[0.0, 800.0], [150.0, 1100.0], [400.0, 1000.0]], temperature)[1];
    let stored: f64 =
        state.mass.iter().zip(&state.temperature).map(|(m, t)| m * (held(t - CELSIUS) - held(220.0))).sum();
    let balance = column("heat_in") - column("heat_out");
    assert!((balance / stored - 1.0).abs() < 1e-9, "{balance} J of {stored} J");

    // Layers one behind the other bear the same force, each as stiff as it is warm.
    let (mut shortening, mut compliance) = (0.0, 0.0);
    for two in temperatures.windows(2) {
        let mean = 0.5 * (two[0] + two[1]);
        shortening += 1e-5 * (220.0 - mean) * 0.5 * CELL;
        compliance += 0.5 * CELL / (30e9 * straight(&[[0.0, 1.2], [400.0, 0.8]], mean)[0]);
    }
    let side = ACROSS as f64 * CELL;
    let expected = OPEN * side * side * shortening / compliance;
    let force = -column("grip_force_z");
    assert!((force / expected - 1.0).abs() < 0.01, "{force} N in place of {expected} N");
    assert_eq!(state.bonds.iter().filter(|bond| !bond.holds()).count(), 0);
    assert_eq!(column("broken_bonds"), 0.0);
}

#[test]
fn what_is_weak_while_it_is_cold_breaks_there() {
    // Half again as strong as it must be above 125 °C, two thirds of that below 110 °C.
    let (state, column) = bar("[[0.0, 0.65], [110.0, 0.65], [125.0, 1.5], [400.0, 1.5]]");
    let middle = 0.5 * CELL * (LAYERS - 1) as f64 / 2.0;
    let broken = state.bonds.iter().filter(|bond| !bond.holds());
    let heights: Vec<f64> = broken.map(|bond| state.position[bond.first as usize][2]).collect();
    assert!(!heights.is_empty() && heights.iter().all(|&height| height > middle), "{heights:?}");
    // The coldest two layers part: all bonds between them, 8 n^2, less those that open sides lack.
    assert_eq!(heights.len(), 8 * ACROSS * ACROSS - 4 * ACROSS);
    assert_eq!(column("broken_bonds"), heights.len() as f64);
    let force = -column("grip_force_z");
    assert!(force < 100.0, "a crack across bears nothing, but {force} N are left");
}
