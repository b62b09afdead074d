//! How many steps fit between two looks at the clock, and how fast a run is.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// How long a batch of steps should take: long enough that looking at the clock costs nothing, short enough that a
/// request to stop is heard at once.
const TARGET: Duration = Duration::from_millis(100);
/// A batch is at most this much longer than the one before: the first steps of a run are no measure of the rest.
const GROWTH: u64 = 4;

/// Sizes of batches. They change when results are written, never what is computed.
#[derive(Debug)]
pub struct Pace {
    batch: u64,
}

impl Default for Pace {
    fn default() -> Self {
        Pace { batch: 1 }
    }
}

impl Pace {
    /// Steps until the clock is to be looked at again.
    #[must_use]
    pub fn batch(&self) -> u64 {
        self.batch
    }
    /// Tells how long so many steps took.
    pub fn took(&mut self, steps: u64, time: Duration) {
        let per_step = (time.as_secs_f64() / steps.max(1) as f64).max(1e-9);
        // The cast saturates.
        let fitting = (TARGET.as_secs_f64() / per_step) as u64;
        self.batch = fitting.clamp(1, self.batch.saturating_mul(GROWTH));
    }
}

/// The rate is averaged over this time: a bar must neither jump nor lag.
const WINDOW: Duration = Duration::from_secs(10);
/// Steps per second are not known before this time has passed.
const LEAST: Duration = Duration::from_millis(200);

/// Steps per second of wall clock, lately.
#[derive(Debug)]
pub struct Rate {
    marks: VecDeque<(Instant, u64)>,
}

impl Rate {
    /// Begins to watch at a step.
    #[must_use]
    pub fn new(step: u64) -> Self {
        Rate { marks: VecDeque::from([(Instant::now(), step)]) }
    }
    /// Tells that a step is reached now.
    pub fn reached(&mut self, step: u64) {
        let now = Instant::now();
        // Marks closer together than this add nothing but memory.
        if self.marks.back().is_none_or(|&(last, _)| now - last >= TARGET / 4) || self.marks.len() < 2 {
            self.marks.push_back((now, step));
        } else if let Some(last) = self.marks.back_mut() {
            *last = (last.0, step.max(last.1));
        }
        while self.marks.len() > 2 && now - self.marks[1].0 > WINDOW {
            self.marks.pop_front();
        }
    }
    /// Steps per second; `None` until that can be said.
    #[must_use]
    pub fn steps_per_second(&self) -> Option<f64> {
        let (&(began, first), &(ended, last)) = (self.marks.front()?, self.marks.back()?);
        let time = ended - began;
        (time >= LEAST).then(|| (last - first) as f64 / time.as_secs_f64())
    }
    /// How long so many steps take at this rate; `None` until that can be said.
    #[must_use]
    pub fn time_for(&self, steps: u64) -> Option<Duration> {
        let rate = self.steps_per_second().filter(|&rate| rate > 0.0)?;
        Duration::try_from_secs_f64(steps as f64 / rate).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_grow_and_shrink_with_the_time_they_take() {
        let mut pace = Pace::default();
        let sizes: Vec<u64> = (0..6)
            .map(|_| {
                pace.took(pace.batch(), Duration::from_micros(pace.batch() * 1000));
                pace.batch()
            })
            .collect();
        assert_eq!(sizes, [4, 16, 64, 100, 100, 100]);
        pace.took(100, Duration::from_secs(50));
        assert_eq!(pace.batch(), 1);
    }
}
