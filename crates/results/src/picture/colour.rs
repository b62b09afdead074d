//! From values to colours.

use super::palette::ColourMap;
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

    /// What it is called in case files and on the command line.
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

    /// What stands above the bar of colours, without the unit.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Colour::Speed => "speed",
            Colour::Spin => "angular velocity",
            Colour::Height => "height",
            Colour::Radius => "radius",
            Colour::Force => "resultant force",
            Colour::Material => "material",
            Colour::Stress => "mean stress",
            Colour::Damage => "share of broken bonds",
            Colour::Temperature => "temperature",
        }
    }

    /// The colour map of who asks for none: one that diverges for stresses, which have a sign.
    #[must_use]
    pub fn map(self) -> ColourMap {
        match self {
            Colour::Stress => ColourMap::Coolwarm,
            Colour::Temperature => ColourMap::Inferno,
            _ => ColourMap::Viridis,
        }
    }

    /// The smallest and the largest of its values; infinity and minus infinity where there is none. Damage and materials
    /// begin at 0, so that dark is none of it, and the first of them, in every picture.
    #[must_use]
    pub fn extent(self, values: &[f64]) -> [f64; 2] {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let largest = finite().fold(f64::NEG_INFINITY, f64::max);
        match self {
            Colour::Damage | Colour::Material => [0.0, largest.max(0.0)],
            _ => [finite().fold(f64::INFINITY, f64::min), largest],
        }
    }

    /// The range of colours for values of an extent. A map that diverges has 0 in its middle if there are values on both
    /// sides of it.
    #[must_use]
    pub fn range(self, [low, high]: [f64; 2], map: ColourMap) -> [f64; 2] {
        if self == Colour::Damage && high == 0.0 {
            [0.0, 1.0]
        } else if map.diverges() && low < 0.0 && high > 0.0 {
            let most = high.max(-low);
            [-most, most]
        } else {
            [low, high]
        }
    }
}
