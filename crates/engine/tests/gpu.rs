//! The contract of bits across devices: kernels give what the CPU gives. Needs a device, or fails.
//!
//! `TDEM_TEST_DEVICE` says of which interface: `opencl`, which is taken without it and for which PoCL will do, or `cuda`.

mod common;

use common::bonded::{CEMENT, ELASTIC, JOINT, bond_neighbours, cracking_block, free_space, lattice};
use common::{DENSITY, scene, spheres};
use tdem_engine::cpu::Options;
use tdem_engine::gpu::Api;
use tdem_engine::physics::bond::{self, Cement, Form, Joint, Tension};
use tdem_engine::physics::contact::{Damping, Friction, Law};
use tdem_engine::{BondPlan, Constraint, Device, Driven, Fault, Integrator, Plan, Ramp, Simulation, State};

const STEPS: u64 = 600;
/// Bonds that store all they hold.
const STORED: bond::Law = bond::Law { form: Form::Incremental(Tension::Stored), ..ELASTIC };

fn gpu() -> Device {
    let api = match std::env::var("TDEM_TEST_DEVICE").as_deref() {
        Ok("cuda") => Api::Cuda,
        Ok("opencl") | Err(_) => Api::OpenCl,
        Ok(other) => panic!("TDEM_TEST_DEVICE is opencl or cuda, not {other:?}"),
    };
    Device::Gpu { api, index: 0 }
}

fn cpu() -> Device {
    Options::default().into()
}

fn run(state: &State, plan: &Plan, device: Device, steps: u64) -> Result<State, Fault> {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), device)?;
    simulation.advance(steps)?;
    simulation.state()
}

/// The states must agree in every field; a message names the first that does not, and where.
fn assert_same(found: &State, expected: &State, what: &str) {
    fn differ<T: PartialEq + std::fmt::Debug>(what: &str, name: &str, found: &[T], expected: &[T]) {
        assert_eq!(found.len(), expected.len(), "{what}: number of entries of {name}");
        if let Some(i) = (0..found.len()).find(|&i| found[i] != expected[i]) {
            panic!("{what}: entry {i} of {name} is {:?}, not {:?}", found[i], expected[i]);
        }
    }
    differ(what, "bonds", &found.bonds, &expected.bonds);
    differ(what, "bond histories", &found.bond_histories, &expected.bond_histories);
    differ(what, "position", &found.position, &expected.position);
    differ(what, "velocity", &found.velocity, &expected.velocity);
    differ(what, "angular velocity", &found.angular_velocity, &expected.angular_velocity);
    differ(what, "force", &found.force, &expected.force);
    differ(what, "moment", &found.moment, &expected.moment);
    differ(what, "derivatives", &found.derivatives, &expected.derivatives);
    differ(what, "accounts", &found.accounts, &expected.accounts);
    differ(what, "image", &found.image, &expected.image);
    differ(what, "orientation", &found.orientation, &expected.orientation);
    differ(what, "contacts", &found.contacts, &expected.contacts);
    differ(what, "wall contacts", &found.wall_contacts, &expected.wall_contacts);
    assert!(found == expected, "{what}: another field differs");
    assert_eq!(found.hash(), expected.hash(), "{what}");
}

fn both(state: &State, plan: &Plan, steps: u64, what: &str) -> State {
    let expected = run(state, plan, cpu(), steps).expect("the scene runs through on the CPU");
    let found = run(state, plan, gpu(), steps).expect("the scene runs through on the device");
    assert_same(&found, &expected, what);
    expected
}

fn laws() -> Vec<Law> {
    let rescaled = Law { friction: Friction::Rescaled, damping: Damping::Restitution, ..Law::GNTM };
    vec![Law::GN, Law::GNT, Law::GNTM, rescaled]
}

#[test]
fn same_bits_in_every_model_with_and_without_ledger() {
    for law in laws() {
        // Spheres that are alike and spheres that are not have kernels of their own.
        for (ledger, radius_ratio) in [(false, 3.0), (true, 3.0), (false, 1.0)] {
            let (state, mut plan) = scene(law, Integrator::VelocityVerlet, radius_ratio);
            plan.ledger = ledger;
            let end = both(&state, &plan, STEPS, &format!("{law:?} ledger {ledger} ratio {radius_ratio}"));
            assert!(end.contacts.len() > 100 && end.wall_contacts.len() > 10, "the scene must be busy");
        }
    }
}

