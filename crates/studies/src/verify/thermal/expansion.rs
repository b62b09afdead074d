//! What heat does to lengths, and the stress where lengths cannot follow.

use super::{CLOSED, Material, ROOM, SOLID, held_at};
use crate::statics::Boundary;
use crate::verify::Kind;
use crate::verify::block::{CELL, LATTICE, lattice, neighbours, star_scene};
use crate::verify::bonded::{JOINT, LATTICE_CONSTANT, RADIUS, ROCK, SPACING, numbers, scene};
use crate::verify::scene::{Bench, HELD, Scene};
use crate::verify::statics::rest;
use tdem_engine::physics::Vec3;
use tdem_engine::physics::bond::face_centred::{CubicElasticity, open_sides};
use tdem_engine::physics::bond::{Cement, Form, Joint};
use tdem_engine::{Bond, Constraint, Course, Fault, State};

/// How much warmer than the room things become, K.
const WARMTH: f64 = 100.0;
/// $\alpha\Delta T$: so small that what is of second order does not count.
const STRAIN: f64 = 1e-7;
const GROWING: Material = Material { expansion: STRAIN / WARMTH, ..SOLID };

/// Along x and y.
const SIDEWAYS: [bool; 3] = [true, true, false];

const HALF: f64 = 0.5 * LATTICE_CONSTANT;

impl Scene {
    /// Makes all particles warmer at once, and as large as they are then.
    fn warm(&mut self, warmth: f64) {
        (0..self.state.len()).for_each(|k| self.warm_one(k, warmth));
    }

    /// Makes one particle warmer.
    fn warm_one(&mut self, k: usize, warmth: f64) {
        let material = self.state.material[k];
        let expansion = self.plan.heat.as_ref().map_or(0.0, |heat| heat.expansion(material));
        self.state.temperature[k] += warmth;
        self.state.radius[k] = self.state.reference_radius[k] * (1.0 + expansion * warmth);
    }

    /// Holds particles by a constraint of their own.
    fn hold_by(&mut self, particles: impl IntoIterator<Item = usize>, constraint: Constraint) {
        let number = self.plan.constraints.len() as u16;
        self.plan.constraints.push(constraint);
        particles.into_iter().for_each(|k| self.state.constraint[k] = number);
    }

    /// Joints of the first material, of both, and of the second: stiffnesses over that of a joint.
    fn join(&mut self, joint: Joint<f64>, [first, mixed, second]: [f64; 3]) {
        let of = |part: f64| Some(Joint { stiffness_per_area: part * joint.stiffness_per_area, ..joint });
        if let Some(bonds) = &mut self.plan.bonds {
            bonds.joints = vec![of(first), of(mixed), of(mixed), of(second)];
        }
    }
}

/// Normal forces of all bonds, N, tension positive, and the largest force that any exerts.
fn bond_forces(scene: &Scene, state: &State) -> (Vec<f64>, f64) {
    let reactions =
        (0..state.bonds.len()).filter_map(|k| state.evaluate_bond(&scene.plan, k)).map(|bond| bond.reaction);
    let (normal, size): (Vec<f64>, Vec<f64>) =
        reactions.map(|reaction| (reaction.load.normal, reaction.force.dot(reaction.force).sqrt())).unzip();
    (normal, size.into_iter().fold(0.0, f64::max))
}

