//! Stage `contact`: forces and moments of touching pairs.
//!
//! One loop, written for one number here and for eight in `contact/eight.rs`; both call the same laws and give the same
//! bits.

mod eight;
mod heat;

use super::bodies::{Bodies, Quad, sphere};
use super::heat::Flows;
use super::neighbours::reaction_numbers;
use super::pieces::{chunks_of, split};
use super::{Cpu, Width};
use crate::energy_accounts::{DAMPING, FRICTION, STIFFENING};
use crate::plan::overlap_ratio;
use crate::{Fault, HeatPlan};
use eight::{rows_portable, rows_widest};
use heat::Warm;
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::contact::encounter::lever_arm;
use tdem_physics::contact::{
    Encounter, Friction, Interaction, Kick, Law, Losses, Period, Sphere, Touch, elastic_force, released_energy,
    respond, touch_spheres,
};
use tdem_physics::heat::Dissipation;

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
    law: Law,
    period: Option<Period<f64>>,
    step: f64,
    /// Time by which positions are ahead of velocities, s.
    lead: f64,
    overlap_limit: f64,
    /// Index of the constraint of each particle.
    constraint: &'a [u16],
    /// Which constraints keep particles where they are.
    holds: &'a [bool],
    /// Which parts of losses become heat.
    dissipation: Dissipation<f64>,
    /// Where heat flows through contacts.
    warm: Option<Warm<'a>>,
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
    /// Pairs in which no contact acts, because their bond holds; empty if there are none.
    bonded: &'a [bool],
    displacement: &'a mut [[f64; 3]],
    reaction: &'a mut [f64],
    /// See [`reaction_numbers`].
    reaction_numbers: usize,
    /// Forces on these particles and heat rates into them, by their own rows.
    force: &'a mut [Quad],
    /// Moments on these particles, by their own rows.
    moment: &'a mut [Quad],
    /// Of these particles.
    accounts: &'a mut [[f64; 4]],
    /// Heat that each pair makes; empty where none does.
    made: &'a mut [f64],
    /// Elastic force of each pair; empty where the ledger does not follow expansion.
    pressure: &'a mut [f64],
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

/// What decides which numbers are read and written, known when a loop is compiled. The rest of a [`Law`] is looked up
/// while a loop runs, which costs nothing that can be measured.
pub(super) trait Variant {
    const FRICTION: bool;
    const MOMENTS: bool;
    const LEDGER: bool;
}
pub(super) struct Compiled<const FRICTION: bool, const MOMENTS: bool, const LEDGER: bool>;
impl<const FRICTION: bool, const MOMENTS: bool, const LEDGER: bool> Variant for Compiled<FRICTION, MOMENTS, LEDGER> {
    const FRICTION: bool = FRICTION;
    const MOMENTS: bool = MOMENTS;
    const LEDGER: bool = LEDGER;
}

/// The pair of lowest ranks that overlaps too much, if any.
pub(super) type Crushed = Option<(u32, u32)>;
type Loop = fn(&Scene<'_>, &mut Rows<'_>) -> Crushed;

/// The loop compiled for a law.
fn choose(law: Law, ledger: bool, width: Width) -> Loop {
    macro_rules! compiled {
        ($f:literal, $m:literal) => {
            match (width, ledger) {
                (Width::One, false) => rows_scalar::<Compiled<$f, $m, false>>,
                (Width::One, true) => rows_scalar::<Compiled<$f, $m, true>>,
                (Width::Portable, false) => rows_portable::<Compiled<$f, $m, false>>,
                (Width::Portable, true) => rows_portable::<Compiled<$f, $m, true>>,
                (Width::Widest, false) => rows_widest::<Compiled<$f, $m, false>>,
                (Width::Widest, true) => rows_widest::<Compiled<$f, $m, true>>,
            }
        };
    }
    match (law.friction, law.moments) {
        (Friction::Off, _) => compiled!(false, false),
        (_, false) => compiled!(true, false),
        (_, true) => compiled!(true, true),
    }
}

