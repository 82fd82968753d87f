//! Surfaces: name, material, shape, and whether they are part of a closed body.

use std::collections::BTreeSet;
use std::ops::Range;

use fredholm_mesh::{Cutting, MeshError, Shape, Topology};
use fredholm_waves::Kind;

use super::choices::EdgeEntry;
use super::format::{SceneEntry, SurfaceEntry};
use super::material;
use crate::error::{ErrorKind, SceneError};
use crate::format::{At, MeshFileEntry};
use crate::import::{Group, Imported};
use crate::resolve::obj::{Placing, group_name, load, mapped, mended, unused_names};
use crate::resolve::shape::{only_shape, shape};
use crate::resolve::{Reading, check_name};

/// Edges a wavelength where the scene does not say.
const PER_WAVELENGTH: f64 = 10.0;

/// Longest edge of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Edge {
    /// The scene does not say.
    Unsaid,
    /// Metres.
    Metres(f64),
    /// The wavelength over this number.
    Part(f64),
}

impl Edge {
    /// In metres, at a wavelength.
    pub fn metres(self, wavelength: f64) -> f64 {
        match self {
            Self::Unsaid => wavelength / PER_WAVELENGTH,
            Self::Metres(length) => length,
            Self::Part(number) => wavelength / number,
        }
    }
}

/// A surface of the mesh to be, before it is cut.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub name: String,
    /// Number of its material; the conductor is 0.
    pub material: usize,
    pub shapes: Vec<Shape>,
    /// Whether its curved shape has as many segments as the edges ask for.
    pub follows_edge: bool,
    pub edge: Edge,
    pub kind: Kind,
    /// Whether the scene says of which kind it is.
    pub said: bool,
    /// Whether it comes from a mesh file.
    pub imported: bool,
    /// Number of its entry.
    pub entry: usize,
    /// Its place in the scene file.
    pub span: Range<usize>,
    /// Where the edge stands, or else the surface.
    pub edge_span: Range<usize>,
}

/// The surfaces of a scene, at least one.
pub(super) fn parts(reading: &mut Reading, scene: &SceneEntry) -> Result<Vec<Part>, SceneError> {
    let source = reading.source;
    if scene.surface.is_empty() {
        let help = "add a [[surface]] with a name and a shape such as quad, box, sphere or mesh";
        let end = source.text.len();
        return Err(source.error(ErrorKind::Empty, end..end, "the scene has no surface", help));
    }
    let (mut names, mut all) = (BTreeSet::new(), vec![]);
    for (number, entry) in scene.surface.iter().enumerate() {
        let mut found = of_entry(reading, scene, entry)?;
        for part in &mut found {
            check_name(source, &entry.name, &part.name, &mut names)?;
            part.entry = number;
        }
        all.extend(found);
    }
    Ok(all)
}

fn of_entry(
    reading: &mut Reading,
    scene: &SceneEntry,
    entry: &At<SurfaceEntry>,
) -> Result<Vec<Part>, SceneError> {
    let source = reading.source;
    let span = only_shape(source, &entry.shapes())?;
    let edge = edge(source, entry)?;
    let material = entry.material.as_ref();
    let material = material.map(|name| material::find(source, scene, name)).transpose()?;
    let bare = Part {
        name: String::clone(&entry.name),
        material: material.unwrap_or(0),
        shapes: vec![],
        follows_edge: follows_edge(entry),
        edge,
        kind: kind(entry.closed.as_ref().is_some_and(|closed| **closed)),
        said: entry.closed.is_some(),
        imported: entry.mesh.is_some(),
        entry: 0,
        span: entry.span(),
        edge_span: entry.edge.as_ref().map_or(entry.span(), At::span),
    };
    match (shape(source, &entry.shapes())?, &entry.mesh) {
        (Some(shape), _) => {
            let kind = if bare.said { bare.kind } else { kind(is_closed(&shape)) };
            shape
                .count(&Cutting::default())
                .map_err(|error| meshing(source, &bare, &error, (source, span)))?;
            Ok(vec![Part { shapes: vec![shape], kind, ..bare }])
        }
        (None, Some(file)) => of_file(reading, scene, file, &bare, material),
        (None, None) => Ok(vec![]),
    }
}

fn kind(closed: bool) -> Kind {
    if closed { Kind::Closed } else { Kind::Sheet }
}

/// Whether a shape is the whole border of a body.
fn is_closed(shape: &Shape) -> bool {
    match shape {
        Shape::Box { .. } | Shape::Sphere { .. } => true,
        Shape::Cylinder { caps, .. } => *caps,
        _ => false,
    }
}

/// Whether a curved shape has no number of segments of its own.
fn follows_edge(entry: &SurfaceEntry) -> bool {
    let sphere = entry.sphere.as_ref().is_some_and(|sphere| sphere.segments.is_none());
    let disc = entry.disc.as_ref().is_some_and(|disc| disc.segments.is_none());
    let cylinder = entry.cylinder.as_ref().is_some_and(|cylinder| cylinder.segments.is_none());
    sphere || disc || cylinder
}

