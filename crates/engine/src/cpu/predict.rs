//! Stage `predict`: particles and walls move to the end of the step, temperatures and radii follow.

use super::bodies::{Quad, trajectory};
use super::heat::{Chunk, Kept, Warmed, Warming};
use super::{CHUNK, Cpu};
use crate::evaluate::quaternion;
use crate::plan::prescribe;
use crate::{Constraint, Domain, Fault, Integrator};
use rayon::prelude::*;
use tdem_physics::motion::{gear, sphere_inertia, verlet};
use tdem_physics::{Vec3, contact::Period};

/// What a chunk of particles reports: the largest squared ways since the last search and in this step, and the lowest
/// rank astray.
#[derive(Clone, Copy)]
struct Report {
    way_squared: f64,
    step_squared: f64,
    astray: u32,
}

const NONE: u32 = u32::MAX;

impl Report {
    const START: Report = Report { way_squared: 0.0, step_squared: 0.0, astray: NONE };
    fn merge(self, other: Report) -> Report {
        Report {
            way_squared: self.way_squared.max(other.way_squared),
            step_squared: self.step_squared.max(other.step_squared),
            astray: self.astray.min(other.astray),
        }
    }
}

impl Cpu {
    /// Predicts all particles, moves the walls, and notes whether the neighbour list still holds.
    pub(super) fn predict_all(&mut self) -> Result<(), Fault> {
        let dt = self.plan.dt;
        self.move_walls();
        let (domain, period) = (self.plan.domain, self.plan.domain.period());
        let wraps = period.any();
        // The step is counted already.
        let middle = self.plan.constraints_at(self.plan.middle(self.step - 1));
        let end = self.plan.constraints_at(self.plan.time(self.step));
        let (integrator, moments) = (self.plan.integrator, self.plan.law.moments);
        let bodies = &mut self.bodies;
        let kept = Kept {
            rank: &bodies.rank,
            material: &bodies.material,
            exposure: &bodies.exposure,
            reference_radius: &bodies.reference_radius,
            listed_radius: &self.neighbours.listed_radius,
            work_per_kelvin: &bodies.work_per_kelvin,
        };
        let heat = Warming::of(&self.plan, self.step, kept);
        let (report, warmed) = (
            bodies.place.par_chunks_mut(CHUNK),
            bodies.motion.par_chunks_mut(CHUNK),
            bodies.spin.par_chunks_mut(CHUNK),
            bodies.force.par_chunks(CHUNK),
            bodies.constraint.par_chunks(CHUNK),
            bodies.rank.par_chunks(CHUNK),
            self.neighbours.reference.par_chunks(CHUNK),
            optional(&mut bodies.derivatives),
            optional(&mut bodies.image),
            optional(&mut bodies.moment),
            (optional(&mut bodies.kick), optional(&mut bodies.twist), optional(&mut bodies.orientation)),
            (optional(&mut bodies.temperature), optional(&mut bodies.heat_accounts), optional(&mut bodies.warming)),
        )
            .into_par_iter()
            .enumerate()
            .map(
                |(
                    chunk,
                    (
                        place,
                        motion,
                        spin,
                        force,
                        constraint,
                        rank,
                        reference,
                        derivatives,
                        image,
                        moment,
                        (kick, twist, orientation),
                        (temperature, accounts, warming),
                    ),
                )| {
                    let mut report = Report::START;
                    for i in 0..place.len() {
                        let [constraint, at_end] = [&middle, &end].map(|table| &table[usize::from(constraint[i])]);
                        let before = place[i].vector();
                        let moving = [motion[i].vector(), spin[i].vector()];
                        match integrator {
                            Integrator::VelocityVerlet => {
                                verlet_particle(&mut place[i], &mut motion[i], &force[i], constraint, dt);
                            }
                            Integrator::Gear => {
                                let (motion, derivatives) = (&mut motion[i], &mut derivatives[i]);
                                gear_particle(&mut place[i], motion, derivatives, [constraint, at_end], dt);
                            }
                        }
                        if moments && integrator == Integrator::VelocityVerlet {
                            let inertia = sphere_inertia(motion[i].scalar(), place[i].scalar());
                            let kicked = verlet::kick(spin[i].vector(), moment[i].vector(), inertia, 0.5 * dt);
                            spin[i].set_vector(prescribe(kicked, &constraint.angular_velocity));
                        }
                        if let Some(orientation) = orientation.get_mut(i) {
                            turn(orientation, &spin[i], dt);
                        }
                        if let Some(kick) = kick.get_mut(i) {
                            kick.set_vector(motion[i].vector() - moving[0]);
                        }
                        if let Some(twist) = twist.get_mut(i) {
                            twist.set_vector(spin[i].vector() - moving[1]);
                        }
                        let step = place[i].vector() - before;
                        report.step_squared = report.step_squared.max(step.dot(step));
                        if wraps {
                            wrap(&mut place[i], &mut image[i], &domain);
                        }
                        if !inside(&place[i], &domain) {
                            report.astray = report.astray.min(rank[i]);
                        }
                        let way = way(&place[i], reference[i], wraps.then_some(&period));
                        report.way_squared = report.way_squared.max(way);
                    }
                    let first = chunk * CHUNK;
                    let chunk = Chunk { first, motion, force, place, temperature, accounts, warming };
                    (report, heat.as_ref().map_or(Warmed::NOTHING, |heat| heat.warm(chunk)))
                },
            )
            .reduce(|| (Report::START, Warmed::NOTHING), |a, b| (a.0.merge(b.0), a.1.merge(b.1)));
        self.heed(report, warmed)
    }

