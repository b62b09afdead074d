//! Heat: what conducts, what surfaces exchange, how time goes.

use super::course::Course;
use super::quantity::{NonNegative, Positive, Share, non_negative, positive};
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
    /// Temperature of all particles at the start, °C or K.
    #[schemars(extend("x-unit" = "°C or K"))]
    pub initial_temperature: f64,
    /// Temperature at which radii are those given, and at which bonds are free of stress, °C or K;
    /// the initial one if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "°C or K"))]
    pub reference_temperature: Option<f64>,
    /// How heat goes through contacts: along a "bar" between the centres (the paper's), through the "circle" of the
    /// contact, or not at all, "closed". Bonds conduct along a bar, and a contact beside a bond conducts nothing.
    pub contacts: ContactPath,
    /// Radius of the bar over the mean radius of the two particles; or "fcc", with which spheres on that lattice conduct
    /// like the solid.
    pub bar_radius: BarRadius,
    /// With "fcc", for a block with open sides across the way of the heat, which conduct less: its cells there, such as
    /// [28, 28], to raise all conductances by the part that is missing, 1/(4 n) for each; or its open sides, such as
    /// `["-x", "+x", "-y", "+y"]`, to let bonds whose particles both lie at one of them conduct 3/2 times as well, with
    /// which only its edges conduct less.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub open_sides: Option<OpenSides>,
    /// What particles do meanwhile: "scaled", they move, and heat goes `time_scale` times as fast; "frozen", nothing moves or
    /// expands, and only heat goes on; "quasi-static", after every step of the heat they move until they are at rest. With
    /// the last two `time.end` is time of the heat.
    #[serde(default)]
    pub motion: Motion,
    /// Step of the heat, s, if particles are "frozen" or "quasi-static"; left out with "explicit", it is the largest safe one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "s"))]
    pub step: Option<Positive>,
    /// How heat advances by itself: "implicit", stable with any step, which is meant if left out, or "explicit".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scheme: Option<Scheme>,
    /// When particles count as being at rest, if they are "quasi-static".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relaxation: Option<Relaxation>,
    /// Part of what sliding dissipates that becomes heat, half of it in each of both bodies, or all in a particle at a wall
    /// without temperature; 0.0 if left out. Energy of the motion: `time_scale` does not multiply it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_friction: Option<Share>,
    /// Part of what the dashpots of contacts and bonds dissipate that becomes heat, in the same way; 0.0 if left out. What
    /// local damping takes makes none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_damping: Option<Share>,
    /// How much faster the time of the heat goes than that of the motion; 1.0 if left out. Give this or `duration`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_scale: Option<Positive>,
    /// How long "scaled" heat goes on, s, while the motion goes on until `time.end`.
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
    /// Cells of a block with open sides, if bars make up for these.
    fn cells_across(&self) -> Option<[u32; 2]> {
        match self.open_sides {
            Some(OpenSides::Cells(cells)) => Some(cells),
            Some(OpenSides::Faces(_)) | None => None,
        }
    }
    /// Open sides along which bonds conduct more.
    #[must_use]
    pub fn open_faces(&self) -> &[Face] {
        match &self.open_sides {
            Some(OpenSides::Faces(faces)) => faces,
            Some(OpenSides::Cells(_)) | None => &[],
        }
    }
    /// Radius of the bar over the mean radius of two particles.
    #[must_use]
    pub fn bar_radius(&self) -> f64 {
        match self.bar_radius {
            BarRadius::Ratio(ratio) => ratio.get(),
            BarRadius::FaceCentred => tdem_engine::physics::heat::conduction::face_centred_bar(self.cells_across()),
        }
    }
}

/// Open sides of a block: its cells across, or their directions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum OpenSides {
    /// Cells in the two directions across the way of the heat.
    Cells([u32; 2]),
    /// Directions in which its sides look.
    Faces(Vec<Face>),
}

/// What particles do while heat goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// They move, and heat goes faster.
    #[default]
    Scaled,
    /// They stay where they are, as large as they are.
    Frozen,
    /// After every step of the heat they move until they are at rest.
    QuasiStatic,
}

/// How heat advances by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Scheme {
    /// By the backward rule of Euler.
    #[default]
    Implicit,
    /// By Euler's rule; steps that are too long are taken in parts.
    Explicit,
}

/// When particles count as being at rest. What breaks meanwhile starts it anew.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Relaxation {
    /// Mean resultant force on a particle over mean force of a contact or bond, at most.
    pub ratio: Positive,
    /// Steps of the motion after which heat goes on in any case; how often that happened is told.
    #[schemars(range(min = 1))]
    pub at_most_steps: u64,
    /// Steps of the motion between two looks at the forces.
    #[schemars(range(min = 1))]
    pub check_every: u64,
}

impl Default for Relaxation {
    fn default() -> Self {
        Relaxation { ratio: positive(1e-3), at_most_steps: 20_000, check_every: 100 }
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

/// A surface through which particles exchange heat with what is outside. Whatever is in no surface is insulated. All that
/// acts through one surface acts at its one temperature. What several surfaces do to one particle adds up, except a
/// temperature that it is held at.
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
    /// Its area, m², of which all its particles have equal parts. It may be left out only with a `face` of particles on one
    /// lattice, which then have the area of the face of the lattice, or for a temperature that is held without depth.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m²"))]
    pub area: Option<Positive>,
    /// How deep the centres of its particles lie behind it, m: material that heat goes through. "half-cell" is what a face
    /// of a lattice has; 0.0 gives the surface the temperature of its particles (the paper's), an error of first order.
    pub depth: Depth,
    /// Temperature of the surface, °C or K, constant or along points [time of the heat in s, temperature].
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

impl Surface {
    /// Whether its particles are held at a temperature themselves, whatever its area.
    pub(crate) fn needs_no_area(&self) -> bool {
        self.temperature.is_some() && self.depth == Depth::Metres(non_negative(0.0))
    }
}

/// A fluid along a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Convection {
    /// Heat transfer coefficient, W/(m² K).
    #[schemars(extend("x-unit" = "W/(m² K)"))]
    pub coefficient: NonNegative,
    /// Temperature of the fluid, °C or K, constant or along points.
    #[schemars(extend("x-unit" = "°C or K"))]
    pub temperature: Course,
}

/// Surroundings that a surface exchanges radiation with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Radiation {
    /// Emissivity of the surface.
    pub emissivity: Share,
    /// Temperature of the surroundings, °C or K, constant or along points.
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
