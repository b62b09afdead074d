//! Chains of multiplications and additions that wait neither for memory nor for each other: they show how many operations a
//! device makes in a second.
//!
//! A link of a chain is $x \leftarrow a x + b$, which takes two operations, as nothing in this program is fused. Numbers
//! approach $b / (1 - a)$, so that none is subnormal, and none overflows.

/// $a$.
pub(crate) const FACTOR: f64 = 0.75;
/// $b$.
pub(crate) const TERM: f64 = 0.3;
/// Operations of a link.
pub(crate) const PER_LINK: f64 = 2.0;

/// The sum of the last numbers of chains that begin at `first`, `first + 1` and so on, added in this order.
#[cfg(test)]
pub(crate) fn sum_of_ends(first: f64, chains: usize, links: u64) -> f64 {
    let end = |chain: usize| {
        (0..links).fold(first + chain as f64, |x, _| {
            let product = x * FACTOR;
            product + TERM
        })
    };
    (0..chains).map(end).fold(0.0, |sum, x| sum + x)
}
