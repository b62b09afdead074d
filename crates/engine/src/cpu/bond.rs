//! Stage `bond`: forces and moments of bonded pairs, and which of them break.
//!
//! The force of its bonds on a particle is summed from zero: those in which it has the lower id, by the other's id,
//! ascending; then those in which it has the higher id, by the other's id, ascending. Stage `gather` adds this sum to
//! that of the contacts. Each bond is evaluated once, by its particle of the lower id.
//!
//! One loop, written for one number here and for eight in `bond/eight.rs`; both call the same laws and give the same bits.

mod eight;

use super::bodies::{Bodies, Quad, sphere};
use super::bonds::{Bonds, REACTION, Written};
use super::heat::{Flows, link};
use super::pieces::{chunks_of, split};
use super::{Cpu, Width};
use crate::energy_accounts::DAMPING;
use crate::evaluate::quaternion;
use crate::{BondHistory, BondPlan, BondTables, Breakage, HeatPlan};
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::bond::{
    Advance, Bond, Damping, Ends, Failure, Form, Joint, Law, Posture, Reaction, Rest, damping, released_energy,
    respond_incremental, respond_total, stored_energy,
};
use tdem_physics::contact::{Encounter, Period, Sphere, begun_energy, touch_spheres};

/// What a bond loop reads.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    place: &'a [Quad],
    motion: &'a [Quad],
    spin: &'a [Quad],
    orientation: &'a [Quad],
    kick: &'a [Quad],
    twist: &'a [Quad],
    material: &'a [u16],
    materials: usize,
    owner: &'a [u32],
    other: &'a [u32],
    offset: &'a [[f64; 3]],
    strength: &'a [f64],
    holds: &'a [bool],
    joints: &'a [Joint<f64>],
    alike: Option<&'a [Bond<f64>]>,
    law: Law,
    period: Option<Period<f64>>,
    step: f64,
    /// Time by which positions are ahead of velocities, s.
    lead: f64,
    heat: Option<Warm<'a>>,
    tempering: Option<Tempering<'a>>,
}

/// What bonds look at that expand.
#[derive(Clone, Copy)]
struct Warm<'a> {
    plan: &'a HeatPlan,
    bodies: &'a Bodies,
    bonds: &'a Bonds,
}

/// What bonds look at whose numbers depend on temperature.
#[derive(Clone, Copy)]
struct Tempering<'a> {
    tables: &'a BondTables,
    temperature: &'a [f64],
}

/// What a bond loop writes: the rows of a chunk of particles.
pub(super) struct Rows<'a> {
    /// The first particle.
    first: usize,
    /// The first bond.
    base: usize,
    /// From here on of these rows only.
    history: &'a mut [BondHistory],
    reaction: &'a mut [f64],
    force: &'a mut [Quad],
    moment: &'a mut [Quad],
    /// Empty without a ledger or without dashpots.
    accounts: &'a mut [[f64; 4]],
    /// What the dashpots of each row took in this step, J; summed on its own, in the order of bonds.
    lost: Vec<f64>,
    /// The same of each bond; empty where it does not become heat.
    taken: &'a mut [f64],
    /// Elastic tension of each bond, N; empty where nobody looks at it.
    tension: &'a mut [f64],
    /// Energy in the springs of each bond, J; empty where their stiffness does not depend on temperature, or nobody looks.
    energy: &'a mut [f64],
}

/// Evaluates the bonds of a chunk and returns those that fail.
type Loop = fn(&Scene<'_>, &mut Rows<'_>) -> Vec<u32>;

impl Cpu {
    /// Evaluates all bonds that hold, and breaks those that fail.
    pub(super) fn bond_all(&mut self) {
        if self.bonds.is_empty() {
            return;
        }
        let mut written = std::mem::take(&mut self.bonds.written);
        let mut accounts = std::mem::take(&mut self.bodies.accounts);
        let mut flows = std::mem::take(&mut self.flows);
        let count = self.bonds.table.len();
        let dashpots = self.plan.makes_heat() && self.plan.bonds.as_ref().is_some_and(BondPlan::has_dashpots);
        flows.bond_losses.resize(if dashpots { count } else { 0 }, 0.0);
        let follows = self.plan.books_expansion();
        flows.tension.resize(if follows { count } else { 0 }, 0.0);
        flows.energy.resize(if follows && self.plan.softens() { count } else { 0 }, 0.0);
        let failed = self.bond_scene().map_or_else(Vec::new, |scene| {
            let booked = if scene.law.damping == Damping::Off { &mut [][..] } else { &mut accounts };
            let evaluate: Loop = match self.options.width {
                Width::One => rows_scalar,
                Width::Portable => eight::rows_portable,
                Width::Widest => eight::rows_widest,
            };
            let mut tasks = tasks(&self.bonds, &mut written, booked, &mut flows);
            tasks.par_iter_mut().flat_map_iter(|rows| evaluate(&scene, rows)).collect()
        });
        self.bonds.written = written;
        self.bodies.accounts = accounts;
        self.flows = flows;
        for slot in failed {
            self.break_bond(slot as usize);
        }
    }

