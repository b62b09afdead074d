//! Heat that advances by itself, alone and in turns with the motion.

mod common;

use common::bonded::{CLAMPED, ELASTIC, JOINT, RADIUS, chain, cracking_block, free_space};
use common::heated::{
    EXPANSION, NONE, REFERENCE, SPECIFIC_HEAT, after, constant, frozen, furnace, heat_of, heated, heated_block,
    held_chain, in_turns, temper, warm_cloud,
};
use common::random;
use tdem_engine::cpu::Options;
use tdem_engine::physics::heat::Exchange;
use tdem_engine::physics::heat::surface::{STEFAN_BOLTZMANN, surface_conductance};
use tdem_engine::{
    Around, Course, Exposure, Fault, Integrator, Ledger, Motion, Plan, Relaxation, Scheme, Simulation, State,
    heat_accounts,
};

fn threads(threads: usize) -> Options {
    Options { threads: Some(threads), ..Options::default() }
}

/// Heat in all particles, J.
fn content(state: &State) -> f64 {
    (0..state.len()).map(|i| state.mass[i] * SPECIFIC_HEAT * state.temperature[i]).sum()
}

fn sums(state: &State) -> [f64; 2] {
    [heat_accounts::IN, heat_accounts::OUT]
        .map(|column| state.heat_accounts.iter().map(|account| account[column]).sum::<f64>())
}

fn held(value: f64) -> Exposure {
    Exposure { temperature: Some(constant(value)), exchanges: Vec::new() }
}

/// Bonded and loose particles of several temperatures and exposures, also prescribed ones, which touch each other and a wall
/// that is warm, all held in place; bonds broken here and there.
fn still_block() -> (State, Plan) {
    let (mut state, mut plan) = cracking_block(ELASTIC, Integrator::VelocityVerlet);
    for step in 0..3 {
        state = after(&state, &plan, Options::default(), 100);
        assert_eq!(state.step, 100 * (step + 1));
    }
    heated(&mut state, &mut plan, 0.0);
    state.step = 0;
    for bond in &mut state.bonds {
        // Those that broke did so before this run.
        bond.breakage = None;
    }
    for k in (0..state.bonds.len()).step_by(7).rev() {
        state.bonds.remove(k);
    }
    state.velocity.fill([0.0; 3]);
    state.angular_velocity.fill([0.0; 3]);
    state.forces_known = false;
    plan.constraints = vec![tdem_engine::Constraint::FREE, CLAMPED];
    state.constraint.fill(1);
    plan.gravity = [0.0; 3];
    for joint in plan.bonds.iter_mut().flat_map(|bonds| &mut bonds.joints).flatten() {
        (joint.cement.tensile_strength, joint.cement.shear_strength) = (f64::INFINITY, f64::INFINITY);
    }
    let warm = Exchange { flux_area: 2e-5, ..NONE };
    let glow = Exchange { conductance: 1e-3, radiation: 5e-12, resistance: 30.0, ..NONE };
    let heat = heat_of(&mut plan);
    heat.walls[0] = Some(Course(vec![[0.0, 300.0], [100.0, 900.0]]));
    heat.exposures.push(Exposure {
        temperature: None,
        exchanges: vec![
            (warm, Around::flux(Course(vec![[0.0, 1e5], [100.0, 4e5]]))),
            (glow, furnace(Course(vec![[0.0, 900.0], [50.0, 600.0]]))),
        ],
    });
    heat.exposures
        .push(Exposure { temperature: Some(Course(vec![[0.0, 300.0], [80.0, 500.0]])), exchanges: Vec::new() });
    for i in 0..state.len() {
        state.temperature[i] = 300.0 + 200.0 * random(12, i as u64);
        state.exposure[i] = [0, 0, 1, 0, 2, 0, 0, 1][i % 8];
    }
    (state, plan)
}

/// The same, where everything depends on temperature.
fn tempered_block() -> (State, Plan) {
    let (state, mut plan) = still_block();
    temper(&mut plan);
    (state, plan)
}

