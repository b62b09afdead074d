//! The contract of bits across devices: kernels give what the CPU gives. Needs a device, or fails.
//!
//! `TDEM_TEST_DEVICE` says of which interface: `opencl`, which is taken without it and for which PoCL will do, or `cuda`.

mod common;

use common::bonded::{CEMENT, ELASTIC, JOINT, bond_neighbours, cracking_block, free_space, lattice};
use common::heated::{
    EXPANSION, NONE, REFERENCE, constant, frozen, heat_of, heated, heated_block, held_chain, in_turns, keep_books,
    still_lattice, temper, warm_block, warm_cloud,
};
use common::overlap;
use common::{DENSITY, random, scene, spheres};
use tdem_engine::cpu::Options;
use tdem_engine::gpu::Api;
use tdem_engine::physics::bond::{self, Cement, Form, Joint, Tension};
use tdem_engine::physics::contact::{Damping, Friction, Law};
use tdem_engine::physics::heat::{Conductor, Exchange, Path};
use tdem_engine::{
    Around, BondPlan, Constraint, Course, Device, Driven, Exposure, Fault, Integrator, Motion, Plan, Ramp, Relaxation,
    Scheme, Simulation, State, Turns,
};

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
    differ(what, "temperature", &found.temperature, &expected.temperature);
    differ(what, "heat rate", &found.heat_rate, &expected.heat_rate);
    differ(what, "heat accounts", &found.heat_accounts, &expected.heat_accounts);
    differ(what, "work per kelvin", &found.work_per_kelvin, &expected.work_per_kelvin);
    differ(what, "radius", &found.radius, &expected.radius);
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

/// Unlike materials, surfaces, a warm floor, contacts, expansion, ledger: in every scheme of bonds.
#[test]
fn same_bits_with_heat_while_bonds_break() {
    let dashpots = bond::Law { damping: bond::Damping::Viscous, ..ELASTIC };
    let stored = bond::Law { form: Form::Incremental(Tension::Stored), ..dashpots };
    let (verlet, gear) = (Integrator::VelocityVerlet, Integrator::Gear);
    for (law, integrator, ledger, beside, path, expansion) in [
        (ELASTIC, verlet, false, false, Path::Bar, EXPANSION),
        (dashpots, verlet, true, true, Path::Circle, 0.0),
        (dashpots, gear, true, false, Path::Bar, EXPANSION),
        (stored, verlet, false, true, Path::Bar, 0.0),
    ] {
        let (state, mut plan) = warm_block(law, integrator, expansion);
        keep_books(&mut plan, ledger);
        heat_of(&mut plan).contacts = path;
        plan.bonds.as_mut().expect("the plan has bonds").contact_in_bonded_pairs = beside;
        assert!(tdem_engine::gpu::source(&state, &plan).contains("#define ALIKE_LINKS 0"));
        let what = format!("heat, {law:?} {integrator:?} ledger {ledger} beside {beside} {path:?} {expansion}");
        let end = both(&state, &plan, 500, &what);
        assert!(broken(&end) > 20 && broken(&end) < end.bonds.len(), "{} bonds broke", broken(&end));
    }
}

/// Bonds from both sides, and each once.
#[test]
fn same_bits_within_open_sides() {
    for (law, integrator, every_step) in [
        (ELASTIC, Integrator::VelocityVerlet, false),
        (ELASTIC, Integrator::VelocityVerlet, true),
        (STORED, Integrator::Gear, false),
    ] {
        let (state, plan) = warm_block(law, integrator, 0.0);
        let mut bounded = plan.clone();
        bounded.search.every_step = every_step;
        // Those that are insulated are within one side, and so are two of the surfaces.
        heat_of(&mut bounded).sides = vec![1, 2, 3, 0];
        let end = both(&state, &bounded, 100, &format!("open sides, {law:?} {integrator:?}, every step {every_step}"));
        let plain = run(&state, &plan, cpu(), 100).expect("the scene runs through");
        assert!(end.temperature.iter().zip(&plain.temperature).any(|(a, b)| (a - b).abs() > 1e-3), "they conduct more");
    }
}

