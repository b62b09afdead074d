//! Values that change with time.

use super::quantity::{Positive, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value that may change with time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Course {
    /// Always the same.
    Constant(f64),
    /// Straight between points [time in s, value], times ascending; constant before the first and behind the last.
    Points(#[schemars(length(min = 1))] Vec<[f64; 2]>),
    /// Read from a table in a file, and from then on like points.
    Measured(Measured),
}

/// Two columns of a table in a file: what was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// The file, relative to the case. Its first line names the columns. Lines that begin with # are skipped.
    pub file: String,
    /// Name of the column of times, s.
    pub time: String,
    /// Name of the column of values.
    pub value: String,
    /// Multiplies times: 60.0 if they are in minutes, 3600.0 if in hours.
    #[serde(default = "one")]
    pub time_factor: Positive,
}

const fn one() -> Positive {
    positive(1.0)
}

impl Course {
    /// Its points; one if it is constant.
    #[must_use]
    pub fn points(&self) -> Vec<[f64; 2]> {
        match self {
            Course::Constant(value) => vec![[0.0, *value]],
            // Files are read when the case is loaded.
            Course::Measured(_) => Vec::new(),
            Course::Points(points) => match points.as_slice() {
                [first, others @ ..] if others.iter().all(|point| point[1] == first[1]) => vec![*first],
                points => points.to_vec(),
            },
        }
    }
    /// The value at a time, s.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        let (constraint, drives, axis) = (0, tdem_engine::Driven::Force, 0);
        tdem_engine::Ramp { constraint, drives, axis, points: self.points() }.value(time)
    }
    /// One of so many equal parts.
    #[must_use]
    pub fn shared(&self, parts: usize) -> Course {
        let parts = parts as f64;
        match self {
            Course::Constant(value) => Course::Constant(value / parts),
            Course::Measured(_) => self.clone(),
            Course::Points(points) => {
                Course::Points(points.iter().map(|[time, value]| [*time, value / parts]).collect())
            }
        }
    }
    /// Whether it always has the same value as another.
    #[must_use]
    pub fn is_like(&self, other: &Course) -> bool {
        let (mine, others) = (self.points(), other.points());
        mine == others || mine.len() == 1 && others.len() == 1 && mine[0][1] == others[0][1]
    }
}