pub(super) fn free(bench: &mut Bench) -> Result<(), Fault> {
    // As much as concrete grows over 100 K: beside less, the rounding of places would show.
    let (cells, heating, steps, strain) = ([2, 2, 3], 300.0, 1500, 1e-3);
    let growing = Material { expansion: strain / WARMTH, ..SOLID };
    let mut scene = scene(Form::Total, LATTICE, 0.3);
    scene.damp_locally(0.7);
    let sites = scene.block(cells);
    scene.heat(&[growing], 0.0, CLOSED);
    scene.heat_step(1.0);
    let all: Vec<usize> = (0..sites.len()).collect();
    scene.expose(&all, &held_at(Course(vec![[0.0, ROOM], [heating, ROOM + WARMTH]])));
    let state = bench.after(&scene, steps)?;
    for (d, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let last = 2 * cells[d] - 1;
        let middle = |layer: usize| {
            let of_layer = all.iter().filter(|&&k| sites[k][d] == layer);
            let (sum, count) = of_layer.fold((Vec3::from([0.0; 3]), 0.0), |(sum, count), &k| {
                (sum + Vec3::from(state.position[k]), count + 1.0)
            });
            sum * (1.0 / count)
        };
        // A free block may turn.
        let between = middle(last) - middle(0);
        let elongation = between.dot(between).sqrt() / (last as f64 * HALF) - 1.0;
        let what = format!("elongation along {axis} over alpha dT L");
        bench.judge(what, "1", elongation / strain, Kind::ClosedForm.within(1.0, 1e-9));
    }
    let blocked = numbers(&LATTICE).stiffness.normal * SPACING * strain;
    let of_blocked = bond_forces(&scene, &state).1 / blocked;
    let what = "largest force of a bond over K_n L_0 alpha dT";
    bench.judge(what, "1", of_blocked, Kind::ClosedForm.at_most(1e-9));
    Ok(())
}

pub(super) fn constrained(bench: &mut Bench) -> Result<(), Fault> {
    let n = 3;
    let mut scene = scene(Form::Total, LATTICE, 0.3);
    let sites = scene.block([n; 3]);
    let last = 2 * n - 1;
    let on_face = |site: [usize; 3], d: usize| site[d] == 0 || site[d] == last;
    // One constraint for each choice of faces that a particle may lie on.
    for faces in 1..8_usize {
        let velocity = std::array::from_fn(|d| (faces >> d & 1 == 1).then_some(0.0));
        let there = |k: &usize| (0..3).all(|d| on_face(sites[*k], d) == (faces >> d & 1 == 1));
        scene.hold_by((0..sites.len()).filter(there), Constraint { velocity, ..Constraint::FREE });
    }
    scene.heat(&[GROWING], 0.0, CLOSED);
    scene.heat_step(1.0);
    scene.expose(&(0..sites.len()).collect::<Vec<_>>(), &held_at(Course(vec![[0.0, ROOM], [50.0, ROOM + WARMTH]])));
    let state = bench.after(&scene, 100)?;
    let side = n as f64 * LATTICE_CONSTANT;
    let stiffness = numbers(&LATTICE).stiffness.normal;
    let expected = -4.0 * stiffness * STRAIN / LATTICE_CONSTANT * (1.0 - 0.5 / n as f64);
    for (d, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let push: f64 = (0..sites.len()).filter(|&k| sites[k][d] == last).map(|k| state.force[k][d]).sum();
        let what = format!("stress along {axis}");
        bench.judge(what, "Pa", -push / (side * side), Kind::ClosedForm.relative(expected, 1e-6));
    }
    let (normal, _) = bond_forces(&scene, &state);
    let blocked = -stiffness * SPACING * STRAIN;
    let off = normal.iter().map(|force| (force / blocked - 1.0).abs()).fold(0.0, f64::max);
    bench.judge("forces of bonds: largest error", "1", off, Kind::ClosedForm.at_most(1e-6));
    Ok(())
}