fn edge(source: &crate::source::Source, entry: &SurfaceEntry) -> Result<Edge, SceneError> {
    let Some(given) = &entry.edge else { return Ok(Edge::Unsaid) };
    let found = match &**given {
        EdgeEntry::Metres(length) => Some(Edge::Metres(*length)),
        EdgeEntry::Text(text) if text == "lambda" => Some(Edge::Part(1.0)),
        EdgeEntry::Text(text) => {
            text.strip_prefix("lambda/").and_then(|n| n.parse::<f64>().ok()).map(Edge::Part)
        }
    };
    let sane = |edge: &Edge| edge.metres(1.0) > 0.0 && edge.metres(1.0).is_finite();
    found.filter(sane).ok_or_else(|| {
        let help = "write a length in metres above 0, or a part of the wavelength such as \"lambda/10\"";
        source.error(ErrorKind::Value, given.span(), "this is no edge", help)
    })
}

/// The objects of a mesh file. Unless the scene says, those that are closed are closed bodies.
fn of_file(
    reading: &mut Reading,
    scene: &SceneEntry,
    file: &MeshFileEntry,
    bare: &Part,
    material: Option<usize>,
) -> Result<Vec<Part>, SceneError> {
    let source = reading.source;
    let imported = load(reading, file)?;
    let placing = Placing::new(source, file)?;
    unused_names(source, file, &imported)?;
    let mended = mended(reading, &imported, &placing)?;
    let (mut shapes, mut parts) = (mended.shapes.into_iter(), vec![]);
    for group in &imported.groups {
        let own: Vec<Vec<Shape>> = shapes.by_ref().take(group.faces.len()).collect();
        for (face, shapes) in group.faces.iter().zip(&own) {
            for shape in shapes {
                shape
                    .count(&Cutting::default())
                    .map_err(|error| meshing(source, bare, &error, (&imported.source, face.span.clone())))?;
            }
        }
        let shapes: Vec<Shape> = own.into_iter().flatten().collect();
        if !shapes.is_empty() {
            let name = group_name(&bare.name, group, &imported.groups);
            let material = of_group(reading, scene, (file, &imported), group, material)?;
            parts.push(Part { name, material, shapes, ..bare.clone() });
        }
    }
    if parts.is_empty() {
        let what = format!("no face of `{}` encloses an area", *file.file);
        let help = "export the mesh anew, with more digits";
        return Err(source.error(ErrorKind::Geometry, file.file.span(), what, help));
    }
    if !bare.said {
        kinds(&mut parts);
    }
    Ok(parts)
}

/// The material of the faces of one object: that of the entry's table or of the scene that has the
/// name, else that of the surface.
fn of_group(
    reading: &Reading,
    scene: &SceneEntry,
    (file, imported): (&MeshFileEntry, &Imported),
    group: &Group,
    own: Option<usize>,
) -> Result<usize, SceneError> {
    let Some(name) = &group.material else {
        let listed =
            |object: &String| file.materials.iter().find(|(from, _)| from.as_str() == object.as_str());
        return match group.object.as_ref().and_then(listed) {
            Some((_, to)) => material::find(reading.source, scene, to),
            None => Ok(own.unwrap_or(0)),
        };
    };
    if let Some(to) = mapped(file, name) {
        return material::find(reading.source, scene, to);
    }
    material::number(scene, &name.text).or(own).ok_or_else(|| {
        let what = format!("the scene has no material `{}`", name.text);
        let help = format!(
            "give the surface a material, or write materials = {{ \"{}\" = \"…\" }} in the mesh table; {}",
            name.text,
            material::known(scene, &name.text)
        );
        imported.source.error(ErrorKind::Name, name.span.clone(), what, help)
    })
}

/// Objects all of whose pieces belong to closed bodies are closed, others are sheets.
fn kinds(parts: &mut [Part]) {
    let (mut pieces, mut part_of) = (vec![], vec![]);
    for (number, part) in parts.iter().enumerate() {
        for shape in &part.shapes {
            // What cannot be meshed was refused before.
            pieces.extend(shape.blockers(&Cutting::default()).unwrap_or_default());
        }
        part_of.resize(pieces.len(), number);
    }
    let topology = Topology::of(&pieces);
    let mut closed = vec![true; parts.len()];
    for (piece, &part) in part_of.iter().enumerate() {
        closed[part] &= topology.components[topology.component_of[piece] as usize].closed;
    }
    parts.iter_mut().zip(closed).for_each(|(part, closed)| part.kind = kind(closed));
}

/// What the mesh says about a shape at `origin`, or about how it is to be cut.
pub(super) fn meshing(
    source: &crate::source::Source,
    part: &Part,
    error: &MeshError,
    origin: (&crate::source::Source, Range<usize>),
) -> SceneError {
    let what = format!("surface `{}`: {error}", part.name);
    match error {
        MeshError::TooLarge { .. } | MeshError::TooManySegments { .. } => {
            source.error(ErrorKind::TooLarge, part.edge_span.clone(), what, "take longer edges")
        }
        _ => origin.0.error(ErrorKind::Geometry, origin.1, what, error.help()),
    }
}
