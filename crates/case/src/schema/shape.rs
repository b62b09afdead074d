//! Parts of space.

use super::Axis;
use super::quantity::Positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A part of space. Exactly one of `box`, `ball`, `cylinder`, `ribbed_bar`, `revolution`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Shape {
    /// A block.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub block: Option<Block>,
    /// A ball.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ball: Option<Ball>,
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

impl Shape {
    /// Keys of the shapes.
    pub const KEYS: [&str; 5] = ["box", "ball", "cylinder", "ribbed_bar", "revolution"];

    /// Keys that are given, of which a good case has one.
    #[must_use]
    pub fn given(&self) -> Vec<&'static str> {
        let there = [
            self.block.is_some(),
            self.ball.is_some(),
            self.cylinder.is_some(),
            self.ribbed_bar.is_some(),
            self.revolution.is_some(),
        ];
        Shape::KEYS.into_iter().zip(there).filter_map(|(key, there)| there.then_some(key)).collect()
    }
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

/// A ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Its middle, m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub center: [f64; 3],
    /// Radius, m.
    #[schemars(extend("x-unit" = "m"))]
    pub radius: Positive,
}

/// A round bar, infinite unless `from` and `to` end it.
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
    /// Where it begins, counted along the axis from `through`, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub from: Option<f64>,
    /// Where it ends, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub to: Option<f64>,
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
