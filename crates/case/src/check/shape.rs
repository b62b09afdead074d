//! What the text shows to be wrong with parts of space.

use super::Checker;
use crate::codes;
use crate::problem::Problem;
use crate::schema::{Cylinder, Particles, Revolution, Shape};
use crate::structure::listed;

impl Checker<'_> {
    /// A part of space has one shape, and that shape is not inside out. `path` leads to the table that holds it.
    pub(super) fn shape(&mut self, shape: &Shape, path: &[&str], of: &str) {
        match shape.given().as_slice() {
            [] => {
                let place = self.place(path);
                self.push(
                    Problem::new(codes::SHAPE, format!("{of} has no shape"))
                        .at(place, format!("one of {} belongs here", listed(Shape::KEYS)))
                        .help("add box = { min = [..., ..., ...], max = [..., ..., ...] }, for instance"),
                );
            }
            [first, second, ..] => {
                let [place, other] = [second, first].map(|key| self.tree.key_place(&[path, &[key]].concat()));
                self.push(
                    Problem::new(codes::SHAPE, format!("{of} has two shapes, but must have one"))
                        .at(place, "one too many")
                        .at(other, "the other")
                        .help("keep one of them"),
                );
            }
            [_] => {}
        }
        if let Some(block) = &shape.block {
            self.corners_if_given(&[path, &["box"]].concat(), block.min, block.max);
        }
        if let Some(cylinder) = &shape.cylinder {
            self.cylinder(cylinder, &[path, &["cylinder"]].concat());
        }
        if let Some(revolution) = &shape.revolution {
            self.revolution(revolution, &[path, &["revolution"]].concat());
        }
    }

    fn cylinder(&mut self, cylinder: &Cylinder, path: &[&str]) {
        let (Some(from), Some(to)) = (cylinder.from, cylinder.to) else { return };
        if from >= to {
            let [start, end] = ["from", "to"].map(|key| self.place(&[path, &[key]].concat()));
            self.push(
                Problem::new(codes::INVERTED_RANGE, format!("the cylinder begins at {from} m and ends at {to} m"))
                    .at(end, "must be larger than `from`")
                    .at(start, "begins here"),
            );
        }
    }

    fn revolution(&mut self, revolution: &Revolution, path: &[&str]) {
        for k in 1..revolution.profile.len() {
            let [before, after] = [revolution.profile[k - 1][0], revolution.profile[k][0]];
            if before >= after {
                let place = self.place(&[path, &["profile", &k.to_string()]].concat());
                self.push(
                    Problem::new(
                        codes::INVERTED_RANGE,
                        format!("the profile goes from {before} m to {after} m along its axis"),
                    )
                    .at(place, "must be farther along than the point before it"),
                );
            }
        }
    }

    /// What is cut out of a group of particles.
    pub(super) fn cuts(&mut self, group: &Particles, index: &str) {
        if let Some(within) = &group.within {
            self.shape(within, &["particles", index, "within"], "what is cut out here");
        }
        for (k, hole) in group.without.iter().enumerate() {
            self.shape(hole, &["particles", index, "without", &k.to_string()], "this hole");
        }
    }
}
