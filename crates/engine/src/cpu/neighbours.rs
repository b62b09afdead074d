//! Who may touch whom until the next search, and what pairs remember.

use super::CHUNK;
use super::pieces::{chunks_of, split};
use crate::{HeatPlan, Plan};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};
use tdem_physics::contact::Friction;

/// The neighbour list. `P` is the number of listed pairs, `N` of particles, in working order.
///
/// The pairs of a particle stand in its row, those with higher ranks first, each part in the order of ranks: forces are
/// summed in this order. In a half list a pair stands in the row of the lower rank only, and the other particle finds it
/// through `incoming`, so that the order of the sum is the same.
#[derive(Default)]
pub(crate) struct Neighbours {
    /// Where each row starts, `(N + 1)`.
    pub(crate) start: Vec<u32>,
    /// The other particle, `(P)`.
    pub(crate) other: Vec<u32>,
    /// Whether the pair touched when it was last looked at, `(P)`.
    pub(crate) touching: Vec<bool>,
    /// Whether a bond holds between the pair, so that no contact acts, `(P)`; empty where contacts do not mind bonds.
    pub(crate) bonded: Vec<bool>,
    /// Tangential displacement as the row's particle sees it, m, `(P)`; empty without friction.
    pub(crate) displacement: Vec<[f64; 3]>,
    /// What the other particle of each pair feels, `(P, n)` with the `n` of [`reaction_numbers`]: force on the row's
    /// particle (it feels the opposite), N; with moments its own moment, N m; where contacts conduct, the heat rate into the
    /// row's particle, W. Valid where touching; empty in a full list.
    pub(crate) reaction: Vec<f64>,
    /// Where the incoming pairs of each particle start, `(N + 1)`.
    pub(crate) incoming_start: Vec<u32>,
    /// Pairs in the rows of lower ranks, in the order of those ranks; empty in a full list.
    pub(crate) incoming: Vec<u32>,
    /// Positions when the list was made, m, `(N)`.
    pub(crate) reference: Vec<[f64; 3]>,
    /// Radii when the list was made, m, `(N)`; empty where nothing expands.
    pub(crate) listed_radius: Vec<f64>,
    /// Particles that may touch walls, ascending by (particle, wall).
    pub(crate) wall_slots: Vec<WallSlot>,
    /// Where the wall slots of each chunk of particles start.
    pub(crate) wall_start: Vec<u32>,
    /// Walls when the list was made, m.
    pub(crate) wall_reference: Vec<[f64; 3]>,
}

/// A particle that may touch a wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallSlot {
    pub(crate) particle: u32,
    pub(crate) wall: u32,
    pub(crate) touching: bool,
    pub(crate) displacement: [f64; 3],
    /// Heat that they make in this step, J.
    pub(crate) made: f64,
}

/// What touching pairs remember, in a form that survives a new order of the particles.
#[derive(Default)]
pub(crate) struct Histories {
    /// Where the pairs of each row start, `(N + 1)`. Rows are those of the lower ranks.
    pub(crate) start: Vec<u32>,
    /// The higher rank, ascending in each row.
    pub(crate) second: Vec<u32>,
    /// m; empty without friction.
    pub(crate) displacement: Vec<[f64; 3]>,
    /// Particle (rank), wall and displacement, ascending.
    pub(crate) walls: Vec<(u32, u32, [f64; 3])>,
}

impl Histories {
    /// The displacement of a pair that touched, as the particle of the row sees it.
    #[inline(always)]
    pub(crate) fn of(&self, row: usize, second: u32) -> Option<[f64; 3]> {
        let row = self.start[row] as usize..self.start[row + 1] as usize;
        let found = self.second[row.clone()].iter().position(|&s| s == second)?;
        Some(self.displacement.get(row.start + found).copied().unwrap_or_default())
    }
    /// The displacement of a particle that touched a wall.
    pub(crate) fn of_wall(&self, rank: u32, wall: u32) -> Option<[f64; 3]> {
        let found = self.walls.binary_search_by_key(&(rank, wall), |&(rank, wall, _)| (rank, wall)).ok()?;
        Some(self.walls[found].2)
    }
}

