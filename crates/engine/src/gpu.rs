//! GPUs through OpenCL and CUDA: one dialect of kernels, and one trait with a runtime for each interface behind it.

mod cuda;
mod devices;
mod kernel_cache;
mod opencl;
mod pool;
mod runtime;
mod self_test;
#[cfg(test)]
mod tests;

pub use devices::{Api, Listing, Survey, devices, survey};
pub use runtime::Error;

/// What precedes the source of every kernel: the dialect, for both compilers.
const PRELUDE: &str = include_str!("gpu/kernels/prelude.cl");
