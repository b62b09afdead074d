//! What may not depend on how neighbours are found, how particles are called, or how space is turned.

use super::scene::{Bench, PLASTIC, Scene, With, random, random_vector};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::Law;
use tdem_engine::{Domain, Fault, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "search/all-pairs",
        tier: Tier::Quick,
        source: "trying all pairs",
        about: "300 spheres of a size ratio of 5 at random places: touching pairs, in all combinations of directions that repeat.",
        body: all_pairs,
    },
    Case {
        name: "search/all-pairs-while-moving",
        tier: Tier::Quick,
        source: "trying all pairs",
        about: "The same spheres moving through each other, looked at ten times; lists hold while nothing moved half a skin.",
        body: while_moving,
    },
    Case {
        name: "search/far-from-the-bulk",
        tier: Tier::Quick,
        source: "trying all pairs",
        about: "The same spheres moving, and touching pairs of them up to 1000 boxes away in all directions; x repeats, or none does.",
        body: far_from_the_bulk,
    },
    Case {
        name: "search/quarter-turn",
        tier: Tier::Quick,
        source: "sums over x and y commute, so that a quarter turn about z changes no bit",
        about: "27 unequal spheres collide in a box with walls; the same scene turned by 90 degrees about z.",
        body: quarter_turn,
    },
    Case {
        name: "search/names",
        tier: Tier::Quick,
        source: "ids decide orders, nothing else",
        about: "The same scene with gaps between the ids, and, to rounding, with the ids shuffled.",
        body: names,
    },
];

const BOX: f64 = 1.0;

/// Spheres of radii 0.02 to 0.1 at random places in the unit box, soft enough to pass through each other.
fn crowd(periodic: [bool; 3], stream: u64) -> Scene {
    let mut interaction = PLASTIC.with_itself();
    interaction.normal_stiffness = 1e-3;
    let mut scene = Scene::new(Law::GN, interaction, 1e-3);
    scene.plan.domain = Domain { min: [0.0; 3], max: [BOX; 3], periodic };
    scene.plan.overlap_limit = f64::INFINITY;
    for k in 0..300 {
        let u = random(stream, k);
        let radius = 0.02 + 0.08 * u * u * u;
        let place = std::array::from_fn(|d| {
            let u = random(stream + 1, 3 * k + d);
            if periodic[d] { u * BOX } else { radius + u * (BOX - 2.0 * radius) }
        });
        scene.sphere(radius, PLASTIC.density, place);
    }
    scene.plan.search.skin = 0.01;
    scene
}

/// Touching pairs by trying all.
fn brute_force(state: &State, domain: &Domain) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    let length = domain.length();
    for i in 0..state.len() {
        for j in i + 1..state.len() {
            let mut square = 0.0;
            for d in 0..3 {
                let mut offset = (state.position[j][d] - state.position[i][d]).abs();
                if domain.periodic[d] {
                    offset = offset.min(length[d] - offset);
                }
                square += offset * offset;
            }
            if square.sqrt() < state.radius[i] + state.radius[j] {
                pairs.push((state.id[i], state.id[j]));
            }
        }
    }
    pairs
}

/// How many pairs are in one list only.
fn difference(a: &[(u32, u32)], b: &[(u32, u32)]) -> f64 {
    let only = |a: &[(u32, u32)], b: &[(u32, u32)]| a.iter().filter(|pair| !b.contains(pair)).count();
    (only(a, b) + only(b, a)) as f64
}

fn listed(state: &State) -> Vec<(u32, u32)> {
    state.contacts.iter().map(|contact| (contact.first, contact.second)).collect()
}