pub(super) fn uniaxial(bench: &mut Bench, cells: [usize; 3], steps: u64, expected: [f64; 2]) -> Result<(), Fault> {
    let [reference, closeness] = expected;
    let elasticity = lattice();
    let (young, aside) = (elasticity.young_modulus(), (1.0 + elasticity.poisson_ratio()) * STRAIN);
    // A sphere whose neighbours have gone to the sides as far as they like.
    let mut star = star_scene([[aside, 0.0, 0.0], [0.0, aside, 0.0], [0.0; 3]]);
    star.heat(&[GROWING], 0.0, CLOSED);
    star.warm(WARMTH);
    let state = bench.after(&star, 0)?;
    let virial = |d: usize| {
        let offsets = neighbours().into_iter().enumerate();
        -2.0 / CELL * offsets.map(|(k, offset)| state.force[k + 1][d] * offset[d]).sum::<f64>()
    };
    let of_lattice = virial(2) / (young * STRAIN);
    bench.judge("lattice: stress over E_100 alpha dT", "1", of_lattice, Kind::ClosedForm.within(-1.0, 1e-6));
    let across = virial(0) / (young * STRAIN);
    bench.judge("lattice: stress to the sides over E_100 alpha dT", "1", across, Kind::ClosedForm.within(0.0, 1e-6));

    let mut scene = scene(Form::Total, LATTICE, 0.3);
    scene.damp_locally(0.7);
    let sites = scene.block(cells);
    let top = 2 * cells[2] - 1;
    let ends = (0..sites.len()).filter(|&k| sites[k][2] == 0 || sites[k][2] == top);
    scene.hold_by(ends, Constraint { velocity: [None, None, Some(0.0)], ..Constraint::FREE });
    scene.heat(&[GROWING], 0.0, CLOSED);
    scene.warm(WARMTH);
    // Near the solution: grown to the sides as in the lattice, about the middle, so that nothing moves as a whole.
    for (k, site) in sites.iter().enumerate() {
        for d in 0..2 {
            let middle = 0.5 * (2 * cells[d] - 1) as f64;
            scene.state.position[k][d] += aside * (site[d] as f64 - middle) * HALF;
        }
    }
    let state = bench.after(&scene, steps)?;
    let push: f64 = (0..sites.len()).filter(|&k| sites[k][2] == top).map(|k| state.force[k][2]).sum();
    let section = (cells[0] * cells[1]) as f64 * LATTICE_CONSTANT * LATTICE_CONSTANT;
    let of_block = -push / section / (young * STRAIN);
    bench.judge("block: stress over E_100 alpha dT", "1", of_block, Kind::Reference.within(-reference, 5e-6));
    let open = open_sides([cells[0] as u32, cells[1] as u32]);
    let what = "block: the same, over the part of the bonds that there are";
    bench.judge(what, "1", of_block / open, Kind::ClosedForm.within(-1.0, closeness));
    Ok(())
}

/// Bonds as stiff across as along: then nothing contracts across what is pulled, and $E = C_{11}$.
const STRAIGHT: Joint<f64> = Joint { cement: Cement { stiffness_ratio: 1.0, ..LATTICE.cement }, ..LATTICE };

/// A second material that grows more.
const FACTOR: f64 = 1.8;
const GROWING_MORE: Material = Material { expansion: FACTOR * GROWING.expansion, ..GROWING };

fn straight_modulus() -> f64 {
    let stiffness = numbers(&STRAIGHT).stiffness;
    CubicElasticity::of_bonds(stiffness.normal, stiffness.shear, LATTICE_CONSTANT).young_modulus()
}

pub(super) fn series(bench: &mut Bench) -> Result<(), Fault> {
    let (cells, stiffer) = ([2, 2, 4], 3.0);
    let mut scene = scene(Form::Total, STRAIGHT, 0.1);
    scene.damp_locally(0.7);
    scene.repeat(cells, SIDEWAYS);
    // Springs one behind the other where the halves meet.
    scene.join(STRAIGHT, [1.0, 2.0 * stiffer / (1.0 + stiffer), stiffer]);
    let sites = scene.block(cells);
    let top = 2 * cells[2] - 1;
    for (k, site) in sites.iter().enumerate() {
        scene.state.material[k] = u16::from(site[2] > top / 2);
    }
    let of_layer = |layer: usize| (0..sites.len()).filter(|&k| sites[k][2] == layer).collect::<Vec<_>>();
    scene.hold_by(
        of_layer(0).into_iter().chain(of_layer(top)),
        Constraint { velocity: [None, None, Some(0.0)], ..HELD },
    );
    scene.heat(&[GROWING, GROWING_MORE], 0.0, CLOSED);
    scene.warm(WARMTH);
    let state = bench.after(&scene, 1200)?;
    let area = (cells[0] * cells[1]) as f64 * LATTICE_CONSTANT * LATTICE_CONSTANT;
    let young = straight_modulus();
    let expected = -(1.0 + FACTOR) * STRAIN / (1.0 / young + 1.0 / (stiffer * young));
    for (what, layer, sign) in [("lower", 0, 1.0), ("upper", top, -1.0)] {
        let stress = sign * of_layer(layer).into_iter().map(|k| state.force[k][2]).sum::<f64>() / area;
        let what = format!("stress at the {what} wall");
        bench.judge(what, "Pa", stress, Kind::ClosedForm.relative(expected, 1e-6));
    }
    Ok(())
}

