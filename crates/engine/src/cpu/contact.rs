//! Stage `contact`: forces and moments of touching pairs.
//!
//! One loop, written for one number and for eight lanes; both call the same laws and give the same bits.

use super::bodies::{Bodies, Quad, sphere};
use super::search::split;
use super::wide::{Machine, rows_widest};
use super::{CHUNK, Cpu};
use crate::Fault;
use crate::energy_accounts::{DAMPING, FRICTION, STIFFENING};
use rayon::prelude::*;
use tdem_physics::contact::{
    Damping, Encounter, Friction, Interaction, Law, Losses, Period, Response, Sphere, Touch, released_energy, respond,
    touch_spheres,
};
use tdem_physics::real::{Lanes, WIDTH};
use tdem_physics::{Real, Vec3, vec3};

/// What a contact loop reads.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    place: &'a [Quad],
    motion: &'a [Quad],
    spin: &'a [Quad],
    rank: &'a [u32],
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
    pull: &'a mut [[f64; 3]],
    turn: &'a mut [[f64; 4]],
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
        let Bodies { place, motion, spin, rank, material, accounts, .. } = &mut self.bodies;
        let scene = Scene {
            place,
            motion,
            spin,
            rank,
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
        let mut pull = split(&mut list.pull, &pairs);
        let mut turn = split(&mut list.turn, &pairs);
        let mut accounts = split(accounts, &particles);
        for chunk in 0..particles.len() - 1 {
            let (first, end) = (particles[chunk], particles[chunk + 1]);
            tasks.push(Rows {
                first,
                start: &list.start[first..=end],
                other: &list.other[pairs[chunk]..pairs[chunk + 1]],
                touching: touching.next().unwrap_or_default(),
                displacement: displacement.next().unwrap_or_default(),
                pull: pull.next().unwrap_or_default(),
                turn: turn.next().unwrap_or_default(),
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
    /// Keeps what a contact does.
    #[inline(always)]
    fn keep<V: Variant>(&mut self, pair: usize, response: &Response<f64>, overlap: f64) {
        self.pull[pair] = response.force.into();
        if V::FRICTION != Friction::Off {
            self.displacement[pair] = response.displacement.into();
        }
        if V::MOMENTS {
            let m = response.moment_per_arm;
            self.turn[pair] = [m.x, m.y, m.z, overlap];
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
                let encounter = Encounter::of_spheres(&a, &b, &touch, V::MOMENTS);
                let displacement = rows.displacement.get(pair).copied().unwrap_or_default().into();
                let response = respond(law, &encounter, displacement, scene.interaction(i, j), scene.step);
                rows.keep::<V>(pair, &response, touch.overlap);
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

/// Pairs eight at a time: first all listed pairs are tried, then those that touch are evaluated.
#[inline(always)]
pub(super) fn rows_lanes<V: Variant, M: Machine>(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Crushed {
    let pairs = rows.other.len();
    if pairs == 0 {
        return None;
    }
    let mut owner = vec![0_u32; pairs];
    for k in 0..rows.start.len() - 1 {
        owner[rows.row(k)].fill((rows.first + k) as u32);
    }
    rows.open_books::<V>();
    let (compact, crushed) = try_pairs::<V, M>(scene, rows, &owner);
    let law = scene.law::<V>();
    let alone = (scene.interactions.len() == 1).then(|| splat(&scene.interactions[0]));
    let period = scene.period.map(|p| Period { length: p.length.map(Lanes::lit), half: p.half.map(Lanes::lit) });
    let step = Lanes::lit(scene.step);
    for group in compact.chunks(WIDTH) {
        // A last, short group is filled up with its first pair.
        let slot: [usize; WIDTH] = std::array::from_fn(|l| group[if l < group.len() { l } else { 0 }] as usize);
        let (i, j) = (slot.map(|s| owner[s]), slot.map(|s| rows.other[s]));
        let [xa, ya, za, ra] = M::load(scene.place, &i);
        let [xb, yb, zb, rb] = M::load(scene.place, &j);
        let offset = vec3(xb, yb, zb) - vec3(xa, ya, za);
        let offset = period.as_ref().map_or(offset, |p| p.nearest(offset));
        let touch = touch_spheres(offset, ra + rb);
        let [ua, va, wa, ma] = M::load(scene.motion, &i);
        let [ub, vb, wb, mb] = M::load(scene.motion, &j);
        let mut spins = [Vec3::zero(); 2];
        if V::MOMENTS {
            let [pa, qa, ta, _] = M::load(scene.spin, &i);
            let [pb, qb, tb, _] = M::load(scene.spin, &j);
            spins = [vec3(pa, qa, ta), vec3(pb, qb, tb)];
        }
        let a = Sphere {
            position: vec3(xa, ya, za),
            radius: ra,
            velocity: vec3(ua, va, wa),
            mass: ma,
            angular_velocity: spins[0],
        };
        let b = Sphere {
            position: vec3(xb, yb, zb),
            radius: rb,
            velocity: vec3(ub, vb, wb),
            mass: mb,
            angular_velocity: spins[1],
        };
        let encounter = Encounter::of_spheres(&a, &b, &touch, V::MOMENTS);
        let mut displacement: Vec3<Lanes> = Vec3::zero();
        if V::FRICTION != Friction::Off {
            for l in 0..WIDTH {
                let [x, y, z] = rows.displacement[slot[l]];
                (displacement.x.0[l], displacement.y.0[l], displacement.z.0[l]) = (x, y, z);
            }
        }
        let interaction = alone.unwrap_or_else(|| gather_interactions(scene, &i, &j));
        let response = respond(law, &encounter, displacement, &interaction, step);
        for l in 0..group.len() {
            let lane = lane(&response, l);
            rows.keep::<V>(slot[l], &lane, touch.overlap.0[l]);
            rows.book::<V>(scene, i[l] as usize, j[l] as usize, &lane.losses);
        }
    }
    rows.close_books::<V>();
    crushed
}

/// Marks the pairs that touch and lists them; pairs that part forget.
#[inline(always)]
fn try_pairs<V: Variant, M: Machine>(scene: &Scene<'_>, rows: &mut Rows<'_>, owner: &[u32]) -> (Vec<u32>, Crushed) {
    let pairs = owner.len();
    let mut compact = vec![0_u32; pairs + WIDTH];
    let mut count = 0;
    let mut crushed: Crushed = None;
    let limit = Lanes::lit(scene.overlap_limit);
    let period = scene.period.map(|p| Period { length: p.length.map(Lanes::lit), half: p.half.map(Lanes::lit) });
    for base in (0..pairs).step_by(WIDTH) {
        let width = WIDTH.min(pairs - base);
        let slot: [usize; WIDTH] = std::array::from_fn(|l| base + l.min(width - 1));
        let (i, j) = (slot.map(|s| owner[s]), slot.map(|s| rows.other[s]));
        let [xa, ya, za, ra] = M::load(scene.place, &i);
        let [xb, yb, zb, rb] = M::load(scene.place, &j);
        let offset = vec3(xb, yb, zb) - vec3(xa, ya, za);
        let offset = period.as_ref().map_or(offset, |p| p.nearest(offset));
        let touch = touch_spheres(offset, ra + rb);
        let touches = touch.overlap.gt(Lanes::lit(0.0));
        let crushes = touch.overlap.gt(limit * (ra + rb));
        for l in 0..width {
            let (now, before) = (touches[l] != 0, rows.touching[slot[l]]);
            compact[count] = slot[l] as u32;
            count += usize::from(now);
            if before && !now {
                rows.part::<V>(scene, i[l] as usize, j[l] as usize, slot[l]);
            }
            rows.touching[slot[l]] = now;
            if crushes[l] != 0 {
                crushed = Some(worse(crushed, scene.ranks(i[l] as usize, j[l] as usize)));
            }
        }
    }
    compact.truncate(count);
    (compact, crushed)
}

fn splat(one: &Interaction<f64>) -> Interaction<Lanes> {
    Interaction {
        normal_stiffness: Lanes::lit(one.normal_stiffness),
        tangential_stiffness: Lanes::lit(one.tangential_stiffness),
        normal_damping: Lanes::lit(one.normal_damping),
        tangential_damping: Lanes::lit(one.tangential_damping),
        static_friction: Lanes::lit(one.static_friction),
        dynamic_friction: Lanes::lit(one.dynamic_friction),
        least_normal_force: Lanes::lit(one.least_normal_force),
    }
}

/// The parameters of eight pairs of several materials.
fn gather_interactions(scene: &Scene<'_>, i: &[u32; WIDTH], j: &[u32; WIDTH]) -> Interaction<Lanes> {
    let of: [&Interaction<f64>; WIDTH] = std::array::from_fn(|l| scene.interaction(i[l] as usize, j[l] as usize));
    Interaction {
        normal_stiffness: Lanes(of.map(|p| p.normal_stiffness)),
        tangential_stiffness: Lanes(of.map(|p| p.tangential_stiffness)),
        normal_damping: Lanes(of.map(|p| p.normal_damping)),
        tangential_damping: Lanes(of.map(|p| p.tangential_damping)),
        static_friction: Lanes(of.map(|p| p.static_friction)),
        dynamic_friction: Lanes(of.map(|p| p.dynamic_friction)),
        least_normal_force: Lanes(of.map(|p| p.least_normal_force)),
    }
}

/// One lane of a response.
#[inline(always)]
fn lane(response: &Response<Lanes>, l: usize) -> Response<f64> {
    let vector = |v: &Vec3<Lanes>| vec3(v.x.0[l], v.y.0[l], v.z.0[l]);
    Response {
        force: vector(&response.force),
        moment_per_arm: vector(&response.moment_per_arm),
        displacement: vector(&response.displacement),
        losses: Losses {
            friction: response.losses.friction.0[l],
            damping: response.losses.damping.0[l],
            stiffening: response.losses.stiffening.0[l],
        },
    }
}