#[test]
fn heat_alone_has_the_bits_of_a_run_in_which_nothing_moves() {
    for (state, plan) in [still_block(), tempered_block()] {
        has_the_bits_of_a_run_in_which_nothing_moves(&state, plan);
    }
}

fn has_the_bits_of_a_run_in_which_nothing_moves(state: &State, mut plan: Plan) {
    heat_of(&mut plan).time_scale = 1e5;
    let begin = after(state, &plan, Options::default(), 0);
    let (contacts, at_walls) = (begin.contacts.len(), begin.wall_contacts.len());
    assert!(contacts > 20 && at_walls > 5 && state.bonds.len() > 300, "{contacts} {at_walls}");
    let alone = frozen(&plan, Scheme::Explicit, plan.heat_step());
    for steps in [0, 1, 60] {
        let expected = after(state, &plan, Options::default(), steps);
        let found = after(state, &alone, Options::default(), steps);
        // Contacts slide to their cones and quaternions are normed where steps are taken, though nothing moves.
        assert!(found.temperature == expected.temperature && found.heat_rate == expected.heat_rate, "{steps}");
        assert!(found.position == state.position && expected.position == state.position, "{steps}");
        assert!(steps == 0 || found.temperature[0] != state.temperature[0]);
    }
}

#[test]
fn bits_depend_neither_on_threads_nor_on_interruptions() {
    let schemes = [Scheme::Explicit, Scheme::Implicit];
    for (scheme, (state, plan)) in
        schemes.into_iter().flat_map(|scheme| [(scheme, still_block()), (scheme, tempered_block())])
    {
        let plan = frozen(&plan, scheme, 3.0);
        let expected = after(&state, &plan, threads(1), 20);
        for count in [2, 7] {
            assert_eq!(after(&state, &plan, threads(count), 20).hash(), expected.hash(), "{scheme:?}, {count} threads");
        }
        for interruption in [1, 13] {
            let first = after(&state, &plan, Options::default(), interruption);
            let second = after(&first, &plan, Options::default(), 20 - interruption);
            assert_eq!(second.hash(), expected.hash(), "{scheme:?}, {interruption}");
        }
    }
}

#[test]
fn what_comes_in_stays_or_goes_out() {
    let (state, plan) = still_block();
    for (scheme, step) in
        [(Scheme::Explicit, 1.0), (Scheme::Explicit, 30.0), (Scheme::Implicit, 1.0), (Scheme::Implicit, 500.0)]
    {
        let plan = frozen(&plan, scheme, step);
        let end = after(&state, &plan, Options::default(), 25);
        let [came, left] = sums(&end);
        let stored = content(&end) - content(&state);
        assert!(came > 0.1 * content(&state) && left > 0.0, "{came} {left}");
        let error = stored - (came - left);
        assert!(error.abs() < 1e-12 * content(&end).max(came), "{scheme:?}, {step} s: {error} of {came}");
        let ledger = Ledger::of(&end, &plan).heat.expect("the plan has heat");
        assert!((ledger.stored / stored - 1.0).abs() < 1e-10 && ledger.error.abs() < 1e-10 * came, "{ledger:?}");
    }
}

#[test]
fn what_comes_in_stays_or_goes_out_where_specific_heats_depend_on_temperature() {
    let (state, plan) = tempered_block();
    for (scheme, step) in [(Scheme::Explicit, 30.0), (Scheme::Implicit, 1.0), (Scheme::Implicit, 50.0)] {
        let plan = frozen(&plan, scheme, step);
        let end = after(&state, &plan, Options::default(), 25);
        let ledger = Ledger::of(&end, &plan).heat.expect("the plan has heat");
        assert!(ledger.came_in > 0.05 * content(&state) && ledger.went_out > 0.0, "{ledger:?}");
        assert!(ledger.error.abs() < 1e-11 * ledger.came_in, "{scheme:?}, {step} s: {ledger:?}");
    }
}

