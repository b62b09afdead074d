//! Scenes with heat.

use super::bonded::{
    CEMENT, CLAMPED, ELASTIC, JOINT, LATTICE_CONSTANT, RADIUS, bond_neighbours, chain, cracking_block, free_space,
    lattice,
};
use super::{DENSITY, random, scene, spheres};
use tdem_engine::cpu::Options;
use tdem_engine::physics::bond::{self, Cement, Joint};
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::heat::{Conductor, Dissipation, Exchange, Path};
use tdem_engine::{
    Around, BondTables, Course, Exposure, HeatPlan, Integrator, Motion, Plan, Relaxation, Scheme, Simulation, State,
    Table, Thermal, ThermalTables,
};

pub(crate) const REFERENCE: f64 = 293.15;
pub(crate) const SPECIFIC_HEAT: f64 = 900.0;
pub(crate) const EXPANSION: f64 = 1e-4;

/// Adds heat to a scene: all of one temperature, insulated.
pub(crate) fn heated(state: &mut State, plan: &mut Plan, expansion: f64) {
    let n = state.len();
    let conductor = Conductor { conductivity: 1.5, section: 0.35 };
    plan.heat = Some(HeatPlan {
        dissipation: Dissipation::default(),
        time_scale: 2.0,
        reference_temperature: REFERENCE,
        materials: vec![Thermal { specific_heat: SPECIFIC_HEAT, expansion }; plan.materials],
        conductors: vec![conductor; plan.materials * plan.materials],
        tables: ThermalTables::default(),
        contacts: Path::Bar,
        exposures: vec![Exposure::default()],
        sides: Vec::new(),
        walls: vec![None; plan.walls.len()],
        motion: Motion::Stepped,
    });
    state.temperature = vec![REFERENCE; n];
    state.heat_rate = vec![0.0; n];
    state.exposure = vec![0; n];
    state.reference_radius = if plan.expands() { state.radius.clone() } else { Vec::new() };
}

pub(crate) fn heat_of(plan: &mut Plan) -> &mut HeatPlan {
    plan.heat.as_mut().expect("the plan has heat")
}

/// With a ledger, motion makes heat, too.
pub(crate) fn keep_books(plan: &mut Plan, ledger: bool) {
    plan.ledger = ledger;
    let some = Dissipation { friction: 0.9, damping: 0.8 };
    heat_of(plan).dissipation = if ledger { some } else { Dissipation::default() };
}

pub(crate) fn constant(value: f64) -> Course {
    Course(vec![[0.0, value]])
}

/// A fluid and walls of one temperature.
pub(crate) fn furnace(temperature: Course) -> Around {
    Around { fluid: Some(temperature.clone()), surroundings: Some(temperature), flux: None }
}

pub(crate) fn after(state: &State, plan: &Plan, options: Options, steps: u64) -> State {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), options).expect("the scene is sound");
    simulation.advance(steps).expect("the scene runs through");
    simulation.state().expect("a state can be taken")
}

/// A chain that is held in place, and the conductance of its bonds.
pub(crate) fn held_chain(count: usize) -> (State, Plan, f64) {
    let mut plan = free_space(ELASTIC, JOINT);
    plan.constraints.push(CLAMPED);
    let mut state = chain(count, &plan);
    state.constraint = vec![1; count];
    heated(&mut state, &mut plan, 0.0);
    heat_of(&mut plan).time_scale = 1e5;
    let conductance = 1.5 * 0.35 * (2.0 * RADIUS) * (2.0 * RADIUS) / (2.0 * RADIUS);
    (state, plan, conductance)
}

/// A colliding cloud between walls of which two are warm, expanding.
pub(crate) fn warm_cloud() -> (State, Plan) {
    let (mut state, mut plan) = scene(Law::GNTM, Integrator::VelocityVerlet, 2.0);
    heated(&mut state, &mut plan, EXPANSION);
    let heat = heat_of(&mut plan);
    heat.time_scale = 3e3;
    heat.walls[0] = Some(Course(vec![[0.0, 300.0], [10.0, 900.0]]));
    heat.walls[2] = Some(constant(700.0));
    let warm = Exchange { flux_area: 2e-5, conductance: 0.0, radiation: 0.0, resistance: 0.0 };
    let glow = Exchange { flux_area: 0.0, conductance: 1e-3, radiation: 5e-12, resistance: 30.0 };
    heat.exposures.push(Exposure {
        temperature: None,
        exchanges: vec![(warm, Around::flux(constant(-400.0))), (glow, furnace(constant(900.0)))],
    });
    for i in 0..state.len() {
        state.temperature[i] = 350.0 + 300.0 * random(11, i as u64);
        state.radius[i] = state.reference_radius[i] * (1.0 + EXPANSION * (state.temperature[i] - REFERENCE));
        state.exposure[i] = u16::from(i % 5 == 0);
    }
    (state, plan)
}

