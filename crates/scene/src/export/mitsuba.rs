//! Mitsuba 3: a PLY file of triangles a surface, diffuse BSDFs, area emitters, a perspective
//! sensor.

use std::collections::HashMap;
use std::fmt::Write;

use fredholm_mesh::Vec3;

use super::{Exported, Outline, OutlineMaterial, OutlineSurface, triangles, words};
use crate::resolve::Camera;

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let (joined, mut notes) = back_to_back(outline);
    let outline = &joined;
    // No two things may have the same id: surfaces keep their names, materials get a number where
    // need be.
    let surfaces = outline.surfaces.iter().map(|surface| surface.name.as_str());
    let mut names = words(surfaces.chain(outline.materials.iter().map(|material| material.name.as_str())));
    let materials = names.split_off(outline.surfaces.len());
    notes.insert(0, "Mitsuba computes in f32: coordinates and colours are rounded to 7 digits".to_owned());
    let mut text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<scene version=\"3.0.0\">\n".to_owned();
    // Writing to a string cannot fail.
    // Paths have no bound; from rr_depth on they end by chance, which has no bias.
    for (name, value) in [("spp", 256), ("max_depth", -1), ("rr_depth", 8)] {
        let _ = writeln!(text, "  <default name=\"{name}\" value=\"{value}\"/>");
    }
    text.push_str("  <integrator type=\"path\">\n    <integer name=\"max_depth\" value=\"$max_depth\"/>\n");
    text.push_str("    <integer name=\"rr_depth\" value=\"$rr_depth\"/>\n  </integrator>\n");
    text.push_str(&outline.camera.as_ref().map(sensor).unwrap_or_default());
    for (material, id) in outline.materials.iter().zip(&materials) {
        let _ = writeln!(text, "  {}", bsdf(material, &format!(" id=\"{}\"", escaped(id))));
    }
    let mut files = vec![];
    for ((number, surface), id) in outline.surfaces.iter().enumerate().zip(names) {
        let file = format!("{stem}_meshes/{number}.ply");
        let front = &outline.materials[surface.material];
        let _ = writeln!(text, "  <shape type=\"ply\" id=\"{}\">", escaped(&id));
        let _ = writeln!(text, "    <string name=\"filename\" value=\"{}\"/>", escaped(&file));
        text.push_str("    <boolean name=\"face_normals\" value=\"true\"/>\n");
        let _ = writeln!(text, "    {}", reflects(outline, surface, &materials));
        if front.emits() {
            let _ =
                writeln!(text, "    <emitter type=\"area\">{}</emitter>", rgb("radiance", front.radiance()));
        }
        if surface.back.is_some_and(|back| outline.materials[back].emits()) {
            notes.push(format!(
                "area emitters emit on their front only: the back of `{}` does not emit",
                surface.name
            ));
        }
        text.push_str("  </shape>\n");
        files.push((file, triangles(&surface.faces)));
    }
    text.push_str("</scene>\n");
    files.insert(0, (format!("{stem}.xml"), text.into_bytes()));
    Exported { files, notes }
}

/// The same scene, in which two surfaces that lie back to back are one with two sides, and what was
/// done: rays of Mitsuba meet only one of two faces in one place, and would find its black back.
fn back_to_back(outline: &Outline) -> (Outline, Vec<String>) {
    let (mut joined, mut notes) = (Outline { surfaces: vec![], ..outline.clone() }, vec![]);
    let emits = |surface: &OutlineSurface| outline.materials[surface.material].emits();
    // One-sided surfaces by the places of their faces, as indices among the joined ones.
    let mut known: HashMap<Vec<[[u64; 3]; 4]>, usize> = HashMap::new();
    for surface in &outline.surfaces {
        let place = |turned| faces_in_order(&surface.faces, turned);
        let opposite = known.get(&place(true)).copied().filter(|_| surface.back.is_none());
        // An emitter of Mitsuba emits on its front only.
        let front = opposite.map(|k| &mut joined.surfaces[k]).filter(|front| front.back.is_none());
        if let Some(front) = front.filter(|front| !(emits(front) && emits(surface))) {
            let mut back = surface.clone();
            if emits(&back) {
                std::mem::swap(front, &mut back);
            }
            front.back = Some(back.material);
            notes.push(format!("`{}` is written as the back of `{}`", back.name, front.name));
            continue;
        }
        if surface.back.is_none() && !surface.faces.is_empty() {
            known.insert(place(false), joined.surfaces.len());
        }
        joined.surfaces.push(surface.clone());
    }
    (joined, notes)
}

/// Where faces are, whichever comes first and whichever corner each begins with; as seen from
/// behind, if they are turned. The fourth corner of a triangle is its first.
fn faces_in_order(faces: &[Vec<Vec3>], turned: bool) -> Vec<[[u64; 3]; 4]> {
    let place = |face: &Vec<Vec3>| {
        // Both zeros are one.
        let mut corners: Vec<_> =
            face.iter().map(|corner| corner.to_array().map(|x| (x + 0.0).to_bits())).collect();
        if turned {
            corners.reverse();
        }
        let first = (0..corners.len()).min_by_key(|&k| corners[k]).unwrap_or(0);
        corners.rotate_left(first);
        std::array::from_fn(|k| corners[k % corners.len()])
    };
    let mut places: Vec<_> = faces.iter().map(place).collect();
    places.sort_unstable();
    places
}

/// The reflection of a surface: that of its material, or two, where it has a back.
fn reflects(outline: &Outline, surface: &OutlineSurface, ids: &[String]) -> String {
    let Some(back) = surface.back else {
        return format!("<ref id=\"{}\"/>", escaped(&ids[surface.material]));
    };
    let front = format!("<ref id=\"{}\"/>", escaped(&ids[surface.material]));
    let other = if back == surface.material { String::new() } else { bsdf(&outline.materials[back], "") };
    format!("<bsdf type=\"twosided\">{front}{other}</bsdf>")
}

fn bsdf(material: &OutlineMaterial, id: &str) -> String {
    format!("<bsdf type=\"diffuse\"{id}>{}</bsdf>", rgb("reflectance", material.reflectance))
}

fn rgb(name: &str, [r, g, b]: [f64; 3]) -> String {
    format!("<rgb name=\"{name}\" value=\"{r}, {g}, {b}\"/>")
}

fn sensor(camera: &Camera) -> String {
    let point = |p: Vec3| format!("{}, {}, {}", p.x, p.y, p.z);
    format!(
        "  <sensor type=\"perspective\">\n    <string name=\"fov_axis\" value=\"y\"/>\n    <float name=\"fov\" value=\"{}\"/>\n    \
         <transform name=\"to_world\"><lookat origin=\"{}\" target=\"{}\" up=\"{}\"/></transform>\n    \
         <sampler type=\"independent\"><integer name=\"sample_count\" value=\"$spp\"/></sampler>\n    \
         <film type=\"hdrfilm\"><integer name=\"width\" value=\"{}\"/><integer name=\"height\" value=\"{}\"/>\
         <string name=\"pixel_format\" value=\"rgb\"/><string name=\"component_format\" value=\"float32\"/>\
         <rfilter type=\"box\"/></film>\n  </sensor>\n",
        camera.vertical_fov_degrees,
        point(camera.eye),
        point(camera.target),
        point(camera.up),
        camera.width,
        camera.height
    )
}

/// A text fit for an attribute in double quotes.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
