//! One sphere and a floor: falling, resting, bouncing, from sliding to rolling; two spheres in a stack.

use super::scene::{Bench, GRAVITY, Hertz, PLASTIC, STEEL, Scene, With, solid};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::{Damping, Law};
use tdem_engine::{Fault, Integrator, Ledger};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "plane/free-fall",
        tier: Tier::Quick,
        source: "z = z0 + v0 t - g t^2/2; both integrators are exact for a constant acceleration",
        about: "A sphere falls without touching anything.",
        body: free_fall,
    },
    Case {
        name: "plane/static-rest",
        tier: Tier::Quick,
        source: "Hertz: h = (3 m g / (4 E* sqrt(R)))^(2/3)",
        about: "A sphere comes to rest on a floor under its weight.",
        body: static_rest,
    },
    Case {
        name: "plane/bouncing-ball",
        tier: Tier::Quick,
        source: "n-th peak e^(2n) H, n-th impact at sqrt(2H/g) (1 + 2 (e + ... + e^(n-1)))",
        about: "A ball of e = 0.8 falls from 1 m and bounces.",
        body: bouncing_ball,
    },
    Case {
        name: "plane/sliding-to-rolling",
        tier: Tier::Quick,
        source: "u = 5 u0/7 after t = 2 u0/(7 mu g) and s = 12 u0^2/(49 mu g); before, u = u0 - mu g t, R omega = 5 mu g t/2",
        about: "A sphere set on a floor with a velocity but no spin slides until it rolls.",
        body: sliding_to_rolling,
    },
    Case {
        name: "plane/sliding-without-moments",
        tier: Tier::Quick,
        source: "stops after t = u0/(mu g) and s = u0^2/(2 mu g)",
        about: "Without moments the same sphere slides until it stands.",
        body: sliding_to_rest,
    },
    Case {
        name: "plane/stack-energy",
        tier: Tier::Quick,
        source: "energy of an undamped stack is constant (MFIX case DEM03, LAMMPS stack_energy)",
        about: "Two unequal spheres under gravity swing between a floor and a lid that press them together.",
        body: stack,
    },
];

fn free_fall(bench: &mut Bench) -> Result<(), Fault> {
    let (dt, steps, start, speed) = (1e-3, 2000_u32, 100.0, 3.0);
    let time = dt * f64::from(steps);
    for (name, integrator) in [("Verlet", Integrator::VelocityVerlet), ("Gear", Integrator::Gear)] {
        let mut scene = Scene::new(Law::GNTM, PLASTIC.with_itself(), dt);
        scene.plan.integrator = integrator;
        scene.plan.gravity = [0.0, 0.0, -GRAVITY];
        scene.moving(0.01, PLASTIC.density, [0.0, 0.0, start], [0.0, 0.0, speed]);
        let state = bench.after(&scene, steps.into())?;
        let height = start + speed * time - 0.5 * GRAVITY * time * time;
        bench.judge(format!("height, {name}"), "m", state.position[0][2], Kind::ClosedForm.relative(height, 1e-12));
        let velocity = speed - GRAVITY * time;
        bench.judge(
            format!("velocity, {name}"),
            "m/s",
            state.velocity[0][2],
            Kind::ClosedForm.relative(velocity, 1e-12),
        );
    }
    Ok(())
}

fn static_rest(bench: &mut Bench) -> Result<(), Fault> {
    let radius = 0.02;
    let mass = PLASTIC.sphere_mass(radius);
    let interaction = PLASTIC.with_itself();
    let hertz = Hertz::new(&interaction, radius, mass);
    let overlap = hertz.overlap(mass * GRAVITY);
    let frequency = (1.5 * GRAVITY / overlap).sqrt();
    for (name, integrator) in [("Verlet", Integrator::VelocityVerlet), ("Gear", Integrator::Gear)] {
        let damped = interaction.dashpots(frequency, 0.0).clamped();
        let mut scene = Scene::new(Law::GN, damped, 0.05 / frequency);
        scene.plan.integrator = integrator;
        scene.plan.gravity = [0.0, 0.0, -GRAVITY];
        scene.floor();
        scene.sphere(radius, PLASTIC.density, [0.0, 0.0, radius]);
        let state = bench.after(&scene, 3000)?;
        let got = radius - state.position[0][2];
        bench.judge(format!("overlap at rest, {name}"), "m", got, Kind::ClosedForm.relative(overlap, 1e-6));
        let pull = Ledger::of(&state, &scene.plan).wall_force[2];
        bench.judge(format!("force on the floor, {name}"), "N", pull, Kind::ClosedForm.relative(-mass * GRAVITY, 1e-6));
    }
    Ok(())
}

