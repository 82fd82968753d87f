//! glTF 2.0, as JSON (.gltf) or binary (.glb): the triangles of the meshes at the nodes of the
//! scene.
//!
//! Format: Khronos Group, glTF 2.0 Specification (ISO/IEC 12113:2022). Lengths are metres. A point
//! of a mesh comes to stand at G p, where G is the product of the matrices of the nodes from the
//! root; where its determinant is negative, the corners run the other way round (§3.7.4). The
//! reflectance is `baseColorFactor`; `emissiveFactor`, times the strength of
//! `KHR_materials_emissive_strength`, is the radiance. Pictures, skins, morph targets and lights
//! without a surface are not read, which is told.

use std::collections::BTreeSet;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fredholm_mesh::Vec3;

use super::cursor::{Cursor, Encoding, Scalar};
use super::json::{self, Json};
use super::{Group, Imported, Input, MeshMaterial, Name, Note, check_faces, face};
use crate::error::{ErrorKind, SceneError};
use crate::source::Source;

/// Extensions that a file may require: they change nothing that is read, or are read.
const KNOWN_EXTENSIONS: [&str; 8] = [
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_materials_specular",
    "KHR_materials_ior",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
];
/// Most nodes, counted along all ways from a root: a file of a few lines could name each twice.
const MOST_NODES: usize = 1_000_000;
/// "JSON" and "BIN\0" as numbers, little endian.
const JSON_CHUNK: u64 = 0x4E4F_534A;
const BIN_CHUNK: u64 = 0x004E_4942;

pub(super) fn import(input: Input, bytes: Vec<u8>) -> Result<Imported, SceneError> {
    if bytes.starts_with(b"glTF") {
        let source = Arc::new(Source::binary(input.path));
        let (text, base, blob) = chunks(&source, &bytes)?;
        let json = json::parse(&source, text, base)?;
        return read(Arc::clone(&source), &json, Some(blob), input);
    }
    let source = Source::decode(input.path, bytes)?;
    let json = json::parse(&source, &source.text, 0)?;
    read(Arc::new(source), &json, None, input)
}

/// The JSON text of a binary file, where it begins, and the binary chunk.
fn chunks<'a>(source: &'a Source, bytes: &'a [u8]) -> Result<(&'a str, usize, &'a [u8]), SceneError> {
    let mut cursor = Cursor::new(source, bytes, Encoding::Little);
    let word = |cursor: &mut Cursor<'a>, what: &str| cursor.number(Scalar::U32, what).map(|x| x as u64);
    cursor.take(4, "the magic number")?;
    let version = word(&mut cursor, "the version")?;
    if version != 2 {
        return Err(cursor.error(4, format!("glTF of version {version}"), "write the file as glTF 2.0"));
    }
    let length = word(&mut cursor, "the length")?;
    if length > bytes.len() as u64 {
        let what = format!("the header promises {length} bytes, but the file has {}", bytes.len());
        return Err(cursor.error(8, what, "the file was cut short: copy or write it anew"));
    }
    let (size, kind) =
        (word(&mut cursor, "the length of a chunk")?, word(&mut cursor, "the type of a chunk")?);
    if kind != JSON_CHUNK {
        return Err(cursor.error(16, "the first chunk is not JSON", "write the file anew"));
    }
    let base = cursor.at;
    let text = cursor.take(size as usize, "the JSON chunk")?;
    let text = std::str::from_utf8(text).map_err(|error| {
        let at = base + error.valid_up_to();
        source.error(ErrorKind::Format, at..at + 1, "this is not UTF-8 text", "write the file anew")
    })?;
    if cursor.at == bytes.len() {
        return Ok((text, base, &[]));
    }
    let (size, kind) =
        (word(&mut cursor, "the length of a chunk")?, word(&mut cursor, "the type of a chunk")?);
    let blob = if kind == BIN_CHUNK { cursor.take(size as usize, "the binary chunk")? } else { &[] };
    Ok((text, base, blob))
}