/// Where every step searches, each bond is evaluated once. Particles that cool part from those they touched.
#[test]
fn same_bits_with_heat_while_every_step_searches() {
    for (law, integrator, ledger, expansion) in
        [(ELASTIC, Integrator::VelocityVerlet, true, EXPANSION), (STORED, Integrator::Gear, false, 0.0)]
    {
        let (mut state, mut plan) = warm_block(law, integrator, expansion);
        keep_books(&mut plan, ledger);
        plan.search.every_step = true;
        plan.search.skin = 0.0;
        let cooling = Course(vec![[0.0, 500.0], [30.0, 250.0]]);
        heat_of(&mut plan).exposures[2] = Exposure { temperature: Some(cooling), exchanges: Vec::new() };
        state.exposure.iter_mut().skip(1).step_by(3).for_each(|exposure| *exposure = 2);
        let end = both(&state, &plan, 300, &format!("heat, {law:?} {integrator:?} ledger {ledger}, every step"));
        assert!(broken(&end) > 20, "{} bonds broke", broken(&end));
    }
}

/// Conductivity, specific heat, stiffness and strength by tables, in every scheme of bonds.
#[test]
fn same_bits_where_materials_depend_on_temperature() {
    let dashpots = bond::Law { damping: bond::Damping::Viscous, ..ELASTIC };
    let (verlet, gear) = (Integrator::VelocityVerlet, Integrator::Gear);
    for (law, integrator, ledger, every_step, path) in [
        (ELASTIC, verlet, false, false, Path::Bar),
        (dashpots, verlet, true, false, Path::Circle),
        (dashpots, gear, true, true, Path::Bar),
        (STORED, verlet, false, false, Path::Circle),
    ] {
        let (mut state, mut plan) = warm_block(law, integrator, 0.0);
        temper(&mut plan);
        plan.ledger = ledger;
        heat_of(&mut plan).contacts = path;
        if every_step {
            (plan.search.every_step, plan.search.skin) = (true, 0.0);
        }
        // From one piece of the tables to others, also down, also over several.
        state.exposure.iter_mut().skip(1).step_by(3).for_each(|exposure| *exposure = 3);
        let what = format!("tables, {law:?} {integrator:?} ledger {ledger} every step {every_step} {path:?}");
        let end = both(&state, &plan, 300, &what);
        assert!(broken(&end) > 10 && broken(&end) < end.bonds.len(), "{} bonds broke", broken(&end));
    }
    let (state, mut plan) = warm_cloud();
    temper(&mut plan);
    plan.ledger = true;
    both(&state, &plan, 200, "tables, a cloud");
}

/// A lattice of one size: what bonds are to heat is the same for all, or for each pair of materials.
#[test]
fn same_bits_with_heat_through_bonds_that_are_alike() {
    for (materials, expansion) in [(1, EXPANSION), (2, 0.0)] {
        let cement = Cement { tensile_strength: 1e5, shear_strength: 1e5, ..CEMENT };
        let joint = Joint { cement, ..JOINT };
        let mut plan = free_space(ELASTIC, joint);
        plan.ledger = false;
        plan.materials = materials;
        plan.interactions = vec![plan.interactions[0]; materials * materials];
        plan.bonds = Some(BondPlan {
            joints: vec![Some(joint); materials * materials],
            ..plan.bonds.clone().expect("the plan has bonds")
        });
        let mut state = spheres(&lattice([6, 3, 3]), DENSITY);
        bond_neighbours(&mut state, &plan);
        heated(&mut state, &mut plan, expansion);
        let heat = heat_of(&mut plan);
        heat.contacts = Path::Closed;
        heat.time_scale = 1e4;
        for (k, conductor) in heat.conductors.iter_mut().enumerate() {
            *conductor = Conductor { conductivity: [1.5, 2.1, 2.1, 3.5][k], section: 0.35 };
        }
        for i in 0..state.len() {
            state.material[i] = (i % materials) as u16;
            state.temperature[i] = REFERENCE + 300.0 * random(13, i as u64);
            state.velocity[i][0] = 100.0 * state.position[i][0];
        }
        let kernels = tdem_engine::gpu::source(&state, &plan);
        assert!(kernels.contains("#define ALIKE_LINKS 1"));
        assert_eq!(kernels.contains("#define ONE_LINK 1"), materials == 1);
        let end = both(&state, &plan, 300, &format!("heat, {materials} materials"));
        assert!(broken(&end) > 20, "{} bonds broke", broken(&end));
    }
}