/// A body that is heated through a film, its conductivity and specific heat by tables: the implicit scheme takes both at the
/// beginning of a step.
#[test]
fn the_implicit_scheme_is_of_first_order_where_materials_depend_on_temperature() {
    let (mut state, mut plan, _) = held_chain(6);
    temper(&mut plan);
    let film = Exchange { conductance: 2e-3, ..NONE };
    heat_of(&mut plan)
        .exposures
        .push(Exposure { temperature: None, exchanges: vec![(film, Around::fluid(constant(700.0)))] });
    state.exposure[0] = 1;
    let end = |scheme, steps: u64| {
        let plan = frozen(&plan, scheme, 2000.0 / steps as f64);
        after(&state, &plan, Options::default(), steps).temperature[5]
    };
    let exact = end(Scheme::Explicit, 40_000);
    let off = [200, 400].map(|steps| end(Scheme::Implicit, steps) - exact);
    assert!(exact > REFERENCE + 50.0 && exact < 690.0, "{exact}");
    assert!((off[0] / off[1] - 2.0).abs() < 0.1, "{off:?}");
}

#[test]
fn a_long_explicit_step_is_taken_in_parts() {
    let (mut state, plan, conductance) = held_chain(2);
    state.temperature = vec![400.0, 300.0];
    let longest = state.mass[0] * SPECIFIC_HEAT / conductance;
    // 2.5 times as long as one of them: three parts.
    let plan = frozen(&plan, Scheme::Explicit, 2.5 * longest);
    let mut simulation = Simulation::new(state, plan, Options::default()).expect("the scene is sound");
    simulation.advance(2).expect("the scene runs through");
    assert_eq!(simulation.turns().expect("heat advances by itself").passes, 6);
    let end = simulation.state().expect("a state can be taken");
    let factor = 1.0 - 2.0 * 2.5 / 3.0;
    let expected = 100.0 * (0..6).fold(1.0, |decay, _| decay * factor);
    let found = end.temperature[0] - end.temperature[1];
    assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
}

/// The mode cos(pi (j + 1/2) / 20) of an insulated chain of 20, and 4 sin^2(pi / 40).
fn mode() -> (Vec<f64>, f64) {
    let (step, half) = (0.987_688_340_595_137_8, 0.996_917_333_733_128);
    let mut mode = vec![half, half * (2.0 * step - 1.0)];
    (2..20).for_each(|j| mode.push(2.0 * step * mode[j - 1] - mode[j - 2]));
    (mode, 2.0 * (1.0 - step))
}

#[test]
fn the_implicit_scheme_follows_a_mode_and_is_right_to_first_order() {
    let (mut state, plan, conductance) = held_chain(20);
    let (mode, eigenvalue) = mode();
    state.temperature = mode.iter().map(|mode| 350.0 + 40.0 * mode).collect();
    let rate = conductance / (state.mass[0] * SPECIFIC_HEAT) * eigenvalue;
    let duration = 1.0 / rate;
    let exact = (-1.0_f64).exp_m1() + 1.0;
    let mut errors = Vec::new();
    for steps in [10_u32, 20, 40] {
        let step = duration / f64::from(steps);
        let end = after(&state, &frozen(&plan, Scheme::Implicit, step), Options::default(), steps.into());
        // Backward Euler's own decay, particle by particle.
        let decay = (0..steps).fold(1.0, |decay, _| decay / (1.0 + step * rate));
        for j in 0..20 {
            let expected = 350.0 + 40.0 * mode[j] * decay;
            assert!((end.temperature[j] - expected).abs() < 1e-8, "{j}: {} {expected}", end.temperature[j]);
        }
        let found = (end.temperature[0] - 350.0) / (40.0 * mode[0]);
        errors.push((found - exact).abs());
    }
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.06, "{order} of {errors:?}");
    }
}