fn read(
    source: Arc<Source>,
    json: &Json,
    blob: Option<&[u8]>,
    mut input: Input,
) -> Result<Imported, SceneError> {
    let file = File { source: &source, json };
    file.check_head()?;
    let mut notes = vec![];
    file.told(&mut notes);
    let buffers = file.buffers(blob, &mut input)?;
    let materials = file.materials()?;
    let mut reader =
        Reader { file: &file, buffers, materials: &materials, groups: vec![], visited: 0, faces: 0 };
    reader.scene()?;
    let groups = reader.groups;
    Ok(Imported { materials, notes, ..Imported::new(source, groups) })
}

/// The file as JSON.
struct File<'a> {
    source: &'a Source,
    json: &'a Json,
}

impl<'a> File<'a> {
    fn error(&self, json: &Json, what: impl AsRef<str>, help: &str) -> SceneError {
        self.source.error(ErrorKind::Value, json.span.clone(), what, help)
    }

    fn check_head(&self) -> Result<(), SceneError> {
        let version = self.json.get("asset").and_then(|asset| asset.get("version"));
        match version.and_then(Json::text) {
            Some(version) if version.starts_with("2.") => {}
            _ => {
                let place = version.unwrap_or(self.json);
                return Err(self.error(place, "the asset has no version 2", "give a glTF 2.0 file"));
            }
        }
        let required = self.json.get("extensionsRequired").and_then(Json::list).unwrap_or_default();
        let unknown =
            required.iter().find(|name| name.text().is_none_or(|name| !KNOWN_EXTENSIONS.contains(&name)));
        let Some(name) = unknown else { return Ok(()) };
        let what = format!("the file requires the extension `{}`", name.text().unwrap_or_default());
        let help = "it is not read: export the file without it, such as without compression";
        Err(self.error(name, what, help))
    }

    /// Says what is in the file and not read.
    fn told(&self, notes: &mut Vec<Note>) {
        let mut tell = |place: &Json, what: &str, help: &str| {
            let (span, what, help) = (place.span.clone(), what.to_owned(), help.to_owned());
            notes.push(Note { span, what, help });
        };
        let lights = self.json.get("extensions").and_then(|all| all.get("KHR_lights_punctual"));
        if let Some(lights) = lights {
            tell(lights, "lights without a surface are not read", "give a surface an emission instead");
        }
        if let Some(skins) = self.json.get("skins") {
            tell(skins, "skins are not read: meshes stand as they are stored", "export the pose as a mesh");
        }
    }

