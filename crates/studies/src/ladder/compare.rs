//! Two rungs at equal times of the heat.

use tdem_engine::ExactSum;

/// What is kept of a rung.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    /// Steps of the instants.
    pub(super) targets: Vec<u64>,
    /// One for each instant.
    pub(super) samples: Vec<Sample>,
    /// In which step each bond broke, `(bonds)`; `None` if it holds at the last instant.
    pub(super) breaks: Vec<Option<u64>>,
}

/// What is kept of an instant; particles by id, ascending.
#[derive(Clone, Debug, Default)]
pub(super) struct Sample {
    /// K, `(N)`.
    pub(super) temperature: Vec<f64>,
    /// Mean of the three normal stresses, Pa, `(N)`.
    pub(super) stress: Vec<f64>,
    /// `None` where nothing is deformed.
    pub(super) kinetic_over_elastic: Option<f64>,
}

/// A rung against the next, with half its time scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// One for each instant, in the order of time.
    pub differences: Vec<Difference>,
}

/// How far two rungs differ at one time of the heat. The first of two is the coarser rung.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// s.
    pub heat_time: f64,
    /// Of temperatures of particles, K.
    pub temperature: Spread,
    /// Of mean stresses of particles, Pa.
    pub stress: Spread,
    /// Root mean square of the mean stresses of the finer rung, Pa: what differences are to be compared with.
    pub stress_size: f64,
    /// Bonds that are broken on each rung.
    pub broken: [u64; 2],
    /// Bonds that are broken on one and not on the other.
    pub broken_in_one: u64,
    /// Kinetic over elastic energy on each rung; `None` where nothing is deformed. In slow motion it is small.
    pub kinetic_over_elastic: [Option<f64>; 2],
}

/// Differences of all particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Root mean square.
    pub rms: f64,
    /// The largest, positive.
    pub largest: f64,
}

impl Spread {
    fn of(differences: impl ExactSizeIterator<Item = f64>) -> Self {
        let count = differences.len().max(1) as f64;
        let (mut sum, mut largest) = (ExactSum::default(), 0.0_f64);
        for difference in differences {
            sum.add(difference * difference);
            largest = largest.max(difference.abs());
        }
        Spread { rms: (sum.value() / count).sqrt(), largest }
    }
    fn between(a: &[f64], b: &[f64]) -> Self {
        Spread::of(a.iter().zip(b).map(|(a, b)| a - b))
    }
}

impl Difference {
    /// How far the numbers of broken bonds differ, over that of the finer rung; `None` if nothing is broken there.
    #[must_use]
    pub fn broken_part(&self) -> Option<f64> {
        let [coarse, fine] = self.broken;
        (fine > 0).then(|| coarse.abs_diff(fine) as f64 / fine as f64)
    }
}

impl Pair {
    /// Compares two rungs of the same particles and bonds at the same instants, s, as far as both got.
    pub(super) fn of(coarse: &Track, fine: &Track, instants: &[f64]) -> Self {
        let at = |(index, &heat_time): (usize, &f64)| {
            let (a, b) = (&coarse.samples[index], &fine.samples[index]);
            let by = [coarse.targets[index], fine.targets[index]];
            let (mut broken, mut broken_in_one) = ([0, 0], 0);
            for (first, second) in coarse.breaks.iter().zip(&fine.breaks) {
                let [first, second] = [(first, by[0]), (second, by[1])].map(|(at, by)| at.is_some_and(|at| at <= by));
                broken[0] += u64::from(first);
                broken[1] += u64::from(second);
                broken_in_one += u64::from(first != second);
            }
            Difference {
                heat_time,
                temperature: Spread::between(&a.temperature, &b.temperature),
                stress: Spread::between(&a.stress, &b.stress),
                stress_size: Spread::of(b.stress.iter().copied()).rms,
                broken,
                broken_in_one,
                kinetic_over_elastic: [a.kinetic_over_elastic, b.kinetic_over_elastic],
            }
        };
        let both = coarse.samples.len().min(fine.samples.len());
        Pair { differences: instants.iter().enumerate().take(both).map(at).collect() }
    }

