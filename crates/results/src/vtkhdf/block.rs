//! Geometry with fields: what VTK calls poly data.

use super::array::Array;
use rayon::prelude::*;

/// Points, the cells between them, and fields on both.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) name: &'static str,
    /// `(N, 3)`, flat.
    pub(crate) points: Array,
    pub(crate) cells: Cells,
    pub(crate) point_fields: Vec<Field>,
    pub(crate) cell_fields: Vec<Field>,
    /// Whether points and cells stay what they are during the run.
    pub(crate) fixed: bool,
}

/// What the points make up. Cells use the points one after the other, none twice.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cells {
    /// One cell per point.
    Vertices,
    /// One cell per two points.
    Lines,
    /// Cells of these numbers of points.
    Polygons(Vec<usize>),
}

/// Numbers on points or cells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) components: usize,
    pub(crate) data: Array,
}

/// VTK's four kinds of cells, in its order; a file has a group for each, even if empty.
pub(crate) const TOPOLOGIES: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];

/// Offsets and connectivity of one kind of cells.
pub(crate) struct Topology {
    pub(crate) offsets: Array,
    pub(crate) connectivity: Array,
}

impl Block {
    pub(crate) fn point_count(&self) -> usize {
        self.points.len() / 3
    }

    /// Cells and connectivity ids of each of VTK's four kinds.
    pub(crate) fn counts(&self) -> ([usize; 4], [usize; 4]) {
        let points = self.point_count();
        let (kind, cells) = match &self.cells {
            Cells::Vertices => (0, points),
            Cells::Lines => (1, points / 2),
            Cells::Polygons(sizes) => (2, sizes.len()),
        };
        let only = |count| std::array::from_fn(|k| if k == kind { count } else { 0 });
        (only(cells), only(points))
    }

    /// The cells as VTK's four kinds. A kind without cells has the one offset 0.
    pub(crate) fn topologies(&self) -> [Topology; 4] {
        let (cells, connectivity) = self.counts();
        std::array::from_fn(|k| {
            let cells = cells[k] as i64;
            let offsets = match &self.cells {
                Cells::Polygons(sizes) if k == 2 => {
                    let ends = sizes.iter().scan(0, |end, &size| {
                        *end += size as i64;
                        Some(*end)
                    });
                    std::iter::once(0).chain(ends).collect()
                }
                Cells::Lines => (0..=cells).into_par_iter().map(|cell| 2 * cell).collect(),
                _ => (0..=cells).into_par_iter().collect(),
            };
            let connectivity = (0..connectivity[k] as i64).into_par_iter().collect();
            Topology { offsets: Array::I64(offsets), connectivity: Array::I64(connectivity) }
        })
    }
}
