//! Heat between particles: chains, lattices, contacts and walls, all held in place.

use super::{CLOSED, Material, ROOM, SOLID, constant, face_centred_section, held_at, largest_difference};
use crate::verify::Kind;
use crate::verify::bonded::{JOINT, LATTICE_CONSTANT, RADIUS, ROCK, SPACING, Way, scene};
use crate::verify::scene::{Bench, HELD, Scene, random};
use std::f64::consts::PI;
use tdem_engine::physics::bond::{Cement, Form, Joint};
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::heat::Path;
use tdem_engine::physics::heat::conduction::pair_conductivity;
use tdem_engine::{Bond, Fault, State, heat_accounts};

/// A bar as thick as the spheres.
const ROUND: f64 = PI / 4.0;

/// $H = \lambda\pi R^2/(2R)$ of a bond of the chain, W/K.
fn chain_conductance() -> f64 {
    SOLID.conductivity * PI * RADIUS * RADIUS / SPACING
}

/// A chain held in place, its step a part of $C/H$.
fn held_chain(links: usize, part: f64) -> Scene {
    let mut scene = scene(Form::Total, JOINT, 0.3);
    scene.chain(links);
    scene.hold_all();
    scene.heat(&[SOLID], ROUND, CLOSED);
    scene.heat_step(part * scene.capacity(0) / chain_conductance());
    scene
}

pub(super) fn two_particles(bench: &mut Bench) -> Result<(), Fault> {
    let (difference, length) = (300.0, 1.6 * RADIUS);
    let mut off_exponential = Vec::new();
    for halving in 0..3 {
        let mut scene = scene(Form::Total, JOINT, 0.3);
        scene.sphere(RADIUS, ROCK.density, [0.0; 3]);
        scene.sphere(0.6 * RADIUS, ROCK.density, [length, 0.0, 0.0]);
        scene.state.make_bonds(vec![Bond::new(0, 1, 1.0)]);
        scene.hold_all();
        scene.heat(&[SOLID], ROUND, CLOSED);
        scene.state.temperature = vec![400.0, 400.0 - difference];
        let conductance = SOLID.conductivity * PI * (0.8 * RADIUS) * (0.8 * RADIUS) / length;
        let rate = conductance * (1.0 / scene.capacity(0) + 1.0 / scene.capacity(1));
        let steps = 20_u32 << halving;
        // Over a time of 1/rate.
        scene.heat_step(1.0 / (rate * f64::from(steps)));
        let state = bench.after(&scene, steps.into())?;
        let left = (state.temperature[0] - state.temperature[1]) / difference;
        let euler = (0..steps).fold(1.0, |left, _| left * (1.0 - 1.0 / f64::from(steps)));
        let what = format!("difference after {steps} steps, of the start");
        bench.judge(what, "1", left, Kind::ClosedForm.relative(euler, 1e-13));
        off_exponential.push((left - libm::exp(-1.0)).abs());
        let heat = |temperature: &[f64]| (0..2).map(|k| scene.capacity(k) * temperature[k]).sum::<f64>();
        let kept = heat(&state.temperature) / heat(&scene.state.temperature);
        bench.judge(
            format!("heat after {steps} steps, of the start"),
            "1",
            kept,
            Kind::Conservation.within(1.0, 1e-14),
        );
    }
    let order = libm::log2(off_exponential[1] / off_exponential[2]);
    bench.judge("order of the difference from the exponential", "1", order, Kind::Order.within(1.0, 0.05));
    Ok(())
}

