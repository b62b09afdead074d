//! How fast errors fall with the step, and what an impact costs an integrator.

use super::scene::{Bench, Hertz, Scene, With, solid};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::Law;
use tdem_engine::{Constraint, Driven, Fault, Integrator, Ramp};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "integrators/hertz-rebound-verlet",
        tier: Tier::Quick,
        source: "the scaled impact x'' = -x^1.5 integrated by a program of its own (numpy)",
        about: "Rebound over impact speed of an elastic impact in 10 to 200 steps; exact: 1.",
        body: |bench| rebound(bench, Integrator::VelocityVerlet, VERLET_REBOUND),
    },
    Case {
        name: "integrators/hertz-rebound-gear",
        tier: Tier::Quick,
        source: "the scaled impact x'' = -x^1.5 integrated by a program of its own (numpy)",
        about: "The same under Gear's method, which loses its order where contact begins and ends.",
        body: |bench| rebound(bench, Integrator::Gear, GEAR_REBOUND),
    },
    Case {
        name: "integrators/order-verlet",
        tier: Tier::Quick,
        source: "velocity Verlet is of second order",
        about: "A sphere swings between two plates that press it: error after 1.6 swings, steps halved.",
        body: |bench| order(bench, Integrator::VelocityVerlet, 0.0, 200, (2.0, 0.05)),
    },
    Case {
        name: "integrators/order-verlet-damped",
        tier: Tier::Quick,
        source: "forces that see the velocity of the half step cost one order",
        about: "The same with dashpots.",
        body: |bench| order(bench, Integrator::VelocityVerlet, 0.1, 800, (1.0, 0.1)),
    },
    Case {
        name: "integrators/order-gear",
        tier: Tier::Quick,
        source: "Gear's method with six values is of fifth order",
        about: "The same under Gear's method, started with the true derivatives.",
        body: |bench| order(bench, Integrator::Gear, 0.0, 100, (5.0, 0.3)),
    },
    Case {
        name: "integrators/order-gear-damped",
        tier: Tier::Quick,
        source: "with 3/16 as first coefficient the order stays for forces that depend on velocity",
        about: "The same under Gear's method with dashpots.",
        body: |bench| order(bench, Integrator::Gear, 0.1, 100, (5.0, 0.3)),
    },
    Case {
        name: "integrators/prescribed-ramp",
        tier: Tier::Quick,
        source: "the area of the trapezes under the velocity",
        about: "A sphere is moved and turned along ramps whose corners lie on steps, under both methods.",
        body: prescribed_ramp,
    },
];

/// Corners of a ramp: step, and velocity over the largest.
const CORNERS: [(u64, f64); 4] = [(0, 0.0), (50, 1.0), (80, 1.0), (200, -0.5)];

fn prescribed_ramp(bench: &mut Bench) -> Result<(), Fault> {
    let (speed, spin, dt) = (0.3, 20.0, 1e-4);
    for (name, integrator) in [("Verlet", Integrator::VelocityVerlet), ("Gear", Integrator::Gear)] {
        let material = solid(5e7, 0.3, 1000.0);
        let mut scene = Scene::new(Law::GNTM, material.with_rigid(), dt);
        scene.plan.integrator = integrator;
        // Another force than that of the ramp must not show.
        scene.plan.gravity = [0.0, 0.0, -9.81];
        scene.sphere(0.01, 1000.0, [0.0; 3]);
        let still = [Some(0.0); 3];
        scene.hold(0, Constraint { velocity: still, angular_velocity: still, ..Constraint::FREE });
        let ramp = |drives, axis, largest: f64| Ramp {
            constraint: 1,
            drives,
            axis,
            points: CORNERS.map(|(step, part)| [scene.plan.time(step), part * largest]).to_vec(),
        };
        scene.plan.ramps = vec![ramp(Driven::Velocity, 0, speed), ramp(Driven::AngularVelocity, 2, spin)];
        let mut simulation = bench.start(&scene)?;
        let mut expected = 0.0;
        for pair in CORNERS.windows(2) {
            let [(from, before), (until, after)] = [pair[0], pair[1]];
            simulation.advance(until - from)?;
            let state = simulation.state()?;
            expected += 0.5 * (before + after) * speed * (until - from) as f64 * dt;
            let gone = state.position[0][0];
            bench.judge(
                format!("{name}: way until step {until}"),
                "m",
                gone,
                Kind::ClosedForm.relative(expected, 1e-13),
            );
            let rate = state.angular_velocity[0][2];
            let what = format!("{name}: angular velocity at step {until}");
            bench.judge(what, "rad/s", rate, Kind::ClosedForm.within(after * spin, 0.0));
        }
        let state = simulation.state()?;
        bench.seal(&state);
        bench.judge(format!("{name}: fall"), "m", state.position[0][2], Kind::ClosedForm.within(0.0, 0.0));
    }
    Ok(())
}

