//! Scenes with heat.

use super::bonded::{CLAMPED, ELASTIC, JOINT, RADIUS, chain, free_space};
use super::{random, scene};
use tdem_engine::cpu::Options;
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::heat::{Conductor, Exchange, Path};
use tdem_engine::{Course, Exposure, HeatPlan, Integrator, Motion, Plan, Simulation, State, Thermal};

pub(crate) const REFERENCE: f64 = 293.15;
pub(crate) const SPECIFIC_HEAT: f64 = 900.0;
pub(crate) const EXPANSION: f64 = 1e-4;

/// Adds heat to a scene: all of one temperature, insulated.
pub(crate) fn heated(state: &mut State, plan: &mut Plan, expansion: f64) {
    let n = state.len();
    let conductor = Conductor { conductivity: 1.5, section: 0.35 };
    plan.heat = Some(HeatPlan {
        time_scale: 2.0,
        reference_temperature: REFERENCE,
        materials: vec![Thermal { specific_heat: SPECIFIC_HEAT, expansion }; plan.materials],
        conductors: vec![conductor; plan.materials * plan.materials],
        contacts: Path::Bar,
        exposures: vec![Exposure::default()],
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

pub(crate) fn constant(value: f64) -> Course {
    Course(vec![[0.0, value]])
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
    heat.exposures
        .push(Exposure { temperature: None, exchanges: vec![(warm, constant(-400.0)), (glow, constant(900.0))] });
    for i in 0..state.len() {
        state.temperature[i] = 350.0 + 300.0 * random(11, i as u64);
        state.radius[i] = state.reference_radius[i] * (1.0 + EXPANSION * (state.temperature[i] - REFERENCE));
        state.exposure[i] = u16::from(i % 5 == 0);
    }
    (state, plan)
}
