//! A state in the making.

use super::Context;
use super::histories::Histories;
use crate::codes;
use crate::problem::{Problem, counted};
use crate::rng::{Stream, uniform4};
use crate::schema::Particles;
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;
use tdem_engine::physics::Vec3;
use tdem_engine::{Bond, BondHistory, BondPlan, Domain, Plan, State};

/// What a source of particles gives. Empty vectors leave the rest to the group's keys.
#[derive(Clone, Debug, Default)]
pub(super) struct Spheres {
    pub(super) position: Vec<[f64; 3]>,
    pub(super) radius: Vec<f64>,
    pub(super) velocity: Vec<[f64; 3]>,
    pub(super) angular_velocity: Vec<[f64; 3]>,
    pub(super) id: Vec<u32>,
    pub(super) material: Vec<u16>,
    /// K.
    pub(super) temperature: Vec<f64>,
    /// Friction springs of what already touches.
    pub(super) histories: Histories,
    /// Bonds that go on, with what they refer to; of other spheres all of this is empty.
    pub(super) carried: Carried,
}

/// Bonds of another run that go on.
#[derive(Clone, Debug, Default)]
pub(super) struct Carried {
    /// m, one for each sphere.
    pub(super) bonded_position: Vec<[f64; 3]>,
    /// One for each sphere.
    pub(super) orientation: Vec<[f64; 4]>,
    pub(super) bonds: Vec<Bond>,
    /// One for each bond, or none.
    pub(super) histories: Vec<BondHistory>,
}

/// Not turned.
const UPRIGHT: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// The values that are marked.
pub(super) fn kept<T: Copy>(values: &[T], marks: &[bool]) -> Vec<T> {
    values.iter().zip(marks).filter_map(|(value, mark)| mark.then_some(*value)).collect()
}

impl Spheres {
    /// Those that are marked; histories of pairs stay where both are.
    pub(super) fn kept(self, marks: &[bool]) -> Self {
        let id = kept(&self.id, marks);
        let left: HashSet<u32> = id.iter().copied().collect();
        let of = self.carried;
        let whole: Vec<bool> = of.bonds.iter().map(|b| left.contains(&b.first) && left.contains(&b.second)).collect();
        let carried = Carried {
            bonded_position: kept(&of.bonded_position, marks),
            orientation: kept(&of.orientation, marks),
            bonds: kept(&of.bonds, &whole),
            histories: kept(&of.histories, &whole),
        };
        Spheres {
            position: kept(&self.position, marks),
            radius: kept(&self.radius, marks),
            velocity: kept(&self.velocity, marks),
            angular_velocity: kept(&self.angular_velocity, marks),
            material: kept(&self.material, marks),
            temperature: kept(&self.temperature, marks),
            histories: self.histories.kept(&left),
            carried,
            id,
        }
    }

    /// The same with ids counted from a number on, in the same order.
    fn renumbered(mut self, first: u64) -> Self {
        let mut ascending = self.id.clone();
        ascending.sort_unstable();
        let new = |id: u32| (first + ascending.partition_point(|&other| other < id) as u64) as u32;
        self.id.iter_mut().for_each(|id| *id = new(*id));
        self.histories = self.histories.renumbered(new);
        for bond in &mut self.carried.bonds {
            (bond.first, bond.second) = (new(bond.first), new(bond.second));
        }
        self
    }
}

/// A state with, for each particle, the group that it came from.
#[derive(Clone, Debug, Default)]
pub(super) struct Draft {
    pub(super) state: State,
    pub(super) group: Vec<u16>,
    /// Bonds of other runs that go on, and what they remember if the form of bonds remembers.
    pub(super) carried: Vec<(Bond, BondHistory)>,
    /// Contact histories of other runs, with the group whose particles have them.
    pub(super) histories: Vec<(u16, Histories)>,
    next_id: u64,
}

