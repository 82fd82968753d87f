//! Mitsuba 3: a PLY file of triangles a surface, diffuse BSDFs, area emitters, a perspective sensor.

use std::fmt::Write;

use super::{Exported, Outline, OutlineMaterial, OutlineSurface, triangles, words};
use crate::resolve::Camera;

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    // No two things may have the same id: surfaces keep their names, materials get a number where need be.
    let surfaces = outline.surfaces.iter().map(|surface| surface.name.as_str());
    let mut names = words(surfaces.chain(outline.materials.iter().map(|material| material.name.as_str())));
    let materials = names.split_off(outline.surfaces.len());
    let mut notes =
        vec!["Mitsuba computes in f32: coordinates and colours are rounded to 7 digits".to_owned()];
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
    let point = |p: fredholm_mesh::Vec3| format!("{}, {}, {}", p.x, p.y, p.z);
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
