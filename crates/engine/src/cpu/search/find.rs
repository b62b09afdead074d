//! Which particles are within the skin of each other.

use crate::cpu::bodies::Quad;
use crate::cpu::grid::{Candidates, Grid, class_of};
use crate::cpu::wide::{Eight, Loop, lanes_period, run_portable, run_widest};
use crate::cpu::{CHUNK, Width};
use rayon::prelude::*;
use tdem_physics::contact::Period;
use tdem_physics::real::WIDTH;
use tdem_physics::vec3;

/// Where particles are, and how far they see.
pub(super) struct Scene<'a> {
    pub(super) place: &'a [Quad],
    pub(super) rank: &'a [u32],
    /// Radius of the largest particle, m.
    pub(super) largest: f64,
    /// Gap up to which pairs are listed, m.
    pub(super) skin: f64,
    /// Of a box that repeats.
    pub(super) period: Option<Period<f64>>,
    pub(super) width: Width,
}

/// The neighbours of a chunk of particles, each pair from both sides.
#[derive(Default)]
pub(super) struct Found {
    /// Neighbours of each row that have a higher and a lower rank.
    pub(super) count: Vec<[u32; 2]>,
    /// The neighbours, row after row, in the order of [`Scene::key`].
    pub(super) other: Vec<u32>,
    /// (row, neighbour) where the row's particle is of a larger class: it does not look for smaller ones.
    strays: Vec<(u32, u32)>,
}

/// The neighbours of all particles, chunk by chunk. A particle looks for its own class and for larger ones.
pub(super) fn find(scene: &Scene<'_>, grids: &[Grid]) -> Vec<Found> {
    let mut found: Vec<Found> = (0..scene.place.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let looking = Looking { scene, grids, first: chunk * CHUNK };
            if scene.width == Width::Widest { run_widest(looking) } else { run_portable(looking) }
        })
        .collect();
    give_strays(scene, &mut found);
    found
}

/// Tells larger particles of the smaller ones that found them.
fn give_strays(scene: &Scene<'_>, found: &mut [Found]) {
    let mut strays: Vec<(u32, u32)> = found.iter_mut().flat_map(|found| std::mem::take(&mut found.strays)).collect();
    strays.par_sort_unstable();
    let bound = |row: usize| strays.partition_point(|&(stray, _)| (stray as usize) < row);
    found.par_iter_mut().enumerate().for_each(|(chunk, found)| {
        let first = chunk * CHUNK;
        let strays = &strays[bound(first)..bound(first + CHUNK)];
        if !strays.is_empty() {
            found.adopt(scene, first, strays);
        }
    });
}

impl Scene<'_> {
    /// What a row is sorted by, with the neighbour in its lower half. Higher ranks come first, then lower ones, each in
    /// order: what a row's particle sums while contacts are evaluated comes before what it gathers from others.
    #[inline(always)]
    fn key(&self, row: usize, other: u32) -> u64 {
        u64::from(self.rank[other as usize].wrapping_sub(self.rank[row])) << 32 | u64::from(other)
    }

    /// Which of eight particles are within the skin of another, one bit each.
    #[inline(always)]
    fn near<R: Eight>(&self, i: usize, others: &[u32; WIDTH], period: Option<&Period<R>>) -> u8 {
        let mine = &self.place[i];
        let [x, y, z, radius] = R::load(self.place, others);
        let offset = vec3(x - R::lit(mine.0[0]), y - R::lit(mine.0[1]), z - R::lit(mine.0[2]));
        let offset = period.map_or(offset, |period| period.nearest(offset));
        let reach = R::lit(mine.scalar()) + radius + R::lit(self.skin);
        R::bits(offset.dot(offset).lt(reach * reach))
    }
}

impl Found {
    /// Ends a row.
    fn close_row(&mut self, rank: u32, keys: &mut [u64]) {
        keys.sort_unstable();
        let higher = keys.iter().filter(|&&key| key >> 32 <= u64::from(u32::MAX - rank)).count();
        self.count.push([higher as u32, (keys.len() - higher) as u32]);
        self.other.extend(keys.iter().map(|&key| key as u32));
    }

