//! What stays the same during a run.

use crate::{BondPlan, Gauge, HeatPlan, Motion};
use std::borrow::Cow;
use tdem_physics::Vec3;
use tdem_physics::contact::{Interaction, Law, Period};
use tdem_physics::motion::ramp::line;

/// Laws, walls, boundary conditions and step of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// $\Delta t$, s.
    pub dt: f64,
    /// How particles move.
    pub integrator: Integrator,
    /// Which contact law acts.
    pub law: Law,
    /// Number of materials, walls' included.
    pub materials: usize,
    /// Parameters of each pair of materials, `(materials, materials)`, symmetric, row by row.
    pub interactions: Vec<Interaction<f64>>,
    /// How bonded particles hold together; `None` if none are.
    pub bonds: Option<BondPlan>,
    /// How heat goes and what it does; `None` without heat.
    pub heat: Option<HeatPlan>,
    /// Walls; their present positions are in [`crate::State::wall_position`].
    pub walls: Vec<Wall>,
    /// $\mathbf g$, m/s².
    pub gravity: [f64; 3],
    /// What particles may be forbidden or ordered to do; the first entry is [`Constraint::FREE`].
    pub constraints: Vec<Constraint>,
    /// Numbers of constraints that change with time.
    pub ramps: Vec<Ramp>,
    /// Groups of particles that are watched.
    pub gauges: Vec<Gauge>,
    /// Where particles may be.
    pub domain: Domain,
    /// How neighbours are found.
    pub search: Search,
    /// Largest overlap, as a fraction of the smaller radius of a pair, or of the radius at a wall; a larger one is a fault.
    pub overlap_limit: f64,
    /// Whether dissipated energy is accounted for, step by step.
    pub ledger: bool,
}

impl Plan {
    /// Parameters of a pair of materials.
    #[must_use]
    pub fn interaction(&self, first: u16, second: u16) -> &Interaction<f64> {
        &self.interactions[usize::from(first) * self.materials + usize::from(second)]
    }
    /// Time after a number of steps, s.
    #[must_use]
    pub fn time(&self, step: u64) -> f64 {
        step as f64 * self.dt
    }
    /// Time in the middle of the step that follows so many others, s.
    #[must_use]
    pub fn middle(&self, step: u64) -> f64 {
        (step as f64 + 0.5) * self.dt
    }
    /// Time by which positions are ahead of the velocities that forces are computed from, s: half a step under velocity
    /// Verlet; none under Gear, or where nothing moves.
    #[must_use]
    pub fn lead(&self) -> f64 {
        let dt = match self.heat.as_ref().map_or(Motion::Stepped, |heat| heat.motion) {
            Motion::Stepped => self.dt,
            Motion::QuasiStatic(relaxation) => relaxation.dt,
            Motion::Frozen(_) => 0.0,
        };
        match self.integrator {
            Integrator::VelocityVerlet => 0.5 * dt,
            Integrator::Gear => 0.0,
        }
    }
    /// The constraints as they are at a time.
    #[must_use]
    pub fn constraints_at(&self, time: f64) -> Cow<'_, [Constraint]> {
        let mut constraints = Cow::Borrowed(&self.constraints[..]);
        for ramp in &self.ramps {
            let constraint = &mut constraints.to_mut()[usize::from(ramp.constraint)];
            let (value, axis) = (ramp.value(time), ramp.axis);
            match ramp.drives {
                Driven::Velocity => constraint.velocity[axis] = Some(value),
                Driven::AngularVelocity => constraint.angular_velocity[axis] = Some(value),
                Driven::Force => constraint.force[axis] = value,
            }
        }
        constraints
    }
    /// Whether forces are applied to any particle.
    #[must_use]
    pub fn applies_forces(&self) -> bool {
        self.constraints.iter().any(|constraint| constraint.force != [0.0; 3])
            || self.ramps.iter().any(|ramp| ramp.drives == Driven::Force)
    }
}

/// How particles move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Velocity Verlet, angular velocity kicked by halves.
    VelocityVerlet,
    /// Gear's fifth-order predictor-corrector, angular velocity by Euler's rule (the paper's).
    Gear,
}

/// Overlap of two spheres, or of a sphere and a wall (of infinite radius), as a fraction of the smaller radius: 2 where the
/// smaller sphere is all inside the larger body.
pub(crate) fn overlap_ratio(overlap: f64, first_radius: f64, second_radius: f64) -> f64 {
    overlap / first_radius.min(second_radius)
}

/// A plane wall, infinite, moving in a straight line.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Its name in the case and in messages.
    pub name: String,
    /// Unit normal, towards the particles.
    pub normal: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Index of its material.
    pub material: u16,
}

impl Wall {
    /// Whether it stays where it is.
    pub(crate) fn rests(&self) -> bool {
        self.velocity == [0.0; 3]
    }
}

/// Components of motion that forces do not govern, and a force that is applied from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// Prescribed velocity per component, m/s; `None` leaves the component to the forces.
    pub velocity: [Option<f64>; 3],
    /// Prescribed angular velocity per component, rad/s.
    pub angular_velocity: [Option<f64>; 3],
    /// Applied to each particle, N.
    pub force: [f64; 3],
}

impl Constraint {
    /// Everything is left to the forces of contacts, bonds and gravity.
    pub const FREE: Constraint = Constraint { velocity: [None; 3], angular_velocity: [None; 3], force: [0.0; 3] };
}

