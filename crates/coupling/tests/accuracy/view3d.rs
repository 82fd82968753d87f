//! The corners and surfaces of View3D files (`V n x y z`, `S n v1 v2 v3 v4 …`, corners counted from
//! 1 and v4 = 0 for triangles).

use fredholm_mesh::{Patch, Vec3};

/// A file of tests/data/viewfactors.
pub fn read(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/viewfactors");
    std::fs::read_to_string(format!("{folder}/{name}")).unwrap()
}

/// The surfaces of a file as patches.
pub fn patches(name: &str) -> Vec<Patch> {
    let text = read(name);
    let corners: Vec<Vec3> =
        numbers(&text, "V").iter().map(|line| Vec3::new(line[1], line[2], line[3])).collect();
    let quad = |line: &Vec<f64>| {
        let at = |k: usize| corners[line[k] as usize - 1];
        Patch::quad([at(1), at(2), at(3), at(4)]).unwrap().unwrap()
    };
    numbers(&text, "S").iter().map(quad).collect()
}

/// The numbers of the lines that start with `key`, up to the first word.
fn numbers(text: &str, key: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter_map(|line| line.strip_prefix(key));
    lines.map(|line| line.split_whitespace().map_while(|word| word.parse().ok()).collect()).collect()
}
