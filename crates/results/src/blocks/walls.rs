//! Walls as polygons: infinite planes, drawn as far as the domain goes.

use super::{Precision, Scene, field};
use crate::glossary::{Place, WALLS};
use crate::vtkhdf::block::{Block, Cells};
use tdem_engine::Domain;
use tdem_engine::physics::{Vec3, vec3};

impl Scene<'_> {
    pub(super) fn walls(&self, precision: Precision) -> Block {
        let sums = self.wall_sums();
        let polygons = self.wall_polygons();
        let points: Vec<f64> = polygons.iter().flatten().flatten().copied().collect();
        Block {
            name: Place::Walls.name(),
            points: precision.store(&points),
            cells: Cells::Polygons(polygons.iter().map(Vec::len).collect()),
            point_fields: Vec::new(),
            cell_fields: WALLS.iter().map(|q| field(q.entry, (q.values)(self, &sums), precision)).collect(),
            fixed: self.plan.walls.iter().all(|wall| wall.velocity == [0.0; 3]),
        }
    }

    /// Corners of each wall, m.
    pub(crate) fn wall_polygons(&self) -> Vec<Vec<[f64; 3]>> {
        let walls = self.plan.walls.iter().zip(&self.state.wall_position);
        walls.map(|(wall, &point)| clip(point, wall.normal, &self.plan.domain)).collect()
    }
}

/// The part of a plane inside a box. A plane that misses the box is drawn at its own place, as large as the box.
fn clip(point: [f64; 3], normal: [f64; 3], domain: &Domain) -> Vec<[f64; 3]> {
    let (point, normal) = (Vec3::from(point), Vec3::from(normal));
    let (low, high) = (Vec3::from(domain.min), Vec3::from(domain.max));
    let (centre, size) = ((low + high) * 0.5, (high - low).dot(high - low).sqrt());
    let foot = centre - normal * (centre - point).dot(normal);
    let [first, second] = spanning(normal);

    let mut corners: Vec<[f64; 3]> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .iter()
        .map(|&(a, b)| foot + first * (a * 2.0 * size) + second * (b * 2.0 * size))
        .map(|corner| [corner.x, corner.y, corner.z])
        .collect();
    let foot = [foot.x, foot.y, foot.z];
    // Rounding must not cut a wall away that lies in a face of the box.
    let slack = 1e-9 * size;
    for k in 0..3 {
        let (low, high) = (domain.min[k].min(foot[k]) - slack, domain.max[k].max(foot[k]) + slack);
        corners = cut(&corners, |corner| corner[k] - low);
        corners = cut(&corners, |corner| high - corner[k]);
        for corner in &mut corners {
            corner[k] = corner[k].clamp(low + slack, high - slack);
        }
    }
    corners
}

/// Two unit vectors that span the plane of a unit normal, right-handed with it.
fn spanning(normal: Vec3<f64>) -> [Vec3<f64>; 2] {
    let aside = if normal.x.abs() < 0.6 { vec3(1.0, 0.0, 0.0) } else { vec3(0.0, 1.0, 0.0) };
    let first = aside - normal * aside.dot(normal);
    let first = first * (1.0 / first.dot(first).sqrt());
    [first, normal.cross(first)]
}

/// The part of a convex polygon where `inside` is not negative.
fn cut(corners: &[[f64; 3]], inside: impl Fn(&[f64; 3]) -> f64) -> Vec<[f64; 3]> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (index, corner) in corners.iter().enumerate() {
        let next = &corners[(index + 1) % corners.len()];
        let (here, there) = (inside(corner), inside(next));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here >= 0.0) != (there >= 0.0) {
            let share = here / (here - there);
            kept.push(std::array::from_fn(|k| corner[k] + share * (next[k] - corner[k])));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: Domain = Domain { min: [0.0; 3], max: [1.0, 2.0, 3.0], periodic: [false; 3] };

    fn area(corners: &[[f64; 3]]) -> f64 {
        let corners: Vec<Vec3<f64>> = corners.iter().map(|&corner| corner.into()).collect();
        let doubled = (1..corners.len() - 1)
            .map(|k| (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]))
            .fold(Vec3::zero(), |sum, part| sum + part);
        0.5 * doubled.dot(doubled).sqrt()
    }

    #[test]
    fn a_wall_in_a_face_of_the_box_is_that_face() {
        let floor = clip([0.3, 0.4, 0.0], [0.0, 0.0, 1.0], &DOMAIN);
        assert_eq!(floor.len(), 4);
        assert!((area(&floor) - 2.0).abs() < 1e-8);
        assert!(floor.iter().all(|corner| corner[2] == 0.0 && (0.0..=1.0).contains(&corner[0])));
    }

    #[test]
    fn a_slanted_wall_is_cut_by_the_box() {
        let half = 0.5_f64.sqrt();
        let corners = clip([0.5, 1.0, 1.5], [half, 0.0, half], &DOMAIN);
        assert!((area(&corners) - 2.0 * 2.0_f64.sqrt()).abs() < 1e-6, "{corners:?}");
    }

    #[test]
    fn a_wall_that_left_the_box_is_drawn_where_it_is() {
        let lid = clip([0.0, 0.0, 7.0], [0.0, 0.0, -1.0], &DOMAIN);
        assert!((area(&lid) - 2.0).abs() < 1e-8);
        assert!(lid.iter().all(|corner| (corner[2] - 7.0).abs() < 1e-8));
    }
}
