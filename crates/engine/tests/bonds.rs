//! Bonds: one result however the machine works, and closed forms.

mod common;

use common::bonded::{
    CEMENT, CLAMPED, ELASTIC, JOINT, RADIUS, bond_neighbours, chain, cracking_block, free_space, lattice,
};
use common::{DENSITY, spheres};
use tdem_engine::cpu::{List, Options, Width};
use tdem_engine::physics::bond::{Bond, Cement, Damping, Failure, Form, Joint, Law, Tension};
use tdem_engine::physics::motion::sphere_inertia;
use tdem_engine::{Constraint, Fault, Integrator, Ledger, Plan, Simulation, State};

const STEPS: u64 = 500;

fn run(state: &State, plan: &Plan, options: &Options, steps: u64) -> State {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), options).expect("the scene is sound");
    simulation.advance(steps).expect("the scene runs through");
    simulation.state().expect("a state can be taken")
}

fn after(state: &State, plan: &Plan, steps: u64) -> State {
    run(state, plan, &Options::default(), steps)
}

const REFERENCE: Options = Options { threads: Some(1), width: Width::One, list: List::Full, cell_factor: 1.0 };

fn laws() -> [Law; 4] {
    let with = |form, damping| Law { form, damping };
    [
        with(Form::Total, Damping::Off),
        with(Form::Total, Damping::Viscous),
        with(Form::Incremental(Tension::FromLength), Damping::Off),
        with(Form::Incremental(Tension::Stored), Damping::Viscous),
    ]
}

fn same(found: &State, expected: &State, what: &str) {
    fn differ<T: PartialEq + std::fmt::Debug>(what: &str, name: &str, found: &[T], expected: &[T]) {
        if let Some(i) = (0..expected.len()).find(|&i| found.get(i) != expected.get(i)) {
            panic!("{what}: entry {i} of {name} is {:?}, not {:?}", found.get(i), expected[i]);
        }
    }
    differ(what, "bonds", &found.bonds, &expected.bonds);
    differ(what, "position", &found.position, &expected.position);
    differ(what, "orientation", &found.orientation, &expected.orientation);
    differ(what, "accounts", &found.accounts, &expected.accounts);
    differ(what, "contacts", &found.contacts, &expected.contacts);
    assert!(found == expected, "{what}: another field differs");
    assert_eq!(found.hash(), expected.hash(), "{what}");
}

#[test]
fn same_bits_for_threads_widths_lists_and_skins() {
    for (law, k) in laws().into_iter().zip(0..) {
        let (state, mut plan) = cracking_block(law, Integrator::VelocityVerlet);
        if let Some(bonds) = &mut plan.bonds {
            bonds.contact_in_bonded_pairs = k == 2;
            bonds.local_damping = if k == 3 { 0.2 } else { 0.0 };
        }
        let expected = run(&state, &plan, &REFERENCE, STEPS);
        let broken = expected.bonds.iter().filter(|bond| !bond.holds()).count();
        let modes = [Failure::Tension, Failure::Shear]
            .map(|mode| expected.bonds.iter().filter(|b| b.breakage.is_some_and(|b| b.failure == mode)).count());
        assert!(broken > 20 && broken < expected.bonds.len() - 100, "{broken} of {} broke", expected.bonds.len());
        assert!(modes.iter().all(|&count| count > 0), "tension and shear: {modes:?}");
        assert!(expected.contacts.len() > 10 && expected.wall_contacts.len() > 10, "contacts act, too");
        assert!(expected.image.iter().any(|image| image[1] != 0), "the block leaves the box");
        for threads in [1, 2, 3] {
            for width in Width::ALL {
                let list = if threads == 3 { List::Full } else { List::Half };
                let options = Options { threads: Some(threads), width, list, cell_factor: 1.0 };
                same(&run(&state, &plan, &options, STEPS), &expected, &format!("{law:?} {options:?}"));
            }
        }
        for (skin, every_step) in [(0.0, true), (1e-4, false), (3e-3, false)] {
            plan.search.skin = skin;
            plan.search.every_step = every_step;
            same(&after(&state, &plan, STEPS), &expected, &format!("{law:?} skin {skin}"));
        }
    }
}

