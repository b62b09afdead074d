//! Single bonds: vibration, damping, objectivity, failure and what comes after.

use super::bonded::{CEMENT, FORMS, JOINT, RADIUS, ROCK, SPACING, Way, numbers, scene};
use super::scene::{Bench, Hertz, Scene, random, random_vector};
use super::{Case, Kind, Tier};
use std::f64::consts::PI;
use tdem_engine::physics::bond::strength::{weibull, weibull_scale};
use tdem_engine::physics::bond::{Cement, Failure, Form, Joint, Tension};
use tdem_engine::physics::motion::orientation::Quaternion;
use tdem_engine::physics::motion::sphere_inertia;
use tdem_engine::physics::{Vec3, vec3};
use tdem_engine::{Bond, BondHistory, Constraint, Fault, Integrator, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "bond/vibration-verlet",
        tier: Tier::Quick,
        source: "w = sqrt(2 K_n / m); velocity Verlet is of second order",
        about: "Two bonded particles swing along their bond: error after 1.6 periods, steps halved.",
        body: |bench| vibration(bench, Integrator::VelocityVerlet, 100, 2.0),
    },
    Case {
        name: "bond/vibration-gear",
        tier: Tier::Quick,
        source: "w = sqrt(2 K_n / m); Gear's method with six values is of fifth order",
        about: "The same under Gear's method, started with the true derivatives.",
        body: |bench| vibration(bench, Integrator::Gear, 50, 5.0),
    },
    Case {
        name: "bond/modes",
        tier: Tier::Quick,
        source: "w^2 = 2 K_n/m, K_s (2/m + l^2/(2I)), 2 K_t/I, 2 K_b/I; leapfrog sin(a/2) = w dt / 2",
        about: "Two bonded particles swing in each of the four ways of a bond: rate after 500 steps.",
        body: modes,
    },
    Case {
        name: "bond/damped-vibration",
        tier: Tier::Quick,
        source: "a damping ratio zeta leaves exp(-2 pi zeta / sqrt(1 - zeta^2)) in each period",
        about: "Two bonded particles with dashpots swing along their bond and twist about it.",
        body: damped_vibration,
    },
    Case {
        name: "bond/unequal-spheres",
        tier: Tier::Quick,
        source: "K_n = E A / L_b, K_s = kappa K_n, A = pi (lambda min(R_1, R_2))^2; arms L R_i / (R_1 + R_2)",
        about: "Two unequal spheres with a gap, bonded by a material of a Young's modulus, are moved apart and across.",
        body: unequal_spheres,
    },
    Case {
        name: "bond/turned-assembly",
        tier: Tier::Quick,
        source: "objectivity: a rigid motion leaves no force, and forces turn with what is loaded",
        about: "Three bonded particles, as they were bonded and strained, turned as a whole in 12 ways.",
        body: turned_assembly,
    },
    Case {
        name: "bond/turning-pair",
        tier: Tier::Quick,
        source: "objectivity: after one revolution stored forces are what they were, whatever the step",
        about: "A loaded pair under the incremental form turns once about itself like a rigid body.",
        body: turning_pair,
    },
    Case {
        name: "bond/strength",
        tier: Tier::Quick,
        source: "sigma = F_n / A + beta |M_b| R / I, tau = |F_s| / A + beta |M_t| R / J",
        about: "A bond is loaded in each of its four ways and in two at once: step and kind of failure, energy that leaves.",
        body: strength,
    },
    Case {
        name: "bond/mohr-coulomb",
        tier: Tier::Quick,
        source: "tau_lim = c - F_n / A tan(phi)",
        about: "A bond is sheared while it is pressed, pulled, or neither: step of failure.",
        body: mohr_coulomb,
    },
    Case {
        name: "bond/weibull",
        tier: Tier::Quick,
        source: "P(x) = 1 - exp(-(x/s)^m), Kolmogorov and Smirnov at 1 %, mean s Gamma(1 + 1/m)",
        about: "400 bonds with scattered strengths are stretched alike: loads at which they break.",
        body: weibull_strengths,
    },
    Case {
        name: "bond/contact-takes-over",
        tier: Tier::Quick,
        source: "Hertz, and nothing in tension: what broke stays broken",
        about: "A bond is torn, its particles are pressed together and drawn apart again.",
        body: contact_takes_over,
    },
];

