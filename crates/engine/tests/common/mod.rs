//! Scenes that the engine's tests share.
#![allow(dead_code, reason = "each test binary uses some of the scenes")]

pub(crate) mod bonded;
pub(crate) mod heated;
pub(crate) mod overlap;

use tdem_engine::physics::contact::{Damping, Interaction, Law, damping::restitution_factor};
use tdem_engine::physics::material::{Elastic, shear_modulus_eff, young_modulus_eff};
use tdem_engine::{Constraint, Domain, Integrator, Plan, Search, State, Wall};

/// The material of the gravity packing.
pub(crate) const PLASTIC: Elastic = Elastic { young_modulus: 9.33e6, poisson_ratio: 0.352 };
pub(crate) const DENSITY: f64 = 920.0;

/// Random numbers in [0, 1) by counting: the n-th number of a stream does not depend on the others.
pub(crate) fn random(stream: u64, n: u64) -> f64 {
    let mut z = stream.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(n.wrapping_mul(0xbf58_476d_1ce4_e5b9));
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}

pub(crate) fn interaction(a: Elastic, b: Elastic) -> Interaction<f64> {
    Interaction {
        normal_stiffness: 4.0 / 3.0 * young_modulus_eff(a, b),
        tangential_stiffness: 8.0 * shear_modulus_eff(a, b),
        normal_damping: 1500.0,
        tangential_damping: 150.0,
        static_friction: 0.6,
        dynamic_friction: 0.5,
        least_normal_force: 0.0,
    }
}

/// The same with a restitution instead of a coefficient.
pub(crate) fn with_restitution(e: f64, mut interaction: Interaction<f64>) -> Interaction<f64> {
    interaction.normal_damping = restitution_factor(e);
    interaction
}

pub(crate) fn plan(law: Law, min: [f64; 3], max: [f64; 3], periodic: [bool; 3]) -> Plan {
    Plan {
        dt: 2e-5,
        integrator: Integrator::VelocityVerlet,
        law,
        materials: 1,
        interactions: vec![interaction(PLASTIC, PLASTIC)],
        bonds: None,
        heat: None,
        walls: Vec::new(),
        gravity: [0.0; 3],
        constraints: vec![Constraint::FREE],
        ramps: Vec::new(),
        gauges: Vec::new(),
        domain: Domain { min, max, periodic },
        search: Search { skin: 1e-3, every_step: false },
        overlap_limit: 0.5,
        ledger: true,
    }
}

pub(crate) fn wall(name: &str, normal: [f64; 3], velocity: [f64; 3]) -> Wall {
    Wall { name: name.into(), normal, velocity, material: 0 }
}

/// Spheres of given places and radii at rest.
pub(crate) fn spheres(places: &[([f64; 3], f64)], density: f64) -> State {
    let n = places.len();
    let mass = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r * r * r * density;
    State {
        id: (0..n as u32).collect(),
        material: vec![0; n],
        constraint: vec![0; n],
        radius: places.iter().map(|p| p.1).collect(),
        mass: places.iter().map(|p| mass(p.1)).collect(),
        position: places.iter().map(|p| p.0).collect(),
        image: vec![[0; 3]; n],
        velocity: vec![[0.0; 3]; n],
        angular_velocity: vec![[0.0; 3]; n],
        force: vec![[0.0; 3]; n],
        moment: vec![[0.0; 3]; n],
        accounts: vec![[0.0; 4]; n],
        ..State::default()
    }
}

/// A loose cloud of spheres of unequal size on a jittered lattice, moving at random, about to collide.
pub(crate) fn cloud(per_side: usize, spacing: f64, radius_ratio: f64) -> State {
    let mut places = Vec::new();
    for k in 0..per_side * per_side * per_side {
        let cell = [k % per_side, k / per_side % per_side, k / per_side / per_side];
        let radius =
            0.5 * spacing / radius_ratio + random(1, k as u64) * (0.5 * spacing - 0.5 * spacing / radius_ratio);
        let room = 0.5 * spacing - radius;
        let place = std::array::from_fn(|d| {
            (cell[d] as f64 + 0.5) * spacing + room * (2.0 * random(2, (3 * k + d) as u64) - 1.0)
        });
        places.push((place, 0.999 * radius));
    }
    let mut state = spheres(&places, DENSITY);
    for k in 0..state.len() {
        state.velocity[k] = std::array::from_fn(|d| 2.0 * random(3, (3 * k + d) as u64) - 1.0);
        state.angular_velocity[k] = std::array::from_fn(|d| 40.0 * random(4, (3 * k + d) as u64) - 20.0);
    }
    state
}

/// A cloud that collides and falls in a box which repeats in x and has walls below, above and at the sides.
pub(crate) fn scene(law: Law, integrator: Integrator, radius_ratio: f64) -> (State, Plan) {
    let (per_side, spacing) = (9, 0.02);
    let length = per_side as f64 * spacing;
    let mut plan = plan(law, [0.0, -0.01, -0.01], [length, length + 0.01, length + 0.01], [true, false, false]);
    plan.integrator = integrator;
    if law.damping == Damping::Restitution {
        plan.interactions[0] = with_restitution(0.6, plan.interactions[0]);
    }
    plan.gravity = [5.0, 0.0, -300.0];
    plan.search.skin = 2e-3;
    let mut state = cloud(per_side, spacing, radius_ratio);
    plan.walls = vec![
        wall("floor", [0.0, 0.0, 1.0], [0.0, 0.0, 0.3]),
        wall("left", [0.0, 1.0, 0.0], [0.0; 3]),
        wall("right", [0.0, -1.0, 0.0], [0.1, 0.0, 0.0]),
        wall("lid", [0.0, 0.0, -1.0], [0.0, 0.0, -0.5]),
    ];
    state.wall_position = vec![[0.0; 3], [0.0; 3], [0.0, length, 0.0], [0.0, 0.0, length]];
    (state, plan)
}
