//! Stage `gather`: adds what other rows keep for a particle, heat of contacts with it, then walls, then the sum of its
//! bonds.

use super::bodies::{Bodies, Quad, sphere};
use super::bonds::{Bonds, REACTION, Written};
use super::neighbours::{Neighbours, WallSlot, reaction_numbers};
use super::pieces::{chunks_of, split};
use super::wide::prefetch;
use super::{CHUNK, Cpu};
use crate::energy_accounts::{DAMPING, EXTERNAL, FRICTION, STIFFENING};
use crate::plan::overlap_ratio;
use crate::{Fault, Plan};
use rayon::prelude::*;
use std::hint::select_unpredictable;
use tdem_physics::contact::encounter::lever_arm;
use tdem_physics::contact::{Encounter, Kick, released_energy, respond, touch_wall};
use tdem_physics::{Vec3, vec3};

impl Cpu {
    /// Forces and moments of all particles; the fault of a particle that overlaps too much with a wall.
    pub(super) fn gather_all(&mut self) -> Result<(), Fault> {
        let n = self.bodies.len();
        let wall_bounds: Vec<usize> = self.neighbours.wall_start.iter().map(|&s| s as usize).collect();
        let mut wall_slots = std::mem::take(&mut self.neighbours.wall_slots);
        let (list, bonds) = (&self.neighbours, &self.bonds);
        let lead = self.lead();
        let Bodies { place, motion, spin, rank, material, constraint, force, moment, accounts, kick, twist, .. } =
            &mut self.bodies;
        let plan = &self.plan;
        let walls = Walls { plan, position: &self.wall_position, step: self.history_step, lead };
        let particles = chunks_of(n);
        let mut slots = split(&mut wall_slots, &wall_bounds);
        let add_incoming = adding(reaction_numbers(&self.plan));
        let mut moment = split(moment, &particles);
        let mut accounts = split(accounts, &particles);
        let tasks: Vec<_> = split(force, &particles)
            .map(|force| {
                let slots = slots.next().unwrap_or_default();
                (force, moment.next().unwrap_or_default(), accounts.next().unwrap_or_default(), slots)
            })
            .collect();
        let through = tasks.into_par_iter().enumerate().filter_map(|(chunk, (force, moment, accounts, slots))| {
            let mut through: Through = None;
            let mut slots = slots.iter_mut().peekable();
            for k in 0..force.len() {
                let i = chunk * CHUNK + k;
                let own = [force[k], moment.get(k).copied().unwrap_or_default()];
                let [with_heat, turning] = add_incoming(list, i, own);
                force[k] = with_heat;
                let mut sum = Sum { force: with_heat.vector(), moment: turning.vector() };
                while let Some(slot) = slots.next_if(|slot| slot.particle as usize == i) {
                    let sphere = sphere(&place[i], &motion[i], &spin[i]);
                    let kick = [kick.get(i), twist.get(i)].map(|k| k.copied().unwrap_or_default().vector());
                    let overlap = walls.add(&sphere, kick, material[i], slot, accounts.get_mut(k), &mut sum);
                    let too_much = overlap > plan.overlap_limit * sphere.radius;
                    if too_much && !rests_at(plan, constraint[i], slot.wall) {
                        let found = (rank[i], slot.wall);
                        through = Some(through.map_or(found, |known| known.min(found)));
                    }
                }
                add_bonds(bonds, i, &mut sum);
                force[k].set_vector(sum.force);
                if let Some(moment) = moment.get_mut(k) {
                    moment.set_vector(sum.moment);
                }
            }
            through
        });
        let through = through.min();
        self.neighbours.wall_slots = wall_slots;
        match through {
            None => Ok(()),
            Some((particle, wall)) => Err(self.through_wall(particle, wall)),
        }
    }

    /// The fault of a particle that overlaps too much with a wall.
    fn through_wall(&self, rank: u32, wall: u32) -> Fault {
        let index = self.bodies.rank.iter().position(|&r| r == rank).unwrap_or(0);
        let (place, index) = (self.bodies.place[index], wall as usize);
        let plane = &self.plan.walls[index];
        let touch = touch_wall(place.vector(), place.scalar(), self.wall_position[index].into(), plane.normal.into());
        Fault::WallOverlap {
            step: self.step,
            time: self.time(),
            particle: self.ids[rank as usize],
            wall: plane.name.clone(),
            ratio: overlap_ratio(touch.overlap, place.scalar(), f64::INFINITY),
            limit: self.plan.overlap_limit,
        }
    }
}

/// Whether neither a particle nor a wall moves: no overlap between them is too large.
fn rests_at(plan: &Plan, constraint: u16, wall: u32) -> bool {
    plan.holds(usize::from(constraint)) && plan.walls[wall as usize].rests()
}

/// The lowest rank that overlaps too much with a wall, and the first such wall, if any.
type Through = Option<(u32, u32)>;

/// Particles ahead whose incoming records are asked for.
const AHEAD: usize = 6;

/// Force and moment on a particle so far.
struct Sum {
    force: Vec3<f64>,
    moment: Vec3<f64>,
}

