//! What is watched during a run, and what is drawn of it at the end.

use super::course::Course;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Watches particles and adds columns to `history.csv`. Give `of`, `between` or `surface`; the first two name a group of particles or a zone
/// by its `name`. A zone stands for the particles that it found at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gauge {
    /// Its name, with which its columns begin: letters, digits, `_` and `-`.
    pub name: String,
    /// Adds the force on these particles, N, and their mean displacement, m: NAME_force_x to _z, NAME_displacement_x to
    /// _z; with heat also their mean temperature, K, NAME_temperature. Of particles that are held or driven, it is the force of all others on them, and the support exerts the
    /// opposite.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Adds how much farther these two are apart than at the start, m, along the line that joined their means then, and
    /// that over their first distance: NAME_elongation, NAME_strain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub between: Option<[String; 2]>,
    /// Adds the mean temperature of a `[[surface]]`, K, and the heat that enters through it, W: NAME_temperature,
    /// NAME_heat_rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<String>,
}

/// A curve that is drawn at the end of the run: `curve-NAME.svg` in its directory. Its axes are columns of `history.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Its name: letters, digits, `_` and `-`.
    pub name: String,
    /// Column along the horizontal axis, such as "time" or "grip_displacement_y".
    pub x: String,
    /// Column along the vertical axis.
    pub y: String,
    /// Multiplies the horizontal column: -1.0 turns it round, 1.0e3 makes mm of m.
    #[serde(default = "one")]
    pub x_factor: f64,
    /// Multiplies the vertical column.
    #[serde(default = "one")]
    pub y_factor: f64,
    /// Is added to the horizontal column then.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub x_offset: f64,
    /// Is added to the vertical column then: -273.15 makes °C of K.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub y_offset: f64,
    /// Title of the horizontal axis, unit included; the column and its unit if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_title: Option<String>,
    /// Title of the vertical axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_title: Option<String>,
    /// Other values that are drawn beside it, dashed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub against: Vec<Against>,
}

/// Values that a curve is drawn against: measured ones, or those of a formula.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Against {
    /// What they are, for the key of the picture.
    pub name: String,
    /// Points [horizontal, vertical] in the units of the axes, or two columns of a table in a file, of which `time` is the
    /// horizontal one.
    pub values: Course,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

const fn one() -> f64 {
    1.0
}
