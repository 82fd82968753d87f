//! `field.ply` and `field.glb`: the elements with the light on them as colours of their corners.
//!
//! The radiosity of the corners is that of [`crate::nodal`]; its colour is that of the picture:
//! exposed so that the mean of log luminance over all elements but lamps becomes mid grey, and
//! compressed.
//!
//! PLY (G. Turk, The PLY Polygon File Format, 1994; binary, little endian): vertices `x y z` (m,
//! f64) and `red green blue` (sRGB, 0 to 255); faces, one an element, with `element`, `face`,
//! `surface` (numbers from 0) and band by band `irradiance_BAND`, `radiosity_BAND` (W/m², f64), the
//! values of the elements.
//!
//! GLB (Khronos Group, glTF 2.0 Specification): a node and a mesh a surface, unlit, with `COLOR_0`
//! (linear, 0 to 1) and `_RADIOSITY` (linear red, green and blue, W/m²), both f32.

use std::io::{self, Write};

use fredholm_mesh::{Anchored, Welded};
use serde_json::{Value, json};

use crate::colour::{Colouring, Rgb};
use crate::nodal::{SMOOTH_WELD, close, vertex_values};
use crate::tone::{Tone, encode, luminance};
use crate::{Exposure, Field, ReportError};

/// The elements with colours at their corners.
struct Baked {
    polygons: Welded,
    /// Radiosity as linear sRGB, W/m².
    radiosity: Vec<Rgb>,
    /// Linear display values.
    display: Vec<Rgb>,
}

impl Baked {
    fn new(field: &Field<'_>, exposure: Exposure) -> Result<Self, ReportError> {
        let (mesh, colouring) = (field.mesh(), Colouring::new(field.bands()));
        let leaves: Vec<Rgb> =
            (0..mesh.len()).map(|k| colouring.colour(&field.exposed_radiosity(k))).collect();
        let Anchored { leaves: welded, polygons, hanging, .. } = mesh.anchored(SMOOTH_WELD);
        let of_leaves = (leaves.as_flattened(), 3);
        let mut radiosity = vertex_values(mesh, &welded, of_leaves, |leaf| field.exposed(leaf));
        close(&hanging, &mut radiosity, 3);
        let radiosity: Vec<Rgb> = radiosity.as_chunks().0.to_vec();
        let dull = leaves.iter().enumerate().filter(|(leaf, _)| !field.emits(*leaf));
        let metered: Vec<f64> = dull.map(|(_, colour)| luminance(*colour)).collect();
        let tone = Tone::new(exposure, &metered)?;
        let display = radiosity.iter().map(|&colour| tone.display(colour)).collect();
        Ok(Self { polygons, radiosity, display })
    }
}

