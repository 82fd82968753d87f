//! Binary PLY, little endian, f64: faces with the number of their surface.

use fredholm_mesh::Vec3;

use super::{Exported, Merged, Outline};

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let sides = outline.sides();
    let faces = sides
        .iter()
        .enumerate()
        .flat_map(|(k, (_, _, faces))| faces.iter().map(move |face| (k, face.as_slice())));
    let names: Vec<&str> = sides.iter().map(|(name, ..)| name.as_str()).collect();
    let bytes = write(faces, &names);
    let mut notes = outline.without_materials("PLY");
    notes.push(
        "PLY holds no names: the property surface of a face counts the surfaces, which comments name"
            .to_owned(),
    );
    Exported { files: vec![(format!("{stem}.ply"), bytes)], notes }
}

/// Faces with numbers of surfaces of these names.
pub(super) fn write<'a>(faces: impl Iterator<Item = (usize, &'a [Vec3])>, names: &[&str]) -> Vec<u8> {
    let (mut merged, mut body, mut count) = (Merged::default(), vec![], 0);
    for (surface, face) in faces {
        // Faces have three or four corners.
        body.push(face.len() as u8);
        merged.face(face).iter().for_each(|k| body.extend((*k as i32).to_le_bytes()));
        if !names.is_empty() {
            body.extend((surface as i32).to_le_bytes());
        }
        count += 1;
    }
    let mut head = "ply\nformat binary_little_endian 1.0\n".to_owned();
    for (k, name) in names.iter().enumerate() {
        head.push_str(&format!("comment surface {k} {name}\n"));
    }
    head.push_str(&format!("element vertex {}\n", merged.places.len()));
    head.push_str("property double x\nproperty double y\nproperty double z\n");
    head.push_str(&format!("element face {count}\nproperty list uchar int vertex_indices\n"));
    head.push_str(if names.is_empty() { "" } else { "property int surface\n" });
    head.push_str("end_header\n");
    let mut bytes = head.into_bytes();
    for corner in &merged.places {
        corner.to_array().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    bytes.extend(body);
    bytes
}
