//! Numbers in their ranges.

use fredholm_mesh::Vec3;

use crate::error::{ErrorKind, SceneError};
use crate::format::{At, Triple};
use crate::source::Source;

/// Largest coordinate, metres: its cube, and the product of two areas, are far from the end of the
/// numbers.
pub(crate) const LARGEST_COORDINATE: f64 = 1e30;

/// A number without rows of zeros.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

impl Source {
    /// An error about a value that is not allowed.
    pub fn value_error<T>(&self, value: &At<T>, what: String, help: &str) -> SceneError {
        self.error(ErrorKind::Value, value.span(), what, help)
    }

    /// A finite number.
    pub fn finite(&self, number: &At<f64>, quantity: &str) -> Result<f64, SceneError> {
        if number.is_finite() {
            return Ok(**number);
        }
        let what = format!("{quantity} is {}, not a finite number", **number);
        Err(self.value_error(number, what, "write a number between -1.7e308 and 1.7e308"))
    }

    /// A finite number above 0.
    pub fn positive(&self, number: &At<f64>, quantity: &str) -> Result<f64, SceneError> {
        let value = self.finite(number, quantity)?;
        if value > 0.0 {
            return Ok(value);
        }
        let what = format!("{quantity} is {}, but must be above 0", short(value));
        Err(self.value_error(number, what, "write a number above 0"))
    }

    /// A number above 0 and below `limit`.
    pub fn below(&self, number: &At<f64>, limit: f64, quantity: &str) -> Result<f64, SceneError> {
        let value = self.positive(number, quantity)?;
        if value < limit {
            return Ok(value);
        }
        let what = format!("{quantity} is {}, but must be below {limit}", short(value));
        Err(self.value_error(number, what, &format!("write a number between 0 and {limit}")))
    }

    /// A point or vector.
    pub fn vector(&self, triple: &Triple, quantity: &str) -> Result<Vec3, SceneError> {
        let [x, y, z] = &**triple;
        let coordinate = |number| self.coordinate(number, quantity);
        Ok(Vec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?))
    }

    /// A length above 0.
    pub fn length(&self, number: &At<f64>, quantity: &str) -> Result<f64, SceneError> {
        self.positive(number, quantity)?;
        self.coordinate(number, quantity)
    }

    fn coordinate(&self, number: &At<f64>, quantity: &str) -> Result<f64, SceneError> {
        let value = self.finite(number, quantity)?;
        if value.abs() <= LARGEST_COORDINATE {
            return Ok(value);
        }
        let what = format!("{quantity} is {value:e} m, too large to compute with");
        Err(self.value_error(number, what, &format!("stay within {LARGEST_COORDINATE:e} m of 0")))
    }

    /// A vector that is not zero.
    pub fn direction(&self, triple: &Triple, quantity: &str) -> Result<Vec3, SceneError> {
        let vector = self.vector(triple, quantity)?;
        let length = vector.length();
        if length > 0.0 && length.is_finite() {
            return Ok(vector);
        }
        let what = format!("{quantity} has the length {length}, so it points nowhere");
        Err(self.value_error(triple, what, "write a direction such as [0, 0, 1]"))
    }
}
