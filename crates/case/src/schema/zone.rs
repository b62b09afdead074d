//! Zones of space that change the particles in them.

use super::particles::{Component, Prescribed};
use super::shape::Shape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Changes particles whose centres lie in a part of space: what they are made of, how they move. Zones act one after the
/// other, in the order of the file. Exactly one of `box`, `ball`, `cylinder`, `ribbed_bar`, `revolution` is its shape.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
// Unknown keys are found by the schema: `serde` cannot refuse them beside a flattened field.
#[serde(default)]
#[schemars(extend("additionalProperties" = false))]
pub struct Zone {
    /// Its name in messages.
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
    /// Components that move at a given rate, m/s or rad/s, such as { y = 0.1 }.
    #[serde(skip_serializing_if = "Prescribed::is_empty")]
    pub prescribed: Prescribed,
    /// Where it is.
    #[serde(flatten)]
    pub shape: Shape,
}
