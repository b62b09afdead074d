//! What the laws of motion keep: momentum, angular momentum, energy.

use super::scene::{Bench, GRAVITY, Hertz, PLASTIC, STEEL, Scene, With, random, random_vector};
use super::{Case, Kind, Tier};
use tdem_engine::physics::contact::{Damping, Friction, Law};
use tdem_engine::physics::motion::sphere_inertia;
use tdem_engine::{Domain, Fault, Integrator, Ledger, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "conservation/momentum",
        tier: Tier::Quick,
        source: "Newton's third law, bit by bit: a pair is evaluated once, its force changes only its sign",
        about: "27 unequal spheres, rubbing and damped, pressed together in a box that repeats, over 1e5 steps.",
        body: |bench| momentum(bench, Law::GNTM, 100_000),
    },
    Case {
        name: "conservation/momentum-rescaled",
        tier: Tier::Quick,
        source: "Newton's third law, bit by bit: a pair is evaluated once, its force changes only its sign",
        about: "The same with the rescaled form of friction and damping by restitution, over 1e4 steps.",
        body: |bench| {
            let law = Law { friction: Friction::Rescaled, damping: Damping::Restitution, ..Law::GNTM };
            momentum(bench, law, 10_000)
        },
    },
    Case {
        name: "conservation/angular-momentum",
        tier: Tier::Quick,
        source: "the two lever arms of a contact add up to the distance of the centres",
        about: "8 unequal spinning spheres collide and rub: 1e5 steps within one impact.",
        body: angular_momentum,
    },
    Case {
        name: "conservation/angular-momentum-gear",
        tier: Tier::Quick,
        source: "Euler's rule for the spin loses angular momentum at first order",
        about: "The same under Gear's method with halved steps.",
        body: angular_momentum_gear,
    },
    Case {
        name: "conservation/energy-elastic",
        tier: Tier::Quick,
        source: "energy of a frictionless elastic gas is constant",
        about: "27 unequal spheres without friction and damping in a box that repeats, 50 steps to an impact.",
        body: energy_elastic,
    },
    Case {
        name: "conservation/ledger-closes",
        tier: Tier::Quick,
        source: "kinetic + elastic + dissipated - work = initial; losses are booked at the velocity of the end of the step, so the sum closes at second order",
        about: "An oblique impact of two spheres with friction and damping, with halved steps: closing error.",
        body: ledger_closes,
    },
    Case {
        name: "conservation/ledger-closes-packing",
        tier: Tier::Quick,
        source: "kinetic + elastic + gravitational + dissipated - work = initial",
        about: "27 unequal spheres fall on a moving floor, with friction and damping: closing error.",
        body: ledger_of_packing,
    },
    Case {
        name: "conservation/displacement-form-creates-energy",
        tier: Tier::Quick,
        source: "k_t grows under a stored displacement; the ledger books it as work of stiffening",
        about: "An elastic impact at 2 degrees from the normal sticks and gains energy.",
        body: displacement_form,
    },
    Case {
        name: "conservation/rescaled-form-creates-none",
        tier: Tier::Quick,
        source: "second law: energy may not grow for mu > 0 and e <= 1",
        about: "The same with the rescaled form, from 0.5 to 80 degrees.",
        body: rescaled_form,
    },
];

/// A cloud of 27 unequal spheres on a jittered lattice, moving and spinning at random.
pub(super) fn cloud(scene: &mut Scene, spacing: f64, least: f64, most: f64, speed: f64) {
    for k in 0..27 {
        let radius = least + (most - least) * random(1, k);
        let jitter = random_vector(2, k);
        let cell = [k % 3, k / 3 % 3, k / 9];
        let place = std::array::from_fn(|d| (cell[d] as f64 + 0.5) * spacing + 0.02 * spacing * jitter[d]);
        let index = scene.moving(radius, PLASTIC.density, place, random_vector(3, k).map(|v| speed * v));
        scene.state.angular_velocity[index] = random_vector(4, k).map(|w| speed / radius * w);
    }
}

