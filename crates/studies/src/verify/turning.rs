//! Bodies that turn freely: what rigid rotation may not do to bonds, to dashpots, and to springs of friction.

use super::bonded::{CEMENT, JOINT, RADIUS, ROCK, SPACING, numbers, scene, unit_of_time};
use super::scene::{Bench, Scene, With};
use super::statics::rest;
use super::{Case, Kind, Tier};
use crate::statics::Boundary;
use std::f64::consts::PI;
use tdem_engine::physics::bond::{Cement, Form, Joint, Tension};
use tdem_engine::physics::contact::Interaction;
use tdem_engine::physics::{Vec3, vec3};
use tdem_engine::{Bond, Contact, Fault, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "turning/damped-bodies",
        tier: Tier::Quick,
        source: "static solution under the loads m w^2 r; objectivity: the tenth turn is the first",
        about: "A pair, a tetrahedron and a ball of 13 bonded spheres with dashpots turn ten times about oblique axes.",
        body: damped_bodies,
    },
    Case {
        name: "turning/damped-bodies-steps",
        tier: Tier::Full,
        source: "static solution under the loads m w^2 r; objectivity: the tenth turn is the first",
        about: "The tetrahedron at other speeds, axes and steps.",
        body: damped_bodies_steps,
    },
    Case {
        name: "turning/undamped-bodies",
        tier: Tier::Full,
        source: "conservation of energy",
        about: "A pair, a tetrahedron and a ball of 13 bonded spheres without dashpots turn ten times: error of the energy.",
        body: undamped_bodies,
    },
    Case {
        name: "turning/steady-tension-of-a-damped-pair",
        tier: Tier::Quick,
        source: "F = m w^2 L / 2, whatever the damping ratio and the step",
        about: "Bonded pairs with damping ratios up to 0.3 turn steadily: force of the spring, force of the dashpot.",
        body: damped_pair,
    },
    Case {
        name: "turning/friction-beside-bonds",
        tier: Tier::Quick,
        source: "objectivity: a held spring stays where its body carries it",
        about: "A bonded tetrahedron whose contacts hold loaded springs of friction and have dashpots turns ten times.",
        body: friction_beside_bonds,
    },
];

/// All forms of a bond.
const ALL_FORMS: [(&str, Form); 3] = [
    ("total", Form::Total),
    ("incremental", Form::Incremental(Tension::FromLength)),
    ("stored", Form::Incremental(Tension::Stored)),
];

/// A body of bonded spheres of equal principal moments of inertia, or a pair that turns about an axis across it.
#[derive(Clone, Copy)]
enum Body {
    Pair,
    Tetrahedron,
    /// A sphere and its twelve neighbours on a face-centred cubic lattice.
    Ball,
}

impl Body {
    const ALL: [Body; 3] = [Body::Pair, Body::Tetrahedron, Body::Ball];