/// A colliding cloud between walls: contacts begin and end, sizes change, lists are made anew.
#[test]
fn same_bits_with_heat_through_contacts_and_on_the_way_between_devices() {
    for ledger in [false, true] {
        let (state, mut plan) = warm_cloud();
        keep_books(&mut plan, ledger);
        let end = both(&state, &plan, 400, &format!("warm cloud, ledger {ledger}"));
        assert!(end.contacts.len() > 100 && end.wall_contacts.len() > 10, "the scene must be busy");
        let mut moved = state;
        for (device, steps) in [(gpu(), 1), (cpu(), 99), (gpu(), 100), (cpu(), 100), (gpu(), 100)] {
            let taken = run(&moved, &plan, device, 0).expect("the state is taken up");
            if moved.forces_known {
                assert_same(&taken, &moved, "a state that is taken up and looked at is the same");
            }
            moved = run(&moved, &plan, device, steps).expect("it goes on");
        }
        assert_same(&moved, &end, &format!("warm cloud, moved, ledger {ledger}"));
    }
}

/// Particles come to rest on the device after every step of the heat, in which they grow.
#[test]
fn same_bits_where_heat_and_motion_take_turns() {
    let mut plan = free_space(ELASTIC, JOINT);
    let mut state = spheres(&lattice([4, 2, 2]), DENSITY);
    bond_neighbours(&mut state, &plan);
    heated(&mut state, &mut plan, EXPANSION);
    plan.bonds.as_mut().expect("the plan has bonds").local_damping = 0.5;
    plan.dt = 5.0;
    let heat = heat_of(&mut plan);
    heat.time_scale = 1.0;
    let (scheme, dt) = (Scheme::Explicit, 1e-5);
    heat.motion = Motion::QuasiStatic(Relaxation { scheme, dt, ratio: 1e-2, at_most_steps: 300, check_every: 50 });
    let course = Course(vec![[0.0, REFERENCE], [20.0, REFERENCE + 200.0]]);
    heat.exposures.push(Exposure { temperature: Some(course), exchanges: Vec::new() });
    for i in 0..state.len() {
        state.exposure[i] = u16::from(state.position[i][0] < 1e-3);
    }
    for ledger in [false, true] {
        plan.ledger = ledger;
        let end = both(&state, &plan, 3, &format!("turns, ledger {ledger}"));
        assert!(end.radius.iter().zip(&state.radius).any(|(now, before)| now > before));
    }
}

#[test]
fn same_bits_where_heated_bodies_crack_between_steps_of_the_heat() {
    let (state, plan) = heated_block();
    let plan = in_turns(&plan, 25.0, 1e-3);
    let end = both(&state, &plan, 8, "cracks");
    assert!(end.bonds.iter().any(|bond| !bond.holds()));
    let half = run(&state, &plan, gpu(), 5).expect("the scene runs through on the device");
    assert_same(&run(&half, &plan, cpu(), 3).expect("it goes on"), &end, "cracks, begun on the device");
}

/// State and count of passes behind some steps of heat alone.
fn alone(state: &State, plan: &Plan, device: Device, steps: u64) -> Result<(State, Turns), Fault> {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), device)?;
    simulation.advance(steps)?;
    Ok((simulation.state()?, simulation.turns().expect("heat advances by itself")))
}