/// Position of the second particle of a swinging pair after 1.6 periods in a number of steps, over the amplitude.
fn swing(bench: &mut Bench, integrator: Integrator, parts: u64) -> Result<f64, Fault> {
    let frequency = 2.0_f64.sqrt();
    let turn = 1.6 * 2.0 * PI / parts as f64;
    let mut scene = scene(Form::Total, JOINT, turn / frequency);
    scene.plan.integrator = integrator;
    scene.chain(1);
    let amplitude = 1e-3 * SPACING;
    scene.state.position[0][0] = -amplitude;
    scene.state.position[1][0] += amplitude;
    if integrator == Integrator::Gear {
        // Scaled derivatives of the cosine at rest; those of odd order vanish.
        let square = turn * turn;
        let derivatives = |sign: f64| {
            let along = |value: f64| [sign * amplitude * value, 0.0, 0.0];
            [along(-0.5 * square), along(0.0), along(square * square / 24.0), along(0.0)]
        };
        scene.state.derivatives = vec![derivatives(-1.0), derivatives(1.0)];
    }
    Ok((bench.after(&scene, parts)?.position[1][0] - SPACING) / amplitude)
}

fn vibration(bench: &mut Bench, integrator: Integrator, coarsest: u64, order: f64) -> Result<(), Fault> {
    let expected = libm::cos(1.6 * 2.0 * PI);
    let mut errors = Vec::new();
    for doubling in 0..3 {
        errors.push((swing(bench, integrator, coarsest << doubling)? - expected).abs());
    }
    let what = format!("error in {} steps, of the amplitude", coarsest << 2);
    bench.judge(what, "1", errors[2], Kind::ClosedForm.at_most(1e-3));
    for k in 0..2 {
        let what = format!("order from {} to {} steps", coarsest << k, coarsest << (k + 1));
        let found = libm::log2(errors[k] / errors[k + 1]);
        bench.judge(what, "1", found, Kind::Order.within(order, 0.06 * order));
    }
    Ok(())
}

fn modes(bench: &mut Bench) -> Result<(), Fault> {
    let (stiffness, steps, part) = (numbers(&JOINT).stiffness, 500, 0.2);
    let mass = ROCK.sphere_mass(RADIUS);
    let inertia = sphere_inertia(mass, RADIUS);
    let shearing = stiffness.shear * (2.0 / mass + SPACING * SPACING / (2.0 * inertia));
    // Component of the velocities, of the angular velocities, whether the two turn alike, and w^2.
    let ways = [
        ("stretch", Some(0), None, 2.0 * stiffness.normal / mass),
        ("shear", Some(1), None, shearing),
        ("twist", None, Some(0), 2.0 * stiffness.torsion / inertia),
        ("bend", None, Some(2), 2.0 * stiffness.bending / inertia),
    ];
    for (name, form) in FORMS {
        for (what, moving, turning, square) in ways {
            let mut scene = scene(form, JOINT, part);
            scene.chain(1);
            let speed = 1e-8 * SPACING / scene.plan.dt;
            for (k, sign) in [(0, -1.0), (1, 1.0)] {
                if let Some(component) = moving {
                    scene.state.velocity[k][component] = sign * speed;
                }
                if let Some(component) = turning {
                    scene.state.angular_velocity[k][component] = sign * speed / RADIUS;
                }
            }
            if what == "shear" {
                // Both turn against it, as the moments of shear make them: the momenta about the middle cancel.
                let spin = -mass * SPACING * speed / (2.0 * inertia);
                scene.state.angular_velocity.iter_mut().for_each(|turn| turn[2] = spin);
            }
            let state = bench.after(&scene, steps)?;
            let moved = moving.map_or(0.0, |component| state.velocity[1][component] / speed);
            let rate = turning.map_or(moved, |component| RADIUS * state.angular_velocity[1][component] / speed);
            let turn = 2.0 * libm::asin(0.5 * square.sqrt() * scene.plan.dt);
            let expected = Kind::ClosedForm.within(libm::cos(steps as f64 * turn), 1e-4);
            bench.judge(format!("{name}, {what}: rate, of the start"), "1", rate, expected);
        }
    }
    Ok(())
}

