//! From a device's working order to a state in the order of ids.

use super::memory::Arriving;
use super::run::Gpu;
use super::runtime::Runtime;
use crate::cpu::Quad;
use crate::{Contact, Fault, State, WallContact};

/// A moment of a run on its way to the host.
struct Snapshot<R: Runtime> {
    step: u64,
    ids: Vec<u32>,
    spins: Vec<[f64; 3]>,
    rank: Arriving<u32, R>,
    kind: Arriving<u32, R>,
    place: Arriving<Quad, R>,
    motion: Arriving<Quad, R>,
    spin: Arriving<Quad, R>,
    force: Arriving<Quad, R>,
    moment: Arriving<Quad, R>,
    wall_place: Arriving<Quad, R>,
    image: Arriving<i32, R>,
    derivatives: Arriving<f64, R>,
    accounts: Arriving<f64, R>,
    starts: Arriving<u32, R>,
    partners: Arriving<u32, R>,
    remembered: Arriving<f64, R>,
}

impl<R: Runtime> Gpu<R> {
    /// Takes the present moment; what is returned may be assembled on another thread while the device goes on.
    pub(super) fn capture_all(&mut self) -> Result<impl FnOnce() -> Result<State, Fault> + Send + 'static, Fault> {
        let entries = if self.particles == 0 { 0 } else { self.put_histories_aside()? };
        let (queue, half, free, fields) =
            (&self.queue, &self.halves[self.now], &self.halves[1 - self.now], &self.fields);
        let all = usize::MAX;
        let snapshot = Snapshot::<R> {
            step: self.step,
            ids: self.ids.clone(),
            spins: self.spins.clone(),
            rank: queue.fetch(&fields.rank, all)?,
            kind: queue.fetch(&fields.kind, all)?,
            place: queue.fetch(&half.place, all)?,
            motion: queue.fetch(&half.motion, all)?,
            spin: queue.fetch(&half.spin, all)?,
            force: queue.fetch(&free.place, all)?,
            moment: queue.fetch(&free.spin, all)?,
            wall_place: queue.fetch(&half.wall_place, all)?,
            image: queue.fetch(&fields.image, all)?,
            derivatives: queue.fetch(&fields.derivatives, all)?,
            accounts: queue.fetch(&fields.accounts, all)?,
            starts: queue.fetch(&self.histories.starts, all)?,
            partners: queue.fetch(&self.histories.partners, entries)?,
            remembered: queue.fetch(&self.histories.remembered, 3 * entries)?,
        };
        queue.flush()?;
        Ok(move || snapshot.state())
    }
}

impl<R: Runtime> Snapshot<R> {
    fn state(self) -> Result<State, Fault> {
        let n = self.ids.len();
        let rank = self.rank.take()?;
        let mut at = vec![0_usize; n];
        for (index, &rank) in rank.iter().enumerate() {
            at[rank as usize] = index;
        }
        let vectors = |field: &[Quad]| -> Vec<[f64; 3]> { at.iter().map(|&i| field[i].vector().into()).collect() };
        let (place, motion, kind) = (self.place.take()?, self.motion.take()?, self.kind.take()?);
        let moments = self.spins.is_empty();
        let (spin, moment) = (self.spin.take()?, self.moment.take()?);
        let (image, derivatives, accounts) = (self.image.take()?, self.derivatives.take()?, self.accounts.take()?);
        let (contacts, wall_contacts) =
            contacts(&self.ids, &at, &self.starts.take()?, &self.partners.take()?, &self.remembered.take()?);
        Ok(State {
            step: self.step,
            forces_known: true,
            initial_energy: 0.0,
            material: at.iter().map(|&i| kind[i] as u16).collect(),
            constraint: at.iter().map(|&i| (kind[i] >> 16) as u16).collect(),
            radius: at.iter().map(|&i| place[i].scalar()).collect(),
            mass: at.iter().map(|&i| motion[i].scalar()).collect(),
            position: vectors(&place),
            image: if image.is_empty() {
                vec![[0; 3]; n]
            } else {
                at.iter().map(|&i| std::array::from_fn(|k| image[k * n + i])).collect()
            },
            velocity: vectors(&motion),
            angular_velocity: if moments { vectors(&spin) } else { self.spins },
            force: vectors(&self.force.take()?),
            moment: if moments { vectors(&moment) } else { vec![[0.0; 3]; n] },
            derivatives: if derivatives.is_empty() {
                Vec::new()
            } else {
                at.iter()
                    .map(|&i| std::array::from_fn(|d| std::array::from_fn(|k| derivatives[(3 * d + k) * n + i])))
                    .collect()
            },
            accounts: if accounts.is_empty() {
                Vec::new()
            } else {
                at.iter().map(|&i| std::array::from_fn(|c| accounts[c * n + i])).collect()
            },
            wall_position: self.wall_place.take()?.iter().map(|p| p.vector().into()).collect(),
            contacts,
            wall_contacts,
            id: self.ids,
        })
    }
}

/// Touching pairs and walls, from what was put aside in the working order; `at` is where a rank stands in it.
fn contacts(
    ids: &[u32],
    at: &[usize],
    starts: &[u32],
    partners: &[u32],
    remembered: &[f64],
) -> (Vec<Contact>, Vec<WallContact>) {
    let n = ids.len();
    let (mut pairs, mut walls) = (Vec::with_capacity(partners.len()), Vec::new());
    for rank in 0..n {
        for at in starts[at[rank]] as usize..starts[at[rank] + 1] as usize {
            let displacement = remembered.get(3 * at..3 * at + 3).map_or([0.0; 3], |kept| [kept[0], kept[1], kept[2]]);
            let partner = partners[at] as usize;
            if partner < n {
                pairs.push(Contact { first: ids[rank], second: ids[partner], displacement });
            } else {
                walls.push(WallContact { particle: ids[rank], wall: (partner - n) as u32, displacement });
            }
        }
    }
    (pairs, walls)
}