#[test]
fn same_bits_with_gear_and_search_in_every_step() {
    for ledger in [false, true] {
        let (mut state, mut plan) = scene(Law::GNTM, Integrator::Gear, 2.0);
        plan.ledger = ledger;
        // A fresh state may come with higher derivatives; the second ones follow from the forces.
        let small = |i: usize, d: usize| std::array::from_fn(|k| 1e-9 * ((7 * i + 3 * d + k) % 11) as f64);
        state.derivatives = (0..state.len()).map(|i| std::array::from_fn(|d| small(i, d))).collect();
        both(&state, &plan, STEPS, "Gear");
        plan.search.every_step = true;
        plan.search.skin = 0.0;
        both(&state, &plan, 60, "Gear, every step");
    }
}

fn broken(state: &State) -> usize {
    state.bonds.iter().filter(|bond| !bond.holds()).count()
}

/// Two materials, sizes that differ, scatter of strength, a box that repeats, contacts, walls.
#[test]
fn same_bits_while_bonds_break() {
    let dashpots = bond::Law { damping: bond::Damping::Viscous, ..ELASTIC };
    let incremental = bond::Law { form: Form::Incremental(Tension::FromLength), ..dashpots };
    for (law, integrator, ledger, beside, local_damping) in [
        (ELASTIC, Integrator::VelocityVerlet, false, false, 0.0),
        (dashpots, Integrator::VelocityVerlet, false, true, 0.3),
        (dashpots, Integrator::VelocityVerlet, true, false, 0.2),
        (dashpots, Integrator::Gear, true, false, 0.0),
        (STORED, Integrator::VelocityVerlet, false, false, 0.0),
        (incremental, Integrator::VelocityVerlet, false, true, 0.3),
        (incremental, Integrator::VelocityVerlet, true, false, 0.2),
        (bond::Law { damping: bond::Damping::Viscous, ..STORED }, Integrator::Gear, true, false, 0.0),
    ] {
        let (state, mut plan) = cracking_block(law, integrator);
        plan.ledger = ledger;
        if let Some(bonds) = &mut plan.bonds {
            bonds.contact_in_bonded_pairs = beside;
            bonds.local_damping = local_damping;
        }
        let end = both(&state, &plan, 500, &format!("{law:?} {integrator:?} ledger {ledger} beside {beside}"));
        assert!(broken(&end) > 20, "{} bonds broke", broken(&end));
    }
}

/// The paper's way: each bond is evaluated once, neighbours are listed in every step.
#[test]
fn same_bits_while_bonds_break_and_every_step_searches() {
    let dashpots = bond::Law { damping: bond::Damping::Viscous, ..ELASTIC };
    for (law, integrator, ledger) in [
        (STORED, Integrator::Gear, false),
        (dashpots, Integrator::Gear, true),
        (ELASTIC, Integrator::VelocityVerlet, false),
    ] {
        let (state, mut plan) = cracking_block(law, integrator);
        plan.ledger = ledger;
        plan.search.every_step = true;
        plan.search.skin = 0.0;
        let end = both(&state, &plan, 300, &format!("{law:?} {integrator:?} ledger {ledger}, every step"));
        assert!(broken(&end) > 20, "{} bonds broke", broken(&end));
    }
}

