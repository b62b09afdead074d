//! Chains of bonds against the closed forms of the discrete chain: a first particle that is clamped, `n` bonds.

use super::bonded::{CEMENT, FORMS, JOINT, RADIUS, ROCK, SPACING, Way, numbers, scene, settled, unit_of_time};
use super::scene::{Bench, Scene, crossing, random_vector};
use super::{Case, Kind, Tier};
use std::f64::consts::PI;
use tdem_engine::physics::bond::{Cement, Form, Joint};
use tdem_engine::{Bond, Constraint, Driven, Fault, Ledger, Ramp, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "chain/tension",
        tier: Tier::Quick,
        source: "bonds in series: F = K_n u / n",
        about: "The end of a chain of 1 and of 4 bonds is pulled along it and held.",
        body: tension,
    },
    Case {
        name: "chain/shear",
        tier: Tier::Quick,
        source: "parallel translation without rotation: F = K_s u, moments F L / 2 on both particles",
        about: "One of two bonded particles is moved across the bond, both kept from turning.",
        body: shear,
    },
    Case {
        name: "chain/torsion",
        tier: Tier::Quick,
        source: "bonds in series: M = K_t theta / n",
        about: "The end of a chain of 1 and of 4 bonds is turned about its axis and held.",
        body: torsion,
    },
    Case {
        name: "chain/pure-bending",
        tier: Tier::Quick,
        source: "the same moment in all bonds: M = K_b theta / n, deflection of the end n l theta / 2, no force",
        about: "The end of a chain of 1 and of 4 bonds is turned across its axis, free to move, and held.",
        body: pure_bending,
    },
    Case {
        name: "chain/cantilever",
        tier: Tier::Quick,
        source: "deflection per force of the discrete chain: l^2 n (4 n^2 - 1) / (12 K_b) + n / K_s",
        about: "The end of a chain of 1 and of 4 bonds is moved across its axis, free to turn, and held.",
        body: cantilever,
    },
    Case {
        name: "chain/cantilever-under-its-weight",
        tier: Tier::Quick,
        source: "sum over bonds of shear V_j / K_s and bending M_j / K_b times the arm to the end",
        about: "A clamped chain of 4 bonds sinks under gravity and comes to rest by local damping.",
        body: weight,
    },
    Case {
        name: "chain/step-load",
        tier: Tier::Quick,
        source: "leapfrog on paper: u = m g / K_n (1 - cos(k a)), sin(a/2) = w dt / 2: an overshoot of exactly 2",
        about: "Gravity is switched on along a single bond, without damping.",
        body: step_load,
    },
    Case {
        name: "chain/step-force",
        tier: Tier::Quick,
        source: "leapfrog on paper: an overshoot of exactly 2; work of a constant force: F u",
        about: "A force is applied at once to the end of a single bond, without damping.",
        body: step_force,
    },
    Case {
        name: "chain/ramped-force",
        tier: Tier::Quick,
        source: "u = F / K_n (t / T - sin(w t) / (w T)) while the force grows; after whole periods it does not swing",
        about: "A force grows over two periods of a mass on a bond and stays, steps halved.",
        body: ramped_force,
    },
    Case {
        name: "chain/axial-vibration",
        tier: Tier::Quick,
        source: "w_k = 2 sqrt(K_n/m) sin((2k-1) pi / (2 (2n+1))), leapfrog sin(a/2) = w dt / 2",
        about: "A chain of 10 bonds with one end clamped swings along itself in modes 1, 3 and 10.",
        body: axial_vibration,
    },
    Case {
        name: "chain/wave-speed",
        tier: Tier::Quick,
        source: "w = 2 sqrt(K_n/m) sin(k l/2), leapfrog sin(a/2) = w dt / 2; long waves: c = l sqrt(K_n/m)",
        about: "A wave of 40 bonds runs once around a chain that closes upon itself through the box.",
        body: wave_speed,
    },
    Case {
        name: "chain/bending-vibration",
        tier: Tier::Quick,
        source: "lowest eigenvalue of the assembled chain (crates/studies/reference/bonded.py), and Euler's beam of length (n + 1/2) l: 3.516 sqrt(E I / (rho A L^4))",
        about: "A clamped chain of 10 bonds swings across itself: frequency of the first mode.",
        body: bending_vibration,
    },
    Case {
        name: "chain/energy",
        tier: Tier::Quick,
        source: "energy of undamped motion is constant; velocity Verlet keeps it within bounds of second order",
        about: "A free chain of 5 bonds tumbles and vibrates in all its modes, steps halved.",
        body: energy,
    },
    Case {
        name: "chain/forms-agree",
        tier: Tier::Quick,
        source: "the incremental form is the total form to first order in rotations",
        about: "The same clamped chain swings under both forms, at two amplitudes.",
        body: forms_agree,
    },
    Case {
        name: "chain/ledger-closes-when-it-breaks",
        tier: Tier::Quick,
        source: "kinetic + elastic + dissipated + released - work = initial",
        about: "A damped chain of 11 bonds is torn by its own motion, steps halved: closing error.",
        body: ledger_closes,
    },
];