impl Draft {
    /// Adds a group: ids, masses, initial motion.
    pub(super) fn add(
        &mut self,
        context: &Context<'_>,
        index: usize,
        group: &Particles,
        spheres: Spheres,
    ) -> Result<(), Problem> {
        let count = spheres.position.len();
        context.room_for(index, (self.state.len() + count) as f64)?;
        let needed = self.next_id + count as u64;
        // A run's ids are kept if all are free; a table's ids are the user's.
        let taken = group.run.is_some() && spheres.id.iter().any(|&id| u64::from(id) < self.next_id);
        if needed > u64::from(u32::MAX) && (spheres.id.is_empty() || taken) {
            return Err(no_ids(context, index, needed));
        }
        let spheres = if taken { spheres.renumbered(self.next_id) } else { spheres };
        let material = group.material.as_deref().map(|name| context.materials.index(name));
        let seed = context.loaded.case.seed;
        let state = &mut self.state;
        self.histories.push((index as u16, spheres.histories));
        let carried = spheres.carried;
        let histories = carried.histories.into_iter().chain(std::iter::repeat(BondHistory::default()));
        self.carried.extend(carried.bonds.into_iter().zip(histories));
        for k in 0..count {
            let id = spheres.id.get(k).copied().unwrap_or((self.next_id + k as u64) as u32);
            let radius = spheres.radius[k];
            let material = spheres.material.get(k).copied().or(material).unwrap_or(0);
            let base = spheres.velocity.get(k).copied().unwrap_or([0.0; 3]);
            let random = group.random_speed.map_or([0.0; 3], |[low, high]| {
                random_velocity(low.get(), high.get(), uniform4(seed, Stream::Velocity, 0, id, 0))
            });
            let spin = spheres.angular_velocity.get(k).copied().unwrap_or([0.0; 3]);
            state.id.push(id);
            state.material.push(material);
            state.constraint.push(0);
            state.radius.push(radius);
            state.temperature.push(spheres.temperature.get(k).copied().unwrap_or(0.0));
            state.mass.push(sphere_mass(radius, context.materials.density[usize::from(material)]));
            let place = spheres.position[k];
            state.position.push(place);
            state.bonded_position.push(carried.bonded_position.get(k).copied().unwrap_or(place));
            state.orientation.push(carried.orientation.get(k).copied().unwrap_or(UPRIGHT));
            let stretching: [f64; 3] = std::array::from_fn(|d| group.strain_rate[d] * place[d]);
            state.velocity.push(std::array::from_fn(|d| base[d] + group.velocity[d] + stretching[d] + random[d]));
            state.angular_velocity.push(std::array::from_fn(|d| spin[d] + group.angular_velocity[d]));
            self.group.push(index as u16);
        }
        let highest = spheres.id.iter().max().map_or(needed, |&id| u64::from(id) + 1);
        self.next_id = self.next_id.max(highest);
        Ok(())
    }

    /// Ids that two particles have.
    pub(super) fn repeated_ids(&self, context: &Context<'_>) -> Option<Problem> {
        if self.state.id.is_sorted_by(|a, b| a < b) {
            return None;
        }
        let mut order: Vec<(u32, u16)> = self.state.id.iter().copied().zip(self.group.iter().copied()).collect();
        order.sort_unstable();
        let repeated: Vec<&[(u32, u16)]> = order.windows(2).filter(|pair| pair[0].0 == pair[1].0).collect();
        let first = repeated.first()?;
        Some(
            Problem::new(
                codes::DUPLICATE_ID,
                format!("{} used twice, the first is {}", counted(repeated.len(), "id"), first[0].0),
            )
            .at(context.place(usize::from(first[1].1), &[]), "again in this group")
            .at(context.place(usize::from(first[0].1), &[]), "first in this group")
            .help("give other ids, or leave them out: groups without ids get the next free ones"),
        )
    }

    /// The state, in the order of ids.
    pub(super) fn finish(self, context: &Context<'_>, plan: &Plan, bonds: Vec<Bond>) -> State {
        let mut state = self.state;
        let count = state.len();
        if !state.id.is_sorted() {
            let mut order: Vec<usize> = (0..count).collect();
            order.sort_unstable_by_key(|&k| state.id[k]);
            state = State {
                id: order.iter().map(|&k| state.id[k]).collect(),
                material: order.iter().map(|&k| state.material[k]).collect(),
                temperature: order.iter().map(|&k| state.temperature[k]).collect(),
                exposure: order.iter().filter_map(|&k| state.exposure.get(k).copied()).collect(),
                constraint: order.iter().map(|&k| state.constraint[k]).collect(),
                radius: order.iter().map(|&k| state.radius[k]).collect(),
                mass: order.iter().map(|&k| state.mass[k]).collect(),
                position: order.iter().map(|&k| state.position[k]).collect(),
                velocity: order.iter().map(|&k| state.velocity[k]).collect(),
                angular_velocity: order.iter().map(|&k| state.angular_velocity[k]).collect(),
                bonded_position: order.iter().map(|&k| state.bonded_position[k]).collect(),
                orientation: order.iter().map(|&k| state.orientation[k]).collect(),
                ..state
            };
        }
        state.image = vec![[0; 3]; count];
        state.force = vec![[0.0; 3]; count];
        state.moment = vec![[0.0; 3]; count];
        if plan.integrator == tdem_engine::Integrator::Gear {
            state.derivatives = vec![[[0.0; 3]; 4]; count];
        }
        if plan.ledger {
            state.accounts = vec![[0.0; 4]; count];
        }
        heat(&mut state, plan);
        let remembers = plan.bonds.as_ref().is_some_and(BondPlan::remembers);
        self::bond(&mut state, &context.domain, &self.carried, bonds, remembers);
        state.wall_position = context.planes.iter().map(|plane| plane.point).collect();
        state
    }
}