#[test]
fn a_thousand_times_the_explicit_limit_is_stable_and_ends_in_a_straight_line() {
    let (mut state, mut plan, conductance) = held_chain(40);
    heat_of(&mut plan).exposures.extend([held(400.0), held(300.0)]);
    (state.exposure[0], state.exposure[39]) = (1, 2);
    let limit = state.mass[0] * SPECIFIC_HEAT / (2.0 * conductance);
    let plan = frozen(&plan, Scheme::Implicit, 1000.0 * limit);
    let mut simulation = Simulation::new(state, plan, Options::default()).expect("the scene is sound");
    let mut last = 293.15;
    for _ in 0..20 {
        simulation.advance(1).expect("the scene runs through");
        let state = simulation.state().expect("a state can be taken");
        // From below, without swinging over.
        assert!(state.temperature[20] > last - 1e-8 && state.temperature[20] < 351.0, "{}", state.temperature[20]);
        last = state.temperature[20];
    }
    let end = simulation.state().expect("a state can be taken");
    for j in 0..40 {
        let expected = 400.0 - 100.0 * j as f64 / 39.0;
        assert!((end.temperature[j] / expected - 1.0).abs() < 1e-10, "{j}: {} {expected}", end.temperature[j]);
    }
}

#[test]
fn a_glowing_lump_cools_as_it_should() {
    let (mut state, mut plan, _) = held_chain(1);
    let (area, emissivity) = (3e-4, 0.9);
    let exchange = Exchange { radiation: emissivity * STEFAN_BOLTZMANN * area, ..NONE };
    heat_of(&mut plan)
        .exposures
        .push(Exposure { temperature: None, exchanges: vec![(exchange, Around::surroundings(constant(1e-3)))] });
    (state.exposure[0], state.temperature[0]) = (1, 1200.0);
    let capacity = state.mass[0] * SPECIFIC_HEAT;
    // Into the cold: T^-3 grows by 3 eps sigma A t / C.
    let factor = 3.0 * emissivity * STEFAN_BOLTZMANN * area / capacity;
    let cube = |t: f64| t * t * t;
    let duration = (1.0 / cube(600.0) - 1.0 / cube(1200.0)) / factor;
    for scheme in [Scheme::Explicit, Scheme::Implicit] {
        let error = |steps: u32| {
            let plan = frozen(&plan, scheme, duration / f64::from(steps));
            (after(&state, &plan, Options::default(), steps.into()).temperature[0] - 600.0).abs()
        };
        let [coarse, fine] = [200, 400].map(error);
        assert!(fine < 1.5 && (coarse / fine - 2.0).abs() < 0.1, "{scheme:?}: {coarse} {fine}");
    }
}

#[test]
fn outside_values_that_change_evenly_are_followed_without_lag() {
    // One particle behind a film whose outside becomes warmer by 2 K/s lags by 2 C/G, not more for long steps.
    let (mut state, mut plan, _) = held_chain(1);
    let film = surface_conductance(1e-4, 0.0, 1.5, 10.0);
    let ramp = |start: f64| Course(vec![[0.0, start], [1e6, start + 2e6]]);
    let exchange = Exchange { conductance: film, ..NONE };
    heat_of(&mut plan)
        .exposures
        .push(Exposure { temperature: None, exchanges: vec![(exchange, Around::fluid(ramp(4000.0)))] });
    let lag = 2.0 * state.mass[0] * SPECIFIC_HEAT / film;
    (state.exposure[0], state.temperature[0]) = (1, 4000.0 - lag);
    let step = state.mass[0] * SPECIFIC_HEAT / film * 20.0;
    let implicit = frozen(&plan, Scheme::Implicit, step);
    let end = after(&state, &implicit, Options::default(), 10);
    let expected = 4000.0 - lag + 2.0 * implicit.heat_time(10);
    assert!(lag > 100.0 && (end.temperature[0] / expected - 1.0).abs() < 1e-11, "{} {expected}", end.temperature[0]);

    // A flux that grows evenly brings its integral, in one step as well.
    let exchange = Exchange { flux_area: 1e-4, ..NONE };
    heat_of(&mut plan).exposures[1].exchanges = vec![(exchange, Around::flux(Course(vec![[0.0, 0.0], [1e3, 1e4]])))];
    state.temperature[0] = 300.0;
    let end = after(&state, &frozen(&plan, Scheme::Implicit, 100.0), Options::default(), 3);
    let expected = 300.0 + 1e-4 * 0.5 * 10.0 * 300.0 * 300.0 / (state.mass[0] * SPECIFIC_HEAT);
    assert!((end.temperature[0] / expected - 1.0).abs() < 1e-12, "{} {expected}", end.temperature[0]);
}

