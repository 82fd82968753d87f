//! Wavefront OBJ with a material library: an object a surface, `Kd` the reflectance, `Ke` the
//! radiance.

use std::fmt::Write;

use super::{Exported, Merged, Outline, triple, words};

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let library = format!("{stem}.mtl");
    let materials = words(outline.materials.iter().map(|material| material.name.as_str()));
    let mut mtl = String::new();
    // Writing to a string cannot fail.
    for (material, name) in outline.materials.iter().zip(&materials) {
        let _ = writeln!(mtl, "newmtl {name}\nKd {}", triple(material.reflectance));
        if material.emits() {
            let _ = writeln!(mtl, "Ke {}", triple(material.radiance()));
        }
    }
    let (mut merged, mut faces) = (Merged::default(), String::new());
    let sides = outline.sides();
    let names = words(sides.iter().map(|(name, ..)| name.as_str()));
    for ((_, material, polygons), name) in sides.iter().zip(names) {
        let _ = writeln!(faces, "o {name}\nusemtl {}", materials[*material]);
        for face in polygons {
            let indices: Vec<String> = merged.face(face).iter().map(|k| (k + 1).to_string()).collect();
            let _ = writeln!(faces, "f {}", indices.join(" "));
        }
    }
    let mut text = format!("mtllib {}\n", library.replace(char::is_whitespace, "_"));
    for corner in &merged.places {
        let _ = writeln!(text, "v {}", triple(corner.to_array()));
    }
    text.push_str(&faces);
    let library = library.replace(char::is_whitespace, "_");
    let files = vec![(format!("{stem}.obj"), text.into_bytes()), (library, mtl.into_bytes())];
    Exported { files, notes: vec![] }
}
