//! Exact sums: the real number that is the sum of all terms, rounded once.
//!
//! The result does not depend on the order of the terms, on how they are grouped, or on the machine: threads, devices and
//! later ranks may add in any order. `gpu/kernels/exact.cl` adds on a device, to the same bits.

#[cfg(test)]
pub(crate) mod tests;

use crate::cpu::{Eight, Loop, Width, run_portable, run_widest};
use rayon::prelude::*;

/// Digits of 32 bits: from $2^{-1074}$ to $2^{1024}$, and room for $2^{62}$ terms.
const DIGITS: usize = 68;
/// Terms that digits bear before carries must be taken out of them.
const BEARABLE: u32 = 1 << 30;
/// Terms of a pass: as many can be added as reals without rounding.
const CHUNK: usize = 1024;
/// Terms side by side in a pass.
const SIDE: usize = 8;
/// Parts of a term in a pass, each of so many bits.
const PARTS: usize = 3;
const PART_BITS: u64 = 41;
/// Fewer terms are added one by one.
const FEW: usize = 48;

/// An exact sum of reals: integers of 32 bits, each worth $2^{32}$ times the one before, with room for carries.
///
/// [`ExactSum::value`] is the sum rounded to the nearest `f64`, ties to even:
///
/// | terms | value |
/// |---|---|
/// | none, or zeros of either sign, or a sum that cancels | +0 |
/// | finite | the nearest `f64`, subnormal ones included; an infinity where the sum rounds beyond the largest one, whatever partial sums are |
/// | an infinity of one sign, and finite ones | that infinity |
/// | infinities of both signs, or NaN | NaN |
///
/// Up to $2^{62}$ terms.
#[derive(Clone, Debug)]
pub struct ExactSum {
    /// Worth $2^{32 k - 1074}$ each. Between two normalisations they are any integers, afterwards those of a number of base
    /// $2^{32}$, of which the last one has the sign.
    digit: [i64; DIGITS],
    /// Terms since the last normalisation.
    borne: u32,
    nan: bool,
    /// Positive and negative.
    infinite: [bool; 2],
}

impl Default for ExactSum {
    fn default() -> Self {
        ExactSum { digit: [0; DIGITS], borne: 0, nan: false, infinite: [false; 2] }
    }
}

impl ExactSum {
    /// The sum of some terms.
    #[must_use]
    pub fn of(terms: impl IntoIterator<Item = f64>) -> Self {
        let mut sum = ExactSum::default();
        terms.into_iter().for_each(|term| sum.add(term));
        sum
    }

    /// Adds a term.
    pub fn add(&mut self, term: f64) {
        let bits = term.to_bits();
        let (exponent, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
        if exponent == 0x7ff {
            self.nan |= fraction != 0;
            self.infinite[usize::from(term < 0.0)] |= fraction == 0;
            return;
        }
        let mantissa = fraction | u64::from(exponent != 0) << 52;
        let place = exponent.saturating_sub(1) as usize;
        // 53 bits shifted by up to 31 are 84 bits: three digits.
        let wide = u128::from(mantissa) << (place % 32);
        let sign = bits.cast_signed() >> 63;
        for (k, digit) in self.digit[place / 32..][..3].iter_mut().enumerate() {
            *digit += (i64::from((wide >> (32 * k)) as u32) ^ sign) - sign;
        }
        self.bear();
    }

    /// Adds many terms, with the widest instructions of this machine.
    pub fn add_all(&mut self, terms: &[f64]) {
        terms.chunks(CHUNK).for_each(|chunk| self.add_chunk(chunk, Width::Widest));
    }

    /// Adds what another sum holds.
    pub fn merge(&mut self, other: &ExactSum) {
        let mut other = other.clone();
        other.normalise();
        self.digit.iter_mut().zip(&other.digit).for_each(|(digit, other)| *digit += other);
        self.nan |= other.nan;
        (0..2).for_each(|k| self.infinite[k] |= other.infinite[k]);
        self.bear();
    }

    /// The sum, rounded once.
    #[must_use]
    pub fn value(&self) -> f64 {
        match (self.nan, self.infinite) {
            (true, _) | (_, [true, true]) => return f64::NAN,
            (_, [true, false]) => return f64::INFINITY,
            (_, [false, true]) => return f64::NEG_INFINITY,
            (_, [false, false]) => {}
        }
        let mut size = self.clone();
        size.normalise();
        let negative = size.digit[DIGITS - 1] < 0;
        if negative {
            size.digit.iter_mut().for_each(|digit| *digit = -*digit);
            size.normalise();
        }
        let Some(top) = size.digit.iter().rposition(|&digit| digit != 0) else { return 0.0 };
        let digit = |below: usize| top.checked_sub(below).map_or(0, |k| size.digit[k] as u128);
        let zeros = (digit(0) as u32).leading_zeros() as usize;
        // The leading bit is the highest of 64, and stands for 2^(place - 1074).
        let window = (digit(0) << 64 | digit(1) << 32 | digit(2)) << zeros;
        let (high, place) = ((window >> 32) as u64, 32 * top + 31 - zeros);
        let rounded = if place < 53 {
            high >> (63 - place)
        } else {
            let (mantissa, rest, half) = (high >> 11, high & 0x7ff, 0x400);
            let beyond = window as u32 != 0 || top > 2 && size.digit[..top - 2].iter().any(|&digit| digit != 0);
            let up = rest > half || rest == half && (beyond || mantissa & 1 == 1);
            // The mantissa has 53 bits, of which the first one adds one to the exponent; a carry out of it does the same.
            (((place - 52) as u64) << 52) + mantissa + u64::from(up)
        };
        let value = f64::from_bits(rounded.min(f64::INFINITY.to_bits()));
        if negative { -value } else { value }
    }

    /// Counts a term.
    fn bear(&mut self) {
        self.borne += 1;
        if self.borne == BEARABLE {
            self.normalise();
        }
    }

    /// Takes carries out of all digits.
    fn normalise(&mut self) {
        for k in 0..DIGITS - 1 {
            let carry = self.digit[k] >> 32;
            self.digit[k] -= carry << 32;
            self.digit[k + 1] += carry;
        }
        // What is left in them counts as one term.
        self.borne = 1;
    }

    /// Adds at most [`CHUNK`] terms.
    ///
    /// # Numerics
    /// Parts of the terms that are multiples of one unit are added as reals, without rounding, so that their order does not
    /// matter: with $|x| < 2^{e + 1}$ and $\sigma = 2^{e + 13}$ the part $(\sigma + x) - \sigma$ is a multiple of
    /// $2^{e - 40}$, 1024 of them are less than $2^{e + 11}$, and what is left of a term is at most $2^{e - 40}$. Three such
    /// parts, each [`PART_BITS`] lower than the one before, take up all bits of terms that are not smaller than
    /// $2^{e - 70}$. Where more is left, or terms are near either end of the range of `f64`, all of them go into digits.
    fn add_chunk(&mut self, terms: &[f64], width: Width) {
        debug_assert!(terms.len() <= CHUNK, "more would round");
        let (eights, rest) = terms.as_chunks();
        let pass = Pass { eights };
        let found = match width {
            _ if terms.len() < FEW => None,
            Width::One => None,
            Width::Portable => run_portable(pass),
            Width::Widest => run_widest(pass),
        };
        match found {
            Some(sums) => sums.into_iter().flatten().chain(rest.iter().copied()).for_each(|sum| self.add(sum)),
            None => terms.iter().filter(|&&term| term != 0.0).for_each(|&term| self.add(term)),
        }
    }
}

/// Takes three parts out of each term, from the magnitude of the largest one down.
struct Pass<'a> {
    eights: &'a [[f64; SIDE]],
}