    /// Puts strays into the rows that start with particle `first`.
    fn adopt(&mut self, scene: &Scene<'_>, first: usize, strays: &[(u32, u32)]) {
        let without = std::mem::take(self);
        let mut strays = strays.iter().peekable();
        let (mut keys, mut rest) = (Vec::new(), &without.other[..]);
        for (row, &[higher, lower]) in (first..).zip(&without.count) {
            let (own, tail) = rest.split_at((higher + lower) as usize);
            rest = tail;
            keys.clear();
            keys.extend(own.iter().map(|&other| scene.key(row, other)));
            while let Some(&(_, other)) = strays.next_if(|&&(stray, _)| stray as usize == row) {
                keys.push(scene.key(row, other));
            }
            self.close_row(scene.rank[row], &mut keys);
        }
    }
}

/// The loop over a chunk of particles.
struct Looking<'a, 'b> {
    scene: &'a Scene<'b>,
    grids: &'a [Grid],
    first: usize,
}

impl Loop for Looking<'_, '_> {
    type Found = Found;
    #[inline(always)]
    fn run<R: Eight>(self) -> Found {
        let Looking { scene, grids, first } = self;
        let period = scene.period.as_ref().map(lanes_period::<R>);
        let mut found = Found::default();
        let (mut candidates, mut keys) = (Candidates::default(), Vec::new());
        for i in first..(first + CHUNK).min(scene.place.len()) {
            let class = class_of(scene.place[i].scalar(), scene.largest);
            keys.clear();
            for (level, grid) in grids.iter().enumerate().take(class + 1) {
                grid.around(&scene.place[i], &mut candidates);
                for group in 0..candidates.groups() {
                    let (eight, valid) = candidates.group(group);
                    let mut near = scene.near(i, eight, period.as_ref()) & valid;
                    while near != 0 {
                        let other = eight[near.trailing_zeros() as usize];
                        near &= near - 1;
                        if other as usize == i {
                            continue;
                        }
                        keys.push(scene.key(i, other));
                        if level < class {
                            found.strays.push((other, i as u32));
                        }
                    }
                }
            }
            found.close_row(scene.rank[i], &mut keys);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Domain;

    #[test]
    fn rows_hold_all_that_is_near_in_order() {
        // Spheres of three sizes in a box that repeats along x, scattered by a simple generator, ranks the other way round.
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let n = 1500;
        let radius = |i: u32| [0.05, 0.02, 0.009][i as usize % 3];
        let place: Vec<Quad> = (0..n).map(|i| Quad([random(), random(), random(), radius(i)])).collect();
        let rank: Vec<u32> = (0..n).map(|i| (i * 7 + 3) % n).collect();
        let domain = Domain { min: [0.0; 3], max: [1.0; 3], periodic: [true, false, false] };
        let period = Some(domain.period());
        let grids: Vec<Grid> = (0..3)
            .map(|class| {
                let members: Vec<u32> = (0..n).filter(|&i| class_of(radius(i), 0.05) == class).collect();
                Grid::new(&place, &members, [0.111, 0.061, 0.036][class], &domain)
            })
            .collect();
        let mut rows = Vec::new();
        for width in Width::ALL {
            let scene = Scene { place: &place, rank: &rank, largest: 0.05, skin: 0.01, period, width };
            let found = find(&scene, &grids);
            rows.push(found.iter().flat_map(|found| found.other.clone()).collect::<Vec<_>>());
            let counts: Vec<[u32; 2]> = found.iter().flat_map(|found| found.count.clone()).collect();
            let mut row = rows[0].iter();
            for (i, a) in place.iter().enumerate() {
                let near = |j: &u32| {
                    let b = &place[*j as usize];
                    let offset = domain.period().nearest(b.vector() - a.vector());
                    let reach = a.scalar() + b.scalar() + 0.01;
                    *j as usize != i && offset.dot(offset) < reach * reach
                };
                let mut expected: Vec<u32> = (0..n).filter(near).collect();
                expected.sort_unstable_by_key(|&j| (rank[j as usize] < rank[i], rank[j as usize]));
                let higher = expected.iter().filter(|&&j| rank[j as usize] > rank[i]).count();
                assert_eq!(counts[i], [higher as u32, (expected.len() - higher) as u32]);
                assert_eq!(row.by_ref().take(expected.len()).copied().collect::<Vec<_>>(), expected, "row {i}");
            }
        }
        assert!(rows.iter().all(|other| *other == rows[0] && !other.is_empty()));
    }
}
