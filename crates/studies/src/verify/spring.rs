//! The tangential spring alone: loading loops at constant overlap, and a spring that turns with its pair.

use super::scene::{Bench, HELD, PLASTIC, Scene, With};
use super::{Case, Kind, Tier};
use tdem_engine::energy_accounts::FRICTION;
use tdem_engine::physics::contact::{Friction, Law};
use tdem_engine::{Constraint, Contact, Fault, State};

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
        source: "projection and rescaling of (0, 1, 1/2) over one revolution, computed with numpy",
        about: "A pair under a held tangential spring turns once about itself like a rigid body.",
        body: rotating_pair,
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
    let spin = libm::sin(2.0 * std::f64::consts::PI / f64::from(parts)) / dt;
    for k in 0..2 {
        scene.hold(k, HELD);
    }
    let mut simulation = bench.start(&scene)?;
    for part in 1..=parts {
        let mut now = Scene { state: simulation.state()?, plan: scene.plan.clone() };
        let angle = 2.0 * std::f64::consts::PI * f64::from(part) / f64::from(parts);
        let place = [arm * libm::cos(angle), arm * libm::sin(angle), 0.0];
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            // The chord to the next place; the spin is what makes its surfaces stick without slip.
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
    let length = 1.25_f64.sqrt();
    let mut off = Vec::new();
    for (parts, across, out) in [(100, 0.954_813, 0.581_663), (1000, 0.995_997, 0.507_926)] {
        let state = one_turn(bench, parts, stored)?;
        let found = state.contacts.first().map_or([f64::NAN; 3], |contact| contact.displacement.map(|d| d / unit));
        let size = found.iter().map(|d| d * d).sum::<f64>().sqrt();
        bench.judge(format!("{parts} steps: size"), "1", size, Kind::ClosedForm.relative(length, 1e-10));
        bench.judge(format!("{parts} steps: across"), "1", found[1], Kind::Reference.within(across, 1e-6));
        bench.judge(format!("{parts} steps: out of plane"), "1", found[2], Kind::Reference.within(out, 1e-6));
        let friction: f64 = state.accounts.iter().map(|account| account[FRICTION]).sum();
        bench.judge(
            format!("{parts} steps: energy lost by sliding"),
            "J",
            friction,
            Kind::Conservation.within(0.0, 0.0),
        );
        off.push(found[2] - 0.5);
        bench.seal(&state);
    }
    let order = libm::log10(off[0] / off[1]);
    bench.judge("order of the error of direction", "1", order, Kind::Order.within(1.0, 0.05));
    Ok(())
}
