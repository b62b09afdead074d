//! What is prescribed and applied along ramps: motion, work, gauges.

mod common;

use common::bonded::{CLAMPED, ELASTIC, JOINT, RADIUS, chain, free_space};
use std::sync::Arc;
use tdem_engine::cpu::Options;
use tdem_engine::{
    Constraint, Driven, Fault, Gauge, Group, Integrator, Ledger, Measure, Plan, Ramp, Reading, Simulation, State,
};

const INTEGRATORS: [Integrator; 2] = [Integrator::VelocityVerlet, Integrator::Gear];

fn advance(state: &State, plan: &Plan, steps: u64) -> State {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), Options::default()).expect("the scene is sound");
    simulation.advance(steps).expect("the scene runs through");
    simulation.state().expect("a state can be taken")
}

/// A ramp of x of the second constraint but the free one.
fn ramp(drives: Driven, points: &[[f64; 2]]) -> Ramp {
    Ramp { constraint: 2, drives, axis: 0, points: points.to_vec() }
}

/// Spheres in a row along x, all bonded, the first clamped.
fn clamped_chain(count: usize, integrator: Integrator) -> (State, Plan) {
    let mut plan = free_space(ELASTIC, JOINT);
    plan.integrator = integrator;
    plan.constraints = vec![Constraint::FREE, CLAMPED, Constraint::FREE];
    let mut state = chain(count, &plan);
    state.constraint[0] = 1;
    state.constraint[count - 1] = 2;
    (state, plan)
}

/// Energy that went in, J, and how much of it is missing.
fn energy(state: &State, plan: &Plan) -> [f64; 2] {
    let ledger = Ledger::of(state, plan);
    [ledger.external_work, ledger.energy_error]
}

#[test]
fn a_value_is_straight_between_points_and_constant_beyond() {
    let ramp = ramp(Driven::Force, &[[1.0, 10.0], [2.0, 30.0], [4.0, -10.0]]);
    let values = [-1.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0].map(|time| ramp.value(time));
    assert_eq!(values, [10.0, 10.0, 20.0, 30.0, 10.0, -10.0, -10.0]);
}

#[test]
fn a_level_ramp_has_the_bits_of_a_constant() {
    for integrator in INTEGRATORS {
        let (state, mut plan) = clamped_chain(3, integrator);
        plan.constraints[2].velocity[0] = Some(0.3);
        plan.constraints[2].force[1] = 0.7;
        let constant = advance(&state, &plan, 300);
        plan.constraints[2].force[1] = 9.0;
        plan.constraints[2].velocity[0] = Some(9.0);
        plan.ramps = vec![
            ramp(Driven::Velocity, &[[1e-4, 0.3], [2e-4, 0.3]]),
            Ramp { axis: 1, ..ramp(Driven::Force, &[[1e-3, 0.7]]) },
        ];
        let mut level = advance(&state, &plan, 300);
        // The work is summed in another way.
        assert!((energy(&level, &plan)[0] - energy(&constant, &plan)[0]).abs() < 1e-15);
        level.accounts.clone_from(&constant.accounts);
        assert_eq!(level, constant, "{integrator:?}");
    }
}

/// Trapezes between steps: what a ramp prescribes is covered exactly where its corners lie on steps.
#[test]
fn a_ramp_goes_as_far_as_its_integral() {
    for integrator in INTEGRATORS {
        let (mut state, mut plan) = clamped_chain(3, integrator);
        state.make_bonds(Vec::new());
        plan.bonds = None;
        state.orientation.clear();
        state.bonded_position.clear();
        plan.constraints[2].velocity[0] = Some(0.0);
        // The corners are those of steps 100 and 300.
        let corners = [100, 300].map(|step| plan.time(step));
        plan.ramps = vec![ramp(Driven::Velocity, &[[0.0, 0.0], [corners[0], 0.02], [corners[1], -0.01]])];
        let mut simulation = Simulation::new(state.clone(), plan.clone(), Options::default()).expect("it is sound");
        let mut went = [0.0; 3];
        for (k, went) in went.iter_mut().enumerate() {
            simulation.advance([100, 200, 50][k]).expect("it runs through");
            let now = simulation.state().expect("a state can be taken");
            *went = now.position[2][0] - state.position[2][0];
            let expected = [0.02, -0.01, -0.01][k];
            assert_eq!(now.velocity[2][0], expected, "{integrator:?}: at corners the velocity is that of the point");
        }
        let expected = [0.01 * 1e-3, 0.01 * 1e-3 + 0.005 * 2e-3, 0.01 * 1e-3 + 0.005 * 2e-3 - 0.01 * 5e-4];
        for (went, expected) in went.into_iter().zip(expected) {
            assert!((went - expected).abs() < 1e-16, "{integrator:?}: {went} m instead of {expected} m");
        }
    }
}

