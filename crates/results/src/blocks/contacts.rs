//! Contacts as lines, and what they do to particles and walls.

use super::{Precision, Scene, field};
use crate::glossary::{CONTACTS, Place};
use crate::vtkhdf::block::{Block, Cells};
use rayon::prelude::*;
use tdem_engine::physics::Vec3;
use tdem_engine::{Contact, Evaluated, ExactSum, WallContact};

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

impl Pair {
    /// A contact of particles or a wall that a state does not have; no back end hands out such a state.
    const UNKNOWN: Pair = Pair {
        first: -1,
        second: -1,
        wall: -1,
        ends: [[f64::NAN; 3]; 2],
        overlap: f64::NAN,
        normal_force: f64::NAN,
        force: [f64::NAN; 3],
        displacement: [f64::NAN; 3],
    };

    fn new((first, second, wall): (i64, i64, i64), found: &Evaluated<'_>) -> Self {
        let from = found.first.position;
        Pair {
            first,
            second,
            wall,
            ends: [array(from), array(from + found.touch.offset)],
            overlap: found.touch.overlap,
            normal_force: -found.force.dot(found.encounter.normal),
            force: array(found.force),
            displacement: array(found.displacement),
        }
    }
}

impl Scene<'_> {
    pub(super) fn contacts(&self, precision: Precision) -> Block {
        let pairs = self.pairs();
        // Every line has its own two points: the end beyond a seam is an image, not a particle.
        let points = pairs.par_iter().map(|pair| pair.ends).collect::<Vec<_>>();
        Block {
            name: Place::Contacts.name(),
            points: precision.store(points.as_flattened().as_flattened()),
            cells: Cells::Lines,
            point_fields: Vec::new(),
            cell_fields: CONTACTS.par_iter().map(|q| field(q.entry, (q.values)(&pairs), precision)).collect(),
            fixed: false,
        }
    }

    /// All contacts, those with walls last. None is left out, so that each core knows where its share goes.
    fn pairs(&self) -> Vec<Pair> {
        let (pairs, walls) = (self.state.contacts.par_iter(), self.state.wall_contacts.par_iter());
        let all = pairs.map(|contact| self.pair(contact)).chain(walls.map(|contact| self.wall_pair(contact)));
        all.map(|pair| pair.unwrap_or(Pair::UNKNOWN)).collect()
    }

    fn pair(&self, contact: &Contact) -> Option<Pair> {
        let ends = (contact.first.into(), contact.second.into(), -1);
        Some(Pair::new(ends, &self.state.evaluate(self.plan, contact)?))
    }

    fn wall_pair(&self, contact: &WallContact) -> Option<Pair> {
        let ends = (contact.particle.into(), -1, contact.wall.into());
        Some(Pair::new(ends, &self.state.evaluate_at_wall(self.plan, contact)?))
    }

    fn wall_pairs(&self) -> Vec<Pair> {
        self.state.wall_contacts.par_iter().filter_map(|contact| self.wall_pair(contact)).collect()
    }

    pub(super) fn wall_sums(&self) -> Vec<WallSum> {
        let mut sums = vec![WallSum::default(); self.plan.walls.len()];
        let mut forces: Vec<[ExactSum; 3]> = sums.iter().map(|_| Default::default()).collect();
        for pair in self.wall_pairs() {
            let wall = pair.wall as usize;
            (0..3).for_each(|k| forces[wall][k].add(-pair.force[k]));
            sums[wall].touching += 1;
        }
        for (sum, force) in sums.iter_mut().zip(forces) {
            sum.force = force.map(|sum| sum.value());
        }
        sums
    }
}

pub(super) fn array(vector: Vec3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use tdem_engine::physics::contact::{Interaction, Law};
    use tdem_engine::{Constraint, Domain, Integrator, Ledger, Plan, Search, State, Wall};

    /// Two spheres that touch across the seam in x, one of which also touches the floor.
    fn pair_across_the_seam() -> (State, Plan) {
        let interaction = Interaction {
            normal_stiffness: 1e6,
            tangential_stiffness: 1e6,
            normal_damping: 0.0,
            tangential_damping: 0.0,
            static_friction: 0.5,
            dynamic_friction: 0.5,
            least_normal_force: 0.0,
        };
        let plan = Plan {
            dt: 1e-5,
            integrator: Integrator::VelocityVerlet,
            law: Law::GNTM,
            materials: 1,
            interactions: vec![interaction],
            bonds: None,
            heat: None,
            walls: vec![Wall { name: "floor".into(), normal: [0.0, 0.0, 1.0], velocity: [0.0; 3], material: 0 }],
            gravity: [0.0; 3],
            constraints: vec![Constraint::FREE],
            ramps: Vec::new(),
            gauges: Vec::new(),
            domain: Domain { min: [0.0; 3], max: [1.0; 3], periodic: [true, false, false] },
            search: Search { skin: 0.01, every_step: false },
            overlap_limit: 0.5,
            ledger: false,
        };
        let state = State {
            id: vec![4, 9],
            material: vec![0; 2],
            constraint: vec![0; 2],
            radius: vec![0.1; 2],
            mass: vec![1.0; 2],
            position: vec![[0.05, 0.5, 0.098], [0.86, 0.5, 0.2]],
            image: vec![[0; 3]; 2],
            velocity: vec![[0.0; 3]; 2],
            angular_velocity: vec![[0.0; 3]; 2],
            force: vec![[0.0; 3]; 2],
            moment: vec![[0.0; 3]; 2],
            wall_position: vec![[0.0; 3]],
            contacts: vec![Contact { first: 4, second: 9, displacement: [0.0; 3] }],
            wall_contacts: vec![WallContact { particle: 4, wall: 0, displacement: [1e-4, 0.0, 0.0] }],
            ..State::default()
        };
        (state, plan)
    }

    #[test]
    fn a_contact_across_the_seam_is_a_short_line_to_the_nearest_image() {
        let (mut state, plan) = pair_across_the_seam();
        state.position[1][2] = 0.12;
        let pairs = Scene { state: &state, plan: &plan, start: None }.pairs();
        let [Pair { first: 4, second: 9, wall: -1, ends: [from, to], overlap, force, .. }, _] = pairs[..] else {
            panic!("{pairs:?}")
        };
        assert_eq!(from, state.position[0]);
        assert!((to[0] - (0.86 - 1.0)).abs() < 1e-12, "an image, outside the domain: {to:?}");
        assert!(overlap > 0.0 && force[0] > 0.0, "the first is pushed away from the image: {force:?}");
        assert!(pairs[0].normal_force > 0.0);
    }

    #[test]
    fn the_force_on_walls_is_that_of_the_ledger() {
        let (state, plan) = pair_across_the_seam();
        let sums = Scene { state: &state, plan: &plan, start: None }.wall_sums();
        assert_eq!(sums.len(), 1);
        assert_eq!((sums[0].force, sums[0].touching), (Ledger::of(&state, &plan).wall_force, 1));
        assert!(sums[0].force[2] < 0.0 && sums[0].force[0] != 0.0, "{:?}", sums[0].force);
    }
}
