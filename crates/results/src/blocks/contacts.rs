//! Contacts as lines, and what they do to particles and walls.

use super::{Precision, Scene, field};
use crate::glossary::{CONTACTS, Place};
use crate::vtkhdf::block::{Block, Cells};
use rayon::prelude::*;
use tdem_engine::physics::Vec3;
use tdem_engine::physics::contact::{Encounter, Sphere, respond, touch_spheres, touch_wall};
use tdem_engine::{Contact, WallContact};

/// A contact of one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) first: i64,
    /// -1 for a wall.
    pub(crate) second: i64,
    /// -1 for a particle.
    pub(crate) wall: i64,
    /// From the first centre to the nearest image of the second, or to the wall, m.
    pub(crate) ends: [[f64; 3]; 2],
    pub(crate) overlap: f64,
    pub(crate) normal_force: f64,
    /// On the first particle, N.
    pub(crate) force: [f64; 3],
    pub(crate) displacement: [f64; 3],
}

/// What all particles together do to a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WallSum {
    pub(crate) force: [f64; 3],
    pub(crate) touching: i64,
}

impl Scene<'_> {
    pub(super) fn contacts(&self, precision: Precision) -> Block {
        let mut pairs = self.pairs();
        pairs.extend(self.wall_pairs());
        // Every line has its own two points: the end beyond a seam is an image, not a particle.
        let points: Vec<f64> = pairs.iter().flat_map(|pair| pair.ends).flatten().collect();
        Block {
            name: Place::Contacts.name(),
            points: precision.store(&points),
            cells: Cells::Lines,
            point_fields: Vec::new(),
            cell_fields: CONTACTS.iter().map(|q| field(q.entry, &(q.values)(&pairs), precision)).collect(),
            fixed: false,
        }
    }

    fn sphere(&self, index: usize) -> Sphere<f64> {
        Sphere {
            position: self.state.position[index].into(),
            radius: self.state.radius[index],
            velocity: self.state.velocity[index].into(),
            mass: self.state.mass[index],
            angular_velocity: self.state.angular_velocity[index].into(),
        }
    }

    fn pairs(&self) -> Vec<Pair> {
        self.state.contacts.par_iter().filter_map(|contact| self.pair(contact)).collect()
    }

    fn pair(&self, contact: &Contact) -> Option<Pair> {
        let (first, second) = (self.index_of(contact.first)?, self.index_of(contact.second)?);
        let (a, b) = (self.sphere(first), self.sphere(second));
        let touch = touch_spheres(self.plan.domain.period().nearest(b.position - a.position), a.radius + b.radius);
        let encounter = Encounter::of_spheres(&a, &b, &touch, self.plan.law.moments);
        let interaction = self.plan.interaction(self.state.material[first], self.state.material[second]);
        // A step of zero length: the force as it is, without moving the history.
        let force = respond(self.plan.law, &encounter, contact.displacement.into(), interaction, 0.0).force;
        Some(Pair {
            first: contact.first.into(),
            second: contact.second.into(),
            wall: -1,
            ends: [array(a.position), array(a.position + touch.offset)],
            overlap: touch.overlap,
            normal_force: -force.dot(encounter.normal),
            force: array(force),
            displacement: contact.displacement,
        })
    }

    pub(super) fn wall_pairs(&self) -> Vec<Pair> {
        self.state.wall_contacts.iter().filter_map(|contact| self.wall_pair(contact)).collect()
    }

    fn wall_pair(&self, contact: &WallContact) -> Option<Pair> {
        let index = self.index_of(contact.particle)?;
        let wall = self.plan.walls.get(contact.wall as usize)?;
        let point = *self.state.wall_position.get(contact.wall as usize)?;
        let (sphere, normal) = (self.sphere(index), Vec3::from(wall.normal));
        let touch = touch_wall(sphere.position, sphere.radius, point.into(), normal);
        let encounter = Encounter::with_wall(&sphere, &touch, normal, wall.velocity.into(), self.plan.law.moments);
        let interaction = self.plan.interaction(self.state.material[index], wall.material);
        let force = respond(self.plan.law, &encounter, contact.displacement.into(), interaction, 0.0).force;
        Some(Pair {
            first: contact.particle.into(),
            second: -1,
            wall: contact.wall.into(),
            ends: [array(sphere.position), array(sphere.position + touch.offset)],
            overlap: touch.overlap,
            normal_force: -force.dot(encounter.normal),
            force: array(force),
            displacement: contact.displacement,
        })
    }

    pub(super) fn wall_sums(&self) -> Vec<WallSum> {
        let mut sums = vec![WallSum::default(); self.plan.walls.len()];
        for pair in self.wall_pairs() {
            let sum = &mut sums[pair.wall as usize];
            for k in 0..3 {
                sum.force[k] -= pair.force[k];
            }
            sum.touching += 1;
        }
        sums
    }
}

fn array(vector: Vec3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z]
}
