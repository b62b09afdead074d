//! Zones of space that change the particles in them.

use super::particles::{Component, Force, Prescribed};
use super::shape::Shape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Changes particles whose centres lie in a part of space: what they are made of, how they move, what pulls them. Zones act
/// one after the other, in the order of the file. Exactly one of `box`, `ball`, `cylinder`, `ribbed_bar`, `revolution` is
/// its shape.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
// Unknown keys are found by the schema: `serde` cannot refuse them beside a flattened field.
#[serde(default)]
#[schemars(extend("additionalProperties" = false))]
pub struct Zone {
    /// Its name in messages and for gauges.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Only particles of this material are changed; all if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<String>,
    /// What they are made of from now on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Components that do not move, besides those of the group: "x", "y", "z", "rx", "ry", "rz".
    pub fixed: Vec<Component>,
    /// Components that move at a given rate, m/s or rad/s, such as { y = 0.1 }, or along a ramp, such as
    /// { y = [[0.0, 0.0], [1.0e-3, 0.1]] }. Two tables must not prescribe different motion for one particle.
    #[serde(skip_serializing_if = "Prescribed::is_empty")]
    pub prescribed: Prescribed,
    /// Force that is applied to the zone, N, such as { y = 1000.0 }, or along a ramp. Its particles share it equally, and
    /// keep their parts wherever they move; forces of several zones add up.
    #[serde(skip_serializing_if = "Force::is_empty")]
    pub force: Force,
    /// Where it is.
    #[serde(flatten)]
    pub shape: Shape,
}