/// Small enough to be linear to the tolerance, large enough for the last digits of positions not to matter.
const SMALL: f64 = 1e-7;
/// Steps to rest.
const REST: u64 = 3000;

fn chain(form: Form, links: usize) -> Scene {
    let mut scene = scene(form, JOINT, 0.3);
    scene.damp_locally(0.7);
    scene.chain(links);
    scene
}

/// A chain with its end moved and at rest, for each form and for 1 and 4 bonds.
fn each(bench: &mut Bench, way: Way, judge: impl Fn(&mut Bench, &str, usize, &State)) -> Result<(), Fault> {
    for (name, form) in FORMS {
        for links in [1, 4] {
            let state = settled(bench, chain(form, links), way, REST)?;
            judge(bench, &format!("{name}, n = {links}"), links, &state);
        }
    }
    Ok(())
}

fn tension(bench: &mut Bench) -> Result<(), Fault> {
    let pulled = SMALL * SPACING;
    let way = Way { shift: [Some(pulled), None, None], turn: [None; 3] };
    each(bench, way, |bench, what, links, state| {
        let expected = numbers(&JOINT).stiffness.normal * pulled / links as f64;
        let (near, far) = (state.force[0][0], -state.force[links][0]);
        bench.judge(format!("{what}: force on the end"), "N", far, Kind::ClosedForm.relative(expected, 1e-6));
        bench.judge(format!("{what}: force on the clamp"), "N", near, Kind::ClosedForm.relative(expected, 1e-6));
    })
}

fn shear(bench: &mut Bench) -> Result<(), Fault> {
    let moved = SMALL * SPACING;
    let way = Way { shift: [Some(0.0), Some(moved), Some(0.0)], turn: [Some(0.0); 3] };
    for (name, form) in FORMS {
        let state = settled(bench, chain(form, 1), way, 1)?;
        let expected = numbers(&JOINT).stiffness.shear * moved;
        let force = Kind::ClosedForm.relative(expected, 1e-6);
        bench.judge(format!("{name}: force"), "N", state.force[0][1], force);
        for k in 0..2 {
            let moment = Kind::ClosedForm.relative(expected * RADIUS, 1e-6);
            bench.judge(format!("{name}: moment on particle {k}"), "N m", state.moment[k][2], moment);
        }
    }
    Ok(())
}

fn torsion(bench: &mut Bench) -> Result<(), Fault> {
    let way = Way { shift: [None; 3], turn: [Some(SMALL), None, None] };
    each(bench, way, |bench, what, links, state| {
        let expected = numbers(&JOINT).stiffness.torsion * SMALL / links as f64;
        let moment = -state.moment[links][0];
        bench.judge(format!("{what}: moment"), "N m", moment, Kind::ClosedForm.relative(expected, 1e-6));
    })
}

