//! Heat: temperatures and radii of the end of a step, and the heat rates that belong to them.
//!
//! The heat rate of a particle is summed like its force: contacts with higher ids, with lower ids; then the sum of its
//! bonds from zero, in their order; then what is foreign, from zero: walls, by their indices, and its surface.

use super::bodies::{Bodies, Quad};
use super::bonds::Bonds;
use super::neighbours::Neighbours;
use super::pieces::split;
use super::predict::optional;
use super::{CHUNK, Cpu};
use crate::heat::book;
use crate::heat_accounts::{EXPANSION, MADE};
use crate::{Exposure, Fault, HeatPlan, Plan};
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::contact::encounter::radius_eff;
use tdem_physics::contact::{elastic_force, touch_spheres, touch_wall};
use tdem_physics::heat::conduction::{at_wall, between_spheres, flow};
use tdem_physics::heat::dissipation::heat_rate;
use tdem_physics::heat::expansion_work::{half_step, of_bond, of_contacts};
use tdem_physics::heat::warming::grown;
use tdem_physics::heat::{Link, Outside};

/// What pairs do to the heat of their particles; room that is kept from step to step. `P` is the number of listed pairs,
/// `B` of bonds.
#[derive(Default)]
pub(super) struct Flows {
    /// Heat rate into the row's particle, W, `(P)`.
    contacts: Vec<f64>,
    /// The same through bonds, W, `(B)`.
    bonds: Vec<f64>,
    /// Heat that the two of a pair make in this step, J, `(P)`; empty where motion makes none.
    pub(super) made: Vec<f64>,
    /// What the dashpots of a bond took in this step, J, `(B)`; empty where it does not become heat.
    pub(super) bond_losses: Vec<f64>,
    /// Elastic force of a contact, N, `(P)`; empty where the ledger does not follow expansion.
    pressure: Vec<f64>,
    /// Elastic tension of a bond, N, `(B)`; empty where the ledger does not follow expansion.
    pub(super) tension: Vec<f64>,
    /// Energy in the springs of a bond, J, `(B)`; empty likewise, and where its stiffness does not depend on temperature.
    pub(super) energy: Vec<f64>,
    /// $\partial U/\partial T$ of a bond for both of its particles, J/K, `(B)`; empty likewise.
    work: Vec<[f64; 2]>,
}

impl Flows {
    pub(super) fn bytes(&self) -> usize {
        let pairs = [&self.contacts, &self.made, &self.pressure];
        let bonds = [&self.bonds, &self.bond_losses, &self.tension, &self.energy];
        pairs.into_iter().chain(bonds).map(|field| size_of_val(&field[..])).sum::<usize>() + size_of_val(&self.work[..])
    }
}

/// How radii changed, the largest of all particles, m.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Growth {
    /// Growth since the list was made.
    pub(super) since_listed: f64,
    /// How much one shrank in this step.
    pub(super) shrinkage: f64,
}

impl Growth {
    fn max(self, other: Growth) -> Growth {
        Growth {
            since_listed: self.since_listed.max(other.since_listed),
            shrinkage: self.shrinkage.max(other.shrinkage),
        }
    }
}