#[test]
fn a_prescribed_temperature_follows_its_course_and_books_what_it_takes() {
    let (mut state, mut plan, conductance) = held_chain(3);
    let course = Course(vec![[0.0, 300.0], [400.0, 500.0]]);
    heat_of(&mut plan).exposures.push(Exposure { temperature: Some(course), exchanges: Vec::new() });
    state.exposure[0] = 1;
    state.temperature.fill(300.0);
    let limit = state.mass[0] * SPECIFIC_HEAT / (2.0 * conductance);
    for (scheme, step) in [(Scheme::Explicit, 10.0 * limit), (Scheme::Implicit, 10.0 * limit)] {
        let plan = frozen(&plan, scheme, step);
        let end = after(&state, &plan, Options::default(), 3);
        let expected = 300.0 + 0.5 * (3.0 * step).min(400.0);
        assert!((end.temperature[0] - expected).abs() < 1e-10, "{scheme:?}: {} {expected}", end.temperature[0]);
        let [came, left] = sums(&end);
        let error = content(&end) - content(&state) - (came - left);
        assert!(error.abs() < 1e-12 * content(&end) && came > 0.0, "{scheme:?}: {error} of {came}");
    }
}

#[test]
fn a_cloud_of_contacts_and_warm_walls_is_the_same_whatever_the_threads() {
    let (mut state, mut plan) = warm_cloud();
    plan.gravity = [0.0; 3];
    let moved = after(&state, &plan, Options::default(), 400);
    // Where nothing moves, nothing expands.
    let (reference_radius, heat_accounts, work_per_kelvin) = (Vec::new(), Vec::new(), Vec::new());
    state = State { reference_radius, heat_accounts, work_per_kelvin, step: 0, ..moved };
    for thermal in &mut heat_of(&mut plan).materials {
        thermal.expansion = 0.0;
    }
    assert!(state.contacts.len() > 100 && state.wall_contacts.len() > 20);
    let plan = frozen(&plan, Scheme::Implicit, 60.0);
    let expected = after(&state, &plan, threads(1), 5);
    assert_eq!(after(&state, &plan, threads(3), 5).hash(), expected.hash());
    assert_eq!(expected.position, state.position);
    let error = {
        let [came, left] = sums(&expected);
        content(&expected) - content(&state) - (came - left)
    };
    assert!(error.abs() < 1e-12 * content(&expected), "{error}");
}

#[test]
fn what_means_nothing_is_refused() {
    let (state, plan, _) = held_chain(3);
    let refused = |plan: &Plan| {
        matches!(Simulation::new(state.clone(), plan.clone(), Options::default()), Err(Fault::Inconsistent { .. }))
    };
    let sound = frozen(&plan, Scheme::Implicit, 1.0);
    assert!(!refused(&sound));
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(&Plan { dt, ..sound.clone() }), "{dt}");
    }
    let mut other = sound.clone();
    heat_of(&mut other).time_scale = 2.0;
    assert!(refused(&other));

    let relaxation =
        Relaxation { scheme: Scheme::Implicit, dt: 1e-5, ratio: 1e-3, at_most_steps: 100, check_every: 10 };
    let turns = |relaxation: Relaxation| {
        let mut plan = sound.clone();
        heat_of(&mut plan).motion = Motion::QuasiStatic(relaxation);
        plan
    };
    assert!(!refused(&turns(relaxation)));
    for wrong in [
        Relaxation { dt: 0.0, ..relaxation },
        Relaxation { ratio: 0.0, ..relaxation },
        Relaxation { ratio: f64::NAN, ..relaxation },
        Relaxation { at_most_steps: 0, ..relaxation },
        Relaxation { check_every: 0, ..relaxation },
    ] {
        assert!(refused(&turns(wrong)), "{wrong:?}");
    }
    let mut driven = turns(relaxation);
    driven.constraints[1].velocity[0] = Some(1.0);
    assert!(refused(&driven));
}

