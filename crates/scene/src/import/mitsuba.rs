//! Mitsuba 3 scenes (.xml) of diffuse surfaces: rectangles, cubes, OBJ and PLY meshes, area
//! emitters.
//!
//! Format: W. Jakob et al., Mitsuba 3 documentation, "Scene format" and the pages of the plugins.
//! The steps of a transformation are carried out one after the other. A BSDF without a reflectance,
//! and a shape without a BSDF, reflect 0.5. The radiance of an area emitter is taken as it stands.
//! What is not diffuse, lights without a surface, volumes and includes are refused: without them it
//! would be another scene.

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use fredholm_mesh::Vec3;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader as Xml, XmlVersion};

use super::{
    Group, Imported, ImportedFace, Input, MeshMaterial, Name, Note, add_material, check_faces, import as mesh,
};
use crate::error::{ErrorKind, SceneError};
use crate::resolve::Camera;
use crate::source::Source;

/// Deepest nesting of elements.
const DEEPEST_NESTING: usize = 64;
/// Elements that change no surface.
const PASSED_OVER: [&str; 9] =
    ["integrator", "sampler", "rfilter", "film", "string", "integer", "float", "boolean", "default"];
/// Reflectance where a BSDF does not say.
const USUAL_REFLECTANCE: f64 = 0.5;
/// Longest value of an attribute, once defaults are put in: they could double it again and again.
const LONGEST_VALUE: usize = 65_536;
/// Largest picture that is taken over, pixels along a side.
const MOST_PIXELS_A_SIDE: f64 = 16384.0;

/// An element of the text.
#[derive(Debug, Default)]
struct Node {
    tag: String,
    attributes: Vec<(String, String)>,
    children: Vec<Node>,
    span: Range<usize>,
}

impl Node {
    fn get(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    fn kind(&self) -> &str {
        self.get("type").unwrap_or_default()
    }

    /// The child with this name, such as `<float name="fov" …/>`.
    fn named(&self, names: &[&str]) -> Option<&Self> {
        self.children.iter().find(|child| child.get("name").is_some_and(|name| names.contains(&name)))
    }

    fn child(&self, tag: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.tag == tag)
    }
}

pub(super) fn import(input: Input, bytes: Vec<u8>) -> Result<Imported, SceneError> {
    let source = Arc::new(Source::decode(input.path, bytes)?);
    let root = tree(&source)?;
    let mut reader = Reader::new(&source, input);
    reader.scene(&root)?;
    let Reader { groups, materials, notes, camera, .. } = reader;
    Ok(Imported { materials, notes, camera, ..Imported::new(source, groups) })
}