impl Cpu {
    /// Temperatures and radii of the end of the step.
    pub(super) fn warm_all(&mut self) -> Result<Growth, Fault> {
        let Some(heat) = self.plan.heat.as_ref().filter(|heat| heat.flows()) else { return Ok(Growth::default()) };
        let (step, time) = (self.plan.heat_step(), self.plan.heat_time(self.step));
        let prescribed: Vec<Option<f64>> = heat.exposures.iter().map(|e| value_of(e, time)).collect();
        let bodies = &mut self.bodies;
        let listed = &self.neighbours.listed_radius;
        let (growth, wrong) = (
            bodies.temperature.par_chunks_mut(CHUNK),
            bodies.place.par_chunks_mut(CHUNK),
            (bodies.motion.par_chunks(CHUNK), bodies.force.par_chunks(CHUNK)),
            (bodies.material.par_chunks(CHUNK), bodies.exposure.par_chunks(CHUNK)),
            bodies.rank.par_chunks(CHUNK),
            optional(&mut bodies.reference_radius),
            (optional(&mut bodies.heat_accounts), optional(&mut bodies.work_per_kelvin), optional(&mut bodies.warming)),
        )
            .into_par_iter()
            .enumerate()
            .map(|(chunk, (temperature, place, (motion, force), (material, exposure), rank, reference, books))| {
                let (accounts, work, warming) = books;
                let (mut growth, mut wrong) = (Growth::default(), u32::MAX);
                for i in 0..temperature.len() {
                    let mass = motion[i].scalar();
                    let free = heat.warmed(material[i], mass, temperature[i], force[i].scalar(), step);
                    let now = prescribed[usize::from(exposure[i])].unwrap_or(free);
                    if let Some(account) = accounts.get_mut(i) {
                        book(account, heat.heat_between(material[i], mass, free, now));
                        if let (Some(work), Some(warming)) = (work.get(i), warming.get_mut(i)) {
                            *warming = now - temperature[i];
                            account[EXPANSION] += half_step(*work, *warming);
                        }
                    }
                    temperature[i] = now;
                    if let Some(&reference) = reference.get(i) {
                        let radius = grown(reference, heat.expansion(material[i]), now - heat.reference_temperature);
                        let one = Growth {
                            since_listed: radius - listed[chunk * CHUNK + i],
                            shrinkage: place[i].0[3] - radius,
                        };
                        growth = growth.max(one);
                        place[i].0[3] = radius;
                    }
                    if !(now > 0.0 && now.is_finite()) {
                        wrong = wrong.min(rank[i]);
                    }
                }
                (growth, wrong)
            })
            .reduce(|| (Growth::default(), u32::MAX), |a, b| (a.0.max(b.0), a.1.min(b.1)));
        if wrong == u32::MAX {
            return Ok(growth);
        }
        let index = self.bodies.rank.iter().position(|&rank| rank == wrong).unwrap_or(0);
        Err(Fault::Temperature {
            step: self.step,
            time: self.time(),
            particle: self.ids[wrong as usize],
            temperature: self.bodies.temperature[index],
        })
    }

    /// Heat rates of all particles at their present temperatures.
    pub(super) fn conduct_all(&mut self) {
        let Some(heat) = self.plan.heat.as_ref().filter(|heat| heat.flows()) else { return };
        let mut flows = std::mem::take(&mut self.flows);
        let law = Conduction { plan: &self.plan, heat, bodies: &self.bodies, bonds: &self.bonds };
        law.pairs(&self.neighbours, &mut flows);
        law.bonds(&mut flows);

        let outside = outside(heat, &self.plan, self.step);
        let walls: Vec<Option<f64>> =
            heat.walls.iter().map(|w| w.as_ref().map(|w| w.value(self.plan.heat_time(self.step)))).collect();
        let (step, advances) = (self.plan.heat_step(), self.history_step > 0.0);
        // What is written stands aside while the rest of the bodies is looked at.
        let mut force = std::mem::take(&mut self.bodies.force);
        let mut accounts = std::mem::take(&mut self.bodies.heat_accounts);
        let mut work = std::mem::take(&mut self.bodies.work_per_kelvin);
        let law = Conduction { plan: &self.plan, heat, bodies: &self.bodies, bonds: &self.bonds };
        let (list, position) = (&self.neighbours, &self.wall_position);
        let tasks = (force.par_chunks_mut(CHUNK), optional(&mut accounts), optional(&mut work)).into_par_iter();
        tasks.enumerate().for_each(|(chunk, (force, accounts, work))| {
            for k in 0..force.len() {
                let i = chunk * CHUNK + k;
                let mut rate = list.row(i).fold(0.0, |sum, pair| sum + flows.contacts[pair]);
                rate = list.incoming(i).iter().fold(rate, |sum, &pair| sum - flows.contacts[pair as usize]);
                let at_walls = law.walls(list, i, position, &walls);
                let mut foreign = at_walls.rate;
                if !self.bonds.is_empty() {
                    let own = self.bonds.row(i).fold(0.0, |sum, slot| sum + flows.bonds[slot]);
                    let incoming = self.bonds.incoming(i).iter();
                    rate += incoming.fold(own, |sum, &slot| sum - flows.bonds[slot as usize]);
                }
                let exposure = usize::from(law.bodies.exposure[i]);
                for ((exchange, _), outside) in heat.exposures[exposure].exchanges.iter().zip(&outside[exposure]) {
                    let temperature = law.bodies.temperature[i];
                    foreign +=
                        heat.exchange(exchange, law.bodies.material[i], temperature).heat_rate(temperature, outside);
                }
                force[k].0[3] = rate + foreign;
                let mut made = 0.0;
                if heat.makes_heat() {
                    made = Conduction::made(list, &flows, i) + at_walls.made + law.made_by_bonds(&flows, i);
                    force[k].0[3] += heat_rate(made, step);
                }
                if let Some(work) = work.get_mut(k) {
                    let pressure = sum_both(list, &flows.pressure, i) + at_walls.pressure;
                    *work = law.work_per_kelvin(i, pressure, &flows);
                }
                if let (true, Some(account)) = (advances, accounts.get_mut(k)) {
                    book(account, foreign * step);
                    account[MADE] += made;
                    if let (Some(work), Some(warming)) = (work.get(k), law.bodies.warming.get(i)) {
                        account[EXPANSION] += half_step(*work, *warming);
                    }
                }
            }
        });
        (self.bodies.force, self.bodies.heat_accounts, self.bodies.work_per_kelvin) = (force, accounts, work);
        self.flows = flows;
    }
}

