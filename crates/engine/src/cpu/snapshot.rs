//! Between a state in the order of ids and the working order.

use super::Cpu;
use super::bodies::{Bodies, Quad};
use super::bonds::Bonds;
use super::neighbours::{Histories, indices_by_rank};
use crate::{Contact, Fault, State, WallContact};
use rayon::prelude::*;

impl Cpu {
    /// Takes a state up: working arrays, histories, first neighbour list.
    pub(super) fn take_up(&mut self, state: State) -> Result<(), Fault> {
        let pool = std::sync::Arc::clone(&self.pool);
        self.bodies = Bodies::from_state(&state, &self.plan);
        self.bonds = Bonds::from_state(&state, &self.plan);
        let histories = pool.install(|| histories(&state));
        self.ids = state.id;
        self.wall_position = state.wall_position;
        let speed_squared = self.bodies.motion.iter().map(|m| m.vector().dot(m.vector())).fold(0.0, f64::max);
        self.step_way = (speed_squared.sqrt() * self.plan.dt).max(self.wall_step());
        pool.install(|| self.list_with(&histories))
    }

    /// The whole state but its initial energy, in the order of ids.
    pub(super) fn state(&self) -> State {
        let bodies = &self.bodies;
        let by_rank = &indices_by_rank(&bodies.rank)[..];
        let histories = self.neighbours.histories(&bodies.rank, Some(by_rank));
        let contacts = self.contacts(&histories);
        let wall_contacts = histories.walls.iter().map(|&(rank, wall, displacement)| WallContact {
            particle: self.ids[rank as usize],
            wall,
            displacement,
        });
        State {
            step: self.step,
            forces_known: true,
            initial_energy: 0.0,
            initial_heat: 0.0,
            id: self.ids.clone(),
            material: sorted(by_rank, &bodies.material, |&material| material),
            constraint: sorted(by_rank, &bodies.constraint, |&constraint| constraint),
            radius: sorted(by_rank, &bodies.place, Quad::scalar),
            mass: sorted(by_rank, &bodies.motion, Quad::scalar),
            position: sorted(by_rank, &bodies.place, vector),
            image: sorted_or_zero(by_rank, &bodies.image, |&image| image),
            velocity: sorted(by_rank, &bodies.motion, vector),
            angular_velocity: sorted(by_rank, &bodies.spin, vector),
            force: sorted(by_rank, &bodies.force, vector),
            moment: sorted_or_zero(by_rank, &bodies.moment, vector),
            orientation: sorted(by_rank, &bodies.orientation, |orientation| orientation.0),
            bonded_position: self.bonds.bonded_position.clone(),
            derivatives: sorted(by_rank, &bodies.derivatives, |&derivatives| derivatives),
            accounts: sorted(by_rank, &bodies.accounts, |&accounts| accounts),
            wall_position: self.wall_position.clone(),
            contacts,
            wall_contacts: wall_contacts.collect(),
            bonds: self.bonds.table.clone(),
            bond_histories: self.bonds.histories(),
            temperature: sorted(by_rank, &bodies.temperature, |&temperature| temperature),
            heat_rate: if bodies.temperature.is_empty() {
                Vec::new()
            } else {
                sorted(by_rank, &bodies.force, Quad::scalar)
            },
            exposure: sorted(by_rank, &bodies.exposure, |&exposure| exposure),
            reference_radius: sorted(by_rank, &bodies.reference_radius, |&radius| radius),
            heat_accounts: sorted(by_rank, &bodies.heat_accounts, |&accounts| accounts),
            work_per_kelvin: sorted(by_rank, &bodies.work_per_kelvin, |&work| work),
        }
    }

    /// Histories by id.
    fn contacts(&self, histories: &Histories) -> Vec<Contact> {
        let first = |pair: usize| histories.start.partition_point(|&start| start as usize <= pair) - 1;
        (histories.second.par_iter().enumerate())
            .map(|(pair, &second)| Contact {
                first: self.ids[first(pair)],
                second: self.ids[second as usize],
                displacement: histories.displacement.get(pair).copied().unwrap_or_default(),
            })
            .collect()
    }
}

fn vector(quad: &Quad) -> [f64; 3] {
    quad.vector().into()
}

/// A field in the order of ids; an optional one that is not there stays empty.
fn sorted<T: Sync, U: Send>(by_rank: &[u32], field: &[T], value: impl Fn(&T) -> U + Sync + Send) -> Vec<U> {
    if field.is_empty() { Vec::new() } else { by_rank.par_iter().map(|&i| value(&field[i as usize])).collect() }
}

/// The same with zeros for a field that is not there.
fn sorted_or_zero<T: Sync, U: Clone + Default + Send>(
    by_rank: &[u32],
    field: &[T],
    value: impl Fn(&T) -> U + Sync + Send,
) -> Vec<U> {
    if field.is_empty() { vec![U::default(); by_rank.len()] } else { sorted(by_rank, field, value) }
}

/// What the touching pairs of a validated state remember, by rank.
fn histories(state: &State) -> Histories {
    let rank = |id: u32| state.index_of(id).unwrap_or(0) as u32;
    // Contacts ascend, so that a row ends where the next first begins.
    let before = |id: u32| state.contacts.partition_point(|contact| contact.first < id) as u32;
    let mut start: Vec<u32> = state.id.par_iter().map(|&id| before(id)).collect();
    start.push(state.contacts.len() as u32);
    Histories {
        start,
        second: state.contacts.par_iter().map(|c| rank(c.second)).collect(),
        displacement: state.contacts.par_iter().map(|c| c.displacement).collect(),
        walls: state.wall_contacts.iter().map(|c| (rank(c.particle), c.wall, c.displacement)).collect(),
    }
}
