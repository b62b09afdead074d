//! Bodies that turn freely: what rigid rotation may not do to bonds, to dashpots, and to springs of friction.

use super::bonded::{CEMENT, JOINT, RADIUS, ROCK, SPACING, numbers, scene, unit_of_time};
use super::scene::{Bench, Scene, With};
use super::statics::rest;
use super::{Case, Kind, Tier};
use crate::statics::Boundary;
use std::f64::consts::PI;
use tdem_engine::physics::bond::{Cement, Damping, Form, Joint, Tension};
use tdem_engine::physics::contact::Interaction;
use tdem_engine::physics::motion::orientation::Quaternion;
use tdem_engine::physics::{Vec3, vec3};
use tdem_engine::{Bond, Contact, Fault, State};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "turning/damped-bodies",
        tier: Tier::Quick,
        source: "static solution under the loads m w^2 r; objectivity: the tenth turn is the first",
        about: "A pair and a tetrahedron of bonded spheres with dashpots turn ten times about axes oblique to space and to bonds.",
        body: damped_bodies,
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
    Case {
        name: "turning/damped-bodies-steps",
        tier: Tier::Full,
        source: "static solution under the loads m w^2 r; objectivity: the tenth turn is the first",
        about: "The tetrahedron at other speeds, axes and steps, and a ball of 13 spheres.",
        body: damped_bodies_steps,
    },
    Case {
        name: "turning/undamped-bodies",
        tier: Tier::Full,
        source: "conservation of energy",
        about: "A pair, a tetrahedron and a ball of 13 bonded spheres, at rest in themselves, turn ten times without dashpots: error of the energy.",
        body: undamped_bodies,
    },
];

/// All forms of a bond.
const ALL_FORMS: [(&str, Form); 3] = [
    ("total", Form::Total),
    ("incremental", Form::Incremental(Tension::FromLength)),
    ("stored", Form::Incremental(Tension::Stored)),
];

/// A body of bonded spheres that turns about an axis of its symmetry, which stays an axis of inertia as the body is stretched.
#[derive(Clone, Copy)]
enum Body {
    /// About an axis across its bond.
    Pair,
    /// About the axis through a corner, oblique to three bonds.
    Tetrahedron,
    /// The same about the axis through the middles of two edges, oblique to four bonds.
    TetrahedronByEdges,
    /// A sphere and its twelve neighbours on a face-centred cubic lattice, about the diagonal of the cube.
    Ball,
}

/// Turns bodies so that nothing lies along the axes of space.
fn askew() -> Quaternion<f64> {
    let half = 0.55;
    Quaternion { vector: vec3(2.0, 3.0, 6.0) * (libm::sin(half) / 7.0), scalar: libm::cos(half) }
}

