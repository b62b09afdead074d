//! The bond loop for eight bonds at a time.

use super::{Rows, Scene};
use crate::BondHistory;
use crate::bond::only_bond;
use crate::cpu::bodies::Quad;
use crate::cpu::wide::{Eight, Loop, lanes_period, prefetch, run_portable, run_widest};
use tdem_physics::bond::{
    Advance, Bond, Cement, Coefficients, Damping, Ends, Form, History, Joint, Posture, Reaction, Rest, damping,
    respond_incremental, respond_total, stored_energy,
};
use tdem_physics::contact::{Period, Sphere};
use tdem_physics::motion::orientation::Quaternion;
use tdem_physics::real::WIDTH;
use tdem_physics::{Vec3, vec3};

/// The bond loop for eight bonds on any machine.
pub(super) fn rows_portable(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Vec<u32> {
    run_portable(Eights { scene, rows })
}

/// The bond loop for the widest registers of this machine.
pub(super) fn rows_widest(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Vec<u32> {
    run_widest(Eights { scene, rows })
}

struct Eights<'a, 'b, 'c> {
    scene: &'a Scene<'b>,
    rows: &'a mut Rows<'c>,
}

impl Loop for Eights<'_, '_, '_> {
    type Found = Vec<u32>;
    #[inline(always)]
    fn run<R: Eight>(self) -> Vec<u32> {
        rows_eight::<R>(self.scene, self.rows)
    }
}

/// Bonds ahead whose other particles are asked for.
const AHEAD: usize = 3 * WIDTH;

/// Bonds eight at a time, as they stand; lanes of broken ones are thrown away. Returns those that fail.
#[inline(always)]
fn rows_eight<R: Eight>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Vec<u32> {
    rows.open_books();
    let mut failed = Vec::new();
    let slots = rows.slots();
    let period = scene.period.as_ref().map(lanes_period);
    let only = scene.alike.and_then(only_bond).as_ref().map(splat_bond::<R>);
    let zero = R::lit(0.0);
    for base in slots.clone().step_by(WIDTH) {
        let width = WIDTH.min(slots.end - base);
        let group = Group::new(scene, base, width);
        if group.active == 0 {
            continue;
        }
        ask_ahead(scene, base + AHEAD);
        let ends = load_ends::<R>(scene, period.as_ref(), &group);
        let bonded_offset = R::load_triples(scene.offset, &group.slot);
        let bond = tempered(scene, &group, numbers(scene, only, &group, &ends, bonded_offset));
        let (history, reaction) = respond(scene, rows, &group, &ends, bonded_offset, &bond);
        let fails = if scene.step > 0.0 { group.active & R::bits(reaction.failure.gt(zero)) } else { 0 };
        for l in (0..WIDTH).filter(|l| fails >> l & 1 != 0) {
            failed.push(group.slot[l]);
        }
        let active = group.active & !fails;
        let force = quads(reaction.force);
        let (first, second) = (quads(reaction.first_moment), quads(reaction.second_moment));
        for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
            rows.keep(group.slot[l] as usize, group.i[l] as usize, &force[l], [&first[l], &second[l]]);
        }
        if let Some(history) = history {
            remember(rows, &group, &history, active);
        }
        if !rows.tension.is_empty() {
            let tension = R::quads([reaction.load.normal, zero, zero, zero]);
            for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
                rows.note(group.slot[l] as usize, tension[l][0]);
            }
        }
        if !rows.energy.is_empty() {
            let energy = R::quads([stored_energy(&reaction.load, &bond), zero, zero, zero]);
            for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
                rows.note_energy(group.slot[l] as usize, energy[l][0]);
            }
        }
        if !rows.accounts.is_empty() {
            let loss = damping::loss(&ends, &settled(scene, &group, &ends), &bond, R::lit(scene.step));
            let loss = R::quads([loss, zero, zero, zero]);
            for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
                rows.book(group.slot[l] as usize, group.i[l] as usize, loss[l][0]);
            }
        }
    }
    rows.close_books();
    failed
}

/// Asks for the memory of the others of eight bonds that will be evaluated soon.
#[inline(always)]
fn ask_ahead(scene: &Scene<'_>, from: usize) {
    if let Some(others) = scene.other.get(from..from + WIDTH) {
        for &j in others {
            prefetch(scene.place, j as usize);
            prefetch(scene.orientation, j as usize);
        }
    }
}