fn pure_bending(bench: &mut Bench) -> Result<(), Fault> {
    let way = Way { shift: [None; 3], turn: [None, None, Some(SMALL)] };
    each(bench, way, |bench, what, links, state| {
        let n = links as f64;
        let expected = numbers(&JOINT).stiffness.bending * SMALL / n;
        let (moment, deflection) = (-state.moment[links][2], state.position[links][1]);
        bench.judge(format!("{what}: moment"), "N m", moment, Kind::ClosedForm.relative(expected, 1e-6));
        let expected = 0.5 * n * SPACING * SMALL;
        bench.judge(format!("{what}: deflection"), "m", deflection, Kind::ClosedForm.relative(expected, 1e-6));
    })
}

fn cantilever(bench: &mut Bench) -> Result<(), Fault> {
    let moved = SMALL * SPACING;
    let way = Way { shift: [None, Some(moved), None], turn: [None; 3] };
    each(bench, way, |bench, what, links, state| {
        let (n, stiffness) = (links as f64, numbers(&JOINT).stiffness);
        let bending = SPACING * SPACING * n * (4.0 * n * n - 1.0) / (12.0 * stiffness.bending);
        let expected = moved / (bending + n / stiffness.shear);
        let force = -state.force[links][1];
        bench.judge(format!("{what}: force"), "N", force, Kind::ClosedForm.relative(expected, 1e-6));
        let at_clamp = Kind::ClosedForm.relative(expected * (n - 0.5) * SPACING, 1e-6);
        // What the clamp feels acts at the middle of the first bond, half a spacing away.
        let moment = state.moment[0][2] - state.force[0][1] * RADIUS;
        bench.judge(format!("{what}: moment in the first bond"), "N m", moment, at_clamp);
    })
}

fn weight(bench: &mut Bench) -> Result<(), Fault> {
    let (links, gravity) = (4, 0.01);
    for (name, form) in FORMS {
        let mut scene = chain(form, links);
        scene.plan.gravity = [0.0, -gravity, 0.0];
        scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
        let state = bench.after(&scene, 2 * REST)?;
        let (load, stiffness) = (state.mass[1] * gravity, numbers(&JOINT).stiffness);
        let mut expected = 0.0;
        for j in 0..links {
            // The middle of bond j lies half a spacing before particle j + 1.
            let arm = |particle: usize| (particle as f64 - j as f64 - 0.5) * SPACING;
            let shear = load * (links - j) as f64;
            let moment: f64 = (j + 1..=links).map(|particle| load * arm(particle)).sum();
            expected += shear / stiffness.shear + moment / stiffness.bending * arm(links);
        }
        let deflection = -state.position[links][1];
        bench.judge(format!("{name}: deflection"), "m", deflection, Kind::ClosedForm.relative(expected, 1e-5));
        let rest = Ledger::of(&state, &scene.plan).kinetic();
        let work = 0.5 * load * expected;
        bench.judge(format!("{name}: kinetic energy over work"), "1", rest / work, Kind::ClosedForm.at_most(1e-10));
    }
    Ok(())
}

/// The part of [`unit_of_time`] in which an oscillator of `frequency` over that unit turns by `angle` a step.
fn part(frequency: f64, angle: f64) -> f64 {
    2.0 * libm::sin(0.5 * angle) / frequency
}

fn step_load(bench: &mut Bench) -> Result<(), Fault> {
    let (steps, gravity) = (100, 1.0);
    for (name, form) in FORMS {
        let mut scene = scene(form, JOINT, part(1.0, PI / steps as f64));
        scene.chain(1);
        scene.plan.gravity = [gravity, 0.0, 0.0];
        scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
        let mut simulation = bench.start(&scene)?;
        let at_rest = scene.state.mass[1] * gravity / numbers(&JOINT).stiffness.normal;
        for (half, expected) in [(1, 1.0), (2, 2.0), (4, 0.0)] {
            simulation.advance(if half == 4 { steps } else { steps / 2 })?;
            let stretch = (simulation.state()?.position[1][0] - SPACING) / at_rest;
            let what = format!("{name}: stretch after {half} quarters of a period, of that at rest");
            bench.judge(what, "1", stretch, Kind::ClosedForm.within(expected, 1e-7));
        }
        bench.seal(&simulation.state()?);
    }
    Ok(())
}

