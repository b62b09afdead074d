//! Blocks of bonded spheres on a face-centred cubic lattice: elasticity, waves, strength, and what motion keeps.

use super::bonded::{CEMENT, FORMS, JOINT, LATTICE_CONSTANT, RADIUS, ROCK, SPACING, numbers, scene};
use super::conservation::{angular_momenta, momenta, size};
use super::scene::{Bench, Scene, With, crossing, random_vector};
use super::{Case, Kind, Tier};
use std::f64::consts::PI;
use tdem_engine::physics::Vec3;
use tdem_engine::physics::bond::face_centred::{CubicElasticity, tensile_stress};
use tdem_engine::physics::bond::{Cement, Form, Joint};
use tdem_engine::physics::stability::GEAR_OSCILLATOR_LIMIT;
use tdem_engine::{Bond, Constraint, Fault, Integrator, Ledger, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "block/elastic-constants",
        tier: Tier::Quick,
        source: "C11 = 2 (K_n + K_s)/a, C12 = (K_n - K_s)/a, C44 = (K_n + K_s)/a; E_100 = 4 K_n/a (1 + 3 kappa)/(3 + kappa)",
        about: "A sphere and its twelve neighbours are strained uniformly: stress by the virial of the forces.",
        body: elastic_constants,
    },
    Case {
        name: "block/bond-forces",
        tier: Tier::Quick,
        source: "under a stress along [100]: F_n = sqrt(2) R^2 S (1 + kappa)/(1 + 3 kappa), F_s = 2 sqrt(2) R^2 S kappa/(1 + 3 kappa)",
        about: "The same strained as by a uniaxial stress: forces of the eight bonds that cross a layer, and of the four in it.",
        body: bond_forces,
    },
    Case {
        name: "block/tension-3",
        tier: Tier::Quick,
        source: "static solution of the same block with six unknowns a sphere: crates/studies/reference/bonded.py",
        about: "3 x 3 x 3 cells are stretched by 1e-7 and come to rest: modulus from grip to grip and within, Poisson's ratio.",
        body: |bench| tension(bench, [3, 3, 3], 800, [0.826_802, 0.829_306, 0.213_862]),
    },
    Case {
        name: "block/plane-wave",
        tier: Tier::Quick,
        source: "w = 4 c/a sin(k a/4), c = sqrt(C11/rho), leapfrog sin(a/2) = w dt / 2",
        about: "A standing wave along [100] in a box that repeats, 6 cells long.",
        body: plane_wave,
    },
    Case {
        name: "block/critical-step",
        tier: Tier::Quick,
        source: "scan of all waves of the lattice with six unknowns a sphere (numpy): 2/w_max = 0.5026 sqrt(m/K_n) at kappa = 1/3",
        about: "A lattice in a box that repeats is disturbed at random, just below and just above the critical step.",
        body: critical_step,
    },
    Case {
        name: "block/critical-step-gear",
        tier: Tier::Quick,
        source: "w_max = sqrt(8 K_n/m) at kappa = 0; Gear's method with 3/16 for one oscillator: bound w dt = 0.312, growth by 8.713e-4 a step at 0.6",
        about: "The same lattice without shear stiffness under Gear's method, at the bound and beyond it.",
        body: critical_step_gear,
    },
    Case {
        name: "block/spinning-and-breaking",
        tier: Tier::Quick,
        source: "Newton's third law, and lever arms that add up to the distance of the centres",
        about: "A free spinning block tears itself apart, its pieces rub against each other: momenta, and the ledger.",
        body: spinning,
    },
    Case {
        name: "block/spinning-gear",
        tier: Tier::Quick,
        source: "Newton's third law; Euler's rule for the spin loses angular momentum at first order",
        about: "A free spinning block under Gear's method, steps halved.",
        body: spinning_gear,
    },
    Case {
        name: "block/tension-4",
        tier: Tier::Full,
        source: "static solution of the same block with six unknowns a sphere: crates/studies/reference/bonded.py",
        about: "The same with 4 x 4 x 6 cells.",
        body: |bench| tension(bench, [4, 4, 6], 2000, [0.869_424, 0.867_827, 0.218_695]),
    },
    Case {
        name: "block/tension-5",
        tier: Tier::Full,
        source: "static solution of the same block with six unknowns a sphere: crates/studies/reference/bonded.py",
        about: "The same with 5 x 5 x 8 cells.",
        body: |bench| tension(bench, [5, 5, 8], 2500, [0.895_684, 0.893_764, 0.215_146]),
    },
    Case {
        name: "block/bar-vibration",
        tier: Tier::Full,
        source: "thin bar: c = sqrt(E/rho), first free mode w = pi c/L; E of the section: crates/studies/reference/bonded.py",
        about: "A free bar of 3 x 3 x 16 cells swings along itself.",
        body: bar_vibration,
    },
    Case {
        name: "block/tensile-strength",
        tier: Tier::Full,
        source: "f_t = sigma_lim pi lambda^2 (1 + 3 kappa)/(sqrt(2) (1 + kappa)), less up to 20 % for grips and open sides",
        about: "4 x 4 x 6 cells whose moments do not count are pulled slowly until they break: greatest stress over the section of its layers.",
        body: tensile_strength,
    },
];

