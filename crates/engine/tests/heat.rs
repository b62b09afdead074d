//! Heat through contacts, bonds, walls and surfaces, and what it does to lengths.

mod common;

use common::bonded::{CLAMPED, ELASTIC, JOINT, RADIUS, bond_neighbours, free_space, lattice};
use common::heated::{
    EXPANSION, REFERENCE, SPECIFIC_HEAT, after, constant, frozen, heat_of, heated, heated_block, held_chain,
    keep_books, temper, warm_block, warm_cloud,
};
use common::{DENSITY, spheres};
use tdem_engine::cpu::{List, Options, Width};
use tdem_engine::physics::bond;
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::heat::surface::surface_conductance;
use tdem_engine::physics::heat::{Exchange, Path};
use tdem_engine::{
    Around, BondTables, Constraint, Course, Exposure, Fault, Integrator, Ledger, Plan, Scheme, Simulation, State,
    Table, heat_accounts,
};

/// Heat in all particles, with what is under way into the next step, J.
fn stored(state: &State, plan: &Plan) -> f64 {
    (0..state.len())
        .map(|i| state.mass[i] * SPECIFIC_HEAT * state.temperature[i] + state.heat_rate[i] * plan.heat_step())
        .sum()
}

#[test]
fn two_particles_meet_as_euler_says() {
    let (mut state, plan, conductance) = held_chain(2);
    state.temperature = vec![400.0, 300.0];
    let capacity = state.mass[0] * SPECIFIC_HEAT;
    let end = after(&state, &plan, Options::default(), 50);
    let factor = 1.0 - plan.heat_step() * conductance * 2.0 / capacity;
    let expected = 100.0 * (0..50).fold(1.0, |decay, _| decay * factor);
    let found = end.temperature[0] - end.temperature[1];
    assert!(expected > 1.0 && expected < 99.0, "{expected}");
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}

#[test]
fn an_insulated_chain_follows_its_mode() {
    let (mut state, plan, conductance) = held_chain(20);
    // cos(pi / 20) and cos(pi / 40); the mode is cos(pi (j + 1/2) / 20).
    let (step, half) = (0.987_688_340_595_137_8, 0.996_917_333_733_128);
    let mut mode = vec![half, half * (2.0 * step - 1.0)];
    (2..20).for_each(|j| mode.push(2.0 * step * mode[j - 1] - mode[j - 2]));
    state.temperature = mode.iter().map(|mode| 350.0 + 40.0 * mode).collect();
    let end = after(&state, &plan, Options::default(), 200);
    let number = plan.heat_step() * conductance / (state.mass[0] * SPECIFIC_HEAT);
    // 4 sin^2(pi / 40) = 2 (1 - cos(pi / 20)).
    let decay = (0..200).fold(1.0, |decay, _| decay * (1.0 - number * 2.0 * (1.0 - step)));
    assert!(decay < 0.95);
    for j in 0..20 {
        let expected = 350.0 + 40.0 * mode[j] * decay;
        assert!((end.temperature[j] - expected).abs() < 1e-10, "{j}: {} {expected}", end.temperature[j]);
    }
}

#[test]
fn prescribed_ends_give_a_straight_line_and_what_goes_in_comes_out() {
    let (mut state, mut plan, conductance) = held_chain(6);
    let held = |value| Exposure { temperature: Some(constant(value)), exchanges: Vec::new() };
    heat_of(&mut plan).exposures.extend([held(400.0), held(300.0)]);
    (state.exposure[0], state.exposure[5]) = (1, 2);
    plan.ledger = true;
    let end = after(&state, &plan, Options::default(), 20_000);
    for j in 0..6 {
        assert!((end.temperature[j] - (400.0 - 20.0 * j as f64)).abs() < 1e-8, "{j}: {}", end.temperature[j]);
    }
    let later = after(&end, &plan, Options::default(), 100);
    let came = |state: &State, column: usize| state.heat_accounts.iter().map(|account| account[column]).sum::<f64>();
    let expected = 100.0 * plan.heat_step() * conductance * 20.0;
    for column in [heat_accounts::IN, heat_accounts::OUT] {
        let through = came(&later, column) - came(&end, column);
        assert!((through / expected - 1.0).abs() < 1e-8, "{through} {expected}");
    }
}

