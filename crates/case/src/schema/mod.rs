//! What a case file may say.
//!
//! Every field is documented with its unit, because editors show these words: the JSON schema comes from these types.
//! The same schema checks a file before `serde` reads it, so that all structural problems are found at once.

mod bonds;
mod course;
mod gauge;
mod heat;
mod particles;
mod picture;
mod property;
mod quantity;
mod shape;
mod zone;

pub use bonds::{BondForm, Bonds, Joint, Micro, Scatter, Solid};
pub use course::{Course, Measured};
pub use gauge::{Against, Curve, Gauge};
pub use heat::{
    BarRadius, ContactPath, Convection, Depth, Heat, Motion, OpenSides, Radiation, Relaxation, Scale, Scheme, Surface,
};
pub use particles::{
    Align, CellKind, Component, Csv, Force, Lattice, List, Particles, Prescribed, Radius, Random, Region, Run,
    RunBonds, RunContacts, SizeDistribution, SizeRange,
};
pub use picture::{Background, Clip, ColourMap, Field, Picture, View};
pub use property::{MeasuredProperty, Property};
pub(crate) use quantity::non_negative;
pub use quantity::{
    Fraction, NonNegative, OutOfRange, PoissonRatio, Positive, Share, Step, Strength, TangentialCoefficient,
};
pub use shape::{Ball, Block, Cylinder, Revolution, RibbedBar, Shape};
pub use zone::Zone;

use quantity::{fraction, positive};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A simulation case for tdem. SI units throughout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// What the case is about, in one line.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// What particles do to each other: "GN" pushes, "GNT" also rubs, "GNTM" also turns, "BPM" also bonds; "TBPM" is BPM
    /// with heat.
    pub model: Model,
    /// Seed of all random numbers.
    #[serde(default = "one")]
    pub seed: u64,
    /// Which of the presets in `sizes` applies.
    #[serde(default, skip_serializing)]
    pub size: Option<String>,
    /// Presets: each may hold any part of a case, which replaces that part.
    #[serde(default, skip_serializing)]
    pub sizes: BTreeMap<String, Preset>,
    /// Acceleration of gravity, m/s². Write [0.0, 0.0, 0.0] for none.
    #[schemars(extend("x-unit" = "m/s²"))]
    pub gravity: [f64; 3],
    /// Step and duration.
    pub time: Time,
    /// Where particles may be.
    pub domain: Domain,
    /// Materials by name.
    pub material: BTreeMap<String, Material>,
    /// Choices in the contact law.
    #[serde(default)]
    pub contact: Contact,
    /// What happens between two materials, one entry for each pair that can meet.
    #[serde(default)]
    pub interaction: Vec<Interaction>,
    /// How bonds are computed.
    #[serde(default)]
    pub bonds: Bonds,
    /// What bonds are made of, one entry for each pair of materials that is bonded. Needed with the model BPM.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bond: Vec<Joint>,
    /// Heat. Particles of all models can have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat: Option<Heat>,
    /// Surfaces through which heat goes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub surface: Vec<Surface>,
    /// Plane walls.
    #[serde(default)]
    pub wall: Vec<Wall>,
    /// Boxes of six plane walls facing inward.
    #[serde(default, rename = "box")]
    pub boxes: Vec<Container>,
    /// Groups of particles.
    pub particles: Vec<Particles>,
    /// Parts of space whose particles are made of something else, or move otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub zone: Vec<Zone>,
    /// Planes of mirror symmetry through centres of particles.
    #[serde(default)]
    pub symmetry: Vec<Symmetry>,
    /// Groups of particles that are watched: forces, displacements and strains in the history.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gauge: Vec<Gauge>,
    /// Curves that are drawn at the end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve: Vec<Curve>,
    /// Pictures that are drawn as the run goes on. Without any there are small ones of temperature, damage or velocity, as the
    /// model has them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub picture: Vec<Picture>,
    /// How neighbours are found; changes the speed, never the result.
    #[serde(default)]
    pub search: Search,
    /// What is written, and how often.
    #[serde(default)]
    pub output: Output,
}