#[test]
fn the_ledger_knows_what_a_ramped_grip_puts_in() {
    for (integrator, tolerance) in [(Integrator::VelocityVerlet, 4e-3), (Integrator::Gear, 4e-3)] {
        let (state, mut plan) = clamped_chain(6, integrator);
        plan.constraints[2].velocity[0] = Some(0.0);
        plan.ramps = vec![ramp(Driven::Velocity, &[[0.0, 0.0], [2e-3, 0.05], [5e-3, 0.05]])];
        plan.dt = 5e-6;
        let end = advance(&state, &plan, 1000);
        let [work, error] = energy(&end, &plan);
        assert!(work > 1e-4, "{work} J");
        assert!(error.abs() < tolerance * work, "{integrator:?}: {error} J of {work} J");
        plan.dt *= 0.5;
        let finer = energy(&advance(&state, &plan, 2000), &plan)[1];
        assert!(finer.abs() < 0.6 * error.abs(), "{integrator:?}: {error} J, with half the step {finer} J");
    }
}

/// A mass on a spring under a force that is there at once swings to twice the elongation of rest.
#[test]
fn a_sudden_force_overshoots_by_a_factor_of_two_and_its_work_is_booked() {
    for (integrator, tolerance) in [(Integrator::VelocityVerlet, 2e-5), (Integrator::Gear, 2e-2)] {
        let (state, mut plan) = clamped_chain(2, integrator);
        let force_at_start = 10.0;
        plan.constraints[2].force[0] = force_at_start;
        // The bond: stiffness per area times the area of its section.
        let at_rest = force_at_start / (7.5e8 * std::f64::consts::PI * RADIUS * RADIUS);
        plan.dt = 1e-6;
        plan.gauges =
            vec![Gauge { name: "mass".into(), measure: Measure::Of(Group::at_start(Arc::from([1]), &state, &plan)) }];
        let mut simulation = Simulation::new(state, plan.clone(), Options::default()).expect("the scene is sound");
        let (mut farthest, mut first_force) = (0.0_f64, None);
        for _ in 0..150 {
            let now = simulation.state().expect("a state can be taken");
            let Reading::Of { force, displacement, .. } = plan.gauges[0].read(&now, &plan) else { panic!("a group") };
            first_force.get_or_insert(force[0]);
            farthest = farthest.max(displacement[0]);
            let ledger = Ledger::of(&now, &plan);
            assert!(
                ledger.energy_error.abs() <= tolerance * force_at_start * at_rest,
                "{integrator:?}: {} J",
                ledger.energy_error
            );
            simulation.advance(2).expect("the scene runs through");
        }
        assert_eq!(first_force, Some(force_at_start));
        let ratio = farthest / at_rest;
        assert!((ratio - 2.0).abs() < 1e-3, "{integrator:?}: overshoot {ratio}");
    }
}

#[test]
fn a_run_resumed_within_a_ramp_has_the_same_bits() {
    for integrator in INTEGRATORS {
        let (state, mut plan) = clamped_chain(5, integrator);
        plan.constraints[2].velocity[0] = Some(0.0);
        plan.constraints.push(Constraint::FREE);
        plan.ramps = vec![
            ramp(Driven::Velocity, &[[0.0, 0.0], [1e-3, 0.1], [3e-3, -0.2]]),
            Ramp { constraint: 3, axis: 1, ..ramp(Driven::Force, &[[0.5e-3, 0.0], [2.5e-3, 3.0]]) },
        ];
        let mut state = state;
        state.constraint[2] = 3;
        let whole = advance(&state, &plan, 300);
        for at in [1, 37, 100, 211] {
            let half_way = advance(&state, &plan, at);
            assert_eq!(advance(&half_way, &plan, 300 - at), whole, "{integrator:?} resumed at {at}");
        }
    }
}

#[test]
fn two_groups_that_move_apart() {
    let (mut state, mut plan) = clamped_chain(4, Integrator::VelocityVerlet);
    plan.domain.periodic = [false, true, false];
    let group = |ids: &[u32], state: &State| Group::at_start(Arc::from(ids), state, &plan);
    let gauge =
        Gauge { name: "middle".into(), measure: Measure::Between([group(&[0, 1], &state), group(&[2, 3], &state)]) };
    for k in 2..4 {
        // Beyond the face that repeats, and away by 1 mm along the line between both groups.
        state.position[k][0] += 1e-3;
        state.position[k][1] += 0.25 - plan.domain.length()[1];
        state.image[k][1] += 1;
    }
    let Reading::Between { elongation, strain } = gauge.read(&state, &plan) else { panic!("two groups") };
    assert!((elongation - 1e-3).abs() < 1e-16, "{elongation} m");
    assert!((strain - 1e-3 / (4.0 * RADIUS)).abs() < 1e-14, "{strain}");
}

#[test]
fn ramps_that_drive_nothing_or_go_back_in_time_are_refused() {
    let (state, plan) = clamped_chain(2, Integrator::VelocityVerlet);
    for ramp in [
        ramp(Driven::Velocity, &[[0.0, 1.0]]),
        ramp(Driven::Force, &[]),
        ramp(Driven::Force, &[[1.0, 0.0], [1.0, 2.0]]),
        ramp(Driven::Force, &[[1.0, f64::NAN]]),
        Ramp { constraint: 7, ..ramp(Driven::Force, &[[0.0, 1.0]]) },
    ] {
        let plan = Plan { ramps: vec![ramp], ..plan.clone() };
        let refused = Simulation::new(state.clone(), plan, Options::default());
        assert!(matches!(refused, Err(Fault::Inconsistent { .. })));
    }
}
