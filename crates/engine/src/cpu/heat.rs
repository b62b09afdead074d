//! Heat: temperatures and radii of the end of a step, and the heat rates that belong to them.
//!
//! The heat rate of a particle is summed like its force: contacts with higher ids, with lower ids; then the sum of its
//! bonds from zero, in their order; then what is foreign, from zero: walls, by their indices, and its surface.

use super::bodies::{Bodies, Quad};
use super::bonds::Bonds;
use super::pieces::split;
use super::predict::optional;
use super::{CHUNK, Cpu};
use crate::heat::book;
use crate::{Exposure, Fault, HeatPlan, Plan};
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::contact::{touch_spheres, touch_wall};
use tdem_physics::heat::Link;
use tdem_physics::heat::conduction::{at_wall, between_spheres, flow};
use tdem_physics::heat::warming::grown;

/// What pairs conduct from the row's particle's side, W; room that is kept from step to step.
#[derive(Default)]
pub(super) struct Flows {
    contacts: Vec<f64>,
    bonds: Vec<f64>,
}

impl Flows {
    pub(super) fn bytes(&self) -> usize {
        std::mem::size_of_val(&self.contacts[..]) + std::mem::size_of_val(&self.bonds[..])
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
            optional(&mut bodies.heat_accounts),
        )
            .into_par_iter()
            .enumerate()
            .map(|(chunk, (temperature, place, (motion, force), (material, exposure), rank, reference, accounts))| {
                let (mut growth, mut wrong) = (Growth::default(), u32::MAX);
                for i in 0..temperature.len() {
                    let mass = motion[i].scalar();
                    let free = heat.warmed(material[i], mass, temperature[i], force[i].scalar(), step);
                    let now = prescribed[usize::from(exposure[i])].unwrap_or(free);
                    if let Some(account) = accounts.get_mut(i) {
                        book(account, heat.heat_between(material[i], mass, free, now));
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
        let n = self.bodies.len();
        let particles: Vec<usize> = (0..=n.div_ceil(CHUNK)).map(|chunk| (chunk * CHUNK).min(n)).collect();
        let law = Conduction { plan: &self.plan, heat, bodies: &self.bodies, bonds: &self.bonds };
        let list = &self.neighbours;

        flows.contacts.resize(list.other.len(), 0.0);
        let pairs: Vec<usize> = particles.iter().map(|&p| list.start[p] as usize).collect();
        let pieces: Vec<_> = split(&mut flows.contacts, &pairs).collect();
        pieces.into_par_iter().zip(particles.par_windows(2)).for_each(|(flow, chunk)| {
            let base = list.start[chunk[0]] as usize;
            for i in chunk[0]..chunk[1] {
                for pair in list.row(i) {
                    let j = list.other[pair] as usize;
                    let open = list.touching[pair] && list.bonded.get(pair) != Some(&true) && !law.beside_bond(i, j);
                    flow[pair - base] = if open { law.contact(i, j) } else { 0.0 };
                }
            }
        });
        flows.bonds.resize(self.bonds.table.len(), 0.0);
        if !self.bonds.is_empty() {
            let slots: Vec<usize> = particles.iter().map(|&p| self.bonds.start[p] as usize).collect();
            let pieces: Vec<_> = split(&mut flows.bonds, &slots).collect();
            pieces.into_par_iter().zip(particles.par_windows(2)).for_each(|(flow, chunk)| {
                let base = self.bonds.start[chunk[0]] as usize;
                for slot in base..self.bonds.start[chunk[1]] as usize {
                    flow[slot - base] = law.bond(slot);
                }
            });
        }

        let outside = outside(heat, &self.plan, self.step);
        let walls: Vec<Option<f64>> =
            heat.walls.iter().map(|w| w.as_ref().map(|w| w.value(self.plan.heat_time(self.step)))).collect();
        let books = if self.history_step > 0.0 { self.plan.heat_step() } else { 0.0 };
        // Force and accounts stand aside while the rest of the bodies is looked at.
        let mut force = std::mem::take(&mut self.bodies.force);
        let mut accounts = std::mem::take(&mut self.bodies.heat_accounts);
        let law = Conduction { plan: &self.plan, heat, bodies: &self.bodies, bonds: &self.bonds };
        let tasks = force.par_chunks_mut(CHUNK).zip(optional(&mut accounts)).enumerate();
        tasks.for_each(|(chunk, (force, accounts))| {
            for k in 0..force.len() {
                let i = chunk * CHUNK + k;
                let mut rate = list.row(i).fold(0.0, |sum, pair| sum + flows.contacts[pair]);
                rate = list.incoming(i).iter().fold(rate, |sum, &pair| sum - flows.contacts[pair as usize]);
                let first = list.wall_slots.partition_point(|slot| (slot.particle as usize) < i);
                let mut foreign = 0.0;
                for slot in list.wall_slots[first..].iter().take_while(|slot| slot.particle as usize == i) {
                    if let (true, Some(temperature)) = (slot.touching, walls[slot.wall as usize]) {
                        foreign += law.wall(i, slot.wall as usize, &self.wall_position, temperature);
                    }
                }
                if !self.bonds.is_empty() {
                    let own = self.bonds.row(i).fold(0.0, |sum, slot| sum + flows.bonds[slot]);
                    let incoming = self.bonds.incoming(i).iter();
                    rate += incoming.fold(own, |sum, &slot| sum - flows.bonds[slot as usize]);
                }
                let exposure = usize::from(law.bodies.exposure[i]);
                for ((exchange, _), &outside) in heat.exposures[exposure].exchanges.iter().zip(&outside[exposure]) {
                    foreign += exchange.heat_rate(law.bodies.temperature[i], outside);
                }
                force[k].0[3] = rate + foreign;
                if let Some(account) = accounts.get_mut(k) {
                    book(account, foreign * books);
                }
            }
        });
        (self.bodies.force, self.bodies.heat_accounts) = (force, accounts);
        self.flows = flows;
    }
}

/// The prescribed temperature of an exposure at a time.
fn value_of(exposure: &Exposure, time: f64) -> Option<f64> {
    exposure.temperature.as_ref().map(|course| course.value(time))
}

/// Outside values of the exchanges of each exposure, those of the middle of the step that follows; none where temperatures
/// are prescribed.
fn outside(heat: &HeatPlan, plan: &Plan, step: u64) -> Vec<Vec<f64>> {
    let middle = plan.heat_middle(step);
    let of_exposure = |exposure: &Exposure| match exposure.temperature {
        Some(_) => Vec::new(),
        None => exposure.exchanges.iter().map(|(_, course)| course.value(middle)).collect(),
    };
    heat.exposures.iter().map(of_exposure).collect()
}

/// What the conduction of heat looks at.
struct Conduction<'a> {
    plan: &'a Plan,
    heat: &'a HeatPlan,
    bodies: &'a Bodies,
    bonds: &'a Bonds,
}

impl Conduction<'_> {
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

/// What a bond is to heat.
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
