//! pbrt-v4: triangle meshes, diffuse materials, diffuse area lights, a perspective camera.
//!
//! Format: M. Pharr, W. Jakob, G. Humphreys, pbrt-v4 input file format. Camera space is
//! left-handed, hence the scale by −1 along x; the angle of view is that along the shorter side of
//! the picture.

use std::fmt::Write;

use super::radiance::two_sided;
use super::{Exported, Merged, Outline, fan, triple};
use crate::resolve::Camera;

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let mut text = "Integrator \"path\" \"integer maxdepth\" 1000 \"bool regularize\" false\n".to_owned();
    text.push_str("Sampler \"independent\" \"integer pixelsamples\" 256\nPixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\n");
    text.push_str(&outline.camera.as_ref().map(|camera| view(camera, stem)).unwrap_or_default());
    text.push_str("WorldBegin\n");
    // Writing to a string cannot fail.
    for surface in &outline.surfaces {
        let material = &outline.materials[surface.material];
        let _ = writeln!(
            text,
            "AttributeBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ {} ]",
            triple(material.reflectance)
        );
        if material.emits() {
            let both = surface.back.is_some_and(|back| outline.materials[back].emits());
            let radiance = triple(material.radiance());
            let _ = writeln!(
                text,
                "AreaLightSource \"diffuse\" \"rgb L\" [ {radiance} ] \"bool twosided\" {both}"
            );
        }
        let mut merged = Merged::default();
        let mut corners = vec![];
        for face in &surface.faces {
            corners.extend(fan(&merged.face(face)).flatten().map(|k| k.to_string()));
        }
        let places: Vec<String> = merged.places.iter().map(|p| triple(p.to_array())).collect();
        let (places, corners) = (places.join("  "), corners.join(" "));
        let _ = writeln!(
            text,
            "Shape \"trianglemesh\" \"point3 P\" [ {places} ] \"integer indices\" [ {corners} ]\nAttributeEnd"
        );
    }
    let mut notes = two_sided(outline, "pbrt");
    notes.push(
        "pbrt computes with spectra: colours that are not grey come out a little different after reflections"
            .to_owned(),
    );
    Exported { files: vec![(format!("{stem}.pbrt"), text.into_bytes())], notes }
}

fn view(camera: &Camera, stem: &str) -> String {
    let half = (0.5 * camera.vertical_fov_degrees).to_radians().tan();
    let aspect = f64::from(camera.width) / f64::from(camera.height);
    let shorter = 2.0 * (half * aspect.min(1.0)).atan().to_degrees();
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(|p| triple(p.to_array()));
    format!(
        "Scale -1 1 1\nLookAt {eye}  {target}  {up}\nCamera \"perspective\" \"float fov\" {shorter}\n\
         Film \"rgb\" \"integer xresolution\" {} \"integer yresolution\" {} \"string filename\" \"{stem}.exr\"\n",
        camera.width, camera.height
    )
}