#[test]
fn temperatures_below_zero_are_a_fault_of_the_step() {
    let (mut state, mut plan, _) = held_chain(1);
    let exchange = Exchange { flux_area: 1.0, ..NONE };
    heat_of(&mut plan)
        .exposures
        .push(Exposure { temperature: None, exchanges: vec![(exchange, Around::flux(constant(-1e4)))] });
    state.exposure[0] = 1;
    for scheme in [Scheme::Explicit, Scheme::Implicit] {
        let plan = frozen(&plan, scheme, 1.0);
        let mut simulation = Simulation::new(state.clone(), plan, Options::default()).expect("the scene is sound");
        assert!(matches!(simulation.advance(5), Err(Fault::Temperature { particle: 0, step: 1, .. })));
    }
}

/// A chain that expands, of which constraints are given, between a warm and a cold end.
fn expanding_chain(count: usize, constraint: &[u16]) -> (State, Plan) {
    let mut plan = free_space(ELASTIC, JOINT);
    plan.constraints.push(CLAMPED);
    let mut state = chain(count, &plan);
    for (of_particle, &given) in state.constraint.iter_mut().zip(constraint) {
        *of_particle = given;
    }
    heated(&mut state, &mut plan, EXPANSION);
    heat_of(&mut plan).exposures.extend([held(REFERENCE + 300.0), held(REFERENCE + 20.0)]);
    (state.exposure[0], state.exposure[count - 1]) = (1, 2);
    (state, plan)
}

/// Tension of all bonds, N.
fn tensions(state: &State, plan: &Plan) -> Vec<f64> {
    let bond = |k| state.evaluate_bond(plan, k).expect("the bond holds").reaction.load.normal;
    (0..state.bonds.len()).map(bond).collect()
}