#[test]
fn open_sides_conduct_like_the_inside() {
    let (mut state, mut plan) = heated_block();
    let heat = heat_of(&mut plan);
    heat.materials[0].expansion = 0.0;
    heat.materials[1] = heat.materials[0];
    state.reference_radius.clear();
    let conductor = heat.conductors[0];
    heat.conductors.fill(conductor);
    heat.exposures = vec![Exposure::default(); 16];
    heat.sides = (0..16).collect();
    let n = state.len();
    let ends = [0, 1, 2].map(|k| {
        let places = || state.position.iter().map(|place| place[k]);
        [places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max)]
    });
    let near = |place: f64, end: f64| (place - end).abs() < 0.1 * RADIUS;
    let at = |i: usize| {
        let place = state.position[i];
        [0, 1].map(|k| ends[k].map(|end| near(place[k], end)))
    };
    let bits = |i: usize| at(i).as_flattened().iter().rev().fold(0, |bits, &there| 2 * bits + u16::from(there));
    let exposure: Vec<u16> = (0..n).map(bits).collect();
    // Where T grows with the square of the height, all that have neighbours above and below gain alike.
    let warmth = |i: usize| {
        10.0 * ((state.position[i][2] - ends[2][0]) / RADIUS) * ((state.position[i][2] - ends[2][0]) / RADIUS)
    };
    let temperature: Vec<f64> = (0..n).map(|i| REFERENCE + warmth(i)).collect();
    let kind = |i: usize| match (ends[2].iter().any(|&end| near(state.position[i][2], end)), exposure[i].count_ones()) {
        (true, _) => None,
        (false, sides) => Some(sides as usize),
    };
    let kinds: Vec<Option<usize>> = (0..n).map(kind).collect();
    (state.temperature, state.exposure) = (temperature, exposure);
    let moving = after(&state, &plan, Options::default(), 0);
    let mut plan = frozen(&plan, Scheme::Explicit, 1.0);
    heat_of(&mut plan).materials.iter_mut().for_each(|material| material.expansion = 0.0);
    state.reference_radius.clear();
    let frozen = after(&state, &plan, Options::default(), 0);
    for end in [moving, frozen] {
        let rates =
            |sides: usize| (0..n).filter(|&i| kinds[i] == Some(sides)).map(|i| end.heat_rate[i]).collect::<Vec<_>>();
        let inside = rates(0)[0];
        assert!(inside > 0.0 && rates(1).len() > 10 && !rates(2).is_empty());
        for (sides, part) in [(0, 1.0), (1, 1.0), (2, 0.75)] {
            assert!(
                rates(sides).iter().all(|rate| (rate / inside / part - 1.0).abs() < 1e-9),
                "{sides}: {:?}",
                rates(sides)
            );
        }
    }
}

#[test]
fn a_lump_cools_through_its_surface() {
    let (mut state, mut plan, _) = held_chain(1);
    let conductance = surface_conductance(1e-4, 0.0, 1.5, 10.0);
    let exchange = Exchange { flux_area: 0.0, conductance, radiation: 0.0, resistance: 0.0 };
    heat_of(&mut plan)
        .exposures
        .push(Exposure { temperature: None, exchanges: vec![(exchange, Around::fluid(constant(300.0)))] });
    (state.exposure[0], state.temperature[0]) = (1, 500.0);
    let end = after(&state, &plan, Options::default(), 1000);
    let factor = 1.0 - plan.heat_step() * conductance / (state.mass[0] * SPECIFIC_HEAT);
    let expected = 300.0 + 200.0 * (0..1000).fold(1.0, |decay, _| decay * factor);
    assert!((end.temperature[0] - expected).abs() < 1e-9 && expected < 495.0, "{} {expected}", end.temperature[0]);
}

