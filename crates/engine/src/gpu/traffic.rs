//! How many bytes a launch moves at least: each buffer once for reading and once for writing, and of what pairs remember
//! only what touching ones do. Empty buffers, of fields that a plan does without, count nothing.

use super::memory::Buffer;
use std::iter::Sum;

/// Bytes that a launch moves at least between memory and chip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Traffic {
    /// Of whole buffers, as far as they are used.
    bytes: u64,
    /// Bytes for each slot of the list with a touching pair: one in each row of the pair, one for a wall.
    per_slot: u64,
    /// Bytes for each touching pair, or particle at a wall.
    per_history: u64,
}

/// How many pairs touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Touching {
    /// Slots of the list.
    pub(crate) slots: u64,
    /// Pairs and particles at walls.
    pub(crate) histories: u64,
}

impl Traffic {
    pub(crate) fn once<T, M>(buffer: &Buffer<T, M>) -> Self {
        Traffic { bytes: (buffer.used() * size_of::<T>()) as u64, ..Traffic::default() }
    }
    pub(crate) fn twice<T, M>(buffer: &Buffer<T, M>) -> Self {
        Traffic { bytes: 2 * Traffic::once(buffer).bytes, ..Traffic::default() }
    }
    /// What each touching slot remembers, read and written.
    pub(crate) fn of_touching_slots<M>(displacement: &Buffer<f64, M>) -> Self {
        Traffic { per_slot: 2 * remembered(displacement), ..Traffic::default() }
    }
    /// What each touching pair remembers, once.
    pub(crate) fn of_histories<M>(displacement: &Buffer<f64, M>) -> Self {
        Traffic { per_history: remembered(displacement), ..Traffic::default() }
    }
    /// Bytes, when so many pairs touch.
    pub(crate) fn bytes(self, touching: Touching) -> u64 {
        self.bytes + self.per_slot * touching.slots + self.per_history * touching.histories
    }
}

/// Bytes of one displacement, if there are any.
fn remembered<M>(displacement: &Buffer<f64, M>) -> u64 {
    if displacement.used() == 0 { 0 } else { size_of::<[f64; 3]>() as u64 }
}

impl Sum for Traffic {
    fn sum<I: Iterator<Item = Traffic>>(all: I) -> Self {
        all.fold(Traffic::default(), |sum, one| Traffic {
            bytes: sum.bytes + one.bytes,
            per_slot: sum.per_slot + one.per_slot,
            per_history: sum.per_history + one.per_history,
        })
    }
}
