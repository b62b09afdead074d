//! Steps just below a proven bound are stable, steps above it are not.

use super::scene::{Bench, Hertz, Scene, With, solid};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::Law;
use tdem_engine::physics::stability::{
    GEAR_DASHPOT_LIMIT, GEAR_OSCILLATOR_LIMIT, VERLET_DASHPOT_LIMIT, VERLET_OSCILLATOR_LIMIT,
};
use tdem_engine::{Fault, Integrator};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "stability/dashpot-verlet",
        tier: Tier::Quick,
        source: "each step multiplies the velocity of the half step by 1 - gamma dt: bound 2",
        about: "A sphere on a dashpot without spring, just below and just above the bound.",
        body: dashpot_verlet,
    },
    Case {
        name: "stability/dashpot-gear",
        tier: Tier::Quick,
        source: "spectral radius of Gear's method with 3/16: 1 at gamma dt = 0.1635 (numpy)",
        about: "The same under Gear's method.",
        body: dashpot_gear,
    },
    Case {
        name: "stability/oscillator-verlet",
        tier: Tier::Quick,
        source: "leapfrog from rest: x = cos(n a), sin(a/2) = w dt/2, up to the bound w dt = 2; beyond it cosh(n a), cosh(a/2) = w dt/2",
        about: "A sphere held by two plates swings a little, just below and just above the bound.",
        body: oscillator_verlet,
    },
    Case {
        name: "stability/damped-oscillator-verlet",
        tier: Tier::Quick,
        source: "damping that lags half a step: bound w dt = 2 (sqrt(1 + zeta^2) - zeta)",
        about: "The same with dashpots, zeta = 0.1, 0.3 and 1.",
        body: damped_oscillator_verlet,
    },
    Case {
        name: "stability/oscillator-gear",
        tier: Tier::Quick,
        source: "spectral radius of Gear's method with 3/16: at most 1 + 1e-9 up to w dt = 0.312, 1 + 9e-4 at 0.6 (numpy)",
        about: "The same under Gear's method without dashpots.",
        body: oscillator_gear,
    },
    Case {
        name: "stability/damped-oscillator-gear",
        tier: Tier::Quick,
        source: "spectral radius of Gear's method with 3/16: bound w dt = 0.498 at zeta = 0.1, 0.157 at 0.5 (numpy)",
        about: "The same under Gear's method with dashpots.",
        body: damped_oscillator_gear,
    },
];

const RADIUS: f64 = 0.01;
const START: f64 = 1e-9;

/// Speed after a number of steps over the speed before, of a sphere on a dashpot alone.
fn dashpot(bench: &mut Bench, integrator: Integrator, gamma_dt: f64, steps: u64) -> Result<f64, Fault> {
    let dt = 1e-4;
    let material = solid(1e7, 0.3, 1000.0);
    let mut interaction = material.with_rigid().dashpots(gamma_dt / dt, 0.0);
    interaction.normal_stiffness = 0.0;
    let mut scene = Scene::new(Law::GN, interaction, dt);
    scene.plan.integrator = integrator;
    scene.plan.ledger = false;
    scene.plan.overlap_limit = f64::INFINITY;
    scene.floor();
    // Deep enough that it never leaves; the speed is small enough that it never comes far.
    scene.moving(RADIUS, material.density, [0.0, 0.0, 0.5 * RADIUS], [0.0, 0.0, START]);
    let state = bench.after(&scene, steps)?;
    Ok((state.velocity[0][2] / START).abs())
}

fn dashpot_verlet(bench: &mut Bench) -> Result<(), Fault> {
    for part in [0.25, 0.99, 1.01] {
        let gamma_dt = part * VERLET_DASHPOT_LIMIT;
        let steps = if part == 0.25 { 5 } else { 400 };
        let got = dashpot(bench, Integrator::VelocityVerlet, gamma_dt, steps)?;
        // The first kick is half a step, the last one too: v = (1 - g/2) q^(n-1) (1 - g/2) v0.
        let half = 1.0 - 0.5 * gamma_dt;
        let expected = half * half * libm::pow((1.0 - gamma_dt).abs(), steps as f64 - 1.0);
        let what = format!("speed after {steps} steps at {part} of the bound, of the start");
        bench.judge(what, "1", got, Kind::ClosedForm.within(expected, 1e-9 * expected.max(1e-9)));
    }
    Ok(())
}

fn dashpot_gear(bench: &mut Bench) -> Result<(), Fault> {
    let below = dashpot(bench, Integrator::Gear, 0.98 * GEAR_DASHPOT_LIMIT, 4000)?;
    bench.judge("speed at 0.98 of the bound, of the start", "1", below, Kind::Reference.at_most(1e-3));
    let above = dashpot(bench, Integrator::Gear, 1.02 * GEAR_DASHPOT_LIMIT, 4000)?;
    bench.judge("speed at 1.02 of the bound, of the start", "1", above, Kind::Reference.at_least(1e3));
    Ok(())
}

