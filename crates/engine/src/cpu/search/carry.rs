//! What pairs remember comes from the old list into the new one.

use crate::cpu::bodies::Quad;
use crate::cpu::neighbours::{Histories, fit, reaction_numbers};
use crate::cpu::pieces::{chunks_of, split};
use crate::cpu::{Cpu, List};
use rayon::prelude::*;
use tdem_physics::contact::Friction;

impl Cpu {
    /// Fills in what touching pairs remember. `came_from` says where particles stood when histories were noted; it is empty
    /// if they have not moved.
    pub(super) fn carry_over(&mut self, histories: &Histories, came_from: &[u32]) {
        let (bodies, bonds, list) = (&self.bodies, &self.bonds, &mut self.neighbours);
        let rank = &bodies.rank[..];
        let pairs = list.other.len();
        let apart = self.plan.bonds.as_ref().is_some_and(|bonds| !bonds.contact_in_bonded_pairs);
        fit(&mut list.touching, pairs);
        fit(&mut list.bonded, if apart && !bonds.is_empty() { pairs } else { 0 });
        fit(&mut list.displacement, if self.plan.law.friction == Friction::Off { 0 } else { pairs });
        // Not cleared: what is there is read only of pairs that touch, after stage `contact` wrote it.
        let numbers = if self.options.list == List::Half { reaction_numbers(&self.plan) } else { 0 };
        fit(&mut list.reaction, numbers * pairs);
        let particles = chunks_of(rank.len());
        let bounds: Vec<usize> = particles.iter().map(|&first| list.start[first] as usize).collect();
        let (start, other) = (&list.start[..], &list.other[..]);
        let tasks: Vec<_> = split(&mut list.touching, &bounds)
            .zip(split(&mut list.displacement, &bounds))
            .zip(split(&mut list.bonded, &bounds))
            .zip(particles.windows(2))
            .collect();
        let before = |i: usize| came_from.get(i).map_or(i, |&from| from as usize);
        tasks.into_par_iter().for_each(|(((touching, displacement), bonded), chunk)| {
            let base = start[chunk[0]] as usize;
            for i in chunk[0]..chunk[1] {
                for pair in start[i] as usize..start[i + 1] as usize {
                    let j = other[pair] as usize;
                    let holds = !bonded.is_empty() && bonds.hold(rank, i, j);
                    if let Some(bonded) = bonded.get_mut(pair - base) {
                        *bonded = holds;
                    }
                    let kept = if holds {
                        None
                    } else if rank[i] < rank[j] {
                        histories.of(before(i), rank[j])
                    } else {
                        histories.of(before(j), rank[i]).map(|displacement| displacement.map(|c| -c))
                    };
                    touching[pair - base] = kept.is_some();
                    if let Some(displacement) = displacement.get_mut(pair - base) {
                        *displacement = kept.unwrap_or_default();
                    }
                }
            }
        });
        if self.plan.expands() {
            bodies.place.par_iter().map(Quad::scalar).collect_into_vec(&mut list.listed_radius);
        }
        bodies.place.par_iter().map(|place| place.vector().into()).collect_into_vec(&mut list.reference);
    }
}