/// Bonds that give the lattice a Poisson's ratio of 0.2, as thick as the spheres: those of the reference.
pub(super) const LATTICE: Joint<f64> =
    Joint { cement: Cement { stiffness_ratio: 1.0 / 3.0, radius_multiplier: 1.0, ..CEMENT }, ..JOINT };

/// Volume of a cell, which holds four spheres, m³.
pub(super) const CELL: f64 = LATTICE_CONSTANT * LATTICE_CONSTANT * LATTICE_CONSTANT;

pub(super) fn lattice() -> CubicElasticity {
    let stiffness = numbers(&LATTICE).stiffness;
    CubicElasticity::of_bonds(stiffness.normal, stiffness.shear, LATTICE_CONSTANT)
}

/// From a sphere to its twelve neighbours, m.
pub(super) fn neighbours() -> Vec<[f64; 3]> {
    let half = 0.5 * LATTICE_CONSTANT;
    let mut offsets = Vec::new();
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        for (first, second) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mut offset = [0.0; 3];
            (offset[a], offset[b]) = (first * half, second * half);
            offsets.push(offset);
        }
    }
    offsets
}

/// A sphere and its twelve neighbours, bonded to it, under a uniform symmetric strain.
pub(super) fn star_scene(strain: [[f64; 3]; 3]) -> Scene {
    let mut scene = scene(Form::Total, LATTICE, 0.3);
    // The twelve touch each other, too.
    scene.plan.interactions.iter_mut().for_each(|i| i.normal_stiffness = 0.0);
    scene.sphere(RADIUS, ROCK.density, [0.0; 3]);
    for offset in neighbours() {
        scene.sphere(RADIUS, ROCK.density, offset);
    }
    scene.state.make_bonds((1..=12).map(|k| Bond::new(0, k, 1.0)).collect());
    for place in &mut scene.state.position {
        let was = *place;
        *place = std::array::from_fn(|i| was[i] + (0..3).map(|j| strain[i][j] * was[j]).sum::<f64>());
    }
    scene
}

/// Forces of its twelve bonds on the sphere in the middle.
fn star(bench: &mut Bench, strain: [[f64; 3]; 3]) -> Result<Vec<[f64; 3]>, Fault> {
    let state = bench.after(&star_scene(strain), 0)?;
    Ok((1..=12).map(|k| state.force[k].map(|f| -f)).collect())
}

