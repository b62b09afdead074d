//! Bonds on a device, see `kernels/bond.cl`.

use super::heat;
use super::layout::{
    Beam, FollowEnds, InvertOrder, JointOf, PutBonds, PutStrengths, TakeBonds, TakeNumbers, TakeStrengths, Vector,
};
use super::memory::{Buffer, Queue};
use super::program::Variant;
use super::runtime::{Error, Runtime};
use crate::bond::only_bond;
use crate::cpu::Quad;
use crate::{Bond, BondHistory, Breakage, Plan, State};
use rayon::prelude::*;
use std::sync::Arc;
use tdem_physics::bond::{Damping, Failure};

/// As in `kernels/bond.cl`.
const HOLDS: u32 = 1 << 31;
/// As in `kernels/particle.cl`.
const NOBODY: u32 = 0x3fff_ffff;
/// A record of a broken bond holds its step below these bits, and how it failed in them.
const FAILURE_BITS: u32 = 30;

/// As in `kernels/bond.cl`.
const SECOND: u32 = 1 << 31;
/// Planes of words, and of reals, that a field of quads has room for.
const WORDS: u32 = (size_of::<Quad>() / size_of::<u32>()) as u32;
const REALS: u32 = (size_of::<Quad>() / size_of::<f64>()) as u32;
/// Numbers of a history on a device.
const HISTORY: usize = 10;

/// The bonds of a run. Without any, every buffer is empty. `W` is the largest number of bonds of a particle, `B` the number
/// of bonds, `N` of particles.
pub(super) struct Bonds<M> {
    /// `W`.
    pub(super) slots: u32,
    /// Places of the particles when they were bonded, in working order; the fourth number is not used. Empty in the
    /// incremental form.
    pub(super) place: Buffer<Quad, M>,
    /// Who is bonded to whom: `W` planes, in working order.
    pub(super) other: Buffer<u32, M>,
    /// Factors on strengths, empty if all are 1: `W` planes, in working order, or `(B)` where bonds are evaluated apart.
    pub(super) strength: Buffer<f64, M>,
    /// Where the bonds of each lower rank start in the table, `(N + 1)`.
    pub(super) start: Buffer<u32, M>,
    /// When and how each bond broke since `since`, 0 if it did not, in the order of the table, `(B)`.
    pub(super) broken: Buffer<u32, M>,
    /// Energy that left with it, J, `(B)`.
    pub(super) released: Buffer<f64, M>,
    pub(super) joints: Buffer<JointOf, M>,
    /// The numbers of the bonds of each pair of materials, if they are alike, else empty.
    pub(super) beams: Buffer<Beam, M>,
    /// Those of all bonds, if there is only one kind.
    pub(super) only: Option<Beam>,
    pub(super) apart: Apart<M>,
    /// As the state had them at step `since`.
    pub(super) table: Arc<Vec<Bond>>,
    pub(super) bonded_position: Arc<Vec<[f64; 3]>>,
    pub(super) since: u64,
}

/// What bonds have that are evaluated once each, apart from their particles; without such bonds every buffer is empty.
pub(super) struct Apart<M> {
    /// Places in the table, `W` planes, in working order.
    pub(super) number: Buffer<u32, M>,
    /// The particles of each bond, in working order, `(B, 2)`.
    pub(super) ends: Buffer<u32, M>,
    /// Lengths at bonding, m, `(B)`; only of the incremental form.
    pub(super) length: Buffer<f64, M>,
    /// What incremental bonds remember, `(10, B)`: the numbers of a [`BondHistory`] in their order.
    pub(super) history: Buffer<f64, M>,
    /// Moment on the first particle, force on the first, moment on the second, `(B, 3)`.
    pub(super) reaction: Buffer<Vector, M>,
    /// What dashpots took in this step, J, `(B)`; empty without a ledger.
    pub(super) lost: Buffer<f64, M>,
    /// Heat rate into the first particle, W, `(B)`; empty without heat.
    pub(super) flow: Buffer<f64, M>,
    /// $\partial U/\partial T$ for both particles, J/K, `(B, 2)`, where the ledger follows expansion.
    pub(super) work: Buffer<f64, M>,
}

