//! Stage `contact`: forces and moments of touching pairs.
//!
//! One loop, written for one number and for eight lanes; both call the same laws and give the same bits.

use super::bodies::{Bodies, Quad, sphere};
use super::search::split;
use super::wide::{Eight, prefetch, rows_widest};
use super::{CHUNK, Cpu};
use crate::Fault;
use crate::energy_accounts::{DAMPING, FRICTION, STIFFENING};
use rayon::prelude::*;
use tdem_physics::contact::encounter::lever_arm;
use tdem_physics::contact::{
    Damping, Encounter, Friction, Interaction, Kick, Law, Losses, Period, Response, Sphere, Touch, released_energy,
    respond, touch_spheres,
};
use tdem_physics::real::WIDTH;
use tdem_physics::{Vec3, vec3};

/// What a contact loop reads.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    place: &'a [Quad],
    motion: &'a [Quad],
    spin: &'a [Quad],
    rank: &'a [u32],
    kick: &'a [Quad],
    twist: &'a [Quad],
    material: &'a [u16],
    interactions: &'a [Interaction<f64>],
    materials: usize,
    damping: Damping,
    period: Option<Period<f64>>,
    step: f64,
    overlap_limit: f64,
}

/// What a contact loop writes: the rows of a chunk of particles.
pub(super) struct Rows<'a> {
    /// The first particle.
    first: usize,
    /// Starts of the rows, and the end of the last.
    start: &'a [u32],
    /// Of all rows, from here on of these rows only.
    other: &'a [u32],
    touching: &'a mut [bool],
    displacement: &'a mut [[f64; 3]],
    reaction: &'a mut [f64],
    /// Forces on these particles, by their own rows.
    force: &'a mut [Quad],
    /// Moments on these particles, by their own rows.
    moment: &'a mut [Quad],
    /// Of these particles.
    accounts: &'a mut [[f64; 4]],
    /// What the pairs of each row lost in this step: summed on its own, in the order of pairs, so that it does not
    /// matter whether partings are found before or between contacts.
    lost: Vec<Lost>,
}

/// Losses of one row in one step, J.
#[derive(Clone, Copy, Default)]
struct Lost {
    friction: f64,
    damping: f64,
    stiffening: f64,
    released: f64,
}

/// The axes of a law that decide what is read and written, known when a loop is compiled.
pub(super) trait Variant {
    const FRICTION: Friction;
    const MOMENTS: bool;
    const LEDGER: bool;
}
pub(super) struct Compiled<const FRICTION: u8, const MOMENTS: bool, const LEDGER: bool>;
impl<const F: u8, const MOMENTS: bool, const LEDGER: bool> Variant for Compiled<F, MOMENTS, LEDGER> {
    const FRICTION: Friction = match F {
        0 => Friction::Off,
        1 => Friction::Displacement,
        _ => Friction::Rescaled,
    };
    const MOMENTS: bool = MOMENTS;
    const LEDGER: bool = LEDGER;
}

/// The pair of lowest ranks that overlaps too much, if any.
pub(super) type Crushed = Option<(u32, u32)>;
/// Numbers per reaction.
pub(super) fn law_stride(law: Law) -> usize {
    if law.moments { 6 } else { 3 }
}

type Loop = fn(&Scene<'_>, &mut Rows<'_>) -> Crushed;

/// The loop compiled for a law.
fn choose(law: Law, ledger: bool, lanes: bool) -> Loop {
    macro_rules! compiled {
        ($f:literal, $m:literal) => {
            match (lanes, ledger) {
                (false, false) => rows_scalar::<Compiled<$f, $m, false>>,
                (false, true) => rows_scalar::<Compiled<$f, $m, true>>,
                (true, false) => rows_widest::<Compiled<$f, $m, false>>,
                (true, true) => rows_widest::<Compiled<$f, $m, true>>,
            }
        };
    }
    match (law.friction, law.moments) {
        (Friction::Off, _) => compiled!(0, false),
        (Friction::Displacement, false) => compiled!(1, false),
        (Friction::Displacement, true) => compiled!(1, true),
        (Friction::Rescaled, false) => compiled!(2, false),
        (Friction::Rescaled, true) => compiled!(2, true),
    }
}