/// A box of three spacings that repeats.
fn repeating(scene: &mut Scene, spacing: f64) {
    scene.plan.domain = Domain { min: [0.0; 3], max: [3.0 * spacing; 3], periodic: [true; 3] };
    scene.plan.search.skin = 0.05 * spacing;
}

pub(super) fn size(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Sum of m v, and of m |v|.
pub(super) fn momenta(state: &State) -> ([f64; 3], f64) {
    let mut total = [0.0; 3];
    let mut scale = 0.0;
    for (velocity, mass) in state.velocity.iter().zip(&state.mass) {
        for d in 0..3 {
            total[d] += mass * velocity[d];
        }
        scale += mass * size(*velocity);
    }
    (total, scale)
}

fn momentum(bench: &mut Bench, law: Law, steps: u64) -> Result<(), Fault> {
    let spacing = 0.02;
    let interaction = match law.damping {
        Damping::Viscous => PLASTIC.with_itself().friction(0.5).dashpots(20.0, 5.0).clamped(),
        Damping::Restitution => PLASTIC.with_itself().friction(0.5).restitution(0.95).clamped(),
    };
    let mut scene = Scene::new(law, interaction, 2e-5);
    scene.plan.ledger = false;
    cloud(&mut scene, spacing, 0.0101, 0.0108, 0.3);
    repeating(&mut scene, spacing);
    for velocity in &mut scene.state.velocity {
        velocity[0] += 0.1;
    }
    let (before, scale) = momenta(&scene.state);
    let state = bench.after(&scene, steps)?;
    let (after, _) = momenta(&state);
    let drift = size(std::array::from_fn(|d| after[d] - before[d])) / scale;
    bench.judge("change of momentum over sum of m |v|", "1", drift, Kind::Conservation.at_most(1e-12));
    let contacts = state.contacts.len() as f64;
    bench.judge("contacts at the end", "1", contacts, Kind::Conservation.at_least(27.0));
    Ok(())
}

/// Sum of x × m v + I w about the origin, and of the sizes of its terms.
pub(super) fn angular_momenta(state: &State) -> ([f64; 3], f64) {
    let mut total = [0.0; 3];
    let mut scale = 0.0;
    for i in 0..state.len() {
        let (x, v, w) = (state.position[i], state.velocity[i], state.angular_velocity[i]);
        let inertia = sphere_inertia(state.mass[i], state.radius[i]);
        let orbit = [x[1] * v[2] - x[2] * v[1], x[2] * v[0] - x[0] * v[2], x[0] * v[1] - x[1] * v[0]];
        for d in 0..3 {
            total[d] += state.mass[i] * orbit[d] + inertia * w[d];
        }
        scale += state.mass[i] * size(orbit) + inertia * size(w);
    }
    (total, scale)
}

/// Eight unequal spheres at the corners of a cube, pressed together and moving inwards, spinning.
fn cluster(dt: f64) -> Scene {
    let interaction = PLASTIC.with_itself().friction(0.4).dashpots(50.0, 20.0).clamped();
    let mut scene = Scene::new(Law::GNTM, interaction, dt);
    scene.plan.ledger = false;
    for k in 0..8 {
        let corner = [k & 1, k >> 1 & 1, k >> 2 & 1].map(|c| 2.0 * f64::from(c) - 1.0);
        let index = k as usize;
        let (radius, jitter) = (0.0099 + 2e-4 * random(5, index), random_vector(6, index));
        let velocity = std::array::from_fn(|d| 0.1 * jitter[d] - 0.3 * corner[d]);
        scene.moving(radius, PLASTIC.density, corner.map(|c| 0.0096 * c), velocity);
        scene.state.angular_velocity[index] = random_vector(7, index).map(|w| 20.0 * w);
    }
    scene
}

fn angular_momentum(bench: &mut Bench) -> Result<(), Fault> {
    let scene = cluster(4e-9);
    let (before, scale) = angular_momenta(&scene.state);
    let state = bench.after(&scene, 100_000)?;
    let (after, _) = angular_momenta(&state);
    let drift = size(std::array::from_fn(|d| after[d] - before[d])) / scale;
    bench.judge("change of angular momentum over sum of sizes", "1", drift, Kind::Conservation.at_most(1e-12));
    bench.judge("contacts at the end", "1", state.contacts.len() as f64, Kind::Conservation.at_least(7.0));
    Ok(())
}

fn angular_momentum_gear(bench: &mut Bench) -> Result<(), Fault> {
    let mut drifts = Vec::new();
    for part in [1, 2, 4] {
        let mut scene = cluster(1e-5 / f64::from(part));
        scene.plan.integrator = Integrator::Gear;
        let (before, scale) = angular_momenta(&scene.state);
        let state = bench.after(&scene, 2000 * u64::from(part as u32))?;
        let (after, _) = angular_momenta(&state);
        drifts.push(size(std::array::from_fn(|d| after[d] - before[d])) / scale);
    }
    bench.judge("change at the smallest step", "1", drifts[2], Kind::Conservation.at_most(1e-3));
    let order = libm::log2(drifts[1] / drifts[2]);
    bench.judge("order of the change, at least", "1", order, Kind::Order.at_least(0.8));
    Ok(())
}

fn energy_elastic(bench: &mut Bench) -> Result<(), Fault> {
    let (spacing, speed) = (0.02, 0.3);
    let interaction = PLASTIC.with_itself();
    let least = 0.008;
    let hertz = Hertz::new(&interaction, 0.5 * least, 0.5 * PLASTIC.sphere_mass(least));
    let dt = hertz.duration(2.0 * speed * 3.0_f64.sqrt()) / 50.0;
    let mut scene = Scene::new(Law::GN, interaction, dt);
    cloud(&mut scene, spacing, least, 0.0096, speed);
    repeating(&mut scene, spacing);
    let mut simulation = bench.start(&scene)?;
    let start = Ledger::of(&simulation.state()?, &scene.plan).mechanical();
    let (mut worst, mut impacts) = (0.0_f64, 0);
    for _ in 0..400 {
        simulation.advance(25)?;
        let now = Ledger::of(&simulation.state()?, &scene.plan);
        worst = worst.max((now.mechanical() / start - 1.0).abs());
        impacts += now.contacts;
    }
    bench.judge("largest change of energy", "1", worst, Kind::Conservation.at_most(1e-4));
    bench.judge("contacts seen", "1", impacts as f64, Kind::Conservation.at_least(100.0));
    bench.seal(&simulation.state()?);
    Ok(())
}

fn ledger_closes(bench: &mut Bench) -> Result<(), Fault> {
    let (radius, speed) = (0.01, 2.0);
    let forms = [("displacement", Friction::Displacement, 0.3), ("rescaled", Friction::Rescaled, 0.8)];
    for (name, friction, dashpot) in forms {
        let law = Law { friction, ..Law::GNTM };
        let interaction = STEEL.with_itself().friction(0.3);
        let duration = Hertz::new(&interaction, 0.5 * radius, 0.5 * STEEL.sphere_mass(radius)).duration(speed);
        let interaction = interaction.dashpots(dashpot / duration, dashpot / duration).clamped();
        let mut errors = Vec::new();
        for parts in [200.0, 400.0, 800.0] {
            let mut scene = Scene::new(law, interaction, duration / parts);
            scene.moving(radius, STEEL.density, [-radius, 0.0, 0.0], [speed, 0.7, 0.2]);
            scene.sphere(radius, STEEL.density, [radius, 0.0, 0.0]);
            scene.state.angular_velocity[1] = [3.0, -20.0, 5.0];
            let state = bench.after(&scene, (2.0 * parts) as u64)?;
            let ledger = Ledger::of(&state, &scene.plan);
            errors.push(ledger.energy_error.abs() / (ledger.friction_dissipated + ledger.damping_dissipated));
        }
        let what = format!("{name}: closing error over dissipation at 800 steps to an impact");
        bench.judge(what, "1", errors[2], Kind::Conservation.at_most(1e-5));
        for k in 0..2 {
            let order = libm::log2(errors[k] / errors[k + 1]);
            bench.judge(format!("{name}: order of the error, {}", k + 1), "1", order, Kind::Order.within(2.0, 0.2));
        }
    }
    Ok(())
}

fn ledger_of_packing(bench: &mut Bench) -> Result<(), Fault> {
    let spacing = 0.021;
    let mut errors = Vec::new();
    for part in [1, 2] {
        let interaction = PLASTIC.with_itself().friction(0.5).dashpots(150.0, 50.0).clamped();
        let mut scene = Scene::new(Law::GNTM, interaction, 1e-5 / f64::from(part));
        scene.plan.gravity = [0.0, 0.0, -GRAVITY];
        cloud(&mut scene, spacing, 0.009, 0.0102, 0.5);
        scene.plan.domain =
            Domain { min: [0.0, 0.0, -1.0], max: [3.0 * spacing, 3.0 * spacing, 1.0], ..scene.plan.domain };
        scene.plan.domain.periodic = [true, true, false];
        scene.plan.search.skin = 1e-3;
        scene.floor();
        scene.plan.walls[0].velocity = [0.05, 0.0, 0.02];
        let state = bench.after(&scene, 15_000 * u64::from(part as u32))?;
        let ledger = Ledger::of(&state, &scene.plan);
        errors.push(ledger.energy_error.abs() / (ledger.friction_dissipated + ledger.damping_dissipated));
    }
    bench.judge("closing error over dissipation", "1", errors[0], Kind::Conservation.at_most(1e-2));
    bench.judge("the same at half the step", "1", errors[1], Kind::Conservation.at_most(5e-3));
    Ok(())
}

/// An elastic impact of a sphere on a rigid plane at an angle in degrees: energy before, and the ledger after.
fn glancing(bench: &mut Bench, friction: Friction, angle: f64, parts: u32) -> Result<(f64, Ledger), Fault> {
    let (radius, speed) = (0.0025, 3.9);
    let material = super::scene::ALUMINIUM_OXIDE;
    let interaction = material.with_rigid().friction(0.092);
    let angle = angle.to_radians();
    let (normal, across) = (speed * libm::cos(angle), speed * libm::sin(angle));
    let duration = Hertz::new(&interaction, radius, material.sphere_mass(radius)).duration(normal);
    let law = Law { friction, ..Law::GNTM };
    let mut scene = Scene::new(law, interaction, duration / f64::from(parts));
    scene.floor();
    scene.moving(radius, material.density, [0.0, 0.0, radius], [across, 0.0, -normal]);
    let before = Ledger::of(&scene.state, &scene.plan).kinetic();
    let state = bench.after(&scene, u64::from(parts) * 5 / 4)?;
    Ok((before, Ledger::of(&state, &scene.plan)))
}

fn displacement_form(bench: &mut Bench) -> Result<(), Fault> {
    let mut errors = Vec::new();
    for parts in [2000, 4000, 8000] {
        let (before, after) = glancing(bench, Friction::Displacement, 2.0, parts)?;
        errors.push(after.energy_error / before);
        if parts == 8000 {
            let gain = (after.kinetic() - before) / before;
            bench.judge("gain of energy, of the whole", "1", gain, Kind::Reference.within(1e-5, 0.5e-5));
            let booked = (after.stiffening_work - after.friction_dissipated) / before;
            bench.judge("the same as the ledger explains it", "1", booked, Kind::Conservation.relative(gain, 0.02));
        }
    }
    for (error, parts) in errors.iter().zip([2000, 4000, 8000]) {
        let what = format!("closing error of the ledger at {parts} steps");
        bench.judge(what, "1", error.abs(), Kind::Conservation.at_most(1e-10));
    }
    Ok(())
}

fn rescaled_form(bench: &mut Bench) -> Result<(), Fault> {
    for angle in [0.5, 2.0, 5.0, 10.0, 20.0, 40.0, 80.0] {
        let (before, after) = glancing(bench, Friction::Rescaled, angle, 4000)?;
        // Rounding and the error of Verlet's method in the normal direction are of the order of 1e-12.
        let gain = (after.kinetic() - before) / before;
        bench.judge(format!("{angle} deg: gain of energy"), "1", gain, Kind::Conservation.at_most(1e-11));
    }
    Ok(())
}