fn damped_vibration(bench: &mut Bench) -> Result<(), Fault> {
    let (ratio, periods, parts) = (0.05_f64, 3_u64, 2000_u64);
    let joint = Joint { cement: Cement { damping_ratio: ratio, ..CEMENT }, ..JOINT };
    let stiffness = numbers(&joint).stiffness;
    let root = (1.0 - ratio * ratio).sqrt();
    // Of the twist: w^2 = 2 K_t / I.
    let twist = (stiffness.torsion / stiffness.normal / (0.4 * RADIUS * RADIUS)).sqrt();
    for (name, form) in FORMS {
        for (mode, frequency) in [("stretch", 2.0_f64.sqrt()), ("twist", twist * 2.0_f64.sqrt())] {
            let mut scene = scene(form, joint, 2.0 * PI / (frequency * root) / parts as f64);
            scene.chain(1);
            let speed = 1e-5 * SPACING / (scene.plan.dt * parts as f64);
            let rate = |state: &State| {
                if mode == "stretch" { state.velocity[1][0] } else { RADIUS * state.angular_velocity[1][0] }
            };
            for (k, sign) in [(0, -1.0), (1, 1.0)] {
                if mode == "stretch" {
                    scene.state.velocity[k][0] = sign * speed;
                } else {
                    scene.state.angular_velocity[k][0] = sign * speed / RADIUS;
                }
            }
            let state = bench.after(&scene, periods * parts)?;
            let decrement = -libm::log(rate(&state) / speed) / periods as f64;
            let expected = 2.0 * PI * ratio / root;
            let what = format!("{name}: logarithmic decrement of the {mode}");
            bench.judge(what, "1", decrement, Kind::ClosedForm.relative(expected, 1e-3));
        }
    }
    Ok(())
}

fn unequal_spheres(bench: &mut Bench) -> Result<(), Fault> {
    let (radii, length, modulus) = ([RADIUS, 1.5 * RADIUS], 2.8 * RADIUS, 6e6);
    let joint = Joint { stiffness_per_area: 0.0, young_modulus: modulus, ..JOINT };
    let moved = 1e-7 * length;
    for (name, form) in FORMS {
        let mut scene = scene(form, JOINT, 0.3);
        scene.plan.bonds.iter_mut().flat_map(|bonds| &mut bonds.joints).for_each(|each| *each = Some(joint));
        for (k, x) in [(0, 0.0), (1, length)] {
            scene.sphere(radii[k], ROCK.density, [x, 0.0, 0.0]);
        }
        scene.state.make_bonds(vec![Bond::new(0, 1, 1.0)]);
        scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
        let steps = 100;
        let way = Way { shift: [Some(moved), Some(moved), Some(0.0)], turn: [Some(0.0); 3] };
        scene.hold(1, way.at_rate(1.0 / steps as f64, scene.plan.dt));
        let state = bench.after(&scene, steps)?;
        let radius = CEMENT.radius_multiplier * RADIUS;
        let normal = modulus * PI * radius * radius / length * moved;
        let shear = CEMENT.stiffness_ratio * normal;
        let exactly = |value: f64| Kind::ClosedForm.relative(value, 1e-6);
        bench.judge(format!("{name}: normal force"), "N", state.force[0][0], exactly(normal));
        bench.judge(format!("{name}: shear force"), "N", state.force[0][1], exactly(shear));
        for k in 0..2 {
            let arm = length * radii[k] / (radii[0] + radii[1]);
            bench.judge(format!("{name}: moment on sphere {k}"), "N m", state.moment[k][2], exactly(shear * arm));
        }
    }
    Ok(())
}

/// The product of two turns: first the second, then the first.
fn after(first: Quaternion<f64>, second: Quaternion<f64>) -> Quaternion<f64> {
    first.from_earlier(Quaternion { vector: -second.vector, scalar: second.scalar })
}