    /// The table number `index` of a list of the file.
    fn item(&self, list: &str, index: &Json) -> Result<&'a Json, SceneError> {
        let all = self.json.get(list).and_then(Json::list).unwrap_or_default();
        index.whole().and_then(|index| all.get(index)).ok_or_else(|| {
            let what = format!("`{list}` has {} entries, counted from 0, and not this one", all.len());
            self.error(index, what, "mend the number, or write the file anew")
        })
    }

    fn member(&self, table: &'a Json, key: &str) -> Result<&'a Json, SceneError> {
        table.get(key).ok_or_else(|| {
            self.error(table, format!("the key `{key}` is missing here"), "add it, or write the file anew")
        })
    }

    /// A whole number of a table; 0 where it may be left out.
    fn whole(&self, table: &'a Json, key: &str, must: bool) -> Result<usize, SceneError> {
        let value = if must {
            self.member(table, key)?
        } else {
            let Some(value) = table.get(key) else { return Ok(0) };
            value
        };
        value
            .whole()
            .ok_or_else(|| self.error(value, format!("`{key}` is no whole number"), "write one, 0 or more"))
    }

    fn vector<const N: usize>(&self, table: &Json, key: &str) -> Result<Option<[f64; N]>, SceneError> {
        let Some(value) = table.get(key) else { return Ok(None) };
        let found = value.numbers().ok_or_else(|| {
            self.error(value, format!("`{key}` is not a list of {N} numbers"), "write so many finite numbers")
        })?;
        Ok(Some(found))
    }

    fn buffers(&self, blob: Option<&[u8]>, input: &mut Input) -> Result<Vec<Vec<u8>>, SceneError> {
        let all = self.json.get("buffers").and_then(Json::list).unwrap_or_default();
        let buffer = |(number, buffer)| self.buffer(number, buffer, blob, input);
        all.iter().enumerate().map(buffer).collect()
    }

    fn buffer(
        &self,
        number: usize,
        buffer: &'a Json,
        blob: Option<&[u8]>,
        input: &mut Input,
    ) -> Result<Vec<u8>, SceneError> {
        let length = self.whole(buffer, "byteLength", true)?;
        let bytes = match (buffer.get("uri"), blob) {
            (None, Some(blob)) if number == 0 => blob.to_vec(),
            (None, _) => {
                return Err(self.error(
                    buffer,
                    "a buffer without `uri`",
                    "name its file, or write the file anew",
                ));
            }
            (Some(uri), _) => self.uri(uri, input)?,
        };
        if bytes.len() < length {
            let what = format!("the buffer promises {length} bytes, but {} are there", bytes.len());
            return Err(self.error(buffer, what, "the file was cut short: copy or write it anew"));
        }
        Ok(bytes)
    }

    fn uri(&self, uri: &Json, input: &mut Input) -> Result<Vec<u8>, SceneError> {
        let text = uri.text().unwrap_or_default();
        if let Some((_, data)) = text.strip_prefix("data:").and_then(|data| data.split_once(";base64,")) {
            return STANDARD.decode(data).map_err(|error| {
                let error = format!("the data of the buffer are not base64: {error}");
                self.error(uri, error, "write the file anew")
            });
        }
        let name = input.name.with_file_name(percent_decoded(text));
        input.files.load(&name).map_err(|error| {
            let what = format!("cannot read the buffer `{text}`: {error}");
            let help = "put it beside the file that names it";
            self.source.error(ErrorKind::Io, uri.span.clone(), what, help).caused_by(error)
        })
    }

    fn materials(&self) -> Result<Vec<MeshMaterial>, SceneError> {
        let all = self.json.get("materials").and_then(Json::list).unwrap_or_default();
        all.iter().enumerate().map(|(number, entry)| self.material(number, entry)).collect()
    }

    fn material(&self, number: usize, entry: &'a Json) -> Result<MeshMaterial, SceneError> {
        let surface = entry.get("pbrMetallicRoughness");
        let base = surface.and_then(|surface| Some((surface, surface.get("baseColorFactor")?)));
        let diffuse = match base {
            Some((surface, place)) => {
                let colour = self.vector::<4>(surface, "baseColorFactor")?;
                colour.map(|[r, g, b, _]| ([r, g, b], place.span.clone()))
            }
            None => None,
        };
        let strength = entry.get("extensions").and_then(|all| all.get("KHR_materials_emissive_strength"));
        let strength = strength.and_then(|table| table.get("emissiveStrength")).and_then(Json::number);
        let emission = match (self.vector::<3>(entry, "emissiveFactor")?, entry.get("emissiveFactor")) {
            (Some(colour), Some(place)) => {
                Some((colour.map(|value| value * strength.unwrap_or(1.0)), place.span.clone()))
            }
            _ => None,
        };
        let picture = surface.and_then(|surface| surface.get("baseColorTexture"));
        let picture = picture.map(|_| "baseColorTexture".to_owned());
        let name = self.material_name(number, entry);
        Ok(MeshMaterial { name, diffuse, emission, picture, span: entry.span.clone() })
    }

    /// The name of a material, with its number where others have the same.
    fn material_name(&self, number: usize, entry: &Json) -> String {
        let all = self.json.get("materials").and_then(Json::list).unwrap_or_default();
        let name = |entry: &Json| entry.get("name").and_then(Json::text).map(str::to_owned);
        let of = name(entry).filter(|text| !text.is_empty());
        let same = all[..number].iter().filter(|other| name(other) == of).count();
        match (of, same) {
            (Some(name), 0) => name,
            (Some(name), _) => format!("{name} {number}"),
            (None, _) => format!("material {number}"),
        }
    }
}

/// A matrix that takes points to where they stand, row by row.
type Matrix = [[f64; 4]; 3];

struct Reader<'a> {
    file: &'a File<'a>,
    buffers: Vec<Vec<u8>>,
    materials: &'a [MeshMaterial],
    groups: Vec<Group>,
    visited: usize,
    faces: usize,
}

