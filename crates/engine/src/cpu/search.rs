//! Stage `search`: lists neighbours anew and carries histories over.

use super::bodies::Quad;
use super::grid::{Grid, class_of, strip_order};
use super::neighbours::{Histories, Neighbours, Reactions, WallSlot};
use super::pieces::split;
use super::{CHUNK, Cpu, List};
use crate::Fault;
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::contact::{Friction, Period, touch_wall};

/// Searches between two sorts along the space-filling curve: particles drift apart slowly.
const SEARCHES_PER_SORT: u64 = 20;

/// Rows of a range of particles, and pairs found from the side of the other particle.
#[derive(Default)]
struct Found {
    /// Entries of each row.
    count: Vec<u32>,
    /// The others, row after row.
    other: Vec<u32>,
    /// (row, other) of pairs that belong to rows elsewhere.
    strays: Vec<(u32, u32)>,
}

impl Cpu {
    /// Sorts particles if that is due, lists all pairs within the skin, and carries histories over.
    pub(super) fn list_anew(&mut self) -> Result<(), Fault> {
        let histories = self.neighbours.histories(&self.bodies.rank);
        self.list_with(&histories)
    }

    /// As [`Self::list_anew`], with the histories of a state taken up.
    pub(super) fn list_with(&mut self, histories: &Histories) -> Result<(), Fault> {
        self.neighbours = Neighbours::default();
        let largest = self.bodies.place.iter().fold(0.0, |largest: f64, p| largest.max(p.scalar()));
        let skin = self.list_skin(largest);
        let reach = 2.0 * largest + skin;
        self.check_box(reach)?;
        if self.searches.is_multiple_of(SEARCHES_PER_SORT) {
            self.sort(reach);
        }
        self.searches += 1;

        let grids = self.grids(largest, skin);
        let found = self.find(&grids, largest, skin);
        let entries = found.iter().map(|f| (f.other.len() + f.strays.len()) as u64).sum();
        if entries > u64::from(u32::MAX) {
            return Err(Fault::ListOverflow { step: self.step, entries });
        }
        let (start, other) = rows(&found, &self.bodies.rank);
        let incoming = if self.options.list == List::Half {
            incoming(&start, &other, &self.bodies.rank)
        } else {
            (Vec::new(), Vec::new())
        };
        self.fill(start, other, incoming, histories);
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
    fn sort(&mut self, width: f64) {
        let place = &self.bodies.place;
        let min: [f64; 3] = std::array::from_fn(|k| place.iter().fold(f64::INFINITY, |least, p| least.min(p.0[k])));
        let mut order: Vec<(u64, u32)> = place
            .par_iter()
            .zip(0..place.len() as u32)
            .map(|(p, index)| (strip_order(p, min, 1.0 / width), index))
            .collect();
        order.par_sort_unstable();
        let order: Vec<u32> = order.into_iter().map(|(_, index)| index).collect();
        self.bodies.reorder(&order);
        self.bonds.lay_out(&self.bodies.rank);
    }

    /// One grid per size class, the largest first.
    fn grids(&self, largest: f64, skin: f64) -> Vec<Grid> {
        let place = &self.bodies.place;
        let mut members: Vec<Vec<u32>> = Vec::new();
        for (index, place) in place.iter().enumerate() {
            let class = class_of(place.scalar(), largest);
            if members.len() <= class {
                members.resize_with(class + 1, Vec::new);
            }
            members[class].push(index as u32);
        }
        let mut class_radius = largest;
        let mut grids = Vec::new();
        for members in &members {
            // A hair wider than the reach, so that rounding cannot put a neighbour two cells away.
            let reach = 1.000_000_1 * (2.0 * class_radius + skin);
            let width = reach * self.options.cell_factor.max(1.0);
            grids.push(Grid::new(place, members, width, &self.plan.domain));
            class_radius *= 0.5;
        }
        grids
    }

    /// All pairs within the skin. A particle looks for its own class and for larger ones; the larger one's row gets what
    /// belongs there as a stray.
    fn find(&self, grids: &[Grid], largest: f64, skin: f64) -> Vec<Found> {
        let bodies = &self.bodies;
        let (place, rank) = (&bodies.place[..], &bodies.rank[..]);
        let half = self.options.list == List::Half;
        let period = self.plan.domain.period();
        let wraps = period.any();
        (0..bodies.len().div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut found = Found::default();
                for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(bodies.len()) {
                    let before = found.other.len();
                    let class = class_of(place[i].scalar(), largest);
                    for (level, grid) in grids.iter().enumerate().take(class + 1) {
                        grid.around(&place[i], |members| {
                            for &j in members {
                                let other = j as usize;
                                if other == i || (half && level == class && rank[i] > rank[other]) {
                                    continue;
                                }
                                if !near(&place[i], &place[other], skin, wraps.then_some(&period)) {
                                    continue;
                                }
                                let mine = !half || rank[i] < rank[other];
                                if mine {
                                    found.other.push(j);
                                }
                                if !mine || (!half && level < class) {
                                    found.strays.push((j, i as u32));
                                }
                            }
                        });
                    }
                    found.other[before..].sort_unstable_by_key(|&j| row_order(rank[i], rank[j as usize]));
                    found.count.push((found.other.len() - before) as u32);
                }
                found
            })
            .collect()
    }

