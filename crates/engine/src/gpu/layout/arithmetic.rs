//! The table of what arithmetic is measured with, see `kernels/arithmetic.cl`. Its kernel is a program of its own.

use super::super::arithmetic::Arithmetic;
use super::{Argument, Buffer, Call, Head, InC, Pod, Traffic, Zeroable};

records! {
    /// What the kernel is told.
    Chain {
        /// Of a link.
        factor: f64,
        term: f64,
        /// Of each chain.
        links: u32,
        items: u32,
    }
}

kernels! {
    of Arithmetic;
    /// See `kernels/arithmetic.cl`.
    chains as Chains(128, 8) { chain: value Chain, sum: write f64 }
}