/// One material and one size: all bonds have the same numbers.
#[test]
fn same_bits_with_bonds_that_are_alike() {
    let cement = Cement { tensile_strength: 1e5, shear_strength: 1e5, ..CEMENT };
    let mut plan = free_space(ELASTIC, Joint { cement, ..JOINT });
    let mut state = spheres(&lattice([6, 3, 3]), DENSITY);
    bond_neighbours(&mut state, &plan);
    let pull = |speed: f64| Constraint { velocity: [Some(speed), None, None], ..Constraint::FREE };
    plan.constraints = vec![Constraint::FREE, pull(-1.0), pull(1.0)];
    let farthest = state.position.iter().fold(0.0, |far: f64, place| far.max(place[0]));
    for i in 0..state.len() {
        let x = state.position[i][0];
        state.constraint[i] = u16::from(x < 1e-6) + 2 * u16::from(x > farthest - 1e-6);
    }
    let end = both(&state, &plan, 400, "alike");
    assert!(broken(&end) > 20, "{} bonds broke", broken(&end));
    // The same of each pair of two materials, of different mass.
    let stiffer = Joint { cement, stiffness_per_area: 3.0 * JOINT.stiffness_per_area, ..JOINT };
    plan.materials = 2;
    plan.interactions = vec![plan.interactions[0]; 4];
    for form in [Form::Total, Form::Incremental(Tension::Stored)] {
        let law = bond::Law { form, damping: bond::Damping::Viscous };
        let damped = |joint: Joint<f64>| Joint { cement: Cement { damping_ratio: 0.05, ..cement }, ..joint };
        let (soft, hard) = (Some(damped(JOINT)), Some(damped(stiffer)));
        plan.bonds = Some(BondPlan { law, joints: vec![soft, soft, soft, hard], ..plan.bonds.clone().expect("bonds") });
        let mut mixed = state.clone();
        for i in (0..state.len()).filter(|i| i % 3 == 0) {
            mixed.material[i] = 1;
            mixed.mass[i] *= 2.0;
        }
        let end = both(&mixed, &plan, 400, "alike for each pair of materials");
        assert!(broken(&end) > 20, "{} bonds broke", broken(&end));
    }
}

#[test]
fn a_bonded_run_moves_between_devices_while_bonds_break() {
    for law in [ELASTIC, STORED] {
        let (state, plan) = cracking_block(law, Integrator::VelocityVerlet);
        let whole = run(&state, &plan, cpu(), 400).expect("it runs through");
        let first = whole.bonds.iter().filter_map(|bond| bond.breakage).map(|b| b.step).min().expect("bonds break");
        let mut moved = state;
        for (device, until) in [(cpu(), first - 1), (gpu(), first + 15), (cpu(), first + 30), (gpu(), 400)] {
            let steps = until - moved.step;
            moved = run(&moved, &plan, device, steps).expect("it goes on");
        }
        assert_same(&moved, &whole, &format!("moved, {law:?}"));
    }
}

#[test]
fn same_bits_with_several_materials_and_prescribed_motion() {
    for ledger in [false, true] {
        let (mut state, mut plan) = scene(Law::GNTM, Integrator::VelocityVerlet, 2.0);
        plan.ledger = ledger;
        plan.materials = 2;
        let mut soft = plan.interactions[0];
        soft.normal_stiffness *= 0.5;
        soft.static_friction = 0.2;
        soft.dynamic_friction = 0.1;
        plan.interactions = vec![plan.interactions[0], soft, soft, soft];
        plan.walls[1].material = 1;
        let (velocity, angular_velocity) = ([Some(0.2), None, Some(0.0)], [None, Some(3.0), None]);
        plan.constraints.push(Constraint { velocity, angular_velocity, ..Constraint::FREE });
        for i in 0..state.len() {
            state.material[i] = (i % 3 == 0).into();
            state.constraint[i] = (i % 50 == 0).into();
        }
        both(&state, &plan, STEPS, "materials and constraints");
    }
}

/// Ramps of everything that a constraint says, with corners on steps and between them.
#[test]
fn same_bits_along_ramps_and_under_applied_forces() {
    for (integrator, ledger) in [
        (Integrator::VelocityVerlet, false),
        (Integrator::VelocityVerlet, true),
        (Integrator::Gear, false),
        (Integrator::Gear, true),
    ] {
        let (mut state, mut plan) = scene(Law::GNTM, integrator, 2.0);
        plan.ledger = ledger;
        let (velocity, angular_velocity) = ([Some(0.2), None, Some(0.0)], [None, Some(3.0), None]);
        plan.constraints.push(Constraint { velocity, angular_velocity, ..Constraint::FREE });
        plan.constraints.push(Constraint { force: [0.0, 2e-3, -1e-3], ..Constraint::FREE });
        let ramp =
            |constraint, drives, axis, points: &[[f64; 2]]| Ramp { constraint, drives, axis, points: points.to_vec() };
        plan.ramps = vec![
            ramp(1, Driven::Velocity, 0, &[[0.0, 0.2], [100.0 * plan.dt, 0.4], [3e-3, 0.1], [0.011, 0.3]]),
            ramp(1, Driven::AngularVelocity, 1, &[[1e-3, 3.0], [8e-3, -4.0]]),
            ramp(2, Driven::Force, 0, &[[0.0, 0.0], [5e-3, 4e-3]]),
        ];
        for i in 0..state.len() {
            state.constraint[i] = if i % 50 == 0 { 1 } else { 2 * u16::from(i % 7 == 0) };
        }
        let what = format!("ramps, {integrator:?}, ledger {ledger}");
        let end = both(&state, &plan, STEPS, &what);
        let mut moved = state;
        for (device, steps) in [(gpu(), 137), (cpu(), 63), (gpu(), STEPS - 200)] {
            moved = run(&moved, &plan, device, steps).expect("it goes on");
        }
        assert_same(&moved, &end, &what);
    }
}

