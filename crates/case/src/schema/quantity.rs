//! Numbers that cannot hold what makes no sense.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A number outside the range of its type.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{value} is not {allowed}")]
pub struct OutOfRange {
    /// The number.
    pub value: f64,
    /// What would be allowed.
    pub allowed: &'static str,
}

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $allowed:literal, |$value:ident| $holds:expr, { $($schema:tt)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $name(f64);

        impl $name {
            /// The number itself.
            #[must_use]
            pub const fn get(self) -> f64 {
                self.0
            }
        }
        impl TryFrom<f64> for $name {
            type Error = OutOfRange;
            fn try_from($value: f64) -> Result<Self, OutOfRange> {
                if $value.is_finite() && $holds {
                    Ok($name($value))
                } else {
                    Err(OutOfRange { value: $value, allowed: $allowed })
                }
            }
        }
        impl From<$name> for f64 {
            fn from(quantity: $name) -> f64 {
                quantity.0
            }
        }
        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({ "type": "number", $($schema)* })
            }
        }
    };
}

quantity!(
    /// Larger than zero, finite.
    Positive, "a number above 0", |value| value > 0.0, { "exclusiveMinimum": 0.0 }
);
quantity!(
    /// Zero or larger, finite.
    NonNegative, "a number of at least 0", |value| value >= 0.0, { "minimum": 0.0 }
);
quantity!(
    /// Above 0, at most 1.
    Fraction, "a number above 0 and at most 1", |value| value > 0.0 && value <= 1.0,
    { "exclusiveMinimum": 0.0, "maximum": 1.0 }
);
quantity!(
    /// From 0 to 1.
    Share, "a number from 0 to 1", |value| (0.0..=1.0).contains(&value), { "minimum": 0.0, "maximum": 1.0 }
);
quantity!(
    /// Poisson's ratio of an isotropic solid: above -1, at most 0.5.
    PoissonRatio, "a number above -1 and at most 0.5", |value| value > -1.0 && value <= 0.5,
    { "exclusiveMinimum": -1.0, "maximum": 0.5 }
);

/// The time step: `"auto"`, or seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Step {
    /// The largest step that all limits allow, times `safety`.
    #[default]
    #[serde(with = "auto")]
    Auto,
    /// As given, s.
    Seconds(Positive),
}

/// Reads and writes the word that stands for a number.
macro_rules! word {
    ($module:ident, $word:literal) => {
        pub(super) mod $module {
            use serde::{Deserialize, Deserializer, Serializer, de::Error};
            pub(in crate::schema) fn serialize<S: Serializer>(serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str($word)
            }
            pub(in crate::schema) fn deserialize<'d, D: Deserializer<'d>>(deserializer: D) -> Result<(), D::Error> {
                match String::deserialize(deserializer)?.as_str() {
                    $word => Ok(()),
                    other => Err(D::Error::custom(format!("expected \"{}\", found \"{other}\"", $word))),
                }
            }
        }
    };
}
word!(auto, "auto");
word!(sixteen_thirds, "16/3");
word!(unbreakable, "unbreakable");
word!(fcc, "fcc");
word!(half_cell, "half-cell");

impl JsonSchema for Step {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Step".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "const": "auto" }, { "type": "number", "exclusiveMinimum": 0.0 }] })
    }
}

/// Coefficient of the tangential stiffness: a number, or `"16/3"`, which TOML cannot write as a number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum TangentialCoefficient {
    /// 16/3.
    #[serde(with = "sixteen_thirds")]
    SixteenThirds,
    /// As given; Mindlin's no-slip value is 8.
    Number(Positive),
}

impl TangentialCoefficient {
    /// The number itself.
    #[must_use]
    pub fn get(self) -> f64 {
        match self {
            TangentialCoefficient::SixteenThirds => 16.0 / 3.0,
            TangentialCoefficient::Number(number) => number.get(),
        }
    }
}

impl Default for TangentialCoefficient {
    fn default() -> Self {
        TangentialCoefficient::Number(Positive(8.0))
    }
}

impl JsonSchema for TangentialCoefficient {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "TangentialCoefficient".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "const": "16/3" }, { "type": "number", "exclusiveMinimum": 0.0 }] })
    }
}

/// A strength: Pa, or `"unbreakable"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Strength {
    /// None is enough.
    #[serde(with = "unbreakable")]
    Unbreakable,
    /// As given, Pa.
    Pascals(Positive),
}

impl Strength {
    /// The number itself, Pa; infinite if it never breaks.
    #[must_use]
    pub fn get(self) -> f64 {
        match self {
            Strength::Unbreakable => f64::INFINITY,
            Strength::Pascals(number) => number.get(),
        }
    }
}

impl JsonSchema for Strength {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Strength".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "const": "unbreakable" }, { "type": "number", "exclusiveMinimum": 0.0 }] })
    }
}

/// Defaults that are numbers of these types.
pub(super) const fn positive(value: f64) -> Positive {
    Positive(value)
}
pub(crate) const fn non_negative(value: f64) -> NonNegative {
    NonNegative(value)
}
pub(super) const fn fraction(value: f64) -> Fraction {
    Fraction(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_no_sense_cannot_be_built() {
        assert!(Positive::try_from(0.0).is_err());
        assert!(Positive::try_from(f64::NAN).is_err());
        assert!(Positive::try_from(f64::INFINITY).is_err());
        assert!(NonNegative::try_from(-1.0).is_err());
        assert!(Fraction::try_from(1.0).is_ok());
        assert!(PoissonRatio::try_from(0.51).is_err());
    }
}
