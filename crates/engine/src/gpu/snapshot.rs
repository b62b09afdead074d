//! From a device's working order to a state in the order of ids.

use super::bodies::constraint_of;
use super::bonds::{histories, with_breakages};
use super::memory::Arriving;
use super::run::Gpu;
use super::runtime::Runtime;
use crate::cpu::{Quad, indices_by_rank, split};
use crate::{Bond, Contact, Fault, State, WallContact};
use rayon::prelude::*;
use std::sync::Arc;

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
    derivatives: [Arriving<Quad, R>; 3],
    accounts: Arriving<Quad, R>,
    starts: Arriving<u32, R>,
    partners: Arriving<u32, R>,
    remembered: Arriving<f64, R>,
    orientation: Arriving<Quad, R>,
    bonds: Arc<Vec<Bond>>,
    bonded_position: Arc<Vec<[f64; 3]>>,
    since: u64,
    broken: Arriving<u32, R>,
    released: Arriving<f64, R>,
    bond_history: Arriving<f64, R>,
    heated: bool,
    temperature: Arriving<f64, R>,
    heat_accounts: Arriving<Quad, R>,
    work_per_kelvin: Arriving<f64, R>,
    exposure: Arc<Vec<u16>>,
    reference_radius: Arc<Vec<f64>>,
}

impl<R: Runtime> Gpu<R> {
    /// Takes the present moment; what is returned may be assembled on another thread while the device goes on.
    pub(super) fn capture_all(&mut self) -> Result<impl FnOnce() -> Result<State, Fault> + Send + 'static, Fault> {
        let entries = if self.particles == 0 { 0 } else { self.put_histories_aside()? };
        let (queue, half, free, fields) =
            (&self.queue, &self.halves[self.now], &self.halves[1 - self.now], &self.fields);
        let [dx, dy, dz] = &fields.derivatives;
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
            derivatives: [queue.fetch(dx, all)?, queue.fetch(dy, all)?, queue.fetch(dz, all)?],
            accounts: queue.fetch(&fields.accounts, all)?,
            starts: queue.fetch(&self.histories.starts, all)?,
            partners: queue.fetch(&self.histories.partners, entries)?,
            remembered: queue.fetch(&self.histories.remembered, 3 * entries)?,
            orientation: queue.fetch(&half.orientation, all)?,
            bonds: Arc::clone(&self.bonds.table),
            bonded_position: Arc::clone(&self.bonds.bonded_position),
            since: self.bonds.since,
            broken: queue.fetch(&self.bonds.broken, all)?,
            released: queue.fetch(&self.bonds.released, all)?,
            bond_history: queue.fetch(&self.bonds.apart.history, all)?,
            heated: self.plan.heat.is_some(),
            temperature: queue.fetch(&half.temperature, all)?,
            heat_accounts: queue.fetch(&self.heat.accounts, all)?,
            work_per_kelvin: queue.fetch(&self.heat.work_per_kelvin, all)?,
            exposure: Arc::clone(&self.heat.exposure_by_rank),
            reference_radius: Arc::clone(&self.heat.reference_by_rank),
        };
        queue.flush()?;
        Ok(move || snapshot.state())
    }
}

impl<R: Runtime> Snapshot<R> {
    fn state(mut self) -> Result<State, Fault> {
        let n = self.ids.len();
        let at = indices_by_rank(self.rank.view()?);
        let (place, motion, kind) = (self.place.view()?, self.motion.view()?, self.kind.view()?);
        let (image, accounts) = (self.image.view()?, self.accounts.view()?);
        let [dx, dy, dz] = &mut self.derivatives;
        let derivatives = [dx.view()?, dy.view()?, dz.view()?];
        let orientation = self.orientation.view()?;
        let (spin, force) = (self.spin.view()?, self.force.view()?);
        let temperature = Temperatures { apart: self.temperature.view()?, spin };
        let (heat_accounts, work) = (self.heat_accounts.view()?, self.work_per_kelvin.view()?);
        let moments = self.spins.is_empty();
        let put_aside = PutAside {
            ids: &self.ids,
            at: &at,
            starts: self.starts.view()?,
            partners: self.partners.view()?,
            remembered: self.remembered.view()?,
        };
        let (contacts, wall_contacts) = (put_aside.pairs(), put_aside.walls());
        Ok(State {
            step: self.step,
            forces_known: true,
            initial_energy: 0.0,
            initial_heat: 0.0,
            material: gather(&at, |i| kind[i] as u16),
            constraint: gather(&at, |i| constraint_of(kind[i])),
            radius: gather(&at, |i| place[i].scalar()),
            mass: gather(&at, |i| motion[i].scalar()),
            position: vectors(&at, place),
            image: if image.is_empty() {
                vec![[0; 3]; n]
            } else {
                gather(&at, |i| std::array::from_fn(|k| image[k * n + i]))
            },
            velocity: vectors(&at, motion),
            angular_velocity: if moments { vectors(&at, spin) } else { self.spins },
            force: vectors(&at, force),
            moment: if moments { vectors(&at, self.moment.view()?) } else { vec![[0.0; 3]; n] },
            orientation: if orientation.is_empty() { Vec::new() } else { gather(&at, |i| orientation[i].0) },
            bonded_position: self.bonded_position.to_vec(),
            derivatives: if derivatives[0].is_empty() {
                Vec::new()
            } else {
                gather(&at, |i| std::array::from_fn(|d| derivatives.map(|of_coordinate| of_coordinate[i].0[d])))
            },
            accounts: if accounts.is_empty() { Vec::new() } else { gather(&at, |i| accounts[i].0) },
            wall_position: self.wall_place.view()?.iter().map(|p| p.vector().into()).collect(),
            contacts,
            wall_contacts,
            bonds: with_breakages(&self.bonds, self.since, self.broken.view()?, self.released.view()?),
            bond_histories: histories(self.bond_history.view()?),
            temperature: if self.heated { gather(&at, |i| temperature.of(i)) } else { Vec::new() },
            heat_rate: if self.heated { gather(&at, |i| force[i].scalar()) } else { Vec::new() },
            exposure: self.exposure.to_vec(),
            reference_radius: self.reference_radius.to_vec(),
            heat_accounts: if heat_accounts.is_empty() { Vec::new() } else { gather(&at, |i| heat_accounts[i].0) },
            work_per_kelvin: if work.is_empty() { Vec::new() } else { gather(&at, |i| work[i]) },
            id: self.ids,
        })
    }
}