fn bouncing_ball(bench: &mut Bench) -> Result<(), Fault> {
    let (radius, height, e, bounces) = (0.01, 1.0_f64, 0.8, 5);
    let rubber = solid(2e7, 0.3, 920.0);
    let interaction = rubber.with_rigid().restitution(e);
    let impact = (2.0 * GRAVITY * height).sqrt();
    let duration = Hertz::new(&interaction, radius, rubber.sphere_mass(radius)).duration(impact);
    let law = Law { damping: Damping::Restitution, ..Law::GN };
    let mut scene = Scene::new(law, interaction, duration / 100.0);
    scene.plan.gravity = [0.0, 0.0, -GRAVITY];
    scene.plan.ledger = false;
    scene.floor();
    scene.sphere(radius, rubber.density, [0.0, 0.0, radius + height]);
    let mut simulation = bench.start(&scene)?;
    let mut expected_height = height;
    let mut expected_time = (2.0 * height / GRAVITY).sqrt();
    let mut falling = true;
    let mut bounce = 0;
    while bounce < bounces && simulation.time() < 10.0 {
        simulation.advance(200)?;
        let state = simulation.state()?;
        let (above, speed) = (state.position[0][2] - radius, state.velocity[0][2]);
        if above > 0.0 && speed > 0.0 && falling {
            bounce += 1;
            expected_height *= e * e;
            expected_time += 2.0 * (2.0 * expected_height / GRAVITY).sqrt();
            let peak = above + speed * speed / (2.0 * GRAVITY);
            bench.judge(format!("peak {bounce}"), "m", peak, Kind::ClosedForm.relative(expected_height, 5e-3));
            let landing = simulation.time() + (speed + (speed * speed + 2.0 * GRAVITY * above).sqrt()) / GRAVITY;
            let what = format!("instant of impact {}", bounce + 1);
            bench.judge(what, "s", landing, Kind::ClosedForm.relative(expected_time, 5e-3));
        }
        falling = speed < 0.0 || above <= 0.0;
    }
    bench.seal(&simulation.state()?);
    bench.judge("bounces seen", "1", f64::from(bounce), Kind::ClosedForm.within(f64::from(bounces), 0.0));
    Ok(())
}

/// A steel sphere settled on a floor, moving along x at 0.5 m/s: friction 0.3.
fn settled(law: Law) -> (Scene, f64) {
    let (radius, friction, speed) = (0.01, 0.3, 0.5);
    let mass = STEEL.sphere_mass(radius);
    let interaction = STEEL.with_itself().friction(friction);
    let overlap = Hertz::new(&interaction, radius, mass).overlap(mass * GRAVITY);
    let frequency = (1.5 * GRAVITY / overlap).sqrt();
    let mut scene = Scene::new(law, interaction.dashpots(0.5 * frequency, 0.5 * frequency), 0.2 / frequency);
    scene.plan.gravity = [0.0, 0.0, -GRAVITY];
    scene.plan.ledger = false;
    scene.floor();
    scene.moving(radius, STEEL.density, [0.0, 0.0, radius - overlap], [speed, 0.0, 0.0]);
    (scene, friction)
}

