//! The stored references and how results are compared with them.

#![allow(dead_code, reason = "every test file uses its part")]

use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{Complex64, Wave};
use std::path::Path;

/// λ at 1 GHz, m.
pub const WAVELENGTH: f64 = 0.299_792_458;

/// The wave of the references.
pub fn wave() -> Wave {
    Wave::new(1e9).unwrap()
}

/// Its source: E = ẑ e^{−jky}.
pub fn source() -> PlaneWave {
    PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap()
}

/// The receivers: 25 m away, a degree apart.
pub fn circle() -> Vec<Vec3> {
    let point = |degree: i32| {
        let (sin, cos) = f64::from(degree).to_radians().sin_cos();
        Vec3::new(25.0 * cos, 25.0 * sin, 0.0)
    };
    (0..360).map(point).collect()
}

/// Column `column` (mom, mie, poM, poJ) of a reference.
pub fn reference(name: &str, column: &str) -> Vec<Complex64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/wave").join(name);
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let [re, im] = ["re", "im"]
        .map(|part| header.iter().position(|title| *title == format!("{column}_{part}_Ez")).unwrap());
    let value = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        Complex64::new(numbers[re], numbers[im])
    };
    let values: Vec<Complex64> = lines.map(value).collect();
    assert_eq!(values.len(), 360);
    values
}

/// ‖a − b‖₂/‖b‖₂.
pub fn relative_error(a: &[Complex64], b: &[Complex64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr()).sum();
    (difference / b.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt()
}
