//! How large a step of the heat may be.

use super::super::bonds::Bonded;
use rayon::prelude::*;
use tdem_engine::physics::contact::touch_spheres;
use tdem_engine::physics::heat::conduction::{WITHIN_SIDE, bar, between_spheres, pair_conductivity};
use tdem_engine::physics::heat::warming::longest_step;
use tdem_engine::physics::heat::{Conductor, Outside, Path};
use tdem_engine::physics::vec3;
use tdem_engine::{Domain, HeatPlan, State};

/// Others that a particle may touch.
const CONTACTS: f64 = 12.0;
/// Overlap at which contacts are taken to conduct, as a fraction of the radius.
const OVERLAP: f64 = 0.01;

/// What the step limits need to know of heat: the extremes over all particles, in time of the heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Warming {
    /// Up to this step temperatures follow without oscillation, s: $\min mc/\sum H$ (Gershgorin), with the least $c$ and the
    /// largest $\lambda$ at any temperature.
    pub(crate) safe_step: f64,
    /// Beyond this one particle alone swings ever wider, s: twice that, of bonds and surfaces alone, with the largest $c$ and
    /// the least $\lambda$.
    pub(crate) certain_step: f64,
    /// The particle that sets the first.
    pub(crate) particle: usize,
}

impl Warming {
    const NONE: Warming = Warming { safe_step: f64::INFINITY, certain_step: f64::INFINITY, particle: usize::MAX };

    /// The smallest over all particles; `plan` is the heat of the plan that they will follow.
    pub(in crate::build) fn of(plan: &HeatPlan, bonded: Option<&Bonded>, domain: &Domain, state: &State) -> Warming {
        let mut conductance = vec![[0.0; 2]; state.len()];
        let mut bonds = vec![0.0; state.len()];
        if let Some(bonded) = bonded {
            for (pair, length) in bonded.lengths(domain, state) {
                let radius_sum = state.radius[pair[0]] + state.radius[pair[1]];
                let [a, b] = pair.map(|index| state.material[index]);
                let within = plan.at_one_side(pair.map(|index| state.exposure[index]));
                let through = bar(plan.conductor(a, b), radius_sum, length) * if within { WITHIN_SIDE } else { 1.0 };
                let range = conductivities(plan, a, b);
                for index in pair {
                    (0..2).for_each(|k| conductance[index][k] += through * range[k]);
                    bonds[index] += 1.0;
                }
            }
        }
        (0..state.len())
            .into_par_iter()
            .map(|k| {
                let material = state.material[k];
                let [least, largest] =
                    specific_heats(plan, material).map(|specific_heat| state.mass[k] * specific_heat);
                let through_surface = surface(plan, material, state.exposure[k]);
                let certain = conductance[k][0] + through_surface[0];
                let contact = touching(plan.contacts, plan.conductor(material, material), state.radius[k])
                    * conductivities(plan, material, material)[1];
                let all = conductance[k][1] + through_surface[1] + (CONTACTS - bonds[k]).max(0.0) * contact;
                // What is held at a temperature has no limit of its own.
                if plan.exposures[usize::from(state.exposure[k])].temperature.is_some() {
                    return Warming::NONE;
                }
                let (safe_step, certain_step) = (longest_step(least, all), 2.0 * longest_step(largest, certain));
                Warming { safe_step, certain_step, particle: k }
            })
            .reduce(
                || Warming::NONE,
                |a, b| {
                    let first = (b.safe_step, b.particle) < (a.safe_step, a.particle);
                    let (safe_step, particle) =
                        if first { (b.safe_step, b.particle) } else { (a.safe_step, a.particle) };
                    Warming { safe_step, particle, certain_step: a.certain_step.min(b.certain_step) }
                },
            )
    }
}

/// By what the conductance of a pair of materials in the plan is multiplied at least and at most, whatever its temperature.
fn conductivities(plan: &HeatPlan, first: u16, second: u16) -> [f64; 2] {
    let tables = &plan.tables.conductivity;
    if tables.is_empty() {
        return [1.0; 2];
    }
    let [a, b] = [first, second].map(|material| &tables[usize::from(material)]);
    [pair_conductivity(a.least(), b.least()), pair_conductivity(a.largest(), b.largest())]
}

/// The least and the largest specific heat of a material, J/(kg K).
fn specific_heats(plan: &HeatPlan, material: u16) -> [f64; 2] {
    let constant = [plan.materials[usize::from(material)].specific_heat; 2];
    let table = plan.tables.specific_heat.get(usize::from(material));
    table.map_or(constant, |table| [table.least(), table.largest()])
}

/// Conductance of a contact of two alike, W/K: an estimate.
fn touching(path: Path, conductor: &Conductor<f64>, radius: f64) -> f64 {
    let touch = touch_spheres(vec3((2.0 - OVERLAP) * radius, 0.0, 0.0), 2.0 * radius);
    between_spheres(path, conductor, radius, radius, &touch)
}

/// What surfaces of a material conduct at least and at most, W/K; radiation at its hottest.
fn surface(plan: &HeatPlan, material: u16, exposure: u16) -> [f64; 2] {
    let of = &plan.exposures[usize::from(exposure)];
    let table = plan.tables.conductivity.get(usize::from(material));
    let conductivities = table.map(|table| [table.least(), table.largest()]);
    let each = |k: usize| {
        let sensitivity = of.exchanges.iter().map(|(exchange, around)| {
            let values = around.temperatures().flat_map(|course| &course.0).map(|point| point[1]);
            let hottest = values.fold(plan.reference_temperature, f64::max);
            let exchange = conductivities.map_or(*exchange, |of| exchange.tempered(of[k]));
            exchange.sensitivity(hottest, &Outside { flux: 0.0, fluid: hottest, surroundings: hottest })
        });
        sensitivity.sum()
    };
    [each(0), each(1)]
}