/// A clamped bond along x with a force on its end, in `steps` steps per half period.
fn loaded(steps: u64, force: f64) -> Scene {
    let mut scene = scene(Form::Total, JOINT, part(1.0, PI / steps as f64));
    scene.chain(1);
    scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
    scene.hold(1, Constraint { force: [force, 0.0, 0.0], ..Constraint::FREE });
    scene
}

fn step_force(bench: &mut Bench) -> Result<(), Fault> {
    let (steps, force) = (100, 0.3);
    let scene = loaded(steps, force);
    let mut simulation = bench.start(&scene)?;
    let at_rest = force / numbers(&JOINT).stiffness.normal;
    for (half, expected) in [(1, 1.0), (2, 2.0), (4, 0.0)] {
        simulation.advance(if half == 4 { steps } else { steps / 2 })?;
        let state = simulation.state()?;
        let stretch = (state.position[1][0] - SPACING) / at_rest;
        let what = format!("stretch after {half} quarters of a period, of that at rest");
        bench.judge(what, "1", stretch, Kind::ClosedForm.within(expected, 1e-7));
        let work = Ledger::of(&state, &scene.plan).external_work / (force * at_rest);
        let what = format!("work after {half} quarters of a period, of F u at rest");
        bench.judge(what, "1", work, Kind::ClosedForm.within(expected, 1e-7));
    }
    bench.seal(&simulation.state()?);
    Ok(())
}

fn ramped_force(bench: &mut Bench) -> Result<(), Fault> {
    let force = 0.3;
    let at_rest = force / numbers(&JOINT).stiffness.normal;
    let mut swings = Vec::new();
    for steps in [50, 100] {
        let mut scene = loaded(steps, 0.0);
        // Two periods of the true oscillation; leapfrog's is shorter by the square of the step.
        let growth = 4.0 * PI * unit_of_time(&JOINT);
        let points = vec![[0.0, 0.0], [growth, force]];
        scene.plan.ramps = vec![Ramp { constraint: 2, drives: Driven::Force, axis: 0, points }];
        let mut simulation = bench.start(&scene)?;
        // A quarter of a period into the ramp: t / T = 1/8, sin = 1.
        simulation.advance(steps / 2)?;
        let stretch = (simulation.state()?.position[1][0] - SPACING) / at_rest;
        let expected = 0.125 - 0.25 / PI;
        let what = format!("{steps} steps per half period: stretch after a quarter, of that at rest");
        bench.judge(what, "1", stretch, Kind::ClosedForm.relative(expected, 10.0 / (steps * steps) as f64));
        simulation.advance(4 * steps)?;
        let mut farthest = [f64::INFINITY, f64::NEG_INFINITY];
        for _ in 0..2 * steps {
            simulation.advance(1)?;
            let stretch = (simulation.state()?.position[1][0] - SPACING) / at_rest;
            farthest = [farthest[0].min(stretch), farthest[1].max(stretch)];
        }
        swings.push(0.5 * (farthest[1] - farthest[0]));
        let state = simulation.state()?;
        let error = Ledger::of(&state, &scene.plan).energy_error / (force * at_rest);
        let what = format!("{steps} steps per half period: closing error, of F u at rest");
        bench.judge(what, "1", error, Kind::Conservation.within(0.0, 5.0 / (steps * steps) as f64));
        bench.seal(&state);
    }
    bench.judge("swing left with 100 steps, of the stretch", "1", swings[1], Kind::ClosedForm.within(0.0, 1e-3));
    let order = libm::log2(swings[0] / swings[1]);
    bench.judge("order of the swing that is left", "1", order, Kind::Order.within(2.0, 0.2));
    Ok(())
}