/// Sum over the pairs of a particle of what they do to both alike; 0 if nothing is known.
fn sum_both(list: &Neighbours, of_pair: &[f64], i: usize) -> f64 {
    let value = |pair: usize| of_pair.get(pair).copied().unwrap_or(0.0);
    let own = list.row(i).fold(0.0, |sum, pair| sum + value(pair));
    list.incoming(i).iter().fold(own, |sum, &pair| sum + value(pair as usize))
}

/// The prescribed temperature of an exposure at a time.
fn value_of(exposure: &Exposure, time: f64) -> Option<f64> {
    exposure.temperature.as_ref().map(|course| course.value(time))
}

/// Outside values of the exchanges of each exposure, those of the middle of the step that follows; none where temperatures
/// are prescribed.
fn outside(heat: &HeatPlan, plan: &Plan, step: u64) -> Vec<Vec<Outside<f64>>> {
    let middle = plan.heat_middle(step);
    heat.exposures.iter().map(|exposure| exposure.outside(middle, middle)).collect()
}

/// Where chunks of particles begin, and where the last ends.
fn chunks_of(particles: usize) -> Vec<usize> {
    (0..=particles.div_ceil(CHUNK)).map(|chunk| (chunk * CHUNK).min(particles)).collect()
}

/// What the conduction of heat looks at.
struct Conduction<'a> {
    plan: &'a Plan,
    heat: &'a HeatPlan,
    bodies: &'a Bodies,
    bonds: &'a Bonds,
}

/// What walls do to a particle.
#[derive(Default)]
struct AtWalls {
    /// Heat rate into it, W.
    rate: f64,
    /// Heat that it gets from friction and dashpots, J.
    made: f64,
    /// Sum of the elastic forces, N.
    pressure: f64,
}