    fn bond_scene(&self) -> Option<Scene<'_>> {
        let Bodies { place, motion, spin, orientation, kick, twist, material, .. } = &self.bodies;
        let Bonds { owner, other, offset, strength, holds, joints, alike, .. } = &self.bonds;
        Some(Scene {
            place,
            motion,
            spin,
            orientation,
            kick,
            twist,
            material,
            materials: self.plan.materials,
            owner,
            other,
            offset,
            strength,
            holds,
            joints,
            alike: alike.as_deref(),
            law: self.plan.bonds.as_ref()?.law,
            period: Some(self.plan.domain.period()).filter(Period::any),
            step: self.history_step,
            lead: self.lead(),
            tempering: (self.plan.bonds.as_ref().map(|bonds| &bonds.tables))
                .filter(|tables| !tables.is_empty())
                .map(|tables| Tempering { tables, temperature: &self.bodies.temperature }),
            heat: (self.plan.heat.as_ref().filter(|heat| heat.expands())).map(|plan| Warm {
                plan,
                bodies: &self.bodies,
                bonds: &self.bonds,
            }),
        })
    }

    /// Breaks a bond that has failed in this step: it exerts nothing any more, and contact may begin.
    fn break_bond(&mut self, slot: usize) {
        let Some(scene) = self.bond_scene() else { return };
        let earlier = self.bonds.written.history.get(slot);
        let (_, reaction) = scene.respond(slot, earlier);
        let ends = scene.ends(slot);
        let released = released_energy(&ends, &reaction.load, &scene.numbers(slot), scene.step);
        let energy = released - self.begun_contact(slot, &ends);
        let (i, j) = scene.pair(slot);
        let step = self.step;
        self.bonds.entry(slot).breakage =
            Failure::of_code(reaction.failure).map(|failure| Breakage { step, failure, energy });
        self.bonds.holds[slot] = false;
        if let Some(history) = self.bonds.written.history.get_mut(slot) {
            *history = BondHistory::default();
        }
        self.neighbours.release(i, j);
    }

    /// Energy of the contact that begins with the end of a bond, J.
    fn begun_contact(&self, slot: usize, ends: &Ends<f64>) -> f64 {
        let touch = touch_spheres(ends.offset, ends.first.radius + ends.second.radius);
        let beside = self.plan.bonds.as_ref().is_some_and(|bonds| bonds.contact_in_bonded_pairs);
        if beside || touch.overlap <= 0.0 {
            return 0.0;
        }
        let [i, j] = [self.bonds.owner[slot], self.bonds.other[slot]].map(|k| self.bodies.material[k as usize]);
        let encounter = Encounter::of_spheres(&ends.first, &ends.second, &touch, true, ends.lead);
        begun_energy(&encounter, self.plan.interaction(i, j), self.history_step)
    }
}

/// The rows of each chunk of particles.
fn tasks<'a>(
    bonds: &Bonds,
    written: &'a mut Written,
    accounts: &'a mut [[f64; 4]],
    flows: &'a mut Flows,
) -> Vec<Rows<'a>> {
    let n = bonds.start.len() - 1;
    let particles = chunks_of(n);
    let slots: Vec<usize> = particles.iter().map(|&particle| bonds.start[particle] as usize).collect();
    let reactions: Vec<usize> = slots.iter().map(|&slot| REACTION * slot).collect();
    let mut history = split(&mut written.history, &slots);
    let mut reaction = split(&mut written.reaction, &reactions);
    let mut force = split(&mut written.force, &particles);
    let mut moment = split(&mut written.moment, &particles);
    let mut accounts = split(accounts, &particles);
    let mut taken = split(&mut flows.bond_losses, &slots);
    let mut tension = split(&mut flows.tension, &slots);
    let mut energy = split(&mut flows.energy, &slots);
    (particles.iter().zip(&slots).take(particles.len() - 1))
        .map(|(&first, &base)| Rows {
            first,
            base,
            history: history.next().unwrap_or_default(),
            reaction: reaction.next().unwrap_or_default(),
            force: force.next().unwrap_or_default(),
            moment: moment.next().unwrap_or_default(),
            accounts: accounts.next().unwrap_or_default(),
            lost: Vec::new(),
            taken: taken.next().unwrap_or_default(),
            tension: tension.next().unwrap_or_default(),
            energy: energy.next().unwrap_or_default(),
        })
        .collect()
}