impl Cpu {
    /// Evaluates all listed pairs.
    pub(super) fn contact_all(&mut self) -> Result<(), Fault> {
        let Bodies { place, motion, spin, rank, material, force, moment, accounts, kick, twist, .. } = &mut self.bodies;
        let scene = Scene {
            place,
            motion,
            spin,
            rank,
            kick,
            twist,
            material,
            interactions: &self.plan.interactions,
            materials: self.plan.materials,
            damping: self.plan.law.damping,
            period: Some(self.plan.domain.period()).filter(Period::any),
            step: self.history_step,
            overlap_limit: 0.5 * self.plan.overlap_limit,
        };
        let evaluate = choose(self.plan.law, self.plan.ledger, self.options.lanes);
        let list = &mut self.neighbours;
        let n = rank.len();
        let particles: Vec<usize> = (0..=n.div_ceil(CHUNK)).map(|chunk| (chunk * CHUNK).min(n)).collect();
        let pairs: Vec<usize> = particles.iter().map(|&p| list.start[p] as usize).collect();
        let mut tasks = Vec::with_capacity(particles.len());
        let mut touching = split(&mut list.touching, &pairs);
        let mut displacement = split(&mut list.displacement, &pairs);
        let stride = law_stride(self.plan.law);
        let reactions: Vec<usize> = pairs.iter().map(|&p| p * stride).collect();
        let mut reaction = split(&mut list.reaction, &reactions);
        let mut force = split(force, &particles);
        let mut moment = split(moment, &particles);
        let mut accounts = split(accounts, &particles);
        for chunk in 0..particles.len() - 1 {
            let (first, end) = (particles[chunk], particles[chunk + 1]);
            tasks.push(Rows {
                first,
                start: &list.start[first..=end],
                other: &list.other[pairs[chunk]..pairs[chunk + 1]],
                touching: touching.next().unwrap_or_default(),
                displacement: displacement.next().unwrap_or_default(),
                reaction: reaction.next().unwrap_or_default(),
                force: force.next().unwrap_or_default(),
                moment: moment.next().unwrap_or_default(),
                accounts: accounts.next().unwrap_or_default(),
                lost: Vec::new(),
            });
        }
        let crushed = tasks.par_iter_mut().filter_map(|rows| evaluate(&scene, rows)).min();
        match crushed {
            None => Ok(()),
            Some((first, second)) => Err(self.crushed(first, second)),
        }
    }

    /// The fault of two particles that overlap too much.
    fn crushed(&self, first: u32, second: u32) -> Fault {
        let index = |rank: u32| self.bodies.rank.iter().position(|&r| r == rank).unwrap_or(0);
        let (a, b) = (self.bodies.place[index(first)], self.bodies.place[index(second)]);
        let offset = self.plan.domain.period().nearest(b.vector() - a.vector());
        let radius_sum = a.scalar() + b.scalar();
        Fault::Overlap {
            step: self.step,
            time: self.time(),
            first: self.ids[first as usize],
            second: self.ids[second as usize],
            ratio: 2.0 * touch_spheres(offset, radius_sum).overlap / radius_sum,
            limit: self.plan.overlap_limit,
        }
    }
}

impl Scene<'_> {
    fn law<V: Variant>(&self) -> Law {
        Law { damping: self.damping, friction: V::FRICTION, moments: V::MOMENTS }
    }
    fn interaction(&self, i: usize, j: usize) -> &Interaction<f64> {
        &self.interactions[usize::from(self.material[i]) * self.materials + usize::from(self.material[j])]
    }
    fn sphere(&self, i: usize) -> Sphere<f64> {
        sphere(&self.place[i], &self.motion[i], &self.spin[i])
    }
    fn touch(&self, i: usize, j: usize) -> Touch<f64> {
        let offset = self.place[j].vector() - self.place[i].vector();
        let offset = self.period.map_or(offset, |p| p.nearest(offset));
        touch_spheres(offset, self.place[i].scalar() + self.place[j].scalar())
    }
    fn kick_of<V: Variant>(&self, i: usize, arm: f64) -> Kick<f64> {
        Kick {
            velocity: self.kick[i].vector(),
            rolling: if V::MOMENTS { self.twist[i].vector() * arm } else { Vec3::zero() },
        }
    }
    /// The ranks of a pair, the lower first.
    fn ranks(&self, i: usize, j: usize) -> (u32, u32) {
        (self.rank[i].min(self.rank[j]), self.rank[i].max(self.rank[j]))
    }
}