pub(super) fn parallel(bench: &mut Bench) -> Result<(), Fault> {
    bars(bench)?;
    layers(bench)
}

/// Two chains of unlike stiffness between plates that have gone as far as the chains pull them.
fn bars(bench: &mut Bench) -> Result<(), Fault> {
    let (links, stiffer) = (5, 3.0);
    let mut scene = scene(Form::Total, JOINT, 0.2);
    scene.damp_locally(0.7);
    scene.join(JOINT, [1.0, 1.0, stiffer]);
    scene.two_chains(links);
    scene.heat(&[GROWING, GROWING_MORE], 0.0, CLOSED);
    scene.warm(WARMTH);
    let common = (1.0 + stiffer * FACTOR) / (1.0 + stiffer) * STRAIN;
    for place in &mut scene.state.position {
        place[0] *= 1.0 + common;
    }
    let ends = [0, links, links + 1, 2 * links + 1];
    scene.hold_by(ends, HELD);
    let state = bench.after(&scene, 600)?;
    // E A = K_n L of a chain.
    let rigidity = numbers(&JOINT).stiffness.normal * SPACING;
    let expected = (1.0 - FACTOR) * STRAIN / (1.0 / rigidity + 1.0 / (stiffer * rigidity));
    let [first, second] = [links, 2 * links + 1].map(|k| -state.force[k][0]);
    bench.judge("bars: force in the first, that grows less", "N", first, Kind::ClosedForm.relative(-expected, 1e-6));
    bench.judge("bars: force in the second", "N", second, Kind::ClosedForm.relative(expected, 1e-6));
    Ok(())
}

impl Scene {
    /// Two chains side by side along x, the second of the second material.
    fn two_chains(&mut self, links: usize) {
        self.chain(links);
        let (mut bonds, first) = (self.state.bonds.clone(), self.state.len() as u32);
        for k in 0..=links {
            let index = self.sphere(RADIUS, ROCK.density, [SPACING * k as f64, 3.0 * SPACING, 0.0]);
            self.state.material[index] = 1;
        }
        bonds.extend((first..first + links as u32).map(|k| Bond::new(k, k + 1, 1.0)));
        self.state.make_bonds(bonds);
    }
}