/// Adds the pairs that particles of lower rank keep to force and heat rate of a particle, and to its moment.
type Adding = fn(&Neighbours, usize, [Quad; 2]) -> [Quad; 2];

/// For so many numbers of [`reaction_numbers`].
fn adding(numbers: usize) -> Adding {
    match numbers {
        3 => add_incoming::<3>,
        4 => add_incoming::<4>,
        6 => add_incoming::<6>,
        _ => add_incoming::<7>,
    }
}

fn add_incoming<const NUMBERS: usize>(list: &Neighbours, i: usize, [mut force, mut moment]: [Quad; 2]) -> [Quad; 2] {
    let (moments, warm) = (NUMBERS >= 6, NUMBERS % 3 == 1);
    // Which pairs touch no machine can foretell: those that do not add zeros, which change no bit.
    let nothing = &[0.0; NUMBERS][..];
    if i + AHEAD + 1 < list.incoming_start.len() {
        for &pair in list.incoming(i + AHEAD) {
            let at = select_unpredictable(list.touching[pair as usize], NUMBERS * pair as usize, 0);
            prefetch(&list.reaction, at);
            prefetch(&list.reaction, at + NUMBERS - 1);
        }
    }
    for &pair in list.incoming(i) {
        let at = NUMBERS * pair as usize;
        let felt = select_unpredictable(list.touching[pair as usize], &list.reaction[at..at + NUMBERS], nothing);
        for k in 0..3 {
            force.0[k] -= felt[k];
        }
        if warm {
            force.0[3] -= felt[NUMBERS - 1];
        }
        if moments {
            for k in 0..3 {
                moment.0[k] += felt[3 + k];
            }
        }
    }
    [force, moment]
}

/// Adds the sum of a particle's bonds: its own row's, then what particles of lower rank keep.
#[inline(always)]
fn add_bonds(bonds: &Bonds, i: usize, sum: &mut Sum) {
    let Written { reaction, force, moment, .. } = &bonds.written;
    let (Some(force), Some(moment)) = (force.get(i), moment.get(i)) else { return };
    let (mut force, mut moment) = (force.vector(), moment.vector());
    for &slot in bonds.incoming(i + AHEAD) {
        prefetch(reaction, REACTION * slot as usize);
        prefetch(reaction, REACTION * slot as usize + REACTION - 1);
    }
    for &slot in bonds.incoming(i) {
        let slot = slot as usize;
        if bonds.holds[slot] {
            let reaction = &reaction[REACTION * slot..REACTION * (slot + 1)];
            force = force - vec3(reaction[0], reaction[1], reaction[2]);
            moment = moment + vec3(reaction[3], reaction[4], reaction[5]);
        }
    }
    sum.force = sum.force + force;
    sum.moment = sum.moment + moment;
}

/// What contacts with walls need.
struct Walls<'a> {
    plan: &'a Plan,
    position: &'a [[f64; 3]],
    step: f64,
    lead: f64,
}

impl Walls<'_> {
    /// Adds the contact of a particle with a wall, if they touch; returns their overlap, m.
    fn add(
        &self,
        sphere: &tdem_physics::contact::Sphere<f64>,
        [kick, twist]: [Vec3<f64>; 2],
        material: u16,
        slot: &mut WallSlot,
        account: Option<&mut [f64; 4]>,
        sum: &mut Sum,
    ) -> f64 {
        let wall = &self.plan.walls[slot.wall as usize];
        let (law, step) = (self.plan.law, self.step);
        let (normal, velocity): (Vec3<f64>, Vec3<f64>) = (wall.normal.into(), wall.velocity.into());
        let interaction = self.plan.interaction(material, wall.material);
        let point = self.position[slot.wall as usize].into();
        let touch = touch_wall(sphere.position, sphere.radius, point, normal);
        let encounter = Encounter::with_wall(sphere, &touch, normal, velocity, law.moments, self.lead);
        slot.made = 0.0;
        if touch.overlap <= 0.0 {
            if slot.touching {
                if let Some(account) = account {
                    account[STIFFENING] -= released_energy(&encounter, slot.displacement.into(), interaction, step);
                }
                slot.displacement = [0.0; 3];
                slot.touching = false;
            }
            return touch.overlap;
        }
        let arm = lever_arm(sphere.radius, touch.overlap);
        let encounter = encounter.settled([Kick { velocity: kick, rolling: twist * arm }, Kick::none()]);
        let response = respond(law, &encounter, slot.displacement.into(), interaction, step);
        slot.touching = true;
        slot.displacement = response.displacement.into();
        sum.force = sum.force + response.force;
        if law.moments {
            sum.moment = sum.moment + response.moment_per_arm * arm;
        }
        if let Some(account) = account {
            account[FRICTION] += response.losses.friction;
            account[DAMPING] += response.losses.damping;
            account[STIFFENING] += response.losses.stiffening;
            account[EXTERNAL] += response.force.dot(velocity) * step;
            if let Some(heat) = &self.plan.heat {
                slot.made = heat.dissipation.heat(response.losses.friction, response.losses.damping);
            }
        }
        touch.overlap
    }
}
