//! The catalogued pairs of `tests/data/form_factors.toml`.

use fredholm_mesh::{Patch, Vec3};

/// A pair with its exact factor.
pub struct Case {
    pub name: String,
    pub a: Patch,
    pub b: Patch,
    /// F_ab.
    pub factor: f64,
    /// Digits that the catalogue gives, as a relative error.
    pub digits: f64,
    /// Points a direction with which `area-gauss` has ten digits.
    pub order: usize,
}

/// Name, points a direction for ten digits of `area-gauss`, digits of the catalogue.
const NOTES: [(&str, usize, f64); 7] = [
    ("parallel_unit_squares", 10, 1e-12),
    ("parallel_2x3_h1", 24, 1e-12),
    ("parallel_unit_h01", 64, 1e-12),
    ("perpendicular_unit_shared_edge", 14, 1e-12),
    ("offset_parallel", 12, 1e-12),
    ("offset_perpendicular", 10, 1e-12),
    ("triangle_parallel", 10, 1e-9),
];

/// All seven.
pub fn cases() -> Vec<Case> {
    let table: toml::Table = include_str!("../data/form_factors.toml").parse().unwrap();
    let read = |case: &toml::Value| {
        let name = case["name"].as_str().unwrap().to_owned();
        let &(_, order, digits) = NOTES.iter().find(|note| note.0 == name).unwrap();
        let factor = case["f_ab"].as_float().unwrap();
        Case { name, a: patch(&case["a"]), b: patch(&case["b"]), factor, digits, order }
    };
    table["case"].as_array().unwrap().iter().map(read).collect()
}

fn patch(corners: &toml::Value) -> Patch {
    let number = |x: &toml::Value| x.as_float().or(x.as_integer().map(|i| i as f64)).unwrap();
    let point = |p: &toml::Value| Vec3::new(number(&p[0]), number(&p[1]), number(&p[2]));
    let corners: Vec<Vec3> = corners.as_array().unwrap().iter().map(point).collect();
    match *corners {
        [a, b, c] => Patch::triangle([a, b, c]).unwrap(),
        [a, b, c, d] => Patch::quad([a, b, c, d]).unwrap().unwrap(),
        _ => panic!("a patch has three or four corners"),
    }
}
