//! The contract of bits: one case, one result, however the machine works.

mod common;

use common::scene;
use tdem_engine::cpu::{List, Options, Width};
use tdem_engine::physics::contact::{Damping, Friction, Law};
use tdem_engine::{Integrator, Plan, Simulation, State};

const STEPS: u64 = 600;

fn run(state: &State, plan: &Plan, options: &Options, steps: u64) -> State {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), options).expect("the scene is sound");
    simulation.advance(steps).expect("the scene runs through");
    assert!(simulation.searches() > 1, "the scene must rebuild its lists, or it shows nothing");
    simulation.state().expect("a state can be taken")
}

fn laws() -> Vec<Law> {
    let rescaled = Law { friction: Friction::Rescaled, damping: Damping::Restitution, ..Law::GNTM };
    vec![Law::GN, Law::GNT, Law::GNTM, rescaled]
}

#[test]
fn same_bits_for_threads_widths_lists_cells_and_skins() {
    for law in laws() {
        let (state, plan) = scene(law, Integrator::VelocityVerlet, 3.0);
        let reference = Options { threads: Some(1), width: Width::One, list: List::Full, cell_factor: 1.0 };
        let expected = run(&state, &plan, &reference, STEPS);
        let (pairs, walls) = (expected.contacts.len(), expected.wall_contacts.len());
        assert!(pairs > 100 && walls > 10, "the scene must be busy: {pairs} pairs, {walls} at walls");
        let variants = [
            reference,
            Options { list: List::Half, ..reference },
            Options { list: List::Half, threads: Some(2), cell_factor: 1.7, ..reference },
            Options { list: List::Half, threads: Some(7), cell_factor: 3.0, ..reference },
        ];
        for options in variants.iter().flat_map(|&options| Width::ALL.map(|width| Options { width, ..options })) {
            assert_eq!(run(&state, &plan, &options, STEPS).hash(), expected.hash(), "{law:?} {options:?}");
        }
        for (skin, every_step) in [(0.0, true), (5e-4, false), (6e-3, false)] {
            let mut plan = plan.clone();
            plan.search.skin = skin;
            plan.search.every_step = every_step;
            let found = run(&state, &plan, &Options::default(), STEPS);
            assert_eq!(found.hash(), expected.hash(), "{law:?} skin {skin}");
        }
    }
}

#[test]
fn same_bits_when_resumed_at_any_step() {
    for integrator in [Integrator::VelocityVerlet, Integrator::Gear] {
        let (state, plan) = scene(Law::GNTM, integrator, 2.0);
        let expected = run(&state, &plan, &Options::default(), STEPS);
        for at in [1, 137, 400] {
            for (width, then) in
                [(Width::One, Width::Portable), (Width::Portable, Width::Widest), (Width::Widest, Width::One)]
            {
                let half_way = run_short(&state, &plan, width, at);
                let resumed = run_short(&half_way, &plan, then, STEPS - at);
                assert_eq!(resumed.hash(), expected.hash(), "{integrator:?} {width:?} resumed at {at} as {then:?}");
                assert_eq!(resumed, expected, "a hash that matches must mean a state that matches");
            }
        }
    }
}

fn run_short(state: &State, plan: &Plan, width: Width, steps: u64) -> State {
    let options = Options { width, ..Options::default() };
    let mut simulation = Simulation::new(state.clone(), plan.clone(), options).expect("the scene is sound");
    simulation.advance(steps).expect("the scene runs through");
    simulation.state().expect("a state can be taken")
}

#[test]
fn same_bits_when_particles_are_given_in_another_order() {
    // Ids decide the order of sums, so the same ids in another place of memory are the same simulation. A state is
    // kept in the order of ids; the working order is shuffled by the search. Here the space is mirrored instead:
    // every coordinate changes sign and so must every result.
    let (state, plan) = scene(Law::GNTM, Integrator::VelocityVerlet, 2.0);
    let mirror = |v: [f64; 3]| v.map(|c| -c);
    let mut mirrored = state.clone();
    for field in [&mut mirrored.position, &mut mirrored.velocity, &mut mirrored.wall_position] {
        for v in field.iter_mut() {
            *v = mirror(*v);
        }
    }
    let mut other = plan.clone();
    other.gravity = mirror(plan.gravity);
    (other.domain.min, other.domain.max) = (mirror(plan.domain.max), mirror(plan.domain.min));
    for wall in &mut other.walls {
        (wall.normal, wall.velocity) = (mirror(wall.normal), mirror(wall.velocity));
    }
    let straight = run(&state, &plan, &Options::default(), STEPS);
    for width in Width::ALL {
        let reflected = run(&mirrored, &other, &Options { width, ..Options::default() }, STEPS);
        for i in 0..straight.len() {
            assert_eq!(straight.position[i], mirror(reflected.position[i]), "particle {i}, {width:?}");
            assert_eq!(
                straight.angular_velocity[i], reflected.angular_velocity[i],
                "spin is an axial vector, {width:?}"
            );
        }
    }
}