#[test]
fn a_restrained_bar_bears_what_its_expansion_would_be() {
    let count = 12;
    let (state, plan) = expanding_chain(count, &[1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
    let ratio = 1e-5;
    let plan = in_turns(&plan, 2000.0, ratio);
    let mut simulation = Simulation::new(state, plan.clone(), Options::default()).expect("the scene is sound");
    simulation.advance(8).expect("the scene runs through");
    let turns = simulation.turns().expect("heat and motion take turns");
    assert!(turns.unrelaxed == 0 && turns.motion_steps >= 8 * 50, "{turns:?}");
    let end = simulation.state().expect("a state can be taken");
    // A force that is the same everywhere: -K alpha L times the mean warmth of the bonds.
    let warmth = |k: usize| 0.5 * (end.temperature[k] + end.temperature[k + 1]) - REFERENCE;
    let mean = (0..count - 1).map(warmth).sum::<f64>() / (count - 1) as f64;
    let stiffness = JOINT.stiffness_per_area * std::f64::consts::PI * RADIUS * RADIUS;
    let expected = -stiffness * EXPANSION * mean * 2.0 * RADIUS;
    assert!(mean > 100.0);
    for tension in tensions(&end, &plan) {
        assert!((tension / expected - 1.0).abs() < 12.0 * ratio, "{tension} {expected}");
    }
    assert!(Ledger::of(&end, &plan).unbalanced_force_ratio <= ratio);
    // Where it is warmer, it has expanded at the cost of what is colder.
    assert!(end.position[5][0] > 10.0 * RADIUS + 1e-5);
    assert!(end.radius[1] > end.radius[10] && end.radius[10] > RADIUS);
}

#[test]
fn a_free_bar_expands_and_is_free_of_stress() {
    let count = 12;
    let (state, plan) = expanding_chain(count, &[1]);
    let ratio = 1e-4;
    let plan = in_turns(&plan, 2000.0, ratio);
    let mut simulation = Simulation::new(state, plan.clone(), Options::default()).expect("the scene is sound");
    simulation.advance(8).expect("the scene runs through");
    assert_eq!(simulation.turns().expect("heat and motion take turns").unrelaxed, 0);
    let end = simulation.state().expect("a state can be taken");
    let strain = |k: usize| EXPANSION * (0.5 * (end.temperature[k] + end.temperature[k + 1]) - REFERENCE);
    let growth: f64 = (0..count - 1).map(|k| strain(k) * 2.0 * RADIUS).sum();
    let found = end.position[count - 1][0] - 2.0 * RADIUS * (count - 1) as f64;
    assert!((found / growth - 1.0).abs() < 1e-4, "{found} {growth}");
    let stiffness = JOINT.stiffness_per_area * std::f64::consts::PI * RADIUS * RADIUS;
    let blocked = stiffness * EXPANSION * 2.0 * RADIUS;
    for tension in tensions(&end, &plan) {
        // Against what 1 K would do to a bond that is held.
        assert!(tension.abs() < 12.0 * ratio * blocked, "{tension} {blocked}");
    }
}

#[test]
fn cracks_do_not_depend_on_threads_or_interruptions() {
    let (state, plan) = heated_block();
    for scheme in [Scheme::Implicit, Scheme::Explicit] {
        let mut plan = in_turns(&plan, 25.0, 1e-3);
        if let Motion::QuasiStatic(relaxation) = &mut heat_of(&mut plan).motion {
            relaxation.scheme = scheme;
        }
        let steps = 10;
        let expected = after(&state, &plan, threads(1), steps);
        let broken: Vec<u64> = expected.bonds.iter().filter_map(|bond| bond.breakage).map(|b| b.step).collect();
        assert!(broken.len() > 5 && 2 * broken.len() < expected.bonds.len(), "{} broke", broken.len());
        // In several of the steps of the heat.
        assert!(broken.iter().all(|&step| (1..=steps).contains(&step)) && broken.iter().any(|&step| step != broken[0]));
        assert_eq!(after(&state, &plan, threads(2), steps).hash(), expected.hash(), "{scheme:?}");
        let half = after(&state, &plan, threads(2), 6);
        assert_eq!(after(&half, &plan, threads(2), steps - 6).hash(), expected.hash(), "{scheme:?}, in two parts");
        // What broke conducts nothing; heat is kept.
        let [came, left] = sums(&expected);
        let error = content(&expected) - content(&state) - (came - left);
        assert!(came > 1.0 && error.abs() < 1e-12 * content(&expected), "{scheme:?}: {error} of {came}");
    }
}

#[test]
fn what_does_not_come_to_rest_is_counted() {
    let (state, plan) = expanding_chain(12, &[1]);
    let mut plan = in_turns(&plan, 2000.0, 1e-9);
    if let Motion::QuasiStatic(relaxation) = &mut heat_of(&mut plan).motion {
        relaxation.at_most_steps = 70;
    }
    let mut simulation = Simulation::new(state, plan, Options::default()).expect("the scene is sound");
    simulation.advance(3).expect("the scene runs through");
    let turns = simulation.turns().expect("heat and motion take turns");
    assert_eq!((turns.unrelaxed, turns.last_unrelaxed, turns.motion_steps), (3, 3, 3 * 70));
    assert!(turns.largest_ratio > 1e-9, "{turns:?}");
}

#[test]
fn faults_of_the_motion_are_told_with_the_step_of_the_heat() {
    let (state, mut plan) = expanding_chain(12, &[1]);
    plan.domain.max[0] = 22.01 * RADIUS;
    let plan = in_turns(&plan, 2000.0, 1e-3);
    let mut simulation = Simulation::new(state, plan.clone(), Options::default()).expect("the scene is sound");
    match simulation.advance(8) {
        Err(Fault::Escaped { step, time, particle: 11, .. }) => assert!(step <= 8 && time == plan.time(step)),
        other => panic!("{other:?}"),
    }
}