impl Scene<'_> {
    /// The particles of a bond, the row's first.
    #[inline(always)]
    fn pair(&self, slot: usize) -> (usize, usize) {
        (self.owner[slot] as usize, self.other[slot] as usize)
    }
    #[inline(always)]
    fn sphere(&self, i: usize) -> Sphere<f64> {
        sphere(&self.place[i], &self.motion[i], &self.spin[i])
    }
    #[inline(always)]
    fn ends(&self, slot: usize) -> Ends<f64> {
        let (i, j) = self.pair(slot);
        let offset = self.place[j].vector() - self.place[i].vector();
        let offset = self.period.map_or(offset, |period| period.nearest(offset));
        Ends { first: self.sphere(i), second: self.sphere(j), offset, lead: self.lead }
    }
    /// The same with the velocities of the end of the step, as well as they are known.
    fn settled(&self, slot: usize, ends: &Ends<f64>) -> Ends<f64> {
        let settle = |sphere: Sphere<f64>, i: usize| Sphere {
            velocity: sphere.velocity + self.kick[i].vector(),
            angular_velocity: sphere.angular_velocity + self.twist[i].vector(),
            ..sphere
        };
        let (i, j) = self.pair(slot);
        if self.kick.is_empty() {
            return *ends;
        }
        Ends { first: settle(ends.first, i), second: settle(ends.second, j), lead: 0.0, ..*ends }
    }
    #[inline(always)]
    fn bonded_offset(&self, slot: usize) -> Vec3<f64> {
        self.offset[slot].into()
    }
    /// The place of a pair's materials in tables.
    #[inline(always)]
    fn materials_of(&self, i: usize, j: usize) -> usize {
        usize::from(self.material[i]) * self.materials + usize::from(self.material[j])
    }
    #[inline(always)]
    fn joint(&self, i: usize, j: usize) -> &Joint<f64> {
        &self.joints[self.materials_of(i, j)]
    }
    /// The numbers of a bond at its temperature.
    #[inline(always)]
    fn numbers(&self, slot: usize) -> Bond<f64> {
        let bond = self.numbers_as_made(slot);
        let Some([stiffness, strength]) = self.factors(slot) else { return bond };
        bond.tempered(stiffness, strength)
    }
    /// Factors on stiffness and strength, if they depend on temperature.
    #[inline(always)]
    fn factors(&self, slot: usize) -> Option<[f64; 2]> {
        let Tempering { tables, temperature } = self.tempering?;
        let (i, j) = self.pair(slot);
        Some(tables.factors(self.materials_of(i, j), [temperature[i], temperature[j]]))
    }
    /// Its numbers but for the temperature.
    #[inline(always)]
    fn numbers_as_made(&self, slot: usize) -> Bond<f64> {
        let strength = self.strength[slot];
        let ((i, j), offset) = (self.pair(slot), self.bonded_offset(slot));
        if let Some(alike) = self.alike {
            return alike[self.materials_of(i, j)].with_strength_times(strength);
        }
        let length = offset.dot(offset).sqrt();
        let [first, second] = [i, j].map(|k| self.bonded_sphere(k));
        self.joint(i, j).bond_of_spheres(self.law.damping, &first, &second, length, strength)
    }
    /// The law, and what is to be remembered.
    #[inline(always)]
    fn respond(&self, slot: usize, earlier: Option<&BondHistory>) -> (BondHistory, Reaction<f64>) {
        let (ends, bond, bonded_offset) = (self.ends(slot), self.numbers(slot), self.bonded_offset(slot));
        match self.law.form {
            Form::Total => {
                let (i, j) = self.pair(slot);
                let [first_orientation, second_orientation] = [i, j].map(|k| quaternion(self.orientation[k].0));
                let free_strain = self.free_strain(slot);
                let posture = Posture { bonded_offset, first_orientation, second_orientation, free_strain };
                (BondHistory::default(), respond_total(self.law.damping, &ends, &posture, &bond))
            }
            Form::Incremental(tension) => {
                let earlier = earlier.copied().unwrap_or_default().law();
                let rest = Rest::of(bonded_offset.dot(bonded_offset).sqrt(), 0.0, 0.0);
                let advance = Advance { earlier, rest, step: self.step };
                let (history, reaction) = respond_incremental(tension, self.law.damping, &ends, &advance, &bond);
                (BondHistory::of(&history), reaction)
            }
        }
    }
    /// A particle with the radius that its bonds have.
    fn bonded_sphere(&self, i: usize) -> Sphere<f64> {
        let sphere = self.sphere(i);
        let radius = self.heat.and_then(|heat| heat.bodies.reference_radius.get(i).copied());
        Sphere { radius: radius.unwrap_or(sphere.radius), ..sphere }
    }
    /// Strain that a bond takes up without force.
    #[inline(always)]
    fn free_strain(&self, slot: usize) -> f64 {
        let Some(Warm { plan, bodies, bonds }) = self.heat else { return 0.0 };
        let (i, j) = self.pair(slot);
        let [first, second] = [i, j].map(|k| bodies.temperature[k] - plan.reference_temperature);
        link(plan, bodies, bonds, slot).free_strain(first, second)
    }
    /// Whether a bond breaks that the law says has failed: not while a fresh state is prepared.
    #[inline(always)]
    fn breaks(&self, failure: f64) -> bool {
        failure > 0.0 && self.step > 0.0
    }
}

