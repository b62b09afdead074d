//! What the flags tell of, worked out on the host from what the device left.

use super::bodies::is_held;
use super::run::Gpu;
use super::runtime::{Error, Runtime};
use super::search::SLICE;
use super::snapshot::Temperatures;
use crate::Fault;
use crate::cpu::Quad;
use crate::plan::overlap_ratio;
use tdem_physics::contact::{touch_spheres, touch_wall};

/// The bit of a slot that says its pair touched, as in `kernels/particle.cl`.
const TOUCHING: u32 = 1 << 31;
const BONDED: u32 = 1 << 30;

impl<R: Runtime> Gpu<R> {
    /// The fault of a particle that is nowhere or outside, the lowest rank of all, at the prediction after `done` steps.
    pub(super) fn astray(&self, done: u64) -> Result<Fault, Error> {
        let n = self.particles;
        let place = self.queue.read(&self.halves[self.now].place, n)?;
        let rank = self.queue.read(&self.fields.rank, n)?;
        let domain = &self.plan.domain;
        let inside = |p: &Quad| (0..3).all(|k| p.0[k] >= domain.min[k] && p.0[k] <= domain.max[k]);
        let step = self.step + done + 1;
        let time = self.plan.time(step);
        let lost = place.iter().zip(&rank).filter(|(p, _)| !inside(p)).min_by_key(|&(_, &rank)| rank);
        Ok(match lost {
            Some((place, &rank)) => {
                let particle = self.ids[rank as usize];
                let position: [f64; 3] = place.vector().into();
                if position.iter().all(|c| c.is_finite()) {
                    Fault::Escaped { step, time, particle, position }
                } else {
                    Fault::NotFinite { step, time, particle }
                }
            }
            None => Fault::Inconsistent { what: "the device lost a particle that the host finds in place" },
        })
    }

    /// The fault of a temperature that is none, the lowest rank of all, at the prediction after `done` steps.
    pub(super) fn unphysical(&self, done: u64) -> Result<Fault, Error> {
        let half = &self.halves[self.now];
        let (apart, spin) = (self.queue.read(&half.temperature, usize::MAX)?, self.queue.read(&half.spin, usize::MAX)?);
        let temperatures = Temperatures { apart: &apart, spin: &spin };
        let rank = self.queue.read(&self.fields.rank, self.particles)?;
        let of_rank = rank.iter().enumerate().map(|(i, &rank)| (temperatures.of(i), rank));
        let wrong = of_rank.filter(|&(t, _)| !(t > 0.0 && t.is_finite()));
        let step = self.step + done + 1;
        Ok(match wrong.min_by_key(|&(_, rank)| rank) {
            Some((temperature, rank)) => {
                Fault::Temperature { step, time: self.plan.time(step), particle: self.ids[rank as usize], temperature }
            }
            None => Fault::Inconsistent { what: "the device found no temperature where the host finds one" },
        })
    }

    /// The fault of two particles that overlap too much, or else of a particle and a wall, the lowest ranks of all, in the last of
    /// `done` steps, which read the given half.
    pub(super) fn crushed(&self, half: usize, done: u64) -> Result<Fault, Error> {
        let n = self.particles;
        let rank = self.queue.read(&self.fields.rank, n)?;
        let slice = self.queue.read(&self.rows.slice, n.div_ceil(SLICE) + 1)?;
        let slots = slice[n.div_ceil(SLICE)] as usize * SLICE;
        let other = self.queue.read(&self.rows.other, slots)?;
        let period = self.plan.domain.period();
        let place = self.queue.read(&self.halves[half].place, n)?;
        let positions = self.queue.read(&self.halves[half].wall_place, self.plan.walls.len())?;
        let (step, limit) = (self.step + done, self.plan.overlap_limit);
        let time = self.plan.time(step);
        let kind = self.queue.read(&self.fields.kind, n)?;
        let mut worst: Option<((u32, u32), f64)> = None;
        let mut through: Option<((u32, usize), f64)> = None;
        for i in 0..n {
            for k in slice[i / SLICE]..slice[i / SLICE + 1] {
                let entry = other[k as usize * SLICE + i % SLICE];
                if entry & !TOUCHING & BONDED != 0 {
                    continue;
                }
                let j = (entry & !TOUCHING) as usize;
                let radius = place[i].scalar();
                if j >= n {
                    let Some(wall) = self.plan.walls.get(j - n) else { break };
                    let touch = touch_wall(place[i].vector(), radius, positions[j - n].vector(), wall.normal.into());
                    let found = (rank[i], j - n);
                    let rests = is_held(kind[i]) && wall.rests();
                    if touch.overlap > limit * radius && !rests && through.is_none_or(|(known, _)| found < known) {
                        through = Some((found, overlap_ratio(touch.overlap, radius, f64::INFINITY)));
                    }
                    continue;
                }
                let other_radius = place[j].scalar();
                let offset = period.nearest(place[j].vector() - place[i].vector());
                let overlap = touch_spheres(offset, radius + other_radius).overlap;
                let pair = (rank[i].min(rank[j]), rank[i].max(rank[j]));
                let too_much = overlap > limit * radius.min(other_radius);
                if too_much && !(is_held(kind[i]) && is_held(kind[j])) && worst.is_none_or(|(known, _)| pair < known) {
                    worst = Some((pair, overlap_ratio(overlap, radius, other_radius)));
                }
            }
        }
        if let Some(((first, second), ratio)) = worst {
            let [first, second] = [first, second].map(|rank| self.ids[rank as usize]);
            return Ok(Fault::Overlap { step, time, first, second, ratio, limit });
        }
        if let Some(((particle, wall), ratio)) = through {
            let (particle, wall) = (self.ids[particle as usize], self.plan.walls[wall].name.clone());
            return Ok(Fault::WallOverlap { step, time, particle, wall, ratio, limit });
        }
        Ok(Fault::Inconsistent { what: "the device found an overlap that the host does not find" })
    }
}