impl Loop for Pass<'_> {
    /// Sums of the parts, exactly; `None` if anything is left of a term, or terms are too large or too small.
    type Found = Option<[[f64; SIDE]; PARTS]>;
    #[inline(always)]
    fn run<R: Eight>(self) -> Self::Found {
        let mut largest = [0.0; SIDE];
        for eight in self.eights {
            for k in 0..SIDE {
                // Passes over NaN, of which NaN is left.
                let size = eight[k].abs();
                largest[k] = if size > largest[k] { size } else { largest[k] };
            }
        }
        let exponent = largest.into_iter().fold(0.0, f64::max).to_bits() >> 52;
        // The largest unit is a number, and the smallest part is not subnormal.
        if exponent + 13 >= 0x7ff || exponent < PARTS as u64 * PART_BITS + 64 {
            return None;
        }
        let unit: [f64; PARTS] = std::array::from_fn(|p| f64::from_bits((exponent + 13 - PART_BITS * p as u64) << 52));
        let (mut sum, mut left) = ([[0.0; SIDE]; PARTS], [0; SIDE]);
        for eight in self.eights {
            let mut eight = *eight;
            for p in 0..PARTS {
                for k in 0..SIDE {
                    let part = (unit[p] + eight[k]) - unit[p];
                    sum[p][k] += part;
                    eight[k] -= part;
                }
            }
            for k in 0..SIDE {
                left[k] |= eight[k].to_bits() << 1;
            }
        }
        left.into_iter().all(|left| left == 0).then_some(sum)
    }
}

/// Exact sums of `K` quantities over `0..count`, and the largest value of one more, 0 if there are none.
pub(crate) fn tally<const K: usize>(
    count: usize,
    term: impl Fn(usize) -> ([f64; K], f64) + Sync,
) -> ([ExactSum; K], f64) {
    struct Partial<const K: usize> {
        sums: [ExactSum; K],
        largest: f64,
        room: Vec<[f64; CHUNK]>,
    }
    let none = || Partial {
        sums: std::array::from_fn(|_| ExactSum::default()),
        largest: 0.0,
        room: vec![[0.0; CHUNK]; if count < FEW { 0 } else { K }],
    };
    let add_chunk = |mut partial: Partial<K>, chunk: usize| {
        let indices = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
        let terms = indices.len();
        for (place, index) in indices.enumerate() {
            let (terms, value) = term(index);
            partial.largest = partial.largest.max(value);
            if partial.room.is_empty() {
                (0..K).for_each(|k| partial.sums[k].add(terms[k]));
            } else {
                (0..K).for_each(|k| partial.room[k][place] = terms[k]);
            }
        }
        for (sum, room) in partial.sums.iter_mut().zip(&mut partial.room) {
            sum.add_chunk(&room[..terms], Width::Widest);
        }
        partial
    };
    let join = |mut first: Partial<K>, second: Partial<K>| {
        first.sums.iter_mut().zip(&second.sums).for_each(|(sum, other)| sum.merge(other));
        Partial { largest: first.largest.max(second.largest), ..first }
    };
    let all = (0..count.div_ceil(CHUNK)).into_par_iter().fold(none, add_chunk).reduce(none, join);
    (all.sums, all.largest)
}

/// Exact sums of `K` quantities over `0..count`, to be merged with others.
pub(crate) fn accumulate<const K: usize>(count: usize, term: impl Fn(usize) -> [f64; K] + Sync) -> [ExactSum; K] {
    tally(count, |index| (term(index), 0.0)).0
}

/// Exact sums of `K` quantities over `0..count`, each rounded once; see [`ExactSum`].
pub fn exact_sums<const K: usize>(count: usize, term: impl Fn(usize) -> [f64; K] + Sync) -> [f64; K] {
    accumulate(count, term).map(|sum| sum.value())
}
