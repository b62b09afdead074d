//! The bonds and contacts of a state as one network that conducts heat while nothing moves.
//!
//! Particles are in the order of ids. The heat rate of a particle is summed as where heat goes along with the motion:
//! contacts with higher ids, with lower ids; then the sum of its bonds from zero, in the same order; then what is foreign,
//! from zero: walls, by their indices, and its surface.

mod field;
mod implicit;
mod processor;
mod rows;
mod surroundings;

pub(crate) use field::{Field, Stuck, is_temperature};
pub(crate) use implicit::{MOST_ITERATIONS, TOLERANCE};
pub(crate) use processor::{Processor, Tempered};
pub(crate) use surroundings::{Span, Surroundings};

use crate::{HeatPlan, Plan, State};
use rayon::prelude::*;
use rows::{Edge, Rows, edges};
use tdem_physics::Vec3;
use tdem_physics::contact::{touch_spheres, touch_wall};
use tdem_physics::heat::conduction::{at_wall, between_spheres};
use tdem_physics::heat::warming::longest_step;

/// Particles per task, and per group of a device.
pub(crate) const CHUNK: usize = 1024;

/// What conducts heat in a state. `N` is the number of particles.
#[derive(Default)]
pub(crate) struct Network {
    /// $mc$ at the temperatures at which conductances are, J/K, `(N)`.
    pub(crate) capacity: Vec<f64>,
    /// Of particles, `(N)`, where conductivities depend on temperature; else empty.
    material: Vec<u16>,
    contacts: Rows,
    bonds: Rows,
    walls: Rows,
}

/// Heat rates of all particles.
#[derive(Clone, Default)]
pub(crate) struct Rates {
    /// All together, W, `(N)`.
    pub(crate) total: Vec<f64>,
    /// From walls and through surfaces, W, `(N)`.
    pub(crate) foreign: Vec<f64>,
}

impl Rates {
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.total[..]) + size_of_val(&self.foreign[..])
    }
}

impl Network {
    /// The network of a state whose contacts are known: bonds that hold, contacts but for those beside such bonds, and walls
    /// that have a temperature.
    pub(crate) fn of(state: &State, plan: &Plan, heat: &HeatPlan) -> Self {
        let n = state.len();
        let index = |id: u32| state.index_of(id).unwrap_or(0);
        let place = |i: usize| -> Vec3<f64> { state.position[i].into() };
        let bonded = |first: u32, second: u32| {
            let found = state.bonds.binary_search_by_key(&(first, second), |bond| (bond.first, bond.second));
            found.is_ok_and(|place| state.bonds[place].holds())
        };
        let contacts = edges(&state.contacts, |contact| {
            if bonded(contact.first, contact.second) {
                return None;
            }
            let (i, j) = (index(contact.first), index(contact.second));
            let offset = plan.domain.period().nearest(place(j) - place(i));
            let (first, second) = (state.radius[i], state.radius[j]);
            let touch = touch_spheres(offset, first + second);
            if touch.overlap <= 0.0 {
                // Gear's corrector moves particles after contacts were found.
                return None;
            }
            let conductor = heat.conductor(state.material[i], state.material[j]);
            let conductance = between_spheres(heat.contacts, conductor, first, second, &touch);
            Some(Edge { ends: [i as u32, j as u32], conductance })
        });
        let bonds = edges(&state.bonds, |bond| {
            let (i, j) = (index(bond.first), index(bond.second));
            let offset = state.bonded_offset(plan, i, j);
            let link = heat.where_it_lies(state.link(plan, i, j)?, [i, j].map(|index| state.exposure[index]));
            let conductance = link.conductance(offset.dot(offset).sqrt());
            bond.holds().then_some(Edge { ends: [i as u32, j as u32], conductance })
        });
        let at_walls = state.wall_contacts.iter().filter_map(|contact| {
            let (i, wall) = (index(contact.particle), contact.wall as usize);
            heat.walls[wall].as_ref()?;
            let (described, radius) = (&plan.walls[wall], state.radius[i]);
            let touch = touch_wall(place(i), radius, state.wall_position[wall].into(), described.normal.into());
            let conductor = heat.conductor(state.material[i], described.material);
            (touch.overlap > 0.0).then(|| (i as u32, contact.wall, at_wall(heat.contacts, conductor, radius, &touch)))
        });
        let mut network = Network {
            material: if heat.tables.conductivity.is_empty() { Vec::new() } else { state.material.clone() },
            // Where it depends on temperature, it will follow.
            capacity: (0..n)
                .map(|i| heat.capacity(state.material[i], state.mass[i], heat.reference_temperature))
                .collect(),
            walls: Rows::of_walls(n, &at_walls.collect::<Vec<_>>()),
            contacts: Rows::of_pairs(n, &contacts),
            bonds: Rows::of_pairs(n, &bonds),
        };
        if !heat.tables.conductivity.is_empty() {
            let Network { contacts, bonds, walls, .. } = &mut network;
            [contacts, bonds, walls].into_iter().for_each(Rows::depend_on_temperature);
        }
        network
    }

