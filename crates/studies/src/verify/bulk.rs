//! Random packings: what many spheres show within their scatter.

use super::scene::{Bench, GRAVITY, Scene, With, random, random_vector, solid};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::{Damping, Law};
use tdem_engine::{Domain, Fault, Ledger, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "bulk/small-pile",
        tier: Tier::Quick,
        source: "equilibrium: the floor carries the weight; spheres with three contacts or more rest",
        about: "60 spheres settle on a floor in a shaft that repeats sideways.",
        body: small_pile,
    },
    Case {
        name: "bulk/frictionless",
        tier: Tier::Full,
        source: "isostaticity: 6 contacts per sphere; random close packing: 0.635 to 0.64 (O'Hern et al. 2003)",
        about: "1000 equal frictionless spheres settle on a floor in a shaft that repeats sideways.",
        body: |bench| packing(bench, 0.0, 3, (5.9, 6.1), (0.63, 0.645)),
    },
    Case {
        name: "bulk/friction-0.5",
        tier: Tier::Full,
        source: "Silbert, Soft Matter 6 (2010) 2918, and similar packings, as bands",
        about: "The same with friction 0.5: looser and with fewer contacts.",
        body: |bench| packing(bench, 0.5, 2, (4.6, 5.0), (0.575, 0.605)),
    },
    Case {
        name: "bulk/determinism",
        tier: Tier::Full,
        source: "one case, one result: the order of every sum is decided by ids",
        about: "The packing with friction, 3000 steps, twice and on 1, 2 and 3 threads.",
        body: determinism,
    },
];

const RADIUS: f64 = 0.005;
const DENSITY: f64 = 2500.0;
const FRICTION: Law = Law { damping: Damping::Restitution, ..Law::GNTM };

/// Spheres thrown at random into a column that repeats sideways, about to fall on a floor.
fn column(count: usize, side: f64, friction: f64) -> Scene {
    let material = solid(2e7, 0.3, DENSITY);
    let law = if friction > 0.0 { FRICTION } else { Law { damping: Damping::Restitution, ..Law::GN } };
    let interaction = material.with_itself().friction(friction).restitution(0.3).clamped();
    let rayleigh = tdem_engine::physics::stability::rayleigh_time(RADIUS, DENSITY, material.elastic);
    let mut scene = Scene::new(law, interaction, 0.15 * rayleigh);
    scene.plan.gravity = [0.0, 0.0, -GRAVITY];
    scene.plan.ledger = false;
    scene.floor();
    let spacing = 2.2 * RADIUS;
    let per_side = (side / spacing) as usize;
    let spacing = side / per_side as f64;
    for k in 0..count {
        let cell = [k % per_side, k / per_side % per_side, k / (per_side * per_side)];
        let jitter = random_vector(60, k);
        let room = 0.5 * spacing - RADIUS;
        let place = std::array::from_fn(|d| (cell[d] as f64 + 0.5) * spacing + 0.99 * room * jitter[d]);
        // No lattice may survive: everything is stirred.
        let index = scene.moving(RADIUS, DENSITY, place, random_vector(61, k).map(|v| 0.5 * v));
        scene.state.velocity[index][2] -= 0.3 * random(62, k);
    }
    scene.plan.domain = Domain { min: [0.0, 0.0, -1.0], max: [side, side, 10.0], periodic: [true, true, false] };
    scene.plan.search.skin = 0.15 * RADIUS;
    // Nothing would ever stop a common drift sideways over a floor without friction.
    for d in 0..2 {
        let drift = scene.state.velocity.iter().map(|v| v[d]).sum::<f64>() / count as f64;
        scene.state.velocity.iter_mut().for_each(|v| v[d] -= drift);
    }
    scene
}

/// The same packing of a material ten times as stiff.
fn stiffened(scene: &Scene, state: State) -> Scene {
    let mut stiff = Scene { state, plan: scene.plan.clone() };
    for interaction in &mut stiff.plan.interactions {
        interaction.normal_stiffness *= 10.0;
        interaction.tangential_stiffness *= 10.0;
    }
    stiff.plan.dt *= 0.1_f64.sqrt();
    // The springs of contacts carry on with the displacement that gives the same force.
    for contact in &mut stiff.state.contacts {
        contact.displacement = contact.displacement.map(|d| 0.1 * d);
    }
    for contact in &mut stiff.state.wall_contacts {
        contact.displacement = contact.displacement.map(|d| 0.1 * d);
    }
    stiff
}

/// Runs until the spheres rest and their forces balance, at most a time in s; the state.
fn settle(bench: &mut Bench, scene: &Scene, longest: f64) -> Result<State, Fault> {
    let mut simulation = bench.start(scene)?;
    loop {
        simulation.advance(1000)?;
        let state = simulation.state()?;
        let ledger = Ledger::of(&state, &scene.plan);
        let rests = ledger.kinetic() < 1e-8 * unit_of_energy(&state) && ledger.unbalanced_force_ratio < 5e-4;
        if rests || (simulation.step() - scene.state.step) as f64 * scene.plan.dt > longest {
            bench.seal(&state);
            return Ok(state);
        }
    }
}

/// m g R of all spheres, J.
fn unit_of_energy(state: &State) -> f64 {
    state.mass[0] * GRAVITY * RADIUS * state.len() as f64
}

