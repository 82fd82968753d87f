//! Values that can be written in several ways.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::format::At;

/// Defines how a value is read and what its schema is: `$type`, in words, as it is in the schema,
/// and what each way of writing becomes.
macro_rules! choice {
    ($type:ident, $name:literal, $words:literal, { $($schema:tt)* }, { $($method:tt)* }) => {
        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                struct Ways;
                impl<'de> Visitor<'de> for Ways {
                    type Value = $type;

                    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                        f.write_str($words)
                    }

                    $($method)*
                }
                deserializer.deserialize_any(Ways)
            }
        }

        impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({ $($schema)* })
            }
        }
    };
}

/// Frequencies, Hz.
#[derive(Debug)]
pub(crate) enum FrequenciesEntry {
    List(Vec<At<f64>>),
    Sweep(SweepEntry),
}

/// How the frequencies of a sweep are spaced.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Spacing {
    /// Equal steps.
    #[default]
    Linear,
    /// Equal ratios.
    Logarithmic,
}

/// Frequencies from one to another, both included.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table of a sweep")]
pub(crate) struct SweepEntry {
    pub from: At<f64>,
    pub to: At<f64>,
    pub points: At<u32>,
    #[serde(default)]
    pub spacing: Spacing,
}

choice!(
    FrequenciesEntry,
    "Frequencies",
    "a list of frequencies or a table { from, to, points }",
    {
        "anyOf": [
            { "type": "array", "items": { "type": "number" }, "minItems": 1 },
            {
                "type": "object",
                "properties": {
                    "from": { "type": "number", "description": "First frequency, Hz." },
                    "to": { "type": "number", "description": "Last frequency, Hz." },
                    "points": { "type": "integer", "minimum": 1, "description": "How many." },
                    "spacing": {
                        "enum": ["linear", "logarithmic"],
                        "default": "linear",
                        "description": "Equal steps, or equal ratios. Default: linear."
                    }
                },
                "required": ["from", "to", "points"],
                "additionalProperties": false
            }
        ]
    },
    {
        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<FrequenciesEntry, A::Error> {
            Deserialize::deserialize(SeqAccessDeserializer::new(list)).map(FrequenciesEntry::List)
        }

        fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<FrequenciesEntry, A::Error> {
            Deserialize::deserialize(MapAccessDeserializer::new(table)).map(FrequenciesEntry::Sweep)
        }
    }
);

/// A vector, or "theta" or "phi" for θ̂ or φ̂ of the direction that the wave comes from.
#[derive(Debug)]
pub(crate) enum PolarisationEntry {
    Vector([f64; 3]),
    Name(String),
}

choice!(
    PolarisationEntry,
    "Polarisation",
    "a vector, \"theta\" or \"phi\"",
    {
        "anyOf": [
            { "enum": ["theta", "phi"] },
            { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 }
        ]
    },
    {
        fn visit_str<E: Error>(self, name: &str) -> Result<PolarisationEntry, E> {
            Ok(PolarisationEntry::Name(name.to_owned()))
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<PolarisationEntry, A::Error> {
            Deserialize::deserialize(SeqAccessDeserializer::new(list)).map(PolarisationEntry::Vector)
        }
    }
);

/// A resistance, or an impedance [real, imaginary], Ω.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ResistanceEntry(pub [f64; 2]);

choice!(
    ResistanceEntry,
    "Resistance",
    "a resistance in ohms or [real, imaginary]",
    {
        "anyOf": [
            { "type": "number", "minimum": 0 },
            { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 }
        ]
    },
    {
        fn visit_f64<E: Error>(self, resistance: f64) -> Result<ResistanceEntry, E> {
            Ok(ResistanceEntry([resistance, 0.0]))
        }

        fn visit_i64<E: Error>(self, resistance: i64) -> Result<ResistanceEntry, E> {
            Ok(ResistanceEntry([resistance as f64, 0.0]))
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<ResistanceEntry, A::Error> {
            Deserialize::deserialize(SeqAccessDeserializer::new(list)).map(ResistanceEntry)
        }
    }
);

/// A length in metres, or a part of the wavelength.
#[derive(Debug)]
pub(crate) enum EdgeEntry {
    Metres(f64),
    Text(String),
}

choice!(
    EdgeEntry,
    "Edge",
    "a length in metres, or a part of the wavelength such as \"lambda/10\"",
    {
        "anyOf": [
            { "type": "number", "exclusiveMinimum": 0 },
            { "type": "string", "pattern": "^lambda(/[0-9.]+)?$" }
        ]
    },
    {
        fn visit_f64<E: Error>(self, length: f64) -> Result<EdgeEntry, E> {
            Ok(EdgeEntry::Metres(length))
        }

        fn visit_i64<E: Error>(self, length: i64) -> Result<EdgeEntry, E> {
            Ok(EdgeEntry::Metres(length as f64))
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<EdgeEntry, E> {
            Ok(EdgeEntry::Text(text.to_owned()))
        }
    }
);

/// Angles, degrees: one, listed, or evenly spaced with both ends included.
#[derive(Clone, Debug)]
pub(crate) enum AnglesEntry {
    One(f64),
    List(Vec<f64>),
    Range(RangeEntry),
}

/// Angles from one to another, both included.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table of angles")]
pub(crate) struct RangeEntry {
    pub from: f64,
    pub to: f64,
    pub points: u32,
}

choice!(
    AnglesEntry,
    "Angles",
    "an angle, a list of angles or a table { from, to, points }",
    {
        "anyOf": [
            { "type": "number" },
            { "type": "array", "items": { "type": "number" } },
            {
                "type": "object",
                "properties": {
                    "from": { "type": "number", "description": "First angle, degrees." },
                    "to": { "type": "number", "description": "Last angle, degrees." },
                    "points": { "type": "integer", "minimum": 1, "description": "How many." }
                },
                "required": ["from", "to", "points"],
                "additionalProperties": false
            }
        ]
    },
    {
        fn visit_f64<E: Error>(self, angle: f64) -> Result<AnglesEntry, E> {
            Ok(AnglesEntry::One(angle))
        }

        fn visit_i64<E: Error>(self, angle: i64) -> Result<AnglesEntry, E> {
            Ok(AnglesEntry::One(angle as f64))
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<AnglesEntry, A::Error> {
            Deserialize::deserialize(SeqAccessDeserializer::new(list)).map(AnglesEntry::List)
        }

        fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<AnglesEntry, A::Error> {
            Deserialize::deserialize(MapAccessDeserializer::new(table)).map(AnglesEntry::Range)
        }
    }
);