fn elastic_constants(bench: &mut Bench) -> Result<(), Fault> {
    let strain = 1e-5;
    // Twelve halves of a bond to the volume of a sphere, a quarter of a cell.
    let stress = |forces: &[[f64; 3]], i: usize, j: usize| {
        let virial: f64 = forces.iter().zip(neighbours()).map(|(force, offset)| force[i] * offset[j]).sum();
        2.0 * virial / CELL
    };
    // Differences: what is of second order in the strain falls out.
    let mut modulus = |deformation: fn(f64) -> [[f64; 3]; 3], entries: &[(usize, usize)]| {
        let ahead = star(bench, deformation(strain))?;
        let behind = star(bench, deformation(-strain))?;
        let slope = |&(i, j): &(usize, usize)| (stress(&ahead, i, j) - stress(&behind, i, j)) / (2.0 * strain);
        Ok::<Vec<f64>, Fault>(entries.iter().map(slope).collect())
    };
    let stretched = modulus(|e| [[e, 0.0, 0.0], [0.0; 3], [0.0; 3]], &[(0, 0), (1, 1), (2, 2)])?;
    // gamma = e, half of it on each side.
    let sheared = modulus(|e| [[0.0; 3], [0.0, 0.0, 0.5 * e], [0.0, 0.5 * e, 0.0]], &[(1, 2), (2, 1), (0, 0)])?;
    let expected = lattice();
    let exactly = |value: f64| Kind::ClosedForm.relative(value, 1e-9);
    bench.judge("C11", "Pa", stretched[0], exactly(expected.c11));
    bench.judge("C12", "Pa", stretched[1], exactly(expected.c12));
    bench.judge("C13", "Pa", stretched[2], exactly(expected.c12));
    bench.judge("C44", "Pa", sheared[0], exactly(expected.c44));
    bench.judge("C44, across", "Pa", sheared[1], exactly(expected.c44));
    bench.judge("C14 over C44", "1", sheared[2] / expected.c44, Kind::ClosedForm.within(0.0, 1e-9));
    let found = CubicElasticity { c11: stretched[0], c12: stretched[1], c44: sheared[0] };
    let normal = numbers(&LATTICE).stiffness.normal;
    // kappa = 1/3: 4 K_n/a (1 + 3 kappa)/(3 + kappa) = 2.4 K_n/a.
    bench.judge("E along [100]", "Pa", found.young_modulus(), exactly(2.4 * normal / LATTICE_CONSTANT));
    bench.judge("Poisson's ratio along [100]", "1", found.poisson_ratio(), exactly(0.2));
    bench.judge("bulk modulus", "Pa", found.bulk_modulus(), exactly(4.0 * normal / (3.0 * LATTICE_CONSTANT)));
    bench.judge("anisotropy", "1", found.anisotropy(), exactly(4.0 / 3.0));
    Ok(())
}

fn bond_forces(bench: &mut Bench) -> Result<(), Fault> {
    let (strain, ratio) = (1e-7, LATTICE.cement.stiffness_ratio);
    let across = -0.2 * strain;
    let forces = star(bench, [[strain, 0.0, 0.0], [0.0, across, 0.0], [0.0, 0.0, across]])?;
    let stress = lattice().young_modulus() * strain;
    let unit = 2.0_f64.sqrt() * RADIUS * RADIUS * stress / (1.0 + 3.0 * ratio);
    let (normal, shear) = (unit * (1.0 + ratio), 2.0 * unit * ratio);
    // Contraction by nu = 0.2 presses the bonds that do not cross.
    let within = across * SPACING * numbers(&LATTICE).stiffness.normal;
    let mut off = [0.0_f64; 3];
    for (force, offset) in forces.into_iter().zip(neighbours()) {
        let (force, offset): (Vec3<f64>, Vec3<f64>) = (force.into(), offset.into());
        let along = force.dot(offset) / SPACING;
        let rest = (force.dot(force) - along * along).max(0.0).sqrt();
        if offset.x == 0.0 {
            off[2] = off[2].max((along / within - 1.0).abs());
        } else {
            off[0] = off[0].max((along / normal - 1.0).abs());
            off[1] = off[1].max((rest / shear - 1.0).abs());
        }
    }
    bench.judge("crossing: normal force, largest error", "1", off[0], Kind::ClosedForm.at_most(1e-6));
    bench.judge("crossing: shear force, largest error", "1", off[1], Kind::ClosedForm.at_most(1e-6));
    bench.judge("within the layer: normal force, largest error", "1", off[2], Kind::ClosedForm.at_most(1e-6));
    Ok(())
}

