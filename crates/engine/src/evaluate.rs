//! The contacts and bonds of a state, evaluated once more: for the ledger and for whoever shows forces.

use crate::plan::{overlap_ratio, prescribe};
use crate::{BondHistory, Contact, Plan, State, WallContact};
use tdem_physics::bond::{self, Advance, Bond, Ends, Form, History, Posture, Reaction, Rest};
use tdem_physics::contact::{Encounter, Interaction, Sphere, Touch, respond, stored_energy, touch_spheres, touch_wall};
use tdem_physics::motion::orientation::Quaternion;
use tdem_physics::motion::{sphere_inertia, verlet};
use tdem_physics::{Vec3, vec3};

/// A contact of a state: how it lies, how it moved when its force was computed, and that force.
#[derive(Clone, Copy, Debug)]
pub struct Evaluated<'a> {
    /// The first body.
    pub first: Sphere<f64>,
    /// Radius of the second, m; infinite for a wall.
    pub second_radius: f64,
    /// From its centre to the nearest image of the second, or to the wall.
    pub touch: Touch<f64>,
    /// What the law is told.
    pub encounter: Encounter<f64>,
    /// Parameters of the pair of materials.
    pub interaction: &'a Interaction<f64>,
    /// Tangential displacement of the second surface relative to the first, m.
    pub displacement: Vec3<f64>,
    /// Force on the first body, N. Zero for bodies that have parted: Gear's corrector moves particles after forces were
    /// computed.
    pub force: Vec3<f64>,
}

impl Evaluated<'_> {
    /// Overlap as a fraction of the smaller radius.
    #[must_use]
    pub fn overlap_ratio(&self) -> f64 {
        overlap_ratio(self.touch.overlap, self.first.radius, self.second_radius)
    }
    /// Whether the bodies still touch.
    #[must_use]
    pub fn touches(&self) -> bool {
        self.touch.overlap > 0.0
    }
    /// Energy in the normal and the tangential spring, J.
    #[must_use]
    pub fn stored_energy(&self) -> [f64; 2] {
        if !self.touches() {
            return [0.0; 2];
        }
        let Evaluated { encounter, displacement, interaction, .. } = self;
        stored_energy(encounter.radius_eff, encounter.overlap, *displacement, interaction).into()
    }
}

/// A bond of a state that holds: where it lies and what it does.
#[derive(Clone, Copy, Debug)]
pub struct EvaluatedBond {
    /// Its particles, and the offset of the second from the first.
    pub ends: Ends<f64>,
    /// Its numbers.
    pub bond: Bond<f64>,
    /// Forces, moments and stresses.
    pub reaction: Reaction<f64>,
}

impl EvaluatedBond {
    /// Energy in its springs, J.
    #[must_use]
    pub fn stored_energy(&self) -> f64 {
        bond::stored_energy(&self.reaction.load, &self.bond)
    }
}

impl State {
    /// Evaluates the bond of an index in [`State::bonds`]; `None` if there is none or it is broken.
    #[must_use]
    pub fn evaluate_bond(&self, plan: &Plan, index: usize) -> Option<EvaluatedBond> {
        let law = plan.bonds.as_ref()?.law;
        let pair = self.bonds.get(index).filter(|bond| bond.holds())?;
        let (i, j) = (self.index_of(pair.first)?, self.index_of(pair.second)?);
        let felt = Felt::of(self, plan);
        let ends = Ends {
            first: felt.sphere(i),
            second: felt.sphere(j),
            offset: self.touch(plan, i, j).offset,
            lead: felt.lead,
        };
        let bonded_offset = self.bonded_offset(plan, i, j);
        let bonded_length = bonded_offset.dot(bonded_offset).sqrt();
        let numbers = self.bond_numbers(plan, [i, j], pair.strength)?;
        let reaction = match law.form {
            Form::Total => {
                let [first_orientation, second_orientation] = [i, j].map(|k| quaternion(self.orientation[k]));
                let free_strain = self.free_strain(plan, i, j);
                let posture = Posture { bonded_offset, first_orientation, second_orientation, free_strain };
                bond::respond_total(law.damping, &ends, &posture, &numbers)
            }
            Form::Incremental(tension) => {
                let unloaded = || History::unloaded(bonded_offset * (1.0 / bonded_length));
                let earlier = self.bond_histories.get(index).map_or_else(unloaded, BondHistory::law);
                // A step of zero length: the forces as they are.
                let advance = Advance { earlier, rest: Rest::of(bonded_length, 0.0, 0.0), step: 0.0 };
                bond::respond_incremental(tension, law.damping, &ends, &advance, &numbers).1
            }
        };
        Some(EvaluatedBond { ends, bond: numbers, reaction })
    }