pub(super) fn chain_steady(bench: &mut Bench) -> Result<(), Fault> {
    let (links, hot, cold) = (9, 400.0, 300.0);
    let mut scene = held_chain(links, 0.5);
    scene.expose(&[0], &held_at(constant(hot)));
    scene.expose(&[links], &held_at(constant(cold)));
    scene.state = bench.after(&scene, 600)?;
    let line = |k: usize| hot + (cold - hot) * k as f64 / links as f64;
    let off = largest_difference(&scene.state.temperature, (0..=links).map(line)) / (hot - cold);
    bench.judge(
        "temperatures: largest difference from the line, of that of the ends",
        "1",
        off,
        Kind::ClosedForm.at_most(1e-10),
    );
    // What goes in at one end comes out at the other.
    let steps = 50;
    let later = bench.after(&scene, steps)?;
    let through = steps as f64 * scene.plan.heat_step() * chain_conductance() * (hot - cold) / links as f64;
    for (what, column) in [("heat in", heat_accounts::IN), ("heat out", heat_accounts::OUT)] {
        let sum = |state: &State| state.heat_accounts.iter().map(|account| account[column]).sum::<f64>();
        let got = sum(&later) - sum(&scene.state);
        bench.judge(format!("{what}, {steps} steps"), "J", got, Kind::ClosedForm.relative(through, 1e-10));
    }
    Ok(())
}

pub(super) fn chain_transient(bench: &mut Bench) -> Result<(), Fault> {
    let (count, part, steps) = (20, 0.2, 200);
    let mut scene = held_chain(count - 1, part);
    scene.state.temperature = (0..count).map(|k| 300.0 + 200.0 * random(71, k)).collect();
    let shape = |k: usize, j: usize| libm::cos(PI * k as f64 * (j as f64 + 0.5) / count as f64);
    // The amplitudes of the modes, and what is left of each.
    let amplitude = |k: usize| {
        let sum: f64 = (0..count).map(|j| scene.state.temperature[j] * shape(k, j)).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / count as f64
    };
    let amplitudes: Vec<f64> = (0..count).map(amplitude).collect();
    let left = |k: usize| {
        let sine = libm::sin(0.5 * PI * k as f64 / count as f64);
        (0..steps).fold(1.0, |left, _| left * (1.0 - 4.0 * part * sine * sine))
    };
    let left: Vec<f64> = (0..count).map(left).collect();
    let expected = |j: usize| (0..count).map(|k| amplitudes[k] * left[k] * shape(k, j)).sum::<f64>();
    let state = bench.after(&scene, steps)?;
    let off = largest_difference(&state.temperature, (0..count).map(expected)) / 300.0;
    bench.judge(
        "temperatures: largest difference from the modes, of the lowest",
        "1",
        off,
        Kind::ClosedForm.at_most(1e-12),
    );
    let slowest = left[1];
    bench.judge("the slowest mode has lost its part", "1", slowest, Kind::ClosedForm.at_most(0.5));
    let hottest = state.temperature.iter().fold(0.0_f64, |hottest, t| hottest.max(*t));
    let was = scene.state.temperature.iter().fold(0.0_f64, |hottest, t| hottest.max(*t));
    bench.judge("the hottest is less hot than before", "K", hottest, Kind::ClosedForm.at_most(was));
    Ok(())
}

/// $\lambda_{eff}/\lambda$ along an axis between layers that are held at temperatures, in the steady state.
fn conductivity(bench: &mut Bench, cells: [usize; 3], axis: usize, periodic: bool) -> Result<f64, Fault> {
    let difference = 100.0;
    let mut scene = scene(Form::Total, JOINT, 0.3);
    if periodic {
        scene.repeat(cells, std::array::from_fn(|d| d != axis));
    }
    let sites = scene.block(cells);
    scene.hold_all();
    scene.heat(&[SOLID], face_centred_section(None), CLOSED);
    // C/H of a particle with twelve bonds is C/(3 lambda a).
    scene.heat_step(0.9 * scene.capacity(0) / (3.0 * SOLID.conductivity * LATTICE_CONSTANT));
    let last = 2 * cells[axis] - 1;
    let of_layer = |layer: usize| (0..sites.len()).filter(|&k| sites[k][axis] == layer).collect::<Vec<_>>();
    scene.expose(&of_layer(0), &held_at(constant(ROOM + difference)));
    scene.expose(&of_layer(last), &held_at(constant(ROOM)));
    let state = bench.after(&scene, 600)?;
    let rate: f64 = of_layer(last).into_iter().map(|k| state.heat_rate[k]).sum();
    let area = cells.iter().enumerate().filter(|(d, _)| *d != axis).map(|(_, &n)| n as f64 * LATTICE_CONSTANT);
    let length = 0.5 * last as f64 * LATTICE_CONSTANT;
    Ok(rate * length / (area.product::<f64>() * difference * SOLID.conductivity))
}

