//! The reference: means of the irradiance over 936 faces by particle tracing, pooled over the
//! symmetries of the scene.
//!
//! The eight symmetries of a square map the room onto itself. A class is the faces that they map
//! onto each other; its mean weighs each by 1/σ², σ its standard error. The scatter within the
//! classes is that of the standard errors (χ² = 798 at 810 degrees of freedom), so a class of eight
//! is known √8 times better than one face.

use fredholm_mesh::Vec3;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Faces that the symmetries map onto each other.
pub struct Class {
    /// Surface and centre of one of them.
    pub surface: String,
    pub centre: Vec3,
    /// Number and area (m²) of all of them.
    pub faces: f64,
    pub area: f64,
    /// Mean irradiance with its standard error, W/m².
    pub irradiance: f64,
    pub error: f64,
}

/// Kind of surface, and the coordinates that no symmetry changes, in millionths.
type Key = (String, [i64; 3]);

fn key(surface: &str, centre: Vec3) -> Key {
    let kind = if surface.starts_with("wall") { "wall" } else { surface };
    let whole = |x: f64| (1e6 * x).round() as i64;
    let (a, b) = (whole((centre.x - 0.5).abs()), whole((centre.y - 0.5).abs()));
    (kind.to_owned(), [a.min(b), a.max(b), whole(centre.z)])
}

pub fn classes() -> Vec<Class> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/occluder_reference.csv");
    let text = fs::read_to_string(path).unwrap();
    let mut groups: BTreeMap<Key, Vec<Class>> = BTreeMap::new();
    for face in text.lines().skip(1).map(face) {
        groups.entry(key(&face.surface, face.centre)).or_default().push(face);
    }
    groups.into_values().map(pooled).collect()
}

/// A class of one face.
fn face(line: &str) -> Class {
    let cells: Vec<&str> = line.split(',').collect();
    let number = |at: usize| cells[at].parse::<f64>().unwrap();
    Class {
        surface: cells[0].to_owned(),
        centre: Vec3::new(number(1), number(2), number(3)),
        faces: 1.0,
        area: number(4),
        irradiance: number(5),
        error: number(6),
    }
}

fn pooled(faces: Vec<Class>) -> Class {
    let weight = |face: &Class| face.error.powi(-2);
    let weights: f64 = faces.iter().map(weight).sum();
    let irradiance = faces.iter().map(|face| weight(face) * face.irradiance).sum::<f64>() / weights;
    let (count, area) = (faces.len() as f64, faces.iter().map(|face| face.area).sum());
    let first = faces.into_iter().next().unwrap();
    Class { faces: count, area, irradiance, error: weights.sqrt().recip(), ..first }
}
