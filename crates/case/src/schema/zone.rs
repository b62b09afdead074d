//! Zones of space that change the particles in them.

use super::Axis;
use super::particles::{Component, Force, Prescribed};
use super::quantity::Positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Changes particles whose centres lie in a part of space: what they are made of, how they move, what pulls them. Zones act one after the
/// other, in the order of the file. Exactly one of `box`, `cylinder`, `ribbed_bar`, `revolution` is its shape.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
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
    /// A block.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub block: Option<Block>,
    /// A round bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<Cylinder>,
    /// A reinforcing bar with ribs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ribbed_bar: Option<RibbedBar>,
    /// A body of revolution.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revolution: Option<Revolution>,
}

/// A block of space, its faces included.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Block {
    /// Lower corner, m; the domain's if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub min: Option<[f64; 3]>,
    /// Upper corner, m; the domain's if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub max: Option<[f64; 3]>,
}

/// An infinite round bar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Direction of its axis.
    pub axis: Axis,
    /// A point of its axis, m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub through: [f64; 3],
    /// Radius, m.
    #[schemars(extend("x-unit" = "m"))]
    pub radius: Positive,
}

/// An infinite bar with trapezoidal ribs around it. The first rib is half a spacing beyond `through`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RibbedBar {
    /// Direction of its axis.
    pub axis: Axis,
    /// A point of its axis in the middle between two ribs, m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub through: [f64; 3],
    /// Radius between ribs, m.
    #[schemars(extend("x-unit" = "m"))]
    pub radius: Positive,
    /// Height of the ribs, m.
    #[schemars(extend("x-unit" = "m"))]
    pub rib_height: Positive,
    /// Width of the ribs at their crests, m.
    #[schemars(extend("x-unit" = "m"))]
    pub rib_width: Positive,
    /// Distance from one rib to the next, m.
    #[schemars(extend("x-unit" = "m"))]
    pub rib_spacing: Positive,
    /// Slope of their flanks, degrees; 90.0 is upright.
    #[schemars(range(max = 90.0))]
    pub flank_angle_deg: Positive,
}

/// What a line of straight pieces leaves when it is turned about an axis. It ends with the line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Revolution {
    /// Direction of its axis.
    pub axis: Axis,
    /// Where the line's first coordinate is 0, m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub through: [f64; 3],
    /// Points of the line: coordinate along the axis, ascending, and radius, m.
    #[schemars(length(min = 2))]
    #[schemars(extend("x-unit" = "m"))]
    pub profile: Vec<[f64; 2]>,
}