/// Rows of bonds as they are laid out: a slot of a particle and the bond that stands in it.
struct Slots {
    /// Planes.
    count: u32,
    /// Of the first and the second particle of each bond.
    of_bond: Vec<[usize; 2]>,
    start: Vec<u32>,
}

impl Slots {
    /// The table ascends by lower ranks, then by higher ones: rows are filled in their order.
    fn of(pairs: &[[usize; 2]], n: usize) -> Self {
        let bonded = if pairs.is_empty() { 0 } else { n };
        let (mut higher, mut degree) = (vec![0_u32; bonded], vec![0_u32; bonded]);
        for &[first, second] in pairs {
            higher[first] += 1;
            degree[first] += 1;
            degree[second] += 1;
        }
        let (mut own, mut incoming) = (vec![0_u32; bonded], higher.clone());
        let take = |next: &mut Vec<u32>, particle: usize| {
            next[particle] += 1;
            (next[particle] - 1) as usize * n + particle
        };
        let of_bond = pairs.iter().map(|&[first, second]| [take(&mut own, first), take(&mut incoming, second)]);
        let of_bond = of_bond.collect();
        Slots { count: degree.iter().copied().max().unwrap_or(0), of_bond, start: starts(&higher) }
    }
    /// Rows of values, one for each side of a bond.
    fn rows<T: Copy>(&self, n: usize, empty: T, value: impl Fn(usize, usize) -> T) -> Vec<T> {
        let mut rows = vec![empty; self.count as usize * n];
        for (bond, slots) in self.of_bond.iter().enumerate() {
            for (side, &slot) in slots.iter().enumerate() {
                rows[slot] = value(bond, side);
            }
        }
        rows
    }
}

impl<M> Bonds<M> {
    pub(super) fn of_state<R: Runtime<Memory = M>>(
        queue: &Queue<R>,
        state: &State,
        plan: &Plan,
        variant: &Variant,
    ) -> Result<Self, Error> {
        let n = state.len();
        let rank = |id: u32| state.index_of(id).unwrap_or(0);
        let pairs: Vec<[usize; 2]> = state.bonds.iter().map(|bond| [rank(bond.first), rank(bond.second)]).collect();
        let slots = Slots::of(&pairs, n);
        let holds = |bond: usize| if state.bonds[bond].holds() { HOLDS } else { 0 };
        let other = slots.rows(n, NOBODY, |bond, side| pairs[bond][1 - side] as u32 | holds(bond));
        let strength = match (variant.scattered_bonds, variant.bonds_apart) {
            (false, _) => Vec::new(),
            (true, false) => slots.rows(n, 1.0, |bond, _| state.bonds[bond].strength),
            (true, true) => state.bonds.iter().map(|bond| bond.strength).collect(),
        };
        let place = if variant.bonds_remember() { &[][..] } else { &state.bonded_position };
        let place: Vec<Quad> = place.iter().map(|&place| Quad::new(place, 0.0)).collect();
        let alike = state.alike_bonds(plan).unwrap_or_default();
        let joints = plan.bonds.iter().flat_map(|bonds| &bonds.joints);
        let joints: Vec<JointOf> =
            joints.map(|joint| joint.as_ref().map_or_else(JointOf::default, JointOf::from)).collect();
        Ok(Bonds {
            slots: slots.count,
            place: queue.buffer_of(&place)?,
            other: queue.buffer_of(&other)?,
            strength: queue.buffer_of(&strength)?,
            start: queue.buffer_of(&slots.start)?,
            broken: queue.zeros(pairs.len())?,
            released: queue.zeros(pairs.len())?,
            joints: queue.buffer_of(&joints)?,
            beams: queue.buffer_of(&alike.iter().map(Beam::from).collect::<Vec<_>>())?,
            only: only_bond(&alike).as_ref().map(Beam::from),
            apart: Apart::of_state(queue, state, plan, variant, &pairs, &slots)?,
            table: Arc::new(state.bonds.clone()),
            bonded_position: Arc::new(state.bonded_position.clone()),
            since: state.step,
        })
    }