/// The elements of the text, defaults put in for `$name`.
fn tree(source: &Source) -> Result<Node, SceneError> {
    let mut xml = Xml::from_str(&source.text);
    let mut open = vec![Node::default()];
    let mut defaults: Vec<(String, String)> = vec![];
    loop {
        let start = xml.buffer_position() as usize;
        let event = xml.read_event().map_err(|error| {
            let at = xml.error_position() as usize;
            let help = "mend the XML here, or write the file anew";
            source.error(ErrorKind::Syntax, at..at + 1, format!("this is no XML: {error}"), help)
        })?;
        let span = start..xml.buffer_position() as usize;
        match event {
            Event::Start(tag) => {
                open.push(node(source, &tag, span.clone(), &mut defaults)?);
                if open.len() > DEEPEST_NESTING {
                    let what = format!("nested deeper than {DEEPEST_NESTING} levels");
                    return Err(source.error(ErrorKind::Syntax, span, what, "flatten the scene"));
                }
            }
            Event::Empty(tag) => {
                let node = node(source, &tag, span, &mut defaults)?;
                if let Some(parent) = open.last_mut() {
                    parent.children.push(node);
                }
            }
            Event::End(_) => {
                // The reader has checked that the names fit.
                let node = open.pop().unwrap_or_default();
                if let Some(parent) = open.last_mut() {
                    parent.children.push(node);
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    if open.len() > 1 {
        let end = source.text.len();
        let what = format!("the file ends before `</{}>`", open.pop().unwrap_or_default().tag);
        return Err(source.error(ErrorKind::Syntax, end..end, what, "the file was cut short: write it anew"));
    }
    let root = open.pop().unwrap_or_default();
    root.children
        .into_iter()
        .find(|node| node.tag == "scene")
        .ok_or_else(|| source.error(ErrorKind::Format, 0..0, "there is no <scene>", "give a Mitsuba 3 scene"))
}

fn node(
    source: &Source,
    tag: &BytesStart,
    span: Range<usize>,
    defaults: &mut Vec<(String, String)>,
) -> Result<Node, SceneError> {
    let refuse = |error: String| {
        let help = "mend the attribute";
        source.error(ErrorKind::Syntax, span.clone(), format!("this is no XML: {error}"), help)
    };
    let mut node = Node { tag: tag.name().0.to_owned(), span: span.clone(), ..Node::default() };
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|error| refuse(error.to_string()))?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0);
        let mut value = value.map_err(|error| refuse(error.to_string()))?.into_owned();
        for (name, text) in defaults.iter() {
            value = value.replace(&format!("${name}"), text);
            if value.len() > LONGEST_VALUE {
                return Err(refuse(format!("defaults make a value longer than {LONGEST_VALUE} bytes")));
            }
        }
        node.attributes.push((attribute.key.0.to_owned(), value));
    }
    if let ("default", Some(name), Some(value)) = (node.tag.as_str(), node.get("name"), node.get("value")) {
        defaults.push((name.to_owned(), value.to_owned()));
        // A name may begin with another.
        defaults.sort_by_key(|(name, _)| std::cmp::Reverse(name.len()));
    }
    Ok(node)
}

/// A material before it is known whether its shape emits.
#[derive(Clone)]
struct Diffuse {
    name: String,
    colour: [f64; 3],
    two_sided: bool,
    span: Range<usize>,
}

struct Reader<'a> {
    source: &'a Source,
    input: Input<'a>,
    known: HashMap<String, Diffuse>,
    groups: Vec<Group>,
    materials: Vec<MeshMaterial>,
    notes: Vec<Note>,
    camera: Option<Camera>,
    faces: usize,
}

impl<'a> Reader<'a> {
    fn new(source: &'a Source, input: Input<'a>) -> Self {
        let (groups, materials, notes) = (vec![], vec![], vec![]);
        Self { source, input, known: HashMap::new(), groups, materials, notes, camera: None, faces: 0 }
    }

    fn error(&self, node: &Node, what: impl AsRef<str>, help: &str) -> SceneError {
        self.source.error(ErrorKind::Value, node.span.clone(), what, help)
    }

    fn scene(&mut self, scene: &Node) -> Result<(), SceneError> {
        for node in &scene.children {
            match node.tag.as_str() {
                "shape" => self.shape(node)?,
                "bsdf" => {
                    let material = self.bsdf(node, &format!("bsdf {}", self.known.len()))?;
                    self.known.insert(material.name.clone(), material);
                }
                "sensor" => self.sensor(node)?,
                tag if PASSED_OVER.contains(&tag) => {}
                "emitter" => {
                    let help =
                        "light comes from area emitters of shapes; remove this one, or make it a surface";
                    return Err(self.error(
                        node,
                        format!("an emitter of type {} without a surface", node.kind()),
                        help,
                    ));
                }
                tag => {
                    let help = "write the scene with shapes, bsdfs and a sensor only";
                    return Err(self.error(node, format!("<{tag}> is not read"), help));
                }
            }
        }
        Ok(())
    }

    fn bsdf(&self, node: &Node, otherwise: &str) -> Result<Diffuse, SceneError> {
        let name = node.get("id").unwrap_or(otherwise).to_owned();
        match node.kind() {
            "twosided" => self.two_sided(node, &name),
            "diffuse" => {
                let colour = node.named(&["reflectance"]).map(|value| self.colour(value)).transpose()?;
                let colour = colour.unwrap_or([USUAL_REFLECTANCE; 3]);
                Ok(Diffuse { name, colour, two_sided: false, span: node.span.clone() })
            }
            kind => {
                let help = "only `diffuse` and `twosided` are read";
                Err(self.error(node, format!("a BSDF of type {kind}"), help))
            }
        }
    }

