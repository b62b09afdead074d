//! Properties that may depend on temperature.

use super::quantity::NonNegative;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tdem_engine::Table;

/// A property that may depend on temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Property {
    /// The same at any temperature.
    Constant(NonNegative),
    /// Straight between points [temperature in °C or K, value], temperatures ascending; constant below the first and above
    /// the last.
    Points(#[schemars(length(min = 1))] Vec<[f64; 2]>),
    /// Read from a table in a file, and from then on like points.
    Measured(MeasuredProperty),
}

/// Two columns of a table in a file: a property that was measured over temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredProperty {
    /// The file, relative to the case. Its first line names the columns. Lines that begin with # are skipped.
    pub file: String,
    /// Name of the column of temperatures, °C or K.
    pub temperature: String,
    /// Name of the column of values.
    pub value: String,
}

impl Property {
    /// Its table in kelvin: `zero` is added to temperatures. One point where it is the same at all temperatures.
    #[must_use]
    pub fn table(&self, zero: f64) -> Table {
        match self {
            Property::Constant(value) => Table::constant(value.get()),
            // Files are read when the case is loaded.
            Property::Measured(_) => Table(Vec::new()),
            Property::Points(points) => {
                let all = points.iter().map(|&[temperature, value]| [temperature + zero, value]);
                let same = points.iter().all(|point| point[1] == points[0][1]);
                Table(all.take(if same { 1 } else { points.len() }).collect())
            }
        }
    }
}
