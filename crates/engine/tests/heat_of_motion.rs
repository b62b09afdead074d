//! Heat that friction and dashpots make, and the work that expansion does on springs.

mod common;

use common::bonded::{CEMENT, CLAMPED, ELASTIC, JOINT, bond_neighbours, chain, free_space, lattice};
use common::heated::{
    EXPANSION, NONE, REFERENCE, SPECIFIC_HEAT, after, constant, heat_of, heated, heated_block, in_turns, keep_books,
    warm_block, warm_cloud,
};
use common::{DENSITY, plan, random, scene, spheres, wall};
use tdem_engine::cpu::{Options, Width};
use tdem_engine::physics::bond::{self, Cement, Damping, Joint};
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::heat::{Dissipation, Exchange, Path};
use tdem_engine::{
    Around, Exposure, Fault, Integrator, Ledger, Plan, Simulation, State, Table, energy_accounts, heat_accounts,
};

const DASHPOTS: bond::Law = bond::Law { damping: Damping::Viscous, ..ELASTIC };

fn booked(state: &State, column: usize) -> f64 {
    state.accounts.iter().map(|account| account[column]).sum()
}
fn heat_booked(state: &State, column: usize) -> f64 {
    state.heat_accounts.iter().map(|account| account[column]).sum()
}
fn kept(state: &State) -> f64 {
    (0..state.len()).map(|i| state.mass[i] * SPECIFIC_HEAT * (state.temperature[i] - REFERENCE)).sum()
}

/// Spheres that collide in an insulated box: what friction and dashpots take is found as heat, whatever the time scale.
#[test]
fn what_collisions_dissipate_becomes_heat() {
    for integrator in [Integrator::VelocityVerlet, Integrator::Gear] {
        let (mut state, mut plan) = scene(Law::GNTM, integrator, 2.0);
        heated(&mut state, &mut plan, 0.0);
        heat_of(&mut plan).dissipation = Dissipation { friction: 1.0, damping: 1.0 };
        let end = after(&state, &plan, Options::default(), 800);
        let [friction, damping] = [energy_accounts::FRICTION, energy_accounts::DAMPING].map(|k| booked(&end, k));
        let made = heat_booked(&end, heat_accounts::MADE);
        assert!(friction > 1e-3 && damping > 1e-3, "{friction} {damping}");
        assert!((made / (friction + damping) - 1.0).abs() < 1e-12, "{made} {friction} {damping}");
        // Of the last step, it is under way.
        let step = plan.heat_step();
        let stored = kept(&end) + end.heat_rate.iter().sum::<f64>() * step;
        assert!((stored / made - 1.0).abs() < 1e-9, "{stored} {made}");
        assert!(Ledger::of(&end, &plan).heat.expect("there is heat").error.abs() < 1e-9 * made);

        let mut slower = plan.clone();
        heat_of(&mut slower).time_scale = 0.01;
        heat_of(&mut slower).contacts = Path::Closed;
        let same = heat_booked(&after(&state, &slower, Options::default(), 800), heat_accounts::MADE);
        assert_eq!(same.to_bits(), made.to_bits(), "heat of motion does not hang on the time scale");
    }
}

/// A sphere pushed along an insulated wall, and along one that has a temperature and takes its half.
#[test]
fn a_sphere_that_slides_along_a_wall_warms_by_the_work_of_friction() {
    for (temperature, part) in [(None, 1.0), (Some(REFERENCE), 0.5)] {
        let mut plan = plan(Law::GNT, [-1.0; 3], [1.0; 3], [false; 3]);
        plan.walls = vec![wall("floor", [0.0, 0.0, 1.0], [0.0; 3])];
        let mut state = spheres(&[([0.0, 0.0, 0.00499], 0.005)], DENSITY);
        state.wall_position = vec![[0.0; 3]];
        state.velocity[0] = [0.2, 0.0, 0.0];
        // Held at its height, it slides with a constant normal force.
        plan.constraints.push(tdem_engine::Constraint {
            velocity: [Some(0.2), Some(0.0), Some(0.0)],
            angular_velocity: [Some(0.0); 3],
            force: [0.0; 3],
        });
        state.constraint[0] = 1;
        heated(&mut state, &mut plan, 0.0);
        let heat = heat_of(&mut plan);
        heat.dissipation.friction = 1.0;
        heat.contacts = Path::Closed;
        heat.walls[0] = temperature.map(constant);
        let [early, late] = [200, 1200].map(|steps| after(&state, &plan, Options::default(), steps));
        let capacity = state.mass[0] * SPECIFIC_HEAT;
        let warmer = capacity * (late.temperature[0] - early.temperature[0]);
        let made = heat_booked(&late, heat_accounts::MADE) - heat_booked(&early, heat_accounts::MADE);
        let normal = late.force[0][2].abs();
        let way = late.position[0][0] - early.position[0][0];
        let work = 0.5 * normal * way; // the dynamic friction of the scene is 0.5
        assert!((made / (part * work) - 1.0).abs() < 1e-9, "{made} {work}");
        // A step adds 1e-7 K to 300 K.
        assert!((warmer / made - 1.0).abs() < 1e-6, "{warmer} {made}");
    }
}