    fn name(self) -> &'static str {
        match self {
            Body::Pair => "pair",
            Body::Tetrahedron => "tetrahedron",
            Body::Ball => "ball",
        }
    }
    /// An axis that the body turns about steadily, oblique to its bonds (but for the pair) and to the axes of space.
    fn axis(self) -> Vec3<f64> {
        match self {
            Body::Pair => vec3(0.64, -0.48, 0.6),
            Body::Tetrahedron => vec3(0.36, 0.48, 0.8),
            Body::Ball => vec3(2.0, 3.0, 6.0) * (1.0 / 7.0),
        }
    }
    /// Centres of touching spheres about the centre of mass, m.
    fn sites(self) -> Vec<Vec3<f64>> {
        let half = 0.5 * SPACING;
        let corner = SPACING / 8.0_f64.sqrt();
        match self {
            Body::Pair => [-half, half].map(|s| vec3(0.6, 0.8, 0.0) * s).to_vec(),
            Body::Tetrahedron => [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]
                .map(|[x, y, z]: [f64; 3]| vec3(x, y, z) * corner)
                .to_vec(),
            Body::Ball => {
                let sites = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9].map(|c| f64::from(c) - 1.0));
                sites
                    .filter(|site| [0.0, 2.0].contains(&site.iter().map(|c| c * c).sum::<f64>()))
                    .map(|[x, y, z]| vec3(x, y, z) * (2.0 * corner))
                    .collect()
            }
        }
    }
    /// Adds the body, turning about its axis as a rigid body.
    fn add(self, scene: &mut Scene, axis: Vec3<f64>, rate: f64) {
        let spin = axis * rate;
        let sites = self.sites();
        for &site in &sites {
            let index = scene.moving(RADIUS, ROCK.density, site.into(), spin.cross(site).into());
            scene.state.angular_velocity[index] = spin.into();
        }
        let mut bonds = Vec::new();
        for i in 0..sites.len() {
            for j in i + 1..sites.len() {
                let offset = sites[j] - sites[i];
                if offset.dot(offset).sqrt() < 1.01 * SPACING {
                    bonds.push(Bond::new(i as u32, j as u32, 1.0));
                }
            }
        }
        scene.state.make_bonds(bonds);
    }
    /// Tensions of its bonds at rest under the loads $m\omega^2 r$ away from the axis, N.
    fn static_tensions(self, scene: &Scene, axis: Vec3<f64>, rate: f64) -> Result<Vec<f64>, Fault> {
        let sites = self.sites();
        let mut boundary = Boundary::free(sites.len());
        boundary.held[0] = [Some(0.0); 6];
        for (k, site) in sites.iter().enumerate() {
            let from_axis = *site - axis * axis.dot(*site);
            let load = from_axis * (scene.state.mass[k] * rate * rate);
            boundary.loads[k] = [load.x, load.y, load.z, 0.0, 0.0, 0.0];
        }
        let moved = rest(scene, &boundary)?.displacement;
        let stiffness = numbers(&JOINT).stiffness.normal;
        let tension = |bond: &Bond| {
            let (i, j) = (bond.first as usize, bond.second as usize);
            let shift = |k: usize| vec3(moved[k][0], moved[k][1], moved[k][2]);
            stiffness * (shift(j) - shift(i)).dot(sites[j] - sites[i]) / SPACING
        };
        Ok(scene.state.bonds.iter().map(tension).collect())
    }
}

/// A joint with a damping ratio.
fn damped(damping_ratio: f64) -> Joint<f64> {
    Joint { cement: Cement { damping_ratio, ..CEMENT }, ..JOINT }
}

/// What all bonds do: lengths, m, and sizes of forces, N, as the motion feels them.
fn loads(scene: &Scene, state: &State) -> Vec<[f64; 3]> {
    let evaluated = (0..state.bonds.len()).filter_map(|k| state.evaluate_bond(&scene.plan, k));
    let size = |v: Vec3<f64>| v.dot(v).sqrt();
    evaluated.map(|bond| [size(bond.ends.offset), bond.reaction.load.normal, size(bond.reaction.force)]).collect()
}

/// A body with dashpots, from its unloaded shape, through ten turns of so many steps.
fn ten_damped_turns(
    bench: &mut Bench,
    body: Body,
    (name, form): (&str, Form),
    axis: Vec3<f64>,
    [turn, part]: [f64; 2],
) -> Result<(), Fault> {
    let joint = damped(0.3);
    let mut scene = scene(form, joint, part);
    let rate = 2.0 * PI / (turn * unit_of_time(&joint));
    body.add(&mut scene, axis, rate);
    let statics = body.static_tensions(&scene, axis, rate)?;
    let steps = libm::round(turn / part) as u64;
    let mut simulation = bench.start(&scene)?;
    simulation.advance(steps)?;
    let first = loads(&scene, &simulation.state()?);
    simulation.advance(9 * steps)?;
    let state = simulation.state()?;
    bench.seal(&state);
    let tenth = loads(&scene, &state);
    let largest = |values: &[[f64; 3]], k: usize| values.iter().map(|v| v[k].abs()).fold(0.0, f64::max);
    let apart = |k: usize| first.iter().zip(&tenth).map(|(a, b)| (a[k] - b[k]).abs()).fold(0.0, f64::max);
    let what = format!("{}, {name}, {steps} steps a turn", body.name());
    let steady = Kind::Invariance.at_most(1e-9);
    let off = apart(0) / SPACING;
    bench.judge(format!("{what}: change of lengths from the first to the tenth turn"), "1", off, steady);
    let off = apart(2) / largest(&first, 2);
    bench.judge(format!("{what}: change of forces from the first to the tenth turn"), "1", off, steady);
    let scale = statics.iter().map(|tension| tension.abs()).fold(0.0, f64::max);
    let off = tenth.iter().zip(&statics).map(|(found, tension)| (found[1] - tension).abs()).fold(0.0, f64::max);
    bench.judge(
        format!("{what}: tensions against the static solution"),
        "1",
        off / scale,
        Kind::Reference.at_most(0.01),
    );
    Ok(())
}

