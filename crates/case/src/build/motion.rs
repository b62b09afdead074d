//! What particles are forbidden or ordered to do.

use super::Context;
use super::draft::Draft;
use crate::check::COMPONENTS;
use crate::codes;
use crate::problem::{Problem, counted, number};
use crate::schema::{Axis, Component, Course, Force, Prescribed};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use tdem_engine::{Constraint, Driven, Ramp};

/// A table of the case that orders something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Origin {
    /// "particles", "zone" or "symmetry".
    table: &'static str,
    index: usize,
}

/// What is asked of a particle, and by whom.
#[derive(Clone, Debug, Default)]
struct Orders {
    /// Rates in the order of [`Component`].
    rates: [Option<(Course, Origin)>; 6],
    /// Forces that add up, each this particle's part.
    forces: [Vec<(Course, Origin)>; 3],
}

impl Orders {
    fn of(fixed: &[Component], prescribed: &Prescribed, force: &Force, members: usize, origin: Origin) -> Self {
        let mut orders = Orders::default();
        for (rate, prescribed) in orders.rates.iter_mut().zip(prescribed.components()) {
            *rate = prescribed.map(|course| (course.clone(), origin));
        }
        for component in fixed {
            orders.rates[*component as usize] = Some((Course::Constant(0.0), origin));
        }
        for (forces, force) in orders.forces.iter_mut().zip(force.components()) {
            forces.extend(force.map(|course| (course.shared(members), origin)));
        }
        orders
    }

    fn is_empty(&self) -> bool {
        self.rates.iter().all(Option::is_none) && self.forces.iter().all(Vec::is_empty)
    }

    /// What all ask for together, and components of which two ask for different things.
    fn and(&self, other: &Orders) -> (Orders, Vec<Clash>) {
        let (mut both, mut clashes) = (self.clone(), Vec::new());
        for (component, (rate, ordered)) in both.rates.iter_mut().zip(&other.rates).enumerate() {
            match (&rate, ordered) {
                (Some((known, first)), Some((new, second))) if !known.is_like(new) => {
                    clashes.push(Clash { component, first: *first, second: *second });
                }
                (None, Some(_)) => rate.clone_from(ordered),
                _ => {}
            }
        }
        for (forces, more) in both.forces.iter_mut().zip(&other.forces) {
            forces.extend(more.iter().cloned());
        }
        (both, clashes)
    }

    /// Components that a force is applied to though they are prescribed.
    fn forced(&self) -> impl Iterator<Item = Clash> + '_ {
        self.forces.iter().zip(&self.rates).enumerate().filter_map(|(component, (forces, rate))| {
            let ((_, first), (_, second)) = (rate.as_ref()?, forces.first()?);
            Some(Clash { component, first: *first, second: *second })
        })
    }

    /// The numbers of the engine, those of ramps as they are at the start.
    fn constraint(&self) -> Constraint {
        let [x, y, z, rx, ry, rz] = self.rates.each_ref().map(|rate| rate.as_ref().map(|(course, _)| course.at(0.0)));
        let force =
            self.forces.each_ref().map(|forces| forces.iter().fold(0.0, |sum, (course, _)| sum + course.at(0.0)));
        Constraint { velocity: [x, y, z], angular_velocity: [rx, ry, rz], force }
    }

    /// What changes with time.
    fn ramps(&self) -> Vec<Ramp> {
        let rates = self.rates.iter().enumerate().filter_map(|(component, rate)| {
            let drives = if component < 3 { Driven::Velocity } else { Driven::AngularVelocity };
            Some((drives, component % 3, rate.as_ref()?.0.points()))
        });
        let forces = self.forces.iter().enumerate().filter(|(_, forces)| !forces.is_empty());
        let forces = forces.map(|(axis, forces)| (Driven::Force, axis, sum(forces)));
        rates
            .chain(forces)
            .filter(|(_, _, points)| points.len() > 1)
            .map(|(drives, axis, points)| Ramp { constraint: 0, drives, axis, points })
            .collect()
    }
}

