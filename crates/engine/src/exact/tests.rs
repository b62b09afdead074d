//! Exact sums against integers of any length, which are rational numbers with one denominator.

use super::*;
use num_bigint::{BigInt, Sign};
use proptest::prelude::*;

/// A finite real in units of $2^{-1074}$; an infinity stands for $2^{1024}$.
fn units(real: f64) -> BigInt {
    let bits = real.to_bits();
    let (exponent, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
    let mantissa = fraction | u64::from(exponent != 0) << 52;
    let size = BigInt::from(mantissa) << exponent.saturating_sub(1);
    if real < 0.0 { -size } else { size }
}

/// Checks that a value is a sum of finite terms, rounded to the nearest, ties to even.
#[track_caller]
pub(crate) fn assert_rounded_once(value: f64, terms: &[f64], what: &str) {
    let sum: BigInt = terms.iter().map(|&term| units(term)).sum();
    let error = |real: f64| BigInt::from_biguint(Sign::Plus, (&sum - units(real)).magnitude().clone());
    let own = error(value);
    for neighbour in [value.next_down(), value.next_up()] {
        let other = error(neighbour);
        let nearest = own < other || own == other && value.to_bits() & 1 == 0;
        assert!(neighbour == value || nearest, "{what}: {value:e} is farther than {neighbour:e} from {terms:?}");
    }
    assert!(value != 0.0 || value.is_sign_positive(), "{what}: a sum that cancels is +0");
}

/// Numbers by a generator that needs no state of the machine.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Random(seed)
    }
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.word() % end as u64) as usize
    }
    /// Of either sign, with a biased exponent from a range that ends below 2047.
    fn real(&mut self, exponents: std::ops::Range<usize>) -> f64 {
        let exponent = exponents.start + self.below(exponents.len());
        f64::from_bits(self.word() & 0x800f_ffff_ffff_ffff | (exponent as u64) << 52)
    }
    pub(crate) fn shuffle<T>(&mut self, terms: &mut [T]) {
        for k in (1..terms.len()).rev() {
            terms.swap(k, self.below(k + 1));
        }
    }
}

/// Sums that plain addition gets wrong: terms of each.
pub(crate) fn hard_sums(count: usize) -> Vec<Vec<f64>> {
    let mut random = Random::new(1);
    (0..count).map(|k| hard_sum(&mut random, k % 8)).collect()
}

fn hard_sum(random: &mut Random, kind: usize) -> Vec<f64> {
    let length = 1 + random.below(300);
    let mut terms: Vec<f64> = match kind {
        // Any finite bits.
        0 => (0..length).map(|_| random.real(0..2047)).collect(),
        // A range of magnitudes somewhere.
        1 => {
            let (low, range) = (random.below(1800), 1 + random.below(240));
            (0..length).map(|_| random.real(low..low + range)).collect()
        }
        // What cancels, and something small that is left.
        2 => {
            let (low, range) = (600 + random.below(1000), 1 + random.below(300));
            let mut terms: Vec<f64> = (0..length / 2).map(|_| random.real(low..low + range)).collect();
            terms.extend(terms.clone().into_iter().map(|term| -term));
            let left = 1 + random.below(3);
            terms.extend((0..left).map(|_| random.real(low - 590..low)));
            terms
        }
        // Subnormal, and the smallest normal ones.
        3 => (0..length).map(|_| random.real(0..3)).collect(),
        // Partial sums that overflow.
        4 => {
            let mut terms: Vec<f64> = (0..length / 2).map(|_| random.real(2030..2047)).collect();
            terms.extend(terms.clone().into_iter().map(|term| -term));
            let left = 1 + random.below(4);
            terms.extend((0..left).map(|_| random.real(1900..2047)));
            terms
        }
        // Alternating neighbours.
        5 => {
            let first = random.real(1..2040);
            (0..length).map(|k| f64::from_bits(first.to_bits() + k as u64) * [1.0, -1.0][k % 2]).collect()
        }
        // A tie, or next to one, under terms that cancel.
        6 => {
            let place = 200 + random.below(1600) as u64;
            let power = |place: u64| f64::from_bits(place << 52);
            let odd = random.below(2) as f64;
            let mut terms = vec![power(place), odd * power(place - 52), power(place - 53)];
            terms.push([0.0, 1.0, -1.0][random.below(3)] * power(1 + random.below(place as usize - 60) as u64));
            let sign = [1.0, -1.0][random.below(2)];
            for term in &mut terms {
                *term *= sign;
            }
            for _ in 0..random.below(100) {
                let filler = random.real(1..2000);
                terms.extend([filler, -filler]);
            }
            terms
        }
        // As the sums of a run: of one sign, all digits full, zeros between.
        _ => {
            let low = 900 + random.below(200);
            let mut term = |_| if random.below(5) == 0 { 0.0 } else { random.real(low..low + 40).abs() };
            (0..4 * length).map(&mut term).collect()
        }
    };
    random.shuffle(&mut terms);
    terms
}

fn by_chunks(terms: &[f64], width: Width) -> f64 {
    let mut sum = ExactSum::default();
    terms.chunks(CHUNK).for_each(|chunk| sum.add_chunk(chunk, width));
    sum.value()
}

