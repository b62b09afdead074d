//! Where the time of a step goes on the device, kernel by kernel, and how fast it copies.

use super::layout::heads;
use super::memory::{Launched, Queue};
use super::program::Program;
use super::run::Gpu;
use super::runtime::{Error, Runtime, Span};
use super::traffic::Touching;
use crate::profile::{COPY_BYTES, best_copy};
use crate::{Fault, Part, Profile, STAGES};
use std::time::Instant;

/// The least that is copied where there is no room for more, bytes.
const LEAST_COPY: usize = 1 << 20;

impl<R: Runtime> Gpu<R> {
    /// Advances with stages apart, each kernel timed by the device.
    pub(super) fn profile_all(&mut self, steps: u64) -> Result<Profile, Fault> {
        if self.particles == 0 {
            self.advance_all(steps)?;
            return Ok(Profile { steps, ..Profile::empty() });
        }
        let searches = self.searches;
        self.queue.begin_record()?;
        let fused = std::mem::replace(&mut self.fused, false);
        let start = Instant::now();
        let advanced = self.advance_all(steps);
        let seconds = start.elapsed().as_secs_f64();
        self.fused = fused;
        let launches = self.queue.end_record()?;
        advanced?;
        let touching = self.touching()?;
        let parts = parts(&launches, touching)?;
        let moved = parts.iter().filter(|part| !fused || part.stage == "search").map(|part| part.bytes).sum::<u64>();
        let mut step = if fused { self.queue.traffic(&self.fused_call()).bytes(touching) } else { 0 };
        if fused && self.bonds.are_apart() {
            step += self.queue.traffic(&self.bonds_call()).bytes(touching);
        }
        let bytes_per_step = step as f64 + moved as f64 / steps.max(1) as f64;
        Ok(Profile { steps, searches: self.searches - searches, seconds, parts, bytes_per_step })
    }

    /// How many pairs touch.
    fn touching(&mut self) -> Result<Touching, Fault> {
        let histories = self.put_histories_aside()?;
        let partners = self.queue.read(&self.histories.partners, histories)?;
        let walls = partners.iter().filter(|&&partner| partner as usize >= self.particles).count();
        Ok(Touching { slots: (2 * histories - walls) as u64, histories: histories as u64 })
    }
}

impl<R: Runtime, P: Program> Queue<R, P> {
    /// Bytes per second, read and written, of copies of as much as there is room for.
    pub(super) fn copy_bandwidth(&self) -> Result<f64, Error> {
        let mut bytes = COPY_BYTES;
        let (from, to) = loop {
            let reals = bytes / size_of::<f64>();
            match self.zeros::<f64>(reals).and_then(|from| Ok((from, self.buffer::<f64>(reals)?))) {
                Err(Error::OutOfMemory { .. }) if bytes > LEAST_COPY => bytes /= 2,
                room => break room?,
            }
        };
        best_copy(bytes, |copies| {
            for _ in 0..copies {
                self.copy(&from, &to)?;
            }
            self.wait()
        })
    }
}

/// All launches of each kernel together, in the order of a step.
fn parts<S: Span>(launches: &[Launched<S>], touching: Touching) -> Result<Vec<Part>, Error> {
    let mut parts: Vec<Part> = heads()
        .iter()
        .map(|head| Part { stage: stage_of(head.name), name: head.name, calls: 0, seconds: 0.0, bytes: 0 })
        .collect();
    for launch in launches {
        let part = parts.iter_mut().find(|part| part.name == launch.kernel).expect("a kernel of the table");
        part.calls += 1;
        part.seconds += launch.span.seconds()?;
        part.bytes += launch.traffic.bytes(touching);
    }
    parts.retain(|part| part.calls > 0);
    parts.sort_by_key(|part| STAGES.iter().position(|&stage| stage == part.stage));
    Ok(parts)
}

/// The stage of a kernel: a search takes many.
fn stage_of(kernel: &str) -> &'static str {
    STAGES.into_iter().find(|&stage| stage == kernel).unwrap_or("search")
}
