//! The catalogued pairs of `tests/data/form_factors.toml`.

use fredholm_mesh::{Patch, Vec3};

/// A pair with its exact factor.
pub struct Case {
    pub name: String,
    pub a: Patch,
    pub b: Patch,
    /// F_ab.
    pub factor: f64,
    /// Points a direction with which `area-gauss` has ten digits.
    pub order: usize,
}

/// Name, and points a direction for ten digits of `area-gauss`.
const ORDERS: [(&str, usize); 7] = [
    ("parallel_unit_squares", 10),
    ("parallel_2x3_h1", 24),
    ("parallel_unit_h01", 64),
    ("perpendicular_unit_shared_edge", 14),
    ("offset_parallel", 12),
    ("offset_perpendicular", 10),
    ("triangle_parallel", 10),
];

/// Of this case the catalogue has ten digits; nested quadrature in arbitrary precision has more.
const TRIANGLES: (&str, f64) = ("triangle_parallel", 0.115_049_228_149_610_5);

/// All seven.
pub fn cases() -> Vec<Case> {
    let table: toml::Table = include_str!("../data/form_factors.toml").parse().unwrap();
    let read = |case: &toml::Value| {
        let name = case["name"].as_str().unwrap().to_owned();
        let &(_, order) = ORDERS.iter().find(|note| note.0 == name).unwrap();
        let printed = case["f_ab"].as_float().unwrap();
        let factor = if name == TRIANGLES.0 { TRIANGLES.1 } else { printed };
        assert!((factor - printed).abs() < 1e-10);
        Case { name, a: patch(&case["a"]), b: patch(&case["b"]), factor, order }
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
