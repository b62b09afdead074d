//! The guard of overlaps.

mod common;

use common::overlap::{small_sphere_in_a_large_one, soft_sphere_at_a_wall};
use tdem_engine::cpu::{Options, Width};
use tdem_engine::physics::contact::Law;
use tdem_engine::{Fault, Ledger, Plan, Simulation, State};

fn fault(state: &State, plan: &Plan, width: Width) -> Fault {
    let mut simulation = Simulation::new(state.clone(), plan.clone(), Options { width, ..Options::default() })
        .expect("the scene is sound");
    simulation.advance(1000).expect_err("the sphere is too soft")
}

const WIDTHS: [Width; 3] = [Width::One, Width::Portable, Width::Widest];

#[test]
fn a_soft_sphere_does_not_go_through_a_wall_without_a_word() {
    for width in WIDTHS {
        for law in [Law::GN, Law::GNT, Law::GNTM] {
            let (state, plan) = soft_sphere_at_a_wall(law, true);
            match fault(&state, &plan, width) {
                Fault::WallOverlap { particle: 1, wall, ratio, limit, .. } => {
                    assert_eq!((wall.as_str(), limit), ("floor", 0.5));
                    assert!(ratio > 0.5 && ratio < 0.6, "{ratio}: found in the first step beyond the limit");
                }
                other => panic!("{other:?}"),
            }
        }
    }
}

#[test]
fn a_small_sphere_does_not_vanish_in_a_large_one_without_a_word() {
    for width in WIDTHS {
        let (state, plan) = small_sphere_in_a_large_one(Law::GNTM, true);
        match fault(&state, &plan, width) {
            Fault::Overlap { first: 0, second: 1, ratio, .. } => assert!(ratio > 0.5 && ratio < 0.55, "{ratio}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn the_largest_overlap_counts_walls() {
    let (state, plan) = soft_sphere_at_a_wall(Law::GNTM, true);
    let mut simulation = Simulation::new(state, plan.clone(), Options::default()).expect("the scene is sound");
    simulation.advance(6).expect("the sphere is not deep yet");
    let state = simulation.state().expect("a state can be taken");
    let depth = (0.01 - state.position[1][2]) / 0.01;
    assert!(depth > 0.1);
    assert!((Ledger::of(&state, &plan).largest_overlap - depth).abs() < 1e-12);
}
