//! Particles as points.

use super::{Precision, Scene, field};
use crate::glossary::{PARTICLES, PARTICLES_WITH_BONDS, PARTICLES_WITH_HEAT, Place};
use crate::vtkhdf::block::{Block, Cells};
use rayon::prelude::*;
use std::sync::atomic::{AtomicI64, Ordering};
use tdem_engine::{Plan, State};

/// Where particles were when the run began.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Start {
    id: Vec<u32>,
    /// Unfolded, m.
    position: Vec<[f64; 3]>,
}

impl Start {
    pub(crate) fn of(state: &State, plan: &Plan) -> Self {
        Start {
            id: state.id.clone(),
            position: (0..state.len()).into_par_iter().map(|index| unfolded(state, plan, index)).collect(),
        }
    }

    fn position(&self, index: usize, id: u32) -> Option<[f64; 3]> {
        let index = if self.id.get(index) == Some(&id) { index } else { self.id.binary_search(&id).ok()? };
        self.position.get(index).copied()
    }
}

/// Position with all crossings of repeating faces undone, m.
fn unfolded(state: &State, plan: &Plan, index: usize) -> [f64; 3] {
    let length = plan.domain.length();
    std::array::from_fn(|k| state.position[index][k] + f64::from(state.image[index][k]) * length[k])
}

impl Scene<'_> {
    pub(super) fn particles(&self, precision: Precision) -> Block {
        let of_bonds = if self.has_bonds() { PARTICLES_WITH_BONDS } else { &[] };
        let of_heat = if self.plan.heat.is_some() { PARTICLES_WITH_HEAT } else { &[] };
        Block {
            name: Place::Particles.name(),
            points: precision.store(self.state.position.as_flattened()),
            cells: Cells::Vertices,
            point_fields: (PARTICLES.par_iter().chain(of_bonds).chain(of_heat))
                .map(|q| field(q.entry, (q.values)(self), precision))
                .collect(),
            cell_fields: Vec::new(),
            fixed: false,
        }
    }

    /// Ways from the start; not a number for a particle that was not there at the start, or without a start.
    pub(crate) fn displacement(&self) -> Vec<f64> {
        let way = |index: usize| {
            let from = self.start.and_then(|start| start.position(index, self.state.id[index]));
            let to = unfolded(self.state, self.plan, index);
            from.map_or([f64::NAN; 3], |from| std::array::from_fn(|k| to[k] - from[k]))
        };
        (0..self.state.len()).into_par_iter().map(way).collect::<Vec<_>>().into_flattened()
    }

    pub(crate) fn coordination_number(&self) -> Vec<i64> {
        let number: Vec<AtomicI64> = (0..self.state.len()).into_par_iter().map(|_| AtomicI64::new(0)).collect();
        self.state.contacts.par_iter().flat_map_iter(|contact| [contact.first, contact.second]).for_each(|id| {
            if let Some(index) = self.state.index_of(id) {
                number[index].fetch_add(1, Ordering::Relaxed);
            }
        });
        number.into_par_iter().map(AtomicI64::into_inner).collect()
    }
}