impl<'a> Reader<'a> {
    /// The nodes of the scene that is shown first; of all roots where the file has no scene.
    fn scene(&mut self) -> Result<(), SceneError> {
        let (file, json) = (self.file, self.file.json);
        let scenes = json.get("scenes").and_then(Json::list).unwrap_or_default();
        let scene = match json.get("scene") {
            Some(index) => Some(file.item("scenes", index)?),
            None => scenes.first(),
        };
        let all = json.get("nodes").and_then(Json::list).unwrap_or_default();
        let roots: Vec<&'a Json> = if let Some(scene) = scene {
            let list = scene.get("nodes").and_then(Json::list).unwrap_or_default();
            list.iter().map(|index| file.item("nodes", index)).collect::<Result<_, _>>()?
        } else {
            let children = |node: &'a Json| node.get("children").and_then(Json::list).unwrap_or_default();
            let inner: BTreeSet<usize> = all.iter().flat_map(children).filter_map(Json::whole).collect();
            (0..all.len()).filter(|k| !inner.contains(k)).map(|k| &all[k]).collect()
        };
        let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let mut open: Vec<(&Json, Matrix)> = roots.into_iter().rev().map(|node| (node, identity)).collect();
        // Depth first with a stack of its own: nodes may be nested as deep as the file is long.
        while let Some((node, parent)) = open.pop() {
            self.visited += 1;
            if self.visited > MOST_NODES {
                let help = "a node must have one parent, and none of its children may be above it";
                return Err(file.error(node, format!("more than {MOST_NODES} nodes"), help));
            }
            let matrix = product(&parent, &self.local(node)?);
            if let Some(index) = node.get("mesh") {
                self.mesh(node, file.item("meshes", index)?, &matrix)?;
            }
            let children = node.get("children").and_then(Json::list).unwrap_or_default();
            for index in children.iter().rev() {
                open.push((file.item("nodes", index)?, matrix));
            }
        }
        Ok(())
    }

    fn local(&self, node: &Json) -> Result<Matrix, SceneError> {
        if let Some(m) = self.file.vector::<16>(node, "matrix")? {
            return Ok([0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| m[4 * column + row])));
        }
        let translation = self.file.vector(node, "translation")?.unwrap_or([0.0; 3]);
        let scale = self.file.vector(node, "scale")?.unwrap_or([1.0; 3]);
        let [x, y, z, w] = self.file.vector(node, "rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        // Rotation by a unit quaternion, §3.6.2.
        let turn = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        let row = |i: usize| {
            let [a, b, c] = [0, 1, 2].map(|j| turn[i][j] * scale[j]);
            [a, b, c, translation[i]]
        };
        Ok([row(0), row(1), row(2)])
    }

    fn mesh(&mut self, node: &Json, mesh: &'a Json, matrix: &Matrix) -> Result<(), SceneError> {
        let name = |json: &Json| {
            json.get("name").and_then(Json::text).filter(|text| !text.is_empty()).map(str::to_owned)
        };
        let object = name(node).or_else(|| name(mesh));
        let object = object.map(|object| self.unused(object));
        let primitives = self.file.member(mesh, "primitives")?;
        for primitive in primitives.list().unwrap_or_default() {
            let group = self.primitive(object.clone(), primitive, matrix)?;
            self.groups.extend(group);
        }
        Ok(())
    }

    /// The name, with a number behind it where an earlier node has the same.
    fn unused(&self, name: String) -> String {
        let taken = |name: &str| self.groups.iter().any(|group| group.object.as_deref() == Some(name));
        if !taken(&name) {
            return name;
        }
        format!("{name} {}", self.visited)
    }

    fn primitive(
        &mut self,
        object: Option<String>,
        primitive: &'a Json,
        matrix: &Matrix,
    ) -> Result<Option<Group>, SceneError> {
        let file = self.file;
        let mode = primitive.get("mode").map_or(Ok(4), |_| file.whole(primitive, "mode", true))?;
        // Points and lines have no area.
        if mode < 4 {
            return Ok(None);
        }
        let place = file.member(file.member(primitive, "attributes")?, "POSITION")?;
        let vertices = self.vertices(place, matrix)?;
        let indices = match primitive.get("indices") {
            Some(place) => self.accessor(place, 1)?.into_iter().map(|index| index as u64).collect(),
            None => (0..vertices.len() as u64).collect::<Vec<_>>(),
        };
        let span = primitive.get("indices").unwrap_or(primitive).span.clone();
        self.faces += indices.len() / 3;
        check_faces(file.source, self.faces, span.clone())?;
        let mut faces = vec![];
        for corners in triangles(mode, &indices, is_mirrored(matrix)) {
            faces.push(face(file.source, &vertices, &corners, span.clone())?);
        }
        let (material, two_sided) = self.material(primitive)?;
        Ok(Some(Group { object, material, faces, two_sided }))
    }

    fn material(&self, primitive: &Json) -> Result<(Option<Name>, bool), SceneError> {
        let Some(index) = primitive.get("material") else { return Ok((None, false)) };
        let entry = self.file.item("materials", index)?;
        let text = index.whole().and_then(|index| self.materials.get(index)).map(|m| m.name.clone());
        let two_sided = entry.get("doubleSided").and_then(Json::bool).unwrap_or(false);
        Ok((text.map(|text| Name { text, span: index.span.clone() }), two_sided))
    }

    fn vertices(&self, place: &'a Json, matrix: &Matrix) -> Result<Vec<Vec3>, SceneError> {
        let values = self.accessor(place, 3)?;
        let point = |p: &[f64]| {
            let coordinate = |row: [f64; 4]| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
            Vec3::from_array(matrix.map(coordinate))
        };
        let vertices: Vec<Vec3> = values.chunks_exact(3).map(point).collect();
        if let Some(k) = vertices.iter().position(|point| !point.is_finite()) {
            let what = format!("the position of vertex {k} is not finite");
            return Err(self.file.error(place, what, "mend the numbers or the matrix of the node"));
        }
        Ok(vertices)
    }

    /// The numbers of an accessor of so many components, one after the other.
    fn accessor(&self, place: &'a Json, components: usize) -> Result<Vec<f64>, SceneError> {
        let file = self.file;
        let accessor = file.item("accessors", place)?;
        let expected = if components == 1 { "SCALAR" } else { "VEC3" };
        let kind = file.member(accessor, "type")?;
        if kind.text() != Some(expected) {
            return Err(file.error(kind, format!("the type should be {expected}"), "write the file anew"));
        }
        let scalar = scalar(file.whole(accessor, "componentType", true)?).ok_or_else(|| {
            file.error(accessor, "unknown `componentType`", "write 5120 to 5126 as the specification says")
        })?;
        if components == 1 && !scalar.is_whole() {
            return Err(file.error(
                accessor,
                "indices must be whole numbers",
                "write componentType 5121, 5123 or 5125",
            ));
        }
        let count = file.whole(accessor, "count", true)?;
        let layout = Layout { scalar, components, count };
        let mut values = match accessor.get("bufferView") {
            Some(view) => self.values(view, accessor, &layout)?,
            None if accessor.get("sparse").is_some() => self.zeros(accessor, &layout)?,
            None => return Err(file.error(accessor, "an accessor without `bufferView`", "name its numbers")),
        };
        if let Some(sparse) = accessor.get("sparse") {
            self.replace(sparse, &layout, &mut values)?;
        }
        if accessor.get("normalized").and_then(Json::bool) == Some(true) && scalar.is_whole() {
            let signed = i32::from(matches!(scalar, Scalar::I8 | Scalar::I16 | Scalar::I32));
            let largest = 2.0_f64.powi(8 * scalar.size() as i32 - signed) - 1.0;
            for value in &mut values {
                *value = (*value / largest).max(-1.0);
            }
        }
        Ok(values)
    }

    /// Zeros, of which there may be no more than the file could name one by one.
    fn zeros(&self, accessor: &Json, layout: &Layout) -> Result<Vec<f64>, SceneError> {
        let there: usize = self.buffers.iter().map(Vec::len).sum();
        if layout.count > there {
            let what = format!("{} zeros in a file whose buffers hold {there} bytes", layout.count);
            return Err(self.file.error(accessor, what, "write the numbers into a buffer"));
        }
        Ok(vec![0.0; layout.count * layout.components])
    }

    fn values(&self, view: &'a Json, accessor: &'a Json, layout: &Layout) -> Result<Vec<f64>, SceneError> {
        let file = self.file;
        let table = file.item("bufferViews", view)?;
        let buffer = file.member(table, "buffer")?;
        file.item("buffers", buffer)?;
        let bytes = buffer.whole().and_then(|k| self.buffers.get(k)).map(Vec::as_slice).unwrap_or_default();
        let start = file.whole(table, "byteOffset", false)?;
        let length = file.whole(table, "byteLength", true)?;
        let own = layout.scalar.size() * layout.components;
        let stride = file.whole(table, "byteStride", false)?;
        let stride = if stride == 0 { own } else { stride };
        let offset = file.whole(accessor, "byteOffset", false)?;
        let bytes = start.checked_add(length).and_then(|end| bytes.get(start..end));
        let bytes = bytes
            .ok_or_else(|| file.error(table, "this view reaches beyond its buffer", "write the file anew"))?;
        let last = layout.count.saturating_sub(1) as u128 * stride as u128;
        if layout.count > 0 && offset as u128 + last + own as u128 > length as u128 {
            let what = format!("{} numbers reach beyond the {length} bytes of their view", layout.count);
            return Err(file.error(accessor, what, "lower `count`, or write the file anew"));
        }
        let size = layout.scalar.size();
        let at = |k: usize| offset + (k / layout.components) * stride + (k % layout.components) * size;
        Ok((0..layout.count * layout.components).map(|k| layout.scalar.of_little(&bytes[at(k)..])).collect())
    }

    fn replace(&self, sparse: &'a Json, layout: &Layout, values: &mut [f64]) -> Result<(), SceneError> {
        let file = self.file;
        let count = file.whole(sparse, "count", true)?;
        let (places, new) = (file.member(sparse, "indices")?, file.member(sparse, "values")?);
        let kind = scalar(file.whole(places, "componentType", true)?).filter(|kind| kind.is_whole());
        let kind =
            kind.ok_or_else(|| file.error(places, "unknown `componentType`", "write 5121, 5123 or 5125"))?;
        let indices = Layout { scalar: kind, components: 1, count };
        let indices = self.values(file.member(places, "bufferView")?, places, &indices)?;
        let layout = Layout { count, ..*layout };
        let numbers = self.values(file.member(new, "bufferView")?, new, &layout)?;
        let n = layout.components;
        for (index, row) in indices.iter().zip(numbers.chunks_exact(n)) {
            let at = *index as usize * n;
            let target = values.get_mut(at..at + n).ok_or_else(|| {
                file.error(sparse, format!("there is no entry {index} to replace"), "write the file anew")
            })?;
            target.copy_from_slice(row);
        }
        Ok(())
    }
}