fn all_pairs(bench: &mut Bench) -> Result<(), Fault> {
    for combination in 0..8_u32 {
        let periodic = std::array::from_fn(|d| combination >> d & 1 == 1);
        let scene = crowd(periodic, 10 + u64::from(combination));
        let state = bench.after(&scene, 0)?;
        let (found, expected) = (listed(&state), brute_force(&state, &scene.plan.domain));
        let axes: String = ["x", "y", "z"].iter().zip(periodic).filter(|(_, p)| *p).map(|(axis, _)| *axis).collect();
        let name = if axes.is_empty() { "no direction repeats".into() } else { format!("{axes} repeat") };
        let what = format!("{name}: pairs missed or invented, of {}", expected.len());
        bench.judge(what, "1", difference(&found, &expected), Kind::Invariance.within(0.0, 0.0));
    }
    Ok(())
}

fn while_moving(bench: &mut Bench) -> Result<(), Fault> {
    let mut scene = crowd([true; 3], 40);
    for (k, velocity) in scene.state.velocity.iter_mut().enumerate() {
        *velocity = random_vector(42, k);
    }
    let mut simulation = bench.start(&scene)?;
    let (mut wrong, mut pairs) = (0.0, 0);
    for _ in 0..10 {
        simulation.advance(37)?;
        let state = simulation.state()?;
        let expected = brute_force(&state, &scene.plan.domain);
        pairs += expected.len();
        wrong += difference(&listed(&state), &expected);
    }
    bench.judge(format!("pairs missed or invented, of {pairs}"), "1", wrong, Kind::Invariance.within(0.0, 0.0));
    let searches = simulation.searches() as f64;
    bench.judge("lists made in 370 steps, at least", "1", searches, Kind::Invariance.at_least(10.0));
    bench.judge("lists made in 370 steps, at most", "1", searches, Kind::Invariance.at_most(180.0));
    bench.seal(&simulation.state()?);
    Ok(())
}

fn far_from_the_bulk(bench: &mut Bench) -> Result<(), Fault> {
    const FAR: f64 = 1000.0 * BOX;
    for periodic in [[false; 3], [true, false, false]] {
        let mut scene = crowd(periodic, 60);
        for d in (0..3).filter(|&d| !periodic[d]) {
            (scene.plan.domain.min[d], scene.plan.domain.max[d]) = (-2.0 * FAR, 2.0 * FAR);
        }
        for k in 0..20 {
            let mut place: [f64; 3] = std::array::from_fn(|d| FAR * (2.0 * random(61, 3 * k + d) - 1.0));
            // Some are far in fewer directions, and near the bulk in the others.
            place
                .iter_mut()
                .enumerate()
                .filter(|(d, _)| periodic[*d] || k % 4 == *d)
                .for_each(|(_, x)| *x /= 2.0 * FAR);
            place[0] = if periodic[0] { place[0].abs() } else { place[0] };
            for turn in 0..2 {
                scene.sphere(0.06, PLASTIC.density, [place[0], place[1] + 0.1 * f64::from(turn), place[2]]);
            }
        }
        for (k, velocity) in scene.state.velocity.iter_mut().enumerate() {
            *velocity = random_vector(62, k);
        }
        let mut simulation = bench.start(&scene)?;
        let (mut wrong, mut pairs) = (0.0, 0);
        for _ in 0..5 {
            let state = simulation.state()?;
            let expected = brute_force(&state, &scene.plan.domain);
            pairs += expected.len();
            wrong += difference(&listed(&state), &expected);
            simulation.advance(29)?;
        }
        let name = if periodic[0] { "x repeats" } else { "no direction repeats" };
        let what = format!("{name}: pairs missed or invented, of {pairs}");
        bench.judge(what, "1", wrong, Kind::Invariance.within(0.0, 0.0));
        bench.seal(&simulation.state()?);
    }
    Ok(())
}