impl Neighbours {
    /// The row of a particle.
    #[inline(always)]
    pub(crate) fn row(&self, particle: usize) -> std::ops::Range<usize> {
        self.start[particle] as usize..self.start[particle + 1] as usize
    }
    /// Pairs that others keep for a particle.
    #[inline(always)]
    pub(crate) fn incoming(&self, particle: usize) -> &[u32] {
        if self.incoming.is_empty() {
            return &[];
        }
        &self.incoming[self.incoming_start[particle] as usize..self.incoming_start[particle + 1] as usize]
    }
    /// Wall slots of a chunk of particles.
    pub(crate) fn walls_of(&self, chunk: usize) -> &[WallSlot] {
        &self.wall_slots[self.wall_start[chunk] as usize..self.wall_start[chunk + 1] as usize]
    }
    /// Lets contact act between two particles whose bond broke.
    pub(crate) fn release(&mut self, i: usize, j: usize) {
        for (from, to) in [(i, j), (j, i)] {
            let pair = self.row(from).find(|&pair| self.other[pair] as usize == to);
            if let Some(bonded) = pair.and_then(|pair| self.bonded.get_mut(pair)) {
                *bonded = false;
            }
        }
    }
    /// Touching pairs, seen from their lower rank: rows in the order of `by_rank`, or in working order without it; other
    /// ranks ascend in each.
    pub(crate) fn histories(&self, rank: &[u32], by_rank: Option<&[u32]>) -> Histories {
        let n = rank.len();
        let mine = |row: usize| {
            let i = by_rank.map_or(row, |by_rank| by_rank[row] as usize);
            let touching = self.row(i).filter(|&pair| self.touching[pair]);
            touching.filter(move |&pair| rank[i] < rank[self.other[pair] as usize])
        };
        let chunks = chunks_of(n);
        let count = |chunk: &[usize]| (chunk[0]..chunk[1]).map(|row| mine(row).count()).sum::<usize>();
        let counts: Vec<usize> = chunks.par_windows(2).map(count).collect();
        let mut bounds = vec![0];
        bounds.extend(counts.iter().scan(0, |end, count| {
            *end += count;
            Some(*end)
        }));
        let touching = bounds.last().copied().unwrap_or(0);
        let remembered = if self.displacement.is_empty() { 0 } else { touching };
        let (mut start, mut second) = (vec![0; n + 1], vec![0; touching]);
        let mut displacement = vec![[0.0; 3]; remembered];
        let pieces: Vec<_> = split(&mut start[1..], &chunks)
            .zip(split(&mut second, &bounds))
            .zip(split(&mut displacement, &bounds))
            .zip(chunks.windows(2).zip(&bounds))
            .collect();
        pieces.into_par_iter().for_each(|(((end, second), displacement), (chunk, &first))| {
            let mut place = 0;
            for (row, end) in (chunk[0]..chunk[1]).zip(end) {
                for pair in mine(row) {
                    second[place] = rank[self.other[pair] as usize];
                    if let Some(displacement) = displacement.get_mut(place) {
                        *displacement = self.displacement[pair];
                    }
                    place += 1;
                }
                *end = (first + place) as u32;
            }
        });
        let mut walls: Vec<_> = self
            .wall_slots
            .iter()
            .filter(|slot| slot.touching)
            .map(|slot| (rank[slot.particle as usize], slot.wall, slot.displacement))
            .collect();
        walls.sort_unstable_by_key(|&(rank, wall, _)| (rank, wall));
        Histories { start, second, displacement, walls }
    }

    /// How far a wall has moved since the list was made, the farthest, m.
    pub(crate) fn wall_way(&self, position: &[[f64; 3]]) -> f64 {
        position.iter().zip(&self.wall_reference).fold(0.0, |largest: f64, (now, then)| {
            let way: [f64; 3] = std::array::from_fn(|k| now[k] - then[k]);
            largest.max((way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt())
        })
    }
    pub(crate) fn wall_displacements(&self) -> Vec<[f64; 3]> {
        self.wall_slots.iter().map(|slot| slot.displacement).collect()
    }
    pub(crate) fn restore_wall_displacements(&mut self, displacements: &[[f64; 3]]) {
        for (slot, &displacement) in self.wall_slots.iter_mut().zip(displacements) {
            slot.displacement = displacement;
        }
    }
    /// Notes where the wall slots of each chunk of particles start.
    pub(crate) fn index_walls(&mut self, particles: usize) {
        let chunks = particles.div_ceil(CHUNK);
        self.wall_start = (0..=chunks)
            .map(|chunk| self.wall_slots.partition_point(|slot| (slot.particle as usize) < chunk * CHUNK) as u32)
            .collect();
    }

    /// Bytes of what the other particle of a pair feels.
    pub(crate) fn reaction_bytes(plan: &Plan) -> usize {
        reaction_numbers(plan) * size_of::<f64>()
    }
    /// Bytes of a half list per particle and per pair.
    pub(crate) fn bytes_each(plan: &Plan) -> [usize; 2] {
        let law = plan.law;
        let bonded = plan.bonds.as_ref().map_or(0, |bonds| usize::from(!bonds.contact_in_bonded_pairs));
        let displacement = if law.friction == Friction::Off { 0 } else { size_of::<[f64; 3]>() };
        let flags = (1 + bonded) * size_of::<bool>();
        let pair = 2 * size_of::<u32>() + flags + displacement + Self::reaction_bytes(plan);
        let listed = if plan.expands() { size_of::<f64>() } else { 0 };
        [2 * size_of::<u32>() + size_of::<[f64; 3]>() + listed, pair]
    }
    pub(crate) fn bytes(&self) -> usize {
        fn size<T>(field: &[T]) -> usize {
            std::mem::size_of_val(field)
        }
        size(&self.start)
            + size(&self.other)
            + size(&self.touching)
            + size(&self.bonded)
            + size(&self.displacement)
            + size(&self.reaction)
            + size(&self.incoming_start)
            + size(&self.incoming)
            + size(&self.reference)
            + size(&self.listed_radius)
            + size(&self.wall_slots)
            + size(&self.wall_start)
    }
}

/// Gives a field of a new list its length. What it holds then means nothing: all of it is to be written. Memory is kept,
/// so that a search need not ask for it again; where more is needed, a thirtieth more is asked for, which costs nothing
/// until it is written.
pub(crate) fn fit<T: Copy + Default>(field: &mut Vec<T>, length: usize) {
    if field.capacity() < length {
        *field = Vec::new();
        *field = vec![T::default(); length + length / 30];
    }
    field.resize(length, T::default());
}

/// Where each rank stands in working order, `(N)`.
pub(crate) fn indices_by_rank(rank: &[u32]) -> Vec<u32> {
    let index: Vec<AtomicU32> = rank.par_iter().map(|_| AtomicU32::new(0)).collect();
    rank.par_iter().enumerate().for_each(|(i, &rank)| index[rank as usize].store(i as u32, Ordering::Relaxed));
    index.into_par_iter().map(AtomicU32::into_inner).collect()
}

/// Numbers per entry of [`Neighbours::reaction`].
pub(crate) fn reaction_numbers(plan: &Plan) -> usize {
    let warm = plan.heat.as_ref().is_some_and(HeatPlan::through_contacts);
    let felt = if plan.law.moments { 6 } else { 3 };
    felt + usize::from(warm)
}
