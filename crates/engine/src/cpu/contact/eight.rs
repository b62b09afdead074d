//! The contact loop for eight pairs at a time.

use super::heat::WarmEights;
use super::{Crushed, Rows, Scene, Variant, worse};
use crate::cpu::wide::{Eight, Loop, lanes_period, prefetch, run_portable, run_widest};
use std::marker::PhantomData;
use tdem_physics::contact::encounter::lever_arm;
use tdem_physics::contact::{
    Encounter, Interaction, Kick, Law, Losses, Period, Response, Sphere, Touch, elastic_force, respond, touch_spheres,
};
use tdem_physics::real::WIDTH;
use tdem_physics::{Vec3, vec3};

/// The contact loop for eight pairs on any machine.
pub(super) fn rows_portable<V: Variant>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
    run_portable(Pairs { scene, rows, variant: PhantomData::<V> })
}

/// The contact loop for the widest registers of this machine.
pub(super) fn rows_widest<V: Variant>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
    run_widest(Pairs { scene, rows, variant: PhantomData::<V> })
}

struct Pairs<'a, 'b, 'c, V> {
    scene: &'a Scene<'b>,
    rows: &'a mut Rows<'c>,
    variant: PhantomData<V>,
}

impl<V: Variant> Loop for Pairs<'_, '_, '_, V> {
    type Found = Crushed;
    #[inline(always)]
    fn run<R: Eight>(self) -> Crushed {
        rows_eight::<V, R>(self.scene, self.rows)
    }
}

/// Pairs eight at a time.
///
/// Where most listed pairs touch, groups of eight neighbours in the list are evaluated as they come, and lanes that do
/// not touch are thrown away. Elsewhere the pairs that touch are collected first.
#[inline(always)]
fn rows_eight<V: Variant, R: Eight>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
    let pairs = rows.other.len();
    rows.open_books::<V>();
    if pairs == 0 {
        return None;
    }
    let mut owner = vec![0_u32; pairs];
    for k in 0..rows.start.len() - 1 {
        owner[rows.row(k)].fill((rows.first + k) as u32);
    }
    let law = Eights::<R>::new::<V>(scene);
    let touched = rows.touching.iter().map(|&t| usize::from(t)).sum::<usize>();
    let dense = 4 * touched > 3 * pairs;
    let mut compact = vec![0_u32; if dense { 0 } else { pairs + WIDTH }];
    let mut count = 0;
    let mut crushed: Crushed = None;
    for base in (0..pairs).step_by(WIDTH) {
        let width = WIDTH.min(pairs - base);
        let free = free_of_bonds(rows.bonded, base, width);
        if free == 0 {
            continue;
        }
        let group = Group::in_a_row(base, width, &owner, rows.other);
        ask_ahead::<V>(scene, rows.other, base + AHEAD);
        let (touch, radii) = law.touch(scene, &group);
        let touches = free & R::bits(touch.overlap.gt(R::lit(0.0)));
        let crushes = free & R::bits(touch.overlap.gt(law.overlap_limit * radii[0].min(radii[1])));
        if crushes != 0 {
            for l in (0..width).filter(|l| crushes >> l & 1 != 0) {
                let (i, j) = (group.i[l] as usize, group.j[l] as usize);
                if !scene.both_held(i, j) {
                    crushed = Some(worse(crushed, scene.ranks(i, j)));
                }
            }
        }
        let settled = touches == u8::MAX && rows.touching[base..base + width] == [true; WIDTH];
        if !settled {
            for l in 0..width {
                let (now, before) = (touches >> l & 1 != 0, rows.touching[base + l]);
                if before && !now {
                    rows.part::<V>(scene, group.i[l] as usize, group.j[l] as usize, base + l);
                }
                rows.touching[base + l] = now;
            }
        }
        if dense {
            law.evaluate::<V>(scene, rows, &group, &touch, radii, touches & (u8::MAX >> (WIDTH - width)));
        } else {
            for l in 0..width {
                compact[count] = (base + l) as u32;
                count += usize::from(touches >> l & 1);
            }
        }
    }
    for chosen in compact[..count].chunks(WIDTH) {
        // A last, short group is filled up with its first pair.
        let mut slot = [chosen[0]; WIDTH];
        slot[..chosen.len()].copy_from_slice(chosen);
        let group = Group::new(slot, &owner, rows.other);
        let (touch, radii) = law.touch(scene, &group);
        law.evaluate::<V>(scene, rows, &group, &touch, radii, u8::MAX >> (WIDTH - chosen.len()));
    }
    rows.close_books::<V>();
    crushed
}

/// One bit for each of eight pairs between which contact may act.
#[inline(always)]
fn free_of_bonds(bonded: &[bool], base: usize, width: usize) -> u8 {
    let mut free = u8::MAX;
    if let Some(bonded) = bonded.get(base..base + width) {
        for l in 0..width {
            free &= !(u8::from(bonded[l]) << l);
        }
        free &= u8::MAX >> (WIDTH - width);
    }
    free
}