impl Rows<'_> {
    /// Pairs of the `k`-th particle, counted from the first pair of these rows.
    fn row(&self, k: usize) -> std::ops::Range<usize> {
        (self.start[k] - self.start[0]) as usize..(self.start[k + 1] - self.start[0]) as usize
    }
    /// Adds what a contact does to the row's particle, and keeps what the other will gather. Fourth numbers are unused.
    #[inline(always)]
    fn keep<V: Variant>(&mut self, i: usize, pair: usize, force: [f64; 4], moments: [[f64; 4]; 2]) {
        let mine = i - self.first;
        for k in 0..4 {
            self.force[mine].0[k] += force[k];
        }
        if V::MOMENTS {
            for k in 0..4 {
                self.moment[mine].0[k] += moments[0][k];
            }
        }
        let stride = if V::MOMENTS { 6 } else { 3 };
        if let Some(reaction) = self.reaction.get_mut(stride * pair..stride * (pair + 1)) {
            reaction[..3].copy_from_slice(&force[..3]);
            if V::MOMENTS {
                reaction[3..].copy_from_slice(&moments[1][..3]);
            }
        }
    }
    /// Books what a pair lost; a pair that is listed twice is booked by its lower rank.
    #[inline(always)]
    fn book<V: Variant>(&mut self, scene: &Scene<'_>, i: usize, j: usize, losses: &Losses<f64>) {
        if V::LEDGER && scene.rank[i] < scene.rank[j] {
            let lost = &mut self.lost[i - self.first];
            lost.friction += losses.friction;
            lost.damping += losses.damping;
            lost.stiffening += losses.stiffening;
        }
    }
    /// Forgets what a pair remembered when it parts.
    #[cold]
    fn part<V: Variant>(&mut self, scene: &Scene<'_>, i: usize, j: usize, pair: usize) {
        if V::FRICTION == Friction::Off {
            return;
        }
        if V::LEDGER && scene.rank[i] < scene.rank[j] {
            let (a, b) = (scene.sphere(i), scene.sphere(j));
            let encounter = Encounter::of_spheres(&a, &b, &scene.touch(i, j), V::MOMENTS);
            let displacement = self.displacement[pair].into();
            let released = released_energy(&encounter, displacement, scene.interaction(i, j), scene.step);
            self.lost[i - self.first].released += released;
        }
        self.displacement[pair] = [0.0; 3];
    }
    fn open_books<V: Variant>(&mut self) {
        self.force.fill(Quad::default());
        self.moment.fill(Quad::default());
        if V::LEDGER {
            self.lost = vec![Lost::default(); self.accounts.len()];
        }
    }
    fn close_books<V: Variant>(&mut self) {
        if V::LEDGER {
            for (account, lost) in self.accounts.iter_mut().zip(&self.lost) {
                account[FRICTION] += lost.friction;
                account[DAMPING] += lost.damping;
                account[STIFFENING] += lost.stiffening - lost.released;
            }
        }
    }
}

/// Pairs one by one: the plain reference.
fn rows_scalar<V: Variant>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
    let law = scene.law::<V>();
    rows.open_books::<V>();
    let mut crushed: Crushed = None;
    for k in 0..rows.start.len() - 1 {
        let i = rows.first + k;
        for pair in rows.row(k) {
            let j = rows.other[pair] as usize;
            let touch = scene.touch(i, j);
            let touches = touch.overlap > 0.0;
            if touches {
                let (a, b) = (scene.sphere(i), scene.sphere(j));
                let mut encounter = Encounter::of_spheres(&a, &b, &touch, V::MOMENTS);
                if V::LEDGER && !scene.kick.is_empty() {
                    encounter = encounter.settled([
                        scene.kick_of::<V>(i, lever_arm(a.radius, touch.overlap)),
                        scene.kick_of::<V>(j, lever_arm(b.radius, touch.overlap)),
                    ]);
                }
                let displacement = rows.displacement.get(pair).copied().unwrap_or_default().into();
                let response = respond(law, &encounter, displacement, scene.interaction(i, j), scene.step);
                let arms = [a.radius, b.radius].map(|radius| lever_arm(radius, touch.overlap));
                let moments = arms.map(|arm| Quad::new((response.moment_per_arm * arm).into(), 0.0).0);
                rows.keep::<V>(i, pair, Quad::new(response.force.into(), 0.0).0, moments);
                if V::FRICTION != Friction::Off {
                    rows.displacement[pair] = response.displacement.into();
                }
                rows.book::<V>(scene, i, j, &response.losses);
                if touch.overlap > scene.overlap_limit * (a.radius + b.radius) {
                    crushed = Some(worse(crushed, scene.ranks(i, j)));
                }
            } else if rows.touching[pair] {
                rows.part::<V>(scene, i, j, pair);
            }
            rows.touching[pair] = touches;
        }
    }
    rows.close_books::<V>();
    crushed
}

