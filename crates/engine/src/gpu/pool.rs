//! Host memory for transfers, kept for the next one: pinning pages costs far more than a transfer.

use std::sync::{Arc, Mutex, PoisonError};

/// Host memory that a device can write.
pub(super) trait Block: Send {
    /// Size, bytes.
    fn capacity(&self) -> usize;
}

/// Blocks that are not in use, the smallest first.
pub(super) struct Pool<B>(Arc<Mutex<Vec<B>>>);

impl<B: Block> Pool<B> {
    pub(super) fn new() -> Self {
        Pool(Arc::default())
    }
    /// Another handle of the same pool.
    pub(super) fn share(&self) -> Self {
        Pool(Arc::clone(&self.0))
    }
    /// The smallest free block of at least `bytes`, else a new one. A new one replaces a free one that is too small,
    /// so there are never more blocks than were in use at one time.
    pub(super) fn take<E>(&self, bytes: usize, make: impl FnOnce(usize) -> Result<B, E>) -> Result<B, E> {
        let mut free = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let place = free.partition_point(|block| block.capacity() < bytes);
        if place < free.len() {
            return Ok(free.remove(place));
        }
        drop(free.pop());
        make(bytes)
    }
    /// Takes back a block that nothing writes any more.
    pub(super) fn give_back(&self, block: B) {
        let mut free = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let place = free.partition_point(|other| other.capacity() < block.capacity());
        free.insert(place, block);
    }
}