/// What belongs to heat. Radii are those of the reference temperature until here.
fn heat(state: &mut State, plan: &Plan) {
    let Some(heat) = &plan.heat else {
        state.temperature.clear();
        return;
    };
    state.heat_rate = vec![0.0; state.len()];
    if plan.ledger {
        state.heat_accounts = vec![[0.0; 4]; state.len()];
    }
    if heat.expands() {
        state.reference_radius = state.radius.clone();
        state.follow_temperatures(plan);
    }
}

/// Bonds particles: new ones as they lie, carried ones as they were.
fn bond(state: &mut State, domain: &Domain, carried: &[(Bond, BondHistory)], mut bonds: Vec<Bond>, remembers: bool) {
    bonds.extend(carried.iter().map(|(bond, _)| *bond));
    bonds.sort_unstable_by_key(|bond| (bond.first, bond.second));
    state.bonds = bonds;
    if state.bonds.is_empty() {
        state.bonded_position.clear();
        state.orientation.clear();
    }
    if remembers && !carried.is_empty() {
        let known: HashMap<(u32, u32), BondHistory> =
            carried.iter().map(|(bond, history)| ((bond.first, bond.second), *history)).collect();
        let place = |id: u32| Vec3::from(state.bonded_position[state.index_of(id).unwrap_or(0)]);
        let unloaded = |bond: &Bond| {
            let offset = domain.period().nearest(place(bond.second) - place(bond.first));
            BondHistory { normal: (offset * (1.0 / offset.dot(offset).sqrt())).into(), ..BondHistory::default() }
        };
        let of = |bond: &Bond| known.get(&(bond.first, bond.second)).copied().unwrap_or_else(|| unloaded(bond));
        state.bond_histories = state.bonds.iter().map(of).collect();
    }
}

/// Ids that are beyond those that there are.
fn no_ids(context: &Context<'_>, group: usize, needed: u64) -> Problem {
    let message = format!("the next ids of these particles go up to {}, more than {}", needed - 1, u32::MAX - 1);
    Problem::new(codes::TOO_MANY_PARTICLES, message)
        .at(context.place(group, &[]), "without ids of their own")
        .help("ids go on from the highest that a table or a run gives: lower those")
}

pub(super) fn sphere_mass(radius: f64, density: f64) -> f64 {
    4.0 / 3.0 * PI * (radius * radius * radius) * density
}

/// Magnitude uniform between two speeds, direction isotropic.
fn random_velocity(low: f64, high: f64, [size, height, angle, _]: [f64; 4]) -> [f64; 3] {
    let speed = low + size * (high - low);
    let z = 2.0 * height - 1.0;
    let across = (1.0 - z * z).max(0.0).sqrt();
    let phi = 2.0 * PI * angle;
    [speed * across * libm::cos(phi), speed * across * libm::sin(phi), speed * z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_velocities_are_isotropic_and_within_range() {
        let count = 20_000;
        let mut mean = [0.0; 3];
        let mut speeds = 0.0;
        for id in 0..count {
            let v = random_velocity(0.1, 0.3, uniform4(1, Stream::Velocity, 0, id, 0));
            let speed = v.iter().map(|c| c * c).sum::<f64>().sqrt();
            assert!((0.1 - 1e-12..=0.3 + 1e-12).contains(&speed));
            speeds += speed / f64::from(count);
            (0..3).for_each(|k| mean[k] += v[k] / f64::from(count));
        }
        assert!((speeds - 0.2).abs() < 2e-3, "{speeds}");
        assert!(mean.iter().all(|m| m.abs() < 3e-3), "{mean:?}");
    }
}