/// Writes the elements as PLY.
///
/// # Errors
/// What `out` reports; an exposure that is no positive number as [`io::ErrorKind::InvalidInput`].
pub fn write_field_ply(field: &Field<'_>, exposure: Exposure, out: &mut dyn Write) -> io::Result<()> {
    let baked = Baked::new(field, exposure).map_err(invalid)?;
    let Baked { polygons, display, .. } = &baked;
    writeln!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment lengths in m, irradiance and radiosity in W/m2"
    )?;
    writeln!(out, "element vertex {}", polygons.vertices.len())?;
    for (kind, name) in [("double", "x y z"), ("uchar", "red green blue")] {
        name.split(' ').try_for_each(|name| writeln!(out, "property {kind} {name}"))?;
    }
    writeln!(out, "element face {}\nproperty list ushort int vertex_indices", polygons.len())?;
    ["element", "face", "surface"].iter().try_for_each(|name| writeln!(out, "property int {name}"))?;
    for band in field.bands() {
        writeln!(out, "property double irradiance_{band}\nproperty double radiosity_{band}")?;
    }
    writeln!(out, "end_header")?;
    for (place, colour) in polygons.vertices.iter().zip(display) {
        place.to_array().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
        out.write_all(&colour.map(encode))?;
    }
    let mesh = field.mesh();
    for (leaf, corners) in polygons.patches().enumerate() {
        out.write_all(&(corners.len() as u16).to_le_bytes())?;
        corners.iter().try_for_each(|&k| out.write_all(&(k as i32).to_le_bytes()))?;
        for number in [leaf, mesh.face_of(leaf), mesh.surface_of(leaf)] {
            out.write_all(&(number as i32).to_le_bytes())?;
        }
        let (irradiance, radiosity) =
            (field.row(field.irradiance(), leaf), field.row(field.radiosity(), leaf));
        for (e, b) in irradiance.iter().zip(radiosity) {
            out.write_all(&e.to_le_bytes())?;
            out.write_all(&b.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Writes the elements as binary glTF.
///
/// # Errors
/// As for [`write_field_ply`].
pub fn write_field_glb(field: &Field<'_>, exposure: Exposure, out: &mut dyn Write) -> io::Result<()> {
    let baked = Baked::new(field, exposure).map_err(invalid)?;
    let places: Vec<[f32; 3]> = single(baked.polygons.vertices.iter().map(fredholm_mesh::Vec3::to_array));
    let (display, radiosity) =
        (single(baked.display.iter().copied()), single(baked.radiosity.iter().copied()));
    let mut blob: Vec<u8> = vec![];
    let (mut views, mut accessors) = (vec![], vec![]);
    for values in [&places, &display, &radiosity] {
        let offset = blob.len();
        views.push(
            json!({ "buffer": 0, "byteOffset": offset, "byteLength": 12 * values.len(), "target": 34962 }),
        );
        let mut accessor = json!({ "bufferView": accessors.len(), "componentType": 5126, "count": values.len(), "type": "VEC3" });
        if offset == 0 {
            accessor["min"] = json!(bound(values, f32::min));
            accessor["max"] = json!(bound(values, f32::max));
        }
        accessors.push(accessor);
        blob.extend(values.iter().flatten().flat_map(|x| x.to_le_bytes()));
    }
    let (mut meshes, mut nodes) = (vec![], vec![]);
    for (surface, indices) in triangles(field, &baked.polygons).into_iter().enumerate() {
        if indices.is_empty() {
            continue;
        }
        let (offset, number, name) = (blob.len(), accessors.len(), &field.mesh().surfaces()[surface].name);
        views.push(
            json!({ "buffer": 0, "byteOffset": offset, "byteLength": 4 * indices.len(), "target": 34963 }),
        );
        accessors.push(
            json!({ "bufferView": number, "componentType": 5125, "count": indices.len(), "type": "SCALAR" }),
        );
        blob.extend(indices.iter().flat_map(|k| k.to_le_bytes()));
        let attributes = json!({ "POSITION": 0, "COLOR_0": 1, "_RADIOSITY": 2 });
        let primitive = json!({ "attributes": attributes, "indices": number, "material": 0 });
        nodes.push(json!({ "name": name, "mesh": meshes.len() }));
        meshes.push(json!({ "name": name, "primitives": [primitive] }));
    }
    let roots: Vec<usize> = (0..nodes.len()).collect();
    let json = json!({
        "asset": { "version": "2.0", "generator": "Fredholm" },
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [{ "name": "radiosity", "extensions": { "KHR_materials_unlit": {} },
            "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 1 } }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": blob.len() }],
    });
    container(&json, &blob, out)
}

/// A header, the JSON text and the numbers, each filled up to a multiple of four bytes.
fn container(json: &Value, blob: &[u8], out: &mut dyn Write) -> io::Result<()> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = u32::try_from(12 + 8 + text.len() + 8 + blob.len());
    let length = length.map_err(|_| io::Error::other("a GLB file can hold no more than 4 GiB"))?;
    out.write_all(b"glTF")?;
    [2, length, text.len() as u32].iter().try_for_each(|word| out.write_all(&word.to_le_bytes()))?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&(blob.len() as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(blob)
}

/// Corners of the triangles of each surface.
fn triangles(field: &Field<'_>, polygons: &Welded) -> Vec<Vec<u32>> {
    let mut indices = vec![vec![]; field.mesh().surfaces().len()];
    for (leaf, corners) in polygons.patches().enumerate() {
        for side in corners[1..].windows(2) {
            let corners = [corners[0], side[0], side[1]].map(|k| k as u32);
            indices[field.mesh().surface_of(leaf)].extend(corners);
        }
    }
    indices
}

fn single(values: impl Iterator<Item = [f64; 3]>) -> Vec<[f32; 3]> {
    values.map(|value| value.map(|x| x as f32)).collect()
}

fn bound(values: &[[f32; 3]], pick: fn(f32, f32) -> f32) -> [f32; 3] {
    [0, 1, 2].map(|axis| values.iter().map(|value| value[axis]).reduce(pick).unwrap_or(0.0))
}

fn invalid(error: ReportError) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{names, sample};

    #[test]
    fn values_stand_where_the_headers_say() {
        let (mesh, bands) = (sample(), names(&["r", "g", "b"]));
        let e: Vec<f64> = (1..=9).map(|k| 0.1 * f64::from(k)).collect();
        let b: Vec<f64> = e.iter().map(|e| 2.0 * e).collect();
        let field = Field::new(&mesh, &bands, &e, &b).unwrap();
        let mut ply = vec![];
        write_field_ply(&field, Exposure::Auto, &mut ply).unwrap();
        // The last face ends in irradiance and radiosity of b.
        let last = |from: usize| f64::from_le_bytes(ply[ply.len() - from..][..8].try_into().unwrap());
        assert_eq!([last(16), last(8)].map(f64::to_bits), [e[8], b[8]].map(f64::to_bits));
        let mut glb = vec![];
        write_field_glb(&field, Exposure::Auto, &mut glb).unwrap();
        let size = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&glb[..4], size(8)), (&b"glTF"[..], glb.len()));
        let json: Value = serde_json::from_slice(&glb[20..20 + size(12)]).unwrap();
        assert_eq!(json["meshes"].as_array().unwrap().len(), 2);
        assert_eq!(json["buffers"][0]["byteLength"], glb.len() - 28 - size(12));
        // The triangle is a surface of its own, so that its corners have its radiosity.
        let blob = &glb[28 + size(12)..];
        let (offset, count) = (json["bufferViews"][2]["byteOffset"].as_u64().unwrap() as usize, 9);
        assert_eq!(json["accessors"][2]["count"], count);
        let red = f32::from_le_bytes(blob[offset + 12 * (count - 1)..][..4].try_into().unwrap());
        assert_eq!(red.to_bits(), (b[6] as f32).to_bits());
    }
}