/// Largest amplitude in the last steps over the amplitude at the start, of a sphere between two plates.
fn oscillator(bench: &mut Bench, integrator: Integrator, omega_dt: f64, zeta: f64, steps: u64) -> Result<f64, Fault> {
    let material = solid(1e7, 0.3, 1000.0);
    let interaction = material.with_rigid();
    let press = 0.05 * RADIUS;
    let mass = material.sphere_mass(RADIUS);
    let stiffness = Hertz::new(&interaction, RADIUS, mass).stiffness;
    let frequency = (3.0 * stiffness * press.sqrt() / mass).sqrt();
    // Two dashpots of zeta w each damp with 2 zeta w.
    let mut scene = Scene::new(Law::GN, interaction.dashpots(zeta * frequency, 0.0), omega_dt / frequency);
    scene.plan.integrator = integrator;
    scene.plan.ledger = false;
    scene.wall([0.0, 0.0, 1.0], [0.0, 0.0, press - RADIUS]);
    scene.wall([0.0, 0.0, -1.0], [0.0, 0.0, RADIUS - press]);
    // Small enough to be linear even after growing ten thousandfold.
    let amplitude = 1e-8 * press;
    scene.sphere(RADIUS, material.density, [0.0, 0.0, amplitude]);
    let mut simulation = bench.start(&scene)?;
    simulation.advance(steps)?;
    let mut largest = 0.0_f64;
    for _ in 0..200 {
        simulation.advance(1)?;
        largest = largest.max(simulation.state()?.position[0][2].abs());
    }
    bench.seal(&simulation.state()?);
    Ok(largest / amplitude)
}

fn oscillator_verlet(bench: &mut Bench) -> Result<(), Fault> {
    let verlet = Integrator::VelocityVerlet;
    for part in [0.5, 0.995] {
        let omega_dt = part * VERLET_OSCILLATOR_LIMIT;
        let got = oscillator(bench, verlet, omega_dt, 0.0, 5000)?;
        let what = format!("amplitude at {part} of the bound, of the start");
        bench.judge(what, "1", got, Kind::ClosedForm.relative(1.0, 1e-3));
    }
    let part = 1.0002;
    let above = oscillator(bench, verlet, part * VERLET_OSCILLATOR_LIMIT, 0.0, 50)?;
    // Positions grow as cosh(n a) with cosh(a/2) = w dt/2.
    let expected = libm::cosh(250.0 * 2.0 * libm::acosh(part));
    let what = format!("amplitude at {part} of the bound after 250 steps, of the start");
    bench.judge(what, "1", above, Kind::ClosedForm.relative(expected, 1e-2));
    Ok(())
}

fn damped_oscillator_verlet(bench: &mut Bench) -> Result<(), Fault> {
    for zeta in [0.1, 0.3, 1.0_f64] {
        let bound = 2.0 * ((1.0 + zeta * zeta).sqrt() - zeta);
        let below = oscillator(bench, Integrator::VelocityVerlet, 0.99 * bound, zeta, 2000)?;
        let what = format!("zeta = {zeta}: amplitude at 0.99 of the bound, of the start");
        bench.judge(what, "1", below, Kind::ClosedForm.at_most(0.1));
        let above = oscillator(bench, Integrator::VelocityVerlet, 1.01 * bound, zeta, 400)?;
        let what = format!("zeta = {zeta}: amplitude at 1.01 of the bound, of the start");
        bench.judge(what, "1", above, Kind::ClosedForm.at_least(10.0));
    }
    Ok(())
}

fn oscillator_gear(bench: &mut Bench) -> Result<(), Fault> {
    let below = oscillator(bench, Integrator::Gear, GEAR_OSCILLATOR_LIMIT, 0.0, 20_000)?;
    bench.judge(
        "amplitude at the bound after 20000 steps, of the start",
        "1",
        below,
        Kind::Reference.within(1.0, 0.02),
    );
    let above = oscillator(bench, Integrator::Gear, 0.6, 0.0, 8000)?;
    bench.judge("amplitude at w dt = 0.6 after 8000 steps, of the start", "1", above, Kind::Reference.at_least(100.0));
    Ok(())
}

fn damped_oscillator_gear(bench: &mut Bench) -> Result<(), Fault> {
    for (zeta, bound) in [(0.1, 0.4986), (0.5, 0.1574)] {
        let below = oscillator(bench, Integrator::Gear, 0.98 * bound, zeta, 4000)?;
        let what = format!("zeta = {zeta}: amplitude at 0.98 of the bound, of the start");
        bench.judge(what, "1", below, Kind::Reference.at_most(1e-3));
        let above = oscillator(bench, Integrator::Gear, 1.02 * bound, zeta, 1000)?;
        let what = format!("zeta = {zeta}: amplitude at 1.02 of the bound, of the start");
        bench.judge(what, "1", above, Kind::Reference.at_least(10.0));
    }
    Ok(())
}