    /// Puts the rows in a new order of the particles. The rooms hold as many words, and four times as many reals, as there
    /// are particles, times eight.
    pub(super) fn reorder<R: Runtime<Memory = M>>(
        &self,
        queue: &Queue<R>,
        order: &Buffer<u32, M>,
        inverse: &Buffer<Quad, M>,
        room: &Buffer<Quad, M>,
    ) -> Result<(), Error> {
        let n = order.len();
        let particles = n as u32;
        let index_of = &inverse.room(n);
        queue.run(&InvertOrder { particles, order, index_of }, n)?;
        for first in (0..self.slots).step_by(WORDS as usize) {
            let planes = WORDS.min(self.slots - first);
            let room = &room.room(planes as usize * n);
            let bond_other = &self.other;
            queue.run(&TakeBonds { particles, first, planes, order, index_of, bond_other, room }, n)?;
            queue.run(&PutBonds { particles, first, planes, room, bond_other }, n)?;
        }
        self.apart.reorder(queue, order, index_of, room, self.slots)?;
        if self.strength.len() > 0 && self.apart.ends.len() == 0 {
            for first in (0..self.slots).step_by(REALS as usize) {
                let planes = REALS.min(self.slots - first);
                let room = &room.room(planes as usize * n);
                let strength = &self.strength;
                queue.run(&TakeStrengths { particles, first, planes, order, strength, room }, n)?;
                queue.run(&PutStrengths { particles, first, planes, room, strength }, n)?;
            }
        }
        Ok(())
    }

    /// Whether each is evaluated once, apart from its particles.
    pub(super) fn are_apart(&self) -> bool {
        self.apart.ends.len() > 0
    }

    /// The number of a step in records; there is none for steps too far ahead.
    pub(super) fn number(&self, step: u64) -> Option<u32> {
        u32::try_from(step - self.since).ok().filter(|&number| number < 1 << FAILURE_BITS)
    }

    /// Takes records over into the table, so that they begin anew at this step.
    pub(super) fn begin_records<R: Runtime<Memory = M>>(&mut self, queue: &Queue<R>, step: u64) -> Result<(), Error> {
        let count = self.table.len();
        let (broken, released) = (queue.read(&self.broken, count)?, queue.read(&self.released, count)?);
        self.table = Arc::new(with_breakages(&self.table, self.since, &broken, &released));
        queue.clear(&self.broken, count)?;
        self.since = step;
        Ok(())
    }
}

impl<M> Apart<M> {
    fn of_state<R: Runtime<Memory = M>>(
        queue: &Queue<R>,
        state: &State,
        plan: &Plan,
        variant: &Variant,
        pairs: &[[usize; 2]],
        slots: &Slots,
    ) -> Result<Self, Error> {
        let present = |needed: bool| if needed && variant.bonds_apart { pairs.len() } else { 0 };
        let side = |bond: usize, side: usize| bond as u32 | if side == 1 { SECOND } else { 0 };
        let number = if variant.bonds_apart { slots.rows(state.len(), NOBODY, side) } else { Vec::new() };
        let first = |bond: usize| pairs[bond][0] as u32 | if state.bonds[bond].holds() { HOLDS } else { 0 };
        let ends: Vec<u32> = (0..present(true)).flat_map(|bond| [first(bond), pairs[bond][1] as u32]).collect();
        let remembering = present(variant.bonds_remember());
        let length = |&[first, second]: &[usize; 2]| {
            let offset = state.bonded_offset(plan, first, second);
            offset.dot(offset).sqrt()
        };
        let length: Vec<f64> = pairs[..remembering].iter().map(length).collect();
        let mut history = vec![0.0; HISTORY * remembering];
        if remembering > 0 {
            for (bond, one) in state.histories_to_begin_with(plan).iter().enumerate() {
                one.numbers().enumerate().for_each(|(k, number)| history[k * remembering + bond] = number);
            }
        }
        Ok(Apart {
            number: queue.buffer_of(&number)?,
            ends: queue.buffer_of(&ends)?,
            length: queue.buffer_of(&length)?,
            history: queue.buffer_of(&history)?,
            reaction: queue.zeros(3 * present(true))?,
            lost: queue.zeros(present(variant.ledger && variant.bond_dashpots()))?,
            flow: queue.zeros(present(variant.heat.is_some()))?,
            work: queue.zeros(2 * present(variant.expansion_work))?,
        })
    }