#[test]
fn twenty_thousand_hard_sums_are_rational_sums_rounded_once_in_any_order() {
    let mut random = Random::new(2);
    let mut wrong_by_plain_addition = 0;
    for (k, mut terms) in hard_sums(20_000).into_iter().enumerate() {
        let value = ExactSum::of(terms.iter().copied()).value();
        assert_rounded_once(value, &terms, &format!("sum {k}"));
        wrong_by_plain_addition += u32::from(terms.iter().sum::<f64>() != value);
        for width in Width::ALL {
            random.shuffle(&mut terms);
            assert_eq!(by_chunks(&terms, width).to_bits(), value.to_bits(), "sum {k}, {width:?}: {terms:?}");
        }
        let cut = random.below(terms.len() + 1);
        let [mut first, second] = [&terms[..cut], &terms[cut..]].map(|part| {
            let mut sum = ExactSum::default();
            sum.add_all(part);
            sum
        });
        first.merge(&second);
        assert_eq!(first.value().to_bits(), value.to_bits(), "sum {k}, cut at {cut}: {terms:?}");
    }
    assert!(wrong_by_plain_addition > 10_000, "they are hard: {wrong_by_plain_addition}");
}

#[test]
fn a_small_term_survives_the_cancellation_of_large_ones() {
    assert_eq!(ExactSum::of([-1e30, -1.1, 1e30]).value(), -1.1);
    assert_eq!(ExactSum::of([f64::MAX, f64::MAX, 5e-324, -f64::MAX, -f64::MAX]).value(), 5e-324);
    assert_eq!(ExactSum::of([0.1; 10]).value(), 1.0);
}

#[test]
fn a_sum_beyond_the_largest_real_is_infinite_and_one_that_rounds_down_to_it_is_not() {
    let half = f64::from_bits((2046 - 53) << 52);
    assert_eq!(ExactSum::of([f64::MAX, half]).value(), f64::INFINITY);
    assert_eq!(ExactSum::of([f64::MAX, half, -5e-324]).value(), f64::MAX);
    assert_eq!(ExactSum::of([-f64::MAX; 1000]).value(), f64::NEG_INFINITY);
}

#[test]
fn what_is_no_number_gives_what_it_gives_in_any_order() {
    let (positive, negative) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut room = vec![1.0; 100];
    let mut with = |terms: &[f64], place: usize| {
        room.fill(1.0);
        room[place..place + terms.len()].copy_from_slice(terms);
        let [one, portable, widest] = Width::ALL.map(|width| by_chunks(&room, width));
        assert!([portable, widest].iter().all(|value| value.to_bits() == one.to_bits()), "{room:?}");
        one
    };
    for place in [0, 50, 97] {
        assert_eq!(with(&[positive, positive], place), positive);
        assert_eq!(with(&[-f64::MAX, positive], place), positive);
        assert_eq!(with(&[negative], place), negative);
        assert!(with(&[positive, negative], place).is_nan());
        assert!(with(&[f64::NAN], place).is_nan());
        assert!(with(&[positive, -f64::NAN], place).is_nan());
    }
    assert_eq!(ExactSum::default().value().to_bits(), 0.0_f64.to_bits());
    assert_eq!(ExactSum::of([-0.0, -0.0]).value().to_bits(), 0.0_f64.to_bits());
}

#[test]
fn digits_that_bear_no_more_terms_are_normalised() {
    let mut sum = ExactSum::default();
    // As if so many terms of the largest digits had come.
    (sum.borne, sum.digit[5]) = (BEARABLE - 1, (i64::from(BEARABLE) - 1) * 0xffff_ffff);
    let before = sum.value();
    sum.add(-1.0);
    assert_eq!(sum.borne, 1);
    assert!(sum.digit.iter().all(|digit| (0..1 << 32).contains(digit)) || sum.value() < 0.0);
    sum.add(1.0);
    assert_eq!(sum.value(), before);
}

#[test]
fn a_tally_of_many_threads_is_the_sum_of_all_terms() {
    let mut random = Random::new(3);
    for count in [0, 1, FEW - 1, FEW, CHUNK, CHUNK + 1, 10 * CHUNK + 77] {
        let terms: Vec<f64> = (0..count).map(|_| random.real(700..1300)).collect();
        let (sums, largest) = tally(count, |k| ([terms[k], -2.0 * terms[k]], terms[k]));
        let expected = ExactSum::of(terms.iter().copied()).value();
        assert_eq!(sums.map(|sum| sum.value()), [expected, ExactSum::of([-2.0 * expected]).value()], "{count}");
        assert_rounded_once(expected, &terms, "tally");
        assert_eq!(largest, terms.iter().copied().fold(0.0, f64::max), "{count}");
    }
}

proptest! {
    #[test]
    fn groups_may_be_merged_in_any_order(
        groups in prop::collection::vec(prop::collection::vec(any::<f64>(), 0..70), 1..8),
        seed in any::<u64>(),
    ) {
        let expected = ExactSum::of(groups.iter().flatten().copied()).value();
        let mut random = Random::new(seed);
        let mut sums: Vec<ExactSum> = groups
            .iter()
            .map(|group| {
                let mut sum = ExactSum::default();
                sum.add_all(group);
                sum
            })
            .collect();
        while sums.len() > 1 {
            random.shuffle(&mut sums);
            let other = sums.pop().expect("there are two");
            sums[0].merge(&other);
        }
        let found = sums[0].value();
        prop_assert!(found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan());
    }
}