fn worse(crushed: Crushed, pair: (u32, u32)) -> (u32, u32) {
    crushed.map_or(pair, |known| known.min(pair))
}

/// Pairs eight at a time.
///
/// Where most listed pairs touch, groups of eight neighbours in the list are evaluated as they come, and lanes that do
/// not touch are thrown away. Elsewhere the pairs that touch are collected first.
#[inline(always)]
pub(super) fn rows_eight<V: Variant, R: Eight>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
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
        let group = Group::in_a_row(base, width, &owner, rows.other);
        ask_ahead::<V>(scene, rows.other, base + AHEAD);
        let (touch, radii) = law.touch(scene, &group);
        let touches = R::bits(touch.overlap.gt(R::lit(0.0)));
        let crushes = R::bits(touch.overlap.gt(law.overlap_limit * (radii[0] + radii[1])));
        if crushes != 0 {
            for l in (0..width).filter(|l| crushes >> l & 1 != 0) {
                crushed = Some(worse(crushed, scene.ranks(group.i[l] as usize, group.j[l] as usize)));
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
    overlap_limit: R,
    /// The parameters, where there is one pair of materials only.
    alone: Option<Interaction<R>>,
}

impl<R: Eight> Eights<R> {
    #[inline(always)]
    fn new<V: Variant>(scene: &Scene<'_>) -> Self {
        Eights {
            law: scene.law::<V>(),
            period: lanes_period(scene),
            step: R::lit(scene.step),
            overlap_limit: R::lit(scene.overlap_limit),
            alone: if scene.interactions.len() == 1 { Some(splat(&scene.interactions[0])) } else { None },
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
        let mut encounter = Encounter::of_spheres(&a, &b, touch, V::MOMENTS);
        if V::LEDGER && !scene.kick.is_empty() {
            let first = load_kicks::<V, R>(scene, &group.i, arms[0]);
            encounter = encounter.settled([first, load_kicks::<V, R>(scene, &group.j, arms[1])]);
        }
        let displacement =
            if V::FRICTION == Friction::Off { Vec3::zero() } else { R::load_triples(rows.displacement, &group.slot) };
        let interaction = match self.alone {
            Some(interaction) => interaction,
            None => gather_interactions(scene, &group.i, &group.j),
        };
        let response = respond(self.law, &encounter, displacement, &interaction, self.step);
        keep_eight::<V, R>(scene, rows, group, &response, arms, active);
    }
}

/// Keeps what the contacts do.
#[inline(always)]
fn keep_eight<V: Variant, R: Eight>(
    scene: &Scene<'_>,
    rows: &mut Rows<'_>,
    group: &Group,
    response: &Response<R>,
    arms: [R; 2],
    active: u8,
) {
    let zero = R::lit(0.0);
    let force = quads(response.force);
    let displacement = quads(response.displacement);
    let moments = [quads(response.moment_per_arm * arms[0]), quads(response.moment_per_arm * arms[1])];
    for l in 0..WIDTH {
        if active >> l & 1 == 0 {
            continue;
        }
        let pair = group.slot[l] as usize;
        rows.keep::<V>(group.i[l] as usize, pair, force[l], [moments[0][l], moments[1][l]]);
        if V::FRICTION != Friction::Off {
            rows.displacement[pair].copy_from_slice(&displacement[l][..3]);
        }
    }
    if V::LEDGER {
        let losses = &response.losses;
        let losses = R::quads([losses.friction, losses.damping, losses.stiffening, zero]);
        for l in (0..WIDTH).filter(|l| active >> l & 1 != 0) {
            let [friction, damping, stiffening, _] = losses[l];
            let losses = Losses { friction, damping, stiffening };
            rows.book::<V>(scene, group.i[l] as usize, group.j[l] as usize, &losses);
        }
    }
}

#[inline(always)]
fn lanes_period<R: Eight>(scene: &Scene<'_>) -> Option<Period<R>> {
    let p = scene.period.as_ref()?;
    Some(Period {
        length: vec3(R::lit(p.length.x), R::lit(p.length.y), R::lit(p.length.z)),
        half: vec3(R::lit(p.half.x), R::lit(p.half.y), R::lit(p.half.z)),
    })
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