/// Kinetic energy of the spheres with three contacts or more, J. With two contacts a sphere may turn about the line through
/// them, with one about its normal: neither slides, and nothing resists it.
fn kinetic_of_held(scene: &Scene, state: &State) -> f64 {
    let mut contacts = vec![0_u32; state.len()];
    let pairs = state.contacts.iter().flat_map(|contact| [contact.first, contact.second]);
    for particle in pairs.chain(state.wall_contacts.iter().map(|contact| contact.particle)) {
        contacts[particle as usize] += 1;
    }
    let mut held = state.clone();
    for i in (0..state.len()).filter(|&i| contacts[i] < 3) {
        (held.velocity[i], held.angular_velocity[i]) = ([0.0; 3], [0.0; 3]);
    }
    Ledger::of(&held, &scene.plan).kinetic()
}

fn judge_rest(bench: &mut Bench, scene: &Scene, state: &State) {
    let ledger = Ledger::of(state, &scene.plan);
    let weight = state.mass.iter().sum::<f64>() * GRAVITY;
    bench.judge("force on the floor", "N", -ledger.wall_force[2], Kind::ClosedForm.relative(weight, 1e-3));
    let kinetic = kinetic_of_held(scene, state) / unit_of_energy(state);
    bench.judge(
        "kinetic energy over m g R, spheres with three contacts",
        "1",
        kinetic,
        Kind::Statistical.at_most(1e-6),
    );
    let ratio = ledger.unbalanced_force_ratio;
    bench.judge("unbalanced force ratio", "1", ratio, Kind::Statistical.at_most(1e-3));
}

fn small_pile(bench: &mut Bench) -> Result<(), Fault> {
    let scene = column(60, 8.0 * RADIUS, 0.5);
    let state = settle(bench, &scene, 3.0)?;
    judge_rest(bench, &scene, &state);
    Ok(())
}

/// Contacts per sphere without rattlers, and the filled part of space, away from floor and surface.
fn interior(scene: &Scene, state: &State, friction: f64) -> (f64, f64) {
    let n = state.len();
    let mut touches = vec![0_u32; n];
    let mut alive = vec![true; n];
    // A sphere is a rattler if too few neighbours touch it to hold it; taking it away may free others.
    let least = if friction > 0.0 { 2 } else { 4 };
    loop {
        touches.fill(0);
        for contact in &state.contacts {
            let (a, b) = (contact.first as usize, contact.second as usize);
            if alive[a] && alive[b] {
                touches[a] += 1;
                touches[b] += 1;
            }
        }
        let free: Vec<usize> = (0..n).filter(|&i| alive[i] && touches[i] < least).collect();
        if free.is_empty() {
            break;
        }
        for i in free {
            alive[i] = false;
        }
    }
    let mut heights: Vec<f64> = state.position.iter().map(|x| x[2]).collect();
    heights.sort_by(f64::total_cmp);
    let (low, high) = (heights[n / 4], heights[3 * n / 4]);
    let inside: Vec<usize> = (0..n).filter(|&i| alive[i] && (low..high).contains(&state.position[i][2])).collect();
    let mean = inside.iter().map(|&i| f64::from(touches[i])).sum::<f64>() / inside.len() as f64;
    // Volume of the spheres, cut by the two planes.
    let filled: f64 = state.position.iter().map(|x| cap(x[2], high) - cap(x[2], low)).sum();
    let length = scene.plan.domain.length();
    (mean, filled / (length[0] * length[1] * (high - low)))
}

/// Volume of a sphere at height `centre` that lies below a plane.
fn cap(centre: f64, plane: f64) -> f64 {
    let depth = (plane - centre + RADIUS).clamp(0.0, 2.0 * RADIUS);
    std::f64::consts::PI * depth * depth * (RADIUS - depth / 3.0)
}

fn packing(
    bench: &mut Bench,
    friction: f64,
    stages: u32,
    contacts: (f64, f64),
    filled: (f64, f64),
) -> Result<(), Fault> {
    let mut scene = column(1000, 14.0 * RADIUS, friction);
    let mut state = settle(bench, &scene, 1.0)?;
    // Fallen and settled soft and fast, then stiff: contacts beyond the isostatic 6 grow with the root of the overlap.
    for _ in 0..stages {
        scene = stiffened(&scene, state);
        state = settle(bench, &scene, 1.2)?;
    }
    let overlap = Ledger::of(&state, &scene.plan).largest_overlap;
    bench.judge("largest overlap, of a radius", "1", overlap, Kind::Statistical.at_most(2e-3));
    judge_rest(bench, &scene, &state);
    let (mean, solid) = interior(&scene, &state, friction);
    let band = |(low, high): (f64, f64)| Kind::Statistical.within(0.5 * (low + high), 0.5 * (high - low));
    bench.judge("contacts per sphere, without rattlers", "1", mean, band(contacts));
    bench.judge("filled part of space", "1", solid, band(filled));
    Ok(())
}

fn determinism(bench: &mut Bench) -> Result<(), Fault> {
    let scene = column(1000, 14.0 * RADIUS, 0.5);
    let first = bench.after(&scene, 3000)?.hash();
    for threads in [1, 2, 3] {
        let mut simulation = bench.start_on(&scene, threads)?;
        simulation.advance(3000)?;
        let same = f64::from(u8::from(simulation.state()?.hash() == first));
        bench.judge(format!("same bits on {threads} threads"), "1", same, Kind::Invariance.within(1.0, 0.0));
    }
    Ok(())
}