/// Stretches a block along z between grips that hold nothing else, and lets it come to rest.
fn tension(bench: &mut Bench, cells: [usize; 3], steps: u64, expected: [f64; 3]) -> Result<(), Fault> {
    let strain = 1e-7;
    let half = 0.5 * LATTICE_CONSTANT;
    let mut scene = scene(Form::Total, LATTICE, 0.3);
    scene.damp_locally(0.7);
    let sites = scene.block(cells);
    let top = 2 * cells[2] - 1;
    scene.plan.constraints.push(Constraint { velocity: [None, None, Some(0.0)], ..Constraint::FREE });
    // Near the solution: sides drawn in as in the lattice, about the middle, so that nothing moves as a whole.
    for (k, site) in sites.iter().enumerate() {
        for d in 0..3 {
            let middle = 0.5 * (2 * cells[d] - 1) as f64;
            let stretch = if d == 2 { strain } else { -0.2 * strain };
            scene.state.position[k][d] += stretch * (site[d] as f64 - middle) * half;
        }
        scene.state.constraint[k] = u16::from(site[2] == 0 || site[2] == top);
    }
    let state = bench.after(&scene, steps)?;
    let moved = |k: usize, d: usize| state.position[k][d] - half * sites[k][d] as f64;
    let pull: f64 = (0..sites.len()).filter(|&k| sites[k][2] == top).map(|k| -state.force[k][2]).sum();
    let section = (cells[0] * cells[1]) as f64 * LATTICE_CONSTANT * LATTICE_CONSTANT;
    let modulus = pull / section / strain / lattice().young_modulus();
    let layer = |z: usize| {
        let of_layer = (0..sites.len()).filter(|&k| sites[k][2] == z);
        let (sum, count) = of_layer.fold((0.0, 0.0), |(sum, count), k| (sum + moved(k, 2), count + 1.0));
        sum / count
    };
    let (low, high) = (cells[2] / 2, 2 * cells[2] - 1 - cells[2] / 2);
    let within = (layer(high) - layer(low)) / ((high - low) as f64 * half);
    // Slope of u over x in the two layers in the middle, by least squares.
    let middle: Vec<[f64; 2]> = (0..sites.len())
        .filter(|&k| sites[k][2] == top / 2 || sites[k][2] == top / 2 + 1)
        .map(|k| [half * sites[k][0] as f64, moved(k, 0)])
        .collect();
    let mean = |d: usize| middle.iter().map(|point| point[d]).sum::<f64>() / middle.len() as f64;
    let (x, u) = (mean(0), mean(1));
    let cross: f64 = middle.iter().map(|point| (point[0] - x) * (point[1] - u)).sum();
    let square: f64 = middle.iter().map(|point| (point[0] - x) * (point[0] - x)).sum();
    let poisson = -cross / square / within;
    bench.judge("E from grip to grip over E_100", "1", modulus, Kind::Reference.within(expected[0], 5e-6));
    bench.judge("E within over E_100", "1", modulus * strain / within, Kind::Reference.within(expected[1], 5e-6));
    bench.judge("Poisson's ratio in the middle", "1", poisson, Kind::Reference.within(expected[2], 5e-6));
    Ok(())
}

fn plane_wave(bench: &mut Bench) -> Result<(), Fault> {
    let (cells, steps, amplitude) = ([6, 3, 3], 199, 1e-8 * SPACING);
    let mut scene = scene(Form::Total, LATTICE, 0.3);
    scene.repeat(cells, [true; 3]);
    let sites = scene.block(cells);
    let bonds = (scene.state.bonds.len() as f64) / sites.len() as f64;
    bench.judge("bonds per sphere", "1", bonds, Kind::ClosedForm.within(6.0, 0.0));
    // Half a cell is a layer.
    let phase = 2.0 * PI / (2 * cells[0]) as f64;
    let shape: Vec<f64> = sites.iter().map(|site| libm::cos(phase * site[0] as f64)).collect();
    let before = scene.state.position.clone();
    for (place, shape) in scene.state.position.iter_mut().zip(&shape) {
        place[0] += amplitude * shape;
    }
    let state = bench.after(&scene, steps)?;
    let moved: f64 = (0..sites.len()).map(|k| (state.position[k][0] - before[k][0]) * shape[k]).sum();
    let of_start = moved / amplitude / shape.iter().map(|s| s * s).sum::<f64>();
    let density = 4.0 * state.mass[0] / CELL;
    let speed = (lattice().c11 / density).sqrt();
    let frequency = 4.0 * speed / LATTICE_CONSTANT * libm::sin(0.5 * phase);
    let turn = 2.0 * libm::asin(0.5 * frequency * scene.plan.dt);
    let expected = libm::cos(steps as f64 * turn);
    let what = format!("amplitude after {steps} steps, of the start");
    bench.judge(what, "1", of_start, Kind::ClosedForm.within(expected, 1e-5));
    Ok(())
}

