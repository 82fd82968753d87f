//! Binary STL: triangles in f32.

use fredholm_mesh::Vec3;

use super::{Exported, Outline};

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let mut triangles: Vec<[Vec3; 3]> = vec![];
    for (_, _, faces) in outline.sides() {
        for face in faces {
            triangles.extend(face[1..].windows(2).map(|side| [face[0], side[0], side[1]]));
        }
    }
    let mut bytes = b"binary STL, metres".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in &triangles {
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for vector in [normal, a, b, c] {
            vector.to_array().iter().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    let mut notes = outline.without_materials("STL");
    notes.push(
        "STL holds f32: coordinates are rounded to 7 digits, and names of surfaces are left out".to_owned(),
    );
    Exported { files: vec![(format!("{stem}.stl"), bytes)], notes }
}