impl Cpu {
    /// Evaluates all listed pairs.
    pub(super) fn contact_all(&mut self) -> Result<(), Fault> {
        let lead = self.lead();
        let Bodies {
            place,
            motion,
            spin,
            rank,
            material,
            constraint,
            force,
            moment,
            accounts,
            kick,
            twist,
            temperature,
            ..
        } = &mut self.bodies;
        let holds: Vec<bool> = (0..self.plan.constraints.len()).map(|index| self.plan.holds(index)).collect();
        let scene = Scene {
            constraint,
            holds: &holds,
            place,
            motion,
            spin,
            rank,
            kick,
            twist,
            material,
            interactions: &self.plan.interactions,
            materials: self.plan.materials,
            law: self.plan.law,
            period: Some(self.plan.domain.period()).filter(Period::any),
            step: self.history_step,
            lead,
            overlap_limit: self.plan.overlap_limit,
            dissipation: self.plan.heat.as_ref().map(|heat| heat.dissipation).unwrap_or_default(),
            warm: Warm::of(&self.plan, temperature, &self.bonds),
        };
        let evaluate = choose(self.plan.law, self.plan.ledger, self.options.width);
        let list = &mut self.neighbours;
        let n = rank.len();
        let Flows { made, pressure, .. } = &mut self.flows;
        made.resize(if self.plan.makes_heat() { list.other.len() } else { 0 }, 0.0);
        let presses = self.plan.books_expansion() && self.plan.heat.as_ref().is_some_and(HeatPlan::flows);
        pressure.resize(if presses { list.other.len() } else { 0 }, 0.0);
        let particles = chunks_of(n);
        let pairs: Vec<usize> = particles.iter().map(|&p| list.start[p] as usize).collect();
        let mut tasks = Vec::with_capacity(particles.len());
        let mut touching = split(&mut list.touching, &pairs);
        let mut displacement = split(&mut list.displacement, &pairs);
        let reaction_numbers = reaction_numbers(&self.plan);
        let reactions: Vec<usize> = pairs.iter().map(|&p| p * reaction_numbers).collect();
        let mut reaction = split(&mut list.reaction, &reactions);
        let mut force = split(force, &particles);
        let mut moment = split(moment, &particles);
        let mut accounts = split(accounts, &particles);
        let mut made = split(made, &pairs);
        let mut pressure = split(pressure, &pairs);
        for chunk in 0..particles.len() - 1 {
            let (first, end) = (particles[chunk], particles[chunk + 1]);
            tasks.push(Rows {
                first,
                start: &list.start[first..=end],
                other: &list.other[pairs[chunk]..pairs[chunk + 1]],
                touching: touching.next().unwrap_or_default(),
                bonded: list.bonded.get(pairs[chunk]..pairs[chunk + 1]).unwrap_or_default(),
                displacement: displacement.next().unwrap_or_default(),
                reaction: reaction.next().unwrap_or_default(),
                reaction_numbers,
                force: force.next().unwrap_or_default(),
                moment: moment.next().unwrap_or_default(),
                accounts: accounts.next().unwrap_or_default(),
                made: made.next().unwrap_or_default(),
                pressure: pressure.next().unwrap_or_default(),
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
        let touch = touch_spheres(offset, a.scalar() + b.scalar());
        Fault::Overlap {
            step: self.step,
            time: self.time(),
            first: self.ids[first as usize],
            second: self.ids[second as usize],
            ratio: overlap_ratio(touch.overlap, a.scalar(), b.scalar()),
            limit: self.plan.overlap_limit,
        }
    }
}

impl Scene<'_> {
    fn law<V: Variant>(&self) -> Law {
        // Written so that the compiler sees which values are left.
        let friction = match (V::FRICTION, self.law.friction) {
            (false, _) => Friction::Off,
            (true, Friction::Rescaled) => Friction::Rescaled,
            (true, _) => Friction::Displacement,
        };
        Law { friction, moments: V::MOMENTS, ..self.law }
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
    /// Whether both particles of a pair stay where they are.
    fn both_held(&self, i: usize, j: usize) -> bool {
        [i, j].into_iter().all(|index| self.holds[usize::from(self.constraint[index])])
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
    /// Adds what a contact does to the row's particle, and keeps what the other will gather. The fourth number of the force
    /// is the heat rate, that of moments is unused.
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
        let numbers = self.reaction_numbers;
        if let Some(reaction) = self.reaction.get_mut(numbers * pair..numbers * (pair + 1)) {
            let felt = if V::MOMENTS { 6 } else { 3 };
            reaction[..3].copy_from_slice(&force[..3]);
            if V::MOMENTS {
                reaction[3..6].copy_from_slice(&moments[1][..3]);
            }
            if let Some(heat_rate) = reaction.get_mut(felt) {
                *heat_rate = force[3];
            }
        }
    }
    /// Books what a pair lost, and the heat that it makes; a pair that is listed twice is booked by its lower rank.
    #[inline(always)]
    fn book<V: Variant>(&mut self, scene: &Scene<'_>, i: usize, j: usize, pair: usize, losses: &Losses<f64>) {
        if let (true, Some(made)) = (V::LEDGER, self.made.get_mut(pair)) {
            *made = scene.dissipation.heat(losses.friction, losses.damping);
        }
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
        if !V::FRICTION {
            return;
        }
        if V::LEDGER && scene.rank[i] < scene.rank[j] {
            let (a, b) = (scene.sphere(i), scene.sphere(j));
            let encounter = Encounter::of_spheres(&a, &b, &scene.touch(i, j), V::MOMENTS, scene.lead);
            let displacement = self.displacement[pair].into();
            let released = released_energy(&encounter, displacement, scene.interaction(i, j), scene.step);
            self.lost[i - self.first].released += released;
        }
        self.displacement[pair] = [0.0; 3];
    }
    fn open_books<V: Variant>(&mut self) {
        self.force.fill(Quad::default());
        self.moment.fill(Quad::default());
        self.made.fill(0.0);
        self.pressure.fill(0.0);
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
            if rows.bonded.get(pair) == Some(&true) {
                continue;
            }
            let j = rows.other[pair] as usize;
            let touch = scene.touch(i, j);
            let touches = touch.overlap > 0.0;
            if touches {
                let (a, b) = (scene.sphere(i), scene.sphere(j));
                let mut encounter = Encounter::of_spheres(&a, &b, &touch, V::MOMENTS, scene.lead);
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
                let heat_rate = scene.heat_rate(i, j, &touch);
                rows.keep::<V>(i, pair, Quad::new(response.force.into(), heat_rate).0, moments);
                if V::FRICTION {
                    rows.displacement[pair] = response.displacement.into();
                }
                rows.book::<V>(scene, i, j, pair, &response.losses);
                if let Some(pressure) = rows.pressure.get_mut(pair) {
                    *pressure = elastic_force(encounter.radius_eff, touch.overlap, scene.interaction(i, j));
                }
                if touch.overlap > scene.overlap_limit * a.radius.min(b.radius) && !scene.both_held(i, j) {
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