const fn one() -> u64 {
    1
}

/// A part of a case that replaces the same part of the case around it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Preset(pub toml::Table);

impl JsonSchema for Preset {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Preset".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        // What a preset holds is checked where it ends up.
        json_schema!({ "type": "object", "additionalProperties": true })
    }
}

/// What particles do to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Model {
    /// Normal force only.
    GN,
    /// Normal and tangential force; particles do not turn.
    GNT,
    /// Normal and tangential force and the moments they make.
    GNTM,
    /// Bonds that break, and contacts as with GNTM.
    BPM,
    /// The same with heat.
    TBPM,
}

impl Model {
    /// Whether particles turn.
    #[must_use]
    pub fn turns(self) -> bool {
        matches!(self, Model::GNTM | Model::BPM | Model::TBPM)
    }
    /// Whether particles are bonded.
    #[must_use]
    pub fn bonds(self) -> bool {
        matches!(self, Model::BPM | Model::TBPM)
    }
}

/// Step and duration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Time step, s; or "auto", the largest step that all limits allow, times `safety`.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s"))]
    pub step: Step,
    /// Duration of the run, s.
    #[schemars(extend("x-unit" = "s"))]
    pub end: Positive,
    /// How particles move: "velocity-verlet", or "gear" (the paper's).
    #[serde(default)]
    pub integrator: Integrator,
    /// Fraction of the smallest limit that "auto" takes.
    #[serde(default = "default_safety")]
    pub safety: Fraction,
    /// How many times their mass particles have where they move, for states of rest: steps may then be longer by its root.
    /// Gravity and specific heats are divided by it, so that weight and heat stay those of the true mass; dashpots with
    /// coefficients in 1/s grow with the mass. 1.0 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_scaling: Option<Positive>,
}

impl Time {
    /// Mass that moves over true mass.
    #[must_use]
    pub fn mass_scaling(&self) -> f64 {
        self.mass_scaling.map_or(1.0, Positive::get)
    }
}

const fn default_safety() -> Fraction {
    fraction(0.8)
}

/// How particles move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Second order, symplectic, large steps.
    #[default]
    VelocityVerlet,
    /// Gear's predictor-corrector of fifth order, small steps.
    Gear,
}

/// Where particles may be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Lower corner, m.
    #[schemars(extend("x-unit" = "m"))]
    pub min: [f64; 3],
    /// Upper corner, m.
    #[schemars(extend("x-unit" = "m"))]
    pub max: [f64; 3],
    /// Directions x, y, z in which the domain repeats. In the others a centre that leaves it stops the run.
    #[serde(default)]
    pub periodic: [bool; 3],
}

/// A material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Density of the solid, kg/m³.
    #[schemars(extend("x-unit" = "kg/m³"))]
    pub density: Positive,
    /// Young's modulus, Pa.
    #[schemars(extend("x-unit" = "Pa"))]
    pub young_modulus: Positive,
    /// Poisson's ratio.
    pub poisson_ratio: PoissonRatio,
    /// Young's modulus of the true material, Pa, where `young_modulus` is lowered for longer steps. Contact spots
    /// (`heat.contacts = "circle"`) then conduct as those of the true material do under the same load: their radius is
    /// corrected by (E*/E*_original)^(1/3). Forces do not know it; if left out, nothing is corrected.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "Pa"))]
    pub original_young_modulus: Option<Positive>,
    /// Thermal conductivity, W/(m K), a number or points [temperature, value]. Needed with heat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "W/(m K)"))]
    pub thermal_conductivity: Option<Property>,
    /// Specific heat, J/(kg K), above 0, a number or points [temperature, value]. Needed with heat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "J/(kg K)"))]
    pub specific_heat: Option<Property>,
    /// Coefficient of linear thermal expansion, 1/K. Needed with heat; 0.0 for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "1/K"))]
    pub thermal_expansion: Option<f64>,
}