fn axial_vibration(bench: &mut Bench) -> Result<(), Fault> {
    let (links, steps, amplitude) = (10_usize, 999, 1e-4 * SPACING);
    for mode in [1_u32, 3, 10] {
        let phase = f64::from(2 * mode - 1) * PI / (2 * links + 1) as f64;
        let mut scene = scene(Form::Total, JOINT, 0.3);
        scene.chain(links);
        scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
        let shape = |k: usize| libm::sin(phase * k as f64);
        for k in 0..=links {
            scene.state.position[k][0] += amplitude * shape(k);
        }
        let state = bench.after(&scene, steps)?;
        let turn = 2.0 * libm::asin(0.5 * 0.3 * 2.0 * libm::sin(0.5 * phase));
        let found: f64 = (0..=links).map(|k| (state.position[k][0] - SPACING * k as f64) * shape(k)).sum();
        let of_start = found / amplitude / (0..=links).map(|k| shape(k) * shape(k)).sum::<f64>();
        let expected = libm::cos(steps as f64 * turn);
        let what = format!("mode {mode}: amplitude after {steps} steps, of the start");
        bench.judge(what, "1", of_start, Kind::ClosedForm.within(expected, 1e-8));
    }
    Ok(())
}

fn wave_speed(bench: &mut Bench) -> Result<(), Fault> {
    let (count, part, amplitude) = (40_usize, 0.2, 1e-5 * SPACING);
    let mut scene = scene(Form::Total, JOINT, part);
    scene.chain(count - 1);
    let mut bonds = scene.state.bonds.clone();
    bonds.push(Bond::new(0, count as u32 - 1, 1.0));
    scene.plan.domain.min[0] = -0.25 * SPACING;
    scene.plan.domain.max[0] = (count as f64 - 0.25) * SPACING;
    scene.plan.domain.periodic[0] = true;
    scene.state.make_bonds(bonds);
    let wave_number = 2.0 * PI / count as f64;
    let turn = 2.0 * libm::asin(0.5 * part * 2.0 * libm::sin(0.5 * wave_number));
    for k in 0..count {
        let phase = wave_number * k as f64;
        scene.state.position[k][0] += amplitude * libm::cos(phase);
        // The leapfrog's velocity of cos(k x - n a).
        scene.state.velocity[k][0] = amplitude * libm::sin(phase) * libm::sin(turn) / scene.plan.dt;
    }
    let steps = (count as f64 / part) as u64;
    let state = bench.after(&scene, steps)?;
    let (mut cosine, mut sine) = (0.0, 0.0);
    for k in 0..count {
        let (phase, moved) = (wave_number * k as f64, state.position[k][0] - SPACING * k as f64);
        cosine += moved * libm::cos(phase);
        sine += moved * libm::sin(phase);
    }
    let size = 2.0 / count as f64 * (cosine * cosine + sine * sine).sqrt() / amplitude;
    bench.judge("amplitude, of the start", "1", size, Kind::ClosedForm.within(1.0, 1e-6));
    // It has run once around, short of what its dispersion holds back.
    let way = 2.0 * PI + libm::atan2(sine, cosine);
    let expected = steps as f64 * turn;
    bench.judge("way in radians of the wave", "1", way, Kind::ClosedForm.relative(expected, 1e-7));
    let speed = way / (wave_number * steps as f64 * part);
    bench.judge("speed over that of long waves", "1", speed, Kind::ClosedForm.within(1.0, 2e-3));
    Ok(())
}