/// Pairs ahead whose other particles are asked for.
const AHEAD: usize = 3 * WIDTH;

/// Asks for the memory of the others of eight pairs that will be evaluated soon.
#[inline(always)]
fn ask_ahead<V: Variant>(scene: &Scene<'_>, other: &[u32], from: usize) {
    if let Some(others) = other.get(from..from + WIDTH) {
        for &j in others {
            prefetch(scene.place, j as usize);
            prefetch(scene.motion, j as usize);
            if V::MOMENTS {
                prefetch(scene.spin, j as usize);
            }
        }
    }
}

/// Eight pairs: their slots, the rows' particles and the others.
struct Group {
    slot: [u32; WIDTH],
    i: [u32; WIDTH],
    j: [u32; WIDTH],
}

impl Group {
    #[inline(always)]
    fn new(slot: [u32; WIDTH], owner: &[u32], other: &[u32]) -> Self {
        let (mut i, mut j) = ([0; WIDTH], [0; WIDTH]);
        for l in 0..WIDTH {
            i[l] = owner[slot[l] as usize];
            j[l] = other[slot[l] as usize];
        }
        Group { slot, i, j }
    }
    /// Pairs that follow each other in the list; fewer than eight are filled up with the first.
    #[inline(always)]
    fn in_a_row(base: usize, width: usize, owner: &[u32], other: &[u32]) -> Self {
        let mut slot = [base as u32; WIDTH];
        for l in 0..width {
            slot[l] = (base + l) as u32;
        }
        match (owner[base..].first_chunk(), other[base..].first_chunk()) {
            (Some(&i), Some(&j)) => Group { slot, i, j },
            _ => Group::new(slot, owner, other),
        }
    }
}

/// The law in lanes.
struct Eights<R> {
    law: Law,
    period: Option<Period<R>>,
    step: R,
    lead: R,
    overlap_limit: R,
    /// The parameters, where there is one pair of materials only.
    alone: Option<Interaction<R>>,
    warm: Option<WarmEights<R>>,
}

impl<R: Eight> Eights<R> {
    #[inline(always)]
    fn new<V: Variant>(scene: &Scene<'_>) -> Self {
        Eights {
            law: scene.law::<V>(),
            period: scene.period.as_ref().map(lanes_period),
            step: R::lit(scene.step),
            lead: R::lit(scene.lead),
            overlap_limit: R::lit(scene.overlap_limit),
            alone: if scene.interactions.len() == 1 { Some(splat(&scene.interactions[0])) } else { None },
            warm: WarmEights::new(scene),
        }
    }

    /// How eight pairs lie to each other, and their radii.
    #[inline(always)]
    fn touch(&self, scene: &Scene<'_>, group: &Group) -> (Touch<R>, [R; 2]) {
        let [xa, ya, za, ra] = R::load(scene.place, &group.i);
        let [xb, yb, zb, rb] = R::load(scene.place, &group.j);
        let mut offset = vec3(xb, yb, zb) - vec3(xa, ya, za);
        if let Some(period) = &self.period {
            offset = period.nearest(offset);
        }
        (touch_spheres(offset, ra + rb), [ra, rb])
    }

    /// Evaluates the lanes of a group whose bit is set.
    #[inline(always)]
    fn evaluate<V: Variant>(
        &self,
        scene: &Scene<'_>,
        rows: &mut Rows<'_>,
        group: &Group,
        touch: &Touch<R>,
        radii: [R; 2],
        active: u8,
    ) {
        let a = load_spheres::<V, R>(scene, &group.i, radii[0]);
        let b = load_spheres::<V, R>(scene, &group.j, radii[1]);
        let arms = [lever_arm(radii[0], touch.overlap), lever_arm(radii[1], touch.overlap)];
        let mut encounter = Encounter::of_spheres(&a, &b, touch, V::MOMENTS, self.lead);
        if V::LEDGER && !scene.kick.is_empty() {
            let first = load_kicks::<V, R>(scene, &group.i, arms[0]);
            encounter = encounter.settled([first, load_kicks::<V, R>(scene, &group.j, arms[1])]);
        }
        let displacement = if V::FRICTION { R::load_triples(rows.displacement, &group.slot) } else { Vec3::zero() };
        let interaction = match self.alone {
            Some(interaction) => interaction,
            None => gather_interactions(scene, &group.i, &group.j),
        };
        let response = respond(self.law, &encounter, displacement, &interaction, self.step);
        let heat_rate = match &self.warm {
            Some(warm) => warm.heat_rate(scene, [&group.i, &group.j], touch, radii),
            None => R::lit(0.0),
        };
        keep_eight::<V, R>(scene, rows, group, &response, heat_rate, arms, active);
        if V::LEDGER && !rows.pressure.is_empty() {
            let zero = R::lit(0.0);
            let pressure =
                R::quads([elastic_force(encounter.radius_eff, touch.overlap, &interaction), zero, zero, zero]);
            for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
                rows.pressure[group.slot[l] as usize] = pressure[l][0];
            }
        }
    }
}