    /// The first instant at which a bond is broken on one rung and not on the other, s of heat; `None` if there is none.
    #[must_use]
    pub fn parted(&self) -> Option<f64> {
        self.differences.iter().find(|difference| difference.broken_in_one > 0).map(|difference| difference.heat_time)
    }

    /// The instant at which something is largest, the first of several.
    #[must_use]
    pub fn worst(&self, what: impl Fn(&Difference) -> f64) -> Option<&Difference> {
        self.differences.iter().reduce(|worst, other| if what(other) > what(worst) { other } else { worst })
    }

    /// The observed order of convergence of something at an instant, from the pair of rungs before and this one:
    /// $\log_2(d_{k-1}/d_k)$; `None` where either difference is zero, or there is no such instant.
    #[must_use]
    pub fn order(&self, before: &Pair, instant: usize, what: impl Fn(&Difference) -> f64) -> Option<f64> {
        let [before, now] = [before, self].map(|pair| pair.differences.get(instant).map(&what).filter(|&d| d > 0.0));
        Some(libm::log2(before? / now?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(targets: [u64; 2], temperature: [f64; 2], breaks: [Option<u64>; 3]) -> Track {
        let sample = |warmth: f64| Sample {
            temperature: temperature.map(|t| t + warmth).to_vec(),
            stress: temperature.map(|t| 10.0 * t).to_vec(),
            kinetic_over_elastic: None,
        };
        Track { targets: targets.into(), samples: vec![sample(0.0), sample(1.0)], breaks: breaks.into() }
    }

    #[test]
    fn differences_are_those_that_can_be_counted_by_hand() {
        // Bonds: one breaks on both at once, one later on the finer rung, one only on the coarser.
        let coarse = track([5, 10], [300.0, 304.0], [Some(5), Some(4), Some(10)]);
        let fine = track([10, 20], [300.0, 301.0], [Some(10), Some(11), None]);
        let pair = Pair::of(&coarse, &fine, &[0.5, 1.0]);
        let [first, last] = &pair.differences[..] else { panic!("there are two instants") };
        assert_eq!(first.temperature, Spread { rms: 4.5_f64.sqrt(), largest: 3.0 });
        assert_eq!(first.stress, Spread { rms: 450.0_f64.sqrt(), largest: 30.0 });
        assert_eq!(first.stress_size, (0.5 * (3000.0 * 3000.0 + 3010.0 * 3010.0_f64)).sqrt());
        assert_eq!((first.broken, first.broken_in_one, first.broken_part()), ([2, 1], 1, Some(1.0)));
        assert_eq!((last.broken, last.broken_in_one, last.broken_part()), ([3, 2], 1, Some(0.5)));
        assert_eq!(pair.parted(), Some(0.5));
        assert_eq!(pair.worst(|d| d.temperature.rms).map(|d| d.heat_time), Some(0.5));
        let started = Track { samples: fine.samples[..1].into(), ..fine.clone() };
        assert_eq!(Pair::of(&coarse, &started, &[0.5, 1.0]).differences[..], pair.differences[..1]);
        let none = Pair::of(&fine, &fine, &[0.5, 1.0]);
        assert_eq!((none.parted(), none.differences[1].broken_in_one), (None, 0));
    }

    #[test]
    fn a_difference_that_halves_is_of_first_order() {
        let at = |warmth: f64| track([1, 2], [300.0 + warmth, 300.0 - warmth], [None; 3]);
        let before = Pair::of(&at(4.0), &at(2.0), &[0.5, 1.0]);
        let after = Pair::of(&at(2.0), &at(1.0), &[0.5, 1.0]);
        assert_eq!(after.order(&before, 0, |d| d.temperature.largest), Some(1.0));
        let same = Pair::of(&at(1.0), &at(1.0), &[0.5, 1.0]);
        assert_eq!(same.order(&after, 0, |d| d.temperature.largest), None);
        assert_eq!(after.order(&before, 2, |d| d.temperature.largest), None);
    }
}