#[test]
fn a_block_that_expands_freely_is_free_of_stress() {
    let mut plan = free_space(ELASTIC, JOINT);
    let mut state = spheres(&lattice([3, 2, 2]), DENSITY);
    bond_neighbours(&mut state, &plan);
    heated(&mut state, &mut plan, EXPANSION);
    let (warmth, grown) = (500.0, 1.0 + EXPANSION * 500.0);
    state.temperature.fill(REFERENCE + warmth);
    state.radius.iter_mut().for_each(|radius| *radius *= grown);
    state.position.iter_mut().flatten().for_each(|x| *x *= grown);
    let end = after(&state, &plan, Options::default(), 10);
    // Against what a bond would bear that is not let grow.
    let area = std::f64::consts::PI * RADIUS * RADIUS;
    let clamped = 7.5e8 * area * EXPANSION * warmth * 2.0 * RADIUS;
    for force in end.force.iter().flatten() {
        assert!(force.abs() < 1e-9 * clamped, "{force} of {clamped}");
    }
    let mut cold = state.clone();
    cold.position.iter_mut().flatten().for_each(|x| *x /= grown);
    let pressed = after(&cold, &plan, Options::default(), 0);
    let largest = pressed.force.iter().flatten().fold(0.0, |largest: f64, force| largest.max(force.abs()));
    assert!(largest > 0.5 * clamped, "{largest} of {clamped}");
}

fn all_options() -> Vec<Options> {
    let lists = [List::Half, List::Full];
    Width::ALL
        .into_iter()
        .flat_map(|width| lists.map(|list| (width, list)))
        .zip([1, 2, 3].into_iter().cycle())
        .map(|((width, list), threads)| Options { threads: Some(threads), width, list, ..Options::default() })
        .collect()
}

#[test]
fn bits_do_not_depend_on_how_heat_is_computed() {
    let block = || warm_block(ELASTIC, Integrator::VelocityVerlet, EXPANSION);
    let tempered = |(state, mut plan): (State, Plan)| {
        temper(&mut plan);
        (state, plan)
    };
    let beside = |(state, mut plan): (State, Plan)| {
        plan.bonds.as_mut().expect("the plan has bonds").contact_in_bonded_pairs = true;
        (state, plan)
    };
    let scenes = [
        ("cloud", 400, warm_cloud()),
        ("block", 400, block()),
        ("cloud with tables", 200, tempered(warm_cloud())),
        ("block with tables", 400, tempered(block())),
        ("block with contacts beside its bonds", 400, beside(block())),
    ];
    for (name, steps, (state, mut plan)) in scenes {
        keep_books(&mut plan, true);
        let expected = after(&state, &plan, Options::default(), steps);
        if name.starts_with("block") {
            let broken = expected.bonds.iter().filter(|bond| !bond.holds()).count();
            assert!(broken > 0 && broken < expected.bonds.len(), "{broken} broke");
        }
        for options in all_options() {
            let found = after(&state, &plan, options, steps);
            assert_eq!(found.hash(), expected.hash(), "{name}, {options:?}");
        }
        let half = after(&state, &plan, Options::default(), steps / 2);
        assert_eq!(after(&half, &plan, Options::default(), steps / 2).hash(), expected.hash(), "{name}, in two parts");
        for skin in [5e-4, 4e-3] {
            let mut other = plan.clone();
            other.search.skin = skin;
            assert_eq!(after(&state, &other, Options::default(), steps).hash(), expected.hash(), "{name}, skin {skin}");
        }
    }
}

/// Where contacts are all that conducts, the rest is not looked at.
#[test]
fn contacts_alone_conduct_as_they_do_beside_surfaces_that_nobody_has() {
    let (mut state, mut beside) = warm_cloud();
    state.exposure.fill(0);
    heat_of(&mut beside).walls.fill(None);
    assert!(heat_of(&mut beside).exposures.iter().any(|exposure| !exposure.exchanges.is_empty()));
    for ledger in [false, true] {
        keep_books(&mut beside, ledger);
        let mut alone = beside.clone();
        heat_of(&mut alone).exposures.truncate(1);
        let expected = after(&state, &beside, Options::default(), 400);
        assert!(expected.heat_rate.iter().any(|&rate| rate != 0.0));
        for options in all_options() {
            assert_eq!(after(&state, &alone, options, 400).hash(), expected.hash(), "ledger {ledger}, {options:?}");
        }
    }
}

