//! The reinforced prism of `cases/tension.toml`: its initial stiffness.

use super::scene::{Bench, Scene};
use super::statics::{at_rest, rest};
use super::{Case, Kind, Tier};
use crate::statics::Boundary;
use std::path::Path;
use tdem_engine::Fault;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "prism/stiffness-by-area",
        tier: Tier::Quick,
        source: "(E_c A_c + E_s A_s)/H with the areas that are there, 1 - 1/(2 n) of it for the open sides; another program: 0.946, with the bar alone pulled 0.29 to 0.31",
        about: "The prism of cases/tension.toml with a smooth bar, all its end pulled, and the bar alone: static solution, and what the engine leaves unbalanced.",
        body: |bench| by_area(bench, 11, 20, 0.946),
    },
    Case {
        name: "prism/initial-stiffness-6",
        tier: Tier::Quick,
        source: "static solution of the same assembly",
        about: "The prism of cases/tension.toml with 6 x 11 x 6 cells is pulled by its bar in the engine and comes to rest: stiffness.",
        body: |bench| initial(bench, 6, 11, 800),
    },
    Case {
        name: "prism/stiffness-by-area-16",
        tier: Tier::Full,
        source: "(E_c A_c + E_s A_s)/H with the areas that are there, 1 - 1/(2 n) of it for the open sides; another program: 0.972",
        about: "The same with 16 x 29 x 16 cells.",
        body: |bench| by_area(bench, 16, 29, 0.972),
    },
    Case {
        name: "prism/initial-stiffness",
        tier: Tier::Full,
        source: "static solution of the same assembly",
        about: "The prism of cases/tension.toml as it is, 9,680 particles, is pulled by its bar and comes to rest: stiffness.",
        body: |bench| initial(bench, 11, 20, 2000),
    },
];

const FILE: &str = include_str!("../../cases/tension.toml");
/// Side of the quarter of the section, m.
const SIDE: f64 = 0.075;
const CONCRETE: f64 = 30e9;
const STEEL: f64 = 200e9;
/// Small enough to be linear and to break nothing, m.
const PULL: f64 = 1e-9;

/// A prism, and what is pulled.
struct Prism {
    scene: Scene,
    /// Lattice constant, m.
    constant: f64,
    /// The end of the bar.
    bar: Vec<usize>,
    /// The whole end.
    end: Vec<usize>,
    /// Part of the particles that is steel.
    steel: f64,
}

impl Prism {
    /// The case file with so many cells across and along, and layers in the grip; nothing moves yet.
    fn of(across: usize, along: usize, layers: usize, changes: &[(&str, &str)]) -> Result<Self, Fault> {
        let constant = SIDE / across as f64;
        let grip = ((2 * along - layers) as f64 - 0.5) * 0.5 * constant;
        let sizes = [
            ("particles.0.lattice.radius", format!("{:.12}", constant / 8.0_f64.sqrt())),
            ("particles.0.lattice.cells", format!("[{across}, {along}, {across}]")),
            ("zone.1.box.min", format!("[-0.01, {grip:.9}, -0.01]")),
        ];
        let changes = changes.iter().map(|&(key, value)| (key.to_owned(), value.to_owned()));
        let overrides: Vec<(String, String)> =
            sizes.into_iter().map(|(key, value)| (key.to_owned(), value)).chain(changes).collect();
        let built = tdem_case::parse("tension.toml", FILE, Path::new("."), &overrides)
            .and_then(|loaded| loaded.build())
            .map_err(|_| Fault::Inconsistent { what: "cases/tension.toml can be built in other sizes" })?;
        let mut scene = Scene { state: built.state, plan: built.plan };
        let all = 0..scene.state.len();
        // Stiffer bonds are those of steel.
        let stiff = |k: usize| {
            let material = scene.state.material[k];
            scene.plan.joint(material, material).map_or(0.0, |joint| joint.stiffness_per_area)
        };
        let stiffest = all.clone().map(stiff).fold(0.0, f64::max);
        let steel = all.clone().filter(|&k| stiff(k) == stiffest).count() as f64 / all.len() as f64;
        let pulled = |k: &usize| scene.plan.ramps.iter().any(|ramp| ramp.constraint == scene.state.constraint[*k]);
        let bar: Vec<usize> = all.clone().filter(pulled).collect();
        let end = all.filter(|&k| scene.state.position[k][1] > grip).collect();
        scene.plan.ramps.clear();
        scene.pull(&bar, 0.0);
        // Nothing shall break at the start.
        for joint in scene.plan.bonds.iter_mut().flat_map(|bonds| bonds.joints.iter_mut().flatten()) {
            joint.cement.tensile_strength = f64::INFINITY;
            joint.cement.shear_strength = f64::INFINITY;
        }
        Ok(Prism { scene, constant, bar, end, steel })
    }