/// Points of the sum of courses: a corner wherever one of them has one.
fn sum(courses: &[(Course, Origin)]) -> Vec<[f64; 2]> {
    let mut times: Vec<f64> = courses.iter().flat_map(|(course, _)| course.points()).map(|[time, _]| time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.iter().map(|&time| [time, courses.iter().fold(0.0, |sum, (course, _)| sum + course.at(time))]).collect()
}

/// Two tables that ask one particle for different things.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Clash {
    component: usize,
    first: Origin,
    second: Origin,
}

/// What all particles are asked for: [`tdem_engine::State::constraint`] is an index into the table.
pub(super) struct Motion {
    table: Vec<Orders>,
}

impl Motion {
    /// Takes the orders of all groups, then those of all zones. Whatever two of them contradict each other in is a problem.
    pub(super) fn of(context: &Context<'_>, draft: &mut Draft, zones: &[Vec<u32>]) -> (Motion, Vec<Problem>) {
        let case = &context.loaded.case;
        let mut motion = Motion { table: vec![Orders::default()] };
        let mut sizes = vec![0; case.particles.len()];
        draft.group.iter().for_each(|&group| sizes[usize::from(group)] += 1);
        let of_group: Vec<u16> = (case.particles.iter().enumerate())
            .map(|(index, group)| {
                let origin = Origin { table: "particles", index };
                motion.entry(Orders::of(&group.fixed, &group.prescribed, &group.force, sizes[index], origin))
            })
            .collect();
        for (constraint, &group) in draft.state.constraint.iter_mut().zip(&draft.group) {
            *constraint = of_group[usize::from(group)];
        }
        let mut clashes = BTreeSet::new();
        for (index, (zone, members)) in case.zone.iter().zip(zones).enumerate() {
            let origin = Origin { table: "zone", index };
            let orders = Orders::of(&zone.fixed, &zone.prescribed, &zone.force, members.len(), origin);
            if !orders.is_empty() {
                clashes.extend(motion.add(draft, members, &orders));
            }
        }
        let forced: BTreeSet<Clash> = motion.table.iter().flat_map(Orders::forced).collect();
        let problems = clashes.iter().map(|clash| clash.of_motion(context));
        let problems = problems.chain(forced.iter().map(|clash| clash.of_force(context))).collect();
        (motion, problems)
    }

    fn entry(&mut self, orders: Orders) -> u16 {
        if orders.is_empty() {
            return 0;
        }
        self.table.push(orders);
        (self.table.len() - 1) as u16
    }

    /// Adds orders to those of some particles.
    fn add(&mut self, draft: &mut Draft, members: &[u32], orders: &Orders) -> Vec<Clash> {
        let (mut becomes, mut clashes) = (BTreeMap::new(), Vec::new());
        for &member in members {
            let constraint = &mut draft.state.constraint[member as usize];
            *constraint = *becomes.entry(*constraint).or_insert_with(|| {
                let (both, found) = self.table[usize::from(*constraint)].and(orders);
                clashes.extend(found);
                self.entry(both)
            });
        }
        clashes
    }

    /// Applies planes of symmetry. A mirror image has the opposite normal velocity and the opposite angular velocity in
    /// the plane, so a particle on the plane has none of these; forces along the normal cancel.
    pub(super) fn symmetry(&mut self, context: &Context<'_>, draft: &mut Draft) -> Vec<Problem> {
        let mut problems = Vec::new();
        for (index, plane) in context.loaded.case.symmetry.iter().enumerate() {
            let (axis, name) = match plane.axis {
                Axis::X => (0, "x"),
                Axis::Y => (1, "y"),
                Axis::Z => (2, "z"),
            };
            let place = context.loaded.tree.place(&["symmetry", &index.to_string(), "at"]);
            let origin = Origin { table: "symmetry", index };
            let mut nearest = f64::INFINITY;
            let mut on_plane = Vec::new();
            for (particle, position) in draft.state.position.iter().enumerate() {
                let distance = (position[axis] - plane.at).abs();
                nearest = nearest.min(distance);
                if distance <= 1e-6 * draft.state.radius[particle] {
                    on_plane.push(particle as u32);
                }
            }
            if on_plane.is_empty() {
                problems.push(
                    Problem::new(codes::SYMMETRY_EMPTY, format!("no centre lies on the plane {name} = {} m", plane.at))
                        .at(place.clone(), format!("the nearest centre is {} m away", number(nearest)))
                        .help("a plane of symmetry goes through centres of particles"),
                );
            }
            let mut mirror = Orders::default();
            let still = || Some((Course::Constant(0.0), origin));
            mirror.rates[axis] = still();
            (0..3).filter(|&d| d != axis).for_each(|d| mirror.rates[3 + d] = still());
            let leaves = |particle: &&u32| {
                let orders = &self.table[usize::from(draft.state.constraint[**particle as usize])];
                !orders.and(&mirror).1.is_empty() || !orders.forces[axis].is_empty()
            };
            let conflicts = on_plane.iter().filter(leaves).count();
            self.add(draft, &on_plane, &mirror);
            if conflicts > 0 {
                let who = counted(conflicts, "particle");
                problems.push(
                    Problem::new(
                        codes::SYMMETRY_CONFLICT,
                        format!("{who} on the plane {name} = {} m prescribed to leave it", plane.at),
                    )
                    .at(place, "their mirror images would move the other way")
                    .help("do not prescribe the normal velocity or a force along it, or turning about an axis in the plane"),
                );
            }
        }
        problems
    }

