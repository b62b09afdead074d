//! What conducts to each particle, row by row.

use super::CHUNK;
use rayon::prelude::*;
use std::ops::Range;
use tdem_physics::heat::conduction::flow;

/// Conductances between particles, or between particles and walls, `L` of them as seen from their particles.
///
/// The entries of a row stand in the order in which they are summed. Without any entry all is empty.
#[derive(Default)]
pub(super) struct Rows {
    /// Where each row starts, `(N + 1)`.
    start: Vec<usize>,
    /// The other particle, or the wall, `(L)`.
    other: Vec<u32>,
    /// W/K, `(L)`.
    conductance: Vec<f64>,
    /// The same with a conductivity of 1 W/(m K), `(L)`; empty where no conductivity depends on temperature.
    unit: Vec<f64>,
}

/// A pair of particles that conducts: indices, the lower id first, and conductance, W/K.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub(super) ends: [u32; 2],
    pub(super) conductance: f64,
}

impl Rows {
    /// Rows of pairs that ascend by their ends: each particle's own, then those in which it has the higher id.
    pub(super) fn of_pairs(particles: usize, edges: &[Edge]) -> Self {
        if edges.is_empty() {
            return Rows::default();
        }
        let mut rows = Rows::with_room(particles, edges.iter().flat_map(|edge| edge.ends));
        let mut next = rows.start.clone();
        for [mine, other] in [[0, 1], [1, 0]] {
            for edge in edges {
                rows.place(&mut next, edge.ends[mine], edge.ends[other], edge.conductance);
            }
        }
        rows
    }

    /// Rows of particles at walls: index of the particle, wall and conductance, ascending.
    pub(super) fn of_walls(particles: usize, entries: &[(u32, u32, f64)]) -> Self {
        if entries.is_empty() {
            return Rows::default();
        }
        let mut rows = Rows::with_room(particles, entries.iter().map(|entry| entry.0));
        let mut next = rows.start.clone();
        for &(particle, wall, conductance) in entries {
            rows.place(&mut next, particle, wall, conductance);
        }
        rows
    }

    /// Empty rows with room for entries of these particles.
    fn with_room(particles: usize, owners: impl Iterator<Item = u32>) -> Self {
        let mut start = vec![0; particles + 1];
        owners.for_each(|owner| start[owner as usize + 1] += 1);
        for particle in 0..particles {
            start[particle + 1] += start[particle];
        }
        let entries = start[particles];
        Rows { start, other: vec![0; entries], conductance: vec![0.0; entries], unit: Vec::new() }
    }
    fn place(&mut self, next: &mut [usize], owner: u32, other: u32, conductance: f64) {
        let place = &mut next[owner as usize];
        (self.other[*place], self.conductance[*place]) = (other, conductance);
        *place += 1;
    }

    /// Whatever conductances are now is what they are with a conductivity of 1 W/(m K).
    pub(super) fn depend_on_temperature(&mut self) {
        self.unit.clone_from(&self.conductance);
    }
    /// Conductances of the present moment, from particle, other and conductance with a conductivity of 1 W/(m K).
    pub(super) fn temper(&mut self, conductance: impl Fn(usize, usize, f64) -> f64 + Sync + Send) {
        let Rows { start, other, conductance: now, unit } = self;
        let mut rest = &mut now[..];
        let rows: Vec<_> = start.windows(2).map(|row| rest.split_off_mut(..row[1] - row[0])).collect();
        rows.into_par_iter().with_min_len(CHUNK).enumerate().for_each(|(particle, row)| {
            for (now, place) in row.into_iter().flatten().zip(start[particle]..) {
                *now = conductance(particle, other[place] as usize, unit[place]);
            }
        });
    }

    #[inline(always)]
    fn range(&self, particle: usize) -> Range<usize> {
        match self.start.get(particle..particle + 2) {
            Some(&[from, to]) => from..to,
            _ => 0..0,
        }
    }
    /// How many conduct to a particle.
    pub(super) fn count(&self, particle: usize) -> usize {
        self.range(particle).len()
    }
    #[inline(always)]
    pub(super) fn row(&self, particle: usize) -> impl Iterator<Item = (usize, f64)> {
        let range = self.range(particle);
        self.other[range.clone()].iter().map(|&other| other as usize).zip(self.conductance[range].iter().copied())
    }
    /// Sum of the heat rates into a particle of one temperature from others, W.
    #[inline(always)]
    pub(super) fn flow(&self, particle: usize, temperature: f64, others: &[f64]) -> f64 {
        self.row(particle).fold(0.0, |sum, (other, conductance)| sum + flow(conductance, temperature, others[other]))
    }
    /// Sum of the conductances of a particle, W/K.
    #[inline(always)]
    pub(super) fn sum(&self, particle: usize) -> f64 {
        self.row(particle).fold(0.0, |sum, (_, conductance)| sum + conductance)
    }
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.start[..])
            + size_of_val(&self.other[..])
            + size_of_val(&self.conductance[..])
            + size_of_val(&self.unit[..])
    }
}

/// Maps pairs to edges on all threads, in order; those that do not conduct are left out.
pub(super) fn edges<T: Sync>(pairs: &[T], edge: impl Fn(&T) -> Option<Edge> + Sync + Send) -> Vec<Edge> {
    pairs.par_iter().filter_map(edge).collect()
}
