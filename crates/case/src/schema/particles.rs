//! Groups of particles: where they come from, and how they start.

use super::course::Course;
use super::quantity::{NonNegative, Positive};
use super::shape::Shape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A group of particles. Exactly one of `lattice`, `random`, `list`, `csv`, `run` says where they come from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Particles {
    /// Its name in messages and for gauges.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Name of the material. May be left out if `csv` or `run` says it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Initial velocity, m/s; added to what `csv` or `run` say.
    #[schemars(extend("x-unit" = "m/s"))]
    pub velocity: [f64; 3],
    /// Lowest and highest speed of a random velocity that is added, m/s: magnitude uniform, direction isotropic.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m/s"))]
    pub random_speed: Option<[NonNegative; 2]>,
    /// Rates at which x, y, z stretch at the start, 1/s: the rate times the coordinate is added to the velocity, so that
    /// what is pulled starts without a shock.
    #[schemars(extend("x-unit" = "1/s"))]
    pub strain_rate: [f64; 3],
    /// Initial angular velocity, rad/s; added to what `csv` or `run` say.
    #[schemars(extend("x-unit" = "rad/s"))]
    pub angular_velocity: [f64; 3],
    /// Temperature at the start, °C or K as `heat.scale` says; `heat.initial_temperature` if left out, or what `run` says.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "°C or K"))]
    pub temperature: Option<f64>,
    /// Components that do not move: "x", "y", "z" and the rotations about them, "rx", "ry", "rz".
    pub fixed: Vec<Component>,
    /// Components that move at a given rate, m/s or rad/s, such as { x = 0.1 }, or along a ramp, such as
    /// { x = [[0.0, 0.0], [1.0e-3, 0.1]] }.
    #[serde(skip_serializing_if = "Prescribed::is_empty")]
    pub prescribed: Prescribed,
    /// Force that is applied to the group, N, such as { x = 100.0 }, or along a ramp. Its particles share it equally.
    #[serde(skip_serializing_if = "Force::is_empty")]
    pub force: Force,
    /// Whether particles are bonded to none, even where a `[[bond]]` joins their materials.
    pub loose: bool,
    /// Whether particles may overlap others, or walls, at the start by more than 1e-6 of a radius.
    pub allow_overlap: bool,
    /// A part of space: of the particles below only those are kept whose centres lie in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within: Option<Shape>,
    /// Parts of space, such as holes: those whose centres lie in one of them are not kept.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub without: Vec<Shape>,
    /// On a regular lattice.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lattice: Option<Lattice>,
    /// At random places, without overlap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub random: Option<Random>,
    /// At the places listed here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub list: Option<List>,
    /// From a table in a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub csv: Option<Csv>,
    /// From the final state of another run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<Run>,
}

/// A component of a particle's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Component {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
    /// About x.
    Rx,
    /// About y.
    Ry,
    /// About z.
    Rz,
}

/// Rates at which components move.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Prescribed {
    /// Along x, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m/s"))]
    pub x: Option<Course>,
    /// Along y, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m/s"))]
    pub y: Option<Course>,
    /// Along z, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m/s"))]
    pub z: Option<Course>,
    /// About x, rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "rad/s"))]
    pub rx: Option<Course>,
    /// About y, rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "rad/s"))]
    pub ry: Option<Course>,
    /// About z, rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "rad/s"))]
    pub rz: Option<Course>,
}

impl Prescribed {
    /// The rates in the order of [`Component`].
    #[must_use]
    pub fn components(&self) -> [Option<&Course>; 6] {
        [&self.x, &self.y, &self.z, &self.rx, &self.ry, &self.rz].map(Option::as_ref)
    }
    /// The same, to be changed.
    pub(crate) fn components_mut(&mut self) -> [Option<&mut Course>; 6] {
        [&mut self.x, &mut self.y, &mut self.z, &mut self.rx, &mut self.ry, &mut self.rz].map(Option::as_mut)
    }
    /// Whether nothing is prescribed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.components().iter().all(Option::is_none)
    }
}

/// A force that is applied from outside, shared equally by the particles that it is applied to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Force {
    /// Along x, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "N"))]
    pub x: Option<Course>,
    /// Along y, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "N"))]
    pub y: Option<Course>,
    /// Along z, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "N"))]
    pub z: Option<Course>,
}

impl Force {
    /// The components.
    #[must_use]
    pub fn components(&self) -> [Option<&Course>; 3] {
        [&self.x, &self.y, &self.z].map(Option::as_ref)
    }
    /// The same, to be changed.
    pub(crate) fn components_mut(&mut self) -> [Option<&mut Course>; 3] {
        [&mut self.x, &mut self.y, &mut self.z].map(Option::as_mut)
    }
    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.components().iter().all(Option::is_none)
    }
}

/// A block of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Lower corner, m.
    pub min: [f64; 3],
    /// Upper corner, m.
    pub max: [f64; 3],
}