fn damped_bodies(bench: &mut Bench) -> Result<(), Fault> {
    for body in Body::ALL {
        for form in ALL_FORMS {
            ten_damped_turns(bench, body, form, body.axis(), [400.0, 0.2])?;
        }
    }
    Ok(())
}

fn damped_bodies_steps(bench: &mut Bench) -> Result<(), Fault> {
    for form in ALL_FORMS {
        for (axis, turn, part) in [
            (vec3(0.36, 0.48, 0.8), 400.0, 0.05),
            (vec3(0.36, 0.48, 0.8), 1600.0, 0.2),
            (vec3(0.0, 0.0, 1.0), 400.0, 0.2),
            (vec3(-2.0, 1.0, 2.0) * (1.0 / 3.0), 800.0, 0.1),
        ] {
            ten_damped_turns(bench, Body::Tetrahedron, form, axis, [turn, part])?;
        }
    }
    Ok(())
}

/// Kinetic energy and energy of all bonds, J.
fn energies(scene: &Scene, state: &State) -> [f64; 2] {
    let kinetic = |k: usize| {
        let sphere = state.sphere(k);
        let inertia = 0.4 * sphere.mass * sphere.radius * sphere.radius;
        let spin = sphere.angular_velocity;
        0.5 * (sphere.mass * sphere.velocity.dot(sphere.velocity) + inertia * spin.dot(spin))
    };
    let elastic = |k: usize| state.evaluate_bond(&scene.plan, k).map_or(0.0, |bond| bond.stored_energy());
    [(0..state.len()).map(kinetic).sum(), (0..state.bonds.len()).map(elastic).sum()]
}

fn undamped_bodies(bench: &mut Bench) -> Result<(), Fault> {
    let (turn, part) = (2000.0, 0.1);
    for body in Body::ALL {
        for (name, form) in ALL_FORMS {
            let mut scene = scene(form, JOINT, part);
            body.add(&mut scene, body.axis(), 2.0 * PI / (turn * unit_of_time(&JOINT)));
            let [start, _] = energies(&scene, &scene.state);
            let steps = libm::round(turn / part) as u64;
            let mut simulation = bench.start(&scene)?;
            let mut errors = [0.0_f64; 10];
            for error in &mut errors {
                for _ in 0..20 {
                    simulation.advance(steps / 20)?;
                    let [kinetic, elastic] = energies(&scene, &simulation.state()?);
                    *error = error.max(((kinetic + elastic) / start - 1.0).abs());
                }
            }
            bench.seal(&simulation.state()?);
            let largest = errors.into_iter().fold(0.0, f64::max);
            let what = format!("{}, {name}", body.name());
            let small = Kind::Conservation.at_most(1e-6);
            bench.judge(
                format!("{what}: error of the energy in ten turns, of the kinetic energy"),
                "1",
                largest,
                small,
            );
            let early = errors[..5].iter().copied().fold(0.0, f64::max);
            let late = errors[5..].iter().copied().fold(0.0, f64::max);
            let grown = Kind::Conservation.at_most(1.2);
            bench.judge(
                format!("{what}: error of the last five turns over that of the first"),
                "1",
                late / early,
                grown,
            );
        }
    }
    Ok(())
}