    /// One BSDF for both sides, or two that reflect the same.
    fn two_sided(&self, node: &Node, name: &str) -> Result<Diffuse, SceneError> {
        let inner = node.children.iter().filter_map(|child| match child.tag.as_str() {
            "bsdf" => Some(self.bsdf(child, name)),
            "ref" => Some(self.referred(child)),
            _ => None,
        });
        let inner: Vec<Diffuse> = inner.collect::<Result<_, _>>()?;
        let help = "put one <bsdf> into it, or make two surfaces";
        match &inner[..] {
            [first, others @ ..] if others.iter().all(|other| is_same(other.colour, first.colour)) => {
                let name = node.get("id").map_or_else(|| first.name.clone(), str::to_owned);
                Ok(Diffuse { two_sided: true, name, ..first.clone() })
            }
            [] => Err(self.error(node, "a two-sided BSDF of none", help)),
            _ => Err(self.error(node, "a two-sided BSDF whose sides differ", help)),
        }
    }

    /// The BSDF that an id stands for.
    fn referred(&self, reference: &Node) -> Result<Diffuse, SceneError> {
        let id = reference.get("id").unwrap_or_default();
        self.known.get(id).cloned().ok_or_else(|| {
            let help = "define it above this line, or mend the id";
            self.error(reference, format!("there is no bsdf `{id}` above this line"), help)
        })
    }

    /// Red, green and blue of an `rgb`, or of a `spectrum` or `float` of one value.
    fn colour(&self, node: &Node) -> Result<[f64; 3], SceneError> {
        let value = node.get("value").unwrap_or_default().trim();
        let is_known = matches!(node.tag.as_str(), "rgb" | "spectrum" | "float");
        if let (true, Some(digits)) = (is_known, value.strip_prefix('#')) {
            let byte =
                |k: usize| digits.get(2 * k..2 * k + 2).and_then(|two| u8::from_str_radix(two, 16).ok());
            if let (6, [Some(r), Some(g), Some(b)]) = (digits.len(), [byte(0), byte(1), byte(2)]) {
                return Ok([r, g, b].map(linear));
            }
        }
        match (is_known, numbers(value).as_deref()) {
            (true, Some([grey])) => Ok([*grey; 3]),
            (true, Some([r, g, b])) => Ok([*r, *g, *b]),
            _ => {
                let help = "write <rgb value=\"red, green, blue\"/>, or one number";
                Err(self.error(node, "this is no colour of one or three numbers", help))
            }
        }
    }

    fn shape(&mut self, node: &Node) -> Result<(), SceneError> {
        for child in &node.children {
            if matches!(child.tag.as_str(), "medium" | "texture" | "sensor" | "shape") {
                let help = "remove it, or write the shape without it";
                return Err(self.error(child, format!("<{}> in a shape is not read", child.tag), help));
            }
        }
        let transform = node.named(&["to_world", "toWorld"]);
        let matrix = transform.map_or(Ok(IDENTITY), |node| self.transform(node))?;
        let mut faces = self.faces(node)?;
        self.faces += faces.len();
        check_faces(self.source, self.faces, node.span.clone())?;
        let determinant = determinant(&matrix);
        let mirrored = determinant < 0.0;
        if mirrored && !matches!(node.kind(), "rectangle" | "cube") {
            let help = "mirror the mesh in its file: which side is lit is not clear otherwise";
            return Err(self.error(node, "a transformation that mirrors a mesh", help));
        }
        let flipped = node.named(&["flip_normals", "flipNormals"]).and_then(|flag| flag.get("value"));
        for corners in &mut faces {
            for corner in corners.iter_mut() {
                *corner = point(&matrix, *corner);
            }
            if mirrored != (flipped == Some("true")) {
                corners.reverse();
            }
            if corners.iter().any(|corner| !corner.is_finite()) {
                return Err(self.error(node, "a corner at no finite place", "mend the transformation"));
            }
        }
        let (material, two_sided) = self.material(node)?;
        let object = node.get("id").map_or_else(|| format!("shape {}", self.groups.len()), str::to_owned);
        let span = node.span.clone();
        let faces = faces.into_iter().map(|corners| ImportedFace { corners, span: span.clone() }).collect();
        self.groups.push(Group { object: Some(object), material: Some(material), faces, two_sided });
        Ok(())
    }