#[test]
fn same_bits_with_any_skin_and_when_results_are_taken_often() {
    let (state, mut plan) = scene(Law::GNTM, Integrator::VelocityVerlet, 3.0);
    plan.ledger = false;
    let expected = run(&state, &plan, cpu(), STEPS).expect("the scene runs through on the CPU");
    for skin in [1e-4, 6e-3] {
        plan.search.skin = skin;
        let mut simulation = Simulation::new(state.clone(), plan.clone(), gpu()).expect("the scene is sound");
        let mut captures = Vec::new();
        for steps in [1, 2, 7, 50, 540] {
            simulation.advance(steps).expect("the scene runs through");
            captures.push(simulation.capture().expect("the device answers"));
        }
        assert!(simulation.searches() > 1, "the scene must rebuild its lists, or it shows nothing");
        // Captures are of their moments, whenever they are looked at.
        let states: Vec<State> = captures.into_iter().map(|c| c.state().expect("it arrives")).collect();
        assert_eq!(states.iter().map(|s| s.step).collect::<Vec<_>>(), [1, 3, 10, 60, STEPS]);
        assert_same(&states[4], &expected, "skin");
    }
}

#[test]
fn a_run_moves_between_devices() {
    for (law, integrator) in
        [(Law::GN, Integrator::VelocityVerlet), (Law::GNTM, Integrator::VelocityVerlet), (Law::GNTM, Integrator::Gear)]
    {
        let (state, plan) = scene(law, integrator, 2.0);
        let expected = run(&state, &plan, cpu(), STEPS).expect("the scene runs through");
        for devices in [[gpu(), cpu(), gpu()], [cpu(), gpu(), cpu()]] {
            let mut moving = state.clone();
            for (device, steps) in devices.into_iter().zip([1, 136, STEPS - 137]) {
                let taken = run(&moving, &plan, device, 0).expect("the state is taken up");
                if moving.forces_known {
                    assert_same(&taken, &moving, "a state that is taken up and looked at is the same");
                }
                moving = run(&moving, &plan, device, steps).expect("the scene runs through");
            }
            assert_same(&moving, &expected, &format!("{law:?} {integrator:?} {devices:?}"));
        }
    }
}

#[test]
fn faults_are_those_of_the_cpu() {
    let (state, plan) = scene(Law::GNTM, Integrator::VelocityVerlet, 2.0);
    let faults = |state: &State, plan: &Plan| {
        let [on_cpu, on_device] = [cpu(), gpu()].map(|device| run(state, plan, device, 400).map(|s| s.step));
        assert_eq!(on_device, on_cpu);
        on_cpu.expect_err("the scene is at fault")
    };
    let mut fast = state.clone();
    fast.velocity[7] = [0.0, 0.0, 300.0];
    fast.velocity[400] = [0.0, 0.0, 300.0];
    let soft = Plan { overlap_limit: 10.0, ..plan.clone() };
    assert!(matches!(faults(&fast, &soft), Fault::Escaped { .. }));
    let mut lost = state.clone();
    lost.angular_velocity[33] = [f64::NAN; 3];
    assert!(matches!(faults(&lost, &plan), Fault::NotFinite { .. }));
    for (ledger, limit) in [(true, 1e-4), (false, 1e-4), (false, 4e-3)] {
        let strict = Plan { overlap_limit: limit, ledger, ..plan.clone() };
        assert!(matches!(faults(&state, &strict), Fault::Overlap { .. }));
    }
    let mut tight = plan.clone();
    tight.search.skin = 0.1;
    assert!(matches!(faults(&state, &tight), Fault::BoxTooSmall { .. }));
}