/// Contacts, bonds, a wall, flux, convection, radiation, prescribed temperatures; chunks of particles of which one is not full.
#[test]
fn same_bits_where_heat_goes_on_alone() {
    let (state, plan) = still_lattice();
    assert!(state.len() > 2 * 1024 && !state.len().is_multiple_of(1024), "{} particles", state.len());
    for (scheme, step, ledger) in [
        (Scheme::Explicit, 0.1, true),
        (Scheme::Explicit, 30.0, true),
        (Scheme::Implicit, 3.0, true),
        (Scheme::Implicit, 500.0, false),
    ] {
        let plan = Plan { ledger, ..frozen(&plan, scheme, step) };
        let what = format!("{scheme:?}, {step} s");
        for steps in [0, 1, 7] {
            let [(expected, passes), (found, passes_on_device)] =
                [cpu(), gpu()].map(|device| alone(&state, &plan, device, steps).expect("the scene runs through"));
            assert!(expected.contacts.len() > 1000 && expected.wall_contacts.len() > 100 && state.bonds.len() > 8000);
            assert_same(&found, &expected, &what);
            assert_eq!(passes_on_device, passes, "{what}");
            if step > 1.0 {
                assert!(passes.passes >= 4 * steps, "{what}: {passes:?}");
            }
            let came: f64 = expected.heat_accounts.iter().map(|account| account[0]).sum();
            assert!(!ledger || steps == 0 || came > 0.0, "{what}: {came}");
        }
        let half = alone(&state, &plan, gpu(), 3).expect("the scene runs through").0;
        let moved = alone(&half, &plan, cpu(), 4).expect("it goes on").0;
        assert_same(&moved, &alone(&state, &plan, gpu(), 7).expect("the scene runs through").0, &what);
    }
}

#[test]
fn faults_of_heat_alone_are_those_of_the_cpu() {
    let (mut state, mut plan) = still_lattice();
    let faults = |state: &State, plan: &Plan| {
        let found = [cpu(), gpu()].map(|device| alone(state, plan, device, 40).expect_err("the scene is at fault"));
        // What is not a number does not equal itself.
        assert_eq!(format!("{:?}", found[1]), format!("{:?}", found[0]));
        found[0].clone()
    };
    // What takes heat away takes more than there is, in a later part of a later step.
    let drain = Exchange { flux_area: 1e-3, ..NONE };
    let course = Course(vec![[0.0, 0.0], [50.0, -3e4]]);
    heat_of(&mut plan).exposures.push(Exposure { temperature: None, exchanges: vec![(drain, Around::flux(course))] });
    state.exposure[1234..1300].fill(4);
    for (scheme, step) in [(Scheme::Explicit, 20.0), (Scheme::Implicit, 3.0)] {
        let fault = faults(&state, &frozen(&plan, scheme, step));
        assert!(matches!(fault, Fault::Temperature { particle: 1234..1300, step: 2.., .. }), "{fault:?}");
    }
    // Heat beyond all numbers: there is no solution.
    for flux in [1e160, 1e308] {
        let (mut state, mut plan, _) = held_chain(5);
        let flood = Exchange { flux_area: 10.0, ..NONE };
        heat_of(&mut plan)
            .exposures
            .push(Exposure { temperature: None, exchanges: vec![(flood, Around::flux(constant(flux)))] });
        state.exposure[2] = 1;
        let fault = faults(&state, &frozen(&plan, Scheme::Implicit, 1.0));
        assert!(matches!(fault, Fault::Conduction { .. }), "{fault:?}");
    }
}

/// Without particles nothing is launched.
#[test]
fn heat_alone_in_nothing_is_nothing() {
    let (_, plan, _) = held_chain(1);
    for scheme in [Scheme::Explicit, Scheme::Implicit] {
        let (end, _) = alone(&State::default(), &frozen(&plan, scheme, 1.0), gpu(), 3).expect("nothing goes wrong");
        assert_eq!((end.step, end.len()), (3, 0));
    }
}