    /// The faces of a shape where it is before its transformation.
    fn faces(&mut self, node: &Node) -> Result<Vec<Vec<Vec3>>, SceneError> {
        let v = |[x, y, z]: [f64; 3]| Vec3::new(x, y, z);
        match node.kind() {
            "rectangle" => {
                Ok(vec![[[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]].map(v).to_vec()])
            }
            "cube" => Ok(CUBE.iter().map(|side| side.map(v).to_vec()).collect()),
            "obj" | "ply" => self.file(node),
            kind => {
                let help = "rectangle, cube, obj and ply are read; write other shapes as a mesh";
                Err(self.error(node, format!("a shape of type `{kind}`"), help))
            }
        }
    }

    fn file(&mut self, node: &Node) -> Result<Vec<Vec<Vec3>>, SceneError> {
        let named = node.named(&["filename"]);
        let Some((named, text)) = named.and_then(|named| Some((named, named.get("value")?))) else {
            let help = "add <string name=\"filename\" value=\"…\"/>";
            return Err(self.error(node, "the name of the file is missing", help));
        };
        let name = self.input.name.with_file_name(text);
        if super::ending(Path::new(text)) != node.kind() {
            let what = format!("`{text}` does not end in .{}", node.kind());
            return Err(self.error(named, what, "give a file of the type of the shape"));
        }
        let bytes = self.input.files.load(&name).map_err(|error| {
            let what = format!("cannot read `{text}`: {error}");
            let help = "correct the name; it is taken relative to the folder of the scene";
            self.source.error(ErrorKind::Io, named.span.clone(), what, help).caused_by(error)
        })?;
        let found = mesh(&name, bytes, self.input.files).unwrap_or_else(|| {
            Err(self.error(named, "no mesh format that is known", "give an OBJ or PLY file"))
        })?;
        let faces = found.groups.into_iter().flat_map(|group| group.faces);
        Ok(faces.map(|face| face.corners).collect())
    }

    /// The material of a shape, and whether it is lit on both sides.
    fn material(&mut self, node: &Node) -> Result<(Name, bool), SceneError> {
        let otherwise = node.get("id").map_or_else(|| format!("shape {}", self.groups.len()), str::to_owned);
        let reference = node.child("ref");
        let diffuse = match (node.child("bsdf"), reference) {
            (Some(bsdf), _) => self.bsdf(bsdf, &otherwise)?,
            (None, Some(reference)) => self.referred(reference)?,
            (None, None) => Diffuse {
                name: otherwise,
                colour: [USUAL_REFLECTANCE; 3],
                two_sided: false,
                span: node.span.clone(),
            },
        };
        let emitter = node.child("emitter");
        let emission = emitter.map(|emitter| self.radiance(emitter)).transpose()?;
        let two_sided = diffuse.two_sided && emission.is_none();
        if diffuse.two_sided && !two_sided && diffuse.colour.iter().any(|&c| c > 0.0) {
            let what = format!(
                "the back of `{}`, which reflects and does not emit, is taken for black",
                diffuse.name
            );
            let help = "give the back a surface of its own".to_owned();
            self.notes.push(Note { span: node.span.clone(), what, help });
        }
        let Diffuse { name, colour, span, .. } = diffuse;
        let material =
            MeshMaterial { name, diffuse: Some((colour, span.clone())), emission, picture: None, span };
        let text = add_material(&mut self.materials, material);
        let span = reference.map_or_else(|| node.span.clone(), |reference| reference.span.clone());
        Ok((Name { text, span }, two_sided))
    }