/// Choices in the contact law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Contact {
    /// "viscous" takes `normal_damping` of each interaction, "restitution" takes `restitution`.
    pub damping: Damping,
    /// "displacement" keeps the tangential displacement (the paper's), "rescaled" never creates energy.
    pub tangential: Tangential,
    /// Tangential stiffness over G* sqrt(R* h): 8.0 (Mindlin, no slip) or "16/3".
    pub tangential_coefficient: TangentialCoefficient,
    /// Whether the dashpot is kept from pulling bodies together that separate.
    pub clamp: bool,
    /// Overlap that stops the run, as a fraction of the smaller radius of a pair, or of the radius at a wall.
    pub overlap_limit: Fraction,
}

impl Default for Contact {
    fn default() -> Self {
        Contact {
            damping: Damping::default(),
            tangential: Tangential::default(),
            tangential_coefficient: TangentialCoefficient::default(),
            clamp: true,
            overlap_limit: fraction(0.5),
        }
    }
}

/// How the normal force dissipates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Damping {
    /// A dashpot with a coefficient in 1/s.
    #[default]
    Viscous,
    /// A dashpot that gives the same restitution at every speed.
    Restitution,
}

/// What a contact remembers of sliding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Tangential {
    /// The displacement.
    #[default]
    Displacement,
    /// The force, while the contact is being loaded.
    Rescaled,
}

/// What happens between two materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interaction {
    /// The two materials; "rigid" is an infinitely stiff wall.
    pub between: [String; 2],
    /// Friction that must be overcome to start sliding. Needed unless the model is GN.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub static_friction: Option<NonNegative>,
    /// Friction while sliding, at most the static one. Needed unless the model is GN.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dynamic_friction: Option<NonNegative>,
    /// Normal dashpot over effective mass, 1/s. Needed with damping = "viscous".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "1/s"))]
    pub normal_damping: Option<NonNegative>,
    /// Tangential dashpot over effective mass, 1/s. Needed unless the model is GN.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "1/s"))]
    pub tangential_damping: Option<NonNegative>,
    /// Speed after over speed before an impact. Needed with damping = "restitution".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub restitution: Option<Fraction>,
}

/// An infinite plane wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Its name in messages and results.
    pub name: String,
    /// A point of the plane, m.
    #[schemars(extend("x-unit" = "m"))]
    pub point: [f64; 3],
    /// Direction towards the particles; its length does not matter.
    pub normal: [f64; 3],
    /// Velocity, m/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub velocity: [f64; 3],
    /// Its material, or "rigid".
    pub material: String,
    /// Its temperature, °C or K, constant or along points [time of the heat in s, temperature]; insulated if left out. A rigid wall
    /// conducts nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "°C or K"))]
    pub temperature: Option<Course>,
}

/// Six plane walls facing inward. Each is an infinite plane, so all particles are inside all boxes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Container {
    /// Its name in messages and results.
    #[serde(default = "default_box_name")]
    pub name: String,
    /// Lower corner, m; the domain's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub min: Option<[f64; 3]>,
    /// Upper corner, m; the domain's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub max: Option<[f64; 3]>,
    /// Faces to leave out: `open = ["+z"]` for an open top.
    #[serde(default)]
    pub open: Vec<Face>,
    /// Velocity, m/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub velocity: [f64; 3],
    /// Its material, or "rigid".
    pub material: String,
    /// Temperature of all its faces, °C or K, constant or along points; insulated if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "°C or K"))]
    pub temperature: Option<Course>,
}

fn default_box_name() -> String {
    "box".to_owned()
}

/// A face of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Face {
    /// The face of lowest x.
    #[serde(rename = "-x")]
    LowX,
    /// The face of highest x.
    #[serde(rename = "+x")]
    HighX,
    /// The face of lowest y.
    #[serde(rename = "-y")]
    LowY,
    /// The face of highest y.
    #[serde(rename = "+y")]
    HighY,
    /// The face of lowest z.
    #[serde(rename = "-z")]
    LowZ,
    /// The face of highest z.
    #[serde(rename = "+z")]
    HighZ,
}