    /// Puts the rows in a new order of the particles, which bonds follow; the arguments are those of [`Bonds::reorder`].
    fn reorder<R: Runtime<Memory = M>>(
        &self,
        queue: &Queue<R>,
        order: &Buffer<u32, M>,
        index_of: &Buffer<u32, M>,
        room: &Buffer<Quad, M>,
        slots: u32,
    ) -> Result<(), Error> {
        let (n, count) = (order.len(), self.ends.len());
        if count == 0 {
            return Ok(());
        }
        let particles = n as u32;
        queue.run(&FollowEnds { count: count as u32, index_of, bond_ends: &self.ends }, count)?;
        for first in (0..slots).step_by(WORDS as usize) {
            let planes = WORDS.min(slots - first);
            let room = &room.room(planes as usize * n);
            let bond_number = &self.number;
            queue.run(&TakeNumbers { particles, first, planes, order, bond_number, room }, n)?;
            queue.run(&PutBonds { particles, first, planes, room, bond_other: bond_number }, n)?;
        }
        Ok(())
    }
}

/// What incremental bonds remember, from the planes of a device.
pub(super) fn histories(planes: &[f64]) -> Vec<BondHistory> {
    let count = planes.len() / HISTORY;
    let one = |bond: usize| {
        let [nx, ny, nz, tension, sx, sy, sz, cx, cy, cz] =
            std::array::from_fn::<f64, HISTORY, _>(|k| planes[k * count + bond]);
        BondHistory { normal: [nx, ny, nz], tension, shear: [sx, sy, sz], couple: [cx, cy, cz] }
    };
    (0..count).into_par_iter().map(one).collect()
}

/// The table with what broke since a step.
pub(super) fn with_breakages(table: &[Bond], since: u64, broken: &[u32], released: &[f64]) -> Vec<Bond> {
    let one = |(bond, (&record, &energy)): (&Bond, (&u32, &f64))| {
        let step = since + u64::from(record & ((1 << FAILURE_BITS) - 1));
        let failure = Failure::of_code(f64::from(record >> FAILURE_BITS));
        Bond { breakage: failure.map(|failure| Breakage { step, failure, energy }).or(bond.breakage), ..*bond }
    };
    table.iter().zip(broken.iter().zip(released)).map(one).collect()
}

/// Bytes per particle, where each has twelve bonds, and per bond.
pub(super) fn bytes_each(plan: &Plan) -> [usize; 2] {
    let (word, real) = (size_of::<u32>(), size_of::<f64>());
    let Some(bonds) = &plan.bonds else { return [0; 2] };
    let remembers = bonds.remembers();
    let place = if remembers { 0 } else { size_of::<Quad>() };
    let (row, mut bond) = (12 * word, word + real);
    let apart = remembers || plan.search.every_step;
    if apart {
        bond += 2 * word + 9 * real + heat::bytes_each(plan)[1];
    }
    if remembers {
        bond += (1 + HISTORY) * real;
    }
    if apart && plan.ledger && bonds.law.damping != Damping::Off {
        bond += real;
    }
    [place + 2 * size_of::<Quad>() + row + word + if apart { row } else { 0 }, bond]
}

/// Where rows of the given lengths start, and the end of the last; nothing if there are none.
fn starts(lengths: &[u32]) -> Vec<u32> {
    let mut end = 0;
    let ends = lengths.iter().map(|length| {
        end += length;
        end
    });
    std::iter::once(0).chain(ends).take(if lengths.is_empty() { 0 } else { lengths.len() + 1 }).collect()
}
