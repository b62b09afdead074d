//! Heat: what conducts, what surfaces exchange, how time goes.

use super::course::Course;
use super::quantity::{Fraction, NonNegative, Positive};
use super::{Case, Face};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Zero of the scale of Celsius, K.
const CELSIUS: f64 = 273.15;

/// Heat: particles have temperatures, conduct, and expand. Without this table nothing does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Heat {
    /// Scale of all temperatures in the case: "celsius" or "kelvin". Results are in kelvin.
    pub scale: Scale,
    /// Temperature of all particles at the start.
    #[schemars(extend("x-unit" = "°C or K"))]
    pub initial_temperature: f64,
    /// Temperature at which radii are those given, and at which bonds are free of stress; the initial one if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "°C or K"))]
    pub reference_temperature: Option<f64>,
    /// How heat goes through contacts: along a "bar" between the centres (the paper's), through the "circle" of the
    /// contact, or not at all, "closed". Bonds conduct along a bar, and a contact beside a bond conducts nothing.
    pub contacts: ContactPath,
    /// Radius of the bar over the mean radius of the two particles; or "fcc", with which spheres on that lattice conduct
    /// like the solid.
    pub bar_radius: BarRadius,
    /// Cells of a block with open sides across the way of the heat, such as [28, 28]: with "fcc", conductances are raised
    /// by the part that is missing at the sides, 1/(4 n) for each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub open_sides: Option<[u32; 2]>,
    /// How much faster the time of the heat goes than that of the motion; 1.0 if left out. Give this or `duration`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_scale: Option<Positive>,
    /// How long the heat goes on, s, while the motion goes on until `time.end`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "s"))]
    pub duration: Option<Positive>,
}

impl Heat {
    /// Time of the heat over time of the motion.
    #[must_use]
    pub fn time_scale(&self, case: &Case) -> f64 {
        match (self.time_scale, self.duration) {
            (Some(scale), _) => scale.get(),
            (None, Some(duration)) => duration.get() / case.time.end.get(),
            (None, None) => 1.0,
        }
    }
    /// Radius of the bar over the mean radius of two particles.
    #[must_use]
    pub fn bar_radius(&self) -> f64 {
        match self.bar_radius {
            BarRadius::Ratio(ratio) => ratio.get(),
            BarRadius::FaceCentred => tdem_engine::physics::heat::conduction::face_centred_bar(self.open_sides),
        }
    }
}

/// A scale of temperatures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// °C.
    Celsius,
    /// K.
    Kelvin,
}

impl Scale {
    /// What is added to a temperature on this scale to have it in kelvin.
    #[must_use]
    pub fn zero(self) -> f64 {
        match self {
            Scale::Celsius => CELSIUS,
            Scale::Kelvin => 0.0,
        }
    }
    /// Its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Scale::Celsius => "°C",
            Scale::Kelvin => "K",
        }
    }
}

/// How heat goes through contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ContactPath {
    /// Along a bar between the centres.
    Bar,
    /// Through the circle of the contact.
    Circle,
    /// Not at all.
    Closed,
}

/// Radius of a bar over the mean radius of its two particles: a number, or `"fcc"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum BarRadius {
    /// That with which spheres on the lattice conduct like the solid.
    #[serde(with = "super::quantity::fcc")]
    FaceCentred,
    /// As given.
    Ratio(Positive),
}

impl JsonSchema for BarRadius {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "BarRadius".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "const": "fcc" }, { "type": "number", "exclusiveMinimum": 0.0 }] })
    }
}

/// A surface through which particles exchange heat with what is outside. Whatever is in no surface is insulated. What acts
/// on one particle adds up, except a temperature that it is held at.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Surface {
    /// Its name in messages.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// The group of particles or the zone that it belongs to, by name; all particles if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Only the outermost layer of these in one direction: "-x", "+x", "-y", "+y", "-z", "+z".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face: Option<Face>,
    /// Its area, m², of which all its particles have equal parts; that of a face of the lattice if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m²"))]
    pub area: Option<Positive>,
    /// How deep the centres of its particles lie behind it, m: material that heat goes through. "half-cell" is what a face
    /// of a lattice has; 0.0 gives the surface the temperature of its particles (the paper's), an error of first order.
    pub depth: Depth,
    /// Temperature of the surface, constant or along points [time of the heat in s, temperature].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "°C or K"))]
    pub temperature: Option<Course>,
    /// Heat that enters, W/m², constant or along points.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "W/m²"))]
    pub flux: Option<Course>,
    /// A fluid along it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub convection: Option<Convection>,
    /// Walls that it sees and exchanges radiation with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radiation: Option<Radiation>,
}

/// A fluid along a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Convection {
    /// Heat transfer coefficient, W/(m² K).
    #[schemars(extend("x-unit" = "W/(m² K)"))]
    pub coefficient: NonNegative,
    /// Temperature of the fluid, constant or along points.
    #[schemars(extend("x-unit" = "°C or K"))]
    pub temperature: Course,
}

/// Surroundings that a surface exchanges radiation with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Radiation {
    /// Emissivity of the surface.
    pub emissivity: Fraction,
    /// Temperature of the surroundings, constant or along points.
    #[schemars(extend("x-unit" = "°C or K"))]
    pub temperature: Course,
}

/// How deep centres lie behind a surface: m, or `"half-cell"`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Depth {
    /// Half a layer of the lattice.
    #[default]
    #[serde(with = "super::quantity::half_cell")]
    HalfCell,
    /// As given, m.
    Metres(NonNegative),
}

impl JsonSchema for Depth {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Depth".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "const": "half-cell" }, { "type": "number", "minimum": 0.0 }] })
    }
}
