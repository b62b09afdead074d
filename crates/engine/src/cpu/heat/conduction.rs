//! What walls and bonds do to the heat of particles, and what expansion does to springs.

use super::Flows;
use crate::cpu::bodies::Bodies;
use crate::cpu::bonds::Bonds;
use crate::cpu::neighbours::{Neighbours, WallSlot};
use crate::cpu::pieces::{chunks_of, split};
use crate::{HeatPlan, Plan};
use rayon::prelude::*;
use std::iter::Peekable;
use std::slice::Iter;
use tdem_physics::Vec3;
use tdem_physics::contact::{Touch, elastic_force, touch_wall};
use tdem_physics::heat::Link;
use tdem_physics::heat::conduction::{at_wall, flow};
use tdem_physics::heat::expansion_work::{of_bond, of_contacts};

/// What the conduction of heat looks at.
pub(super) struct Conduction<'a> {
    pub(super) plan: &'a Plan,
    pub(super) heat: &'a HeatPlan,
    pub(super) bodies: &'a Bodies,
    pub(super) bonds: &'a Bonds,
}

/// What walls do to a particle.
#[derive(Default)]
pub(super) struct AtWalls {
    /// Heat rate into it, W.
    pub(super) rate: f64,
    /// Heat that it gets from friction and dashpots, J.
    pub(super) made: f64,
    /// Sum of the elastic forces, N.
    pub(super) pressure: f64,
}

impl Conduction<'_> {
    /// What bonds conduct, and what their expansion does.
    pub(super) fn bonds(&self, flows: &mut Flows) {
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
    /// What walls do to a particle, by their indices. `slots` are those from this particle on.
    pub(super) fn walls(
        &self,
        slots: &mut Peekable<Iter<'_, WallSlot>>,
        i: usize,
        position: &[[f64; 3]],
        temperatures: &[Option<f64>],
    ) -> AtWalls {
        let (mut all, follows) = (AtWalls::default(), self.plan.books_expansion());
        while let Some(slot) = slots.next_if(|slot| slot.particle as usize == i) {
            if !slot.touching {
                continue;
            }
            let wall = slot.wall as usize;
            let touch = self.touch_of_wall(i, wall, position);
            if let Some(temperature) = temperatures[wall] {
                all.rate += self.wall(i, wall, &touch, temperature);
            }
            // A wall that has a temperature takes its half away.
            all.made += if temperatures[wall].is_some() { 0.5 * slot.made } else { slot.made };
            if !follows {
                continue;
            }
            let interaction = self.plan.interaction(self.bodies.material[i], self.plan.walls[wall].material);
            all.pressure += elastic_force(self.bodies.place[i].scalar(), touch.overlap, interaction);
        }
        all
    }
    /// Heat that a particle gets from its contacts, half of what they make, J.
    pub(super) fn made(list: &Neighbours, flows: &Flows, i: usize) -> f64 {
        0.5 * sum_both(list, &flows.made, i)
    }
    /// Heat that it gets from the dashpots of its bonds, J.
    pub(super) fn made_by_bonds(&self, flows: &Flows, i: usize) -> f64 {
        if flows.bond_losses.is_empty() {
            return 0.0;
        }
        let half = |slot: usize| 0.5 * self.heat.dissipation.heat(0.0, flows.bond_losses[slot]);
        let own = self.bonds.row(i).fold(0.0, |sum, slot| sum + half(slot));
        self.bonds.incoming(i).iter().fold(own, |sum, &slot| sum + half(slot as usize))
    }
    /// $\partial U/\partial T$ of a particle, J/K, from the sum of the elastic forces of its contacts.
    pub(super) fn work_per_kelvin(&self, i: usize, pressure: f64, flows: &Flows) -> f64 {
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
    /// How a particle lies to a wall.
    fn touch_of_wall(&self, i: usize, wall: usize, position: &[[f64; 3]]) -> Touch<f64> {
        let (place, normal) = (&self.bodies.place[i], self.plan.walls[wall].normal.into());
        touch_wall(place.vector(), place.scalar(), position[wall].into(), normal)
    }
    /// Heat rate from a wall of a temperature, K, into a particle that touches it, W.
    fn wall(&self, i: usize, wall: usize, touch: &Touch<f64>, temperature: f64) -> f64 {
        let materials = [self.bodies.material[i], self.plan.walls[wall].material];
        let conductor = self.heat.conductor(materials[0], materials[1]);
        let conductance = at_wall(self.heat.contacts, conductor, self.bodies.place[i].scalar(), touch);
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
        let link = self.heat.where_it_lies(link, [i, j].map(|k| self.bodies.exposure[k]));
        let materials = [i, j].map(|k| self.bodies.material[k]);
        let temperatures = [i, j].map(|k| self.bodies.temperature[k]);
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
pub(in crate::cpu) fn link(heat: &HeatPlan, bodies: &Bodies, bonds: &Bonds, slot: usize) -> Link<f64> {
    let (i, j) = (bonds.owner[slot] as usize, bonds.other[slot] as usize);
    let [a, b] = [i, j].map(|k| bodies.material[k]);
    if let Some(alike) = &bonds.links {
        return alike[usize::from(a) * heat.materials.len() + usize::from(b)];
    }
    let radii = [i, j].map(|k| bodies.reference_radius.get(k).copied().unwrap_or_else(|| bodies.place[k].scalar()));
    heat.link([a, b], radii)
}

/// Sum over the pairs of a particle of what they do to both alike; 0 if nothing is known.
pub(super) fn sum_both(list: &Neighbours, of_pair: &[f64], i: usize) -> f64 {
    let value = |pair: usize| of_pair.get(pair).copied().unwrap_or(0.0);
    let own = list.row(i).fold(0.0, |sum, pair| sum + value(pair));
    list.incoming(i).iter().fold(own, |sum, &pair| sum + value(pair as usize))
}
