//! How records are read back: a number that is not finite is `null` in JSON, and NaN again when it
//! is read.

use serde::{Deserialize, Deserializer};

/// A number, or NaN for `null`.
pub(crate) fn number<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Option::<f64>::deserialize(source).map(|value| value.unwrap_or(f64::NAN))
}

/// A list of them.
pub(crate) fn row<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<f64>, D::Error> {
    Vec::<Option<f64>>::deserialize(source).map(numbers)
}

/// A list of such lists.
pub(crate) fn rows<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<Vec<f64>>, D::Error> {
    let rows = Vec::<Vec<Option<f64>>>::deserialize(source)?;
    Ok(rows.into_iter().map(numbers).collect())
}

fn numbers(row: Vec<Option<f64>>) -> Vec<f64> {
    row.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect()
}
