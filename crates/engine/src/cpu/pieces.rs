//! Fields cut into pieces for the tasks of a parallel loop.

use super::CHUNK;

/// Where chunks of particles begin, and where the last ends.
pub(crate) fn chunks_of(particles: usize) -> Vec<usize> {
    (0..=particles.div_ceil(CHUNK)).map(|chunk| (chunk * CHUNK).min(particles)).collect()
}

/// Cuts a field at ascending bounds; an empty field gives empty pieces.
pub(crate) fn split<'a, T>(field: &'a mut [T], bounds: &[usize]) -> std::vec::IntoIter<&'a mut [T]> {
    let mut rest = field;
    let mut pieces = Vec::with_capacity(bounds.len());
    for bound in bounds.windows(2) {
        let length = if rest.is_empty() { 0 } else { bound[1] - bound[0] };
        let (piece, tail) = rest.split_at_mut(length);
        pieces.push(piece);
        rest = tail;
    }
    pieces.into_iter()
}
