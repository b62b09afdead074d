//! The tangential spring alone: loading loops at constant overlap, and a spring that turns with its pair.

use super::scene::{Bench, HELD, PLASTIC, Scene, With};
use super::{Case, Kind, Tier};
use tdem_engine::energy_accounts::FRICTION;
use tdem_engine::physics::contact::{Friction, Law};
use tdem_engine::{Constraint, Contact, Fault, State, WallContact};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "spring/loading-loop-on-a-wall",
        tier: Tier::Quick,
        source: "F_t = k_t delta up to mu F_n, unloading and reversal along the same slope; area = dissipation",
        about: "A sphere is dragged to and fro along a wall at constant overlap.",
        body: |bench| loading_loop(bench, Law::GNT, Rig::Wall),
    },
    Case {
        name: "spring/loading-loop-of-a-pair",
        tier: Tier::Quick,
        source: "F_t = k_t delta up to mu F_n, unloading and reversal along the same slope; area = dissipation",
        about: "One of two held spheres is turned to and fro against the other at constant overlap.",
        body: |bench| loading_loop(bench, Law::GNTM, Rig::Pair),
    },
    Case {
        name: "spring/loading-loop-rescaled",
        tier: Tier::Quick,
        source: "at constant overlap both forms of friction are the same",
        about: "The loop of a pair with the rescaled form.",
        body: |bench| loading_loop(bench, Law { friction: Friction::Rescaled, ..Law::GNTM }, Rig::Pair),
    },
    Case {
        name: "spring/rotating-pair",
        tier: Tier::Quick,
        source: "objectivity: after one revolution a held spring is what it was, whatever the step",
        about: "A pair under a held tangential spring turns once about itself like a rigid body, also about its own axis.",
        body: rotating_pair,
    },
    Case {
        name: "spring/spinning-on-the-spot",
        tier: Tier::Quick,
        source: "objectivity: a held spring turns about the normal by the mean spin of its bodies",
        about: "Two spheres in contact, or one on a wall, spin about their common normal: a stored displacement turns a quarter.",
        body: spinning_on_the_spot,
    },
];

#[derive(Clone, Copy)]
enum Rig {
    Wall,
    Pair,
}

/// Steps in which the spring reaches the limit of friction from zero.
const TO_LIMIT: f64 = 100.0;
/// Parts of the path: direction and steps, and the force afterwards in units of the limit.
const PATH: [(f64, u64, f64); 6] =
    [(1.0, 50, 0.5), (1.0, 200, 1.0), (-1.0, 100, 0.0), (-1.0, 200, -1.0), (1.0, 100, 0.0), (1.0, 50, 0.5)];
/// Steps of the path in which the surfaces slide: 150 forward, 100 back.
const SLIDING: f64 = 250.0;

fn loading_loop(bench: &mut Bench, law: Law, rig: Rig) -> Result<(), Fault> {
    let (radius, overlap, friction, dt) = (0.02, 2e-4, 0.3, 1e-4);
    let interaction = PLASTIC.with_itself().friction(friction);
    let mut scene = Scene::new(law, interaction, dt);
    let (radius_eff, way_per_turn) = match rig {
        Rig::Wall => {
            scene.floor();
            scene.sphere(radius, PLASTIC.density, [0.0, 0.0, radius - overlap]);
            scene.hold(0, HELD);
            (radius, None)
        }
        Rig::Pair => {
            scene.sphere(radius, PLASTIC.density, [0.0; 3]);
            scene.sphere(radius, PLASTIC.density, [2.0 * radius - overlap, 0.0, 0.0]);
            scene.hold(0, HELD);
            scene.hold(1, HELD);
            (0.5 * radius, Some(radius - 0.5 * overlap))
        }
    };
    // The overlap as the engine sees it, after rounding of positions.
    let state = &scene.state;
    let overlap = match rig {
        Rig::Wall => radius - state.position[0][2],
        Rig::Pair => 2.0 * radius - state.position[1][0],
    };
    let normal = interaction.normal_stiffness * (radius_eff * overlap).sqrt() * overlap;
    let stiffness = interaction.tangential_stiffness * (radius_eff * overlap).sqrt();
    let limit = friction * normal;
    let way = limit / stiffness / TO_LIMIT;

    let mut state = scene.state.clone();
    let mut done = 0;
    for (direction, steps, expected) in PATH {
        let speed = direction * way / dt;
        let constraint = &mut scene.plan.constraints[1];
        match way_per_turn {
            None => constraint.velocity[0] = Some(-speed),
            Some(arm) => constraint.angular_velocity[1] = Some(speed / arm),
        }
        scene.state = state;
        state = bench.after(&scene, steps)?;
        done += steps;
        // The wall resists along x, the other sphere along z.
        let force = match rig {
            Rig::Wall => state.force[0][0],
            Rig::Pair => state.force[0][2],
        };
        let what = format!("tangential force after {done} steps, of the limit");
        bench.judge(what, "1", force / limit, Kind::ClosedForm.within(expected, 1e-12));
        if let (Some(arm), true) = (way_per_turn, expected == 1.0) {
            let moment = state.moment[0][1] / (arm * limit);
            bench.judge("moment over arm and limit", "1", moment, Kind::ClosedForm.within(-1.0, 1e-12));
        }
    }
    let dissipated: f64 = state.accounts.iter().map(|account| account[FRICTION]).sum();
    let area = SLIDING * way * limit;
    bench.judge("dissipation over area of the loop", "1", dissipated / area, Kind::ClosedForm.within(1.0, 1e-12));
    Ok(())
}