    fn radiance(&self, node: &Node) -> Result<([f64; 3], Range<usize>), SceneError> {
        if node.kind() != "area" {
            let help = "give the shape an emitter of type `area`";
            return Err(self.error(node, format!("an emitter of type `{}`", node.kind()), help));
        }
        let value = node.named(&["radiance"]);
        let colour = value.map_or(Ok([1.0; 3]), |value| self.colour(value))?;
        Ok((colour, value.unwrap_or(node).span.clone()))
    }

    fn sensor(&mut self, node: &Node) -> Result<(), SceneError> {
        if node.kind() != "perspective" {
            let what = format!("a sensor of type `{}` is not read", node.kind());
            let help = "a picture is taken from where the whole scene is seen".to_owned();
            self.notes.push(Note { span: node.span.clone(), what, help });
            return Ok(());
        }
        let matrix = node.named(&["to_world", "toWorld"]);
        let matrix = matrix.map_or(Ok(IDENTITY), |node| self.transform(node))?;
        let value = |parent: &Node, names: &[&str]| {
            parent.named(names).and_then(|child| child.get("value")).map(str::to_owned)
        };
        let number = |parent: &Node, names: &[&str], usual: f64| {
            let text = value(parent, names);
            text.map_or(Some(usual), |text| text.trim().parse::<f64>().ok())
        };
        let film = node.child("film").unwrap_or(node);
        let width = number(film, &["width"], 768.0).filter(|w| (1.0..=MOST_PIXELS_A_SIDE).contains(w));
        let height = number(film, &["height"], 576.0).filter(|h| (1.0..=MOST_PIXELS_A_SIDE).contains(h));
        let fov = number(node, &["fov"], 45.0).filter(|fov| *fov > 0.0 && *fov < 180.0);
        let (Some(width), Some(height), Some(fov)) = (width, height, fov) else {
            let help = "write width and height from 1 to 16384, and fov above 0 and below 180";
            return Err(self.error(node, "a picture of no size, or an angle of no picture", help));
        };
        let axis = value(node, &["fov_axis", "fovAxis"]).unwrap_or_else(|| "x".to_owned());
        let (eye, ahead, above) =
            (point(&matrix, Vec3::ZERO), point(&matrix, Vec3::Z), point(&matrix, Vec3::Y));
        let camera = Camera {
            eye,
            target: ahead,
            up: above - eye,
            vertical_fov_degrees: vertical(fov, &axis, width / height),
            width: width as u32,
            height: height as u32,
            exposure: None,
        };
        let turned = (camera.target - camera.eye).cross(camera.up).length();
        if !(turned > 1e-9 && turned.is_finite()) {
            return Err(self.error(
                node,
                "the sensor looks nowhere, or along its up",
                "mend its transformation",
            ));
        }
        self.camera = Some(camera);
        Ok(())
    }

    /// The product of the steps of a transformation, the last in front.
    fn transform(&self, node: &Node) -> Result<Matrix, SceneError> {
        let mut matrix = IDENTITY;
        for step in &node.children {
            let found = Self::step(step).ok_or_else(|| {
                let help =
                    "translate, scale, rotate, matrix (16 numbers) and lookat are read, with finite numbers";
                self.error(step, format!("this <{}> is no step of a transformation", step.tag), help)
            })?;
            matrix = product(&found, &matrix);
        }
        Ok(matrix)
    }