#[test]
fn heat_is_kept() {
    let (mut state, mut plan) = warm_cloud();
    plan.ledger = true;
    let begin = after(&state, &plan, Options::default(), 0);
    let end = after(&state, &plan, Options::default(), 1000);
    let [came, left] = [heat_accounts::IN, heat_accounts::OUT]
        .map(|column| end.heat_accounts.iter().map(|account| account[column]).sum::<f64>());
    let error = stored(&end, &plan) - stored(&begin, &plan) - came + left;
    assert!(came > 1e-3 * stored(&begin, &plan) && left > 0.0, "{came} {left}");
    assert!(error.abs() < 1e-12 * stored(&end, &plan), "{error}");

    // The same without walls and surfaces.
    state.exposure.fill(0);
    heat_of(&mut plan).walls.fill(None);
    let end = after(&state, &plan, Options::default(), 1000);
    let spread = end.temperature.iter().zip(&state.temperature).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let balance = stored(&end, &plan) / stored(&after(&state, &plan, Options::default(), 0), &plan) - 1.0;
    assert!(spread > 1.0 && balance.abs() < 1e-13, "{spread} {balance}");
}

#[test]
fn heat_is_kept_where_specific_heats_depend_on_temperature() {
    for (mut state, mut plan) in [warm_cloud(), warm_block(ELASTIC, Integrator::VelocityVerlet, EXPANSION)] {
        temper(&mut plan);
        plan.ledger = true;
        state.initial_heat = 0.0;
        let ledger = |state: &State| Ledger::of(state, &plan).heat.expect("there is heat");
        let begin = ledger(&after(&state, &plan, Options::default(), 0));
        let end = ledger(&after(&state, &plan, Options::default(), 1000));
        let unexplained = (end.stored - end.came_in + end.went_out) - (begin.stored - begin.came_in + begin.went_out);
        assert!(end.came_in > 1e-3 * begin.stored.abs(), "{end:?}");
        assert!(unexplained.abs() < 1e-11 * end.stored.abs(), "{unexplained} of {}", end.stored);
    }
}

#[test]
fn a_chain_whose_conductivity_is_straight_has_the_temperatures_of_kirchhoff() {
    let (mut state, mut plan, _) = held_chain(8);
    let held = |value| Exposure { temperature: Some(constant(value)), exchanges: Vec::new() };
    let heat = heat_of(&mut plan);
    heat.exposures.extend([held(900.0), held(300.0)]);
    heat.conductors[0].conductivity = 1.0;
    let table = Table(vec![[250.0, 2.0], [1000.0, 0.5]]);
    heat.tables.conductivity = vec![table.clone()];
    (state.exposure[0], state.exposure[7]) = (1, 2);
    state.temperature[0] = 900.0;
    let end = after(&state, &plan, Options::default(), 60_000);
    let whole = table.heat_between(300.0, 900.0);
    for j in 0..8 {
        let flux = table.heat_between(end.temperature[j], 900.0) / whole;
        assert!((flux - j as f64 / 7.0).abs() < 1e-9, "{j}: {} {flux}", end.temperature[j]);
    }
    assert!((end.temperature[4] - (900.0 - 600.0 * 4.0 / 7.0)).abs() > 20.0);
}

#[test]
fn what_lies_before_a_particle_at_a_surface_conducts_by_its_temperature() {
    let (area, depth, film) = (1e-4, 2e-3, 50.0);
    let table = Table(vec![[300.0, 2.0], [700.0, 1.0]]);
    let (mut state, mut plan, _) = held_chain(1);
    let conductance = surface_conductance(area, depth, 1.0, film);
    let resistance = depth / area;
    let exchange = Exchange { flux_area: 0.0, conductance, radiation: 0.0, resistance };
    let heat = heat_of(&mut plan);
    heat.exposures.push(Exposure { temperature: None, exchanges: vec![(exchange, Around::fluid(constant(900.0)))] });
    heat.conductors[0].conductivity = 1.0;
    heat.tables.conductivity = vec![table];
    state.exposure[0] = 1;
    for (temperature, conductivity) in [(300.0, 2.0), (500.0, 1.5), (800.0, 1.0)] {
        state.temperature[0] = temperature;
        let expected = surface_conductance(area, depth, conductivity, film) * (900.0 - temperature);
        let found = after(&state, &plan, Options::default(), 0).heat_rate[0];
        assert!((found / expected - 1.0).abs() < 1e-13, "{temperature} K: {found} {expected}");
    }
}

