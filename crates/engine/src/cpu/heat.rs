//! Heat: temperatures and radii of the end of a step, and the heat rates that belong to them.
//!
//! The heat rate of a particle is summed like its force, in the fourth number of which it is kept: contacts with higher ids,
//! with lower ids, in the stages contact and gather; then the sum of its bonds from zero, in their order; then what is
//! foreign, from zero: walls, by their indices, and its surface.

mod conduction;
mod warming;

pub(super) use conduction::link;
pub(super) use warming::{Chunk, Kept, Warmed, Warming};

use super::predict::optional;
use super::{CHUNK, Cpu};
use crate::heat::book;
use crate::heat_accounts::{EXPANSION, MADE};
use crate::{HeatPlan, Plan};
use conduction::{Conduction, sum_both};
use rayon::prelude::*;
use tdem_physics::heat::Outside;
use tdem_physics::heat::dissipation::heat_rate;
use tdem_physics::heat::expansion_work::half_step;

/// What pairs do to the heat of their particles; room that is kept from step to step. `P` is the number of listed pairs,
/// `B` of bonds.
#[derive(Default)]
pub(super) struct Flows {
    /// Heat rate through a bond into the row's particle, W, `(B)`.
    bonds: Vec<f64>,
    /// Heat that the two of a pair make in this step, J, `(P)`; empty where motion makes none.
    pub(super) made: Vec<f64>,
    /// What the dashpots of a bond took in this step, J, `(B)`; empty where it does not become heat.
    pub(super) bond_losses: Vec<f64>,
    /// Elastic force of a contact, N, `(P)`; empty where the ledger does not follow expansion.
    pub(super) pressure: Vec<f64>,
    /// Elastic tension of a bond, N, `(B)`; empty where the ledger does not follow expansion.
    pub(super) tension: Vec<f64>,
    /// Energy in the springs of a bond, J, `(B)`; empty likewise, and where its stiffness does not depend on temperature.
    pub(super) energy: Vec<f64>,
    /// $\partial U/\partial T$ of a bond for both of its particles, J/K, `(B)`; empty likewise.
    work: Vec<[f64; 2]>,
}

impl Flows {
    pub(super) fn bytes(&self) -> usize {
        let pairs = [&self.made, &self.pressure];
        let bonds = [&self.bonds, &self.bond_losses, &self.tension, &self.energy];
        pairs.into_iter().chain(bonds).map(|field| size_of_val(&field[..])).sum::<usize>() + size_of_val(&self.work[..])
    }
}

impl Cpu {
    /// Adds what bonds, walls and surfaces do to the heat rates of all particles at their present temperatures; those of
    /// contacts are summed already.
    pub(super) fn conduct_all(&mut self) {
        let Some(heat) = self.plan.heat.as_ref().filter(|heat| heat.flows()) else { return };
        if self.bonds.is_empty() && contacts_are_all(heat, &self.plan) {
            return;
        }
        let mut flows = std::mem::take(&mut self.flows);
        let law = Conduction { plan: &self.plan, heat, bodies: &self.bodies, bonds: &self.bonds };
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
            let mut slots = list.walls_of(chunk).iter().peekable();
            for k in 0..force.len() {
                let i = chunk * CHUNK + k;
                let mut rate = force[k].scalar();
                let at_walls = law.walls(&mut slots, i, position, &walls);
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

/// Whether nothing but contacts does anything to the heat of particles that have no bonds, and nobody follows the work of
/// their expansion.
fn contacts_are_all(heat: &HeatPlan, plan: &Plan) -> bool {
    heat.exposures.iter().all(|exposure| exposure.exchanges.is_empty())
        && heat.walls.iter().all(Option::is_none)
        && !heat.makes_heat()
        && !plan.books_expansion()
}

/// Outside values of the exchanges of each exposure, those of the middle of the step that follows; none where temperatures
/// are prescribed.
fn outside(heat: &HeatPlan, plan: &Plan, step: u64) -> Vec<Vec<Outside<f64>>> {
    let middle = plan.heat_middle(step);
    heat.exposures.iter().map(|exposure| exposure.outside(middle, middle)).collect()
}