fn critical_step(bench: &mut Bench) -> Result<(), Fault> {
    // The stiffest wave is two cells long.
    let (cells, bound, start) = ([2; 3], 0.5026, 1e-12 * SPACING);
    let mut growth = |part: f64| {
        let mut scene = scene(Form::Total, LATTICE, part * bound);
        scene.repeat(cells, [true; 3]);
        scene.block(cells);
        let rate = start / scene.plan.dt;
        for k in 0..scene.state.len() {
            scene.state.velocity[k] = random_vector(61, k).map(|v| rate * v);
            scene.state.angular_velocity[k] = random_vector(62, k).map(|w| rate / RADIUS * w);
        }
        let state = bench.after(&scene, 200)?;
        let turning = state.angular_velocity.iter().map(|&turn| RADIUS * size(turn));
        Ok::<f64, Fault>(turning.fold(0.0, f64::max) / rate)
    };
    let (below, above) = (growth(0.997)?, growth(1.003)?);
    bench.judge("greatest spin at 0.997 of the bound, of the start", "1", below, Kind::Reference.at_most(100.0));
    bench.judge("greatest spin at 1.003 of the bound, of the start", "1", above, Kind::Reference.at_least(1e6));
    Ok(())
}

fn critical_step_gear(bench: &mut Bench) -> Result<(), Fault> {
    let joint = Joint { cement: Cement { stiffness_ratio: 0.0, ..LATTICE.cement }, ..LATTICE };
    let (cells, start, fastest) = ([2; 3], 1e-12 * SPACING, 8.0_f64.sqrt());
    // Of displacements and velocities over the greatest frequency, root of the sum of squares.
    let mut amplitudes = |omega_dt: f64, steps: u64| {
        let mut scene = scene(Form::Total, joint, omega_dt / fastest);
        scene.plan.integrator = Integrator::Gear;
        scene.repeat(cells, [true; 3]);
        scene.block(cells);
        let sites = scene.state.position.clone();
        for (k, place) in scene.state.position.iter_mut().enumerate() {
            (0..3).for_each(|d| place[d] += start * random_vector(63, k)[d]);
        }
        let omega = omega_dt / scene.plan.dt;
        let amplitude = |state: &State| {
            let of_particle = |k: usize| {
                let moved = size(std::array::from_fn(|d| state.position[k][d] - sites[k][d]));
                let speed = size(state.velocity[k]) / omega;
                moved * moved + speed * speed
            };
            (0..sites.len()).map(of_particle).sum::<f64>().sqrt()
        };
        let mut simulation = bench.start(&scene)?;
        simulation.advance(steps)?;
        let first = amplitude(&simulation.state()?);
        simulation.advance(steps)?;
        let second = amplitude(&simulation.state()?);
        bench.seal(&simulation.state()?);
        Ok::<[f64; 3], Fault>([amplitude(&scene.state), first, second])
    };
    let [begun, _, ended] = amplitudes(GEAR_OSCILLATOR_LIMIT, 8000)?;
    let steps = 5000;
    let [_, first, second] = amplitudes(0.6, steps)?;
    bench.judge(
        "amplitude at the bound after 16000 steps, of the start",
        "1",
        ended / begun,
        Kind::Reference.at_most(1.0),
    );
    let growth = libm::log(second / first) / steps as f64;
    bench.judge("growth at w dt = 0.6, in a step", "1", growth, Kind::Reference.relative(8.713e-4, 0.02));
    Ok(())
}

