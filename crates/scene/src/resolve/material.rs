//! Materials: reflectance ρ in [0, 1), so that B = M + ρ E has a solution, and exitance M ≥ 0 in
//! W/m².

use std::ops::Range;

use super::number::short;
use crate::error::{ErrorKind, SceneError};
use crate::format::{At, MaterialEntry, PerBand, SceneEntry};
use crate::source::Source;
use crate::suggest::among;

/// A diffuse material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the scene.
    pub name: String,
    /// Reflectance for each band, dimensionless, in [0, 1).
    pub reflectance: Vec<f64>,
    /// Exitance for each band, W/m².
    pub exitance: Vec<f64>,
}

/// A range that the numbers of a quantity must lie in.
struct Quantity {
    name: &'static str,
    allowed: fn(f64) -> bool,
    help: &'static str,
}

const REFLECTANCE: Quantity = Quantity {
    name: "reflectance",
    allowed: |r| (0.0..1.0).contains(&r),
    help: "write a number from 0 to below 1: no surface reflects more than it receives",
};

const EXITANCE: Quantity = Quantity {
    name: "exitance",
    // Powers, their sums and their squares stay finite.
    allowed: |m| (0.0..=1e100).contains(&m),
    help: "write a number of W/m² from 0 to 1e100",
};

pub(super) fn materials(
    source: &Source,
    entry: &SceneEntry,
    bands: &[String],
) -> Result<Vec<Material>, SceneError> {
    let material = |(name, entry)| material(source, name, entry, bands);
    entry.materials.iter().map(material).collect()
}

fn material(
    source: &Source,
    name: &At<String>,
    entry: &MaterialEntry,
    bands: &[String],
) -> Result<Material, SceneError> {
    let reflectance = per_band(source, &entry.reflectance, bands, &REFLECTANCE)?;
    let exitance = match &entry.exitance {
        Some(exitance) => per_band(source, exitance, bands, &EXITANCE)?,
        None => vec![0.0; bands.len()],
    };
    Ok(Material { name: String::clone(name), reflectance, exitance })
}

fn per_band(
    source: &Source,
    values: &At<PerBand>,
    bands: &[String],
    quantity: &Quantity,
) -> Result<Vec<f64>, SceneError> {
    let check = |value: f64, span| check(source, value, span, quantity);
    match &**values {
        PerBand::All(value) => Ok(vec![check(*value, values.span())?; bands.len()]),
        PerBand::List(list) if list.len() == bands.len() => {
            list.iter().map(|value| check(**value, value.span())).collect()
        }
        PerBand::List(list) => Err(wrong_length(source, values, list.len(), bands, quantity)),
        PerBand::Table(table) => {
            unknown_band(source, table.keys(), bands)?;
            let lookup = |band: &String| match table.iter().find(|(name, _)| ***name == *band) {
                Some((_, value)) => check(**value, value.span()),
                None => Err(missing_band(source, values, band, quantity)),
            };
            bands.iter().map(lookup).collect()
        }
    }
}

fn check(source: &Source, value: f64, span: Range<usize>, quantity: &Quantity) -> Result<f64, SceneError> {
    if (quantity.allowed)(value) {
        return Ok(value);
    }
    let what = format!("{} {} is out of range", quantity.name, short(value));
    Err(source.error(ErrorKind::Value, span, what, quantity.help))
}

fn wrong_length(
    source: &Source,
    values: &At<PerBand>,
    found: usize,
    bands: &[String],
    quantity: &Quantity,
) -> SceneError {
    let what = format!(
        "{} has {found} values, but the scene has {} bands: {}",
        quantity.name,
        bands.len(),
        bands.join(", ")
    );
    let help = "write one value for each band, or one number for all of them";
    source.error(ErrorKind::Type, values.span(), what, help)
}

fn unknown_band<'a>(
    source: &Source,
    mut names: impl Iterator<Item = &'a At<String>>,
    bands: &[String],
) -> Result<(), SceneError> {
    let Some(name) = names.find(|name| !bands.contains(name)) else { return Ok(()) };
    let what = format!("the scene has no band `{}`", **name);
    let help = among(name, bands.iter().map(String::as_str), "bands");
    Err(source.error(ErrorKind::Name, name.span(), what, help))
}

fn missing_band(source: &Source, values: &At<PerBand>, band: &str, quantity: &Quantity) -> SceneError {
    let what = format!("{} has no value for the band `{band}`", quantity.name);
    source.error(ErrorKind::MissingKey, values.span(), what, format!("add `{band}` to this table"))
}