/// A velocity with prescribed components in the place of computed ones.
#[inline(always)]
pub(crate) fn prescribe(velocity: Vec3<f64>, prescribed: &[Option<f64>; 3]) -> Vec3<f64> {
    let [x, y, z] = prescribed;
    Vec3 { x: x.unwrap_or(velocity.x), y: y.unwrap_or(velocity.y), z: z.unwrap_or(velocity.z) }
}

/// A number of a constraint that changes with time: straight between points, constant before the first and behind the
/// last. It replaces what the constraint says.
///
/// Velocities are taken where the integrator needs them. Under velocity Verlet a particle drifts with the velocity of the
/// middle of the step, which integrates straight pieces between steps exactly, and has the velocity of the end of the
/// step when the step is over; under Gear the same holds. A force is that of the time for which forces are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// Index of the constraint.
    pub constraint: u16,
    /// What changes.
    pub drives: Driven,
    /// Its component: 0, 1 or 2.
    pub axis: usize,
    /// Time, s, and value, m/s, rad/s or N; at least one point, times strictly ascending.
    pub points: Vec<[f64; 2]>,
}

/// What a ramp changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    /// A prescribed velocity.
    Velocity,
    /// A prescribed angular velocity.
    AngularVelocity,
    /// An applied force.
    Force,
}

impl Ramp {
    /// The value at a time.
    #[must_use]
    pub fn value(&self, time: f64) -> f64 {
        value_at(&self.points, time)
    }
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Piece> {
        pieces(&self.points)
    }

    /// Whether the points say something, in the order of time, and nothing else but finite numbers.
    fn is_sound(&self) -> bool {
        !self.points.is_empty()
            && self.axis < 3
            && self.points.iter().flatten().all(|number| number.is_finite())
            && self.points.is_sorted_by(|a, b| a[0] < b[0])
    }
}

/// The value at a time of points of time and value: straight between them, constant outside.
pub(crate) fn value_at(points: &[[f64; 2]], time: f64) -> f64 {
    piece(points, points.partition_point(|point| point[0] <= time)).value(time)
}

/// The straight pieces between points, those before the first and behind the last included: they cover all times.
pub(crate) fn pieces(points: &[[f64; 2]]) -> impl Iterator<Item = Piece> {
    let count = if points.is_empty() { 0 } else { points.len() + 1 };
    (0..count).map(|k| piece(points, k))
}

/// The piece behind so many points; before the first and behind the last it is level.
pub(crate) fn piece(points: &[[f64; 2]], behind: usize) -> Piece {
    let level =
        |from, until, [time, value]: [f64; 2]| Piece { from, until, start: [time, value], end: [time + 1.0, value] };
    match (behind.checked_sub(1).map(|k| points[k]), points.get(behind)) {
        (Some(start), Some(&end)) => Piece { from: start[0], until: end[0], start, end },
        (None, Some(&first)) => level(f64::NEG_INFINITY, first[0], first),
        (Some(last), None) => level(last[0], f64::INFINITY, last),
        (None, None) => level(f64::NEG_INFINITY, f64::INFINITY, [0.0, f64::NAN]),
    }
}

/// A straight piece of a ramp, course or table, which holds at times from one, included, until another, not included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) from: f64,
    pub(crate) until: f64,
    /// Two points of the line.
    pub(crate) start: [f64; 2],
    pub(crate) end: [f64; 2],
}

impl Piece {
    fn value(&self, time: f64) -> f64 {
        line(self.start, self.end, time)
    }
}

impl Plan {
    /// Whether a constraint keeps particles where they are, and from turning where the law lets them turn. Between two such
    /// particles no overlap is too large.
    #[must_use]
    pub fn holds(&self, constraint: usize) -> bool {
        let still = |components: &[Option<f64>; 3]| components.iter().all(|component| *component == Some(0.0));
        let driven =
            self.ramps.iter().any(|ramp| usize::from(ramp.constraint) == constraint && ramp.drives != Driven::Force);
        self.constraints.get(constraint).is_some_and(|held| {
            !driven && still(&held.velocity) && (!self.law.moments || still(&held.angular_velocity))
        })
    }

    /// Whether every ramp drives what there is.
    pub(crate) fn ramps_are_sound(&self) -> bool {
        self.ramps.iter().all(|ramp| {
            let constraint = self.constraints.get(usize::from(ramp.constraint));
            ramp.is_sound()
                && constraint.is_some_and(|constraint| match ramp.drives {
                    Driven::Velocity => constraint.velocity[ramp.axis].is_some(),
                    Driven::AngularVelocity => constraint.angular_velocity[ramp.axis].is_some(),
                    Driven::Force => ramp.constraint > 0,
                })
        })
    }
}

/// Where particles may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Lower corner, m.
    pub min: [f64; 3],
    /// Upper corner, m.
    pub max: [f64; 3],
    /// Directions in which the box repeats; in the others, a centre outside it is a fault.
    pub periodic: [bool; 3],
}

impl Domain {
    /// Extent, m.
    #[must_use]
    pub fn length(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.max[k] - self.min[k])
    }
    /// The lengths that repeat.
    #[must_use]
    pub fn period(&self) -> Period<f64> {
        let length = self.length();
        Period::new(std::array::from_fn(|k| self.periodic[k].then_some(length[k])))
    }
}

/// How neighbours are found. None of these changes a bit of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Pairs are listed up to this gap, m; the list holds until something has moved half of it.
    pub skin: f64,
    /// List anew in every step, as the paper does.
    pub every_step: bool,
}