/// Eight bonds: their slots, the rows' particles and the others.
struct Group {
    slot: [u32; WIDTH],
    i: [u32; WIDTH],
    j: [u32; WIDTH],
    /// One bit for each that holds.
    active: u8,
}

impl Group {
    /// Bonds that follow each other; fewer than eight are filled up with the first.
    #[inline(always)]
    fn new(scene: &Scene<'_>, base: usize, width: usize) -> Self {
        let mut group = Group { slot: [base as u32; WIDTH], i: [0; WIDTH], j: [0; WIDTH], active: 0 };
        for l in 0..width {
            group.slot[l] = (base + l) as u32;
            group.active |= u8::from(scene.holds[base + l]) << l;
        }
        for l in 0..WIDTH {
            group.i[l] = scene.owner[group.slot[l] as usize];
            group.j[l] = scene.other[group.slot[l] as usize];
        }
        group
    }
}

/// The law, and what is to be remembered.
#[inline(always)]
fn respond<R: Eight>(
    scene: &Scene<'_>,
    rows: &Rows<'_>,
    group: &Group,
    ends: &Ends<R>,
    bonded_offset: Vec3<R>,
    bond: &Bond<R>,
) -> (Option<History<R>>, Reaction<R>) {
    let damping = scene.law.damping;
    match scene.law.form {
        Form::Total => {
            let first_orientation = load_orientations(scene, &group.i);
            let second_orientation = load_orientations(scene, &group.j);
            let free_strain = free_strains(scene, group);
            let posture = Posture { bonded_offset, first_orientation, second_orientation, free_strain };
            (None, respond_total(damping, ends, &posture, bond))
        }
        Form::Incremental(tension) => {
            let earlier = load_histories(rows, group);
            let (zero, length) = (R::lit(0.0), bonded_offset.dot(bonded_offset).sqrt());
            let advance = Advance { earlier, rest: Rest::of(length, zero, zero), step: R::lit(scene.step) };
            let (history, reaction) = respond_incremental(tension, damping, ends, &advance, bond);
            (Some(history), reaction)
        }
    }
}

/// Eight bonds at their temperatures.
#[inline(always)]
fn tempered<R: Eight>(scene: &Scene<'_>, group: &Group, bond: Bond<R>) -> Bond<R> {
    if scene.tempering.is_none() {
        return bond;
    }
    let mut factors = [[1.0; WIDTH]; 2];
    for l in 0..WIDTH {
        if let Some([stiffness, strength]) = scene.factors(group.slot[l] as usize) {
            (factors[0][l], factors[1][l]) = (stiffness, strength);
        }
    }
    bond.tempered(R::from_array(factors[0]), R::from_array(factors[1]))
}

/// Strains that eight bonds take up without force.
#[inline(always)]
fn free_strains<R: Eight>(scene: &Scene<'_>, group: &Group) -> R {
    if scene.heat.is_none() {
        return R::lit(0.0);
    }
    R::from_array(group.slot.map(|slot| scene.free_strain(slot as usize)))
}

/// Eight ends with the radii that their bonds have.
#[inline(always)]
fn bonded<R: Eight>(scene: &Scene<'_>, group: &Group, ends: &Ends<R>) -> Ends<R> {
    let mut bonded = *ends;
    if scene.heat.is_some() {
        for (sphere, index) in [(&mut bonded.first, &group.i), (&mut bonded.second, &group.j)] {
            sphere.radius = R::from_array(index.map(|k| scene.bonded_sphere(k as usize).radius));
        }
    }
    bonded
}

// Loads and stores are functions that are always inlined, not closures: a closure that stays a function is compiled
// without the instruction set of its caller, and every instruction in it becomes a call.

/// The particles of eight bonds; without their motion where the law does not look at it.
#[inline(always)]
fn load_ends<R: Eight>(scene: &Scene<'_>, period: Option<&Period<R>>, group: &Group) -> Ends<R> {
    let [xa, ya, za, ra] = R::load(scene.place, &group.i);
    let [xb, yb, zb, rb] = R::load(scene.place, &group.j);
    let mut offset = vec3(xb, yb, zb) - vec3(xa, ya, za);
    if let Some(period) = period {
        offset = period.nearest(offset);
    }
    let (first, second) = (load_spheres(scene, &group.i, ra), load_spheres(scene, &group.j, rb));
    Ends { first, second, offset, lead: R::lit(scene.lead) }
}

