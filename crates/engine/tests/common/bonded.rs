//! Scenes with bonds.

use super::{DENSITY, plan, random, spheres, wall};
use tdem_engine::physics::bond::{Cement, Damping, Form, Joint, Law};
use tdem_engine::physics::contact;
use tdem_engine::{Bond, BondPlan, BondTables, Constraint, Integrator, Plan, State};

pub(crate) const RADIUS: f64 = 5e-3;
/// Of touching spheres.
pub(crate) const LATTICE_CONSTANT: f64 = 2.0 * std::f64::consts::SQRT_2 * RADIUS;

pub(crate) const CEMENT: Cement<f64> = Cement {
    stiffness_ratio: 0.4,
    radius_multiplier: 1.0,
    tensile_strength: f64::INFINITY,
    shear_strength: f64::INFINITY,
    internal_friction: 0.0,
    moment_contribution: 1.0,
    damping_ratio: 0.0,
};
/// About 60 kN/m between spheres of [`RADIUS`].
pub(crate) const JOINT: Joint<f64> = Joint { cement: CEMENT, stiffness_per_area: 7.5e8, young_modulus: 0.0 };
pub(crate) const ELASTIC: Law = Law { form: Form::Total, damping: Damping::Off };

pub(crate) fn bond_plan(law: Law, joint: Joint<f64>) -> BondPlan {
    BondPlan {
        law,
        joints: vec![Some(joint)],
        tables: BondTables::default(),
        contact_in_bonded_pairs: false,
        local_damping: 0.0,
    }
}

/// A plan without gravity in a wide box.
pub(crate) fn free_space(law: Law, joint: Joint<f64>) -> Plan {
    let mut plan = plan(contact::Law::GNTM, [-1.0; 3], [1.0; 3], [false; 3]);
    plan.dt = 1e-5;
    plan.bonds = Some(bond_plan(law, joint));
    plan
}

/// Bonds all pairs that lie no farther apart than 1.01 of the sum of their radii.
pub(crate) fn bond_neighbours(state: &mut State, plan: &Plan) {
    let (n, mut bonds) = (state.len(), Vec::new());
    let period = plan.domain.period();
    for i in 0..n {
        for j in i + 1..n {
            let (a, b) = (state.position[i], state.position[j]);
            let offset = period.nearest([b[0] - a[0], b[1] - a[1], b[2] - a[2]].into());
            if offset.dot(offset).sqrt() < 1.01 * (state.radius[i] + state.radius[j]) {
                bonds.push(Bond::new(state.id[i], state.id[j], 1.0));
            }
        }
    }
    state.make_bonds(bonds);
}

/// Touching spheres on a face-centred cubic lattice, a corner at the origin.
pub(crate) fn lattice(cells: [usize; 3]) -> Vec<([f64; 3], f64)> {
    let base = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let count = cells[0] * cells[1] * cells[2];
    let corner = |k: usize| [k % cells[0], k / cells[0] % cells[1], k / cells[0] / cells[1]];
    (0..count)
        .flat_map(|k| base.map(|b| std::array::from_fn(|d| (corner(k)[d] as f64 + b[d]) * LATTICE_CONSTANT)))
        .map(|place| (place, RADIUS))
        .collect()
}

/// Spheres in a row along x, all bonded.
pub(crate) fn chain(count: usize, plan: &Plan) -> State {
    let places: Vec<_> = (0..count).map(|k| ([2.0 * RADIUS * k as f64, 0.0, 0.0], RADIUS)).collect();
    let mut state = spheres(&places, DENSITY);
    bond_neighbours(&mut state, plan);
    state
}

/// Nothing moves.
pub(crate) const CLAMPED: Constraint =
    Constraint { velocity: [Some(0.0); 3], angular_velocity: [Some(0.0); 3], ..Constraint::FREE };

/// A block of two materials, bonded also through the faces of a box that repeats in y, that drifts through these faces,
/// lies on a floor, is hit by loose spheres, and is pulled at both ends until it cracks.
pub(crate) fn cracking_block(law: Law, integrator: Integrator) -> (State, Plan) {
    let cells = [5, 4, 2];
    let width = cells[1] as f64 * LATTICE_CONSTANT;
    let mut plan = plan(contact::Law::GNTM, [-0.1, 0.0, -0.1], [0.2, width, 0.3], [false, true, false]);
    plan.integrator = integrator;
    plan.dt = if integrator == Integrator::Gear { 5e-6 } else { 1e-5 };
    plan.gravity = [0.0, 0.0, -50.0];
    plan.search.skin = 4e-4;
    let cement =
        Cement { tensile_strength: 8e4, shear_strength: 4e4, internal_friction: 0.3, damping_ratio: 0.03, ..CEMENT };
    let lattice_joint = Joint { cement, ..JOINT };
    let other = Joint { stiffness_per_area: 0.0, young_modulus: 6e6, cement };
    let weak = Joint { cement: Cement { tensile_strength: 6e4, ..cement }, ..lattice_joint };
    plan.materials = 2;
    plan.interactions = vec![plan.interactions[0]; 4];
    plan.bonds = Some(BondPlan {
        joints: vec![Some(lattice_joint), Some(weak), Some(weak), Some(other)],
        ..bond_plan(law, lattice_joint)
    });
    plan.walls = vec![wall("floor", [0.0, 0.0, 1.0], [0.0; 3])];
    let pull = |speed: f64| Constraint { velocity: [Some(speed), None, None], ..Constraint::FREE };
    plan.constraints = vec![Constraint::FREE, pull(-1.2), pull(1.5)];

    let mut places = lattice(cells);
    let solid = places.len();
    let top = cells[2] as f64 * LATTICE_CONSTANT + RADIUS;
    for k in 0..12 {
        let [column, row, number] = [k % 4, k / 4, k].map(f64::from);
        places.push(([0.006 + 0.02 * column, 0.01 + 0.017 * row, top + 1e-4 * number], (0.6 + 0.03 * number) * RADIUS));
    }
    let mut state = spheres(&places, DENSITY);
    state.wall_position = vec![[0.0, 0.0, -RADIUS]];
    let length = cells[0] as f64 * LATTICE_CONSTANT;
    for i in 0..state.len() {
        let x = state.position[i][0];
        state.velocity[i] = [0.1 * random(7, i as u64), 2.5, if i < solid { 0.0 } else { -2.0 }];
        state.angular_velocity[i] = [0.0, 0.0, random(8, i as u64)];
        state.material[i] = u16::from(x > 0.45 * length);
        if i < solid {
            state.constraint[i] =
                u16::from(x < 0.1 * LATTICE_CONSTANT) + 2 * u16::from(x > length - 0.6 * LATTICE_CONSTANT);
        }
    }
    bond_neighbours(&mut state, &plan);
    state.bonds.retain(|bond| (bond.second as usize) < solid);
    for (bond, k) in state.bonds.iter_mut().zip(0..) {
        bond.strength = 0.8 + 0.4 * random(9, k);
    }
    (state, plan)
}