/// Temperatures as a half keeps them.
pub(super) struct Temperatures<'a> {
    /// Where particles do not turn.
    pub(super) apart: &'a [f64],
    /// Else.
    pub(super) spin: &'a [Quad],
}

impl Temperatures<'_> {
    /// That of the particle at a place of the working order, K.
    pub(super) fn of(&self, i: usize) -> f64 {
        self.apart.get(i).copied().unwrap_or_else(|| self.spin[i].scalar())
    }
}

/// A field in the order of ranks, from its value at a place of the working order.
fn gather<T: Send>(at: &[u32], value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    at.par_iter().map(|&i| value(i as usize)).collect()
}

fn vectors(at: &[u32], field: &[Quad]) -> Vec<[f64; 3]> {
    gather(at, |i| field[i].vector().into())
}

/// What was put aside of touching pairs and walls, in the working order.
struct PutAside<'a> {
    ids: &'a [u32],
    /// Where a rank stands in the working order.
    at: &'a [u32],
    starts: &'a [u32],
    /// Ranks, or walls counted on from the number of particles.
    partners: &'a [u32],
    remembered: &'a [f64],
}

impl PutAside<'_> {
    /// Touching pairs, ascending.
    fn pairs(&self) -> Vec<Contact> {
        let n = self.ids.len() as u32;
        self.listed(
            |partner| partner < n,
            |rank, partner, displacement| Contact { first: self.ids[rank], second: self.ids[partner], displacement },
        )
    }

    /// Particles at walls, ascending.
    fn walls(&self) -> Vec<WallContact> {
        let n = self.ids.len() as u32;
        self.listed(
            |partner| partner >= n,
            |rank, partner, displacement| WallContact {
                particle: self.ids[rank],
                wall: partner as u32 - n,
                displacement,
            },
        )
    }

    /// What is made of the entries with a wanted partner, rank by rank: from rank, partner and displacement.
    fn listed<T: Send>(
        &self,
        wanted: impl Fn(u32) -> bool + Sync,
        make: impl Fn(usize, usize, [f64; 3]) -> T + Send + Sync,
    ) -> Vec<T> {
        let n = self.at.len();
        let entries = |rank: usize| {
            let at = self.at[rank] as usize;
            (self.starts[at] as usize..self.starts[at + 1] as usize).filter(|&entry| wanted(self.partners[entry]))
        };
        // Counted before they are listed, so that pieces are written where they belong.
        let ranks = |piece: usize| piece * PIECE..((piece + 1) * PIECE).min(n);
        let counts: Vec<usize> = (0..n.div_ceil(PIECE))
            .into_par_iter()
            .map(|piece| ranks(piece).map(|rank| entries(rank).count()).sum())
            .collect();
        let mut bounds = vec![0; counts.len() + 1];
        for (piece, count) in counts.iter().enumerate() {
            bounds[piece + 1] = bounds[piece] + count;
        }
        let mut places = vec![[0_u32; 2]; bounds[counts.len()]];
        split(&mut places, &bounds).collect::<Vec<_>>().into_par_iter().enumerate().for_each(|(piece, places)| {
            let found = ranks(piece).flat_map(|rank| entries(rank).map(move |entry| [rank as u32, entry as u32]));
            places.iter_mut().zip(found).for_each(|(place, found)| *place = found);
        });
        let made = |&[rank, entry]: &[u32; 2]| {
            let entry = entry as usize;
            let kept =
                self.remembered.get(3 * entry..3 * entry + 3).map_or([0.0; 3], |kept| [kept[0], kept[1], kept[2]]);
            make(rank as usize, self.partners[entry] as usize, kept)
        };
        places.par_iter().map(made).collect()
    }
}

/// Ranks per task.
const PIECE: usize = 4096;