/// Eight spheres without their positions.
#[inline(always)]
fn load_spheres<R: Eight>(scene: &Scene<'_>, index: &[u32; WIDTH], radius: R) -> Sphere<R> {
    let zero = R::lit(0.0);
    let mut sphere =
        Sphere { position: Vec3::zero(), radius, velocity: Vec3::zero(), mass: zero, angular_velocity: Vec3::zero() };
    if scene.law.form == Form::Total && scene.law.damping == Damping::Off {
        return sphere;
    }
    let [x, y, z, mass] = R::load(scene.motion, index);
    (sphere.velocity, sphere.mass) = (vec3(x, y, z), mass);
    sphere.angular_velocity = load_vectors(scene.spin, index);
    sphere
}

/// The same particles with the velocities of the end of the step, as well as they are known.
#[inline(always)]
fn settled<R: Eight>(scene: &Scene<'_>, group: &Group, ends: &Ends<R>) -> Ends<R> {
    if scene.kick.is_empty() {
        return *ends;
    }
    let mut settled = Ends { lead: R::lit(0.0), ..*ends };
    for (sphere, index) in [(&mut settled.first, &group.i), (&mut settled.second, &group.j)] {
        sphere.velocity = sphere.velocity + load_vectors(scene.kick, index);
        sphere.angular_velocity = sphere.angular_velocity + load_vectors(scene.twist, index);
    }
    settled
}

#[inline(always)]
fn load_vectors<R: Eight>(field: &[Quad], index: &[u32; WIDTH]) -> Vec3<R> {
    let [x, y, z, _] = R::load(field, index);
    vec3(x, y, z)
}

#[inline(always)]
fn load_orientations<R: Eight>(scene: &Scene<'_>, index: &[u32; WIDTH]) -> Quaternion<R> {
    let [x, y, z, scalar] = R::load(scene.orientation, index);
    Quaternion { vector: vec3(x, y, z), scalar }
}

#[inline(always)]
fn load_histories<R: Eight>(rows: &Rows<'_>, group: &Group) -> History<R> {
    let mut numbers = [[0.0; WIDTH]; 10];
    for l in 0..WIDTH {
        let BondHistory { normal: n, tension, shear: s, couple: c } = rows.history[group.slot[l] as usize - rows.base];
        let of_bond = [n[0], n[1], n[2], tension, s[0], s[1], s[2], c[0], c[1], c[2]];
        for k in 0..10 {
            numbers[k][l] = of_bond[k];
        }
    }
    let vector = [vec3_from(&numbers, 0), vec3_from(&numbers, 4), vec3_from(&numbers, 7)];
    History { normal: vector[0], tension: R::from_array(numbers[3]), shear: vector[1], couple: vector[2] }
}

#[inline(always)]
fn vec3_from<R: Eight>(numbers: &[[f64; WIDTH]; 10], at: usize) -> Vec3<R> {
    vec3(R::from_array(numbers[at]), R::from_array(numbers[at + 1]), R::from_array(numbers[at + 2]))
}

/// Keeps what the bonds of a group remember, in lanes whose bit is set.
#[inline(always)]
fn remember<R: Eight>(rows: &mut Rows<'_>, group: &Group, history: &History<R>, active: u8) {
    let History { normal, tension, shear, couple } = history;
    let normal = R::quads([normal.x, normal.y, normal.z, *tension]);
    let (shear, couple) = (quads(*shear), quads(*couple));
    for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
        let ([x, y, z, tension], [sx, sy, sz, _], [cx, cy, cz, _]) = (normal[l], shear[l], couple[l]);
        let history = BondHistory { normal: [x, y, z], tension, shear: [sx, sy, sz], couple: [cx, cy, cz] };
        rows.remember(group.slot[l] as usize, history);
    }
}

/// Eight vectors, a zero behind each.
#[inline(always)]
fn quads<R: Eight>(v: Vec3<R>) -> [[f64; 4]; WIDTH] {
    R::quads([v.x, v.y, v.z, R::lit(0.0)])
}

/// The numbers of eight bonds.
#[inline(always)]
fn numbers<R: Eight>(
    scene: &Scene<'_>,
    only: Option<Bond<R>>,
    group: &Group,
    ends: &Ends<R>,
    bonded_offset: Vec3<R>,
) -> Bond<R> {
    let mut strength = [0.0; WIDTH];
    for l in 0..WIDTH {
        strength[l] = scene.strength[group.slot[l] as usize];
    }
    let strength = R::from_array(strength);
    if let Some(bond) = only {
        return bond.with_strength_times(strength);
    }
    if let Some(table) = scene.alike {
        return gather_bonds(scene, table, group).with_strength_times(strength);
    }
    let length = bonded_offset.dot(bonded_offset).sqrt();
    let ends = bonded(scene, group, ends);
    gather_joints(scene, group).bond_of_spheres(scene.law.damping, &ends.first, &ends.second, length, strength)
}

