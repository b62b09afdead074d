//! Spheres on a regular lattice.

use super::Context;
use super::draft::Spheres;
use crate::codes;
use crate::problem::{Problem, number};
use crate::schema::{Align, CellKind, Lattice};

/// Places of the spheres in a cell, in units of the lattice constant.
fn basis(kind: CellKind) -> &'static [[f64; 3]] {
    match kind {
        CellKind::Fcc => &[[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]],
        CellKind::Sc => &[[0.0, 0.0, 0.0]],
    }
}

/// Lattice constant, m: nearest neighbours are a diameter and the gap apart.
fn constant(kind: CellKind, radius: f64, gap: f64) -> f64 {
    let neighbour = 2.0 * radius * (1.0 + gap);
    match kind {
        CellKind::Fcc => std::f64::consts::SQRT_2 * neighbour,
        CellKind::Sc => neighbour,
    }
}

/// What a face across an axis of a lattice has of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    /// m².
    pub(super) area: f64,
    /// How deep the centre lies behind the face, half a layer, m.
    pub(super) depth: f64,
}

impl Cell {
    pub(super) fn of(spec: &Lattice) -> Self {
        let a = constant(spec.kind, spec.radius.get(), spec.gap);
        match spec.kind {
            // Two particles on a square of the lattice constant, four layers in it.
            CellKind::Fcc => Cell { area: 0.5 * (a * a), depth: 0.25 * a },
            CellKind::Sc => Cell { area: a * a, depth: 0.5 * a },
        }
    }
}

/// Distance from the first to the last centre of some cells, in lattice constants.
fn span(kind: CellKind, cells: f64) -> f64 {
    match kind {
        CellKind::Fcc => cells - 0.5,
        CellKind::Sc => cells - 1.0,
    }
}

pub(super) fn place(context: &Context<'_>, group: usize, spec: &Lattice) -> Result<Spheres, Problem> {
    let radius = spec.radius.get();
    let a = constant(spec.kind, radius, spec.gap);
    let region = context.region(spec.min, spec.max);
    let room: [f64; 3] = std::array::from_fn(|k| region.max[k] - region.min[k]);
    // A direction that repeats and is filled from end to end holds whole cells: the last one meets the first.
    let wraps: [bool; 3] = std::array::from_fn(|k| {
        context.domain.periodic[k] && region.min[k] <= context.domain.min[k] && region.max[k] >= context.domain.max[k]
    });
    if let Some(site) = spec.site {
        return around(context, group, spec, site, wraps);
    }
    let cells: [f64; 3] = match spec.cells {
        Some(cells) => cells.map(f64::from),
        None => std::array::from_fn(|k| {
            let fit = if wraps[k] { room[k] / a } else { (room[k] - 2.0 * radius) / a + (1.0 - span(spec.kind, 1.0)) };
            (fit * (1.0 + 1e-9)).floor().max(0.0)
        }),
    };
    let atoms = basis(spec.kind);
    let count = cells.iter().product::<f64>() * atoms.len() as f64;
    if count == 0.0 {
        return Err(too_small(context, group, a, room));
    }
    context.room_for(group, count)?;
    let first: [f64; 3] = spec.origin.unwrap_or_else(|| {
        std::array::from_fn(|k| {
            let extent = span(spec.kind, cells[k]) * a + 2.0 * radius;
            let free = room[k] - extent;
            match spec.align[k] {
                Align::Min => region.min[k] + radius,
                Align::Center => region.min[k] + 0.5 * free + radius,
                Align::Max => region.max[k] - (extent - radius),
            }
        })
    });
    let cells = cells.map(|c| c as usize);
    let mut position = Vec::with_capacity(count as usize);
    for z in 0..cells[2] {
        for y in 0..cells[1] {
            for x in 0..cells[0] {
                for atom in atoms {
                    let corner = [x as f64, y as f64, z as f64];
                    position.push(std::array::from_fn(|k| first[k] + (corner[k] + atom[k]) * a));
                }
            }
        }
    }
    Ok(Spheres { radius: vec![radius; position.len()], position, ..Spheres::default() })
}

/// All spheres of a lattice, one of which is at `site`, that lie wholly in the region. Directions that wrap take whole
/// cells, as many as fit.
fn around(
    context: &Context<'_>,
    group: usize,
    spec: &Lattice,
    site: [f64; 3],
    wraps: [bool; 3],
) -> Result<Spheres, Problem> {
    let radius = spec.radius.get();
    let a = constant(spec.kind, radius, spec.gap);
    let region = context.region(spec.min, spec.max);
    // Layers of spheres across a direction; in face-centred cells every other place of a layer is taken.
    let (layers, share) = match spec.kind {
        CellKind::Fcc => (2.0, 0.5),
        CellKind::Sc => (1.0, 1.0),
    };
    let spacing = a / layers;
    let margin = wraps.map(|wraps| if wraps { 0.0 } else { radius });
    let first: [f64; 3] = std::array::from_fn(|k| ((region.min[k] + margin[k] - site[k]) / spacing - SLACK).ceil());
    let count: [f64; 3] = std::array::from_fn(|k| {
        let room = region.max[k] - region.min[k];
        if wraps[k] {
            return layers * (room / a * (1.0 + SLACK)).floor();
        }
        let last = ((region.max[k] - margin[k] - site[k]) / spacing + SLACK).floor();
        (last - first[k] + 1.0).max(0.0)
    });
    let places = count.iter().product::<f64>();
    context.room_for(group, share * places)?;
    let [columns, rows, slices] = count.map(|count| count as u64);
    let mut position = Vec::with_capacity((share * places) as usize + 1);
    for z in 0..slices {
        for y in 0..rows {
            for x in 0..columns {
                let layer = [x, y, z];
                let step: [f64; 3] = std::array::from_fn(|k| first[k] + layer[k] as f64);
                if spec.kind == CellKind::Sc || step.iter().sum::<f64>() % 2.0 == 0.0 {
                    position.push(std::array::from_fn(|k| site[k] + step[k] * spacing));
                }
            }
        }
    }
    if position.is_empty() {
        return Err(too_small(context, group, a, std::array::from_fn(|k| region.max[k] - region.min[k])));
    }
    Ok(Spheres { radius: vec![radius; position.len()], position, ..Spheres::default() })
}

/// Part of a cell that rounding may cost.
const SLACK: f64 = 1e-9;

fn too_small(context: &Context<'_>, group: usize, cell: f64, room: [f64; 3]) -> Problem {
    let message = format!(
        "no lattice cell fits: a cell is {} m wide, the region {} m",
        number(cell),
        room.map(number).join(" x ")
    );
    Problem::new(codes::REGION_TOO_SMALL, message)
        .at(context.place(group, &["lattice", "radius"]), "sets the size of a cell")
        .help("enlarge the region or take smaller spheres")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_neighbours_touch() {
        for (kind, neighbours) in [(CellKind::Fcc, 12), (CellKind::Sc, 6)] {
            let a = constant(kind, 0.5, 0.0);
            let mut near = 0;
            for cell in 0..27 {
                let offset = [cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1].map(f64::from);
                for atom in basis(kind) {
                    let distance = (0..3).map(|k| (offset[k] + atom[k]) * a).map(|c| c * c).sum::<f64>().sqrt();
                    assert!(distance == 0.0 || distance > 1.0 - 1e-12);
                    near += usize::from((distance - 1.0).abs() < 1e-12);
                }
            }
            assert_eq!(near, neighbours);
        }
    }
}
