//! Groups of particles that are watched: the force on them, how far they went, how far apart they are, how warm they and
//! their surfaces are.

use crate::exact::exact_sums;
use crate::{Plan, State};
use std::sync::Arc;
use tdem_physics::Vec3;

/// A group or two of which something is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauge {
    /// Its name in the case and in what is written.
    pub name: String,
    /// What is measured.
    pub measure: Measure,
}

/// What a gauge measures.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// Force on a group, and its displacement.
    Of(Group),
    /// How far two groups move apart.
    Between([Group; 2]),
    /// Temperature of a surface, and the heat through it.
    Surface(Surface),
}

/// A surface that is watched.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Ids of its particles, ascending, at least one.
    pub members: Arc<[u32]>,
    /// What of each exposure of the plan belongs to it, `(exposures)`; `None` where nothing does.
    pub parts: Vec<Option<Part>>,
}

/// What of an exposure belongs to a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The particles themselves are held at its temperature.
    Held,
    /// One of the exchanges.
    Exchange(usize),
}

/// Particles that are watched together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Their ids, ascending, at least one.
    pub members: Arc<[u32]>,
    /// Mean of their places at the start of the run, true ones where the domain repeats, m.
    pub start: [f64; 3],
}

/// What a gauge shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Of a group.
    Of {
        /// What contacts, bonds, gravity and applied forces, less local damping, exert on the group, N. Where the group is
        /// held or driven, the support exerts the opposite, but for what accelerates the group.
        force: [f64; 3],
        /// Mean displacement since the start of the run, m.
        displacement: [f64; 3],
        /// Mean temperature, K; `None` without heat.
        temperature: Option<f64>,
    },
    /// Between two groups.
    Between {
        /// How much farther apart their means are than at the start, along the line that joined them then, m.
        elongation: f64,
        /// That over their distance at the start.
        strain: f64,
    },
    /// Of a surface.
    Surface {
        /// Mean temperature of the surface itself, K.
        temperature: f64,
        /// Heat that enters through it, W. Where particles are held at its temperature, it is what they conduct away.
        heat_rate: f64,
    },
}

impl Gauge {
    /// What it shows of a state. Sums over particles are exact.
    #[must_use]
    pub fn read(&self, state: &State, plan: &Plan) -> Reading {
        match &self.measure {
            Measure::Of(group) => Reading::Of {
                force: exact_sums(group.members.len(), |k| group.index(state, k).map_or([0.0; 3], |i| state.force[i])),
                displacement: group.displacement(state, plan).into(),
                temperature: plan.heat.is_some().then(|| group.temperature(state)),
            },
            Measure::Between([first, second]) => {
                let line = Vec3::from(second.start) - first.start.into();
                let length = line.dot(line).sqrt();
                let apart = second.displacement(state, plan) - first.displacement(state, plan);
                let elongation = apart.dot(line) / length;
                Reading::Between { elongation, strain: elongation / length }
            }
            Measure::Surface(surface) => {
                let count = surface.members.len();
                let [temperature, heat_rate] = exact_sums(count, |k| surface.of_member(state, plan, k));
                Reading::Surface { temperature: temperature / count as f64, heat_rate }
            }
        }
    }

    /// Whether its particles exist in a state.
    pub(crate) fn is_sound(&self, state: &State) -> bool {
        let named = |members: &[u32]| {
            !members.is_empty()
                && members.is_sorted_by(|a, b| a < b)
                && members.iter().all(|&id| state.index_of(id).is_some())
        };
        let sound = |group: &Group| named(&group.members);
        match &self.measure {
            Measure::Of(group) => sound(group),
            Measure::Between(groups) => groups.iter().all(sound),
            Measure::Surface(surface) => named(&surface.members),
        }
    }
}

impl Group {
    /// A group of particles of a state that is the start of a run.
    #[must_use]
    pub fn at_start(members: Arc<[u32]>, state: &State, plan: &Plan) -> Self {
        let mut group = Group { members, start: [0.0; 3] };
        group.start = group.mean(state, plan).into();
        group
    }

    fn index(&self, state: &State, member: usize) -> Option<usize> {
        state.index_of(self.members[member])
    }

    /// Mean of the true places, m.
    fn mean(&self, state: &State, plan: &Plan) -> Vec3<f64> {
        let length = plan.domain.length();
        let count = self.members.len();
        let total = exact_sums(count, |k| self.index(state, k).map_or([0.0; 3], |i| state.true_position(i, length)));
        total.map(|total| total / count as f64).into()
    }

    /// Mean temperature, K.
    fn temperature(&self, state: &State) -> f64 {
        let count = self.members.len();
        let [total] = exact_sums(count, |k| self.index(state, k).map_or([0.0], |i| [state.temperature[i]]));
        total / count as f64
    }

    fn displacement(&self, state: &State, plan: &Plan) -> Vec3<f64> {
        self.mean(state, plan) - self.start.into()
    }
}

impl Surface {
    /// Temperature of the surface at one of its particles, K, and the heat that enters there, W.
    fn of_member(&self, state: &State, plan: &Plan, member: usize) -> [f64; 2] {
        let found = state.index_of(self.members[member]).zip(plan.heat.as_ref());
        let Some((i, heat)) = found else { return [0.0; 2] };
        let (temperature, exposure) = (state.temperature[i], usize::from(state.exposure[i]));
        let Some(part) = self.parts.get(exposure).and_then(Option::as_ref) else { return [temperature, 0.0] };
        let of = &heat.exposures[exposure];
        match part {
            Part::Held => [temperature, -state.heat_rate[i]],
            // Who is held exchanges nothing else.
            Part::Exchange(_) if of.temperature.is_some() => [temperature, 0.0],
            Part::Exchange(place) => {
                let (exchange, around) = &of.exchanges[*place];
                let exchange = heat.exchange(exchange, state.material[i], temperature);
                let now = plan.heat_time(state.step);
                let rate = exchange.heat_rate(temperature, &around.at(now, now));
                [temperature + rate * exchange.resistance, rate]
            }
        }
    }
}