/// Bonded layers of unequal thickness and equal stiffness, repeating sideways.
fn layers(bench: &mut Bench) -> Result<(), Fault> {
    let (cells, thin) = ([6, 2, 3], 4);
    let mut scene = scene(Form::Total, STRAIGHT, 0.2);
    scene.damp_locally(0.7);
    scene.repeat(cells, SIDEWAYS);
    let sites = scene.block(cells);
    let top = 2 * cells[2] - 1;
    for (k, site) in sites.iter().enumerate() {
        scene.state.material[k] = u16::from(site[0] < thin);
    }
    scene.heat(&[GROWING, GROWING_MORE], 0.0, CLOSED);
    scene.warm(WARMTH);
    let thick = 2 * cells[0] - thin;
    let common = (thick as f64 + thin as f64 * FACTOR) / (thick + thin) as f64 * STRAIN;
    for place in &mut scene.state.position {
        place[2] *= 1.0 + common;
    }
    let of_top =
        |plane: usize| (0..sites.len()).filter(|&k| sites[k][2] == top && sites[k][0] == plane).collect::<Vec<_>>();
    let ends = (0..sites.len()).filter(|&k| sites[k][2] == 0 || sites[k][2] == top);
    scene.hold_by(ends, Constraint { velocity: [None, None, Some(0.0)], ..HELD });
    let state = bench.after(&scene, 800)?;
    // Planes are half a cell thick; the force is for one cell across.
    let area = |planes: usize| planes as f64 * HALF * LATTICE_CONSTANT;
    let young = straight_modulus();
    let force = (1.0 - FACTOR) * STRAIN / (1.0 / (young * area(thick)) + 1.0 / (young * area(thin)));
    for (what, plane, planes, sign) in [("thin", thin / 2, thin, 1.0), ("thick", thin + thick / 2, thick, -1.0)] {
        let own = of_top(plane);
        let pull = own.iter().map(|&k| -state.force[k][2]).sum::<f64>() / own.len() as f64;
        let stress = pull / (0.5 * LATTICE_CONSTANT * LATTICE_CONSTANT);
        let expected = sign * force / area(planes);
        bench.judge(
            format!("layers: stress within the {what} one"),
            "Pa",
            stress,
            Kind::ClosedForm.relative(expected, 1e-6),
        );
    }
    let all: f64 = (0..sites.len()).filter(|&k| sites[k][2] == top).map(|k| state.force[k][2]).sum();
    let of_one = all / (force.abs() * cells[1] as f64);
    bench.judge("layers: force on the plate, of that of one layer", "1", of_one, Kind::ClosedForm.within(0.0, 1e-6));
    Ok(())
}

/// A plate that is warmest in its middle, so that nothing bends; parabolic.
struct Plate {
    scene: Scene,
    /// The same before anything became warm.
    cold: Scene,
    sites: Vec<[usize; 3]>,
    cells: [usize; 3],
    /// Layer of each particle.
    layer: Vec<usize>,
}

impl Plate {
    fn of(cells: [usize; 3], sides_repeat: bool) -> Self {
        let mut scene = scene(Form::Total, LATTICE, 0.3);
        if sides_repeat {
            scene.repeat(cells, SIDEWAYS);
        }
        let sites = scene.block(cells);
        let layer = sites.iter().map(|site| site[2]).collect();
        let mut plate = Plate { cold: scene.clone(), scene, sites, cells, layer };
        plate.scene.heat(&[GROWING], 0.0, CLOSED);
        for k in 0..plate.sites.len() {
            let warmth = plate.warmth(plate.layer[k]);
            plate.scene.warm_one(k, warmth);
        }
        plate
    }
    fn layers(&self) -> usize {
        2 * self.cells[2]
    }
    fn warmth(&self, layer: usize) -> f64 {
        let height = (2.0 * layer as f64 + 1.0) / self.layers() as f64 - 1.0;
        WARMTH * (1.0 - height * height)
    }
    /// The warmth that the bonds of a layer within feel: two thirds of their stiffness along the plate lie within the
    /// layer, a sixth each between it and the next ones, at the mean of both temperatures.
    fn felt(&self, layer: usize) -> f64 {
        5.0 * self.warmth(layer) / 6.0 + (self.warmth(layer - 1) + self.warmth(layer + 1)) / 12.0
    }
    /// Stresses along x of the layers, Pa, within a part of the section: by the virial, half of a bond to each end.
    fn stresses(&self, state: &State, inside: impl Fn([usize; 3]) -> bool) -> Vec<f64> {
        let mut sums = vec![0.0; self.layers()];
        for (k, bond) in state.bonds.iter().enumerate() {
            let Some(evaluated) = state.evaluate_bond(&self.scene.plan, k) else { continue };
            let half = 0.5 * evaluated.reaction.force.x * evaluated.ends.offset.x;
            for end in [bond.first, bond.second].map(|id| id as usize) {
                if inside(self.sites[end]) {
                    sums[self.layer[end]] += half;
                }
            }
        }
        let mut volumes = vec![0.0; self.layers()];
        for (site, &layer) in self.sites.iter().zip(&self.layer).filter(|(site, _)| inside(**site)) {
            debug_assert_eq!(site[2], layer);
            volumes[layer] += CELL / 4.0;
        }
        sums.iter().zip(volumes).map(|(sum, volume)| sum / volume).collect()
    }
}