    /// Lets conductances and capacities follow temperatures, those of walls as they are now.
    pub(crate) fn temper(&mut self, temperature: &[f64], by: &Tempered, heat: &HeatPlan, around: &Surroundings) {
        let Tempered { material, mass, wall_material } = by;
        if !heat.tables.conductivity.is_empty() {
            for rows in [&mut self.contacts, &mut self.bonds] {
                rows.temper(|i, j, unit| {
                    heat.tempered(unit, [material[i], material[j]], [temperature[i], temperature[j]])
                });
            }
            self.walls.temper(|i, wall, unit| {
                let materials = [material[i], wall_material[wall]];
                heat.tempered(unit, materials, [temperature[i], around.walls[wall]])
            });
        }
        if !heat.tables.specific_heat.is_empty() {
            self.capacity = (0..temperature.len())
                .into_par_iter()
                .with_min_len(CHUNK)
                .map(|i| heat.capacity(material[i], mass[i], temperature[i]))
                .collect();
        }
    }

    /// Heat rate into a particle through contacts and bonds, W.
    #[inline(always)]
    fn conducted(&self, particle: usize, temperature: &[f64]) -> f64 {
        let mine = temperature[particle];
        self.contacts.flow(particle, mine, temperature) + self.bonds.flow(particle, mine, temperature)
    }
    /// Heat rate into a particle from walls and through its surface, W.
    fn foreign(&self, particle: usize, temperature: f64, exposure: u16, heat: &HeatPlan, around: &Surroundings) -> f64 {
        let exposure = usize::from(exposure);
        let from_walls = self.walls.flow(particle, temperature, &around.walls);
        let exchanges = heat.exposures[exposure].exchanges.iter().zip(&around.outside[exposure]);
        let material = self.material.get(particle).copied().unwrap_or(0);
        exchanges.fold(from_walls, |sum, ((exchange, _), outside)| {
            sum + heat.exchange(exchange, material, temperature).heat_rate(temperature, outside)
        })
    }
    /// How much less comes in from walls and through the surface per kelvin of a particle, W/K.
    fn sensitivity(
        &self,
        particle: usize,
        temperature: f64,
        exposure: u16,
        heat: &HeatPlan,
        around: &Surroundings,
    ) -> f64 {
        let exposure = usize::from(exposure);
        let exchanges = heat.exposures[exposure].exchanges.iter().zip(&around.outside[exposure]);
        let material = self.material.get(particle).copied().unwrap_or(0);
        exchanges.fold(self.walls.sum(particle), |sum, ((exchange, _), outside)| {
            sum + heat.exchange(exchange, material, temperature).sensitivity(temperature, outside)
        })
    }

    /// Heat rates of all particles at their temperatures.
    pub(crate) fn rates(&self, temperature: &[f64], exposure: &[u16], heat: &HeatPlan, around: &Surroundings) -> Rates {
        let (total, foreign) = (0..temperature.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|i| {
                let foreign = self.foreign(i, temperature[i], exposure[i], heat, around);
                (self.conducted(i, temperature) + foreign, foreign)
            })
            .unzip();
        Rates { total, foreign }
    }

    /// The longest explicit step in which no particle is carried beyond its neighbours, s; those of prescribed temperature
    /// do not count.
    pub(crate) fn longest_step(
        &self,
        temperature: &[f64],
        exposure: &[u16],
        heat: &HeatPlan,
        around: &Surroundings,
    ) -> f64 {
        let of_particle = |i: usize| {
            if around.prescribed[usize::from(exposure[i])].is_some() {
                return f64::INFINITY;
            }
            let foreign = self.sensitivity(i, temperature[i], exposure[i], heat, around);
            longest_step(self.capacity[i], self.contacts.sum(i) + self.bonds.sum(i) + foreign)
        };
        (0..temperature.len()).into_par_iter().with_min_len(CHUNK).map(of_particle).reduce(|| f64::INFINITY, f64::min)
    }

    /// All that conducts to a particle: others and conductances of contacts, of bonds, walls and conductances; W/K.
    pub(crate) fn row(&self, particle: usize) -> impl Iterator<Item = (usize, f64)> {
        self.contacts.row(particle).chain(self.bonds.row(particle)).chain(self.walls.row(particle))
    }
    /// Where contacts, bonds and walls end in [`Network::row`].
    pub(crate) fn row_ends(&self, particle: usize) -> [usize; 3] {
        let contacts = self.contacts.count(particle);
        let bonds = contacts + self.bonds.count(particle);
        [contacts, bonds, bonds + self.walls.count(particle)]
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.capacity[..])
            + size_of_val(&self.material[..])
            + self.contacts.bytes()
            + self.bonds.bytes()
            + self.walls.bytes()
    }
}
