//! Heat that motion makes, and the work that expansion does.

use super::{CLOSED, Material, ROOM, SOLID, held_at};
use crate::verify::Kind;
use crate::verify::bonded::{JOINT, LATTICE_CONSTANT, RADIUS, SPACING, numbers, scene};
use crate::verify::conservation::cloud;
use crate::verify::scene::{Bench, GRAVITY, HELD, PLASTIC, Scene, With};
use tdem_engine::physics::bond::Form;
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::heat::Dissipation;
use tdem_engine::{Constraint, Course, Fault, Ledger, State, energy_accounts, heat_accounts};

/// All of what is lost becomes heat.
const ALL: Dissipation<f64> = Dissipation { friction: 1.0, damping: 1.0 };

impl Scene {
    /// Lets motion make heat.
    fn dissipate(&mut self, dissipation: Dissipation<f64>) {
        if let Some(heat) = &mut self.plan.heat {
            heat.dissipation = dissipation;
        }
    }
    /// Heat of all particles above the temperature of the room, J.
    fn warmth(&self, state: &State) -> f64 {
        (0..state.len()).map(|k| self.capacity(k) * (state.temperature[k] - ROOM)).sum()
    }
}

fn booked(accounts: &[[f64; 4]], column: usize) -> f64 {
    accounts.iter().map(|account| account[column]).sum()
}

pub(super) fn sliding_block(bench: &mut Bench) -> Result<(), Fault> {
    let (speed, friction) = (0.05, 0.4);
    let mut scene = scene(Form::Total, JOINT, 0.2);
    let cells = [3, 3, 1];
    scene.block(cells);
    let contact = PLASTIC.with_itself().friction(friction).dashpots(3000.0, 300.0).clamped();
    scene.plan.interactions.fill(contact);
    scene.plan.gravity = [0.0, 0.0, -GRAVITY];
    scene.wall([0.0, 0.0, 1.0], [0.0, 0.0, -RADIUS]);
    // All of it is pushed along at one speed and does not turn, but rests on the floor by its own weight.
    let pushed = Constraint { velocity: [Some(speed), Some(0.0), None], ..HELD };
    scene.hold(0, pushed);
    let number = scene.state.constraint[0];
    scene.state.constraint.fill(number);
    scene.state.velocity.fill([speed, 0.0, 0.0]);
    scene.damp_locally(0.2);
    scene.heat(&[SOLID], 1.0, CLOSED);
    scene.heat_step(1e-3);
    scene.dissipate(Dissipation { friction: 1.0, damping: 0.0 });
    let (settled, way) = (6_000, 8_000);
    let mut simulation = bench.start(&scene)?;
    simulation.advance(settled)?;
    let begin = simulation.state()?;
    simulation.advance(way)?;
    let end = simulation.state()?;
    bench.seal(&end);
    let weight = GRAVITY * scene.state.mass.iter().sum::<f64>();
    let slid = speed * scene.plan.dt * way as f64;
    let expected = friction * weight * slid;
    let warmer = scene.warmth(&end) - scene.warmth(&begin);
    bench.judge("sum of m c dT", "J", warmer, Kind::ClosedForm.relative(expected, 1e-3));
    let made = booked(&end.heat_accounts, heat_accounts::MADE) - booked(&begin.heat_accounts, heat_accounts::MADE);
    bench.judge("heat made, by the ledger", "J", made, Kind::ClosedForm.relative(expected, 1e-3));
    let speed_left = end.velocity.iter().map(|v| v[2].abs()).fold(0.0, f64::max) / speed;
    bench.judge("speed across the floor, of that along it", "1", speed_left, Kind::ClosedForm.at_most(1e-3));
    Ok(())
}