#[test]
fn same_bits_when_resumed_while_bonds_break() {
    for integrator in [Integrator::VelocityVerlet, Integrator::Gear] {
        for law in laws() {
            let (state, plan) = cracking_block(law, integrator);
            let expected = after(&state, &plan, STEPS);
            let first = expected.bonds.iter().filter_map(|bond| bond.breakage).map(|b| b.step).min();
            let first = first.expect("bonds break");
            for at in [1, first - 1, first, first + 20] {
                let half_way = run(&state, &plan, &REFERENCE, at);
                let what = format!("{integrator:?} {law:?} resumed at {at}");
                same(&after(&half_way, &plan, STEPS - at), &expected, &what);
            }
        }
    }
}

/// Momentum, angular momentum about the origin, and the size of what they are sums of.
fn momenta(state: &State) -> ([f64; 3], [f64; 3], f64) {
    let (mut linear, mut angular, mut size) = ([0.0; 3], [0.0; 3], 0.0);
    for i in 0..state.len() {
        let (x, v, w) = (state.position[i], state.velocity[i], state.angular_velocity[i]);
        let inertia = sphere_inertia(state.mass[i], state.radius[i]);
        for k in 0..3 {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let turn = state.mass[i] * (x[a] * v[b] - x[b] * v[a]) + inertia * w[k];
            linear[k] += state.mass[i] * v[k];
            angular[k] += turn;
            size += turn.abs();
        }
    }
    (linear, angular, size)
}

#[test]
fn a_spinning_block_keeps_its_momenta_and_its_shape() {
    let law = Law { damping: Damping::Viscous, ..ELASTIC };
    let joint = Joint { cement: Cement { damping_ratio: 0.02, ..CEMENT }, ..JOINT };
    let plan = free_space(law, joint);
    let mut state = spheres(&lattice([3, 2, 2]), DENSITY);
    bond_neighbours(&mut state, &plan);
    let spin = [20.0, -10.0, 30.0];
    for i in 0..state.len() {
        let x = state.position[i];
        state.velocity[i] = std::array::from_fn(|k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            spin[a] * x[b] - spin[b] * x[a] + [0.3, 0.1, -0.2][k]
        });
        state.angular_velocity[i] = spin;
    }
    let (linear, angular, size) = momenta(&state);
    let end = after(&state, &plan, 20_000);
    let (later_linear, later_angular, _) = momenta(&end);
    for k in 0..3 {
        assert!((later_linear[k] - linear[k]).abs() < 1e-12 * size / RADIUS, "{later_linear:?}, {linear:?}");
        assert!((later_angular[k] - angular[k]).abs() < 1e-12 * size, "{later_angular:?}, {angular:?}");
    }
    // It has turned by about 7 rad, and its bonds are as long as they were but for the centrifugal strain.
    let turned = end.orientation[0];
    assert!(turned[3] < 0.9, "{turned:?}");
    let ledger = Ledger::of(&end, &plan);
    assert!(ledger.elastic_bonds < 1e-3 * ledger.kinetic(), "{ledger:?}");
}

#[test]
fn a_loaded_bond_stretches_by_force_over_stiffness() {
    let mut plan = free_space(ELASTIC, JOINT);
    plan.gravity = [40.0, 0.0, 0.0];
    plan.constraints.push(CLAMPED);
    plan.bonds.as_mut().expect("there are bonds").local_damping = 0.7;
    let mut state = chain(2, &plan);
    state.constraint[0] = 1;
    let end = after(&state, &plan, 20_000);
    let stiffness = numbers(&JOINT).stiffness.normal;
    let expected = state.mass[1] * 40.0 / stiffness;
    let found = end.position[1][0] - 2.0 * RADIUS;
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} m, not {expected} m");
}

fn numbers(joint: &Joint<f64>) -> Bond<f64> {
    joint.bond(RADIUS, RADIUS, 2.0 * RADIUS, 1.0)
}

