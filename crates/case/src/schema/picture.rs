//! Pictures that are drawn while a case runs.

use super::{Case, Model};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Pictures of spheres that are drawn as the run goes on: `pictures/NAME-STEP.png`. `output.pictures` says how many.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Picture {
    /// Its name: letters, digits, `_` and `-`.
    pub name: String,
    /// What colours mean.
    pub field: Field,
    /// Values at the two ends of the colours, in the unit of the field; the smallest and the largest of all pictures of the series
    /// if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// Which colours; "coolwarm" for stresses, "inferno" for temperatures, "viridis" for others if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour_map: Option<ColourMap>,
    /// What lies behind spheres.
    #[serde(default = "white")]
    pub background: Background,
    /// From where. Give this or `direction`; without either it is "corner".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub view: Option<View>,
    /// Where the camera stands, seen from what it looks at; its length does not matter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Whether the particles fill the picture instead of the whole domain.
    #[serde(default)]
    pub close: bool,
    /// What is cut away.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip: Option<Clip>,
    /// Pixels across and down, at most 16384.
    #[serde(default = "size")]
    pub size: [u32; 2],
    /// Whether walls are outlined.
    #[serde(default = "yes")]
    pub walls: bool,
    /// Whether a bar beside the picture tells values and time.
    #[serde(default = "yes")]
    pub bar: bool,
}

const fn size() -> [u32; 2] {
    [960, 720]
}
const fn white() -> Background {
    Background::White
}
const fn yes() -> bool {
    true
}

/// A plane that cuts particles away.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clip {
    /// A point of the plane, m.
    #[schemars(extend("x-unit" = "m"))]
    pub point: [f64; 3],
    /// Towards the particles that are left out, those whose centres lie beyond the plane; its length does not matter.
    pub normal: [f64; 3],
}

/// An enum of words with their meanings: for the schema, for the command line, for lists.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $(#[doc = $about:literal] $variant:ident = $word:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        pub enum $name {
            $(#[doc = $about] #[serde(rename = $word)] $variant,)*
        }
        impl $name {
            /// All of them, each with its word and what it means.
            pub const ALL: &'static [(Self, &'static str, &'static str)] =
                &[$((Self::$variant, $word, $about),)*];
        }
    };
}

words! {
    /// What colours mean.
    Field {
        #[doc = " Speed, m/s."]
        Velocity = "velocity",
        #[doc = " Size of the angular velocity, rad/s."]
        AngularVelocity = "angular-velocity",
        #[doc = " Third coordinate, m."]
        Height = "height",
        #[doc = " Radius, m."]
        Radius = "radius",
        #[doc = " Size of the resultant force, N."]
        Force = "force",
        #[doc = " Number of the material, in the order of their names."]
        Material = "material",
        #[doc = " Mean of the three normal stresses from contacts and bonds, Pa, tension positive."]
        Stress = "stress",
        #[doc = " Share of the bonds that broke."]
        Damage = "damage",
        #[doc = " Temperature, on the scale of the case."]
        Temperature = "temperature",
    }
}

words! {
    /// Which colours.
    ColourMap {
        #[doc = " From dark blue over green to yellow, ascending evenly in lightness."]
        Viridis = "viridis",
        #[doc = " From black over red to pale yellow, ascending evenly in lightness."]
        Inferno = "inferno",
        #[doc = " From blue over pale grey to red, 0 in the middle if values of both signs are there."]
        Coolwarm = "coolwarm",
        #[doc = " From dark to light grey, for print."]
        Grey = "grey",
    }
}

words! {
    /// What lies behind spheres.
    Background {
        #[doc = " White."]
        White = "white",
        #[doc = " Dark grey, with light letters."]
        Dark = "dark",
        #[doc = " Nothing: the picture can be laid over a page of any colour."]
        Transparent = "transparent",
    }
}

/// From where a picture is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum View {
    /// In front, a little to the right and from above.
    #[default]
    Corner,
    /// Along y.
    Front,
    /// Against y.
    Back,
    /// Along x.
    Left,
    /// Against x.
    Right,
    /// From above, y upwards.
    Top,
    /// From below.
    Bottom,
}

impl View {
    /// Where the camera stands, seen from what it looks at.
    #[must_use]
    pub fn direction(self) -> [f64; 3] {
        match self {
            View::Corner => [1.0, -1.7, 0.9],
            View::Front => [0.0, -1.0, 0.0],
            View::Back => [0.0, 1.0, 0.0],
            View::Left => [-1.0, 0.0, 0.0],
            View::Right => [1.0, 0.0, 0.0],
            View::Top => [0.0, 0.0, 1.0],
            View::Bottom => [0.0, 0.0, -1.0],
        }
    }
}

impl Case {
    /// The pictures that it asks for; a case that asks for none gets small ones of what its model is about.
    #[must_use]
    pub fn pictures(&self) -> Vec<Picture> {
        let plain = |field, name: &str| Picture {
            name: name.to_owned(),
            field,
            range: None,
            colour_map: None,
            background: Background::White,
            view: None,
            direction: None,
            close: self.model.bonds(),
            clip: None,
            size: [640, 480],
            walls: true,
            bar: true,
        };
        if !self.picture.is_empty() {
            return self.picture.clone();
        }
        let temperature = self.heat.is_some().then(|| plain(Field::Temperature, "temperature"));
        let other = match self.model {
            Model::BPM | Model::TBPM => Some(plain(Field::Damage, "damage")),
            Model::GN | Model::GNT | Model::GNTM if self.heat.is_none() => Some(plain(Field::Velocity, "velocity")),
            Model::GN | Model::GNT | Model::GNTM => None,
        };
        temperature.into_iter().chain(other).collect()
    }
}