/// The dashpots of bonds make heat of a vibration that dies down.
#[test]
fn a_vibration_that_dies_down_warms_the_bar() {
    let mut plan = free_space(DASHPOTS, Joint { cement: Cement { damping_ratio: 0.05, ..CEMENT }, ..JOINT });
    let mut state = chain(12, &plan);
    for i in 0..state.len() {
        state.velocity[i][0] = if i < 6 { 0.1 } else { -0.1 };
    }
    heated(&mut state, &mut plan, 0.0);
    heat_of(&mut plan).dissipation.damping = 1.0;
    plan.ledger = true;
    let begin = after(&state, &plan, Options::default(), 0);
    let end = after(&state, &plan, Options::default(), 4000);
    let lost = Ledger::of(&begin, &plan).mechanical() - Ledger::of(&end, &plan).mechanical();
    let made = heat_booked(&end, heat_accounts::MADE);
    assert!(lost > 0.5 * Ledger::of(&begin, &plan).mechanical());
    assert!((made / lost - 1.0).abs() < 1e-2, "{made} {lost}");
    assert!((made / booked(&end, energy_accounts::DAMPING) - 1.0).abs() < 1e-12);
    // Both ends of each bond got their half.
    assert!(end.temperature.iter().all(|&temperature| temperature > REFERENCE));
}

/// A bar that is held at all of its particles: what expansion puts in is all that its springs hold.
#[test]
fn expansion_of_a_held_bar_does_the_work_that_its_springs_hold() {
    let mut plan = free_space(ELASTIC, JOINT);
    plan.constraints.push(CLAMPED);
    plan.ledger = true;
    let mut state = chain(9, &plan);
    state.constraint = vec![1; 9];
    heated(&mut state, &mut plan, EXPANSION);
    heat_of(&mut plan).time_scale = 1e5;
    for i in 0..state.len() {
        state.temperature[i] = REFERENCE + 200.0 * random(5, i as u64);
        state.exposure[i] = 0;
    }
    heat_of(&mut plan).exposures.push(Exposure {
        temperature: Some(tdem_engine::Course(vec![[0.0, REFERENCE], [300.0, REFERENCE + 300.0]])),
        exchanges: Vec::new(),
    });
    state.exposure[4] = 1;
    state.follow_temperatures(&plan);
    let begin = after(&state, &plan, Options::default(), 0);
    let end = after(&state, &plan, Options::default(), 300);
    let gained = Ledger::of(&end, &plan).elastic_bonds - Ledger::of(&begin, &plan).elastic_bonds;
    let work = heat_booked(&end, heat_accounts::EXPANSION);
    assert!(gained.abs() > 0.1 * Ledger::of(&begin, &plan).elastic_bonds);
    assert!((work / gained - 1.0).abs() < 1e-9, "{work} {gained}");
}

/// A stretched bar that is held and becomes softer, and one that moves meanwhile: what temperature takes from its springs is
/// booked.
#[test]
fn the_ledger_closes_where_bonds_become_softer() {
    for (expansion, held) in [(0.0, true), (EXPANSION, false)] {
        let mut plan = free_space(ELASTIC, JOINT);
        plan.constraints.push(CLAMPED);
        plan.ledger = true;
        let mut state = chain(9, &plan);
        for i in 0..state.len() {
            state.position[i][0] *= 1.001;
            state.constraint[i] = u16::from(held || i == 0 || i == 8);
        }
        heated(&mut state, &mut plan, expansion);
        plan.bonds.as_mut().expect("the plan has bonds").tables.stiffness =
            vec![Table(vec![[REFERENCE, 1.0], [REFERENCE + 100.0, 0.8], [REFERENCE + 250.0, 0.2]])];
        heat_of(&mut plan).time_scale = 1e5;
        heat_of(&mut plan).exposures.push(Exposure {
            temperature: Some(tdem_engine::Course(vec![[0.0, REFERENCE], [600.0, REFERENCE + 300.0]])),
            exchanges: Vec::new(),
        });
        state.exposure.iter_mut().step_by(2).for_each(|exposure| *exposure = 1);
        let begin = Ledger::of(&after(&state, &plan, Options::default(), 0), &plan);
        let end = Ledger::of(&after(&state, &plan, Options::default(), 600), &plan);
        assert!(end.expansion_work.abs() > 0.1 * begin.elastic_bonds, "{end:?}");
        // At the corners of the table, a step of half a kelvin counts with the mean of both slopes.
        assert!(
            end.energy_error.abs() < 3e-3 * end.expansion_work.abs(),
            "{} of {}",
            end.energy_error,
            end.expansion_work
        );
        for options in [Width::One, Width::Portable].map(|width| Options { width, ..Options::default() }) {
            let found = Ledger::of(&after(&state, &plan, options, 600), &plan);
            assert_eq!(found.expansion_work.to_bits(), end.expansion_work.to_bits());
        }
    }
}

