//! What contacts conduct. Temperatures are those of the end of the step, as places and radii are.

use super::Scene;
use crate::cpu::bonds::Bonds;
use crate::cpu::wide::Eight;
use crate::{HeatPlan, Plan};
use tdem_physics::contact::Touch;
use tdem_physics::heat::conduction::{between_spheres, flow, tempered};
use tdem_physics::heat::{Conductor, Path};
use tdem_physics::real::WIDTH;

/// What contacts look at through which heat flows.
#[derive(Clone, Copy)]
pub(super) struct Warm<'a> {
    heat: &'a HeatPlan,
    temperature: &'a [f64],
    /// Those beside which contacts act: where one holds, it alone conducts.
    bonds: Option<&'a Bonds>,
}

impl<'a> Warm<'a> {
    /// `None` where no contact conducts.
    pub(super) fn of(plan: &'a Plan, temperature: &'a [f64], bonds: &'a Bonds) -> Option<Self> {
        let heat = plan.heat.as_ref().filter(|heat| heat.flows() && heat.contacts != Path::Closed)?;
        let beside = plan.bonds.as_ref().is_some_and(|bonds| bonds.contact_in_bonded_pairs);
        Some(Warm { heat, temperature, bonds: Some(bonds).filter(|bonds| beside && !bonds.is_empty()) })
    }
    #[inline(always)]
    fn temperatures(&self, index: &[u32; WIDTH]) -> [f64; WIDTH] {
        let mut temperatures = [0.0; WIDTH];
        for l in 0..WIDTH {
            temperatures[l] = self.temperature[index[l] as usize];
        }
        temperatures
    }
}

impl Scene<'_> {
    /// Heat rate into the first of two particles that touch, W; 0 where no heat flows.
    pub(super) fn heat_rate(&self, i: usize, j: usize, touch: &Touch<f64>) -> f64 {
        let Some(warm) = self.warm.as_ref().filter(|warm| !self.beside_bond(warm, i, j)) else { return 0.0 };
        let [first, second] = [i, j].map(|k| self.place[k].scalar());
        let materials = [i, j].map(|k| self.material[k]);
        let temperatures = [i, j].map(|k| warm.temperature[k]);
        let conductor = warm.heat.conductor(materials[0], materials[1]);
        let conductance = between_spheres(warm.heat.contacts, conductor, first, second, touch);
        flow(warm.heat.tempered(conductance, materials, temperatures), temperatures[0], temperatures[1])
    }
    fn beside_bond(&self, warm: &Warm<'_>, i: usize, j: usize) -> bool {
        warm.bonds.is_some_and(|bonds| bonds.hold(self.rank, i, j))
    }
}

/// What contacts conduct, in lanes.
pub(super) struct WarmEights<R> {
    path: Path,
    /// What conducts, where there is one pair of materials only.
    alone: Option<Conductor<R>>,
}

impl<R: Eight> WarmEights<R> {
    /// `None` where no contact conducts.
    #[inline(always)]
    pub(super) fn new(scene: &Scene<'_>) -> Option<Self> {
        let heat = scene.warm?.heat;
        let alone = match heat.conductors[..] {
            [Conductor { conductivity, section }] => {
                Some(Conductor { conductivity: R::lit(conductivity), section: R::lit(section) })
            }
            _ => None,
        };
        Some(WarmEights { path: heat.contacts, alone })
    }

    /// Heat rates into the first particles of eight pairs that touch, W.
    #[inline(always)]
    pub(super) fn heat_rate(
        &self,
        scene: &Scene<'_>,
        [i, j]: [&[u32; WIDTH]; 2],
        touch: &Touch<R>,
        [first, second]: [R; 2],
    ) -> R {
        let Some(warm) = &scene.warm else { return R::lit(0.0) };
        let temperatures = [warm.temperatures(i), warm.temperatures(j)];
        let conductor = match self.alone {
            Some(conductor) => conductor,
            None => gather_conductors(scene, warm, i, j),
        };
        let mut conductance = between_spheres(self.path, &conductor, first, second, touch);
        if !warm.heat.tables.conductivity.is_empty() {
            let [first, second] = conductivities(scene, warm, [i, j], &temperatures);
            conductance = tempered(conductance, first, second);
        }
        let rates = flow(conductance, R::from_array(temperatures[0]), R::from_array(temperatures[1]));
        match warm.bonds {
            None => rates,
            Some(_) => R::select(open::<R>(scene, warm, i, j).gt(R::lit(0.0)), rates, R::lit(0.0)),
        }
    }
}

/// What conducts between eight pairs of several materials.
#[inline(always)]
fn gather_conductors<R: Eight>(scene: &Scene<'_>, warm: &Warm<'_>, i: &[u32; WIDTH], j: &[u32; WIDTH]) -> Conductor<R> {
    let mut parts = [[0.0; WIDTH]; 2];
    for l in 0..WIDTH {
        let of = warm.heat.conductor(scene.material[i[l] as usize], scene.material[j[l] as usize]);
        (parts[0][l], parts[1][l]) = (of.conductivity, of.section);
    }
    Conductor { conductivity: R::from_array(parts[0]), section: R::from_array(parts[1]) }
}

/// Conductivities of both particles of eight pairs at the mean of their temperatures, K, where they depend on it.
#[inline(always)]
fn conductivities<R: Eight>(
    scene: &Scene<'_>,
    warm: &Warm<'_>,
    pairs: [&[u32; WIDTH]; 2],
    temperatures: &[[f64; WIDTH]; 2],
) -> [R; 2] {
    let mut parts = [[0.0; WIDTH]; 2];
    for l in 0..WIDTH {
        let materials = [scene.material[pairs[0][l] as usize], scene.material[pairs[1][l] as usize]];
        let found = warm.heat.conductivities(materials, [temperatures[0][l], temperatures[1][l]]);
        (parts[0][l], parts[1][l]) = (found[0], found[1]);
    }
    [R::from_array(parts[0]), R::from_array(parts[1])]
}

/// 1 for each of eight pairs without a bond that holds, 0 for others.
#[inline(always)]
fn open<R: Eight>(scene: &Scene<'_>, warm: &Warm<'_>, i: &[u32; WIDTH], j: &[u32; WIDTH]) -> R {
    let mut open = [0.0; WIDTH];
    for l in 0..WIDTH {
        open[l] = f64::from(u8::from(!scene.beside_bond(warm, i[l] as usize, j[l] as usize)));
    }
    R::from_array(open)
}