    /// Whether the neighbour list still holds, or what went wrong.
    fn heed(&mut self, report: Report, warmed: Warmed) -> Result<(), Fault> {
        if report.astray != NONE {
            return Err(self.astray(report.astray));
        }
        if warmed.wrong != NONE {
            return Err(self.unphysical(warmed.wrong));
        }
        self.step_way = report.step_squared.sqrt().max(self.wall_step()) + warmed.shrinkage;
        let half_skin = 0.5 * self.plan.search.skin - warmed.since_listed;
        self.search_due = half_skin < 0.0
            || report.way_squared > half_skin * half_skin
            || self.neighbours.wall_way(&self.wall_position) > half_skin;
        Ok(())
    }

    fn move_walls(&mut self) {
        for (position, wall) in self.wall_position.iter_mut().zip(&self.plan.walls) {
            *position = verlet::drift((*position).into(), wall.velocity.into(), self.plan.dt).into();
        }
    }

    /// The way of the fastest wall in one step, m.
    pub(super) fn wall_step(&self) -> f64 {
        self.plan.walls.iter().fold(0.0, |largest: f64, wall| {
            let velocity: Vec3<f64> = wall.velocity.into();
            largest.max(velocity.dot(velocity).sqrt() * self.plan.dt)
        })
    }

    /// The fault of a particle that is nowhere or outside.
    fn astray(&self, rank: u32) -> Fault {
        let (step, time, particle) = (self.step, self.time(), self.ids[rank as usize]);
        let index = self.bodies.rank.iter().position(|&r| r == rank).unwrap_or(0);
        let [x, y, z, _] = self.bodies.place[index].0;
        if [x, y, z].iter().all(|c| c.is_finite()) {
            Fault::Escaped { step, time, particle, position: [x, y, z] }
        } else {
            Fault::NotFinite { step, time, particle }
        }
    }
}

/// A field cut into chunks like the others; one empty slice per chunk where the plan does without it.
pub(crate) fn optional<T: Send>(field: &mut [T]) -> Optional<'_, T> {
    let left = if field.is_empty() { usize::MAX / CHUNK } else { field.len().div_ceil(CHUNK) };
    Optional { field, left }
}

/// Chunks of a field, or empty ones without end: one type for both, so that nothing is compiled twice for it.
pub(crate) struct Optional<'a, T> {
    field: &'a mut [T],
    left: usize,
}

impl<'a, T: Send> ParallelIterator for Optional<'a, T> {
    type Item = &'a mut [T];
    fn drive_unindexed<C: rayon::iter::plumbing::UnindexedConsumer<Self::Item>>(self, consumer: C) -> C::Result {
        rayon::iter::plumbing::bridge(self, consumer)
    }
    fn opt_len(&self) -> Option<usize> {
        Some(self.left)
    }
}

