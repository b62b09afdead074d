//! Temperatures and radii of the end of a step: a part of stage `predict`, which has the places of particles at hand.

use crate::cpu::Cpu;
use crate::cpu::bodies::Quad;
use crate::heat::book;
use crate::heat_accounts::EXPANSION;
use crate::{Fault, HeatPlan, Plan};
use tdem_physics::heat::expansion_work::half_step;
use tdem_physics::heat::warming::grown;

/// How particles become warmer in a step.
pub(in crate::cpu) struct Warming<'a> {
    heat: &'a HeatPlan,
    /// Of the heat, s.
    step: f64,
    /// Prescribed temperatures at the end of the step, K, `(exposures)`.
    prescribed: Vec<Option<f64>>,
    kept: Kept<'a>,
}

/// What stays meanwhile, of all particles, `(N)`; optional fields are empty where the plan does not need them.
pub(in crate::cpu) struct Kept<'a> {
    pub(in crate::cpu) rank: &'a [u32],
    pub(in crate::cpu) material: &'a [u16],
    pub(in crate::cpu) exposure: &'a [u16],
    /// Optional.
    pub(in crate::cpu) reference_radius: &'a [f64],
    /// Optional.
    pub(in crate::cpu) listed_radius: &'a [f64],
    /// Optional.
    pub(in crate::cpu) work_per_kelvin: &'a [f64],
}

/// A chunk of particles.
pub(in crate::cpu) struct Chunk<'a> {
    /// The first of them.
    pub(in crate::cpu) first: usize,
    pub(in crate::cpu) motion: &'a [Quad],
    pub(in crate::cpu) force: &'a [Quad],
    pub(in crate::cpu) place: &'a mut [Quad],
    pub(in crate::cpu) temperature: &'a mut [f64],
    /// Optional.
    pub(in crate::cpu) accounts: &'a mut [[f64; 4]],
    /// Optional.
    pub(in crate::cpu) warming: &'a mut [f64],
}

/// What a chunk of particles reports.
#[derive(Clone, Copy)]
pub(in crate::cpu) struct Warmed {
    /// How much a radius grew since the list was made, the most, m.
    pub(in crate::cpu) since_listed: f64,
    /// How much one shrank in this step, the most, m.
    pub(in crate::cpu) shrinkage: f64,
    /// The lowest rank whose temperature is none.
    pub(in crate::cpu) wrong: u32,
}

impl Warmed {
    pub(in crate::cpu) const NOTHING: Warmed = Warmed { since_listed: 0.0, shrinkage: 0.0, wrong: u32::MAX };
    pub(in crate::cpu) fn merge(self, other: Warmed) -> Warmed {
        Warmed {
            since_listed: self.since_listed.max(other.since_listed),
            shrinkage: self.shrinkage.max(other.shrinkage),
            wrong: self.wrong.min(other.wrong),
        }
    }
}

impl<'a> Warming<'a> {
    /// In the step that ends with this number; `None` where no heat flows.
    pub(in crate::cpu) fn of(plan: &'a Plan, step: u64, kept: Kept<'a>) -> Option<Self> {
        let heat = plan.heat.as_ref().filter(|heat| heat.flows())?;
        let time = plan.heat_time(step);
        let at_its_end = |exposure: &crate::Exposure| exposure.temperature.as_ref().map(|course| course.value(time));
        Some(Warming {
            heat,
            step: plan.heat_step(),
            prescribed: heat.exposures.iter().map(at_its_end).collect(),
            kept,
        })
    }

    /// Warms a chunk of particles, by the heat rates that stand with their forces.
    pub(in crate::cpu) fn warm(&self, chunk: Chunk<'_>) -> Warmed {
        let Chunk { first, motion, force, place, temperature, accounts, warming } = chunk;
        let Kept { rank, material, exposure, reference_radius, listed_radius, work_per_kelvin } = self.kept;
        let (heat, mut all) = (self.heat, Warmed::NOTHING);
        for k in 0..temperature.len() {
            let i = first + k;
            let (material, mass, before) = (material[i], motion[k].scalar(), temperature[k]);
            let free = heat.warmed(material, mass, before, force[k].scalar(), self.step);
            let now = self.prescribed[usize::from(exposure[i])].unwrap_or(free);
            if let Some(account) = accounts.get_mut(k) {
                book(account, heat.heat_between(material, mass, free, now));
                if let (Some(work), Some(warming)) = (work_per_kelvin.get(i), warming.get_mut(k)) {
                    *warming = now - before;
                    account[EXPANSION] += half_step(*work, *warming);
                }
            }
            temperature[k] = now;
            if let Some(&reference) = reference_radius.get(i) {
                let radius = grown(reference, heat.expansion(material), now - heat.reference_temperature);
                all.since_listed = all.since_listed.max(radius - listed_radius[i]);
                all.shrinkage = all.shrinkage.max(place[k].0[3] - radius);
                place[k].0[3] = radius;
            }
            if !(now > 0.0 && now.is_finite()) {
                all.wrong = all.wrong.min(rank[i]);
            }
        }
        all
    }
}

impl Cpu {
    /// The fault of a particle whose temperature is none.
    pub(in crate::cpu) fn unphysical(&self, rank: u32) -> Fault {
        let index = self.bodies.rank.iter().position(|&r| r == rank).unwrap_or(0);
        Fault::Temperature {
            step: self.step,
            time: self.time(),
            particle: self.ids[rank as usize],
            temperature: self.bodies.temperature[index],
        }
    }
}