#[test]
fn a_cantilever_bends_under_its_weight_as_beams_do() {
    let (count, g) = (6, 0.05);
    for form in [Form::Total, Form::Incremental(Tension::FromLength)] {
        let mut plan = free_space(Law { form, ..ELASTIC }, JOINT);
        plan.gravity = [0.0, 0.0, -g];
        plan.constraints.push(CLAMPED);
        plan.bonds.as_mut().expect("there are bonds").local_damping = 0.7;
        let mut state = chain(count, &plan);
        state.constraint[0] = 1;
        let end = after(&state, &plan, 60_000);
        let (length, weight, bond) = (2.0 * RADIUS, state.mass[1] * g, numbers(&JOINT));
        let mut expected = 0.0;
        for j in 1..count {
            let beyond = |k: usize| (k - j) as f64 + 0.5;
            let shear = weight * (count - j) as f64;
            let moment: f64 = (j..count).map(|k| weight * beyond(k) * length).sum();
            expected += shear / bond.stiffness.shear + moment / bond.stiffness.bending * beyond(count - 1) * length;
        }
        let found = -end.position[count - 1][2];
        assert!((found / expected - 1.0).abs() < 1e-5, "{form:?}: {found} m, not {expected} m");
    }
}

/// A pair whose second particle is pulled away at a constant velocity until the bond breaks; a state before that, the
/// state right behind it.
fn pulled_apart(plan: &mut Plan, state: &mut State, velocity: [f64; 3]) -> (State, State) {
    let constraint = Constraint { velocity: velocity.map(Some), angular_velocity: [Some(0.0); 3], ..Constraint::FREE };
    plan.constraints = vec![Constraint::FREE, CLAMPED, constraint];
    state.constraint = vec![1, 2];
    state.velocity[1] = velocity;
    let mut simulation = Simulation::new(state.clone(), plan.clone(), Options::default()).expect("sound");
    let mut before = simulation.state().expect("a state");
    loop {
        simulation.advance(1).expect("runs");
        let now = simulation.state().expect("a state");
        assert!(now.step < 10_000, "it must break");
        if !now.bonds[0].holds() {
            return (before, now);
        }
        before = now;
    }
}

#[test]
fn a_bond_breaks_at_its_strength() {
    for (direction, mode) in [([1.0, 0.0, 0.0], Failure::Tension), ([0.0, 1.0, 0.0], Failure::Shear)] {
        for form in [Form::Total, Form::Incremental(Tension::FromLength), Form::Incremental(Tension::Stored)] {
            let cement = Cement { tensile_strength: 7e4, shear_strength: 3e4, moment_contribution: 0.0, ..CEMENT };
            let joint = Joint { cement, ..JOINT };
            let mut plan = free_space(Law { form, ..ELASTIC }, joint);
            let mut state = chain(2, &plan);
            state.bonds[0].strength = 1.1;
            let speed = 0.1;
            let (before, broken) = pulled_apart(&mut plan, &mut state, direction.map(|c| c * speed));
            let bond = numbers(&joint);
            let limit = 1.1 * if mode == Failure::Tension { 7e4 } else { 3e4 };
            let stiffness = if mode == Failure::Tension { bond.stiffness.normal } else { bond.stiffness.shear };
            let breakage = broken.bonds[0].breakage.expect("it broke");
            let steps = limit / bond.stress_per_force / stiffness / (speed * plan.dt);
            assert_eq!(breakage.failure, mode);
            assert!((breakage.step as f64 - steps).abs() < 2.0, "{form:?} {mode:?}: {breakage:?}, not {steps}");
            assert!(before.force[0].iter().any(|&f| f.abs() > 0.98 * limit / bond.stress_per_force));
            assert_eq!(broken.force, vec![[0.0; 3]; 2], "a bond that breaks exerts nothing in the same step");
            assert_eq!(broken.moment, vec![[0.0; 3]; 2]);
            let force = limit / bond.stress_per_force;
            let held = 0.5 * force * force / stiffness;
            assert!((breakage.energy / held - 1.0).abs() < 0.02, "{} J, not {held} J", breakage.energy);
            let later = after(&broken, &plan, 50);
            assert_eq!(later.bonds, broken.bonds, "what broke stays broken, with its step and mode");
        }
    }
}

