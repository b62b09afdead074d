//! Tables over temperature: what a plan says of properties that depend on it.

use crate::plan::{Piece, piece, pieces, value_at};
use tdem_physics::heat::table::{heat_along, rise, slope};

/// A property over temperature: points of temperature, K, and value; straight between them, constant below the first and
/// above the last. Temperatures ascend strictly.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(pub Vec<[f64; 2]>);

impl Table {
    /// The same at any temperature.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Table(vec![[0.0, value]])
    }
    /// With all values divided by a number.
    #[must_use]
    pub fn divided_by(&self, divisor: f64) -> Self {
        Table(self.0.iter().map(|&[temperature, value]| [temperature, value / divisor]).collect())
    }
    /// The value at a temperature, K.
    #[must_use]
    pub fn value(&self, temperature: f64) -> f64 {
        value_at(&self.0, temperature)
    }
    /// By how much the value changes per kelvin at a temperature.
    #[must_use]
    pub fn slope(&self, temperature: f64) -> f64 {
        let Piece { start, end, .. } = self.piece(self.piece_of(temperature));
        slope(start, end)
    }
    /// The largest value.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.0.iter().map(|point| point[1]).fold(f64::NEG_INFINITY, f64::max)
    }
    /// The least value.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.0.iter().map(|point| point[1]).fold(f64::INFINITY, f64::min)
    }

    /// $\int c\,dT$ of a specific heat from one temperature to another, K: heat per mass, J/kg.
    #[must_use]
    pub fn heat_between(&self, from: f64, to: f64) -> f64 {
        if to < from {
            return -self.heat_between(to, from);
        }
        let (mut place, mut heat) = (from, 0.0);
        for k in self.piece_of(from)..=self.0.len() {
            let Piece { until, start, end, .. } = self.piece(k);
            if to < until {
                return heat + heat_along(start, end, place, to);
            }
            heat += heat_along(start, end, place, until);
            place = until;
        }
        f64::NAN
    }

    /// The temperature of a body of this specific heat that was at another, K, and took in heat per mass, J/kg, negative if
    /// it gave heat away: from piece to piece, within each by [`rise`].
    #[must_use]
    pub fn warmed(&self, temperature: f64, heat: f64) -> f64 {
        let (mut place, mut left) = (temperature, heat);
        let mut k = self.piece_of(temperature);
        loop {
            let Piece { from, until, start, end } = self.piece(k);
            let bound = if left > 0.0 { until } else { from };
            if bound.is_finite() {
                let room = heat_along(start, end, place, bound);
                if left.abs() > room.abs() {
                    left -= room;
                    place = bound;
                    k = if left > 0.0 { k + 1 } else { k - 1 };
                    continue;
                }
            }
            return place + rise(start, end, place, left);
        }
    }

    /// The piece that holds at a temperature: 0 below the first point.
    fn piece_of(&self, temperature: f64) -> usize {
        self.0.partition_point(|point| point[0] <= temperature)
    }
    fn piece(&self, k: usize) -> Piece {
        piece(&self.0, k)
    }
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Piece> {
        pieces(&self.0)
    }

    /// Whether it says something, in the order of temperature, and no value is below this.
    pub(crate) fn is_sound(&self, holds: impl Fn(f64) -> bool) -> bool {
        !self.0.is_empty()
            && self.0.iter().all(|&[temperature, value]| temperature.is_finite() && value.is_finite() && holds(value))
            && self.0.is_sorted_by(|a, b| a[0] < b[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak() -> Table {
        Table(vec![[300.0, 900.0], [370.0, 1000.0], [375.0, 9000.0], [380.0, 1000.0], [500.0, 1200.0]])
    }

    #[test]
    fn heat_is_the_area_below_the_table() {
        let table = peak();
        let expected = 900.0 * 50.0 + 950.0 * 70.0 + 5000.0 * 5.0 + 5000.0 * 5.0 + 1100.0 * 120.0 + 1200.0 * 10.0;
        assert!((table.heat_between(250.0, 510.0) / expected - 1.0).abs() < 1e-15);
        assert_eq!(table.heat_between(510.0, 250.0), -table.heat_between(250.0, 510.0));
        assert_eq!(table.heat_between(320.0, 320.0), 0.0);
        assert_eq!(table.heat_between(375.0, 375.0), 0.0);
        assert_eq!(table.heat_between(100.0, 200.0), 9e4);
    }

    #[test]
    fn what_is_taken_in_is_there() {
        let table = peak();
        for from in [200.0, 300.0, 333.3, 374.9, 375.0, 375.1, 500.0, 700.0] {
            for to in [150.0, 299.9, 300.0, 371.0, 375.0, 380.0, 499.0, 500.0, 900.0] {
                let found = table.warmed(from, table.heat_between(from, to));
                assert!((found - to).abs() < 1e-12 * 900.0, "from {from} to {to}: {found}");
            }
            assert_eq!(table.warmed(from, 0.0).to_bits(), f64::to_bits(from));
        }
        assert!(table.warmed(300.0, f64::NAN).is_nan());
        assert!(table.warmed(310.0, -1e9) < 0.0, "a fault that is found");
    }

    #[test]
    fn a_constant_is_what_a_number_is() {
        let table = Table::constant(901.3);
        assert_eq!(table.value(1e4).to_bits(), 901.3_f64.to_bits());
        assert_eq!(table.warmed(300.0, 77.7).to_bits(), (300.0 + 77.7 / 901.3_f64).to_bits());
        assert_eq!((table.least(), table.largest()), (901.3, 901.3));
    }
}
