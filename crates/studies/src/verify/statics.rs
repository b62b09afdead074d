//! Equilibrium without time, [`crate::statics`], against closed forms, a reference program, and the engine at rest.

use super::block::{LATTICE, lattice};
use super::bonded::{JOINT, LATTICE_CONSTANT, RADIUS, ROCK, SPACING, numbers, scene};
use super::scene::{Bench, Scene};
use super::{Case, Kind, Tier};
use crate::statics::{Assembly, Boundary, Six, Solution};
use tdem_engine::physics::bond::{Form, Joint};
use tdem_engine::{Bond, Fault, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "statics/stiffness",
        tier: Tier::Quick,
        source: "differences of the engine's forces and moments, of second order",
        about: "Three unequal spheres, bonded askew: forces under each of their 18 displacements and rotations.",
        body: stiffness,
    },
    Case {
        name: "statics/chain",
        tier: Tier::Quick,
        source: "discrete chain: n/K_n, n/K_s + l^2 n (4 n^2 - 1)/(12 K_b), n/K_t, n/K_b, l n^2/(2 K_b)",
        about: "The end of a clamped chain of 1, 4 and 40 bonds is loaded along, across, by a couple about its axis and across it.",
        body: chain,
    },
    Case {
        name: "statics/block",
        tier: Tier::Quick,
        source: "static solution of the same block with six unknowns a sphere: crates/studies/reference/bonded.py",
        about: "3 x 3 x 3, 4 x 4 x 6 and 5 x 5 x 8 cells are stretched: modulus from grip to grip, and what the engine leaves unbalanced.",
        body: block,
    },
];

/// Where a scene comes to rest under a boundary.
pub(super) fn rest(scene: &Scene, boundary: &Boundary) -> Result<Solution, Fault> {
    Assembly::of(&scene.state, &scene.plan)
        .and_then(|assembly| assembly.solve(boundary))
        .map_err(|_| Fault::Inconsistent { what: "the assembly is bonded and held" })
}

/// What the engine finds of a solution: the state there, and the largest force or moment (over the radius) that bonds,
/// loads and reactions together leave on a particle, over the largest load or reaction.
pub(super) fn at_rest(
    bench: &mut Bench,
    scene: &Scene,
    boundary: &Boundary,
    solution: &Solution,
) -> Result<(State, f64), Fault> {
    let moved = Scene { state: solution.applied_to(&scene.state), plan: scene.plan.clone() };
    let state = bench.after(&moved, 0)?;
    let (mut unbalanced, mut largest) = (0.0_f64, 0.0_f64);
    for k in 0..state.len() {
        let found = six(&state, k);
        for d in 0..6 {
            let force = if d < 3 { 1.0 } else { 1.0 / state.radius[k] };
            let load = boundary.loads[k][d];
            largest = largest.max(force * solution.reaction[k][d].abs()).max(force * load.abs());
            unbalanced = unbalanced.max(force * (found[d] + load + solution.reaction[k][d]).abs());
        }
    }
    Ok((state, unbalanced / largest))
}

/// Force and moment on a particle.
fn six(state: &State, k: usize) -> Six {
    let ([x, y, z], [a, b, c]) = (state.force[k], state.moment[k]);
    [x, y, z, a, b, c]
}