#[test]
fn a_held_bond_pulls_and_breaks_by_its_temperature() {
    let (mut state, mut plan, _) = held_chain(2);
    let stretch = 1e-3 * RADIUS;
    state.position[1][0] += stretch;
    let stiffness = Table(vec![[300.0, 1.0], [500.0, 0.2]]);
    let strength = Table(vec![[300.0, 1.0], [400.0, 0.0]]);
    let bonds = plan.bonds.as_mut().expect("the plan has bonds");
    bonds.tables = BondTables { stiffness: vec![stiffness.clone()], strength: Vec::new() };
    heat_of(&mut plan).conductors[0].conductivity = 0.0;
    let force = |temperatures: [f64; 2], plan: &Plan| {
        let mut state = state.clone();
        state.temperature = temperatures.to_vec();
        after(&state, plan, Options::default(), 0).force[0][0]
    };
    let cold = force([280.0, 300.0], &plan);
    for temperatures in [[300.0, 500.0], [430.0, 450.0], [600.0, 700.0]] {
        let mean = 0.5 * (temperatures[0] + temperatures[1]);
        let found = force(temperatures, &plan) / cold;
        assert!((found / stiffness.value(mean) - 1.0).abs() < 1e-12, "{temperatures:?}: {found}");
    }
    // Warmed by a flux, it breaks where its strength has fallen to its stress.
    let area = std::f64::consts::PI * RADIUS * RADIUS;
    let bonds = plan.bonds.as_mut().expect("the plan has bonds");
    bonds.tables = BondTables { stiffness: Vec::new(), strength: vec![strength] };
    let joint = bonds.joints[0].as_mut().expect("there is a joint");
    (joint.cement.tensile_strength, joint.cement.shear_strength) = (2.0 * cold / area, f64::INFINITY);
    let exchange = Exchange { flux_area: 1e-4, conductance: 0.0, radiation: 0.0, resistance: 0.0 };
    heat_of(&mut plan)
        .exposures
        .push(Exposure { temperature: None, exchanges: vec![(exchange, Around::flux(constant(1e3)))] });
    state.exposure = vec![1; 2];
    state.temperature = vec![330.0; 2];
    let per_step = plan.heat_step() * 0.1 / (state.mass[0] * SPECIFIC_HEAT);
    for options in all_options() {
        let end = after(&state, &plan, options, 400);
        let breakage = end.bonds[0].breakage.expect("it breaks");
        let at = 330.0 + per_step * breakage.step as f64;
        assert!((350.0..350.0 + 1.01 * per_step).contains(&at), "{at} K, {per_step} K a step");
    }
}

