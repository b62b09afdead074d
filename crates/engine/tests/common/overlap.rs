//! Spheres that are too soft for their speed.

use super::{PLASTIC, interaction, plan, spheres, wall};
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::material::Elastic;
use tdem_engine::{Plan, State};

const SOFT: Elastic = Elastic { young_modulus: 1e4, ..PLASTIC };

fn soft(law: Law, ledger: bool) -> Plan {
    let mut plan = plan(law, [-1.0; 3], [1.0; 3], [false; 3]);
    plan.interactions = vec![interaction(SOFT, SOFT)];
    plan.interactions[0].normal_damping = 0.0;
    plan.ledger = ledger;
    plan
}

/// A slow sphere and one that would go through a floor.
pub(crate) fn soft_sphere_at_a_wall(law: Law, ledger: bool) -> (State, Plan) {
    let mut plan = soft(law, ledger);
    plan.walls = vec![wall("side", [1.0, 0.0, 0.0], [0.0; 3]), wall("floor", [0.0, 0.0, 1.0], [0.0; 3])];
    let mut state = spheres(&[([0.5, 0.0, 0.011], 0.01), ([0.7, 0.0, 0.011], 0.01)], 7800.0);
    state.velocity = vec![[0.0; 3], [0.0, 0.0, -30.0]];
    state.wall_position = vec![[0.0; 3]; 2];
    (state, plan)
}

/// A small sphere that would vanish in a large one, 30 times its size.
pub(crate) fn small_sphere_in_a_large_one(law: Law, ledger: bool) -> (State, Plan) {
    let mut state = spheres(&[([0.0; 3], 0.3), ([0.0, 0.0, 0.311], 0.01)], 7800.0);
    state.velocity[1] = [0.0, 0.0, -10.0];
    (state, soft(law, ledger))
}
