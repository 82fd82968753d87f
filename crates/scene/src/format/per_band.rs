//! A number for every band, in one of three ways of writing.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::At;

/// One number for all bands, a list in the order of the bands, or a table by band name.
#[derive(Debug)]
pub(crate) enum PerBand {
    All(f64),
    List(Vec<At<f64>>),
    Table(BTreeMap<At<String>, At<f64>>),
}

impl<'de> Deserialize<'de> for PerBand {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PerBandVisitor)
    }
}

struct PerBandVisitor;

impl<'de> Visitor<'de> for PerBandVisitor {
    type Value = PerBand;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a list in the order of the bands or a table by band name")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<PerBand, E> {
        Ok(PerBand::All(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<PerBand, E> {
        Ok(PerBand::All(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<PerBand, E> {
        Ok(PerBand::All(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<PerBand, A::Error> {
        Deserialize::deserialize(SeqAccessDeserializer::new(list)).map(PerBand::List)
    }

    fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<PerBand, A::Error> {
        Deserialize::deserialize(MapAccessDeserializer::new(table)).map(PerBand::Table)
    }
}

impl JsonSchema for PerBand {
    fn schema_name() -> Cow<'static, str> {
        "PerBand".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "One number for all bands, a list in the order of the bands, or a table by band name.",
            "anyOf": [
                { "type": "number" },
                { "type": "array", "items": { "type": "number" } },
                { "type": "object", "additionalProperties": { "type": "number" } }
            ]
        })
    }
}
