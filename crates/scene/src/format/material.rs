//! A material, as it is written.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, PerBand};

/// A diffuse (Lambertian) material.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of a material")]
#[schemars(rename = "Material")]
pub(crate) struct MaterialEntry {
    /// Share of the arriving light that is reflected: from 0 to below 1. One number for all bands,
    /// a list in the order of the bands, or a table by band name.
    pub reflectance: At<PerBand>,
    /// Power that the surface emits by itself, W/m², at least 0; its radiance is exitance/π. One
    /// number for all bands, a list in the order of the bands, or a table by band name. Default: 0.
    pub exitance: Option<At<PerBand>>,
}
