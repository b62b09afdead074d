//! From values to colours.

use crate::blocks::{Scene, mean_stress};
use tdem_engine::{Plan, State};

/// What colours mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Size of the velocity.
    Speed,
    /// Size of the angular velocity.
    Spin,
    /// Third coordinate.
    Height,
    /// Radius.
    Radius,
    /// Size of the resultant force.
    Force,
    /// Index of the material.
    Material,
    /// Mean of the three normal stresses, tension positive.
    Stress,
    /// Share of the bonds that broke.
    Damage,
    /// Temperature; not a number without heat.
    Temperature,
}

/// A value between the two ends of the colours, 0 to 1.
pub type Shade = f32;

impl Colour {
    /// All of them.
    pub const ALL: [Colour; 9] = [
        Colour::Speed,
        Colour::Spin,
        Colour::Height,
        Colour::Radius,
        Colour::Force,
        Colour::Material,
        Colour::Stress,
        Colour::Damage,
        Colour::Temperature,
    ];

    /// What it is called in case files, on the command line, and beside the bar of colours.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Colour::Speed => "velocity",
            Colour::Spin => "angular-velocity",
            Colour::Height => "height",
            Colour::Radius => "radius",
            Colour::Force => "force",
            Colour::Material => "material",
            Colour::Stress => "stress",
            Colour::Damage => "damage",
            Colour::Temperature => "temperature",
        }
    }

    /// Unit of its values; empty for a pure number.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Colour::Speed => "m/s",
            Colour::Spin => "rad/s",
            Colour::Height | Colour::Radius => "m",
            Colour::Force => "N",
            Colour::Stress => "Pa",
            Colour::Temperature => "K",
            Colour::Material | Colour::Damage => "",
        }
    }

    /// The values themselves, `(N)`, SI.
    #[must_use]
    pub fn values(self, state: &State, plan: &Plan) -> Vec<f64> {
        let scene = Scene { state, plan, start: None };
        let sizes = |vectors: &[[f64; 3]]| vectors.iter().map(|[x, y, z]| (x * x + y * y + z * z).sqrt()).collect();
        match self {
            Colour::Speed => sizes(&state.velocity),
            Colour::Spin => sizes(&state.angular_velocity),
            Colour::Force => sizes(&state.force),
            Colour::Height => state.position.iter().map(|position| position[2]).collect(),
            Colour::Radius => state.radius.clone(),
            Colour::Material => state.material.iter().map(|&material| material.into()).collect(),
            Colour::Stress => mean_stress(state, plan),
            Colour::Damage => scene.damage(),
            Colour::Temperature if state.temperature.is_empty() => vec![f64::NAN; state.len()],
            Colour::Temperature => state.temperature.clone(),
        }
    }

    /// From the smallest to the largest of its values. Damage and
    /// materials begin at 0, so that dark is none of it, and the first of them, in every picture.
    #[must_use]
    pub fn range_of(self, values: &[f64]) -> [f64; 2] {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let largest = finite().fold(f64::NEG_INFINITY, f64::max);
        match self {
            Colour::Damage if largest > 0.0 => [0.0, largest],
            Colour::Damage => [0.0, 1.0],
            Colour::Material => [0.0, largest.max(0.0)],
            _ => [finite().fold(f64::INFINITY, f64::min), largest],
        }
    }
}

/// Values as shares of a range.
pub(super) fn shades(values: &[f64], [low, high]: [f64; 2]) -> Vec<Shade> {
    let span = if high > low { high - low } else { 1.0 };
    values.iter().map(|value| (((value - low) / span) as Shade).clamp(0.0, 1.0)).collect()
}

/// Dark blue, teal, green, yellow: ascending in brightness, so that it also reads in grey and for the colour-blind.
const STOPS: [[f32; 3]; 6] = [
    [0.27, 0.11, 0.43],
    [0.23, 0.32, 0.55],
    [0.13, 0.53, 0.55],
    [0.24, 0.71, 0.45],
    [0.66, 0.86, 0.20],
    [0.99, 0.90, 0.14],
];

/// The colour of a shade; red, green and blue between 0 and 1. What is not a number is grey.
pub(super) fn colour_of(shade: Shade) -> [f32; 3] {
    if shade.is_nan() {
        return [0.5; 3];
    }
    let place = shade * (STOPS.len() - 1) as f32;
    let stop = (place as usize).min(STOPS.len() - 2);
    let share = place - stop as f32;
    std::array::from_fn(|k| STOPS[stop][k] + share * (STOPS[stop + 1][k] - STOPS[stop][k]))
}