/// Keeps what the contacts do: forces, heat rates, moments, and what they remember and lost.
#[inline(always)]
fn keep_eight<V: Variant, R: Eight>(
    scene: &Scene<'_>,
    rows: &mut Rows<'_>,
    group: &Group,
    response: &Response<R>,
    heat_rate: R,
    arms: [R; 2],
    active: u8,
) {
    let zero = R::lit(0.0);
    let force = R::quads([response.force.x, response.force.y, response.force.z, heat_rate]);
    let displacement = quads(response.displacement);
    let moments = [quads(response.moment_per_arm * arms[0]), quads(response.moment_per_arm * arms[1])];
    for l in 0..WIDTH {
        if active >> l & 1 == 0 {
            continue;
        }
        let pair = group.slot[l] as usize;
        rows.keep::<V>(group.i[l] as usize, pair, force[l], [moments[0][l], moments[1][l]]);
        if V::FRICTION {
            rows.displacement[pair].copy_from_slice(&displacement[l][..3]);
        }
    }
    if V::LEDGER {
        let losses = &response.losses;
        let losses = R::quads([losses.friction, losses.damping, losses.stiffening, zero]);
        for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
            let [friction, damping, stiffening, _] = losses[l];
            let losses = Losses { friction, damping, stiffening };
            rows.book::<V>(scene, group.i[l] as usize, group.j[l] as usize, group.slot[l] as usize, &losses);
        }
    }
}

// Loads and stores are functions that are always inlined, not closures: a closure that stays a function is compiled
// without the instruction set of its caller, and every instruction in it becomes a call.

/// Eight spheres without their positions.
#[inline(always)]
fn load_spheres<V: Variant, R: Eight>(scene: &Scene<'_>, index: &[u32; WIDTH], radius: R) -> Sphere<R> {
    let [x, y, z, mass] = R::load(scene.motion, index);
    let mut angular_velocity = Vec3::zero();
    if V::MOMENTS {
        let [x, y, z, _] = R::load(scene.spin, index);
        angular_velocity = vec3(x, y, z);
    }
    Sphere { position: Vec3::zero(), radius, velocity: vec3(x, y, z), mass, angular_velocity }
}

/// How the last half kick changed eight spheres.
#[inline(always)]
fn load_kicks<V: Variant, R: Eight>(scene: &Scene<'_>, index: &[u32; WIDTH], arm: R) -> Kick<R> {
    let [x, y, z, _] = R::load(scene.kick, index);
    let mut rolling = Vec3::zero();
    if V::MOMENTS {
        let [x, y, z, _] = R::load(scene.twist, index);
        rolling = vec3(x, y, z) * arm;
    }
    Kick { velocity: vec3(x, y, z), rolling }
}

/// Eight vectors, a zero behind each.
#[inline(always)]
fn quads<R: Eight>(v: Vec3<R>) -> [[f64; 4]; WIDTH] {
    R::quads([v.x, v.y, v.z, R::lit(0.0)])
}

#[inline(always)]
fn splat<R: Eight>(one: &Interaction<f64>) -> Interaction<R> {
    Interaction {
        normal_stiffness: R::lit(one.normal_stiffness),
        tangential_stiffness: R::lit(one.tangential_stiffness),
        normal_damping: R::lit(one.normal_damping),
        tangential_damping: R::lit(one.tangential_damping),
        static_friction: R::lit(one.static_friction),
        dynamic_friction: R::lit(one.dynamic_friction),
        least_normal_force: R::lit(one.least_normal_force),
    }
}

/// The parameters of eight pairs of several materials.
#[inline(always)]
fn gather_interactions<R: Eight>(scene: &Scene<'_>, i: &[u32; WIDTH], j: &[u32; WIDTH]) -> Interaction<R> {
    let mut parts = [[0.0; WIDTH]; 7];
    for l in 0..WIDTH {
        let of = scene.interaction(i[l] as usize, j[l] as usize);
        parts[0][l] = of.normal_stiffness;
        parts[1][l] = of.tangential_stiffness;
        parts[2][l] = of.normal_damping;
        parts[3][l] = of.tangential_damping;
        parts[4][l] = of.static_friction;
        parts[5][l] = of.dynamic_friction;
        parts[6][l] = of.least_normal_force;
    }
    Interaction {
        normal_stiffness: R::from_array(parts[0]),
        tangential_stiffness: R::from_array(parts[1]),
        normal_damping: R::from_array(parts[2]),
        tangential_damping: R::from_array(parts[3]),
        static_friction: R::from_array(parts[4]),
        dynamic_friction: R::from_array(parts[5]),
        least_normal_force: R::from_array(parts[6]),
    }
}
