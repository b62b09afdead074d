//! Groups of particles that are watched: the force on them, how far they went, how far apart they are.

use crate::ledger::sum;
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
    },
    /// Between two groups.
    Between {
        /// How much farther apart their means are than at the start, along the line that joined them then, m.
        elongation: f64,
        /// That over their distance at the start.
        strain: f64,
    },
}

impl Gauge {
    /// What it shows of a state. The result has the same bits for any number of threads.
    #[must_use]
    pub fn read(&self, state: &State, plan: &Plan) -> Reading {
        match &self.measure {
            Measure::Of(group) => Reading::Of {
                force: sum(group.members.len(), |k| group.index(state, k).map_or([0.0; 3], |i| state.force[i])),
                displacement: group.displacement(state, plan).into(),
            },
            Measure::Between([first, second]) => {
                let line = Vec3::from(second.start) - first.start.into();
                let length = line.dot(line).sqrt();
                let apart = second.displacement(state, plan) - first.displacement(state, plan);
                let elongation = apart.dot(line) / length;
                Reading::Between { elongation, strain: elongation / length }
            }
        }
    }

    /// Whether its particles exist in a state.
    pub(crate) fn is_sound(&self, state: &State) -> bool {
        let sound = |group: &Group| {
            !group.members.is_empty()
                && group.members.is_sorted_by(|a, b| a < b)
                && group.members.iter().all(|&id| state.index_of(id).is_some())
        };
        match &self.measure {
            Measure::Of(group) => sound(group),
            Measure::Between(groups) => groups.iter().all(sound),
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
        let total = sum(count, |k| self.index(state, k).map_or([0.0; 3], |i| state.true_position(i, length)));
        total.map(|total| total / count as f64).into()
    }

    fn displacement(&self, state: &State, plan: &Plan) -> Vec3<f64> {
        self.mean(state, plan) - self.start.into()
    }
}