/// Turns the pair once in `parts` steps and returns the stored displacement.
fn one_turn(bench: &mut Bench, parts: u32, stored: [f64; 3]) -> Result<State, Fault> {
    let (radius, overlap, dt) = (0.02, 2e-4, 1e-4);
    let arm = radius - 0.5 * overlap;
    let mut scene = Scene::new(Law::GNTM, PLASTIC.with_itself().friction(1e12), dt);
    scene.sphere(radius, PLASTIC.density, [-arm, 0.0, 0.0]);
    scene.sphere(radius, PLASTIC.density, [arm, 0.0, 0.0]);
    scene.state.contacts = vec![Contact { first: 0, second: 1, displacement: stored }];
    // Turns by the same angle in a step as the chords do.
    let spin = 2.0 * libm::tan(std::f64::consts::PI / f64::from(parts)) / dt;
    for k in 0..2 {
        scene.hold(k, HELD);
    }
    let mut simulation = bench.start(&scene)?;
    for part in 1..=parts {
        let mut now = Scene { state: simulation.state()?, plan: scene.plan.clone() };
        let angle = 2.0 * std::f64::consts::PI * f64::from(part) / f64::from(parts);
        let place = [arm * libm::cos(angle), arm * libm::sin(angle), 0.0];
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            // The chord to the next place.
            let velocity = std::array::from_fn(|d| Some((sign * place[d] - now.state.position[k][d]) / dt));
            let angular_velocity = [Some(0.0), Some(0.0), Some(spin)];
            now.plan.constraints[k + 1] = Constraint { velocity, angular_velocity, ..Constraint::FREE };
        }
        simulation = bench.start(&now)?;
        simulation.advance(1)?;
    }
    simulation.state()
}

fn rotating_pair(bench: &mut Bench) -> Result<(), Fault> {
    let unit = 1e-5;
    let stored = [0.0, unit, 0.5 * unit];
    for parts in [20, 1000] {
        let state = one_turn(bench, parts, stored)?;
        let found = state.contacts.first().map_or([f64::NAN; 3], |contact| contact.displacement.map(|d| d / unit));
        for (what, found, expected) in
            [("along", found[0], 0.0), ("across", found[1], 1.0), ("out of plane", found[2], 0.5)]
        {
            bench.judge(format!("{parts} steps: {what}"), "1", found, Kind::Invariance.within(expected, 1e-10));
        }
        let friction: f64 = state.accounts.iter().map(|account| account[FRICTION]).sum();
        bench.judge(
            format!("{parts} steps: energy lost by sliding"),
            "J",
            friction,
            Kind::Conservation.within(0.0, 0.0),
        );
        bench.seal(&state);
    }
    Ok(())
}

/// Held springs turn about the normal at the mean spin of their bodies: with a sphere on a resting wall by half its angle.
fn spinning_on_the_spot(bench: &mut Bench) -> Result<(), Fault> {
    let (radius, overlap, dt, unit, steps) = (0.02, 2e-4, 1e-4, 1e-5, 400_u32);
    let angle = 0.5 * std::f64::consts::PI / f64::from(steps);
    let rate = 2.0 * libm::tan(0.5 * angle) / dt;
    for (rig, spins, turned) in
        [(Rig::Pair, [1.0, 1.0], 1.0), (Rig::Pair, [2.0, 0.0], 1.0), (Rig::Wall, [2.0, 0.0], 1.0)]
    {
        let mut scene = Scene::new(Law::GNTM, PLASTIC.with_itself().friction(1e12), dt);
        scene.sphere(radius, PLASTIC.density, [0.0, 0.0, radius - 0.5 * overlap]);
        let stored = [unit, 0.0, 0.0];
        match rig {
            Rig::Pair => {
                scene.sphere(radius, PLASTIC.density, [0.0, 0.0, -radius + 0.5 * overlap]);
                scene.state.contacts = vec![Contact { first: 0, second: 1, displacement: stored }];
            }
            Rig::Wall => {
                scene.wall([0.0, 0.0, 1.0], [0.0, 0.0, 0.5 * overlap]);
                scene.state.wall_contacts = vec![WallContact { particle: 0, wall: 0, displacement: stored }];
            }
        }
        for (k, spin) in spins.into_iter().enumerate().take(scene.state.len()) {
            let angular_velocity = [Some(0.0), Some(0.0), Some(spin * rate)];
            scene.hold(k, Constraint { angular_velocity, ..HELD });
        }
        let state = bench.after(&scene, u64::from(steps))?;
        let pair = state.contacts.first().map(|contact| contact.displacement);
        let found = pair.or(state.wall_contacts.first().map(|contact| contact.displacement)).unwrap_or([f64::NAN; 3]);
        let name = match rig {
            Rig::Pair => format!("pair, spins {} and {}", spins[0], spins[1]),
            Rig::Wall => "sphere on a wall".to_owned(),
        };
        let quarter = 0.5 * std::f64::consts::PI * turned;
        for (what, found, expected) in
            [("cosine", found[0], libm::cos(quarter)), ("sine", found[1], libm::sin(quarter))]
        {
            let expect = Kind::Invariance.within(expected, 1e-11);
            bench.judge(format!("{name}: {what} of the displacement's turn"), "1", found / unit, expect);
        }
    }
    Ok(())
}