/// $M = C_{11} + C_{12} - 2C_{12}^2/C_{11}$: stress over strain of a plate that is stretched in both its directions.
fn plate_modulus() -> f64 {
    let CubicElasticity { c11, c12, .. } = lattice();
    c11 + c12 - 2.0 * c12 * c12 / c11
}

/// A plate that cannot grow sideways: its mean temperature does not count.
pub(super) fn restrained_plate(bench: &mut Bench) -> Result<(), Fault> {
    let mut plate = Plate::of([2, 2, 8], true);
    plate.scene.damp_locally(0.7);
    let state = bench.after(&plate.scene, 1500)?;
    let found = plate.stresses(&state, |_| true);
    let unit = plate_modulus() * GROWING.expansion;
    let (mut off, mut off_solid) = (0.0_f64, 0.0_f64);
    for k in 1..plate.layers() - 1 {
        let expected = -unit * plate.felt(k);
        off = off.max((found[k] / expected - 1.0).abs());
        off_solid = off_solid.max((found[k] / (-unit * plate.warmth(k)) - 1.0).abs());
    }
    bench.judge("stresses of the solid: largest error within", "1", off_solid, Kind::ClosedForm.at_most(0.02));
    bench.judge("stresses of the lattice: largest error within", "1", off, Kind::ClosedForm.at_most(1e-5));
    Ok(())
}

/// A free plate, at rest by a static solution under the forces that the engine finds in the warm plate before it moves.
pub(super) fn free_plate(bench: &mut Bench, cells: [usize; 3]) -> Result<(), Fault> {
    let mut plate = Plate::of(cells, false);
    let blocked = bench.after(&plate.scene, 0)?;
    let mut boundary = Boundary::free(plate.sites.len());
    boundary.held[0] = [Some(0.0); 6];
    for (load, force) in boundary.loads.iter_mut().zip(&blocked.force) {
        load[..3].copy_from_slice(force);
    }
    let solution = rest(&plate.cold, &boundary)?;
    plate.scene.state = solution.applied_to(&plate.scene.state);
    let state = bench.after(&plate.scene, 0)?;
    let largest = |state: &State| state.force.iter().flatten().fold(0.0_f64, |largest, f| largest.max(f.abs()));
    let unbalanced = largest(&state) / largest(&blocked);
    bench.judge("unbalanced force in the engine, of the load", "1", unbalanced, Kind::Reference.at_most(1e-6));
    // The middle of the plate, two cells across.
    let found = plate.stresses(&state, |site| (0..2).all(|d| (cells[d] - 2..cells[d] + 2).contains(&site[d])));
    // A layer at the surface has five sixths of the bonds.
    let (layers, mut weights) = (plate.layers(), vec![1.0; plate.layers()]);
    (weights[0], weights[layers - 1]) = (5.0 / 6.0, 5.0 / 6.0);
    let weighted = weights.iter().enumerate().map(|(k, weight)| weight * plate.warmth(k)).sum::<f64>();
    let mean = weighted / weights.iter().sum::<f64>();
    let (mut off, mut off_solid) = (0.0_f64, 0.0_f64);
    for k in 1..layers - 1 {
        let strain = found[k] / plate_modulus() / GROWING.expansion;
        off_solid = off_solid.max((strain - (mean - plate.warmth(k))).abs() / WARMTH);
        off = off.max((strain - (mean - plate.felt(k))).abs() / WARMTH);
    }
    let what = "stresses of the solid: largest difference within, of that of the warmest";
    bench.judge(what, "1", off_solid, Kind::ClosedForm.at_most(0.02));
    let what = "stresses of the lattice: largest difference within, of that of the warmest";
    bench.judge(what, "1", off, Kind::ClosedForm.at_most(0.005));
    Ok(())
}