/// Equal spheres on a regular lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// "fcc", the densest, with 4 spheres per cell and 12 neighbours each; or "sc", simple cubic, with 1 and 6.
    pub kind: CellKind,
    /// Radius of the spheres, m.
    #[schemars(extend("x-unit" = "m"))]
    pub radius: Positive,
    /// Number of cells in x, y, z; as many as the region holds if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells: Option<[u32; 3]>,
    /// Gap between nearest neighbours, as a fraction of the diameter. Slightly negative, such as -1e-9, makes sure that
    /// they touch.
    #[serde(default)]
    #[schemars(range(min = -0.5))]
    pub gap: f64,
    /// Lower corner of the region, m; the domain's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub min: Option<[f64; 3]>,
    /// Upper corner of the region, m; the domain's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub max: Option<[f64; 3]>,
    /// Where in the region the lattice stands, for each direction.
    #[serde(default, skip_serializing_if = "is_centered")]
    pub align: [Align; 3],
    /// Centre of the first sphere, m; replaces `align`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub origin: Option<[f64; 3]>,
    /// Centre of any of the spheres, m: all others follow from it that lie wholly in the region. What is cut out around
    /// it with `within` is as symmetric as the lattice. Replaces `cells`, `align` and `origin`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub site: Option<[f64; 3]>,
}

/// A default that would contradict `origin` if it were written out.
fn is_centered(align: &[Align]) -> bool {
    align.iter().all(|align| *align == Align::Center)
}

/// Kind of a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CellKind {
    /// Face-centred cubic.
    Fcc,
    /// Simple cubic.
    Sc,
}

/// Where in a region something stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Align {
    /// At the lower end.
    Min,
    /// In the middle.
    #[default]
    Center,
    /// At the upper end.
    Max,
}

/// Spheres at random places, without overlap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Random {
    /// Number of spheres. Give this or `volume_fraction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub count: Option<u32>,
    /// Volume of the spheres over volume of the region; beyond about 0.35 there is no room left for random places.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 0.64))]
    pub volume_fraction: Option<Positive>,
    /// Radius, m: a number, or a table such as { min = 0.01, max = 0.03, distribution = "number" }.
    #[schemars(extend("x-unit" = "m"))]
    pub radius: Radius,
    /// Lower corner of the region, m; the domain's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub min: Option<[f64; 3]>,
    /// Upper corner of the region, m; the domain's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub max: Option<[f64; 3]>,
    /// Places that are tried for one sphere before giving up.
    #[serde(default = "default_attempts")]
    #[schemars(range(min = 1))]
    pub attempts: u32,
}

const fn default_attempts() -> u32 {
    20_000
}

/// One radius or a range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Radius {
    /// All spheres are equal.
    Equal(Positive),
    /// Sizes between two radii.
    Range(SizeRange),
}

/// Sizes between two radii.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SizeRange {
    /// Smallest radius, m.
    #[schemars(extend("x-unit" = "m"))]
    pub min: Positive,
    /// Largest radius, m.
    #[schemars(extend("x-unit" = "m"))]
    pub max: Positive,
    /// "number": every radius is as frequent; "volume": every radius holds as much volume, so small ones abound.
    pub distribution: SizeDistribution,
}

/// How often sizes occur.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SizeDistribution {
    /// Uniform by number.
    Number,
    /// Uniform by volume.
    Volume,
}

impl Radius {
    /// Smallest and largest radius, m.
    #[must_use]
    pub fn bounds(self) -> [f64; 2] {
        match self {
            Radius::Equal(radius) => [radius.get(); 2],
            Radius::Range(range) => [range.min.get(), range.max.get()],
        }
    }
}

/// Spheres at given places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct List {
    /// Radius, m.
    #[schemars(extend("x-unit" = "m"))]
    pub radius: Positive,
    /// Centres, m.
    #[schemars(length(min = 1))]
    #[schemars(extend("x-unit" = "m"))]
    pub positions: Vec<[f64; 3]>,
}

/// Spheres from a table in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Csv {
    /// The file, relative to the case. Its first line names the columns: x, y, z, radius, and if wanted vx, vy, vz, wx,
    /// wy, wz, id, material. Lines that begin with # are skipped.
    pub file: String,
}

/// Spheres from the final state of another run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// The run's directory, relative to the case.
    pub directory: String,
    /// Names for the materials of that run, in the order of its indices. If left out, and the group has no `material`
    /// either, materials keep the names that they have in that run's case.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<String>,
    /// Added to all places, m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub offset: [f64; 3],
    /// "anew": particles are bonded as they lie now, as `[[bond]]` says, and that run's bonds are forgotten. "carry": that
    /// run's bonds go on, loaded as they are; what broke stays unbonded, and these particles are bonded to no others.
    #[serde(default)]
    pub bonds: RunBonds,
    /// What becomes of the contact histories of that run, the tangential displacements of its friction springs. "carry":
    /// they are transferred, between particles and with walls of the same name, where the contact is closed here and has
    /// friction; springs keep their displacement, whatever their stiffness is here. "anew": all springs start unloaded. If
    /// left out they do so too, with a warning that counts them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contacts: Option<RunContacts>,
}

/// What becomes of the bonds of another run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RunBonds {
    /// They are forgotten.
    #[default]
    Anew,
    /// They go on.
    Carry,
}

/// What becomes of the contact histories of another run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RunContacts {
    /// Friction springs start unloaded.
    Anew,
    /// Friction springs are transferred.
    Carry,
}