/// The cracking block of two materials that conduct and expand differently and of two sizes, warmed from below,
/// held at a temperature at one end, losing and gaining heat through its top.
pub(crate) fn warm_block(law: bond::Law, integrator: Integrator, expansion: f64) -> (State, Plan) {
    let (mut state, mut plan) = cracking_block(law, integrator);
    state.radius.iter_mut().step_by(3).for_each(|radius| *radius *= 0.97);
    heated(&mut state, &mut plan, expansion);
    let heat = heat_of(&mut plan);
    heat.time_scale = 1e4;
    heat.materials[1] = Thermal { specific_heat: 0.6 * SPECIFIC_HEAT, expansion: 0.7 * expansion };
    let conductor = |conductivity| Conductor { conductivity, section: 0.35 };
    heat.conductors = vec![conductor(1.5), conductor(2.1), conductor(2.1), conductor(3.5)];
    heat.walls[0] = Some(Course(vec![[0.0, 300.0], [20.0, 500.0]]));
    let convection = Exchange { flux_area: 0.0, conductance: 2e-3, radiation: 5e-12, resistance: 30.0 };
    let flux = Exchange { flux_area: 1e-4, conductance: 0.0, radiation: 0.0, resistance: 0.0 };
    // All that can act on one surface, each with a course of its own.
    let all = Exchange { flux_area: 7e-5, ..convection };
    let around = Around {
        flux: Some(Course(vec![[0.0, 100.0], [5.0, -200.0]])),
        fluid: Some(constant(350.0)),
        surroundings: Some(Course(vec![[3.0, 400.0], [9.0, 800.0]])),
    };
    let open = |exchanges| Exposure { temperature: None, exchanges };
    heat.exposures.extend([
        open(vec![(convection, furnace(Course(vec![[0.0, 300.0], [7.03, 900.0], [30.0, 400.0]])))]),
        open(vec![(flux, Around::flux(constant(-300.0))), (all, around)]),
        Exposure { temperature: Some(Course(vec![[1.0, 310.0], [25.0, 480.0]])), exchanges: Vec::new() },
    ]);
    let highest = state.position.iter().fold(0.0, |highest: f64, place| highest.max(place[2]));
    for i in 0..state.len() {
        let [x, _, z] = state.position[i];
        state.temperature[i] = 300.0 + 200.0 * random(12, i as u64);
        state.exposure[i] = match (x < 1e-3, z > 0.6 * highest) {
            (true, _) => 3,
            (false, true) => 1 + (i % 2) as u16,
            (false, false) => 0,
        };
    }
    (state, plan)
}

/// Lets everything that can depend on temperature do so: materials in turn, bonds of all pairs; stiffness only where bonds
/// remember nothing.
pub(crate) fn temper(plan: &mut Plan) {
    let materials = plan.materials;
    let conductivities =
        [Table(vec![[280.0, 2.0], [350.0, 1.3], [480.0, 1.1]]), Table(vec![[300.0, 1.0], [310.0, 4.0], [450.0, 3.0]])];
    let specific_heats = [
        Table(vec![[300.0, 900.0], [340.0, 1000.0], [345.0, 2500.0], [350.0, 1000.0]]),
        Table(vec![[250.0, 500.0], [700.0, 800.0]]),
    ];
    let heat = heat_of(plan);
    heat.conductors.iter_mut().for_each(|conductor| conductor.conductivity = 1.0);
    heat.tables = ThermalTables {
        conductivity: (0..materials).map(|k| conductivities[k % 2].clone()).collect(),
        specific_heat: (0..materials).map(|k| specific_heats[k % 2].clone()).collect(),
    };
    if let Some(bonds) = &mut plan.bonds {
        let falling = |to: f64| Table(vec![[293.15, 1.0], [400.0, 0.5 * (1.0 + to)], [520.0, to]]);
        let of_pairs = |to: f64| {
            (0..materials * materials).map(|k| falling(if k % (materials + 1) == 0 { to } else { to - 0.1 })).collect()
        };
        let stiffness = if bonds.remembers() { Vec::new() } else { of_pairs(0.4) };
        bonds.tables = BondTables { stiffness, strength: of_pairs(0.7) };
    }
}

pub(crate) const NONE: Exchange<f64> = Exchange { flux_area: 0.0, conductance: 0.0, radiation: 0.0, resistance: 0.0 };

/// The same with nothing moving, in steps of the heat.
pub(crate) fn frozen(plan: &Plan, scheme: Scheme, step: f64) -> Plan {
    let mut plan = Plan { dt: step, ..plan.clone() };
    let heat = heat_of(&mut plan);
    (heat.motion, heat.time_scale) = (Motion::Frozen(scheme), 1.0);
    plan
}

/// Heat and motion in turns, in steps of the heat.
pub(crate) fn in_turns(plan: &Plan, step: f64, ratio: f64) -> Plan {
    let mut plan = Plan { dt: step, ..plan.clone() };
    plan.bonds.as_mut().expect("the plan has bonds").local_damping = 0.7;
    let heat = heat_of(&mut plan);
    let relaxation = Relaxation { scheme: Scheme::Implicit, dt: 2e-5, ratio, at_most_steps: 20_000, check_every: 50 };
    (heat.motion, heat.time_scale) = (Motion::QuasiStatic(relaxation), 1.0);
    plan
}

