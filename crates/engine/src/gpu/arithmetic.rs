//! How many additions and multiplications in 64 bits a device makes in a second.

use super::layout::arithmetic::{Chain, Chains, heads, record_definitions};
use super::layout::with_heads;
use super::memory::Queue;
use super::program::Program;
use super::runtime::{Error, Runtime};
use crate::arithmetic::{FACTOR, PER_LINK, TERM};
use crate::profile::shortest;

/// Chains of a work-item, as in the kernel.
const CHAINS: usize = 8;
/// Work-items of a measurement: they fill the largest devices.
const ITEMS: usize = 1 << 18;
/// Links of each chain in a measurement.
const LINKS: u32 = 512;

/// The program.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arithmetic;

impl Program for Arithmetic {
    fn kernels(&self) -> Vec<&'static str> {
        heads().into_iter().map(|head| head.name).collect()
    }
    fn source(&self) -> String {
        let skeletons = format!("\n{}", include_str!("kernels/arithmetic.cl"));
        record_definitions() + &with_heads(skeletons, &heads())
    }
}

fn chain(items: usize, links: u32) -> Chain {
    Chain { factor: FACTOR, term: TERM, links, items: items as u32 }
}

/// Operations a second.
pub(super) fn rate<R: Runtime>(runtime: R) -> Result<f64, Error> {
    let queue = Queue::new(runtime, Arithmetic)?;
    let sum = queue.buffer::<f64>(ITEMS)?;
    let seconds = shortest(|times| {
        for _ in 0..times {
            queue.run(&Chains { chain: chain(ITEMS, LINKS), sum: &sum }, ITEMS)?;
        }
        queue.wait()
    })?;
    Ok(PER_LINK * (CHAINS * ITEMS) as f64 * f64::from(LINKS) / seconds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::sum_of_ends;
    use crate::gpu::devices::{open_cuda, open_opencl};

    fn chains_compute_what_they_should<R: Runtime>(runtime: R) {
        let queue = Queue::new(runtime, Arithmetic).expect("the kernel compiles");
        let sum = queue.zeros::<f64>(300).expect("there is room");
        for links in [0, 1, 7, 30] {
            // Items behind the last one are left alone.
            queue.run(&Chains { chain: chain(299, links), sum: &sum }, 299).expect("it runs");
            let found = queue.read(&sum, 300).expect("it arrives");
            let expected =
                |item: usize| if item < 299 { sum_of_ends((CHAINS * item) as f64, CHAINS, links.into()) } else { 0.0 };
            for (item, found) in found.into_iter().enumerate() {
                assert_eq!(found.to_bits(), expected(item).to_bits(), "{links} {item}");
            }
        }
    }

    #[test]
    fn chains_compute_what_they_should_through_opencl() {
        chains_compute_what_they_should(open_opencl(0).expect("the tests need an OpenCL device"));
    }

    #[test]
    #[ignore = "needs a device of CUDA"]
    fn chains_compute_what_they_should_through_cuda() {
        chains_compute_what_they_should(open_cuda(0).expect("a device of CUDA"));
    }

    #[test]
    fn a_rate_is_that_of_a_device() {
        let rate = rate(open_opencl(0).expect("the tests need an OpenCL device")).expect("it runs");
        assert!(rate > 1e8 && rate < 1e15, "{rate:e}");
    }
}