impl<T: Send> IndexedParallelIterator for Optional<'_, T> {
    fn len(&self) -> usize {
        self.left
    }
    fn drive<C: rayon::iter::plumbing::Consumer<Self::Item>>(self, consumer: C) -> C::Result {
        rayon::iter::plumbing::bridge(self, consumer)
    }
    fn with_producer<CB: rayon::iter::plumbing::ProducerCallback<Self::Item>>(self, callback: CB) -> CB::Output {
        callback.callback(self)
    }
}

impl<'a, T: Send> rayon::iter::plumbing::Producer for Optional<'a, T> {
    type Item = &'a mut [T];
    type IntoIter = Self;
    fn into_iter(self) -> Self {
        self
    }
    fn split_at(self, index: usize) -> (Self, Self) {
        let at = (index * CHUNK).min(self.field.len());
        let (before, behind) = self.field.split_at_mut(at);
        (Optional { field: before, left: index }, Optional { field: behind, left: self.left - index })
    }
}

impl<'a, T> Iterator for Optional<'a, T> {
    type Item = &'a mut [T];
    fn next(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let field = std::mem::take(&mut self.field);
        let (chunk, rest) = field.split_at_mut(CHUNK.min(field.len()));
        self.field = rest;
        Some(chunk)
    }
    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl<T> ExactSizeIterator for Optional<'_, T> {}

impl<T> DoubleEndedIterator for Optional<'_, T> {
    fn next_back(&mut self) -> Option<Self::Item> {
        self.left = self.left.checked_sub(1)?;
        let field = std::mem::take(&mut self.field);
        let at = (self.left * CHUNK).min(field.len());
        let (rest, chunk) = field.split_at_mut(at);
        self.field = rest;
        Some(chunk)
    }
}

#[inline(always)]
fn verlet_particle(place: &mut Quad, motion: &mut Quad, force: &Quad, constraint: &Constraint, dt: f64) {
    let kicked = verlet::kick(motion.vector(), force.vector(), motion.scalar(), 0.5 * dt);
    let velocity = prescribe(kicked, &constraint.velocity);
    motion.set_vector(velocity);
    place.set_vector(verlet::drift(place.vector(), velocity, dt));
}

/// Under velocity Verlet the angular velocity is that of the middle of the step, under Gear that of its beginning.
#[inline(always)]
fn turn(orientation: &mut Quad, spin: &Quad, dt: f64) {
    let turned = quaternion(orientation.0).turned(spin.vector(), dt);
    *orientation = Quad::new(turned.vector.into(), turned.scalar);
}

/// Prescribed components have no higher derivatives, so that the predictor moves them by V dt, with the V of the middle of
/// the step; behind it they have that of its end.
#[inline(always)]
fn gear_particle(
    place: &mut Quad,
    motion: &mut Quad,
    derivatives: &mut [[f64; 3]; 4],
    [middle, end]: [&Constraint; 2],
    dt: f64,
) {
    motion.set_vector(prescribe(motion.vector(), &middle.velocity));
    let predicted = gear::predict(&trajectory(place, motion, derivatives), dt);
    place.set_vector(predicted.position);
    motion.set_vector(prescribe(predicted.velocity, &end.velocity));
    *derivatives = predicted.derivatives.map(Into::into);
}

/// Brings a centre that left through a face that repeats back in through the opposite one.
#[inline(always)]
fn wrap(place: &mut Quad, image: &mut [i32; 3], domain: &Domain) {
    for k in 0..3 {
        if domain.periodic[k] {
            let length = domain.max[k] - domain.min[k];
            if place.0[k] >= domain.max[k] {
                place.0[k] -= length;
                image[k] += 1;
            } else if place.0[k] < domain.min[k] {
                place.0[k] += length;
                image[k] -= 1;
            }
        }
    }
}

/// Whether a centre is in the domain; false also for what is not a number.
#[inline(always)]
fn inside(place: &Quad, domain: &Domain) -> bool {
    (0..3).all(|k| place.0[k] >= domain.min[k] && place.0[k] <= domain.max[k])
}

/// Squared way from the reference point.
#[inline(always)]
fn way(place: &Quad, reference: [f64; 3], period: Option<&Period<f64>>) -> f64 {
    let way = place.vector() - reference.into();
    let way = period.map_or(way, |p| p.nearest(way));
    way.dot(way)
}