#[test]
fn tables_that_say_nothing_are_refused() {
    let (state, plan, _) = held_chain(3);
    let refused = |plan: &Plan| {
        matches!(Simulation::new(state.clone(), plan.clone(), Options::default()), Err(Fault::Inconsistent { .. }))
    };
    let table = || Table(vec![[300.0, 1.0], [400.0, 0.5]]);
    let with = |change: &dyn Fn(&mut Plan)| {
        let mut plan = plan.clone();
        change(&mut plan);
        plan
    };
    let conducting = |plan: &mut Plan, table: Table| {
        let heat = heat_of(plan);
        heat.conductors[0].conductivity = 1.0;
        heat.tables.conductivity = vec![table];
    };
    let bonded = |plan: &mut Plan, stiffness: Vec<Table>, strength: Vec<Table>| {
        plan.bonds.as_mut().expect("the plan has bonds").tables = BondTables { stiffness, strength };
    };
    assert!(!refused(&with(&|plan| conducting(plan, table()))));
    assert!(!refused(&with(&|plan| bonded(plan, vec![table()], vec![table()]))));
    for wrong in [
        Table(Vec::new()),
        Table(vec![[400.0, 1.0], [300.0, 0.5]]),
        Table(vec![[300.0, 1.0], [400.0, f64::NAN]]),
        Table(vec![[300.0, 1.0], [400.0, -0.5]]),
    ] {
        assert!(refused(&with(&|plan| conducting(plan, wrong.clone()))), "{wrong:?}");
        assert!(refused(&with(&|plan| heat_of(plan).tables.specific_heat = vec![wrong.clone()])), "{wrong:?}");
        assert!(refused(&with(&|plan| bonded(plan, vec![wrong.clone()], Vec::new()))), "{wrong:?}");
        assert!(refused(&with(&|plan| bonded(plan, Vec::new(), vec![wrong.clone()]))), "{wrong:?}");
    }
    // Another number of tables, a conductivity besides them, no heat, bonds that remember.
    assert!(refused(&with(&|plan| heat_of(plan).tables.specific_heat = vec![table(); 2])));
    assert!(refused(&with(&|plan| heat_of(plan).tables.conductivity = vec![table()])));
    let remembering = |plan: &mut Plan| {
        plan.bonds.as_mut().expect("the plan has bonds").law.form = bond::Form::Incremental(bond::Tension::Stored);
    };
    assert!(!refused(&with(&remembering)));
    assert!(!refused(&with(&|plan| {
        remembering(plan);
        bonded(plan, Vec::new(), vec![table()]);
    })));
    assert!(refused(&with(&|plan| {
        remembering(plan);
        bonded(plan, vec![table()], Vec::new());
    })));
}

#[test]
fn what_cannot_be_is_refused() {
    let (state, plan, _) = held_chain(3);
    let refused = |state: &State, plan: &Plan| {
        matches!(Simulation::new(state.clone(), plan.clone(), Options::default()), Err(Fault::Inconsistent { .. }))
    };
    assert!(!refused(&state, &plan));
    let mut frozen = state.clone();
    frozen.temperature[1] = -1.0;
    assert!(refused(&frozen, &plan));
    let mut short = state.clone();
    short.exposure.pop();
    assert!(refused(&short, &plan));
    let mut backwards = plan.clone();
    let course = Course(vec![[1.0, 300.0], [0.0, 400.0]]);
    heat_of(&mut backwards).exposures.push(Exposure { temperature: Some(course), exchanges: Vec::new() });
    assert!(refused(&state, &backwards));

    let mut insulating = plan.clone();
    heat_of(&mut insulating).conductors[0].conductivity = f64::NAN;
    assert!(refused(&state, &insulating));
    for (conductance, outside) in [(-1.0, 300.0), (1.0, -3.0), (f64::INFINITY, 300.0)] {
        let exchange = Exchange { flux_area: 0.0, conductance, radiation: 0.0, resistance: 0.0 };
        let mut wrong = plan.clone();
        let exchanges = vec![(exchange, Around::fluid(constant(outside)))];
        heat_of(&mut wrong).exposures.push(Exposure { temperature: None, exchanges });
        assert!(refused(&state, &wrong), "{conductance} {outside}");
    }
    // Nothing is outside of what radiates.
    let mut nowhere = plan.clone();
    let exchange = Exchange { flux_area: 0.0, conductance: 0.0, radiation: 5e-12, resistance: 0.0 };
    let exchanges = vec![(exchange, Around::fluid(constant(300.0)))];
    heat_of(&mut nowhere).exposures.push(Exposure { temperature: None, exchanges });
    assert!(refused(&state, &nowhere));
    let mut icy = plan.clone();
    heat_of(&mut icy).exposures.push(Exposure { temperature: Some(constant(0.0)), exchanges: Vec::new() });
    assert!(refused(&state, &icy));

    // A step of the heat beyond the limit is found before temperatures mean nothing.
    let (mut state, mut plan, _) = held_chain(2);
    state.temperature = vec![1000.0, 10.0];
    heat_of(&mut plan).time_scale = 1e8;
    let mut simulation = Simulation::new(state, plan, Options::default()).expect("the scene is sound");
    assert!(matches!(simulation.advance(10), Err(Fault::Temperature { particle: 0, step: 1, .. })));
}