fn stiffness(bench: &mut Bench) -> Result<(), Fault> {
    let joint = Joint { stiffness_per_area: 3e8, young_modulus: 6e6, ..JOINT };
    let mut scene = scene(Form::Total, joint, 0.3);
    scene.plan.interactions.iter_mut().for_each(|i| i.normal_stiffness = 0.0);
    let places = [[0.0; 3], [1.6, 0.9, -0.7], [0.4, 2.1, 1.2]];
    for (place, radius) in places.into_iter().zip([RADIUS, 1.4 * RADIUS, 0.8 * RADIUS]) {
        scene.sphere(radius, ROCK.density, place.map(|c| c * RADIUS));
    }
    scene.state.make_bonds(vec![Bond::new(0, 1, 1.0), Bond::new(0, 2, 1.0), Bond::new(1, 2, 1.0)]);
    let assembly =
        Assembly::of(&scene.state, &scene.plan).map_err(|_| Fault::Inconsistent { what: "the spheres are bonded" })?;
    let (mut off, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
    for (particle, component) in (0..3).flat_map(|k| (0..6).map(move |c| (k, c))) {
        let size = if component < 3 { 1e-4 * RADIUS } else { 1e-4 };
        let mut way = vec![[0.0; 6]; 3];
        way[particle][component] = size;
        let expected = assembly.forces(&way);
        let mut engine = |sign: f64| {
            let displacement = way.iter().map(|six| six.map(|c| sign * c)).collect();
            let moved = Solution { displacement, reaction: Vec::new(), iterations: 0 };
            bench.after(&Scene { state: moved.applied_to(&scene.state), plan: scene.plan.clone() }, 0)
        };
        let (ahead, behind) = (engine(1.0)?, engine(-1.0)?);
        for k in 0..3 {
            let (ahead, behind) = (six(&ahead, k), six(&behind, k));
            for d in 0..6 {
                let found = 0.5 * (ahead[d] - behind[d]);
                off[d / 3] = off[d / 3].max((found - expected[k][d]).abs());
                largest[d / 3] = largest[d / 3].max(expected[k][d].abs());
            }
        }
    }
    let what = ["forces", "moments"];
    for d in 0..2 {
        let what = format!("{}: largest difference over the largest", what[d]);
        bench.judge(what, "1", off[d] / largest[d], Kind::Reference.at_most(1e-6));
    }
    Ok(())
}

fn chain(bench: &mut Bench) -> Result<(), Fault> {
    let stiffness = numbers(&JOINT).stiffness;
    for links in [1_usize, 4, 40] {
        let n = links as f64;
        let bent = SPACING * SPACING * n * (4.0 * n * n - 1.0) / (12.0 * stiffness.bending);
        let curved = 0.5 * SPACING * n * n / stiffness.bending;
        // Loaded component, and what a unit of load moves.
        let loads = [
            ("pulled", 0, vec![(0, n / stiffness.normal)]),
            ("loaded across", 1, vec![(1, bent + n / stiffness.shear), (5, curved)]),
            ("twisted", 3, vec![(3, n / stiffness.torsion)]),
            ("bent", 5, vec![(1, curved), (5, n / stiffness.bending)]),
        ];
        for (what, component, expected) in loads {
            let mut scene = scene(Form::Total, JOINT, 0.3);
            scene.chain(links);
            let mut boundary = Boundary::free(links + 1);
            boundary.held[0] = [Some(0.0); 6];
            // So small that the engine finds it linear.
            let load = 1e-7 * if component < 3 { SPACING } else { 1.0 } / expected.last().map_or(1.0, |last| last.1);
            boundary.loads[links][component] = load;
            let solution = rest(&scene, &boundary)?;
            for (moved, flexibility) in expected {
                let got = solution.displacement[links][moved] / load;
                let unit = if moved < 3 { "m per unit" } else { "rad per unit" };
                let what = format!("n = {links}, {what}: component {moved} of the end");
                bench.judge(what, unit, got, Kind::ClosedForm.relative(flexibility, 1e-9));
            }
            if links < 40 {
                let (_, unbalanced) = at_rest(bench, &scene, &boundary, &solution)?;
                let what = format!("n = {links}, {what}: unbalanced in the engine, of the load");
                bench.judge(what, "1", unbalanced, Kind::Reference.at_most(1e-5));
            }
        }
    }
    Ok(())
}

fn block(bench: &mut Bench) -> Result<(), Fault> {
    let strain = 1e-7;
    for (cells, expected) in [([3, 3, 3], 0.826_802), ([4, 4, 6], 0.869_424), ([5, 5, 8], 0.895_684)] {
        let mut scene = scene(Form::Total, LATTICE, 0.3);
        let sites = scene.block(cells);
        let top = 2 * cells[2] - 1;
        let length = top as f64 * 0.5 * LATTICE_CONSTANT;
        let mut boundary = Boundary::free(sites.len());
        for (held, site) in boundary.held.iter_mut().zip(&sites) {
            held[2] = [(0, 0.0), (top, strain * length)].iter().find(|grip| grip.0 == site[2]).map(|grip| grip.1);
        }
        let solution = rest(&scene, &boundary)?;
        let section = (cells[0] * cells[1]) as f64 * LATTICE_CONSTANT * LATTICE_CONSTANT;
        let of_top = |k: &usize| sites[*k][2] == top;
        let pull: f64 = (0..sites.len()).filter(of_top).map(|k| solution.reaction[k][2]).sum();
        let what = |what: &str| format!("{} x {} x {} cells: {what}", cells[0], cells[1], cells[2]);
        let modulus = pull / section / strain / lattice().young_modulus();
        bench.judge(what("E from grip to grip over E_100"), "1", modulus, Kind::Reference.within(expected, 1e-6));
        let (state, unbalanced) = at_rest(bench, &scene, &boundary, &solution)?;
        bench.judge(what("unbalanced in the engine, of the pull"), "1", unbalanced, Kind::Reference.at_most(1e-5));
        let engine: f64 = (0..sites.len()).filter(of_top).map(|k| -state.force[k][2]).sum();
        bench.judge(what("the engine's pull over it"), "1", engine / pull, Kind::Reference.within(1.0, 1e-5));
    }
    Ok(())
}