#[test]
fn contact_begins_where_a_bond_breaks_and_remembers_nothing_of_it() {
    let cement = Cement { shear_strength: 3e4, ..CEMENT };
    let mut plan = free_space(ELASTIC, Joint { cement, ..JOINT });
    let mut state = spheres(&[([0.0; 3], RADIUS), ([1.9 * RADIUS, 0.0, 0.0], RADIUS)], DENSITY);
    bond_neighbours(&mut state, &plan);
    let speed = 0.1;
    let (before, broken) = pulled_apart(&mut plan, &mut state, [0.0, speed, 0.0]);
    assert!(before.contacts.is_empty(), "a bond that holds keeps contact off");
    assert_eq!(broken.contacts.len(), 1, "contact begins in the step of the breakage");
    let slipped = broken.contacts[0].displacement[1];
    assert!((slipped / (speed * plan.dt) - 1.0).abs() < 0.1, "{slipped} m in one step");
    assert!(broken.force[0][0] < 0.0, "the spheres push each other away");

    plan.bonds.as_mut().expect("there are bonds").contact_in_bonded_pairs = true;
    let both = after(&state, &plan, 10);
    assert!(both.bonds[0].holds() && both.contacts.len() == 1, "contacts may act beside bonds");
}

#[test]
fn bonds_reach_over_gaps_and_faces_that_repeat() {
    let joint = Joint { cement: Cement { radius_multiplier: 0.5, ..CEMENT }, ..JOINT };
    let mut plan = free_space(ELASTIC, joint);
    plan.domain.periodic = [true, false, false];
    // A gap of a diameter, through the face at x = 1: beyond any list of neighbours.
    let mut state = spheres(&[([-0.99, 0.0, 0.0], RADIUS), ([0.99, 0.0, 0.0], RADIUS)], DENSITY);
    state.make_bonds(vec![tdem_engine::Bond::new(0, 1, 1.0)]);
    // Thrown through the face and pulled apart a little.
    state.velocity = vec![[-20.0, 0.0, 0.0], [-20.001, 0.0, 0.0]];
    let end = after(&state, &plan, 3_000);
    let stretch = |state: &State| state.position[0][0] - state.position[1][0];
    assert!(end.image[0] != [0; 3] && end.image[1] == [0; 3], "the first has gone through the face: {:?}", end.image);
    assert!((stretch(&end).rem_euclid(2.0) - 0.02).abs() < 1e-6, "{:?}", end.position);
    let momentum: f64 = end.velocity.iter().map(|v| v[0]).sum();
    assert!((momentum + 40.001).abs() < 1e-11, "{momentum}");
}

#[test]
fn a_fresh_state_that_is_overloaded_breaks_in_its_first_step() {
    let joint = Joint { cement: Cement { tensile_strength: 1e4, ..CEMENT }, ..JOINT };
    for form in [Form::Total, Form::Incremental(Tension::FromLength)] {
        let plan = free_space(Law { form, ..ELASTIC }, joint);
        let mut state = chain(2, &plan);
        state.position[1][0] += 1e-4;
        let prepared = after(&state, &plan, 0);
        assert!(prepared.bonds[0].holds() && prepared.force[0][0] > 0.0);
        let broken = after(&state, &plan, 1);
        assert_eq!(broken.bonds[0].breakage.map(|b| (b.step, b.failure)), Some((1, Failure::Tension)));
    }
}

#[test]
fn the_ledger_closes_for_a_bond_that_vibrates() {
    for (ratio, local_damping) in [(0.0, 0.0), (0.05, 0.0), (0.0, 0.1)] {
        for form in [Form::Total, Form::Incremental(Tension::FromLength)] {
            let law = Law { form, damping: if ratio > 0.0 { Damping::Viscous } else { Damping::Off } };
            let joint = Joint { cement: Cement { damping_ratio: ratio, ..CEMENT }, ..JOINT };
            let errors = [1e-5, 5e-6].map(|dt| {
                let mut plan = free_space(law, joint);
                plan.dt = dt;
                plan.bonds.as_mut().expect("there are bonds").local_damping = local_damping;
                let mut state = chain(3, &plan);
                state.velocity[0] = [-0.02, 0.01, 0.0];
                state.angular_velocity[2] = [1.0, 0.5, -2.0];
                let mut simulation = Simulation::new(state, plan.clone(), Options::default()).expect("sound");
                let mut largest: f64 = 0.0;
                for _ in 0..100 {
                    simulation.advance((2e-5 / dt) as u64).expect("runs");
                    let ledger = Ledger::of(&simulation.state().expect("a state"), &plan);
                    largest = largest.max(ledger.energy_error.abs() / simulation_energy(&ledger));
                }
                largest
            });
            // Dashpots and local damping lack half a step's loss at the start.
            let (limit, order) = if ratio + local_damping > 0.0 { (0.03, 0.8) } else { (0.01, 0.3) };
            assert!(errors[0] < limit, "{ratio} {local_damping} {form:?}: {errors:?}");
            assert!(errors[1] < order * errors[0], "smaller steps: {ratio} {local_damping} {form:?}: {errors:?}");
        }
    }
}