    fn step(step: &Node) -> Option<Matrix> {
        let vector = |key: &str| step.get(key).and_then(numbers).and_then(|v| <[f64; 3]>::try_from(v).ok());
        match step.tag.as_str() {
            "translate" => {
                let [x, y, z] = vector("value").or_else(|| axes(step, 0.0))?;
                Some([[1., 0., 0., x], [0., 1., 0., y], [0., 0., 1., z]])
            }
            "scale" => {
                let all = step.get("value").and_then(numbers).filter(|v| v.len() == 1).map(|v| [v[0]; 3]);
                let [x, y, z] = all.or_else(|| vector("value")).or_else(|| axes(step, 1.0))?;
                Some([[x, 0., 0., 0.], [0., y, 0., 0.], [0., 0., z, 0.]])
            }
            "rotate" => {
                let axis = Vec3::from_array(vector("value").or_else(|| axes(step, 0.0))?);
                let angle = step.get("angle").and_then(numbers).filter(|v| v.len() == 1)?[0];
                let k = axis.try_normalize()?;
                let (sine, cosine) = angle.to_radians().sin_cos();
                let turned = |p: Vec3| p * cosine + k.cross(p) * sine + k * (k.dot(p) * (1.0 - cosine));
                Some(columns([turned(Vec3::X), turned(Vec3::Y), turned(Vec3::Z)], Vec3::ZERO))
            }
            "matrix" => {
                let m: [f64; 16] = step.get("value").and_then(numbers)?.try_into().ok()?;
                Some([0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| m[4 * row + column])))
            }
            "lookat" | "lookAt" | "look_at" => {
                let [origin, target] = ["origin", "target"].map(|key| vector(key).map(Vec3::from_array));
                let up = vector("up").map_or(Vec3::Z, Vec3::from_array);
                let ahead = (target? - origin?).try_normalize()?;
                let left = up.cross(ahead).try_normalize()?;
                Some(columns([left, ahead.cross(left), ahead], origin?))
            }
            _ => None,
        }
    }
}

/// Corners of the sides of the cube from −1 to 1, counter-clockwise seen from outside.
const CUBE: [[[f64; 3]; 4]; 6] = [
    [[-1., -1., -1.], [-1., 1., -1.], [1., 1., -1.], [1., -1., -1.]],
    [[-1., -1., 1.], [1., -1., 1.], [1., 1., 1.], [-1., 1., 1.]],
    [[-1., -1., -1.], [1., -1., -1.], [1., -1., 1.], [-1., -1., 1.]],
    [[-1., 1., -1.], [-1., 1., 1.], [1., 1., 1.], [1., 1., -1.]],
    [[-1., -1., -1.], [-1., -1., 1.], [-1., 1., 1.], [-1., 1., -1.]],
    [[1., -1., -1.], [1., 1., -1.], [1., 1., 1.], [1., -1., 1.]],
];

/// A matrix that takes points to where they stand, row by row.
type Matrix = [[f64; 4]; 3];
const IDENTITY: Matrix = [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]];

fn columns([a, b, c]: [Vec3; 3], d: Vec3) -> Matrix {
    [[a.x, b.x, c.x, d.x], [a.y, b.y, c.y, d.y], [a.z, b.z, c.z, d.z]]
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| {
        let sum: f64 = (0..3).map(|k| a[i][k] * b[k][j]).sum();
        if j == 3 { sum + a[i][3] } else { sum }
    };
    [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| entry(i, j)))
}

fn point(m: &Matrix, p: Vec3) -> Vec3 {
    Vec3::from_array(m.map(|row| row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]))
}

fn determinant(m: &Matrix) -> f64 {
    let row = |k: usize| Vec3::new(m[k][0], m[k][1], m[k][2]);
    row(0).cross(row(1)).dot(row(2))
}

/// The attributes x, y and z.
fn axes(node: &Node, usual: f64) -> Option<[f64; 3]> {
    let value = |key: &str| {
        node.get(key).map_or(Some(usual), |text| text.trim().parse().ok().filter(|x: &f64| x.is_finite()))
    };
    Some([value("x")?, value("y")?, value("z")?])
}

fn is_same(a: [f64; 3], b: [f64; 3]) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}

/// Finite numbers with commas or blanks between them.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let words = text.split([',', ' ', '\t', '\n']).filter(|word| !word.is_empty());
    words.map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite())).collect()
}