/// 27 unequal spheres that collide in a box with walls.
fn bustle() -> Scene {
    let spacing = 0.022;
    let interaction = PLASTIC.with_itself().friction(0.4).dashpots(100.0, 20.0).clamped();
    let mut scene = Scene::new(Law::GNTM, interaction, 2e-5);
    scene.plan.gravity = [90.0, -30.0, -270.0];
    for k in 0..27 {
        let cell = [k % 3, k / 3 % 3, k / 9];
        let place = std::array::from_fn(|d| (cell[d] as f64 + 0.5) * spacing);
        let radius = 0.008 + 0.0028 * random(50, k);
        let index = scene.moving(radius, PLASTIC.density, place, random_vector(51, k));
        scene.state.angular_velocity[index] = random_vector(52, k).map(|w| 30.0 * w);
    }
    let side = 3.0 * spacing;
    for (normal, point) in [
        ([1.0, 0.0, 0.0], [0.0; 3]),
        ([-1.0, 0.0, 0.0], [side, 0.0, 0.0]),
        ([0.0, 1.0, 0.0], [0.0; 3]),
        ([0.0, -1.0, 0.0], [0.0, side, 0.0]),
        ([0.0, 0.0, 1.0], [0.0; 3]),
        ([0.0, 0.0, -1.0], [0.0, 0.0, side]),
    ] {
        scene.wall(normal, point);
    }
    scene
}

const BUSTLE_STEPS: u64 = 2000;

fn quarter_turn(bench: &mut Bench) -> Result<(), Fault> {
    let turn = |[x, y, z]: [f64; 3]| [-y, x, z];
    let scene = bustle();
    let mut turned = scene.clone();
    let state = &mut turned.state;
    for field in [&mut state.position, &mut state.velocity, &mut state.angular_velocity, &mut state.wall_position] {
        for v in field.iter_mut() {
            *v = turn(*v);
        }
    }
    turned.plan.gravity = turn(turned.plan.gravity);
    for wall in &mut turned.plan.walls {
        wall.normal = turn(wall.normal);
    }
    let straight = bench.after(&scene, BUSTLE_STEPS)?;
    let other = bench.after(&turned, BUSTLE_STEPS)?;
    let differ = |a: &[[f64; 3]], b: &[[f64; 3]]| a.iter().zip(b).filter(|&(a, b)| turn(*a) != *b).count() as f64;
    let exact = Kind::Invariance.within(0.0, 0.0);
    bench.judge("positions that differ", "1", differ(&straight.position, &other.position), exact);
    bench.judge("velocities that differ", "1", differ(&straight.velocity, &other.velocity), exact);
    bench.judge("spins that differ", "1", differ(&straight.angular_velocity, &other.angular_velocity), exact);
    bench.judge("contacts", "1", straight.contacts.len() as f64, Kind::Invariance.at_least(10.0));
    Ok(())
}

fn names(bench: &mut Bench) -> Result<(), Fault> {
    let scene = bustle();
    let plain = bench.after(&scene, BUSTLE_STEPS)?;
    let mut gaps = scene.clone();
    gaps.state.id.iter_mut().for_each(|id| *id = 1000 * *id + 7);
    let found = bench.after(&gaps, BUSTLE_STEPS)?;
    let differ = plain.position.iter().zip(&found.position).filter(|(a, b)| a != b).count() as f64;
    bench.judge("ids with gaps: positions that differ", "1", differ, Kind::Invariance.within(0.0, 0.0));

    // Other ids mean another order of sums, so rounding differs; collisions let that grow slowly.
    let few = 200;
    let plain = bench.after(&scene, few)?;
    let mut shuffled = scene.clone();
    let order: Vec<usize> = (0..27).map(|k| (k * 10 + 4) % 27).collect();
    let (old, new) = (&scene.state, &mut shuffled.state);
    for (k, &from) in order.iter().enumerate() {
        (new.radius[k], new.mass[k]) = (old.radius[from], old.mass[from]);
        (new.position[k], new.velocity[k]) = (old.position[from], old.velocity[from]);
        new.angular_velocity[k] = old.angular_velocity[from];
    }
    let found = bench.after(&shuffled, few)?;
    let mut worst = 0.0_f64;
    for (k, &from) in order.iter().enumerate() {
        for d in 0..3 {
            worst = worst.max((found.position[k][d] - plain.position[from][d]).abs());
        }
    }
    bench.judge("ids shuffled: largest difference of positions", "m", worst, Kind::Invariance.at_most(1e-13));
    Ok(())
}
