//! Where the time of a step goes on the processor, stage by stage, and how fast its threads copy.
//!
//! The bytes of a stage are those of whole arrays, counted once for reading and once for writing; of what pairs remember
//! and keep for each other, only what touching ones do:
//!
//! | stage | reads | writes | both |
//! |---|---|---|---|
//! | predict | constraint, reference; under Verlet force, moment | kick, twist | place, motion, derivatives, orientation; under Verlet spin |
//! | search | place, rank | rows, incoming, touching, displacement, reaction, reference, wall slots | histories |
//! | bond | place, orientation, rows of bonds; with dashpots motion, spin | sums of bonds, reaction | what bonds remember |
//! | contact | place, motion, spin, kick, twist, material, rows; with a ledger rank | force, moment, reaction | touching, displacement, accounts |
//! | gather | incoming, touching, reaction; sums of bonds | | force, moment, wall slots |
//! | boundary | motion; with a ledger or applied forces constraint; with ramps, moments and a ledger place | | force |
//! | correct | force, moment, constraint; under Verlet place, for moments | | motion, spin, derivatives; under Gear place |
//!
//! Arrays that a plan does without are empty and count nothing. Heat is timed with predict, contact, gather and boundary,
//! and its own arrays are not counted.

use super::neighbours::Neighbours;
use super::{Cpu, List};
use crate::profile::{COPY_BYTES, Timed, best_copy};
use crate::step::step;
use crate::{Fault, Integrator, Part, Profile, STAGES};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;
use tdem_physics::bond::Damping;
use tdem_physics::contact::Friction;

/// Bytes of an array.
fn size<T>(field: &[T]) -> usize {
    size_of_val(field)
}

impl Cpu {
    /// Advances with a clock around each stage.
    pub(super) fn profile_all(&mut self, steps: u64) -> Result<Profile, Fault> {
        let (pool, searches) = (Arc::clone(&self.pool), self.searches);
        let start = Instant::now();
        let times = pool.install(|| {
            let mut timed = Timed::new(self);
            (0..steps).try_for_each(|_| step(&mut timed))?;
            Ok::<_, Fault>(timed.seconds)
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let searches = self.searches - searches;
        let bytes = self.bytes_of_stages();
        let part = |k: usize| {
            let calls = if STAGES[k] == "search" { searches } else { steps };
            Part { stage: STAGES[k], name: STAGES[k], calls, seconds: times[k], bytes: calls * bytes[k] }
        };
        let bonded = !self.bonds.is_empty();
        let parts: Vec<Part> = (0..STAGES.len()).map(part).filter(|part| bonded || part.stage != "bond").collect();
        let moved: u64 = parts.iter().map(|part| part.bytes).sum();
        Ok(Profile { steps, searches, seconds, parts, bytes_per_step: moved as f64 / steps.max(1) as f64 })
    }

    /// Bytes that each stage moves at least when it runs once, in the order of [`STAGES`].
    fn bytes_of_stages(&self) -> [u64; STAGES.len()] {
        let (b, list) = (&self.bodies, &self.neighbours);
        let law = self.plan.law;
        let gear = self.plan.integrator == Integrator::Gear;
        let verlet = usize::from(!gear);
        let touching = list.touching.iter().filter(|&&touches| touches).count();
        let remembered = if law.friction == Friction::Off { 0 } else { touching * size_of::<[f64; 3]>() };
        let reaction = if self.options.list == List::Half { touching * Neighbours::reaction_bytes(law) } else { 0 };
        let spin = if law.moments { size(&b.spin) } else { 0 };
        let (kicks, sums) = (size(&b.kick) + size(&b.twist), size(&b.force) + size(&b.moment));
        let rows = size(&list.start) + size(&list.other);
        let incoming = size(&list.incoming_start) + size(&list.incoming);
        let held = size(&b.constraint);
        let predict = verlet * (sums + 2 * spin)
            + 2 * (size(&b.place) + size(&b.motion) + size(&b.derivatives) + size(&b.orientation))
            + held
            + size(&list.reference)
            + kicks;
        let (bonds, written) = (&self.bonds, &self.bonds.written);
        let sums_of_bonds = size(&written.force) + size(&written.moment) + size(&written.reaction);
        let dashpots = self.plan.bonds.as_ref().is_some_and(|bonds| bonds.law.damping != Damping::Off);
        let bond = if bonds.is_empty() {
            0
        } else {
            size(&b.place)
                + size(&b.orientation)
                + if dashpots { size(&b.motion) + size(&b.spin) } else { 0 }
                + size(&bonds.owner)
                + size(&bonds.other)
                + size(&bonds.offset)
                + size(&bonds.strength)
                + size(&bonds.holds)
                + sums_of_bonds
                + 2 * size(&written.history)
        };
        let histories = touching * size_of::<u32>() + remembered;
        let search = size(&b.place)
            + size(&b.rank)
            + rows
            + incoming
            + size(&list.touching)
            + size(&list.displacement)
            + size(list.reaction.quads())
            + size(&list.reference)
            + size(&list.wall_slots)
            + 2 * histories;
        let rank = if self.plan.ledger { size(&b.rank) } else { 0 };
        let contact = size(&b.place)
            + size(&b.motion)
            + spin
            + rank
            + kicks
            + size(&b.material)
            + rows
            + sums
            + 2 * (size(&list.touching) + size(&b.accounts) + remembered)
            + reaction;
        let gather = incoming
            + (if incoming == 0 { 0 } else { size(&list.touching) })
            + reaction
            + sums_of_bonds
            + 2 * (sums + size(&list.wall_slots));
        let turned = self.plan.ledger && law.moments && !self.plan.ramps.is_empty();
        let boundary = size(&b.motion)
            + 2 * size(&b.force)
            + if self.plan.ledger || self.plan.applies_forces() { held } else { 0 }
            + if turned { size(&b.place) } else { 0 };
        let place = if gear {
            2 * size(&b.place)
        } else if law.moments {
            size(&b.place)
        } else {
            0
        };
        let correct = sums + held + place + 2 * (size(&b.motion) + spin + size(&b.derivatives));
        [predict, search, bond, contact, gather, boundary, correct].map(|bytes| bytes as u64)
    }
}

/// Bytes per second, read and written, when each thread copies one piece of a large array.
pub(crate) fn copy_bandwidth(pool: &ThreadPool) -> Result<f64, Fault> {
    let reals = COPY_BYTES / size_of::<f64>();
    let piece = reals.div_ceil(pool.current_num_threads());
    let (from, mut to) = (vec![1.0_f64; reals], vec![0.0_f64; reals]);
    best_copy(COPY_BYTES, |copies| {
        pool.install(|| {
            for _ in 0..copies {
                to.par_chunks_mut(piece).zip(from.par_chunks(piece)).for_each(|(to, from)| to.copy_from_slice(from));
            }
        });
        Ok(())
    })
}
