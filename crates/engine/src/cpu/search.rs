//! Stage `search`: lists neighbours anew and carries histories over.

mod carry;
mod find;
mod rows;
mod walls;

use super::bodies::Quad;
use super::grid::{Grid, class_of, extremes, strip_order};
use super::neighbours::Histories;
use super::{Cpu, List};
use crate::Fault;
use find::{Scene, find};
use rayon::prelude::*;
use rows::{ends, lay_out};
use tdem_physics::contact::Period;

/// Searches between two sorts along the space-filling curve: particles drift apart slowly.
const SEARCHES_PER_SORT: u64 = 20;

impl Cpu {
    /// Sorts particles if that is due, lists all pairs within the skin, and carries histories over.
    pub(super) fn list_anew(&mut self) -> Result<(), Fault> {
        let histories = self.neighbours.histories(&self.bodies.rank, None);
        self.list_with(&histories)
    }

    /// As [`Self::list_anew`], with the histories of a state taken up; their rows are in working order.
    pub(super) fn list_with(&mut self, histories: &Histories) -> Result<(), Fault> {
        let largest = self.bodies.place.par_iter().map(Quad::scalar).reduce(|| 0.0, f64::max);
        let skin = self.list_skin(largest);
        let reach = 2.0 * largest + skin;
        self.check_box(reach)?;
        let came_from = if self.searches.is_multiple_of(SEARCHES_PER_SORT) { self.sort(reach) } else { Vec::new() };
        self.searches += 1;

        let half = self.options.list == List::Half;
        let scene = Scene {
            place: &self.bodies.place,
            rank: &self.bodies.rank,
            largest,
            skin,
            period: Some(self.plan.domain.period()).filter(Period::any),
            width: self.options.width,
        };
        let found = find(&scene, &self.grids(largest, skin));
        let ends = ends(&found, half);
        let entries = ends.last().map_or(0, |&[rows, _]| rows);
        if entries > u64::from(u32::MAX) {
            return Err(Fault::ListOverflow { step: self.step, entries });
        }
        lay_out(&mut self.neighbours, &found, &ends, half)?;
        drop(found);
        self.carry_over(histories, &came_from);
        self.list_walls(histories, skin);
        self.search_due = false;
        Ok(())
    }

    /// Up to which gap pairs are listed. A pair that touched in the last step must be listed even if it has just parted,
    /// whatever skin was asked for: the contact stage closes its history.
    fn list_skin(&self, largest: f64) -> f64 {
        let parted = 2.000_001 * self.step_way + 1e-9 * largest;
        self.plan.search.skin.max(parted)
    }

    /// In a box that repeats, a particle must not meet two images of another.
    fn check_box(&self, reach: f64) -> Result<(), Fault> {
        let domain = &self.plan.domain;
        for (length, periodic) in domain.length().into_iter().zip(domain.periodic) {
            if periodic && length < 2.0 * reach {
                return Err(Fault::BoxTooSmall { length, reach });
            }
        }
        Ok(())
    }

    /// Puts the particles in the order of a space-filling curve, so that neighbours in space are neighbours in memory.
    /// Returns where each stood before.
    fn sort(&mut self, width: f64) -> Vec<u32> {
        let place = &self.bodies.place;
        let (min, _) = extremes(place.par_iter());
        let mut order: Vec<(u64, u32)> = place
            .par_iter()
            .zip(0..place.len() as u32)
            .map(|(p, index)| (strip_order(p, min, 1.0 / width), index))
            .collect();
        order.par_sort_unstable();
        let order: Vec<u32> = order.into_par_iter().map(|(_, index)| index).collect();
        self.bodies.reorder(&order);
        self.bonds.lay_out(&self.bodies.rank);
        order
    }

    /// One grid per size class, the largest first.
    fn grids(&self, largest: f64, skin: f64) -> Vec<Grid> {
        let place = &self.bodies.place[..];
        let class = |i: u32| class_of(place[i as usize].scalar(), largest);
        let all = 0..place.len() as u32;
        let last = all.clone().into_par_iter().map(class).max();
        let mut class_radius = largest;
        let mut grids = Vec::new();
        for level in 0..last.map_or(0, |last| last + 1) {
            let members: Vec<u32> = all.clone().into_par_iter().filter(|&i| class(i) == level).collect();
            // A hair wider than the reach, so that rounding cannot put a neighbour two cells away.
            let reach = 1.000_000_1 * (2.0 * class_radius + skin);
            let width = reach * self.options.cell_factor.max(1.0);
            grids.push(Grid::new(place, &members, width, &self.plan.domain));
            class_radius *= 0.5;
        }
        grids
    }
}
