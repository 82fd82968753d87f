//! Binary glTF 2.0: a node and a mesh a surface, diffuse materials, the camera.

use fredholm_mesh::Vec3;
use serde_json::{Value, json};

use super::{Exported, Merged, Outline, OutlineMaterial, fan};

pub(super) fn export(outline: &Outline, stem: &str) -> Exported {
    let mut parts = Parts::default();
    for (name, material, faces) in &outline.sides() {
        parts.surface(name, *material, faces);
    }
    let materials: Vec<Value> = outline.materials.iter().map(material).collect();
    let emits = outline.materials.iter().any(OutlineMaterial::emits);
    let Parts { blob, views, accessors, meshes, nodes } = parts;
    let roots: Vec<usize> = (0..nodes.len()).collect();
    let mut json = json!({
        "asset": { "version": "2.0", "generator": "Fredholm" },
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": blob.len() }],
    });
    if emits {
        json["extensionsUsed"] = json!(["KHR_materials_emissive_strength"]);
    }
    let mut notes = vec!["glTF holds f32: coordinates and colours are rounded to 7 digits".to_owned()];
    if outline.camera.is_some() {
        notes.push("the camera is not written".to_owned());
    }
    Exported { files: vec![(format!("{stem}.glb"), container(&json, &blob))], notes }
}

/// Radiance is `emissiveFactor`, which is at most 1, times a strength.
fn material(material: &OutlineMaterial) -> Value {
    let [r, g, b] = material.reflectance;
    let mut entry = json!({
        "name": material.name,
        "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1], "metallicFactor": 0, "roughnessFactor": 1 },
    });
    if material.emits() {
        let radiance = material.radiance();
        let strength = radiance.iter().copied().fold(0.0, f64::max).max(1.0);
        entry["emissiveFactor"] = json!(radiance.map(|l| l / strength));
        entry["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
    }
    entry
}

#[derive(Default)]
struct Parts {
    blob: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl Parts {
    fn surface(&mut self, name: &str, material: usize, faces: &[Vec<Vec3>]) {
        let mut merged = Merged::default();
        let mut indices: Vec<u32> = vec![];
        for face in faces {
            indices.extend(fan(&merged.face(face)).flatten().map(|k| k as u32));
        }
        let places: Vec<[f32; 3]> = merged.places.iter().map(|p| p.to_array().map(|x| x as f32)).collect();
        let bound = |pick: fn(f32, f32) -> f32| {
            [0, 1, 2].map(|axis| places.iter().map(|p| p[axis]).reduce(pick).unwrap_or(0.0))
        };
        let (min, max) = (bound(f32::min), bound(f32::max));
        let view = |target: u32, offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length, "target": target });
        self.views.push(view(34962, self.blob.len(), 12 * places.len()));
        self.blob.extend(places.iter().flatten().flat_map(|x| x.to_le_bytes()));
        self.views.push(view(34963, self.blob.len(), 4 * indices.len()));
        self.blob.extend(indices.iter().flat_map(|k| k.to_le_bytes()));
        let first = self.accessors.len();
        self.accessors.push(json!({
            "bufferView": first, "componentType": 5126, "count": places.len(), "type": "VEC3", "min": min, "max": max,
        }));
        self.accessors.push(json!({
            "bufferView": first + 1, "componentType": 5125, "count": indices.len(), "type": "SCALAR",
        }));
        let primitive =
            json!({ "attributes": { "POSITION": first }, "indices": first + 1, "material": material });
        self.nodes.push(json!({ "name": name, "mesh": self.meshes.len() }));
        self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
    }
}

/// A header, the JSON text and the numbers, each filled up to a multiple of four bytes.
fn container(json: &Value, blob: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + blob.len();
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((length as u32).to_le_bytes());
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend((blob.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(blob);
    bytes
}
