//! Bonds on a device, see `kernels/bond.cl`.

use super::layout::{InvertOrder, JointOf, PutBonds, PutStrengths, TakeBonds, TakeStrengths};
use super::memory::{Buffer, Queue};
use super::runtime::{Error, Runtime};
use crate::cpu::Quad;
use crate::{Bond, Breakage, Plan, State};
use std::sync::Arc;
use tdem_physics::bond::Failure;

/// As in `kernels/bond.cl`.
const HOLDS: u32 = 1 << 31;
/// As in `kernels/particle.cl`.
const NOBODY: u32 = 0x3fff_ffff;
/// A record of a broken bond holds its step below these bits, and how it failed in them.
const FAILURE_BITS: u32 = 30;

/// The bonds of a run. Without any, every buffer is empty. `W` is the largest number of bonds of a particle, `B` the number
/// of bonds.
pub(super) struct Bonds<M> {
    /// `W`.
    pub(super) slots: u32,
    /// Places of the particles when they were bonded, in working order; the fourth number is not used.
    pub(super) place: Buffer<Quad, M>,
    /// `W` planes, in working order.
    pub(super) other: Buffer<u32, M>,
    /// Factors on strengths, `W` planes, in working order; empty if all are 1.
    pub(super) strength: Buffer<f64, M>,
    /// Where the bonds of each lower rank start in the table, `(N + 1)`.
    pub(super) start: Buffer<u32, M>,
    /// When and how each bond broke since `since`, 0 if it did not, in the order of the table, `(B)`.
    pub(super) broken: Buffer<u32, M>,
    /// Energy that left with it, J, `(B)`.
    pub(super) released: Buffer<f64, M>,
    pub(super) joints: Buffer<JointOf, M>,
    /// As the state had them at step `since`.
    pub(super) table: Arc<Vec<Bond>>,
    pub(super) bonded_position: Arc<Vec<[f64; 3]>>,
    pub(super) since: u64,
}

impl<M> Bonds<M> {
    pub(super) fn of_state<R: Runtime<Memory = M>>(
        queue: &Queue<R>,
        state: &State,
        plan: &Plan,
        scattered: bool,
    ) -> Result<Self, Error> {
        let n = state.len();
        let rank = |id: u32| state.index_of(id).unwrap_or(0);
        let pairs: Vec<[usize; 2]> = state.bonds.iter().map(|bond| [rank(bond.first), rank(bond.second)]).collect();
        let bonded = if pairs.is_empty() { 0 } else { n };
        let (mut higher, mut degree) = (vec![0_u32; bonded], vec![0_u32; bonded]);
        for &[first, second] in &pairs {
            higher[first] += 1;
            degree[first] += 1;
            degree[second] += 1;
        }
        let slots = degree.iter().copied().max().unwrap_or(0);
        let start = starts(&higher);
        // The table ascends by lower ranks, then by higher ones: rows are filled in their order.
        let mut other = vec![NOBODY; slots as usize * n];
        let mut strength = vec![1.0; if scattered { other.len() } else { 0 }];
        let (mut own, mut incoming) = (vec![0_u32; bonded], higher.clone());
        for (bond, &[first, second]) in state.bonds.iter().zip(&pairs) {
            for (particle, partner, next) in [(first, second, &mut own), (second, first, &mut incoming)] {
                let slot = next[particle] as usize * n + particle;
                next[particle] += 1;
                other[slot] = partner as u32 | if bond.holds() { HOLDS } else { 0 };
                if scattered {
                    strength[slot] = bond.strength;
                }
            }
        }
        let place: Vec<Quad> = state.bonded_position.iter().map(|&place| Quad::new(place, 0.0)).collect();
        let joints = plan.bonds.iter().flat_map(|bonds| &bonds.joints);
        let joints: Vec<JointOf> =
            joints.map(|joint| joint.as_ref().map_or_else(JointOf::default, JointOf::from)).collect();
        Ok(Bonds {
            slots,
            place: queue.buffer_of(&place)?,
            other: queue.buffer_of(&other)?,
            strength: queue.buffer_of(&strength)?,
            start: queue.buffer_of(&start)?,
            broken: queue.zeros(pairs.len())?,
            released: queue.zeros(pairs.len())?,
            joints: queue.buffer_of(&joints)?,
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
        const WORDS: u32 = (size_of::<Quad>() / size_of::<u32>()) as u32;
        const REALS: u32 = (size_of::<Quad>() / size_of::<f64>()) as u32;
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
        if self.strength.len() > 0 {
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
    let word = size_of::<u32>();
    if plan.bonds.is_none() { [0; 2] } else { [3 * size_of::<Quad>() + 13 * word, word + size_of::<f64>()] }
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