fn turn_about(axis: [f64; 3], angle: f64) -> Quaternion<f64> {
    let axis: Vec3<f64> = axis.into();
    let unit = axis * (1.0 / axis.dot(axis).sqrt());
    Quaternion { vector: unit * libm::sin(0.5 * angle), scalar: libm::cos(0.5 * angle) }
}

/// Forces and moments of a chain of two bonds, displaced at random by a strain, then turned and shifted as a whole.
fn loads(bench: &mut Bench, strain: f64, turn: Quaternion<f64>, shift: Vec3<f64>) -> Result<Vec<Vec3<f64>>, Fault> {
    let mut scene = scene(Form::Total, JOINT, 0.3);
    scene.chain(2);
    for k in 0..3 {
        let own = turn_about(random_vector(42, k), strain);
        let displaced: Vec3<f64> = Vec3::from(random_vector(41, k)) * (strain * SPACING);
        let place = Vec3::from(scene.state.position[k]) + displaced;
        scene.state.position[k] = (turn.rotate(place) + shift).into();
        let Quaternion { vector, scalar } = after(turn, own);
        scene.state.orientation[k] = [vector.x, vector.y, vector.z, scalar];
    }
    let state = bench.after(&scene, 0)?;
    Ok(state.force.iter().chain(&state.moment).map(|&v| v.into()).collect())
}

fn turned_assembly(bench: &mut Bench) -> Result<(), Fault> {
    let strength = numbers(&JOINT).stiffness.normal * SPACING;
    let still = Vec3::zero();
    let strain = 1e-2;
    let loaded = loads(bench, strain, Quaternion::identity(), still)?;
    let size = |v: Vec3<f64>| v.dot(v).sqrt();
    let (mut rigid, mut strained) = (0.0_f64, 0.0_f64);
    for k in 0..12 {
        let turn = turn_about(random_vector(43, k), 2.0 * PI * random(44, k));
        let shift = Vec3::from(random_vector(45, k)) * SPACING;
        let forces = loads(bench, 0.0, turn, shift)?;
        rigid = forces.iter().fold(rigid, |most, &f| most.max(size(f) / strength));
        let forces = loads(bench, strain, turn, shift)?;
        let off = |k: usize| size(forces[k] - turn.rotate(loaded[k])) / size(loaded[k]);
        strained = (0..forces.len()).fold(strained, |most, k| most.max(off(k)));
    }
    bench.judge("rigid motion: largest force over K_n L", "1", rigid, Kind::Invariance.at_most(1e-14));
    bench.judge("turned load: largest difference, relative", "1", strained, Kind::Invariance.at_most(1e-11));
    let least = loaded.iter().fold(f64::INFINITY, |least, &f| least.min(size(f)));
    bench.judge("least load over K_n L R", "1", least / strength, Kind::Invariance.at_least(1e-8));
    Ok(())
}