#[inline(always)]
fn splat_bond<R: Eight>(one: &Bond<f64>) -> Bond<R> {
    Bond {
        stiffness: splat_coefficients(&one.stiffness),
        damping: splat_coefficients(&one.damping),
        stress_per_force: R::lit(one.stress_per_force),
        stress_per_torsion: R::lit(one.stress_per_torsion),
        stress_per_bending: R::lit(one.stress_per_bending),
        tensile_strength: R::lit(one.tensile_strength),
        shear_strength: R::lit(one.shear_strength),
        internal_friction: R::lit(one.internal_friction),
    }
}

#[inline(always)]
fn splat_coefficients<R: Eight>(one: &Coefficients<f64>) -> Coefficients<R> {
    Coefficients {
        normal: R::lit(one.normal),
        shear: R::lit(one.shear),
        torsion: R::lit(one.torsion),
        bending: R::lit(one.bending),
    }
}

/// The numbers of eight bonds of a table.
#[inline(always)]
fn gather_bonds<R: Eight>(scene: &Scene<'_>, table: &[Bond<f64>], group: &Group) -> Bond<R> {
    let mut parts = [[0.0; WIDTH]; 14];
    for l in 0..WIDTH {
        let bond = &table[scene.materials_of(group.i[l] as usize, group.j[l] as usize)];
        let [spring, dashpot] = [&bond.stiffness, &bond.damping].map(|c| [c.normal, c.shear, c.torsion, c.bending]);
        let stresses = [bond.stress_per_force, bond.stress_per_torsion, bond.stress_per_bending];
        let limits = [bond.tensile_strength, bond.shear_strength, bond.internal_friction];
        for k in 0..4 {
            parts[k][l] = spring[k];
            parts[4 + k][l] = dashpot[k];
        }
        for k in 0..3 {
            parts[8 + k][l] = stresses[k];
            parts[11 + k][l] = limits[k];
        }
    }
    Bond {
        stiffness: coefficients_from(&parts, 0),
        damping: coefficients_from(&parts, 4),
        stress_per_force: R::from_array(parts[8]),
        stress_per_torsion: R::from_array(parts[9]),
        stress_per_bending: R::from_array(parts[10]),
        tensile_strength: R::from_array(parts[11]),
        shear_strength: R::from_array(parts[12]),
        internal_friction: R::from_array(parts[13]),
    }
}

#[inline(always)]
fn coefficients_from<R: Eight>(parts: &[[f64; WIDTH]; 14], at: usize) -> Coefficients<R> {
    Coefficients {
        normal: R::from_array(parts[at]),
        shear: R::from_array(parts[at + 1]),
        torsion: R::from_array(parts[at + 2]),
        bending: R::from_array(parts[at + 3]),
    }
}

/// What eight bonds are made of.
#[inline(always)]
fn gather_joints<R: Eight>(scene: &Scene<'_>, group: &Group) -> Joint<R> {
    let mut parts = [[0.0; WIDTH]; 9];
    for l in 0..WIDTH {
        let Joint { cement, stiffness_per_area, young_modulus } = scene.joint(group.i[l] as usize, group.j[l] as usize);
        parts[0][l] = cement.stiffness_ratio;
        parts[1][l] = cement.radius_multiplier;
        parts[2][l] = cement.tensile_strength;
        parts[3][l] = cement.shear_strength;
        parts[4][l] = cement.internal_friction;
        parts[5][l] = cement.moment_contribution;
        parts[6][l] = cement.damping_ratio;
        parts[7][l] = *stiffness_per_area;
        parts[8][l] = *young_modulus;
    }
    Joint {
        cement: Cement {
            stiffness_ratio: R::from_array(parts[0]),
            radius_multiplier: R::from_array(parts[1]),
            tensile_strength: R::from_array(parts[2]),
            shear_strength: R::from_array(parts[3]),
            internal_friction: R::from_array(parts[4]),
            moment_contribution: R::from_array(parts[5]),
            damping_ratio: R::from_array(parts[6]),
        },
        stiffness_per_area: R::from_array(parts[7]),
        young_modulus: R::from_array(parts[8]),
    }
}