    /// The constraints and ramps of a plan. Particles start as they are prescribed to move.
    pub(super) fn finish(self, draft: &mut Draft) -> (Vec<Constraint>, Vec<Ramp>) {
        let mut unique: Vec<(Constraint, Vec<Ramp>)> = Vec::new();
        let entries = self.table.iter().map(|orders| (orders.constraint(), orders.ramps()));
        let becomes: Vec<u16> = entries
            .map(|entry| {
                let known = unique.iter().position(|known| *known == entry);
                known.unwrap_or_else(|| {
                    unique.push(entry);
                    unique.len() - 1
                }) as u16
            })
            .collect();
        let state = &mut draft.state;
        for (k, constraint) in state.constraint.iter_mut().enumerate() {
            *constraint = becomes[usize::from(*constraint)];
            let Constraint { velocity, angular_velocity, .. } = unique[usize::from(*constraint)].0;
            for d in 0..3 {
                state.velocity[k][d] = velocity[d].unwrap_or(state.velocity[k][d]);
                state.angular_velocity[k][d] = angular_velocity[d].unwrap_or(state.angular_velocity[k][d]);
            }
        }
        let ramps = unique.iter().enumerate().flat_map(|(index, (_, ramps))| {
            ramps.iter().map(move |ramp| Ramp { constraint: index as u16, ..ramp.clone() })
        });
        let ramps = ramps.collect();
        (unique.into_iter().map(|(constraint, _)| constraint).collect(), ramps)
    }
}

impl Clash {
    fn name(&self) -> &'static str {
        COMPONENTS[self.component].1
    }

    /// The line of a table that prescribes or fixes the component.
    fn rate_place(&self, context: &Context<'_>, origin: Origin) -> Range<usize> {
        let (tree, index) = (&context.loaded.tree, origin.index.to_string());
        let prescribed = [origin.table, &index, "prescribed", self.name()];
        let key = if tree.get(&prescribed).is_some() { prescribed } else { [origin.table, &index, "fixed", ""] };
        tree.place(&key)
    }

    fn of_motion(&self, context: &Context<'_>) -> Problem {
        let name = self.name();
        Problem::new(codes::CONTRADICTORY_MOTION, format!("`{name}` of the same particles is told to move in two ways"))
            .at(self.rate_place(context, self.second), "some particles here")
            .at(self.rate_place(context, self.first), "have this from before")
            .help("keep one of them, or bound the zone so that it leaves these particles out")
    }

    fn of_force(&self, context: &Context<'_>) -> Problem {
        let name = self.name();
        let Origin { table, index } = self.second;
        let place = context.loaded.tree.place(&[table, &index.to_string(), "force", name]);
        Problem::new(
            codes::FORCE_ON_PRESCRIBED,
            format!("a force along {name} has no effect on particles whose motion along {name} is prescribed"),
        )
        .at(place, "the force")
        .at(self.rate_place(context, self.first), "their motion")
        .help("keep one of them, or bound the zone so that it leaves these particles out")
    }
}
