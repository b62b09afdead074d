//! What particles are forbidden or ordered to do.

use super::Context;
use super::draft::Draft;
use crate::problem::{Problem, counted, number};
use crate::schema::{Axis, Component, Prescribed};
use tdem_engine::Constraint;

/// Applies `fixed` and `prescribed` of all groups, then of all zones, of which the later wins; returns the table of
/// constraints.
pub(super) fn constrain(context: &Context<'_>, draft: &mut Draft, zones: &[Vec<u32>]) -> Vec<Constraint> {
    let mut table = vec![Constraint::FREE];
    let case = &context.loaded.case;
    let of_group: Vec<u16> =
        case.particles.iter().map(|group| entry(&mut table, constraint(&group.fixed, &group.prescribed))).collect();
    for k in 0..draft.state.len() {
        apply(draft, k, of_group[usize::from(draft.group[k])], &table);
    }
    for (zone, members) in case.zone.iter().zip(zones) {
        let ordered = constraint(&zone.fixed, &zone.prescribed);
        for &particle in members.iter().filter(|_| ordered != Constraint::FREE) {
            let particle = particle as usize;
            let mut merged = table[usize::from(draft.state.constraint[particle])];
            for k in 0..3 {
                merged.velocity[k] = ordered.velocity[k].or(merged.velocity[k]);
                merged.angular_velocity[k] = ordered.angular_velocity[k].or(merged.angular_velocity[k]);
            }
            let index = entry(&mut table, merged);
            apply(draft, particle, index, &table);
        }
    }
    table
}

fn constraint(fixed: &[Component], prescribed: &Prescribed) -> Constraint {
    let mut rates = prescribed.components();
    for component in fixed {
        rates[*component as usize] = Some(0.0);
    }
    let [x, y, z, rx, ry, rz] = rates;
    Constraint { velocity: [x, y, z], angular_velocity: [rx, ry, rz] }
}

/// Index of a constraint in the table, added if it is new.
fn entry(table: &mut Vec<Constraint>, constraint: Constraint) -> u16 {
    let index = table.iter().position(|known| *known == constraint).unwrap_or_else(|| {
        table.push(constraint);
        table.len() - 1
    });
    index as u16
}

/// Gives a particle a constraint and the motion that it prescribes.
fn apply(draft: &mut Draft, particle: usize, index: u16, table: &[Constraint]) {
    let (state, constraint) = (&mut draft.state, &table[usize::from(index)]);
    state.constraint[particle] = index;
    for k in 0..3 {
        if let Some(rate) = constraint.velocity[k] {
            state.velocity[particle][k] = rate;
        }
        if let Some(rate) = constraint.angular_velocity[k] {
            state.angular_velocity[particle][k] = rate;
        }
    }
}

/// Applies planes of symmetry. A mirror image has the opposite normal velocity and the opposite angular velocity in the
/// plane, so a particle on the plane has none of these.
pub(super) fn symmetry(context: &Context<'_>, draft: &mut Draft, table: &mut Vec<Constraint>) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (k, plane) in context.loaded.case.symmetry.iter().enumerate() {
        let (axis, name) = match plane.axis {
            Axis::X => (0, "x"),
            Axis::Y => (1, "y"),
            Axis::Z => (2, "z"),
        };
        let place = context.loaded.tree.place(&["symmetry", &k.to_string(), "at"]);
        let (mut found, mut conflicts) = (0_usize, 0_usize);
        let mut nearest = f64::INFINITY;
        for particle in 0..draft.state.len() {
            let distance = (draft.state.position[particle][axis] - plane.at).abs();
            nearest = nearest.min(distance);
            if distance > 1e-6 * draft.state.radius[particle] {
                continue;
            }
            found += 1;
            let mut mirrored = table[usize::from(draft.state.constraint[particle])];
            let turning = (0..3).filter(|&d| d != axis).map(|d| mirrored.angular_velocity[d]);
            let moves = |rate: Option<f64>| rate.is_some_and(|rate| rate != 0.0);
            conflicts += usize::from(moves(mirrored.velocity[axis]) || turning.into_iter().any(moves));
            mirrored.velocity[axis] = Some(0.0);
            (0..3).filter(|&d| d != axis).for_each(|d| mirrored.angular_velocity[d] = Some(0.0));
            let index = entry(table, mirrored);
            apply(draft, particle, index, table);
        }
        if found == 0 {
            problems.push(
                Problem::error(
                    "tdem::case::symmetry-empty",
                    format!("no centre lies on the plane {name} = {} m", plane.at),
                )
                .at(place.clone(), format!("the nearest centre is {} m away", number(nearest)))
                .help("a plane of symmetry goes through centres of particles"),
            );
        }
        if conflicts > 0 {
            problems.push(
                Problem::error(
                    "tdem::case::symmetry-conflict",
                    format!(
                        "{} on the plane {name} = {} m prescribed to leave it",
                        counted(conflicts, "particle"),
                        plane.at
                    ),
                )
                .at(place, "their mirror images would move the other way")
                .help("do not prescribe the normal velocity or turning about an axis in the plane"),
            );
        }
    }
    problems
}
