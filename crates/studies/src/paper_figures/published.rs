//! What the paper prints, from `published.toml`.

use super::Model;
use serde::{Deserialize, Serialize};

/// The paper, and the numbers that it prints about performance.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Its title.
    pub title: String,
    /// Who wrote it.
    pub authors: String,
    /// Where and when it appeared.
    pub published_in: String,
    /// The GPU it was measured on.
    pub gpu: String,
    /// The processors.
    pub cpu: String,
    /// The numbers, in the order of figures.
    #[serde(rename = "value")]
    pub values: Vec<Value>,
}

/// One number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Value {
    /// What it is.
    pub quantity: Quantity,
    /// Of which model; `None` is of all.
    pub model: Option<Model>,
    /// On which device, where that matters.
    pub device: Option<On>,
    /// The number,
    pub value: Option<f64>,
    /// or what it lies between.
    pub range: Option<[f64; 2]>,
    /// 1 for a pure number.
    pub unit: String,
    /// What stands in the paper.
    pub printed: String,
    /// How the number follows from it, where that is more than reading.
    pub derived: Option<String>,
    /// Where in the paper.
    pub place: String,
}

/// A device of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum On {
    /// The P100.
    Gpu,
    /// The two Xeons.
    Cpu,
}

/// What a published number is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Nominal bandwidth, B/s.
    Bandwidth,
    /// Cores of the processors.
    Cores,
    /// Memory, B.
    MemoryAtMost,
    /// Memory over that of GN.
    MemoryOverGn,
    /// Part of the time that integration takes.
    ShareIntegration,
    /// Search.
    ShareSearch,
    /// Contact history.
    ShareHistory,
    /// Contact forces.
    ShareContact,
    /// Bonds.
    ShareBonds,
    /// Gravity and boundary conditions.
    ShareExternal,
    /// Time of contact forces over that of GN.
    ContactTimeOverGn,
    /// Over that of GNT.
    ContactTimeOverGnt,
    /// Particle-steps per second.
    Cundall,
    /// How many times faster the GPU is.
    SpeedUp,
    /// The largest.
    SpeedUpAtMost,
    /// Time of a step over that of GN.
    TimeOverGn,
    /// Operations of a contact.
    OperationsOfContact,
    /// Contacts of a particle.
    ContactsAtMost,
    /// Bytes of a particle's contacts.
    BytesOfContacts,
    /// Operations of a bond.
    OperationsOfBond,
    /// Bytes of a bond.
    BytesOfBond,
}

impl Published {
    /// The paper's numbers.
    ///
    /// # Panics
    /// If the file of this program is not what a test found it to be.
    #[must_use]
    pub fn read() -> Self {
        toml::from_str(include_str!("published.toml")).expect("a test reads the file")
    }
    /// A number of a model, or of all, on a device of the paper or without one.
    #[must_use]
    pub fn value(&self, quantity: Quantity, model: Option<Model>, device: Option<On>) -> Option<f64> {
        self.find(quantity, model, device)?.value
    }
    /// The entry of such a number.
    #[must_use]
    pub fn find(&self, quantity: Quantity, model: Option<Model>, device: Option<On>) -> Option<&Value> {
        let same = |value: &&Value| value.quantity == quantity && value.model == model && value.device == device;
        self.values.iter().find(same)
    }
    /// A number that the paper prints once, for all models.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn constant(&self, quantity: Quantity) -> f64 {
        let found = self.values.iter().find(|value| value.quantity == quantity).and_then(|value| value.value);
        found.expect("the paper prints it")
    }
}

#[cfg(test)]
mod tests {
    use super::Quantity as Q;
    use super::*;
    use Model::{BPM, GN, GNT, GNTM, TBPM};

    #[test]
    fn numbers_are_those_of_the_paper() {
        let published = Published::read();
        let value = |quantity, model, device| {
            let entry: &Value =
                published.find(quantity, model, device).unwrap_or_else(|| panic!("{quantity:?} {model:?}"));
            (entry.value, entry.range)
        };
        let gpu = Some(On::Gpu);
        let expected = [
            (Q::Bandwidth, None, gpu, 549e9),
            (Q::Cores, None, Some(On::Cpu), 20.0),
            (Q::MemoryOverGn, Some(GNT), None, 2.4),
            (Q::MemoryOverGn, Some(GNTM), None, 2.4 * 1.13),
            (Q::MemoryOverGn, Some(BPM), None, 5.4 - 0.338),
            (Q::MemoryOverGn, Some(TBPM), None, 5.4),
            (Q::ShareIntegration, Some(GN), None, 0.107),
            (Q::ShareIntegration, Some(TBPM), None, 0.048),
            (Q::ShareSearch, Some(GN), None, 0.689),
            (Q::ShareSearch, Some(TBPM), None, 0.263),
            (Q::ContactTimeOverGn, Some(GNT), None, 2.0),
            (Q::ContactTimeOverGnt, Some(GNTM), None, 1.245),
            (Q::ShareBonds, Some(BPM), None, 0.224),
            (Q::ShareBonds, Some(TBPM), None, 0.262),
            (Q::Cundall, Some(GN), gpu, 4.45e7),
            (Q::Cundall, Some(GNTM), gpu, 2.83e7),
            (Q::Cundall, Some(BPM), gpu, 1.84e7),
            (Q::Cundall, Some(TBPM), gpu, 1.62e7),
            (Q::SpeedUpAtMost, Some(BPM), None, 7.4),
            (Q::SpeedUpAtMost, Some(TBPM), None, 7.4),
            (Q::TimeOverGn, Some(GN), gpu, 1.0),
            (Q::TimeOverGn, Some(GNT), gpu, 1.405),
            (Q::TimeOverGn, Some(GNTM), gpu, 1.526),
            (Q::TimeOverGn, Some(BPM), gpu, 2.336),
            (Q::TimeOverGn, Some(TBPM), gpu, 2.645),
            (Q::TimeOverGn, Some(GNTM), Some(On::Cpu), 1.624),
            (Q::TimeOverGn, Some(TBPM), Some(On::Cpu), 2.805),
            (Q::OperationsOfContact, None, None, 15.0 + 57.0 + 110.0 + 107.0),
            (Q::BytesOfContacts, None, None, 2256.0),
            (Q::ContactsAtMost, None, None, 12.0),
            (Q::OperationsOfBond, None, None, 24.0 + 65.0 + 156.0 + 32.0),
            (Q::BytesOfBond, None, None, 504.0),
        ];
        for (quantity, model, device, expected) in expected {
            let (found, range) = value(quantity, model, device);
            assert!(
                range.is_none() && (found.expect("a number") / expected - 1.0).abs() < 1e-12,
                "{quantity:?} {model:?}"
            );
        }
        let ranges = [
            (Q::ShareHistory, None, [0.086, 0.16]),
            (Q::ShareContact, None, [0.18, 0.319]),
            (Q::ShareExternal, None, [0.015, 0.028]),
            (Q::SpeedUp, Some(GNTM), [3.0, 7.2]),
        ];
        for (quantity, model, expected) in ranges {
            assert_eq!(value(quantity, model, None), (None, Some(expected)), "{quantity:?}");
        }
    }

    #[test]
    fn every_number_is_one_or_a_range_and_stands_there_once() {
        let published = Published::read();
        for (k, value) in published.values.iter().enumerate() {
            assert!(value.value.is_some() != value.range.is_some(), "{value:?}");
            let same = published.values[..k].iter();
            let twice = same.filter(|o| (o.quantity, o.model, o.device) == (value.quantity, value.model, value.device));
            assert_eq!(twice.count(), 0, "{value:?}");
        }
    }
}