impl Rows<'_> {
    fn open_books(&mut self) {
        self.force.fill(Quad::default());
        self.moment.fill(Quad::default());
        self.lost = vec![0.0; self.accounts.len()];
        self.taken.fill(0.0);
        self.tension.fill(0.0);
        self.energy.fill(0.0);
    }
    fn close_books(&mut self) {
        for (account, lost) in self.accounts.iter_mut().zip(&self.lost) {
            account[DAMPING] += lost;
        }
    }
    /// Adds what a bond does to the row's particle, and keeps what the other will gather. Fourth numbers are unused.
    #[inline(always)]
    fn keep(&mut self, slot: usize, i: usize, force: &[f64; 4], moments: [&[f64; 4]; 2]) {
        let mine = i - self.first;
        for k in 0..4 {
            self.force[mine].0[k] += force[k];
            self.moment[mine].0[k] += moments[0][k];
        }
        let at = REACTION * (slot - self.base);
        self.reaction[at..at + 3].copy_from_slice(&force[..3]);
        self.reaction[at + 3..at + 6].copy_from_slice(&moments[1][..3]);
    }
    /// Keeps what a bond remembers.
    #[inline(always)]
    fn remember(&mut self, slot: usize, history: BondHistory) {
        if let Some(kept) = self.history.get_mut(slot - self.base) {
            *kept = history;
        }
    }
    /// Books what the dashpots of a bond took.
    #[inline(always)]
    fn book(&mut self, slot: usize, i: usize, loss: f64) {
        self.lost[i - self.first] += loss;
        if let Some(taken) = self.taken.get_mut(slot - self.base) {
            *taken = loss;
        }
    }
    /// Notes how a bond pulls.
    #[inline(always)]
    fn note(&mut self, slot: usize, tension: f64) {
        if let Some(noted) = self.tension.get_mut(slot - self.base) {
            *noted = tension;
        }
    }
    /// Notes what its springs hold.
    #[inline(always)]
    fn note_energy(&mut self, slot: usize, energy: f64) {
        if let Some(noted) = self.energy.get_mut(slot - self.base) {
            *noted = energy;
        }
    }
    /// The bonds of these rows.
    fn slots(&self) -> std::ops::Range<usize> {
        self.base..self.base + self.reaction.len() / REACTION
    }
}

/// Bonds one by one: the plain reference. Returns those that fail.
fn rows_scalar(scene: &Scene<'_>, rows: &mut Rows<'_>) -> Vec<u32> {
    rows.open_books();
    let mut failed = Vec::new();
    for slot in rows.slots() {
        if !scene.holds[slot] {
            continue;
        }
        let (history, reaction) = scene.respond(slot, rows.history.get(slot - rows.base));
        if scene.breaks(reaction.failure) {
            failed.push(slot as u32);
            continue;
        }
        let i = scene.owner[slot] as usize;
        let [force, first, second] =
            [reaction.force, reaction.first_moment, reaction.second_moment].map(|v| Quad::new(v.into(), 0.0).0);
        rows.keep(slot, i, &force, [&first, &second]);
        rows.remember(slot, history);
        rows.note(slot, reaction.load.normal);
        if !rows.energy.is_empty() {
            rows.note_energy(slot, stored_energy(&reaction.load, &scene.numbers(slot)));
        }
        if !rows.accounts.is_empty() {
            let ends = scene.ends(slot);
            let loss = damping::loss(&ends, &scene.settled(slot, &ends), &scene.numbers(slot), scene.step);
            rows.book(slot, i, loss);
        }
    }
    rows.close_books();
    failed
}