/// What there was at the start, J.
fn simulation_energy(ledger: &Ledger) -> f64 {
    ledger.mechanical() + ledger.damping_dissipated + ledger.breakage_dissipated
}

#[test]
fn the_ledger_closes_when_a_chain_breaks() {
    let cement = Cement { tensile_strength: 6e4, damping_ratio: 0.02, ..CEMENT };
    let errors = [1e-5, 5e-6, 2.5e-6].map(|dt| {
        let mut plan = free_space(Law { damping: Damping::Viscous, ..ELASTIC }, Joint { cement, ..JOINT });
        plan.dt = dt;
        let mut state = chain(12, &plan);
        for i in 0..12 {
            state.velocity[i] = [(i as f64 - 5.5) * 0.25, 0.0, 0.0];
        }
        let end = after(&state, &plan, (2e-3 / dt) as u64);
        let ledger = Ledger::of(&end, &plan);
        assert!(ledger.broken_bonds > 1 && ledger.bonds > 1, "{ledger:?}");
        assert!(ledger.breakage_dissipated > 0.05 * ledger.kinetic(), "{ledger:?}");
        ledger.energy_error.abs() / ledger.breakage_dissipated
    });
    assert!(errors[2] < 2e-3, "{errors:?}");
}

#[test]
fn the_ledger_closes_when_contact_takes_over_from_a_bond() {
    let cement = Cement { shear_strength: 2e4, ..CEMENT };
    let errors = [1e-5, 5e-6, 2.5e-6].map(|dt| {
        let mut plan = free_space(ELASTIC, Joint { cement, ..JOINT });
        plan.dt = dt;
        let mut state = spheres(&[([0.0; 3], RADIUS), ([1.9 * RADIUS, 0.0, 0.0], RADIUS)], DENSITY);
        bond_neighbours(&mut state, &plan);
        state.velocity = vec![[0.1, -0.6, 0.0], [-0.1, 0.6, 0.0]];
        let end = after(&state, &plan, (2e-3 / dt) as u64);
        let ledger = Ledger::of(&end, &plan);
        assert!(ledger.broken_bonds == 1 && ledger.damping_dissipated > 0.0, "they part after a contact: {ledger:?}");
        // The contact begins with much more than the bond ever held.
        assert!(ledger.breakage_dissipated < -1e-4, "{ledger:?}");
        (ledger.energy_error / ledger.breakage_dissipated).abs()
    });
    assert!(errors[2] < 0.01 && errors[2] < errors[0], "{errors:?}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let plan = free_space(ELASTIC, JOINT);
    let good = chain(3, &plan);
    let fault = |state: &State, plan: &Plan| match state.validate(plan) {
        Err(Fault::Inconsistent { what }) => what,
        other => panic!("{other:?}"),
    };
    assert_eq!(good.validate(&plan), Ok(()));
    let changed = |change: &dyn Fn(&mut State)| {
        let mut state = good.clone();
        change(&mut state);
        fault(&state, &plan)
    };
    assert!(changed(&|state| state.bonds.swap(0, 1)).contains("ascend"));
    assert!(changed(&|state| state.bonds[1].second = 7).contains("exist"));
    assert!(changed(&|state| state.orientation.truncate(2)).contains("orientation"));
    assert!(changed(&|state| state.bonded_position[1] = state.bonded_position[0]).contains("apart"));
    assert!(changed(&|state| state.bonds[0].strength = f64::NAN).contains("strength"));
    let without = Plan { bonds: None, ..plan.clone() };
    assert!(fault(&good, &without).contains("law"));
    let mut flat = plan.clone();
    flat.law.moments = false;
    assert!(fault(&good, &flat).contains("moments"));
}
