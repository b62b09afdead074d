//! Geometry with fields: what VTK calls poly data.

use super::array::Array;

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
    pub(crate) offsets: Vec<i64>,
    pub(crate) connectivity: Vec<i64>,
}

impl Block {
    pub(crate) fn point_count(&self) -> usize {
        self.points.len() / 3
    }

    /// The cells as VTK's four kinds. A kind without cells has the one offset 0.
    pub(crate) fn topologies(&self) -> [Topology; 4] {
        let points = self.point_count();
        let sizes: Vec<usize> = match &self.cells {
            Cells::Vertices => vec![1; points],
            Cells::Lines => vec![2; points / 2],
            Cells::Polygons(sizes) => sizes.clone(),
        };
        let kind = match &self.cells {
            Cells::Vertices => 0,
            Cells::Lines => 1,
            Cells::Polygons(_) => 2,
        };
        std::array::from_fn(|k| {
            let mut offsets = vec![0];
            if k != kind {
                return Topology { offsets, connectivity: Vec::new() };
            }
            let mut end = 0;
            offsets.extend(sizes.iter().map(|&size| {
                end += size as i64;
                end
            }));
            Topology { offsets, connectivity: (0..points as i64).collect() }
        })
    }
}
