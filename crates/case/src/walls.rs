//! Walls and boxes of a case, as planes.

use crate::schema::{Case, Container, Course, Face};
use std::ops::Range;
use tdem_engine::Wall;

/// Faces, the direction each is across, and whether it is the lower one.
pub(crate) const FACES: [(Face, usize, bool); 6] = [
    (Face::LowX, 0, true),
    (Face::HighX, 0, false),
    (Face::LowY, 1, true),
    (Face::HighY, 1, false),
    (Face::LowZ, 2, true),
    (Face::HighZ, 2, false),
];

/// Name of a face in cases, messages and results.
pub(crate) fn face_name(face: Face) -> &'static str {
    match face {
        Face::LowX => "-x",
        Face::HighX => "+x",
        Face::LowY => "-y",
        Face::HighY => "+y",
        Face::LowZ => "-z",
        Face::HighZ => "+z",
    }
}

/// A plane with the place in the case that made it.
#[derive(Clone, Debug)]
pub(crate) struct Plane {
    pub(crate) wall: Wall,
    pub(crate) point: [f64; 3],
    pub(crate) span: Range<usize>,
    pub(crate) temperature: Option<Course>,
}

impl Plane {
    /// Distance of a point from the plane, m; negative behind it.
    pub(crate) fn distance(&self, point: [f64; 3]) -> f64 {
        (0..3).map(|k| (point[k] - self.point[k]) * self.wall.normal[k]).sum()
    }
}

/// All planes of a case: walls in order, then the faces of boxes in the order -x, +x, -y, +y, -z, +z.
pub(crate) fn planes(case: &Case, tree: &crate::tree::Node, material: impl Fn(&str) -> u16) -> Vec<Plane> {
    let mut planes: Vec<Plane> = Vec::new();
    for (k, wall) in case.wall.iter().enumerate() {
        let length = wall.normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        planes.push(Plane {
            wall: Wall {
                name: wall.name.clone(),
                normal: wall.normal.map(|c| c / length),
                velocity: wall.velocity,
                material: material(&wall.material),
            },
            point: wall.point,
            span: tree.place(&["wall", &k.to_string(), "point"]),
            temperature: wall.temperature.clone(),
        });
    }
    for (k, container) in case.boxes.iter().enumerate() {
        let span = tree.place(&["box", &k.to_string()]);
        let material = material(&container.material);
        planes.extend(faces(case, container, material).map(|(wall, point)| Plane {
            wall,
            point,
            span: span.clone(),
            temperature: container.temperature.clone(),
        }));
    }
    planes
}

fn faces(case: &Case, container: &Container, material: u16) -> impl Iterator<Item = (Wall, [f64; 3])> {
    let (min, max) = (container.min.unwrap_or(case.domain.min), container.max.unwrap_or(case.domain.max));
    FACES.into_iter().filter(|face| !container.open.contains(&face.0)).map(move |(face, direction, low)| {
        let mut normal = [0.0; 3];
        normal[direction] = if low { 1.0 } else { -1.0 };
        let name = format!("{} {}", container.name, face_name(face));
        (Wall { name, normal, velocity: container.velocity, material }, if low { min } else { max })
    })
}