    /// What the constraints of the case hold, with particles moved along y.
    fn pulled(&self, particles: &[usize]) -> Boundary {
        let mut boundary = Boundary::of_plan(&self.scene.state, &self.scene.plan, 0.0);
        for &k in particles {
            boundary.held[k][1] = Some(PULL);
        }
        boundary
    }

    /// Force along y over the way of particles in static equilibrium, N/m, and what the engine leaves unbalanced.
    fn stiffness(&self, bench: &mut Bench, pulled: &[usize]) -> Result<[f64; 2], Fault> {
        let boundary = self.pulled(pulled);
        let solution = rest(&self.scene, &boundary)?;
        let force: f64 = pulled.iter().map(|&k| solution.reaction[k][1]).sum();
        let (_, unbalanced) = at_rest(bench, &self.scene, &boundary, &solution)?;
        Ok([force / PULL, unbalanced])
    }
}

impl Scene {
    /// Prescribes the rate along y of particles whose constraints are theirs alone, m/s.
    fn pull(&mut self, particles: &[usize], rate: f64) {
        for &k in particles {
            self.plan.constraints[usize::from(self.state.constraint[k])].velocity[1] = Some(rate);
            self.state.velocity[k][1] = rate;
        }
    }
}

fn by_area(bench: &mut Bench, across: usize, along: usize, golden: f64) -> Result<(), Fault> {
    let prism = Prism::of(across, along, 1, &[("zone.0.ribbed_bar.rib_height", "1e-6")])?;
    let length = along as f64 * prism.constant;
    let formula = (CONCRETE + (STEEL - CONCRETE) * prism.steel) * SIDE * SIDE / length;
    let still = Kind::Reference.at_most(1e-4);
    let [stiffness, unbalanced] = prism.stiffness(bench, &prism.end)?;
    let open = 1.0 - 0.5 / across as f64;
    let what = "all of the end pulled: stiffness over that of the areas";
    bench.judge(what, "1", stiffness / formula, Kind::Reference.relative(golden, 0.03));
    bench.judge(
        format!("{what}, less the open sides"),
        "1",
        stiffness / formula / open,
        Kind::ClosedForm.within(1.0, 0.03),
    );
    bench.judge("all of the end pulled: unbalanced in the engine, of the largest reaction", "1", unbalanced, still);
    let [stiffness, unbalanced] = prism.stiffness(bench, &prism.bar)?;
    let what = "the bar pulled: stiffness over that of the areas";
    bench.judge(what, "1", stiffness / formula, Kind::Reference.within(0.3, 0.015));
    bench.judge("the bar pulled: unbalanced in the engine, of the largest reaction", "1", unbalanced, still);
    Ok(())
}

/// Steps in which the bar is moved before it is held.
const MOVING: u64 = 100;

fn initial(bench: &mut Bench, across: usize, along: usize, steps: u64) -> Result<(), Fault> {
    let prism = Prism::of(across, along, 2, &[])?;
    let [expected, unbalanced] = prism.stiffness(bench, &prism.bar)?;
    let what = "static solution: unbalanced in the engine, of the largest reaction";
    bench.judge(what, "1", unbalanced, Kind::Reference.at_most(1e-4));
    let Prism { mut scene, bar, .. } = prism;
    scene.damp_locally(0.7);
    scene.pull(&bar, PULL / (MOVING as f64 * scene.plan.dt));
    scene.state = bench.after(&scene, MOVING)?;
    scene.pull(&bar, 0.0);
    let state = bench.after(&scene, steps)?;
    let stiffness = bar.iter().map(|&k| -state.force[k][1]).sum::<f64>() / PULL;
    bench.judge("force over way of the bar", "N/m", stiffness, Kind::Reference.relative(expected, 0.01));
    let broken = state.bonds.iter().filter(|bond| !bond.holds()).count();
    bench.judge("broken bonds", "1", broken as f64, Kind::Reference.within(0.0, 0.0));
    Ok(())
}