impl Body {
    fn name(self) -> &'static str {
        match self {
            Body::Pair => "pair",
            Body::Tetrahedron => "tetrahedron",
            Body::TetrahedronByEdges => "tetrahedron by its edges",
            Body::Ball => "ball",
        }
    }
    /// The axis that it turns about.
    fn axis(self) -> Vec3<f64> {
        askew().rotate(match self {
            Body::Pair | Body::TetrahedronByEdges => vec3(0.0, 0.0, 1.0),
            Body::Tetrahedron | Body::Ball => vec3(1.0, 1.0, 1.0) * (1.0 / 3.0_f64.sqrt()),
        })
    }
    /// Centres of touching spheres about the centre of mass, m.
    fn sites(self) -> Vec<Vec3<f64>> {
        self.upright().into_iter().map(|site| askew().rotate(site)).collect()
    }
    fn upright(self) -> Vec<Vec3<f64>> {
        let half = 0.5 * SPACING;
        let corner = SPACING / 8.0_f64.sqrt();
        match self {
            Body::Pair => [-half, half].map(|s| vec3(0.6, 0.8, 0.0) * s).to_vec(),
            Body::Tetrahedron | Body::TetrahedronByEdges => {
                [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]
                    .map(|[x, y, z]: [f64; 3]| vec3(x, y, z) * corner)
                    .to_vec()
            }
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
    fn add(self, scene: &mut Scene, rate: f64) {
        let spin = self.axis() * rate;
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
    fn static_tensions(self, scene: &Scene, rate: f64) -> Result<Vec<f64>, Fault> {
        let (sites, axis) = (self.sites(), self.axis());
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
    [turn, part]: [f64; 2],
) -> Result<(), Fault> {
    let joint = damped(0.3);
    let mut scene = scene(form, joint, part);
    let rate = 2.0 * PI / (turn * unit_of_time(&joint));
    body.add(&mut scene, rate);
    let statics = body.static_tensions(&scene, rate)?;
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
    for form in ALL_FORMS {
        ten_damped_turns(bench, Body::Tetrahedron, form, [400.0, 0.2])?;
    }
    ten_damped_turns(bench, Body::Pair, ALL_FORMS[1], [400.0, 0.2])
}

fn damped_bodies_steps(bench: &mut Bench) -> Result<(), Fault> {
    for form in ALL_FORMS {
        ten_damped_turns(bench, Body::Pair, form, [400.0, 0.2])?;
        ten_damped_turns(bench, Body::Ball, form, [400.0, 0.1])?;
        ten_damped_turns(bench, Body::TetrahedronByEdges, form, [400.0, 0.2])?;
        for [turn, part] in [[200.0, 0.05], [400.0, 0.1], [1000.0, 0.25]] {
            ten_damped_turns(bench, Body::Tetrahedron, form, [turn, part])?;
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

/// Steps between looks at the energy, in a turn.
const LOOKS: u64 = 20;

fn undamped_bodies(bench: &mut Bench) -> Result<(), Fault> {
    let (turn, part) = (400.0, 0.1);
    let steps = libm::round(turn / part) as u64;
    for body in [Body::Pair, Body::Tetrahedron, Body::Ball] {
        for (name, form) in ALL_FORMS {
            // A turn with dashpots brings the body to rest in itself.
            let mut scene = scene(form, damped(0.3), part);
            body.add(&mut scene, 2.0 * PI / (turn * unit_of_time(&JOINT)));
            scene.state = bench.after(&scene, steps)?;
            if let Some(bonds) = &mut scene.plan.bonds {
                bonds.law.damping = Damping::Off;
            }
            let [kinetic, elastic] = energies(&scene, &scene.state);
            let start = kinetic + elastic;
            let mut simulation = bench.start(&scene)?;
            let mut errors = [0.0_f64; 10];
            for error in &mut errors {
                for _ in 0..LOOKS {
                    simulation.advance(steps / LOOKS)?;
                    let [kinetic, elastic] = energies(&scene, &simulation.state()?);
                    *error = error.max((kinetic + elastic - start).abs() / kinetic);
                }
            }
            bench.seal(&simulation.state()?);
            let largest = |turns: &[f64]| turns.iter().copied().fold(0.0, f64::max);
            let what = format!("{}, {name}", body.name());
            let small = Kind::Conservation.at_most(1e-6);
            let error = largest(&errors);
            bench.judge(format!("{what}: error of the energy in ten turns, of the kinetic energy"), "1", error, small);
            let grown = largest(&errors[5..]) - largest(&errors[..5]);
            let steady = Kind::Conservation.at_most(1e-9);
            bench.judge(
                format!("{what}: growth of the error from the first to the last five turns"),
                "1",
                grown,
                steady,
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
            body.add(&mut scene, rate);
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
    let back = Quaternion { vector: -vec3(x, y, z), scalar: w };
    back.rotate(contact.displacement.into())
}

fn friction_beside_bonds(bench: &mut Bench) -> Result<(), Fault> {
    let joint = damped(0.3);
    for (name, form) in [ALL_FORMS[0], ALL_FORMS[2]] {
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
        body.add(&mut scene, rate);
        for radius in &mut scene.state.radius {
            *radius += 0.5 * overlap;
        }
        let (sites, axis) = (body.sites(), body.axis());
        // Alike about the axis of symmetry, so that it stays an axis of inertia.
        let springs = scene.state.bonds.iter().map(|bond| {
            let normal = (sites[bond.second as usize] - sites[bond.first as usize]) * (1.0 / SPACING);
            let along = normal.dot(axis);
            let across = normal.cross(axis) * 0.8 + (axis - normal * along) * along;
            Contact { first: bond.first, second: bond.second, displacement: (across * (1e-3 * SPACING)).into() }
        });
        scene.state.contacts = springs.collect();
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