/// How the numbers of an accessor lie.
struct Layout {
    scalar: Scalar,
    components: usize,
    count: usize,
}

/// Kinds of numbers by `componentType`.
fn scalar(code: usize) -> Option<Scalar> {
    Some(match code {
        5120 => Scalar::I8,
        5121 => Scalar::U8,
        5122 => Scalar::I16,
        5123 => Scalar::U16,
        5125 => Scalar::U32,
        5126 => Scalar::F32,
        _ => return None,
    })
}

/// The triangles of a list (4), a strip (5) or a fan (6), turned where the matrix mirrors.
fn triangles(mode: usize, indices: &[u64], mirrored: bool) -> Vec<[u64; 3]> {
    let corners: Vec<[u64; 3]> = match mode {
        4 => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        5 => {
            let strip = indices.windows(3).enumerate();
            strip.map(|(k, c)| if k % 2 == 0 { [c[0], c[1], c[2]] } else { [c[0], c[2], c[1]] }).collect()
        }
        _ => indices.get(1..).unwrap_or_default().windows(2).map(|c| [indices[0], c[0], c[1]]).collect(),
    };
    corners.into_iter().map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] }).collect()
}

fn is_mirrored(m: &Matrix) -> bool {
    let row = |k: usize| Vec3::new(m[k][0], m[k][1], m[k][2]);
    row(0).cross(row(1)).dot(row(2)) < 0.0
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| {
        let sum: f64 = (0..3).map(|k| a[i][k] * b[k][j]).sum();
        if j == 3 { sum + a[i][3] } else { sum }
    };
    [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| entry(i, j)))
}

