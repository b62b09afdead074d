//! Axes: round ticks, their labels, extents, and prefixes of units.

use crate::words::parted;
use std::ops::Range;

/// Round values along an axis, 1, 2 or 5 times a power of ten apart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) values: Vec<f64>,
    step: f64,
    /// Digits behind the point; none where powers of ten are easier to read.
    decimals: Option<usize>,
}

impl Ticks {
    /// About so many between two values; none where there is no way between them.
    pub(crate) fn between(low: f64, high: f64, count: usize) -> Self {
        let rough = (high - low) / count as f64;
        if !(rough > 0.0 && rough.is_finite() && low.is_finite()) {
            return Ticks { values: Vec::new(), step: 0.0, decimals: Some(0) };
        }
        let exponent = rough.log10().floor();
        let power = format!("1e{exponent}").parse::<f64>().unwrap_or(1.0);
        let (factor, carry) =
            [(1.0, 0.0), (2.0, 0.0), (5.0, 0.0)].into_iter().find(|(f, _)| f * power >= rough).unwrap_or((10.0, 1.0));
        let step = factor * power;
        let first = (low / step).ceil();
        let values = (0..=2 * count).map(|k| (first + k as f64) * step).take_while(|value| *value <= high).collect();
        let plain = low.abs().max(high.abs()) < 1e6 && exponent >= -4.0;
        let decimals = plain.then(|| (-(exponent + carry)).max(0.0) as usize);
        Ticks { values, step, decimals }
    }

    /// The text beside a tick: as many digits as tell it from its neighbours, thousands set apart.
    pub(crate) fn label(&self, value: f64) -> String {
        // A multiple of the step that is far less than it is 0 that was not met.
        if value.abs() < 1e-6 * self.step {
            return "0".to_owned();
        }
        if let Some(decimals) = self.decimals {
            parted(&format!("{value:.decimals$}"))
        } else {
            let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
            format!("{rounded:e}")
        }
    }
}

/// From the lowest to the highest value and a little more.
pub(crate) fn extent(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let width = high - low;
    let margin = if width > 0.0 { 0.04 * width } else { 0.5 * high.abs().max(1.0) };
    low - margin..high + margin
}

/// The prefix of a unit that leaves the fewest zeros, and its size.
pub(crate) fn prefix(largest: f64) -> (&'static str, f64) {
    let prefixes = [("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("\u{b5}", 1e-6), ("n", 1e-9)];
    prefixes.into_iter().find(|(_, size)| largest >= *size).unwrap_or(("", 1.0))
}

/// The unit of times that is easiest to read, and its seconds.
pub(crate) fn unit_of_time(longest: f64) -> (&'static str, f64) {
    const UNITS: [(&str, f64, f64); 5] =
        [("h", 3600.0, 7200.0), ("min", 60.0, 300.0), ("s", 1.0, 0.5), ("ms", 1e-3, 5e-4), ("\u{b5}s", 1e-6, 0.0)];
    let fitting = UNITS.into_iter().find(|(_, _, from)| longest >= *from);
    fitting.map_or(("s", 1.0), |(unit, size, _)| (unit, size))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, count: usize) -> Vec<String> {
        let ticks = Ticks::between(low, high, count);
        ticks.values.iter().map(|value| ticks.label(*value)).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(Ticks::between(-0.4, 10.3, 5).values, [0.0, 5.0, 10.0]);
        assert_eq!(Ticks::between(0.0, 0.0, 5).values, Vec::<f64>::new());
        assert_eq!(Ticks::between(f64::INFINITY, f64::NEG_INFINITY, 5).values, Vec::<f64>::new());
        let many = Ticks::between(293.1, 1173.2, 5).values;
        assert_eq!((many[0], many.len()), (400.0, 4));
    }

    #[test]
    fn labels_have_the_same_digits_along_an_axis() {
        assert_eq!(labels(0.0, 1.0, 5), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-1250.0, 900.0, 4), ["-1,000", "0"]);
        assert_eq!(labels(20.0, 900.0, 5), ["200", "400", "600", "800"]);
        assert_eq!(labels(0.0, 9.7, 1), ["0"]);
        assert_eq!(labels(1e-7, 4e-7, 4), ["1e-7", "2e-7", "3e-7", "4e-7"]);
        assert_eq!(labels(0.0, 3e9, 3), ["0", "1e9", "2e9", "3e9"]);
    }

    #[test]
    fn units_have_the_prefix_and_times_the_unit_of_their_size() {
        assert_eq!([3e4, 0.5, 2e-5, 0.0].map(|largest| prefix(largest).0), ["k", "m", "\u{b5}", ""]);
        assert_eq!(
            [20_280.0, 600.0, 2.0, 3e-3, 1e-5, 0.0].map(|t| unit_of_time(t).0),
            ["h", "min", "s", "ms", "\u{b5}s", "\u{b5}s"]
        );
    }
}