    /// Lays the list out and fills in what touching pairs remember.
    fn fill(&mut self, start: Vec<u32>, other: Vec<u32>, incoming: (Vec<u32>, Vec<u32>), histories: &Histories) {
        let pairs = other.len();
        let law = self.plan.law;
        let mut touching = vec![false; pairs];
        let apart = self.plan.bonds.as_ref().is_some_and(|bonds| !bonds.contact_in_bonded_pairs);
        let mut bonded = vec![false; if apart && !self.bonds.is_empty() { pairs } else { 0 }];
        let mut displacement = if law.friction == Friction::Off { Vec::new() } else { vec![[0.0; 3]; pairs] };
        let (bodies, bonds) = (&self.bodies, &self.bonds);
        let rank = &bodies.rank[..];
        let bounds: Vec<usize> =
            (0..=bodies.len().div_ceil(CHUNK)).map(|chunk| start[(chunk * CHUNK).min(bodies.len())] as usize).collect();
        let tasks: Vec<_> = split(&mut touching, &bounds)
            .zip(split(&mut displacement, &bounds))
            .zip(split(&mut bonded, &bounds))
            .collect();
        tasks.into_par_iter().enumerate().for_each(|(chunk, ((touching, displacement), bonded))| {
            let base = bounds[chunk];
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(rank.len()) {
                for pair in start[i] as usize..start[i + 1] as usize {
                    if let Some(bonded) = bonded.get_mut(pair - base) {
                        *bonded = bonds.hold(rank, i, other[pair] as usize);
                        if *bonded {
                            continue;
                        }
                    }
                    if let Some(kept) = histories.of(rank[i], rank[other[pair] as usize]) {
                        touching[pair - base] = true;
                        if let Some(slot) = displacement.get_mut(pair - base) {
                            *slot = kept;
                        }
                    }
                }
            }
        });
        let (incoming_start, incoming) = incoming;
        self.neighbours = Neighbours {
            start,
            other,
            touching,
            bonded,
            displacement,
            reaction: if self.options.list == List::Half { Reactions::new(pairs, law) } else { Reactions::default() },
            incoming_start,
            incoming,
            listed_radius: if self.plan.expands() {
                bodies.place.par_iter().map(Quad::scalar).collect()
            } else {
                Vec::new()
            },
            reference: bodies.place.par_iter().map(|p| p.vector().into()).collect(),
            ..Neighbours::default()
        };
    }