/// With the work of expansion the ledger of a body closes that is strained by heat and moves.
#[test]
fn the_ledger_closes_where_bodies_expand() {
    // A block between two clamped ends, heated through them.
    let mut plan = free_space(ELASTIC, JOINT);
    plan.constraints.push(CLAMPED);
    plan.ledger = true;
    let mut state = spheres(&lattice([4, 2, 2]), DENSITY);
    let far = state.position.iter().fold(0.0, |far: f64, place| far.max(place[0]));
    bond_neighbours(&mut state, &plan);
    heated(&mut state, &mut plan, EXPANSION);
    heat_of(&mut plan).time_scale = 3e4;
    heat_of(&mut plan).exposures.push(Exposure {
        temperature: Some(tdem_engine::Course(vec![[0.0, REFERENCE], [600.0, REFERENCE + 10.0]])),
        exchanges: Vec::new(),
    });
    for i in 0..state.len() {
        let end = state.position[i][0] < 1e-4 || state.position[i][0] > far - 1e-4;
        state.constraint[i] = u16::from(end);
        state.exposure[i] = u16::from(end);
    }
    check_ledger(&state, &plan, 4000, 1e-3);
    // A row of spheres between two walls, which press each other as they grow.
    let mut plan = common::plan(Law::GN, [-1.0; 3], [1.0; 3], [false; 3]);
    plan.dt = 4e-6;
    plan.walls = vec![wall("left", [1.0, 0.0, 0.0], [0.0; 3]), wall("right", [-1.0, 0.0, 0.0], [0.0; 3])];
    let row: Vec<_> = (0..5).map(|k| ([0.005 + 0.01 * f64::from(k), 0.0, 0.0], 0.005)).collect();
    let mut state = spheres(&row, DENSITY);
    state.wall_position = vec![[0.0; 3], [0.05, 0.0, 0.0]];
    heated(&mut state, &mut plan, EXPANSION);
    let heat = heat_of(&mut plan);
    heat.time_scale = 1e3;
    let warm = Exchange { flux_area: 1.0, ..NONE };
    heat.exposures.push(Exposure { temperature: None, exchanges: vec![(warm, Around::flux(constant(1.0)))] });
    state.exposure[1] = 1;
    check_ledger(&state, &plan, 20_000, 1e-2);
}

/// The ledger must close to a part of the work of expansion.
fn check_ledger(state: &State, plan: &Plan, steps: u64, part: f64) {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), Options::default()).expect("the scene is sound");
    simulation.advance(steps).expect("it runs through");
    let ledger = Ledger::of(&simulation.state().expect("a state can be taken"), plan);
    let (error, work) = (ledger.energy_error, ledger.expansion_work);
    assert!(work.abs() > 1e-9, "{work}");
    assert!(error.abs() < part * work.abs(), "{error} of {work}");
}

/// Where heat and motion take turns, what expansion does before anything moves is booked as a whole.
#[test]
fn the_ledger_closes_where_heat_and_motion_take_turns() {
    let (state, plan) = heated_block();
    let mut plan = in_turns(&plan, 10.0, 1e-4);
    plan.ledger = true;
    if let tdem_engine::Motion::QuasiStatic(relaxation) = &mut heat_of(&mut plan).motion {
        (relaxation.dt, relaxation.at_most_steps) = (2e-6, 200_000);
    }
    check_ledger(&state, &plan, 3, 0.02);
}

#[test]
fn heat_of_motion_needs_a_ledger_and_motion_of_its_own() {
    let refused = |plan: &Plan, state: &State| {
        let found = Simulation::new(state.clone(), plan.clone(), Options::default()).err();
        matches!(found, Some(Fault::Inconsistent { .. }))
    };
    let (state, mut plan) = warm_cloud();
    keep_books(&mut plan, true);
    assert!(!refused(&plan, &state));
    plan.ledger = false;
    assert!(refused(&plan, &state), "no ledger");
    keep_books(&mut plan, true);
    for wrong in [-0.1, 1.1, f64::NAN] {
        heat_of(&mut plan).dissipation.friction = wrong;
        assert!(refused(&plan, &state), "{wrong}");
    }
    let (state, plan) = warm_block(ELASTIC, Integrator::VelocityVerlet, EXPANSION);
    let mut plan = in_turns(&plan, 10.0, 1e-3);
    keep_books(&mut plan, true);
    assert!(refused(&plan, &state), "in turns");
}