/// A free block that spins about its middle and moves on, with bonds of the given strengths.
fn spinning_block(cement: Cement<f64>, part: f64, spin: [f64; 3]) -> Scene {
    let mut scene = scene(Form::Total, Joint { cement, ..LATTICE }, part);
    scene.plan.interactions.iter_mut().for_each(|i| *i = ROCK.with_itself().friction(0.4));
    let cells = [3, 2, 2];
    scene.block(cells);
    let spin: Vec3<f64> = spin.into();
    let middle = cells.map(|n| 0.25 * LATTICE_CONSTANT * (2 * n - 1) as f64);
    for k in 0..scene.state.len() {
        let arm = Vec3::from(scene.state.position[k]) - middle.into();
        scene.state.velocity[k] = (spin.cross(arm) + Vec3::from([0.3, 0.1, -0.2])).into();
        scene.state.angular_velocity[k] = spin.into();
    }
    scene
}

/// Changes of momentum and angular momentum, relative.
fn changes(before: &State, after: &State) -> [f64; 2] {
    let ((linear, linear_scale), (angular, angular_scale)) = (momenta(before), angular_momenta(before));
    let (now_linear, now_angular) = (momenta(after).0, angular_momenta(after).0);
    let change = |now: [f64; 3], was: [f64; 3]| size(std::array::from_fn(|d| now[d] - was[d]));
    [change(now_linear, linear) / linear_scale, change(now_angular, angular) / angular_scale]
}

fn spinning(bench: &mut Bench) -> Result<(), Fault> {
    let cement = Cement {
        tensile_strength: 2e4,
        shear_strength: 1e4,
        internal_friction: 0.3,
        damping_ratio: 0.02,
        ..LATTICE.cement
    };
    let scene = spinning_block(cement, 0.1, [150.0, -80.0, 200.0]);
    let state = bench.after(&scene, 4000)?;
    let [linear, angular] = changes(&scene.state, &state);
    bench.judge("change of momentum over sum of m |v|", "1", linear, Kind::Conservation.at_most(1e-12));
    bench.judge("change of angular momentum over sum of sizes", "1", angular, Kind::Conservation.at_most(1e-12));
    let ledger = Ledger::of(&state, &scene.plan);
    bench.judge("broken bonds", "1", ledger.broken_bonds as f64, Kind::Conservation.at_least(20.0));
    bench.judge("bonds that hold", "1", ledger.bonds as f64, Kind::Conservation.at_least(20.0));
    let start = Ledger::of(&scene.state, &scene.plan).kinetic();
    let error = ledger.energy_error.abs() / start;
    bench.judge("closing error of the ledger over energy", "1", error, Kind::Conservation.at_most(1e-2));
    Ok(())
}

fn spinning_gear(bench: &mut Bench) -> Result<(), Fault> {
    let mut drifts = Vec::new();
    for halving in 0..3 {
        let parts = 1 << halving;
        let mut scene = spinning_block(LATTICE.cement, 0.1 / f64::from(parts), [20.0, -10.0, 30.0]);
        scene.plan.integrator = Integrator::Gear;
        let state = bench.after(&scene, 400 * u64::from(parts as u32))?;
        let [linear, angular] = changes(&scene.state, &state);
        drifts.push(angular);
        if halving == 2 {
            bench.judge("change of momentum over sum of m |v|", "1", linear, Kind::Conservation.at_most(1e-12));
        }
    }
    bench.judge("change of angular momentum at the smallest step", "1", drifts[2], Kind::Conservation.at_most(1e-3));
    // Less would be rounding, and no order could be told.
    bench.judge("and at least", "1", drifts[2], Kind::Conservation.at_least(1e-12));
    let order = libm::log2(drifts[1] / drifts[2]);
    bench.judge("order of the change, at least", "1", order, Kind::Order.at_least(0.8));
    Ok(())
}