#[test]
fn heat_takes_the_memory_that_is_foretold() {
    let (warm, warm_plan) = warm_cloud();
    let cold_plan = Plan { heat: None, ..warm_plan.clone() };
    let nothing = State::default();
    let cold = State {
        temperature: nothing.temperature,
        heat_rate: nothing.heat_rate,
        exposure: nothing.exposure,
        reference_radius: nothing.reference_radius,
        ..warm.clone()
    };
    let n = warm.len();
    // An exposure, two radii, four accounts, the work of expansion and how much warmer it got; temperatures stand in spins.
    let each = 4 + 2 * 8 + 4 * 8 + 2 * 8;
    let held = |state: &State, plan: &Plan| {
        Simulation::new(state.clone(), plan.clone(), gpu()).expect("the scene is sound").bytes()
    };
    let of_heat = held(&warm, &warm_plan) - held(&cold, &cold_plan);
    // Beside the particles there are only tables.
    assert!((n * each..n * each + 1024).contains(&of_heat), "{of_heat} of {n}");
    let foretold = |plan: &Plan| tdem_engine::gpu::bytes(plan, n, 0, 0);
    assert_eq!(foretold(&warm_plan) - foretold(&cold_plan), n * each);
    // Where particles do not turn, temperatures stand apart, twice.
    let unturned = |plan: &Plan| Plan { law: Law { moments: false, ..plan.law }, ..plan.clone() };
    assert_eq!(foretold(&unturned(&warm_plan)) - foretold(&unturned(&cold_plan)), n * (each + 2 * 8));
}

#[test]
fn heat_alone_takes_the_memory_that_is_foretold() {
    let (state, plan) = still_lattice();
    let n = state.len();
    for (scheme, ledger) in [(Scheme::Explicit, false), (Scheme::Implicit, true)] {
        let plan = Plan { ledger, ..frozen(&plan, scheme, 1.0) };
        assert!(tdem_engine::gpu::source(&state, &plan).contains("\nDEVICE void implicit_balance("));
        let mut simulation = Simulation::new(state.clone(), plan.clone(), gpu()).expect("the scene is sound");
        let end = simulation.state().expect("the device answers");
        let (accounts, booked) = if ledger { (4 * 8 * n, 2 * 8 * n) } else { (0, 0) };
        let entries = 2 * (end.contacts.len() + end.bonds.len()) + end.wall_contacts.len();
        // The same run on the processor: temperature, two rates, capacity, exposure, accounts, rows of three kinds.
        let on_host = n * (4 * 8 + 2) + accounts + 3 * 8 * (n + 1) + entries * 12;
        let host = Simulation::new(state.clone(), plan.clone(), cpu()).expect("the scene is sound").bytes() - on_host;
        // The host keeps the accounts that it was given.
        let held = simulation.bytes() - host - accounts;
        // Temperature, two rates, capacity, exposure, three ends of rows; two accounts; seven vectors of a system.
        let system = if scheme == Scheme::Implicit { 7 * 8 * n } else { 0 };
        let least = n * (4 * 8 + 4 * 4) + booked + system + entries * 12;
        // Rows side by side are as long as the longest.
        assert!(held > least && (held as f64) < 1.25 * least as f64, "{held}, not {least}");
        assert!(tdem_engine::gpu::bytes(&plan, n, 7 * n, 0) >= least);
    }
}