impl Conduction<'_> {
    /// What listed pairs conduct, and how hard they press.
    fn pairs(&self, list: &Neighbours, flows: &mut Flows) {
        let presses = self.plan.books_expansion();
        flows.contacts.resize(list.other.len(), 0.0);
        flows.pressure.resize(if presses { list.other.len() } else { 0 }, 0.0);
        let particles = chunks_of(self.bodies.len());
        let pairs: Vec<usize> = particles.iter().map(|&p| list.start[p] as usize).collect();
        let mut pressure = split(&mut flows.pressure, &pairs);
        let pieces: Vec<_> =
            split(&mut flows.contacts, &pairs).map(|flow| (flow, pressure.next().unwrap_or_default())).collect();
        pieces.into_par_iter().zip(particles.par_windows(2)).for_each(|((flow, pressure), chunk)| {
            let base = list.start[chunk[0]] as usize;
            for i in chunk[0]..chunk[1] {
                for pair in list.row(i) {
                    let j = list.other[pair] as usize;
                    let acts = list.touching[pair] && list.bonded.get(pair) != Some(&true);
                    flow[pair - base] = if acts && !self.beside_bond(i, j) { self.contact(i, j) } else { 0.0 };
                    if let Some(pressure) = pressure.get_mut(pair - base) {
                        *pressure = if acts { self.pressure(i, j) } else { 0.0 };
                    }
                }
            }
        });
    }
    /// What bonds conduct, and what their expansion does.
    fn bonds(&self, flows: &mut Flows) {
        flows.bonds.resize(self.bonds.table.len(), 0.0);
        flows.work.resize(flows.tension.len(), [0.0; 2]);
        if self.bonds.is_empty() {
            return;
        }
        let particles = chunks_of(self.bodies.len());
        let slots: Vec<usize> = particles.iter().map(|&p| self.bonds.start[p] as usize).collect();
        let mut work = split(&mut flows.work, &slots);
        let pieces: Vec<_> =
            split(&mut flows.bonds, &slots).map(|flow| (flow, work.next().unwrap_or_default())).collect();
        let (tension, energy) = (&flows.tension, &flows.energy);
        pieces.into_par_iter().zip(particles.par_windows(2)).for_each(|((flow, work), chunk)| {
            let base = self.bonds.start[chunk[0]] as usize;
            for slot in base..self.bonds.start[chunk[1]] as usize {
                flow[slot - base] = self.bond(slot);
                if let Some(work) = work.get_mut(slot - base) {
                    *work = self.work_of_bond(slot, tension[slot], energy.get(slot).copied());
                }
            }
        });
    }
    /// What walls do to a particle, by their indices.
    fn walls(&self, list: &Neighbours, i: usize, position: &[[f64; 3]], temperatures: &[Option<f64>]) -> AtWalls {
        let mut all = AtWalls::default();
        let first = list.wall_slots.partition_point(|slot| (slot.particle as usize) < i);
        let touching = list.wall_slots[first..].iter().take_while(|slot| slot.particle as usize == i);
        for slot in touching.filter(|slot| slot.touching) {
            let wall = slot.wall as usize;
            if let Some(temperature) = temperatures[wall] {
                all.rate += self.wall(i, wall, position, temperature);
            }
            // A wall that has a temperature takes its half away.
            all.made += if temperatures[wall].is_some() { 0.5 * slot.made } else { slot.made };
            if self.plan.books_expansion() {
                all.pressure += self.pressure_at_wall(i, wall, position);
            }
        }
        all
    }
    /// Heat that a particle gets from its contacts, half of what they make, J.
    fn made(list: &Neighbours, flows: &Flows, i: usize) -> f64 {
        0.5 * sum_both(list, &flows.made, i)
    }
    /// Heat that it gets from the dashpots of its bonds, J.
    fn made_by_bonds(&self, flows: &Flows, i: usize) -> f64 {
        if flows.bond_losses.is_empty() {
            return 0.0;
        }
        let half = |slot: usize| 0.5 * self.heat.dissipation.heat(0.0, flows.bond_losses[slot]);
        let own = self.bonds.row(i).fold(0.0, |sum, slot| sum + half(slot));
        self.bonds.incoming(i).iter().fold(own, |sum, &slot| sum + half(slot as usize))
    }
    /// $\partial U/\partial T$ of a particle, J/K, from the sum of the elastic forces of its contacts.
    fn work_per_kelvin(&self, i: usize, pressure: f64, flows: &Flows) -> f64 {
        let expansion = self.heat.expansion(self.bodies.material[i]);
        let reference = self.bodies.reference_radius.get(i);
        let contacts = reference.map_or(0.0, |&radius| of_contacts(pressure, expansion, radius));
        if flows.work.is_empty() {
            return contacts;
        }
        let own = self.bonds.row(i).fold(0.0, |sum, slot| sum + flows.work[slot][0]);
        contacts + self.bonds.incoming(i).iter().fold(own, |sum, &slot| sum + flows.work[slot as usize][1])
    }
    /// The same of a bond for both of its particles, from its elastic tension, and the energy in its springs if their
    /// stiffness depends on temperature.
    fn work_of_bond(&self, slot: usize, tension: f64, energy: Option<f64>) -> [f64; 2] {
        if !self.bonds.holds[slot] {
            return [0.0; 2];
        }
        let offset: Vec3<f64> = self.bonds.offset[slot].into();
        let length = offset.dot(offset).sqrt();
        let link = link(self.heat, self.bodies, self.bonds, slot);
        let work = [link.first_growth, link.second_growth].map(|growth| of_bond(growth, tension, length));
        let (Some(energy), Some(bonds)) = (energy, &self.plan.bonds) else { return work };
        let ends = [self.bonds.owner[slot], self.bonds.other[slot]].map(|k| k as usize);
        let [a, b] = ends.map(|k| usize::from(self.bodies.material[k]));
        let temperatures = ends.map(|k| self.bodies.temperature[k]);
        let softening = bonds.tables.softening(a * self.plan.materials + b, temperatures, energy);
        work.map(|work| work + softening)
    }
    /// Elastic force between two particles that touch, N.
    fn pressure(&self, i: usize, j: usize) -> f64 {
        let [first, second] = [i, j].map(|k| &self.bodies.place[k]);
        let offset = self.plan.domain.period().nearest(second.vector() - first.vector());
        let touch = touch_spheres(offset, first.scalar() + second.scalar());
        let interaction = self.plan.interaction(self.bodies.material[i], self.bodies.material[j]);
        elastic_force(radius_eff(first.scalar(), second.scalar()), touch.overlap, interaction)
    }
    /// Elastic force between a particle and a wall that it touches, N.
    fn pressure_at_wall(&self, i: usize, wall: usize, position: &[[f64; 3]]) -> f64 {
        let (place, described) = (&self.bodies.place[i], &self.plan.walls[wall]);
        let touch = touch_wall(place.vector(), place.scalar(), position[wall].into(), described.normal.into());
        elastic_force(place.scalar(), touch.overlap, self.plan.interaction(self.bodies.material[i], described.material))
    }
    /// Heat rate into the first of two particles that touch, W.
    fn contact(&self, i: usize, j: usize) -> f64 {
        let place = |k: usize| -> &Quad { &self.bodies.place[k] };
        let offset = self.plan.domain.period().nearest(place(j).vector() - place(i).vector());
        let (first, second) = (place(i).scalar(), place(j).scalar());
        let touch = touch_spheres(offset, first + second);
        let materials = [i, j].map(|k| self.bodies.material[k]);
        let conductor = self.heat.conductor(materials[0], materials[1]);
        let conductance = between_spheres(self.heat.contacts, conductor, first, second, &touch);
        self.flow(conductance, materials, [i, j].map(|k| self.bodies.temperature[k]))
    }
    /// Whether a contact acts beside a bond that holds: then the bond alone conducts.
    fn beside_bond(&self, i: usize, j: usize) -> bool {
        let beside = self.plan.bonds.as_ref().is_some_and(|bonds| bonds.contact_in_bonded_pairs);
        beside && !self.bonds.is_empty() && self.bonds.hold(&self.bodies.rank, i, j)
    }
    /// Heat rate from a wall into a particle that touches it, W.
    fn wall(&self, i: usize, wall: usize, position: &[[f64; 3]], temperature: f64) -> f64 {
        let place = &self.bodies.place[i];
        let described = &self.plan.walls[wall];
        let touch = touch_wall(place.vector(), place.scalar(), position[wall].into(), described.normal.into());
        let materials = [self.bodies.material[i], described.material];
        let conductor = self.heat.conductor(materials[0], materials[1]);
        let conductance = at_wall(self.heat.contacts, conductor, place.scalar(), &touch);
        self.flow(conductance, materials, [self.bodies.temperature[i], temperature])
    }
    /// Heat rate into the row's particle through a bond, W.
    fn bond(&self, slot: usize) -> f64 {
        if !self.bonds.holds[slot] {
            return 0.0;
        }
        let (i, j) = (self.bonds.owner[slot] as usize, self.bonds.other[slot] as usize);
        let offset: Vec3<f64> = self.bonds.offset[slot].into();
        let link = link(self.heat, self.bodies, self.bonds, slot);
        let within = self.heat.at_one_side([i, j].map(|index| self.bodies.exposure[index]));
        let link = if within { link.within_side() } else { link };
        let (materials, temperatures) =
            ([i, j].map(|k| self.bodies.material[k]), [i, j].map(|k| self.bodies.temperature[k]));
        self.flow(link.conductance(offset.dot(offset).sqrt()), materials, temperatures)
    }
    /// Heat rate into the first of two, whose conductance follows their temperatures where conductivities do, W.
    #[inline(always)]
    fn flow(&self, conductance: f64, materials: [u16; 2], temperatures: [f64; 2]) -> f64 {
        flow(self.heat.tempered(conductance, materials, temperatures), temperatures[0], temperatures[1])
    }
}

/// What a bond is to heat, wherever its particles lie.
#[inline(always)]
pub(super) fn link(heat: &HeatPlan, bodies: &Bodies, bonds: &Bonds, slot: usize) -> Link<f64> {
    let (i, j) = (bonds.owner[slot] as usize, bonds.other[slot] as usize);
    let [a, b] = [i, j].map(|k| bodies.material[k]);
    if let Some(alike) = &bonds.links {
        return alike[usize::from(a) * heat.materials.len() + usize::from(b)];
    }
    let radii = [i, j].map(|k| bodies.reference_radius.get(k).copied().unwrap_or_else(|| bodies.place[k].scalar()));
    heat.link([a, b], radii)
}
