//! A grid of cells over the space that particles of one size class occupy.

use super::bodies::Quad;
use crate::Domain;

/// Particles of one size class, sorted into cells at least as wide as their reach.
pub(crate) struct Grid {
    min: [f64; 3],
    /// Cells per metre.
    per_metre: [f64; 3],
    cells: [usize; 3],
    /// Whether the last cell of a direction is a neighbour of the first.
    wraps: [bool; 3],
    /// Where the particles of each cell start.
    start: Vec<u32>,
    /// Particles, cell by cell.
    items: Vec<u32>,
}

impl Grid {
    /// Sorts `members` (indices into `place`) into cells of at least `width`.
    pub(crate) fn new(place: &[Quad], members: &[u32], width: f64, domain: &Domain) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &i in members {
            for k in 0..3 {
                min[k] = min[k].min(place[i as usize].0[k]);
                max[k] = max[k].max(place[i as usize].0[k]);
            }
        }
        let wraps = domain.periodic;
        for k in 0..3 {
            if wraps[k] {
                (min[k], max[k]) = (domain.min[k], domain.max[k]);
            }
        }
        // Scattered particles would make a grid of mostly empty cells: coarsen it until cells are as many as particles.
        let budget = (4 * members.len()).max(64) as f64;
        let mut width = width;
        let count = |width: f64| -> [f64; 3] { std::array::from_fn(|k| ((max[k] - min[k]) / width).floor().max(1.0)) };
        while count(width).iter().product::<f64>() > budget {
            width *= 1.25;
        }
        let cells = count(width).map(|c| c as usize);
        let per_metre = std::array::from_fn(|k| {
            let extent = max[k] - min[k];
            if extent > 0.0 { cells[k] as f64 / extent } else { 0.0 }
        });
        let mut grid = Grid { min, per_metre, cells, wraps, start: Vec::new(), items: Vec::new() };
        let cell_of: Vec<u32> = members.iter().map(|&i| grid.linear(grid.cell(&place[i as usize])) as u32).collect();
        let mut start = vec![0_u32; cells.iter().product::<usize>() + 1];
        for &cell in &cell_of {
            start[cell as usize + 1] += 1;
        }
        for cell in 1..start.len() {
            start[cell] += start[cell - 1];
        }
        let mut next = start.clone();
        let mut items = vec![0; members.len()];
        for (&member, &cell) in members.iter().zip(&cell_of) {
            items[next[cell as usize] as usize] = member;
            next[cell as usize] += 1;
        }
        grid.start = start;
        grid.items = items;
        grid
    }

    /// The cell of a member of the class.
    fn cell(&self, place: &Quad) -> [usize; 3] {
        std::array::from_fn(|k| (((place.0[k] - self.min[k]) * self.per_metre[k]) as usize).min(self.cells[k] - 1))
    }
    fn linear(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.cells[1] + y) * self.cells[0] + x
    }

    /// Calls `visit` with the members of all cells around a point, whether the point is inside the grid or not.
    #[inline(always)]
    pub(crate) fn around(&self, place: &Quad, mut visit: impl FnMut(&[u32])) {
        let mut near = [[0_usize; 3]; 3];
        let mut count = [0_usize; 3];
        for k in 0..3 {
            let cell = ((place.0[k] - self.min[k]) * self.per_metre[k]).floor() as isize;
            let cells = self.cells[k] as isize;
            for step in -1..=1 {
                let mut c = cell + step;
                if self.wraps[k] {
                    c = c.rem_euclid(cells);
                }
                // With one or two cells a step to either side may end in the same cell.
                if c >= 0 && c < cells && !near[k][..count[k]].contains(&(c as usize)) {
                    near[k][count[k]] = c as usize;
                    count[k] += 1;
                }
            }
        }
        for &z in &near[2][..count[2]] {
            for &y in &near[1][..count[1]] {
                for &x in &near[0][..count[0]] {
                    let cell = self.linear([x, y, z]);
                    visit(&self.items[self.start[cell] as usize..self.start[cell + 1] as usize]);
                }
            }
        }
    }
}

/// Size classes, each half as large as the one before: radii of class `c` are above `largest / 2^(c+1)`.
pub(crate) fn class_of(radius: f64, largest: f64) -> usize {
    let mut class = 0;
    let mut bound = 0.5 * largest;
    while radius <= bound && class < 30 {
        class += 1;
        bound *= 0.5;
    }
    class
}

/// Rows of cells side by side in a strip, see [`strip_order`].
const STRIP: u64 = 16;

/// Place of a point on a curve that fills space in strips: row after row of cells along x, `STRIP` rows side by side in
/// y, then the next layer in z, and when a strip is done the next strip.
///
/// Neighbours in space stay near in memory, as on a Morton curve, and memory is read in long runs, which hardware
/// prefetches: measured 1.3 times faster than Morton order on the contact benchmark.
pub(crate) fn strip_order(place: &Quad, min: [f64; 3], per_metre: f64) -> u64 {
    let cell = |k: usize| (((place.0[k] - min[k]) * per_metre) as u64).min(0xf_ffff);
    let [x, y, z] = [cell(0), cell(1), cell(2)];
    (y / STRIP) << 44 | z << 24 | (y % STRIP) << 20 | x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_run_along_x_then_y_then_z_then_to_the_next_strip() {
        let order = |x: f64, y: f64, z: f64| strip_order(&Quad([x, y, z, 0.1]), [0.0; 3], 1.0);
        let points = [order(0.5, 0.5, 0.5), order(9.5, 0.5, 0.5), order(0.5, 1.5, 0.5), order(0.5, 0.5, 1.5)];
        assert!(points.is_sorted());
        assert!(order(9.5, 15.5, 99.5) < order(0.5, 16.5, 0.5));
    }

    #[test]
    fn classes_halve() {
        assert_eq!([1.0, 0.51, 0.5, 0.26, 0.25].map(|r| class_of(r, 1.0)), [0, 0, 1, 1, 2]);
    }
}
