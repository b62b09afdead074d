//! Joins what chunks of particles found into the rows of the list.

use super::find::Found;
use crate::Fault;
use crate::cpu::neighbours::{Neighbours, fit};
use crate::cpu::pieces::{chunks_of, split};
use rayon::prelude::*;

/// How many entries of the list the neighbours of a row make, in its own row and among its incoming pairs.
fn entries([higher, lower]: [u32; 2], half: bool) -> [u32; 2] {
    if half { [higher, lower] } else { [higher + lower, 0] }
}

/// Entries of all chunks together, as [`entries`].
pub(super) fn ends(found: &[Found], half: bool) -> Vec<[u64; 2]> {
    let of_chunk = |found: &Found| {
        let each = found.count.iter().map(|&count| entries(count, half));
        each.fold([0; 2], |[mine, theirs], [a, b]| [mine + u64::from(a), theirs + u64::from(b)])
    };
    let sums: Vec<[u64; 2]> = found.par_iter().map(of_chunk).collect();
    let mut end = [0; 2];
    let ends = sums.into_iter().map(|sum| {
        end = [end[0] + sum[0], end[1] + sum[1]];
        end
    });
    std::iter::once([0; 2]).chain(ends).collect()
}

/// Writes rows and incoming pairs; `ends` are those of [`ends`].
///
/// # Errors
/// [`Fault::Inconsistent`] if a particle found another that did not find it, which would be a bug.
pub(super) fn lay_out(list: &mut Neighbours, found: &[Found], ends: &[[u64; 2]], half: bool) -> Result<(), Fault> {
    let particles = found.iter().map(|found| found.count.len()).sum();
    let bounds = [0, 1].map(|side| ends.iter().map(|end| end[side] as usize).collect::<Vec<usize>>());
    let total = ends.last().map_or([0; 2], |end| end.map(|end| end as usize));
    let Neighbours { start, other, incoming_start, incoming, .. } = &mut *list;
    fit(start, particles + 1);
    fit(other, total[0]);
    fit(incoming_start, if half { particles + 1 } else { 0 });
    fit(incoming, total[1]);
    start[0] = 0;
    incoming_start.iter_mut().take(1).for_each(|start| *start = 0);
    let chunks = chunks_of(particles);
    let tasks: Vec<_> = (split(&mut start[1..], &chunks).zip(split(other, &bounds[0])))
        .zip(split(incoming_start.get_mut(1..).unwrap_or_default(), &chunks).zip(split(incoming, &bounds[1])))
        .zip(found)
        .zip(ends)
        .collect();
    tasks.into_par_iter().for_each(|((((start, other), (incoming_start, incoming)), found), &ends)| {
        let mut end = ends.map(|end| end as u32);
        let mut at = [0; 2];
        let mut rest = &found.other[..];
        for (k, &count) in found.count.iter().enumerate() {
            let lengths = entries(count, half);
            for (side, to) in [&mut *other, &mut *incoming].into_iter().enumerate() {
                let (from, tail) = rest.split_at(lengths[side] as usize);
                to[at[side]..at[side] + from.len()].copy_from_slice(from);
                at[side] += from.len();
                end[side] += lengths[side];
                rest = tail;
            }
            start[k] = end[0];
            if let Some(start) = incoming_start.get_mut(k) {
                *start = end[1];
            }
        }
    });
    number_incoming(list)
}

/// Incoming pairs are known by the particles that keep them: puts the pairs in their places.
fn number_incoming(list: &mut Neighbours) -> Result<(), Fault> {
    let Neighbours { start, other, incoming_start, incoming, .. } = list;
    let chunks = chunks_of(incoming_start.len().saturating_sub(1));
    if incoming.is_empty() {
        return Ok(());
    }
    let bounds: Vec<usize> = chunks.iter().map(|&first| incoming_start[first] as usize).collect();
    let tasks: Vec<_> = split(incoming, &bounds).zip(chunks.windows(2)).collect();
    tasks.into_par_iter().try_for_each(|(incoming, chunk)| {
        let mut rest = incoming;
        for j in chunk[0]..chunk[1] {
            let (mine, tail) = rest.split_at_mut((incoming_start[j + 1] - incoming_start[j]) as usize);
            rest = tail;
            for keeper in mine {
                let row = start[*keeper as usize]..start[*keeper as usize + 1];
                let keeps = |&pair: &u32| other[pair as usize] as usize == j;
                // Both sides find a pair, or neither: distances are the same to the last bit.
                let one_sided = Fault::Inconsistent { what: "a particle found another that did not find it" };
                *keeper = row.into_iter().find(keeps).ok_or(one_sided)?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::CHUNK;

    #[test]
    fn incoming_pairs_are_those_of_the_other_rows() {
        // A ring over two chunks: each particle has the one before it (of lower rank) and the one behind.
        let n = CHUNK as u32 + 3;
        let found: Vec<Found> = [0..CHUNK as u32, CHUNK as u32..n]
            .into_iter()
            .map(|chunk| {
                let mut found = Found::default();
                for i in chunk {
                    let row: &[u32] = match i {
                        0 => &[1, n - 1],
                        i if i == n - 1 => &[0, n - 2],
                        i => &[i + 1, i - 1],
                    };
                    found.count.push(if i == 0 {
                        [2, 0]
                    } else if i == n - 1 {
                        [0, 2]
                    } else {
                        [1, 1]
                    });
                    found.other.extend(row);
                }
                found
            })
            .collect();
        let mut list = Neighbours::default();
        lay_out(&mut list, &found, &ends(&found, true), true).expect("each pair is found from both sides");
        assert_eq!((list.other.len(), list.incoming.len()), (n as usize, n as usize));
        for j in 0..n as usize {
            let keepers: Vec<usize> =
                (0..n as usize).filter(|&i| list.row(i).any(|p| list.other[p] as usize == j)).collect();
            let pairs: Vec<usize> = list.incoming(j).iter().map(|&pair| pair as usize).collect();
            assert!(pairs.iter().all(|&pair| list.other[pair] as usize == j));
            let rows: Vec<usize> =
                pairs.iter().map(|&p| (0..n as usize).position(|i| list.row(i).contains(&p)).unwrap_or(0)).collect();
            assert_eq!(rows, keepers, "of particle {j}");
        }
        lay_out(&mut list, &found, &ends(&found, false), false).expect("each pair is found from both sides");
        assert_eq!((list.other.len(), list.incoming.len(), list.incoming(1).len()), (2 * n as usize, 0, 0));
        assert_eq!(list.other[list.row(5)], [6, 4]);
        // Particle 1 no longer finds 2, which still finds it.
        let mut found = found;
        found[0].count[1] = [0, 1];
        found[0].other.remove(2);
        let broken = lay_out(&mut list, &found, &ends(&found, true), true);
        assert!(matches!(broken, Err(Fault::Inconsistent { .. })), "{broken:?}");
    }
}