fn damped_pair(bench: &mut Bench) -> Result<(), Fault> {
    for (name, form) in ALL_FORMS {
        for (ratio, part) in [(0.0, 0.2), (0.05, 0.2), (0.3, 0.2), (0.3, 0.02)] {
            let joint = damped(ratio);
            let (turn, body) = (628.0, Body::Pair);
            let mut scene = scene(form, joint, part);
            let rate = 2.0 * PI / (turn * unit_of_time(&joint));
            body.add(&mut scene, body.axis(), rate);
            // From the length at which it turns steadily.
            let mass = scene.state.mass[0];
            let stiffness = numbers(&joint).stiffness.normal;
            let stretch = 0.5 * mass * rate * rate * SPACING / (stiffness - 0.5 * mass * rate * rate);
            let longer = 1.0 + stretch / SPACING;
            for k in 0..2 {
                for d in 0..3 {
                    scene.state.position[k][d] *= longer;
                    scene.state.velocity[k][d] *= longer;
                }
            }
            let tension = stiffness * stretch;
            if form != Form::Total {
                let normal = body.sites()[1] * (2.0 / SPACING);
                let history = tdem_engine::BondHistory { normal: normal.into(), tension, ..Default::default() };
                scene.state.bond_histories = vec![history];
            }
            let state = bench.after(&scene, (0.3 * turn / part) as u64)?;
            let found = loads(&scene, &state)[0];
            let what = format!("{name}, damping ratio {ratio}, step {part}");
            let spring = Kind::ClosedForm.relative(tension, 1e-4);
            bench.judge(format!("{what}: force of the spring"), "N", found[1], spring);
            let dashpot = Kind::ClosedForm.within(0.0, 1e-4);
            let off = (found[2] - found[1].abs()) / tension;
            bench.judge(format!("{what}: force of the dashpot, of that of the spring"), "1", off, dashpot);
        }
    }
    Ok(())
}

/// Springs of friction in the body of a particle: turned back by its orientation.
fn in_body(state: &State, contact: &Contact) -> Vec3<f64> {
    let [x, y, z, w] = state.orientation[contact.first as usize];
    let back = tdem_engine::physics::motion::orientation::Quaternion { vector: -vec3(x, y, z), scalar: w };
    back.rotate(contact.displacement.into())
}

fn friction_beside_bonds(bench: &mut Bench) -> Result<(), Fault> {
    let joint = damped(0.3);
    for (name, form) in ALL_FORMS {
        let mut scene = scene(form, joint, 0.1);
        if let Some(bonds) = &mut scene.plan.bonds {
            bonds.contact_in_bonded_pairs = true;
        }
        let body = Body::Tetrahedron;
        let turn = 400.0;
        let rate = 2.0 * PI / (turn * unit_of_time(&joint));
        // Large enough for friction to hold, small enough for contacts to stay pressed.
        let overlap = 2e-2 * SPACING;
        let dashpot = 0.05 / unit_of_time(&joint);
        scene.plan.interactions = vec![
            Interaction { ..ROCK.with_itself() }.friction(1e9).dashpots(dashpot, dashpot);
            scene.plan.interactions.len()
        ];
        body.add(&mut scene, body.axis(), rate);
        for radius in &mut scene.state.radius {
            *radius += 0.5 * overlap;
        }
        let sites = body.sites();
        scene.state.contacts = (scene.state.bonds.iter().zip(1..))
            .map(|(bond, k)| {
                let normal = sites[bond.second as usize] - sites[bond.first as usize];
                let across = normal.cross(vec3(f64::from(k), 1.0, -0.5));
                let displacement = across * (1e-3 * SPACING / across.dot(across).sqrt());
                Contact { first: bond.first, second: bond.second, displacement: displacement.into() }
            })
            .collect();
        let steps = libm::round(turn / 0.1) as u64;
        let mut simulation = bench.start(&scene)?;
        simulation.advance(steps)?;
        let first = simulation.state()?;
        simulation.advance(9 * steps)?;
        let tenth = simulation.state()?;
        bench.seal(&tenth);
        let mut off = 0.0_f64;
        let mut least = f64::INFINITY;
        for (was, is) in first.contacts.iter().zip(&tenth.contacts) {
            let (was, is) = (in_body(&first, was), in_body(&tenth, is));
            let change = is - was;
            off = off.max((change.dot(change) / was.dot(was)).sqrt());
            least = least.min(was.dot(was).sqrt() / SPACING);
        }
        bench.judge(
            format!("{name}: contacts that hold"),
            "1",
            tenth.contacts.len() as f64,
            Kind::Invariance.within(6.0, 0.0),
        );
        bench.judge(
            format!("{name}: smallest displacement of a spring, of a diameter"),
            "1",
            least,
            Kind::Invariance.at_least(1e-4),
        );
        let steady = Kind::Invariance.at_most(1e-9);
        bench.judge(format!("{name}: change of springs from the first to the tenth turn"), "1", off, steady);
    }
    Ok(())
}