/// A reference in which `%20` stands for a blank (RFC 3986).
fn percent_decoded(text: &str) -> String {
    let mut bytes = vec![];
    let mut rest = text.as_bytes();
    while let [first, tail @ ..] = rest {
        let digits = tail.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let code = digits.and_then(|two| u8::from_str_radix(two, 16).ok()).filter(|_| *first == b'%');
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::Place;
    use crate::files::Files;
    use std::path::Path;

    fn embedded() -> String {
        let positions: Vec<u8> =
            [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let mut all = positions;
        all.extend([0, 1, 2, 0]);
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
 "nodes": [{{"translation": [0, 0, 2], "children": [1]}},
  {{"name": "plate", "mesh": 0, "scale": [-1, 2, 1]}}],
 "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}],
 "materials": [{{"name": "lamp", "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
   "extensions": {{"KHR_materials_emissive_strength": {{"emissiveStrength": 4}}}},
   "pbrMetallicRoughness": {{"baseColorFactor": [0.25, 0.5, 0.75, 1]}}}}],
 "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}},
  {{"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"}}],
 "bufferViews": [{{"buffer": 0, "byteLength": 36}}, {{"buffer": 0, "byteOffset": 36, "byteLength": 3}}],
 "buffers": [{{"byteLength": 40, "uri": "data:application/octet-stream;base64,{}"}}]}}"#,
            STANDARD.encode(&all)
        )
    }

    fn read(bytes: &[u8]) -> Result<Imported, SceneError> {
        let (name, mut files) = (Path::new("a.gltf"), Files::beside(Path::new("a.gltf")));
        import(Input { name, path: name, files: &mut files }, bytes.to_vec())
    }

    #[test]
    fn nodes_place_meshes_and_mirrors_turn_them() {
        let found = read(embedded().as_bytes()).unwrap();
        let group = &found.groups[0];
        assert_eq!((group.object.as_deref(), group.two_sided), (Some("plate"), true));
        let expected = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(0.0, 2.0, 2.0), Vec3::new(-1.0, 0.0, 2.0)];
        assert_eq!(group.faces[0].corners, expected);
        let material = &found.materials[0];
        assert_eq!(material.diffuse.as_ref().unwrap().0, [0.25, 0.5, 0.75]);
        let (emission, span) = material.emission.clone().unwrap();
        assert_eq!((emission, &embedded()[span]), ([4.0, 2.0, 0.0], "[1, 0.5, 0]"));
    }

    #[test]
    fn errors_name_the_line_or_the_byte() {
        for (from, to, line) in [
            ("\"indices\": 1", "\"indices\": 7", 4),
            ("\"count\": 3, \"type\": \"VEC3\"", "\"count\": 4000000000, \"type\": \"VEC3\"", 8),
            ("[0, 0, 2]", "[0, 0]", 2),
            ("\"byteLength\": 40", "\"byteLength\": 4000000000", 11),
            ("\"children\": [1]", "\"children\": [0]", 2),
            ("5121", "5126", 9),
            ("base64,", "base64,!", 11),
        ] {
            let error = read(embedded().replacen(from, to, 1).as_bytes()).unwrap_err();
            assert!(
                matches!(error.place(), Some(Place::Line { line: found, .. }) if found == line),
                "{error}"
            );
        }
        let glb = [&b"glTF"[..], &2_u32.to_le_bytes(), &4_000_000_000_u32.to_le_bytes()].concat();
        assert_eq!(read(&glb).unwrap_err().place(), Some(Place::Byte(8)));
    }

    #[test]
    fn strips_and_fans_are_triangles_that_turn_one_way() {
        assert_eq!(triangles(5, &[0, 1, 2, 3], false), [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(triangles(6, &[0, 1, 2, 3], true), [[0, 2, 1], [0, 3, 2]]);
    }

    #[test]
    fn names_of_buffers_may_hold_blanks() {
        assert_eq!(percent_decoded("a%20b%2.bin%"), "a b%2.bin%");
    }
}