fn turning_pair(bench: &mut Bench) -> Result<(), Fault> {
    let (tension, shear, couple) = (3.0, vec3(0.0, 1.0, 0.5), vec3(2e-3, 1e-3, -4e-3));
    let dt = 1e-5;
    for (name, form) in [("tension from length", Tension::FromLength), ("stored tension", Tension::Stored)] {
        for parts in [20_u32, 200] {
            let mut scene = scene(Form::Incremental(form), JOINT, 0.3);
            scene.plan.dt = dt;
            scene.chain(1);
            let stretch = tension / numbers(&JOINT).stiffness.normal;
            let arm = 0.5 * (SPACING + stretch);
            let history = BondHistory { normal: [1.0, 0.0, 0.0], tension, shear: shear.into(), couple: couple.into() };
            scene.state.bond_histories = vec![history];
            (scene.state.position[0], scene.state.position[1]) = ([-arm, 0.0, 0.0], [arm, 0.0, 0.0]);
            // Turns by the same angle in a step as the chords do.
            let spin = 2.0 * libm::tan(PI / f64::from(parts)) / dt;
            for k in 0..2 {
                scene.hold(k, Way::HELD.at_rate(0.0, dt));
            }
            for part in 1..=parts {
                let angle = 2.0 * PI * f64::from(part) / f64::from(parts);
                let place = [arm * libm::cos(angle), arm * libm::sin(angle), 0.0];
                for (k, sign) in [(0, -1.0), (1, 1.0)] {
                    // The chord to the next place.
                    let velocity = std::array::from_fn(|d| Some((sign * place[d] - scene.state.position[k][d]) / dt));
                    let angular_velocity = [Some(0.0), Some(0.0), Some(spin)];
                    scene.plan.constraints[k + 1] = Constraint { velocity, angular_velocity, ..Constraint::FREE };
                }
                let mut simulation = bench.start(&scene)?;
                simulation.advance(1)?;
                scene.state = simulation.state()?;
            }
            bench.seal(&scene.state);
            let found = scene.state.bond_histories.first().copied().unwrap_or_default();
            let apart = |found: [f64; 3], was: Vec3<f64>| {
                let off = Vec3::from(found) - was;
                (off.dot(off) / was.dot(was)).sqrt()
            };
            let exact = Kind::Invariance.at_most(1e-9);
            let what = format!("{name}, {parts} steps");
            bench.judge(format!("{what}: change of shear"), "1", apart(found.shear, shear), exact);
            bench.judge(format!("{what}: change of moments"), "1", apart(found.couple, couple), exact);
            let off = (found.tension / tension - 1.0).abs();
            bench.judge(format!("{what}: change of tension"), "1", off, exact);
        }
    }
    Ok(())
}

/// Steps in which a load is made to reach a strength: it is exceeded in the next whole one.
const TO_STRENGTH: f64 = 400.5;

/// Way to failure along a bond that is stretched alone, m: a ten-thousandth of its length.
const TO_FAILURE: f64 = 1e-4 * SPACING;
/// Strengths that a bond reaches when it is stretched or sheared by [`TO_FAILURE`], Pa.
const TENSILE_STRENGTH: f64 = TO_FAILURE * JOINT.stiffness_per_area;
const SHEAR_STRENGTH: f64 = CEMENT.stiffness_ratio * TENSILE_STRENGTH;

/// Moves the second of two bonded particles until their bond breaks, by a part of its way in each step; `strength` is
/// the factor of this bond.
fn loaded_until_it_breaks(
    bench: &mut Bench,
    form: Form,
    cement: Cement<f64>,
    way: Way,
    strength: f64,
) -> Result<State, Fault> {
    let mut scene = scene(form, Joint { cement, ..JOINT }, 0.3);
    scene.chain(1);
    scene.state.bonds[0].strength = strength;
    scene.hold(0, Way::HELD.at_rate(0.0, 1.0));
    scene.hold(1, way.at_rate(1.0 / TO_STRENGTH, scene.plan.dt));
    bench.after(&scene, 3 * TO_STRENGTH as u64)
}

fn judge_breakage(bench: &mut Bench, what: &str, state: &State, step: f64, failure: Failure) {
    let breakage = state.bonds[0].breakage;
    let found = breakage.map_or(f64::NAN, |breakage| breakage.step as f64);
    bench.judge(format!("{what}: step of failure"), "1", found, Kind::ClosedForm.within(step, 0.0));
    let code = breakage.map_or(f64::NAN, |breakage| breakage.failure.code());
    let expected = Kind::ClosedForm.within(failure.code(), 0.0);
    bench.judge(format!("{what}: kind, 1 for tension, 2 for shear"), "1", code, expected);
}

/// A way to load a bond to failure.
struct Loading {
    what: &'static str,
    /// Stretch, shear, torsion and bending, each in units of what alone makes a bond of strength 1 fail.
    parts: [f64; 4],
    failure: Failure,
    moment_contribution: f64,
    /// Factor on both strengths.
    strength: f64,
}

const LOADINGS: [Loading; 7] = [
    Loading::new("tension", [1.0, 0.0, 0.0, 0.0], Failure::Tension),
    Loading::new("shear", [0.0, 1.0, 0.0, 0.0], Failure::Shear),
    Loading::new("torsion", [0.0, 0.0, 1.0, 0.0], Failure::Shear),
    Loading::new("bending", [0.0, 0.0, 0.0, 1.0], Failure::Tension),
    Loading::new("half tension, half bending", [0.5, 0.0, 0.0, 0.5], Failure::Tension),
    Loading {
        moment_contribution: 0.0,
        ..Loading::new("tension, half bending that counts for nothing", [1.0, 0.0, 0.0, 0.5], Failure::Tension)
    },
    Loading {
        strength: 1.5,
        ..Loading::new("shear and torsion, strength times 1.5", [0.0, 0.75, 0.75, 0.0], Failure::Shear)
    },
];