/// A block of two materials of which one expands five times as much, heated through one side until it cracks.
pub(crate) fn heated_block() -> (State, Plan) {
    let mut plan = free_space(ELASTIC, JOINT);
    plan.materials = 2;
    plan.interactions = vec![plan.interactions[0]; 4];
    let cement = Cement { tensile_strength: 1.5e5, shear_strength: 1.5e5, ..CEMENT };
    plan.bonds.as_mut().expect("the plan has bonds").joints = vec![Some(Joint { cement, ..JOINT }); 4];
    plan.constraints.push(CLAMPED);
    let mut state = spheres(&lattice([4, 4, 4]), DENSITY);
    for i in 0..state.len() {
        state.material[i] = u16::from(state.position[i][0] > 1.9 * LATTICE_CONSTANT);
        state.constraint[i] = u16::from(state.position[i][2] < 0.1 * LATTICE_CONSTANT);
    }
    bond_neighbours(&mut state, &plan);
    for (bond, k) in state.bonds.iter_mut().zip(0..) {
        bond.strength = 0.7 + 0.6 * random(9, k);
    }
    heated(&mut state, &mut plan, EXPANSION);
    let film = Exchange { conductance: 5e-3, ..NONE };
    let heat = heat_of(&mut plan);
    heat.materials[1].expansion *= 5.0;
    let course = Course(vec![[0.0, REFERENCE], [200.0, REFERENCE + 600.0]]);
    heat.exposures.push(Exposure { temperature: None, exchanges: vec![(film, Around::fluid(course))] });
    for i in 0..state.len() {
        state.exposure[i] = u16::from(state.position[i][2] > 3.4 * LATTICE_CONSTANT);
    }
    (state, plan)
}

/// More than two chunks of spheres of several sizes, temperatures and exposures, also prescribed ones, on a lattice that
/// repeats in y and stands on a warm floor. Most neighbours are bonded, the others touch; nothing moves.
pub(crate) fn still_lattice() -> (State, Plan) {
    let cells = [9, 8, 8];
    let mut plan = free_space(ELASTIC, JOINT);
    (plan.domain.min, plan.domain.max[1]) = ([-0.1, 0.0, -0.1], cells[1] as f64 * LATTICE_CONSTANT);
    plan.domain.periodic = [false, true, false];
    plan.materials = 2;
    plan.interactions = vec![plan.interactions[0]; 4];
    plan.bonds.as_mut().expect("the plan has bonds").joints = vec![Some(JOINT); 4];
    plan.walls = vec![super::wall("floor", [0.0, 0.0, 1.0], [0.0; 3])];
    plan.constraints.push(CLAMPED);
    let mut places = lattice(cells);
    places.iter_mut().zip(0..).for_each(|((_, radius), k)| *radius *= 1.001 + 0.008 * random(15, k));
    let mut state = spheres(&places, DENSITY);
    state.wall_position = vec![[0.0, 0.0, -RADIUS]];
    state.constraint.fill(1);
    bond_neighbours(&mut state, &plan);
    let mut count = 0;
    state.bonds.retain(|_| {
        count += 1;
        count % 5 > 0
    });
    heated(&mut state, &mut plan, 0.0);
    let conductor = |conductivity| Conductor { conductivity, section: 0.35 };
    let heat = heat_of(&mut plan);
    heat.materials[1].specific_heat *= 0.6;
    heat.conductors = vec![conductor(1.5), conductor(2.1), conductor(2.1), conductor(3.5)];
    heat.walls[0] = Some(Course(vec![[0.0, 300.0], [100.0, 900.0]]));
    let flux = Exchange { flux_area: 2e-5, ..NONE };
    let glow = Exchange { conductance: 1e-3, radiation: 5e-12, resistance: 30.0, ..NONE };
    let open = |exchanges| Exposure { temperature: None, exchanges };
    let cooling = Course(vec![[0.0, 900.0], [50.0, 600.0]]);
    heat.exposures.extend([
        open(vec![
            (flux, Around::flux(Course(vec![[0.0, 1e5], [100.0, 4e5]]))),
            (glow, Around { fluid: Some(cooling.clone()), surroundings: Some(cooling), ..Around::default() }),
        ]),
        Exposure {
            temperature: Some(Course(vec![[0.0, 300.0], [80.0, 500.0]])),
            exchanges: vec![(glow, Around::fluid(constant(900.0)))],
        },
        open(vec![(Exchange { conductance: 2e-3, ..NONE }, Around::fluid(constant(280.0)))]),
    ]);
    for i in 0..state.len() {
        state.material[i] = u16::from(i % 3 == 0);
        state.temperature[i] = 300.0 + 200.0 * random(16, i as u64);
        state.exposure[i] = [0, 0, 1, 0, 2, 0, 0, 3, 0, 0, 0][i % 11];
    }
    (state, plan)
}
