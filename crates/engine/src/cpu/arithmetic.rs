//! How many additions and multiplications the threads make in a second.

use super::wide::{Eight, Loop, run_portable, run_widest};
use super::{Options, Width};
use crate::Fault;
use crate::arithmetic::{FACTOR, PER_LINK, TERM};
use crate::profile::shortest;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::hint::black_box;
use tdem_physics::real::WIDTH;

/// Links of each chain in one measurement.
const LINKS: u64 = 1 << 16;

/// Chains of eight numbers each, as many side by side as `COUNT` says. The first numbers are 0, 1, 2 and so on, lane by lane
/// within a chain.
struct Chains<const COUNT: usize> {
    links: u64,
}

impl<const COUNT: usize> Loop for Chains<COUNT> {
    /// The last numbers.
    type Found = [[f64; WIDTH]; COUNT];
    #[inline(always)]
    fn run<R: Eight>(self) -> Self::Found {
        let (factor, term) = (R::lit(FACTOR), R::lit(TERM));
        let mut x: [R; COUNT] =
            std::array::from_fn(|k| R::from_array(std::array::from_fn(|lane| black_box((WIDTH * k + lane) as f64))));
        for _ in 0..self.links {
            for k in 0..COUNT {
                x[k] = x[k] * factor + term;
            }
        }
        x.map(|x| R::quads([x; 4]).map(|[first, ..]| first))
    }
}

fn last<const COUNT: usize>(width: Width, links: u64) -> [[f64; WIDTH]; COUNT] {
    let chains = Chains { links };
    if width == Width::Widest { run_widest(chains) } else { run_portable(chains) }
}

/// Operations a second of all threads, with so many chains in each.
fn rate_of<const COUNT: usize>(pool: &ThreadPool, width: Width) -> Result<f64, Fault> {
    let seconds = shortest(|times| {
        pool.broadcast(|_| {
            for _ in 0..times {
                black_box(last::<COUNT>(width, LINKS));
            }
        });
        Ok::<_, Fault>(())
    })?;
    Ok(PER_LINK * LINKS as f64 * (WIDTH * COUNT * pool.current_num_threads()) as f64 / seconds)
}

/// Operations a second of all threads; eight numbers at a time also where contacts are evaluated one by one. How many chains
/// fill the registers depends on the machine: the best of several numbers counts.
pub(crate) fn rate(options: &Options) -> Result<f64, Fault> {
    let threads = options.threads.unwrap_or(0);
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|_| Fault::Threads { threads })?;
    let rates = [rate_of::<4>, rate_of::<6>, rate_of::<10>].map(|rate| rate(&pool, options.width));
    rates.into_iter().try_fold(0.0, |best: f64, rate| Ok(best.max(rate?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::sum_of_ends;

    #[test]
    fn chains_compute_what_they_should() {
        for width in Width::ALL {
            for links in [0, 1, 7, 30] {
                let found: f64 = last::<6>(width, links).as_flattened().iter().fold(0.0, |sum, x| sum + x);
                assert_eq!(found.to_bits(), sum_of_ends(0.0, 6 * WIDTH, links).to_bits(), "{width:?} {links}");
            }
        }
    }

    #[test]
    fn a_rate_is_that_of_a_processor() {
        let options = Options { threads: Some(1), ..Options::default() };
        let rate = rate(&options).expect("one thread can be started");
        assert!(rate > 1e8 && rate < 1e12, "{rate:e}");
    }
}