pub(super) fn heat_of_collisions(bench: &mut Bench) -> Result<(), Fault> {
    let contact = PLASTIC.with_itself().friction(0.5).dashpots(800.0, 200.0).clamped();
    let mut scene = Scene::new(Law::GNTM, contact, 1e-5);
    let (radius, spacing) = (5e-3, 0.012);
    cloud(&mut scene, spacing, 0.7 * radius, radius, 1.0);
    let far = 3.0 * spacing;
    for d in 0..3 {
        let mut normal = [0.0; 3];
        normal[d] = 1.0;
        scene.wall(normal, [0.0; 3]);
        scene.wall(normal.map(|n| -n), [far; 3]);
    }
    scene.heat(&[SOLID], 1.0, CLOSED);
    scene.heat_step(1e-3);
    scene.dissipate(ALL);
    let begin = Ledger::of(&bench.after(&scene, 0)?, &scene.plan).mechanical();
    let end = bench.after(&scene, 8_000)?;
    let ledger = Ledger::of(&end, &scene.plan);
    let lost = begin - ledger.mechanical();
    let made = booked(&end.heat_accounts, heat_accounts::MADE);
    bench.judge("energy lost, of that at the start", "1", lost / begin, Kind::Conservation.at_least(0.5));
    // Springs that stiffen under a stored displacement put energy into the motion.
    let between = made / (lost + ledger.stiffening_work);
    bench.judge("heat made over energy lost and put in", "1", between, Kind::Conservation.within(1.0, 5e-3));
    let [friction, damping] =
        [energy_accounts::FRICTION, energy_accounts::DAMPING].map(|column| booked(&end.accounts, column));
    let between = made / (friction + damping);
    bench.judge("heat made over friction and damping", "1", between, Kind::Conservation.within(1.0, 1e-12));
    let under_way = end.heat_rate.iter().sum::<f64>() * scene.plan.heat_step();
    let found = (scene.warmth(&end) + under_way) / made;
    bench.judge("heat found in the spheres over heat made", "1", found, Kind::Conservation.within(1.0, 1e-8));
    Ok(())
}

pub(super) fn expansion_work(bench: &mut Bench) -> Result<(), Fault> {
    let (links, steps) = (8, 4000);
    let (expansion, warmth) = (1e-5, 20.0);
    let mut scene = scene(Form::Total, JOINT, 0.2);
    scene.chain(links);
    scene.hold(0, HELD);
    scene.hold(links, HELD);
    scene.heat(&[Material { expansion, ..SOLID }], 1.0, CLOSED);
    scene.heat_step(1.0);
    let ramp = Course(vec![[0.0, ROOM], [steps as f64, ROOM + warmth]]);
    scene.expose(&(0..=links).collect::<Vec<_>>(), &held_at(ramp));
    let end = bench.after(&scene, steps)?;
    let ledger = Ledger::of(&end, &scene.plan);
    let strain = expansion * warmth;
    let stiffness = numbers(&JOINT).stiffness.normal;
    let expected = 0.5 * stiffness * (SPACING * strain) * (SPACING * strain) * links as f64;
    bench.judge(
        "work of expansion of a held chain",
        "J",
        ledger.expansion_work,
        Kind::ClosedForm.relative(expected, 1e-6),
    );
    bench.judge("energy in its bonds", "J", ledger.elastic_bonds, Kind::ClosedForm.relative(expected, 1e-6));

    // A block between two held faces that is heated there: it bends, moves and is strained everywhere.
    let mut scene = self::scene(Form::Total, JOINT, 0.2);
    scene.block([4, 2, 2]);
    let faces: Vec<usize> = (0..scene.state.len())
        .filter(|&k| {
            let x = scene.state.position[k][0];
            !(0.25 * LATTICE_CONSTANT..=3.25 * LATTICE_CONSTANT).contains(&x)
        })
        .collect();
    for &k in &faces {
        scene.hold(k, HELD);
    }
    scene.heat(&[Material { expansion, ..SOLID }], 1.0, CLOSED);
    scene.heat_step(0.1);
    let ramp = Course(vec![[0.0, ROOM], [0.05 * steps as f64, ROOM + warmth]]);
    scene.expose(&faces, &held_at(ramp));
    let end = bench.after(&scene, steps)?;
    let ledger = Ledger::of(&end, &scene.plan);
    let error = ledger.energy_error.abs() / ledger.expansion_work;
    bench.judge("block: what the ledger lacks, of the work", "1", error, Kind::Conservation.at_most(1e-3));
    Ok(())
}