/// Steps of an impact, rebound over impact speed.
type Rebounds = &'static [(f64, f64)];
const VERLET_REBOUND: Rebounds = &[
    (10.0, 1.000_928_42),
    (20.0, 1.000_082_92),
    (30.0, 1.000_020_13),
    (50.0, 1.000_003_38),
    (100.0, 1.000_000_30),
    (200.0, 1.000_000_03),
];
const GEAR_REBOUND: Rebounds = &[
    (10.0, 1.002_936_70),
    (20.0, 1.000_425_89),
    (30.0, 1.000_154_31),
    (50.0, 1.000_043_19),
    (100.0, 1.000_007_65),
    (200.0, 1.000_001_35),
];

fn rebound(bench: &mut Bench, integrator: Integrator, golden: Rebounds) -> Result<(), Fault> {
    let (radius, material, speed) = (0.01, solid(5e7, 0.3, 1000.0), 0.5);
    let interaction = material.with_rigid();
    let duration = Hertz::new(&interaction, radius, material.sphere_mass(radius)).duration(speed);
    for &(parts, expected) in golden {
        let mut scene = Scene::new(Law::GN, interaction, duration / parts);
        scene.plan.integrator = integrator;
        scene.floor();
        scene.moving(radius, material.density, [0.0, 0.0, radius], [0.0, 0.0, -speed]);
        let mut simulation = bench.start(&scene)?;
        let mut state = simulation.state()?;
        // The first step after which the sphere is above the floor again: Gear's method goes on correcting after it.
        for _ in 0..2 * parts as u64 {
            simulation.advance(1)?;
            state = simulation.state()?;
            if state.position[0][2] > radius {
                break;
            }
        }
        bench.seal(&state);
        let got = state.velocity[0][2] / speed;
        let excess = Kind::Reference.within(expected - 1.0, 2e-8);
        bench.judge(format!("rebound in {parts} steps, less 1"), "1", got - 1.0, excess);
    }
    Ok(())
}

/// Position after 1.6 swings of a sphere between two plates, in a number of steps.
fn swing(bench: &mut Bench, integrator: Integrator, damping_ratio: f64, parts: u64) -> Result<f64, Fault> {
    let (radius, material, press, amplitude) = (1.0, solid(1e6, 0.3, 100.0), 0.05_f64, 0.02);
    let interaction = material.with_rigid();
    let mass = material.sphere_mass(radius);
    let stiffness = Hertz::new(&interaction, radius, mass).stiffness;
    let frequency = (3.0 * stiffness * press.sqrt() / mass).sqrt();
    let dashpot = damping_ratio * frequency;
    let dt = 1.6 * 2.0 * std::f64::consts::PI / frequency / parts as f64;
    let mut scene = Scene::new(Law::GN, interaction.dashpots(dashpot, 0.0), dt);
    scene.plan.integrator = integrator;
    scene.wall([0.0, 0.0, 1.0], [0.0, 0.0, press - radius]);
    scene.wall([0.0, 0.0, -1.0], [0.0, 0.0, radius - press]);
    scene.sphere(radius, material.density, [0.0, 0.0, amplitude]);
    if integrator == Integrator::Gear {
        // The true derivatives of the start at rest: a start with zeros would hide the order.
        let (below, above) = ((press - amplitude).sqrt(), (press + amplitude).sqrt());
        let second = stiffness / mass * (below * below * below - above * above * above);
        let slope = -1.5 * stiffness / mass * (below + above);
        let damping = 2.0 * dashpot;
        let third = -damping * second;
        let fourth = slope * second - damping * third;
        let fifth = slope * third - damping * fourth;
        let along = |value: f64| [0.0, 0.0, value];
        let square = dt * dt;
        scene.state.derivatives = vec![[
            along(square / 2.0 * second),
            along(square * dt / 6.0 * third),
            along(square * square / 24.0 * fourth),
            along(square * square * dt / 120.0 * fifth),
        ]];
    }
    Ok(bench.after(&scene, parts)?.position[0][2])
}

fn order(
    bench: &mut Bench,
    integrator: Integrator,
    damping_ratio: f64,
    coarsest: u64,
    (expected, width): (f64, f64),
) -> Result<(), Fault> {
    let mut found = Vec::new();
    for doubling in 0..4 {
        found.push(swing(bench, integrator, damping_ratio, coarsest << doubling)?);
    }
    for k in 0..2 {
        // Differences of successive results fall as the error does.
        let ratio = (found[k + 1] - found[k]) / (found[k + 2] - found[k + 1]);
        let steps = coarsest << k;
        let what = format!("order from {steps} to {} steps", 4 * steps);
        bench.judge(what, "1", libm::log2(ratio.abs()), Kind::Order.within(expected, width));
    }
    Ok(())
}
