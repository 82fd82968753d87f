//! Radiance: plastic without specularity, light, polygons, and a view file.

use std::fmt::Write;

use super::{Exported, Outline, triple, words};

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let materials = words(outline.materials.iter().map(|material| material.name.as_str()));
    let (mut text, mut notes) = (String::new(), vec![]);
    // Writing to a string cannot fail.
    for (material, name) in outline.materials.iter().zip(&materials) {
        let _ = if material.emits() {
            writeln!(text, "void light {name}\n0\n0\n3 {}", triple(material.radiance()))
        } else {
            writeln!(text, "void plastic {name}\n0\n0\n5 {} 0 0", triple(material.reflectance))
        };
        if material.emits() && material.reflectance.iter().any(|&r| r > 0.0) {
            notes
                .push(format!("light reflects nothing in Radiance: the reflectance of `{name}` is left out"));
        }
    }
    let names = words(outline.surfaces.iter().map(|surface| surface.name.as_str()));
    for (surface, name) in outline.surfaces.iter().zip(names) {
        for (k, face) in surface.faces.iter().enumerate() {
            let _ = writeln!(
                text,
                "{} polygon {name}.{}\n0\n0\n{}",
                materials[surface.material],
                k + 1,
                3 * face.len()
            );
            for corner in face {
                let _ = writeln!(text, "{}", triple(corner.to_array()));
            }
        }
    }
    notes.extend(two_sided(outline, "Radiance"));
    let mut files = vec![(format!("{stem}.rad"), text.into_bytes())];
    if let Some(camera) = &outline.camera {
        let half = (0.5 * camera.vertical_fov_degrees).to_radians().tan();
        let width = 2.0 * (half * f64::from(camera.width) / f64::from(camera.height)).atan().to_degrees();
        let ahead = (camera.target - camera.eye).to_array();
        let view = format!(
            "rvu -vtv -vp {} -vd {} -vu {} -vh {width} -vv {}\n",
            triple(camera.eye.to_array()),
            triple(ahead),
            triple(camera.up.to_array()),
            camera.vertical_fov_degrees
        );
        files.push((format!("{stem}.vf"), view.into_bytes()));
    }
    Exported { files, notes }
}

/// What is said of a format whose surfaces reflect on both sides.
pub(super) fn two_sided(outline: &Outline, format: &str) -> Vec<String> {
    let mut notes = vec![format!(
        "surfaces reflect on both sides in {format}: where light reaches the backs of one-sided surfaces, the light differs"
    )];
    let other = |back: &Option<usize>, front: usize| back.is_some_and(|back| back != front);
    if outline.surfaces.iter().any(|surface| other(&surface.back, surface.material)) {
        notes.push("backs have the material of the front".to_owned());
    }
    notes
}