/// A plane of mirror symmetry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Symmetry {
    /// Direction of the plane's normal.
    pub axis: Axis,
    /// Coordinate of the plane, m. Centres of particles must lie on it.
    #[schemars(extend("x-unit" = "m"))]
    pub at: f64,
}

/// A direction of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// How neighbours are found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Search {
    /// Pairs are listed up to this gap, as a fraction of the smallest radius.
    pub skin: NonNegative,
    /// Whether to search in every step, as the paper does.
    pub every_step: bool,
}

impl Default for Search {
    fn default() -> Self {
        Search { skin: non_negative(0.2), every_step: false }
    }
}

/// What is written, and how often.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Output {
    /// Number of frames after the first; 0 writes none. Give this or `interval`; without either it is 50.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<u32>,
    /// Simulated time between frames, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "s"))]
    pub interval: Option<Positive>,
    /// Number of pictures of each kind after the first; 0 draws none. If left out it is 4, or 0 where `frames` is 0 and there is
    /// no `[[picture]]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pictures: Option<u32>,
    /// Simulated time between rows of the history, s; a thousandth of the run if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "s"))]
    pub history_interval: Option<Positive>,
    /// Simulated time between checkpoints, s; none by simulated time if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "s"))]
    pub checkpoint_interval: Option<Positive>,
    /// Time on the clock between checkpoints, s.
    #[schemars(extend("x-unit" = "s"))]
    pub checkpoint_interval_secs: Positive,
    /// Whether frames show contacts, as lines between centres with their forces.
    pub contacts: bool,
    /// Whether frames show bonds, as lines between centres with their forces; if left out, they do where there are bonds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bonds: Option<bool>,
    /// Precision of the numbers in frames: "single", or "double".
    pub precision: Precision,
    /// How hard frames are compressed, from 0 (not at all) to 9.
    #[schemars(range(max = 9))]
    pub compression: u32,
    /// Whether dissipated energy is accounted for.
    pub ledger: bool,
}

impl Default for Output {
    fn default() -> Self {
        Output {
            frames: None,
            interval: None,
            pictures: None,
            history_interval: None,
            checkpoint_interval: None,
            checkpoint_interval_secs: positive(300.0),
            contacts: false,
            bonds: None,
            precision: Precision::default(),
            // Of a million spheres, level 4 saves 2 % more space than level 1 and takes three times as long.
            compression: 1,
            ledger: true,
        }
    }
}

/// Precision of the numbers in frames. Checkpoints are always exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 32 bits: what pictures need.
    #[default]
    Single,
    /// 64 bits.
    Double,
}

/// The JSON schema of case files, for editors.
#[must_use]
pub fn json_schema() -> serde_json::Value {
    let mut schema = schemars::schema_for!(Case).to_value();
    remove_null(&mut schema);
    schema
}

/// TOML has no null: a key is there or not.
fn remove_null(value: &mut serde_json::Value) {
    use serde_json::Value;
    if let Value::Object(map) = value {
        if let Some(Value::Array(types)) = map.get_mut("type") {
            types.retain(|t| t != "null");
            if let [only] = types.as_slice() {
                let only = only.clone();
                map.insert("type".to_owned(), only);
            }
        }
        if map.get("default") == Some(&Value::Null) {
            map.remove("default");
        }
        if let Some(Value::Array(options)) = map.get_mut("anyOf") {
            options.retain(|o| o.get("type") != Some(&"null".into()));
            if let [Value::Object(only)] = options.as_slice() {
                let only = only.clone();
                map.remove("anyOf");
                map.extend(only);
            }
        }
        map.values_mut().for_each(remove_null);
    } else if let Value::Array(items) = value {
        items.iter_mut().for_each(remove_null);
    }
}