fn bar_vibration(bench: &mut Bench) -> Result<(), Fault> {
    let cells = [3, 3, 16];
    let half = 0.5 * LATTICE_CONSTANT;
    let length = cells[2] as f64 * LATTICE_CONSTANT;
    for (name, form) in FORMS {
        let mut scene = scene(form, LATTICE, 0.3);
        let sites = scene.block(cells);
        let shape = |k: usize| libm::cos(PI * (sites[k][2] as f64 + 0.5) * half / length);
        let speed = 1e-6 * SPACING / scene.plan.dt;
        for k in 0..sites.len() {
            scene.state.velocity[k][2] = speed * shape(k);
        }
        let mut simulation = bench.start(&scene)?;
        let (mut before, mut crossings) = (0.0, Vec::new());
        for sample in 1..=220 {
            simulation.advance(2)?;
            let state = simulation.state()?;
            let moved = |k: usize| state.position[k][2] - half * sites[k][2] as f64;
            let now: f64 = (0..sites.len()).map(|k| moved(k) * shape(k)).sum();
            if before * now < 0.0 {
                crossings.push((f64::from(sample - 1) + crossing(before, now)) * 2.0 * scene.plan.dt);
            }
            before = now;
        }
        bench.seal(&simulation.state()?);
        let span = crossings.last().unwrap_or(&f64::NAN) - crossings.first().unwrap_or(&f64::NAN);
        let frequency = PI * (crossings.len() as f64 - 1.0) / span;
        let density = 4.0 * scene.state.mass[0] / CELL;
        let speed = (0.829_306 * lattice().young_modulus() / density).sqrt();
        let of_bar = frequency * length / (PI * speed);
        bench.judge(format!("{name}: frequency over that of a bar"), "1", of_bar, Kind::ClosedForm.within(1.0, 0.02));
    }
    Ok(())
}

fn tensile_strength(bench: &mut Bench) -> Result<(), Fault> {
    let (cells, half) = ([4, 4, 6], 0.5 * LATTICE_CONSTANT);
    let ratio = LATTICE.cement.stiffness_ratio;
    let strength = 5e4;
    // Bonds on open sides bend: with beta = 1 the block would bear 0.69 of the lattice, whatever its size.
    let cement = Cement {
        tensile_strength: strength,
        shear_strength: 3.0 * strength,
        moment_contribution: 0.0,
        ..LATTICE.cement
    };
    let mut scene = scene(Form::Total, Joint { cement, ..LATTICE }, 0.3);
    scene.damp_locally(0.7);
    let sites = scene.block(cells);
    let top = 2 * cells[2] - 1;
    let expected = strength / tensile_stress(1.0, ratio, 1.0);
    let failure_way = expected / lattice().young_modulus() * top as f64 * half;
    let steps = 6000;
    let speed = 0.5 * failure_way / (f64::from(steps) * scene.plan.dt);
    for sign in [-1.0, 1.0] {
        scene.plan.constraints.push(Constraint { velocity: [None, None, Some(sign * speed)], ..Constraint::FREE });
    }
    for (k, site) in sites.iter().enumerate() {
        scene.state.constraint[k] = u16::from(site[2] == 0) + 2 * u16::from(site[2] == top);
    }
    let mut simulation = bench.start(&scene)?;
    let (mut greatest, mut last) = (0.0_f64, 0.0);
    for _ in 0..150 {
        simulation.advance(50)?;
        let state = simulation.state()?;
        last = (0..sites.len()).filter(|&k| sites[k][2] == top).map(|k| -state.force[k][2]).sum();
        greatest = greatest.max(last);
    }
    bench.seal(&simulation.state()?);
    // The layers are half a cell narrower than the cells.
    let section = cells[0] as f64 * (cells[1] as f64 - 0.5) * LATTICE_CONSTANT * LATTICE_CONSTANT;
    let of_lattice = greatest / section / expected;
    bench.judge("strength over that of the lattice", "1", of_lattice, Kind::ClosedForm.within(0.9, 0.1));
    bench.judge("force at the end over the greatest", "1", last / greatest, Kind::ClosedForm.at_most(0.1));
    Ok(())
}