/// First frequency of a clamped chain of 10 bonds with kappa = 0.4 and a bond radius of 0.4 l, times sqrt(m/K_n).
const FIRST_FREQUENCY: f64 = 0.006_375_841_64;
/// The first solution of cos(x) cosh(x) = -1.
const EULER: f64 = 1.875_104_068_711_961;

fn bending_vibration(bench: &mut Bench) -> Result<(), Fault> {
    let links = 10_usize;
    let length = (links as f64 + 0.5) * SPACING;
    for (name, form) in FORMS {
        let mut scene = scene(form, JOINT, 0.3);
        scene.chain(links);
        scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
        // Euler's first mode and its slope, as velocities.
        let ratio = (libm::cosh(EULER) + libm::cos(EULER)) / (libm::sinh(EULER) + libm::sin(EULER));
        let shape = |k: usize| {
            let x = EULER * k as f64 * SPACING / length;
            libm::cosh(x) - libm::cos(x) - ratio * (libm::sinh(x) - libm::sin(x))
        };
        let slope = |k: usize| {
            let x = EULER * k as f64 * SPACING / length;
            EULER / length * (libm::sinh(x) + libm::sin(x) - ratio * (libm::cosh(x) - libm::cos(x)))
        };
        let speed = 1e-6 * SPACING / unit_of_time(&JOINT);
        for k in 1..=links {
            scene.state.velocity[k][1] = speed * shape(k);
            scene.state.angular_velocity[k][2] = speed * slope(k);
        }
        let mut simulation = bench.start(&scene)?;
        let (mut before, mut crossings, interval) = (0.0, Vec::new(), 40);
        for sample in 1..=200 {
            simulation.advance(interval)?;
            let state = simulation.state()?;
            let now: f64 = (1..=links).map(|k| state.position[k][1] * shape(k)).sum();
            if before * now < 0.0 {
                let part = f64::from(sample - 1) + crossing(before, now);
                crossings.push(part * interval as f64 * scene.plan.dt);
            }
            before = now;
        }
        bench.seal(&simulation.state()?);
        let periods = 0.5 * (crossings.len() as f64 - 1.0);
        let span = crossings.last().unwrap_or(&f64::NAN) - crossings.first().unwrap_or(&f64::NAN);
        let frequency = 2.0 * PI * periods / span * unit_of_time(&JOINT);
        let what = format!("{name}: frequency times sqrt(m/K_n)");
        bench.judge(what, "1", frequency, Kind::Reference.relative(FIRST_FREQUENCY, 1e-3));
        // E I = K_b l and rho A = m / l.
        let bending = numbers(&JOINT).stiffness.bending * SPACING;
        let beam = EULER * EULER / (length * length) * (bending * SPACING / ROCK.sphere_mass(RADIUS)).sqrt();
        let of_beam = frequency / unit_of_time(&JOINT) / beam;
        let what = format!("{name}: frequency over that of Euler's beam");
        bench.judge(what, "1", of_beam, Kind::ClosedForm.within(1.0, 2e-3));
    }
    Ok(())
}

/// A free chain that moves at random.
fn tumbling(form: Form, part: f64, speed: f64) -> Scene {
    let mut scene = scene(form, JOINT, part);
    scene.chain(5);
    for k in 0..6 {
        scene.state.velocity[k] = random_vector(31, k).map(|v| speed * v);
        scene.state.angular_velocity[k] = random_vector(32, k).map(|w| speed / RADIUS * w);
    }
    scene
}

/// Largest change of energy of a tumbling chain within so many samples, relative.
fn energy_change(bench: &mut Bench, scene: &Scene, samples: u32, interval: u64) -> Result<f64, Fault> {
    let mut simulation = bench.start(scene)?;
    let start = Ledger::of(&simulation.state()?, &scene.plan).mechanical();
    let mut largest = 0.0_f64;
    for _ in 0..samples {
        simulation.advance(interval)?;
        let now = Ledger::of(&simulation.state()?, &scene.plan);
        largest = largest.max((now.mechanical() / start - 1.0).abs());
    }
    bench.seal(&simulation.state()?);
    Ok(largest)
}