pub(super) fn lattice_conductivity(bench: &mut Bench) -> Result<(), Fault> {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let cells = std::array::from_fn(|d| if d == axis { 3 } else { 2 });
        let got = conductivity(bench, cells, axis, true)?;
        let what = format!("sides that repeat: lambda_eff along {name} over lambda");
        bench.judge(what, "1", got, Kind::ClosedForm.relative(1.0, 1e-9));
    }
    // The field is linear, so what is missing are bonds: exactly so many.
    let cells = [3, 2, 3];
    let got = conductivity(bench, cells, 2, false)?;
    let open = 1.0 - 0.25 / cells[0] as f64 - 0.25 / cells[1] as f64;
    bench.judge("open sides: lambda_eff over lambda", "1", got, Kind::ClosedForm.relative(open, 1e-9));
    Ok(())
}

pub(super) fn unlike(bench: &mut Bench) -> Result<(), Fault> {
    let other = Material { conductivity: 45.0, specific_heat: 480.0, ..SOLID };
    let mut scene = scene(Form::Total, JOINT, 0.3);
    scene.chain(2);
    scene.hold_all();
    scene.state.material[2] = 1;
    scene.heat(&[SOLID, other], ROUND, CLOSED);
    scene.state.temperature = vec![500.0, 300.0, 350.0];
    let capacity = [scene.capacity(0), scene.capacity(1), scene.capacity(2)];
    // 2 * 1.5 * 45 / 46.5: two halves one behind the other.
    let mixed = 2.903_225_806_451_613 / 1.5 * chain_conductance();
    let step = 0.2 * capacity[0] / mixed;
    scene.heat_step(step);
    let steps = 30;
    let state = bench.after(&scene, steps)?;
    let mut expected = [500.0, 300.0, 350.0];
    for _ in 0..steps {
        let flow = [chain_conductance() * (expected[0] - expected[1]), mixed * (expected[1] - expected[2])];
        expected[0] -= step * flow[0] / capacity[0];
        expected[1] += step * (flow[0] - flow[1]) / capacity[1];
        expected[2] += step * flow[1] / capacity[2];
    }
    for k in 0..3 {
        let what = format!("particle {k} after {steps} steps");
        bench.judge(what, "K", state.temperature[k], Kind::ClosedForm.relative(expected[k], 1e-13));
    }
    Ok(())
}