#[test]
fn a_bond_that_broke_hands_its_heat_to_the_contact() {
    let (mut state, mut plan, conductance) = held_chain(2);
    state.temperature = vec![400.0, 300.0];
    let pull = Constraint { velocity: [Some(1.0), Some(0.0), Some(0.0)], ..CLAMPED };
    plan.constraints.push(pull);
    let rate = |state: &State| state.heat_rate[0];
    assert!((rate(&after(&state, &plan, Options::default(), 0)) / (-100.0 * conductance) - 1.0).abs() < 1e-12);
    // Apart and broken: nothing.
    let mut apart = state.clone();
    apart.constraint[1] = 2;
    let joint = plan.bonds.as_mut().and_then(|bonds| bonds.joints[0].as_mut()).expect("there is a joint");
    joint.cement.tensile_strength = 1.0;
    let torn = after(&apart, &plan, Options::default(), 3);
    assert!(!torn.bonds[0].holds() && rate(&torn) == 0.0);
    // Broken and pressed together: the contact's own path.
    let mut pressed = torn.clone();
    pressed.position[1][0] = pressed.position[0][0] + 1.98 * RADIUS;
    pressed.constraint = vec![1; 2];
    let touching = after(&pressed, &plan, Options::default(), 1);
    let expected = 1.5 * 0.35 * (2.0 * RADIUS) * (2.0 * RADIUS) / (1.98 * RADIUS);
    let difference = touching.temperature[1] - touching.temperature[0];
    assert!((rate(&touching) / (expected * difference) - 1.0).abs() < 1e-9);
}

#[test]
fn a_bond_and_the_contact_beside_it_conduct_once() {
    let (mut state, mut plan, conductance) = held_chain(2);
    state.temperature = vec![400.0, 300.0];
    state.position[1][0] = 1.98 * RADIUS;
    for beside in [false, true] {
        plan.bonds.as_mut().expect("the plan has bonds").contact_in_bonded_pairs = beside;
        for options in all_options() {
            let end = after(&state, &plan, options, 0);
            assert!((end.heat_rate[0] / (-100.0 * conductance) - 1.0).abs() < 1e-12, "{beside}, {options:?}");
            assert_eq!(end.heat_rate[1].to_bits(), (-end.heat_rate[0]).to_bits());
        }
    }
}

#[test]
fn contacts_and_walls_conduct_by_their_path() {
    // Two spheres that overlap by 1e-4 m, the first of them by 2e-4 m with a wall.
    let (overlap, depth) = (1e-4, 2e-4);
    let mut plan = common::plan(Law::GNTM, [-1.0; 3], [1.0; 3], [false; 3]);
    plan.walls = vec![common::wall("floor", [1.0, 0.0, 0.0], [0.0; 3])];
    let mut state = spheres(&[([0.0; 3], RADIUS), ([2.0 * RADIUS - overlap, 0.0, 0.0], RADIUS)], DENSITY);
    state.wall_position = vec![[depth - RADIUS, 0.0, 0.0]];
    heated(&mut state, &mut plan, 0.0);
    heat_of(&mut plan).walls[0] = Some(constant(600.0));
    state.temperature = vec![400.0, 300.0];
    let section = 0.35 * (2.0 * RADIUS) * (2.0 * RADIUS);
    let bars = [1.5 * section / (2.0 * RADIUS - overlap), 1.5 * section / (RADIUS - depth)];
    let circles = [2.0 * 1.5 * (0.5 * RADIUS * overlap).sqrt(), 2.0 * 1.5 * (RADIUS * depth).sqrt()];
    for (path, [between, at_wall]) in [(Path::Bar, bars), (Path::Circle, circles), (Path::Closed, [0.0; 2])] {
        heat_of(&mut plan).contacts = path;
        let rate = after(&state, &plan, Options::default(), 0).heat_rate;
        let expected = [at_wall * 200.0 - between * 100.0, between * 100.0];
        for k in 0..2 {
            assert!((rate[k] - expected[k]).abs() <= 1e-9 * expected[k].abs(), "{path:?}: {rate:?} {expected:?}");
        }
    }
}