/// Spheres at rest, too far apart to be listed, of which some grow to more than twice their size.
#[test]
fn spheres_that_grow_meet_those_that_were_not_listed() {
    let places: Vec<_> = (0..343)
        .map(|k| ([k % 7, k / 7 % 7, k / 49].map(|c| 0.014 * f64::from(c)), 4e-3 + 4e-4 * random(14, k as u64)))
        .collect();
    let mut plan = common::plan(Law::GNTM, [-0.1; 3], [0.2; 3], [false; 3]);
    plan.ledger = false;
    let mut state = spheres(&places, DENSITY);
    heated(&mut state, &mut plan, 2e-3);
    let course = Course(vec![[0.0, REFERENCE], [0.01, REFERENCE + 700.0], [0.02, REFERENCE + 100.0]]);
    let heat = heat_of(&mut plan);
    heat.exposures.push(Exposure { temperature: Some(course), exchanges: Vec::new() });
    state.exposure.iter_mut().step_by(3).for_each(|exposure| *exposure = 1);
    for skin in [1e-3, 3e-4] {
        plan.search.skin = skin;
        let grown = both(&state, &plan, 240, "grown");
        assert!(grown.contacts.len() > 50, "{} contacts", grown.contacts.len());
        both(&grown, &plan, 300, "grown and shrunk");
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
        // The lid comes down on particles that keep their height.
        plan.overlap_limit = 1.0;
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
        // The lid comes down on particles that keep their height.
        plan.overlap_limit = 1.0;
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
        assert!(matches!(faults(&state, &strict), Fault::Overlap { .. } | Fault::WallOverlap { .. }));
    }
    // Walls guard, too, and the smaller of two spheres sets the limit.
    for (ledger, law) in [(true, Law::GNTM), (false, Law::GNT), (false, Law::GN)] {
        let (state, plan) = overlap::soft_sphere_at_a_wall(law, ledger);
        assert!(matches!(faults(&state, &plan), Fault::WallOverlap { particle: 1, .. }));
        let (state, plan) = overlap::small_sphere_in_a_large_one(law, ledger);
        assert!(matches!(faults(&state, &plan), Fault::Overlap { first: 0, second: 1, .. }));
    }
    let mut tight = plan.clone();
    tight.search.skin = 0.1;
    assert!(matches!(faults(&state, &tight), Fault::BoxTooSmall { .. }));
    // A step of the heat that is too large for the first that touch.
    for ledger in [false, true] {
        let (mut state, mut plan) = warm_cloud();
        plan.ledger = ledger;
        heat_of(&mut plan).time_scale = 1e8;
        state.exposure.fill(0);
        assert!(matches!(faults(&state, &plan), Fault::Temperature { .. }));
    }
}

#[test]
fn spheres_that_are_all_fixed_may_overlap_as_they_like() {
    let held = |turning: Option<f64>| Constraint {
        velocity: [Some(0.0); 3],
        angular_velocity: [turning; 3],
        ..Constraint::FREE
    };
    for (integrator, ledger) in
        [(Integrator::VelocityVerlet, false), (Integrator::VelocityVerlet, true), (Integrator::Gear, false)]
    {
        let (mut state, mut plan) = scene(Law::GNTM, integrator, 2.0);
        plan.ledger = ledger;
        if !ledger {
            state.accounts.clear();
        }
        let [fixed, turns] = [0, 1].map(|k| (plan.constraints.len() + k) as u16);
        plan.constraints.extend([held(Some(0.0)), held(None)]);
        // Two spheres almost in the same place, far less apart than the limit allows.
        state.position[1] = state.position[0];
        state.position[1][0] += 0.2 * state.radius[0];
        let mut outcome = |constraints: [u16; 2]| {
            state.constraint[0] = constraints[0];
            state.constraint[1] = constraints[1];
            let [on_cpu, on_device] = [cpu(), gpu()].map(|device| run(&state, &plan, device, 3));
            match (on_cpu, on_device) {
                (Ok(on_cpu), Ok(on_device)) => {
                    assert_same(&on_device, &on_cpu, &format!("{integrator:?} {constraints:?}"));
                    true
                }
                (on_cpu, on_device) => {
                    let [on_cpu, on_device] = [on_cpu, on_device].map(|outcome| outcome.map(|state| state.step));
                    assert_eq!(on_device, on_cpu);
                    assert!(matches!(on_cpu, Err(Fault::Overlap { .. })), "{on_cpu:?}");
                    false
                }
            }
        };
        assert!(outcome([fixed, fixed]), "{integrator:?}, ledger {ledger}: both are fixed");
        assert!(!outcome([fixed, turns]) && !outcome([0, fixed]), "one of them turns, or moves");
    }
}