pub(super) fn broken_bond(bench: &mut Bench) -> Result<(), Fault> {
    let brittle = Joint { cement: Cement { tensile_strength: 1e3, ..JOINT.cement }, ..JOINT };
    let mut scene = scene(Form::Total, brittle, 0.3);
    scene.chain(1);
    scene.heat(&[SOLID], ROUND, Path::Bar);
    scene.state.temperature = vec![400.0, 300.0];
    scene.heat_step(1e-3 * scene.capacity(0) / chain_conductance());
    scene.hold(0, HELD);
    scene.hold(1, HELD);
    let held = bench.after(&scene, 0)?;
    let exactly = |value: f64| Kind::ClosedForm.relative(value, 1e-13);
    let expected = chain_conductance() * 100.0;
    bench.judge("bonded: heat rate", "W", held.heat_rate[1], exactly(-held.heat_rate[0]));
    bench.judge("bonded: heat rate, by the bar", "W", held.heat_rate[1], exactly(expected));
    // The second is moved away until the bond breaks, back, and 0.01 R into the first.
    let dt = scene.plan.dt;
    let mut move_by = |scene: &mut Scene, way: f64, steps: u64| {
        let shift = [Some(way), Some(0.0), Some(0.0)];
        scene.plan.constraints[2] = Way { shift, turn: [Some(0.0); 3] }.at_rate(1.0 / steps as f64, dt);
        scene.state = bench.after(scene, steps)?;
        Ok::<(), Fault>(())
    };
    move_by(&mut scene, 0.01 * RADIUS, 10)?;
    let [broken, apart] = [f64::from(u8::from(!scene.state.bonds[0].holds())), scene.state.heat_rate[0].abs()];
    move_by(&mut scene, -0.02 * RADIUS, 10)?;
    bench.judge("bonds that broke", "1", broken, Kind::ClosedForm.within(1.0, 0.0));
    bench.judge("apart: heat rate", "W", apart, Kind::ClosedForm.within(0.0, 0.0));
    let state = &scene.state;
    let length = state.position[1][0] - state.position[0][0];
    let conductance = chain_conductance() * SPACING / length;
    let through = conductance * (state.temperature[0] - state.temperature[1]);
    bench.judge("distance, pressed together", "m", length, Kind::ClosedForm.relative(1.99 * RADIUS, 1e-12));
    bench.judge("touching: heat rate, by the bar", "W", state.heat_rate[1], Kind::ClosedForm.relative(through, 1e-12));
    Ok(())
}

pub(super) fn contact_circle(bench: &mut Bench) -> Result<(), Fault> {
    // Two spheres, the first pressed to a wall of another material.
    let steel = Material { conductivity: 45.0, ..SOLID };
    let (overlap, depth, small) = (0.01 * RADIUS, 0.02 * RADIUS, 0.5 * RADIUS);
    let mut scene = Scene::new(Law::GNTM, ROCK.with_itself(), 1e-6);
    scene.sphere(RADIUS, ROCK.density, [0.0, 0.0, RADIUS - depth]);
    scene.sphere(small, ROCK.density, [RADIUS + small - overlap, 0.0, RADIUS - depth]);
    scene.floor();
    scene.hold_all();
    scene.heat(&[SOLID, steel], ROUND, Path::Circle);
    scene.state.temperature = vec![400.0, 300.0];
    scene.warm_walls(&[Some(constant(600.0))]);
    // R* = R/3 between the spheres, R at the wall.
    let between = 2.0 * SOLID.conductivity * (RADIUS / 3.0 * overlap).sqrt();
    let at_wall = 2.0 * pair_conductivity(SOLID.conductivity, steel.conductivity) * (RADIUS * depth).sqrt();
    let step = 0.05 * scene.capacity(1) / between;
    scene.heat_step(step);
    let state = bench.after(&scene, 0)?;
    let exactly = |value: f64| Kind::ClosedForm.relative(value, 1e-12);
    bench.judge("between two spheres: heat rate", "W", state.heat_rate[1], exactly(100.0 * between));
    let from_wall = state.heat_rate[0] + state.heat_rate[1];
    bench.judge("from the wall: heat rate", "W", from_wall, exactly(200.0 * at_wall));
    let steps = 30;
    let state = bench.after(&scene, steps)?;
    let mut expected = [400.0, 300.0];
    for _ in 0..steps {
        let flow = between * (expected[0] - expected[1]);
        let warmed = [at_wall * (600.0 - expected[0]) - flow, flow];
        (0..2).for_each(|k| expected[k] += step * warmed[k] / scene.capacity(k));
    }
    for k in 0..2 {
        let what = format!("particle {k} after {steps} steps");
        bench.judge(what, "K", state.temperature[k], exactly(expected[k]));
    }
    // Without overlap there is no circle.
    scene.state.position[1][0] = 1.6 * RADIUS;
    scene.warm_walls(&[None]);
    let apart = bench.after(&scene, 0)?;
    bench.judge("apart: heat rate", "W", apart.heat_rate[0], Kind::ClosedForm.within(0.0, 0.0));
    Ok(())
}