    /// Evaluates a pair of particles; `None` if the state has no such particles.
    #[must_use]
    pub fn evaluate<'a>(&self, plan: &'a Plan, contact: &Contact) -> Option<Evaluated<'a>> {
        let (i, j) = (self.index_of(contact.first)?, self.index_of(contact.second)?);
        let felt = Felt::of(self, plan);
        let (first, second) = (felt.sphere(i), felt.sphere(j));
        let touch = self.touch(plan, i, j);
        let encounter = Encounter::of_spheres(&first, &second, &touch, plan.law.moments, felt.lead);
        let interaction = plan.interaction(self.material[i], self.material[j]);
        Some(evaluated(plan, (first, second.radius), touch, encounter, interaction, contact.displacement))
    }

    /// Evaluates a particle at a wall; `None` if there is no such particle or wall.
    #[must_use]
    pub fn evaluate_at_wall<'a>(&self, plan: &'a Plan, contact: &WallContact) -> Option<Evaluated<'a>> {
        let i = self.index_of(contact.particle)?;
        let wall = plan.walls.get(contact.wall as usize)?;
        let point = *self.wall_position.get(contact.wall as usize)?;
        let felt = Felt::of(self, plan);
        let (first, normal) = (felt.sphere(i), wall.normal.into());
        let touch = touch_wall(first.position, first.radius, point.into(), normal);
        let encounter = Encounter::with_wall(&first, &touch, normal, wall.velocity.into(), plan.law.moments, felt.lead);
        let interaction = plan.interaction(self.material[i], wall.material);
        Some(evaluated(plan, (first, f64::INFINITY), touch, encounter, interaction, contact.displacement))
    }

    fn touch(&self, plan: &Plan, i: usize, j: usize) -> Touch<f64> {
        let position = |index: usize| -> Vec3<f64> { self.position[index].into() };
        touch_spheres(plan.domain.period().nearest(position(j) - position(i)), self.radius[i] + self.radius[j])
    }

    /// The particle of an index, as laws see it.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn sphere(&self, index: usize) -> Sphere<f64> {
        Sphere {
            position: self.position[index].into(),
            radius: self.radius[index],
            velocity: self.velocity[index].into(),
            mass: self.mass[index],
            angular_velocity: self.angular_velocity[index].into(),
        }
    }
}

impl State {
    /// The same with the radius that its bonds have.
    pub(crate) fn bonded_sphere(&self, index: usize) -> Sphere<f64> {
        Sphere { radius: self.bonded_radius(index), ..self.sphere(index) }
    }
    /// Strain that a bond takes up without force.
    fn free_strain(&self, plan: &Plan, first: usize, second: usize) -> f64 {
        let Some(heat) = plan.heat.as_ref().filter(|heat| heat.expands()) else { return 0.0 };
        let [first_warmth, second_warmth] = [first, second].map(|k| self.temperature[k] - heat.reference_temperature);
        let link = self.link(plan, first, second);
        link.map_or(0.0, |link| link.free_strain(first_warmth, second_warmth))
    }
}

/// The velocities that the forces of a state were computed from.
///
/// # Numerics
/// Under velocity Verlet these are the velocities of the middle of the last step: the second half kick is taken back, so that
/// they, and the forces of dashpots, are those that the motion felt to rounding. Forces of a state that was only prepared were
/// computed from its own velocities.
struct Felt<'a> {
    state: &'a State,
    plan: &'a Plan,
    /// Time by which positions are ahead of velocities, s.
    lead: f64,
}

impl<'a> Felt<'a> {
    fn of(state: &'a State, plan: &'a Plan) -> Self {
        let stepped = state.step > 0 && state.forces_known;
        Felt { state, plan, lead: if stepped { plan.lead() } else { 0.0 } }
    }
    fn sphere(&self, index: usize) -> Sphere<f64> {
        let (state, sphere) = (self.state, self.state.sphere(index));
        if self.lead == 0.0 {
            return sphere;
        }
        let inertia = sphere_inertia(sphere.mass, sphere.radius);
        let velocity = verlet::kick(sphere.velocity, state.force[index].into(), sphere.mass, -self.lead);
        let angular_velocity = verlet::kick(sphere.angular_velocity, state.moment[index].into(), inertia, -self.lead);
        let felt = Sphere { velocity, angular_velocity, ..sphere };
        let constraint = usize::from(state.constraint[index]);
        if constraint == 0 {
            return felt;
        }
        let held = &self.plan.constraints_at(self.plan.middle(state.step - 1))[constraint];
        Sphere {
            velocity: prescribe(velocity, &held.velocity),
            angular_velocity: prescribe(angular_velocity, &held.angular_velocity),
            ..felt
        }
    }
}

fn evaluated<'a>(
    plan: &Plan,
    (first, second_radius): (Sphere<f64>, f64),
    touch: Touch<f64>,
    encounter: Encounter<f64>,
    interaction: &'a Interaction<f64>,
    displacement: [f64; 3],
) -> Evaluated<'a> {
    let displacement = displacement.into();
    let force = if touch.overlap > 0.0 {
        // A step of zero length: the force as it is, without moving the history.
        respond(plan.law, &encounter.advanced(), displacement, interaction, 0.0).force
    } else {
        Vec3::zero()
    };
    Evaluated { first, second_radius, touch, encounter, interaction, displacement, force }
}

/// An orientation as the law has it.
pub(crate) fn quaternion([x, y, z, scalar]: [f64; 4]) -> Quaternion<f64> {
    Quaternion { vector: vec3(x, y, z), scalar }
}