/// A component of sRGB as linear light (IEC 61966-2-1).
fn linear(byte: u8) -> f64 {
    let value = f64::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// The angle from the lower to the upper edge, degrees, from the one along an axis of a picture
/// that is `aspect` times as wide as high.
fn vertical(fov: f64, axis: &str, aspect: f64) -> f64 {
    let tangent = (0.5 * fov.to_radians()).tan();
    let half = match axis {
        "y" => tangent,
        "smaller" if aspect >= 1.0 => tangent,
        "larger" if aspect < 1.0 => tangent,
        "diagonal" => tangent / (1.0 + aspect * aspect).sqrt(),
        _ => tangent / aspect,
    };
    2.0 * half.atan().to_degrees()
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::Place;
    use crate::files::Files;

    const TEXT: &str = r#"<?xml version="1.0"?>
<scene version="3.0.0">
  <default name="spp" value="16"/>
  <default name="grey" value="0.5"/>
  <integrator type="path"/>
  <sensor type="perspective">
    <string name="fov_axis" value="y"/><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="32"/></film>
  </sensor>
  <bsdf type="twosided" id="wall"><bsdf type="diffuse"><rgb name="reflectance" value="$grey, 0.25, 0.125"/></bsdf></bsdf>
  <shape type="rectangle" id="floor">
    <transform name="to_world"><scale x="2"/><rotate x="1" angle="-90"/><translate y="-1"/></transform>
    <ref id="wall"/>
  </shape>
  <shape type="cube" id="lamp">
    <transform name="to_world"><scale value="0.5"/></transform>
    <bsdf type="diffuse"/>
    <emitter type="area"><rgb name="radiance" value="3"/></emitter>
  </shape>
</scene>
"#;

    fn read(text: &str) -> Result<Imported, SceneError> {
        let (name, mut files) = (Path::new("a.xml"), Files::beside(Path::new("a.xml")));
        import(Input { name, path: name, files: &mut files }, text.as_bytes().to_vec())
    }

    #[test]
    fn shapes_materials_and_the_camera_are_found() {
        let found = read(TEXT).unwrap();
        let floor = &found.groups[0];
        assert_eq!((floor.object.as_deref(), floor.two_sided), (Some("floor"), true));
        let expected = [[-2., -1., 1.], [2., -1., 1.], [2., -1., -1.], [-2., -1., -1.]].map(Vec3::from_array);
        assert!(floor.faces[0].corners.iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-15));
        assert_eq!(found.materials[0].diffuse.as_ref().unwrap().0, [0.5, 0.25, 0.125]);
        assert_eq!(found.groups[1].faces.len(), 6);
        assert_eq!(found.materials[1].emission.as_ref().unwrap().0, [3.0; 3]);
        let camera = found.camera.unwrap();
        assert_eq!((camera.eye, camera.width, camera.height), (Vec3::new(0., 0., 5.), 64, 32));
        assert!((camera.vertical_fov_degrees - 40.0).abs() < 1e-12);
        assert!(
            (camera.target - Vec3::new(0., 0., 4.)).length() < 1e-15 && camera.up.distance(Vec3::Y) < 1e-15
        );
    }

    #[test]
    fn the_sides_of_a_cube_look_outwards() {
        for side in CUBE {
            let [a, b, c, d] = side.map(Vec3::from_array);
            assert!((b - a).cross(c - a).dot(a + b + c + d) > 0.0, "{side:?}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        for (from, to, line) in [
            ("<ref id=\"wall\"/>", "<ref id=\"none\"/>", 14),
            ("$grey, 0.25", "x, 0.25", 11),
            ("type=\"cube\"", "type=\"sphere\"", 16),
            ("<bsdf type=\"diffuse\"/>", "<bsdf type=\"conductor\"/>", 18),
            ("<emitter type=\"area\">", "<emitter type=\"area\"", 19),
            ("</scene>\n", "", 22),
            ("<integrator type=\"path\"/>", "<emitter type=\"point\"/>", 5),
            ("rotate x=\"1\"", "rotate x=\"0\"", 13),
            ("value=\"40\"", "value=\"400\"", 6),
            ("name=\"fov\" value", "name=\"fov\" name", 7),
        ] {
            let error = read(&TEXT.replacen(from, to, 1)).unwrap_err();
            assert!(
                matches!(error.place(), Some(Place::Line { line: found, .. }) if found.abs_diff(line) <= 1),
                "{line}: {error}"
            );
        }
    }
}