    /// Lists particles within the skin of walls.
    fn list_walls(&mut self, histories: &Histories, skin: f64) {
        let bodies = &self.bodies;
        let (walls, position) = (&self.plan.walls, &self.wall_position);
        let slots: Vec<WallSlot> = (0..bodies.len())
            .into_par_iter()
            .flat_map_iter(|i| {
                walls.iter().zip(position).enumerate().filter_map(move |(wall, (plan, &point))| {
                    let place = &bodies.place[i];
                    let touch = touch_wall(place.vector(), place.scalar(), point.into(), plan.normal.into());
                    (touch.overlap > -skin).then(|| {
                        let kept = histories.of_wall(bodies.rank[i], wall as u32);
                        WallSlot {
                            particle: i as u32,
                            wall: wall as u32,
                            touching: kept.is_some(),
                            displacement: kept.unwrap_or_default(),
                            made: 0.0,
                        }
                    })
                })
            })
            .collect();
        self.neighbours.wall_slots = slots;
        self.neighbours.wall_reference.clone_from(&self.wall_position);
        self.neighbours.index_walls(bodies.len());
    }
}

/// Whether two particles are within the skin of each other.
#[inline(always)]
fn near(a: &Quad, b: &Quad, skin: f64, period: Option<&Period<f64>>) -> bool {
    let offset = b.vector() - a.vector();
    let offset: Vec3<f64> = period.map_or(offset, |p| p.nearest(offset));
    let reach = a.scalar() + b.scalar() + skin;
    offset.dot(offset) < reach * reach
}

/// Higher ranks come first, then lower ones, each in order: what a row's particle sums while contacts are evaluated
/// comes before what it gathers from others.
#[inline(always)]
fn row_order(mine: u32, other: u32) -> (bool, u32) {
    (other < mine, other)
}

/// Joins what the chunks found into rows.
fn rows(found: &[Found], rank: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let n = rank.len();
    let mut start = vec![0_u32; n + 1];
    for (i, count) in found.iter().flat_map(|f| &f.count).enumerate() {
        start[i + 1] = *count;
    }
    let mut strays: Vec<(u32, u32)> = found.iter().flat_map(|f| f.strays.iter().copied()).collect();
    strays.par_sort_unstable_by_key(|&(row, other)| (row, rank[other as usize]));
    for &(row, _) in &strays {
        start[row as usize + 1] += 1;
    }
    for i in 0..n {
        start[i + 1] += start[i];
    }
    let mut all = Vec::with_capacity(start[n] as usize);
    let mut stray = strays.iter().copied().peekable();
    let mut row = 0;
    for found in found {
        let mut at = 0;
        for &count in &found.count {
            let begin = all.len();
            all.extend_from_slice(&found.other[at..at + count as usize]);
            at += count as usize;
            let mut mixed = false;
            while let Some((_, other)) = stray.next_if(|&(r, _)| r == row) {
                all.push(other);
                mixed = true;
            }
            if mixed {
                all[begin..].sort_unstable_by_key(|&j| row_order(rank[row as usize], rank[j as usize]));
            }
            row += 1;
        }
    }
    (start, all)
}

/// The pairs of a half list from the side of the higher rank, in the order of the lower rank.
fn incoming(start: &[u32], other: &[u32], rank: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let n = rank.len();
    let mut incoming_start = vec![0_u32; n + 1];
    for &j in other {
        incoming_start[j as usize + 1] += 1;
    }
    for i in 0..n {
        incoming_start[i + 1] += incoming_start[i];
    }
    let mut next = incoming_start.clone();
    // Pair and rank of its row, so that a short sort per particle brings them in order.
    let mut entries = vec![(0_u32, 0_u32); other.len()];
    for i in 0..n {
        for pair in start[i]..start[i + 1] {
            let j = other[pair as usize] as usize;
            entries[next[j] as usize] = (rank[i], pair);
            next[j] += 1;
        }
    }
    let bounds: Vec<usize> = incoming_start.iter().step_by(CHUNK).map(|&s| s as usize).chain([other.len()]).collect();
    let tasks: Vec<_> = split(&mut entries, &bounds).enumerate().collect();
    tasks.into_par_iter().for_each(|(chunk, entries)| {
        let base = bounds[chunk];
        for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(n) {
            entries[incoming_start[i] as usize - base..incoming_start[i + 1] as usize - base].sort_unstable();
        }
    });
    (incoming_start, entries.into_iter().map(|(_, pair)| pair).collect())
}