fn sliding_to_rolling(bench: &mut Bench) -> Result<(), Fault> {
    let (scene, friction) = settled(Law::GNTM);
    let (radius, speed) = (scene.state.radius[0], scene.state.velocity[0][0]);
    let brake = friction * GRAVITY;
    let roll = 2.0 * speed / (7.0 * brake);
    let mut simulation = bench.start(&scene)?;
    simulation.advance((0.5 * roll / scene.plan.dt) as u64)?;
    let (state, time) = (simulation.state()?, simulation.time());
    let velocity = speed - brake * time;
    bench.judge("velocity while sliding", "m/s", state.velocity[0][0], Kind::ClosedForm.relative(velocity, 1e-3));
    let surface = 2.5 * brake * time / radius;
    bench.judge("spin while sliding", "rad/s", state.angular_velocity[0][1], Kind::ClosedForm.relative(surface, 1e-3));
    simulation.advance((1.0 * roll / scene.plan.dt) as u64)?;
    let (state, time) = (simulation.state()?, simulation.time());
    let rolling = 5.0 / 7.0 * speed;
    bench.judge("velocity while rolling", "m/s", state.velocity[0][0], Kind::ClosedForm.relative(rolling, 1e-3));
    let spin = rolling / radius;
    bench.judge("spin while rolling", "rad/s", state.angular_velocity[0][1], Kind::ClosedForm.relative(spin, 1e-3));
    let way = state.position[0][0] - rolling * (time - roll);
    let slid = 12.0 * speed * speed / (49.0 * brake);
    bench.judge("way until it rolls", "m", way, Kind::ClosedForm.relative(slid, 1e-3));
    bench.seal(&state);
    Ok(())
}

fn sliding_to_rest(bench: &mut Bench) -> Result<(), Fault> {
    let (scene, friction) = settled(Law::GNT);
    let speed = scene.state.velocity[0][0];
    let brake = friction * GRAVITY;
    let mut simulation = bench.start(&scene)?;
    simulation.advance((0.5 * speed / brake / scene.plan.dt) as u64)?;
    let velocity = speed - brake * simulation.time();
    let got = simulation.state()?.velocity[0][0];
    bench.judge("velocity while sliding", "m/s", got, Kind::ClosedForm.relative(velocity, 1e-3));
    simulation.advance((0.7 * speed / brake / scene.plan.dt) as u64)?;
    let state = simulation.state()?;
    bench.judge("speed at the end", "m/s", state.velocity[0][0].abs(), Kind::ClosedForm.at_most(1e-9));
    let way = 0.5 * speed * speed / brake;
    bench.judge("way", "m", state.position[0][0], Kind::ClosedForm.relative(way, 1e-3));
    bench.judge("spin", "rad/s", state.angular_velocity[0][1], Kind::ClosedForm.within(0.0, 0.0));
    bench.seal(&state);
    Ok(())
}

fn stack(bench: &mut Bench) -> Result<(), Fault> {
    let (lower, upper) = (0.02, 0.015);
    let interaction = PLASTIC.with_itself();
    let hertz = Hertz::new(&interaction, upper, PLASTIC.sphere_mass(upper));
    // Pressed by 1 % of a radius at each contact; the fastest swing is about that of the smaller sphere between two.
    let press = 0.01 * upper;
    let frequency = (3.0 * hertz.stiffness * press.sqrt() / hertz.mass_eff).sqrt();
    let mut scene = Scene::new(Law::GN, interaction, 2.0 * std::f64::consts::PI / frequency / 200.0);
    scene.plan.gravity = [0.0, 0.0, -GRAVITY];
    scene.floor();
    scene.wall([0.0, 0.0, -1.0], [0.0, 0.0, 2.0 * (lower + upper) - 3.0 * press]);
    scene.moving(lower, PLASTIC.density, [0.0, 0.0, lower - press], [0.0, 0.0, 0.02]);
    scene.moving(upper, PLASTIC.density, [0.0, 0.0, 2.0 * lower + upper - 2.0 * press], [0.0, 0.0, -0.03]);
    let mut simulation = bench.start(&scene)?;
    let start = Ledger::of(&simulation.state()?, &scene.plan);
    // Heights would hide what the springs do: count them from where the spheres start.
    let unit = start.mechanical() - start.gravitational;
    let mut worst = 0.0_f64;
    for _ in 0..400 {
        simulation.advance(50)?;
        let now = Ledger::of(&simulation.state()?, &scene.plan);
        worst = worst.max((now.mechanical() - start.mechanical()).abs() / unit);
    }
    bench.judge("largest change of energy", "1", worst, Kind::Conservation.at_most(1e-4));
    let state = simulation.state()?;
    let side = state.velocity.iter().fold(0.0, |side: f64, v| side.max(v[0].abs()).max(v[1].abs()));
    bench.judge("sideways velocity", "m/s", side, Kind::ClosedForm.within(0.0, 0.0));
    bench.seal(&state);
    Ok(())
}
