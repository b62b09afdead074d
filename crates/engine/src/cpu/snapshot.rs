//! Between a state in the order of ids and the working order.

use super::Cpu;
use super::bodies::Bodies;
use super::neighbours::Histories;
use crate::{Contact, Fault, State, WallContact};

impl Cpu {
    /// Takes a state up: working arrays, histories, first neighbour list.
    pub(super) fn take_up(&mut self, state: State) -> Result<(), Fault> {
        self.bodies = Bodies::from_state(&state, &self.plan);
        let histories = histories(&state);
        self.ids = state.id;
        self.wall_position = state.wall_position;
        let speed_squared = self.bodies.motion.iter().map(|m| m.vector().dot(m.vector())).fold(0.0, f64::max);
        self.step_way = (speed_squared.sqrt() * self.plan.dt).max(self.wall_step());
        let pool = std::sync::Arc::clone(&self.pool);
        pool.install(|| self.list_with(&histories))
    }

    /// The whole state but the initial energy, in the order of ids.
    pub(super) fn state(&self) -> State {
        let bodies = &self.bodies;
        let n = bodies.len();
        let mut index_of = vec![0_usize; n];
        for (index, &rank) in bodies.rank.iter().enumerate() {
            index_of[rank as usize] = index;
        }
        let by_rank = &index_of;
        let vectors =
            |field: &dyn Fn(usize) -> [f64; 3]| -> Vec<[f64; 3]> { by_rank.iter().map(|&i| field(i)).collect() };
        let histories = self.neighbours.histories(&bodies.rank);
        let mut contacts = Vec::with_capacity(histories.second.len());
        for rank in 0..n {
            for pair in histories.start[rank] as usize..histories.start[rank + 1] as usize {
                contacts.push(Contact {
                    first: self.ids[rank],
                    second: self.ids[histories.second[pair] as usize],
                    displacement: histories.displacement[pair],
                });
            }
        }
        let image =
            if bodies.image.is_empty() { vec![[0; 3]; n] } else { by_rank.iter().map(|&i| bodies.image[i]).collect() };
        State {
            step: self.step,
            forces_known: true,
            initial_energy: 0.0,
            id: self.ids.clone(),
            material: by_rank.iter().map(|&i| bodies.material[i]).collect(),
            constraint: by_rank.iter().map(|&i| bodies.constraint[i]).collect(),
            radius: by_rank.iter().map(|&i| bodies.place[i].scalar()).collect(),
            mass: by_rank.iter().map(|&i| bodies.motion[i].scalar()).collect(),
            position: vectors(&|i| bodies.place[i].vector().into()),
            image,
            velocity: vectors(&|i| bodies.motion[i].vector().into()),
            angular_velocity: vectors(&|i| bodies.spin[i].vector().into()),
            force: vectors(&|i| bodies.force[i].vector().into()),
            moment: vectors(&|i| bodies.moment.get(i).copied().unwrap_or_default().vector().into()),
            derivatives: by_rank.iter().filter_map(|&i| bodies.derivatives.get(i).copied()).collect(),
            accounts: by_rank.iter().filter_map(|&i| bodies.accounts.get(i).copied()).collect(),
            wall_position: self.wall_position.clone(),
            contacts,
            wall_contacts: histories
                .walls
                .iter()
                .map(|&(rank, wall, displacement)| WallContact {
                    particle: self.ids[rank as usize],
                    wall,
                    displacement,
                })
                .collect(),
        }
    }
}

/// What the touching pairs of a validated state remember, by rank.
fn histories(state: &State) -> Histories {
    let rank = |id: u32| state.index_of(id).unwrap_or(0) as u32;
    let mut start = vec![0_u32; state.len() + 1];
    for contact in &state.contacts {
        start[rank(contact.first) as usize + 1] += 1;
    }
    for r in 0..state.len() {
        start[r + 1] += start[r];
    }
    Histories {
        start,
        second: state.contacts.iter().map(|c| rank(c.second)).collect(),
        displacement: state.contacts.iter().map(|c| c.displacement).collect(),
        walls: state.wall_contacts.iter().map(|c| (rank(c.particle), c.wall, c.displacement)).collect(),
    }
}