impl Loading {
    const fn new(what: &'static str, parts: [f64; 4], failure: Failure) -> Self {
        Loading { what, parts, failure, moment_contribution: 1.0, strength: 1.0 }
    }
    /// Ways (m) and angles (rad) to failure.
    fn deformations(&self) -> [f64; 4] {
        let angle = TO_FAILURE / (CEMENT.radius_multiplier * RADIUS);
        let [stretch, shear, torsion, bending] = self.parts;
        [stretch * TO_FAILURE, shear * TO_FAILURE, torsion * angle, bending * angle]
    }
    fn way(&self) -> Way {
        let [stretch, shear, torsion, bending] = self.deformations();
        // What bends swings about the middle of the bond: bending without shear.
        let across = shear + RADIUS * bending;
        Way { shift: [Some(stretch), Some(across), Some(0.0)], turn: [Some(torsion), Some(0.0), Some(bending)] }
    }
    /// Energy in the springs at failure, J.
    fn energy(&self) -> f64 {
        let stiffness = numbers(&JOINT).stiffness;
        let springs = [stiffness.normal, stiffness.shear, stiffness.torsion, stiffness.bending];
        springs.iter().zip(self.deformations()).map(|(spring, way)| 0.5 * spring * way * way).sum()
    }
}

fn strength(bench: &mut Bench) -> Result<(), Fault> {
    for (name, form) in FORMS {
        for loading in &LOADINGS {
            let cement = Cement {
                tensile_strength: TENSILE_STRENGTH,
                shear_strength: SHEAR_STRENGTH,
                moment_contribution: loading.moment_contribution,
                ..CEMENT
            };
            let state = loaded_until_it_breaks(bench, form, cement, loading.way(), loading.strength)?;
            let what = format!("{name}, {}", loading.what);
            judge_breakage(bench, &what, &state, 401.0, loading.failure);
            let force = state.force[0].iter().fold(0.0_f64, |most, f| most.max(f.abs()));
            bench.judge(format!("{what}: force afterwards"), "N", force, Kind::ClosedForm.within(0.0, 1e-9));
            // What the springs hold in step 401, less their work in its second half.
            let expected = loading.energy() * 401.0 * 400.0 / (TO_STRENGTH * TO_STRENGTH);
            let energy = state.bonds[0].breakage.map_or(f64::NAN, |breakage| breakage.energy);
            let released = Kind::ClosedForm.relative(expected, 1e-3);
            bench.judge(format!("{what}: energy that leaves"), "J", energy, released);
        }
    }
    Ok(())
}

fn mohr_coulomb(bench: &mut Bench) -> Result<(), Fault> {
    let friction = 0.5;
    let cement = Cement { shear_strength: SHEAR_STRENGTH, internal_friction: friction, ..CEMENT };
    for (name, form) in FORMS {
        // Ways along the bond as parts of that across it.
        for (what, along) in [("pressed", -0.4), ("neither", 0.0), ("pulled", 0.4)] {
            let shift = [Some(along * TO_FAILURE), Some(TO_FAILURE), Some(0.0)];
            let way = Way { shift, turn: [Some(0.0); 3] };
            let state = loaded_until_it_breaks(bench, form, cement, way, 1.0)?;
            // kappa k s = c - k along s tan(phi), in units of c.
            let steps = TO_STRENGTH / (1.0 + along * friction / CEMENT.stiffness_ratio);
            judge_breakage(bench, &format!("{name}, {what}"), &state, steps.ceil(), Failure::Shear);
        }
    }
    Ok(())
}