fn energy(bench: &mut Bench) -> Result<(), Fault> {
    let unit_of_speed = SPACING / unit_of_time(&JOINT);
    for (name, form) in FORMS {
        let mut worst = Vec::new();
        for halving in 0..3 {
            let parts = 1 << halving;
            let scene = tumbling(form, 0.1 / f64::from(parts), 1e-5 * unit_of_speed);
            worst.push(energy_change(bench, &scene, 200, 5 * u64::from(parts as u32))?);
        }
        let what = format!("{name}: largest change of energy at the smallest step");
        bench.judge(what, "1", worst[2], Kind::Conservation.at_most(2e-4));
        for k in 0..2 {
            let order = libm::log2(worst[k] / worst[k + 1]);
            let what = format!("{name}: order of the change, {}", k + 1);
            bench.judge(what, "1", order, Kind::Order.within(2.0, 0.2));
        }
    }
    // Its forces are the gradient of its energy for small strains only; still nothing accumulates. The incremental form
    // gains energy here.
    let scene = tumbling(Form::Total, 0.2, 1e-2 * unit_of_speed);
    let worst = energy_change(bench, &scene, 50, 200)?;
    bench.judge("total, strains of 1 %: largest change of energy", "1", worst, Kind::Conservation.at_most(3e-2));
    Ok(())
}

fn forms_agree(bench: &mut Bench) -> Result<(), Fault> {
    let mut apart = Vec::new();
    for amplitude in [1e-3, 1e-4] {
        let speed = amplitude * SPACING / unit_of_time(&JOINT);
        let mut ends = Vec::new();
        for (_, form) in FORMS {
            let mut scene = tumbling(form, 0.1, speed);
            scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
            let state = bench.after(&scene, 1000)?;
            let offsets = (0..6).map(|k| {
                let [x, y, z] = state.position[k];
                [x - SPACING * k as f64, y, z]
            });
            ends.push(offsets.collect::<Vec<[f64; 3]>>());
        }
        let size = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let largest = ends[0].iter().map(|v| size(*v)).fold(0.0, f64::max);
        let difference = |k: usize| size(std::array::from_fn(|d| ends[0][k][d] - ends[1][k][d]));
        apart.push((0..6).map(difference).fold(0.0, f64::max) / largest);
    }
    bench.judge("largest difference over amplitude", "1", apart[1], Kind::ClosedForm.at_most(1e-3));
    let order = libm::log10(apart[0] / apart[1]);
    bench.judge("order in the amplitude", "1", order, Kind::Order.within(1.0, 0.3));
    Ok(())
}

fn ledger_closes(bench: &mut Bench) -> Result<(), Fault> {
    let cement = Cement { tensile_strength: 6e4, damping_ratio: 0.02, ..CEMENT };
    let joint = Joint { cement, ..JOINT };
    let mut errors = Vec::new();
    for halving in 0..3 {
        let parts = 1 << halving;
        let mut scene = scene(Form::Total, joint, 0.05 / f64::from(parts));
        scene.chain(11);
        for k in 0..12 {
            scene.state.velocity[k] = [(k as f64 - 5.5) * 0.25, 0.0, 0.0];
        }
        let state = bench.after(&scene, 400 * u64::from(parts as u32))?;
        let ledger = Ledger::of(&state, &scene.plan);
        errors.push(ledger.energy_error.abs() / ledger.breakage_dissipated);
        if halving == 2 {
            let broken = ledger.broken_bonds as f64;
            bench.judge("broken bonds", "1", broken, Kind::Conservation.at_least(2.0));
            bench.judge("bonds that hold", "1", ledger.bonds as f64, Kind::Conservation.at_least(2.0));
        }
    }
    let what = "closing error over energy that left with bonds";
    bench.judge(what, "1", errors[2], Kind::Conservation.at_most(5e-4));
    Ok(())
}
