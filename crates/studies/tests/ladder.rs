//! Rungs of a small block that is heated from above: what differs shrinks with the acceleration.

use std::path::Path;
use tdem_case::schema::Positive;
use tdem_case::{Loaded, NoRuns, parse};
use tdem_engine::{Plan, Simulation, State, cpu};
use tdem_studies::ladder::{Difference, Error, Follower, Ladder, climb, rungs, step_seconds};

/// 108 spheres on a lattice; the lowest layer is held, and the top follows a course.
const BLOCK: &str = r#"
model = "TBPM"
gravity = [0.0, 0.0, 0.0]
[time]
step = "auto"
end = 2e-3
[domain]
min = [-0.05, -0.05, -0.05]
max = [0.15, 0.15, 0.15]
[material.concrete]
density = 3038.57
young_modulus = 23.2e9
poisson_ratio = 0.2
thermal_conductivity = 1.5
specific_heat = 900.0
thermal_expansion = 6.6e-6
[[interaction]]
between = ["concrete", "concrete"]
static_friction = 0.6
dynamic_friction = 0.6
normal_damping = 1500.0
tangential_damping = 150.0
[heat]
scale = "celsius"
initial_temperature = 20.0
contacts = "circle"
bar_radius = "fcc"
duration = 1000.0
[bonds]
local_damping = 0.5
[[bond]]
between = ["concrete", "concrete"]
damping_ratio = 0.05
moment_contribution = 0.0
[bond.lattice]
young_modulus = 23.2e9
poisson_ratio = 0.2
tensile_strength = "unbreakable"
shear_factor = 3.0
[[particles]]
name = "block"
material = "concrete"
lattice = { kind = "fcc", radius = 6.4e-3, cells = [3, 3, 3], origin = [0.0, 0.0, 0.0] }
[[zone]]
name = "foot"
block = { min = [-1.0, -1.0, -0.001], max = [1.0, 1.0, 0.001] }
fixed = ["x", "y", "z"]
[[surface]]
name = "top"
face = "+z"
temperature = [[0.0, 20.0], [500.0, 320.0]]
"#;

fn case(set: &[(&str, &str)]) -> Loaded {
    let set: Vec<(String, String)> = set.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    parse("block.toml", BLOCK, Path::new("."), &set).expect("the case is right")
}

fn start(state: State, plan: Plan) -> Result<Simulation, tdem_engine::Fault> {
    Simulation::new(state, plan, cpu::Options { threads: Some(1), ..cpu::Options::default() })
}

fn ladder(set: &[(&str, &str)], parts: u32) -> Ladder {
    let rungs = rungs(&case(set), 3, &NoRuns).expect("the case has a ladder");
    climb(rungs, parts, start, &mut |_| {}).expect("nothing goes wrong")
}

#[test]
fn probe() {
    for set in [&[][..], &[("bond.0.lattice.tensile_strength", "2e6")]] {
        let l = ladder(set, 6);
        println!("{:?}", l.rungs);
        for p in &l.pairs {
            for d in &p.differences {
                println!("{d:?}");
            }
        }
    }
}