fn weibull_strengths(bench: &mut Bench) -> Result<(), Fault> {
    let (count, shape, steps_to_mean) = (400_usize, 4.0, 300.0);
    let cement = Cement { tensile_strength: TENSILE_STRENGTH, ..CEMENT };
    let mut scene = scene(Form::Total, Joint { cement, ..JOINT }, 0.3);
    let scale = weibull_scale(1.0, shape);
    let mut bonds = Vec::new();
    for k in 0..count {
        let place = [0.0, 4.0 * RADIUS * (k % 20) as f64, 4.0 * RADIUS * (k / 20) as f64];
        let first = scene.sphere(RADIUS, ROCK.density, place);
        let second = scene.sphere(RADIUS, ROCK.density, [SPACING, place[1], place[2]]);
        (scene.state.constraint[first], scene.state.constraint[second]) = (1, 2);
        bonds.push(Bond::new(first as u32, second as u32, weibull(random(51, k), shape, scale)));
    }
    scene.state.make_bonds(bonds);
    let pull = Way { shift: [Some(TO_FAILURE), Some(0.0), Some(0.0)], turn: [Some(0.0); 3] };
    let dt = scene.plan.dt;
    scene.plan.constraints.extend([Way::HELD.at_rate(0.0, dt), pull.at_rate(1.0 / steps_to_mean, dt)]);
    let state = bench.after(&scene, (2.5 * steps_to_mean) as u64)?;
    // A bond that breaks in step k has a strength between those of steps k - 1 and k.
    let mut loads: Vec<f64> = state
        .bonds
        .iter()
        .map(|bond| bond.breakage.map_or(f64::NAN, |b| (b.step as f64 - 0.5) / steps_to_mean))
        .collect();
    loads.sort_by(f64::total_cmp);
    let n = count as f64;
    let below = |load: f64| 1.0 - libm::exp(-libm::pow(load / scale, shape));
    let distance = loads.iter().enumerate().map(|(k, &load)| (below(load) - (k as f64 + 0.5) / n).abs());
    let largest = distance.fold(0.0, |most: f64, d| if d.is_nan() { d } else { most.max(d) });
    let what = "largest distance of the distributions";
    bench.judge(what, "1", largest, Kind::Statistical.at_most(1.63 / n.sqrt()));
    let mean = loads.iter().sum::<f64>() / n;
    // Four standard errors; a Weibull distribution of shape 4 has a relative deviation of 0.2806.
    bench.judge("mean strength", "1", mean, Kind::Statistical.within(1.0, 4.0 * 0.2806 / n.sqrt()));
    Ok(())
}

fn contact_takes_over(bench: &mut Bench) -> Result<(), Fault> {
    let cement = Cement { tensile_strength: TENSILE_STRENGTH, ..CEMENT };
    let mut scene: Scene = scene(Form::Total, Joint { cement, ..JOINT }, 0.3);
    let dt = scene.plan.dt;
    scene.chain(1);
    scene.hold(0, Way::HELD.at_rate(0.0, dt));
    scene.hold(1, Way::HELD.at_rate(0.0, dt));
    let hertz = Hertz::new(&ROCK.with_itself(), 0.5 * RADIUS, 1.0);
    for (what, direction, steps, overlap) in
        [("torn", 1.0, 500, 0.0), ("pressed", -1.0, 700, 200.0), ("drawn apart", 1.0, 300, 0.0)]
    {
        let pull = Way { shift: [Some(direction * TO_FAILURE), Some(0.0), Some(0.0)], turn: [Some(0.0); 3] };
        scene.plan.constraints[2] = pull.at_rate(1.0 / TO_STRENGTH, dt);
        scene.state = bench.after(&scene, steps)?;
        let overlap = overlap * TO_FAILURE / TO_STRENGTH;
        let expected = -hertz.stiffness * overlap * overlap.sqrt();
        let force = Kind::ClosedForm.within(expected, 1e-9 * expected.abs());
        bench.judge(format!("{what}: force"), "N", scene.state.force[0][0], force);
        let step = scene.state.bonds[0].breakage.map_or(f64::NAN, |breakage| breakage.step as f64);
        bench.judge(format!("{what}: step of failure"), "1", step, Kind::ClosedForm.within(401.0, 0.0));
    }
    Ok(())
}
