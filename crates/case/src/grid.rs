//! Cells that tell who is near whom.

use tdem_engine::Domain;

/// Marks the end of a cell's list.
const END: u32 = u32::MAX;

/// Lists of particles per cell. A cell is at least as wide as the distance that matters, so that neighbours are in the 27
/// cells around a point.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    origin: [f64; 3],
    per_metre: [f64; 3],
    cells: [usize; 3],
    periodic: [bool; 3],
    head: Vec<u32>,
    next: Vec<u32>,
}

impl Grid {
    /// An empty grid over a block of space; directions that repeat take the domain's bounds. Points outside the block
    /// count as points of its outermost cells, which keeps neighbours neighbours.
    pub(crate) fn new(domain: &Domain, min: [f64; 3], max: [f64; 3], width: f64, capacity: usize) -> Self {
        let mut origin = min;
        let mut length: [f64; 3] = std::array::from_fn(|k| (max[k] - min[k]).max(0.0));
        for k in 0..3 {
            if domain.periodic[k] {
                origin[k] = domain.min[k];
                length[k] = domain.max[k] - domain.min[k];
            }
        }
        let mut width = width;
        let cells = loop {
            let cells: [f64; 3] = std::array::from_fn(|k| (length[k] / width).floor().max(1.0));
            // A wide domain with few small particles must not cost memory for its empty cells.
            if cells.iter().product::<f64>() <= 8.0 * capacity as f64 + 64.0 {
                break cells.map(|c| c as usize);
            }
            width *= 1.3;
        };
        // With fewer than three cells in a direction that repeats, a cell would be its own neighbour twice.
        let cells: [usize; 3] = std::array::from_fn(|k| if domain.periodic[k] && cells[k] < 3 { 1 } else { cells[k] });
        Grid {
            origin,
            per_metre: std::array::from_fn(|k| if length[k] > 0.0 { cells[k] as f64 / length[k] } else { 0.0 }),
            cells,
            periodic: domain.periodic,
            head: vec![END; cells.iter().product()],
            next: Vec::with_capacity(capacity),
        }
    }

    fn cell(&self, point: [f64; 3]) -> [usize; 3] {
        // Conversion saturates, so that points below the block fall into the first cell.
        std::array::from_fn(|k| (((point[k] - self.origin[k]) * self.per_metre[k]) as usize).min(self.cells[k] - 1))
    }

    fn flat(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.cells[1] + y) * self.cells[0] + x
    }

    /// Adds the particle of the next index.
    pub(crate) fn push(&mut self, point: [f64; 3]) {
        let cell = self.flat(self.cell(point));
        self.next.push(self.head[cell]);
        self.head[cell] = self.next.len() as u32 - 1;
    }

    /// Whether any particle near a point satisfies a condition; particles are asked until one does.
    pub(crate) fn any_near(&self, point: [f64; 3], mut condition: impl FnMut(usize) -> bool) -> bool {
        let cell = self.cell(point);
        let steps = |k: usize| {
            let (count, at) = (self.cells[k], cell[k]);
            let reach = usize::from(count > 1);
            (0..=2 * reach).filter_map(move |step| match (at + step).checked_sub(reach) {
                Some(index) if index < count => Some(index),
                Some(_) if self.periodic[k] => Some(0),
                None if self.periodic[k] => Some(count - 1),
                _ => None,
            })
        };
        for z in steps(2) {
            for y in steps(1) {
                for x in steps(0) {
                    let mut at = self.head[self.flat([x, y, z])];
                    while at != END {
                        if condition(at as usize) {
                            return true;
                        }
                        at = self.next[at as usize];
                    }
                }
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(domain: &Domain, width: f64, points: &[[f64; 3]], at: [f64; 3]) -> Vec<usize> {
        let mut grid = Grid::new(domain, domain.min, domain.max, width, 1000);
        for &point in points {
            grid.push(point);
        }
        let mut found = Vec::new();
        grid.any_near(at, |k| {
            found.push(k);
            false
        });
        found.sort_unstable();
        found
    }

    #[test]
    fn neighbours_are_found_across_the_seam_and_only_once() {
        let points = [[0.05, 0.5, 0.5], [0.95, 0.5, 0.5], [0.5, 0.5, 0.5]];
        let mut domain = Domain { min: [0.0; 3], max: [1.0; 3], periodic: [true, false, false] };
        assert_eq!(near(&domain, 0.1, &points, [0.99, 0.5, 0.5]), [0, 1]);
        assert_eq!(near(&domain, 0.45, &points, [0.99, 0.5, 0.5]), [0, 1, 2]);
        domain.periodic = [false; 3];
        assert_eq!(near(&domain, 0.1, &points, [0.99, 0.5, 0.5]), [1]);
    }

    #[test]
    fn points_outside_the_block_keep_their_neighbours() {
        let domain = Domain { min: [0.0; 3], max: [1.0; 3], periodic: [false; 3] };
        assert_eq!(near(&domain, 0.1, &[[1.2, 0.5, -0.3]], [1.25, 0.5, -0.3]), [0]);
    }
}
