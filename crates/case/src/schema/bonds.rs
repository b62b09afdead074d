//! Bonds between particles: which there are, and what they are made of.

use super::property::Property;
use super::quantity::{NonNegative, PoissonRatio, Positive, Strength, non_negative, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How bonds are computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Bonds {
    /// How forces follow from motion: "total", "incremental", or "incremental-stored" (the paper's).
    pub form: BondForm,
    /// Whether contacts act beside bonds that hold. If not, a contact begins when its bond breaks.
    pub contact_in_bonded_pairs: bool,
    /// Part of each force and moment that is taken away where it speeds particles up and added where it slows them down,
    /// for quasi-static cases only; 0.0 for none.
    #[schemars(range(max = 0.99))]
    pub local_damping: NonNegative,
    /// A table of the pairs to bond, relative to the case, instead of all that are near enough. Its first line is
    /// first,second, its rows are ids of particles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

impl Default for Bonds {
    fn default() -> Self {
        Bonds { form: BondForm::default(), contact_in_bonded_pairs: false, local_damping: none(), file: None }
    }
}

/// How forces of bonds follow from motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BondForm {
    /// From places and orientations: nothing is stored, nothing drifts.
    #[default]
    Total,
    /// Shear force and moments are stored and advanced, the normal force follows from the length.
    Incremental,
    /// All forces and moments are stored and advanced.
    IncrementalStored,
}

/// What bonds between two materials are made of. Exactly one of `lattice`, `micro`, `series` says how stiff they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// The two materials.
    pub between: [String; 2],
    /// As stiff, and if wanted as strong, as a solid whose values were measured: for equal spheres on the lattice "fcc".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lattice: Option<Solid>,
    /// Stiffness of the bonds themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub micro: Option<Micro>,
    /// Whether they are half a bond of each material, one after the other: for interfaces.
    #[serde(default)]
    pub series: bool,
    /// Radius of a bond over the smaller radius of the two particles.
    #[serde(default = "one")]
    pub radius_multiplier: Positive,
    /// Tensile stress, bending included, that breaks a bond, Pa; or "unbreakable". Needed unless `lattice` says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "Pa"))]
    pub tensile_strength: Option<Strength>,
    /// Shear stress, torsion included, that breaks a bond, Pa; or "unbreakable". Needed unless `lattice` says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "Pa"))]
    pub shear_strength: Option<Strength>,
    /// Factor on all stiffnesses over the mean temperature of the two particles, above 0, points [temperature, factor]: 1.0
    /// is what is given above. Only with form = "total".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness_over_temperature: Option<Property>,
    /// Factor on both strengths over the mean temperature of the two particles, points [temperature, factor].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength_over_temperature: Option<Property>,
    /// Angle of internal friction, degrees: pressure adds its tangent times the pressure to the shear strength.
    #[serde(default = "none")]
    #[schemars(range(max = 89.0))]
    pub friction_angle_deg: NonNegative,
    /// How much moments add to stresses, from 0.0 (nothing) to 1.0 (as in a beam).
    #[serde(default = "all")]
    #[schemars(range(max = 1.0))]
    pub moment_contribution: NonNegative,
    /// Damping ratio of dashpots beside the springs; 0.0 for none.
    #[serde(default = "none")]
    pub damping_ratio: NonNegative,
    /// Particles are bonded whose surfaces are no farther apart than this, as a fraction of their mean radius.
    #[serde(default = "default_gap")]
    pub gap: NonNegative,
    /// The same as a length, m; replaces `gap`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "m"))]
    pub gap_length: Option<NonNegative>,
    /// Random strengths; all bonds are equally strong if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scatter: Option<Scatter>,
}

impl Joint {
    /// Distance of centres up to which particles of two radii are bonded, m.
    #[must_use]
    pub fn reach(&self, first: f64, second: f64) -> f64 {
        let sum = first + second;
        self.gap_length.map_or((1.0 + 0.5 * self.gap.get()) * sum, |length| sum + length.get())
    }
}

const fn one() -> Positive {
    positive(1.0)
}
const fn none() -> NonNegative {
    non_negative(0.0)
}
const fn all() -> NonNegative {
    non_negative(1.0)
}
const fn default_gap() -> NonNegative {
    // Far more than rounding, far less than the way to second neighbours.
    non_negative(0.01)
}

/// A solid as it was measured, along a cube axis of the lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Solid {
    /// Young's modulus of the solid, Pa.
    #[schemars(extend("x-unit" = "Pa"))]
    pub young_modulus: Positive,
    /// Poisson's ratio of the solid, from 0 to 1/3: no other can be had on this lattice.
    pub poisson_ratio: PoissonRatio,
    /// Tensile strength of the solid, Pa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "Pa"))]
    pub tensile_strength: Option<Positive>,
    /// How many times more shear bonds bear than they feel when the solid reaches its tensile strength; with 3.0 to 10.0
    /// tension governs. Goes with `tensile_strength`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_factor: Option<Positive>,
}

/// Stiffness of bonds. Exactly one of `young_modulus` and `stiffness_per_area`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Micro {
    /// Young's modulus of the bonds, Pa: long ones are less stiff.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "Pa"))]
    pub young_modulus: Option<Positive>,
    /// Normal stiffness over area, Pa/m: the same for bonds of all lengths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "Pa/m"))]
    pub stiffness_per_area: Option<Positive>,
    /// Shear stiffness over normal stiffness.
    pub stiffness_ratio: NonNegative,
}

/// How strengths scatter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Shape of Weibull's distribution, the larger the narrower; its mean is the strength given.
    pub weibull_shape: Positive,
}
