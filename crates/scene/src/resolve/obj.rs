//! Surfaces from a mesh file: placed in the scene, their materials found by name.
//!
//! A point p of the file comes to stand at t + R (s p): scaled by s, turned by R (Rodrigues' rotation formula), moved
//! by t.

use std::collections::BTreeSet;
use std::path::Path;

use fredholm_mesh::{Cutting, MeshError, Shape, Vec3};

use super::number::FARTHEST;
use super::surface::{find_material, geometry, part};
use super::{Context, Material};
use crate::error::{ErrorKind, SceneError};
use crate::format::{At, ObjEntry, SurfaceEntry, Turn};
use crate::import::{ENDINGS, Group, Imported, ImportedFace, Name, import, material_names};
use crate::part::Part;
use crate::source::Source;
use crate::suggest::among;

pub(super) fn parts(
    context: &mut Context,
    entry: &SurfaceEntry,
    file: &ObjEntry,
    cutting: &Cutting,
) -> Result<Vec<Part>, SceneError> {
    let (source, materials) = (context.source, context.materials);
    let imported = load(context, file)?;
    let placing = Placing::new(source, file)?;
    let libraries = libraries(context, file, &imported)?;
    unused_names(source, file, &imported)?;
    let part = |group: &Group| {
        let material =
            Lookup { source, entry, file, imported: &imported, materials, libraries: libraries.as_deref() };
        let material = material.of(group)?;
        let shapes = shapes(source, entry, &imported.source, group, &placing, cutting)?;
        let elements = shapes.iter().map(|(_, elements)| elements).sum();
        let shapes = shapes.into_iter().map(|(shape, _)| shape).collect();
        Ok(part(entry, &name(entry, group, &imported.groups), material, shapes, cutting, elements))
    };
    imported.groups.iter().map(part).collect()
}

fn load(context: &mut Context, file: &ObjEntry) -> Result<Imported, SceneError> {
    let name = Path::new(file.file.as_str());
    let bytes = context.files.load(name).map_err(|error| {
        let what = format!("cannot read `{}`: {error}", *file.file);
        let help = "correct the name; it is taken relative to the folder of the scene file";
        context.source.error(ErrorKind::Io, file.file.span(), what, help).caused_by(error)
    })?;
    let imported = import(&context.files.path(name), bytes).unwrap_or_else(|| {
        let what = format!("`{}` is of no known mesh format", *file.file);
        let help = format!("give a file whose name ends in {ENDINGS}");
        Err(context.source.error(ErrorKind::Format, file.file.span(), what, help))
    })?;
    if imported.groups.is_empty() {
        let what = format!("`{}` holds no face", *file.file);
        let help = "give a file with faces (lines that begin with f)";
        return Err(context.source.error(ErrorKind::Empty, file.file.span(), what, help));
    }
    Ok(imported)
}

/// Names in the material libraries, or `None` where there is none or where none is needed, since the scene has a
/// material for every name.
fn libraries(
    context: &mut Context,
    file: &ObjEntry,
    imported: &Imported,
) -> Result<Option<Vec<String>>, SceneError> {
    let mut used = imported.groups.iter().filter_map(|group| group.material.as_ref());
    if imported.libraries.is_empty() || used.all(|name| mapped(file, name).is_some()) {
        return Ok(None);
    }
    let mut names = vec![];
    for library in &imported.libraries {
        names.extend(library_names(context, file, imported, library)?);
    }
    Ok(Some(names))
}

fn library_names(
    context: &mut Context,
    file: &ObjEntry,
    imported: &Imported,
    library: &Name,
) -> Result<Vec<String>, SceneError> {
    let name = Path::new(file.file.as_str()).with_file_name(&library.text);
    let bytes = context.files.load(&name).map_err(|error| {
        let what = format!("cannot read the material library `{}`: {error}", library.text);
        let help =
            "put it beside the OBJ file, or name a material of the scene for every usemtl: materials = { … }";
        imported.source.error(ErrorKind::Io, library.span.clone(), what, help).caused_by(error)
    })?;
    Ok(material_names(&Source::decode(&context.files.path(&name), bytes)?))
}

fn mapped<'a>(file: &'a ObjEntry, name: &Name) -> Option<&'a At<String>> {
    file.materials.iter().find(|(from, _)| ***from == name.text).map(|(_, to)| to)
}

/// Refuses names in the entry's table of materials that the file does not use.
fn unused_names(source: &Source, file: &ObjEntry, imported: &Imported) -> Result<(), SceneError> {
    let used: BTreeSet<&str> =
        imported.groups.iter().filter_map(|g| g.material.as_ref()).map(|name| name.text.as_str()).collect();
    let Some(name) = file.materials.keys().find(|name| !used.contains(name.as_str())) else { return Ok(()) };
    let what = format!("`{}` uses no material `{}`", *file.file, **name);
    Err(source.error(ErrorKind::Name, name.span(), what, among(name, used, "materials of the file")))
}

/// Where the material of a group is looked for.
struct Lookup<'a> {
    source: &'a Source,
    entry: &'a SurfaceEntry,
    file: &'a ObjEntry,
    imported: &'a Imported,
    materials: &'a [Material],
    libraries: Option<&'a [String]>,
}

impl Lookup<'_> {
    fn of(&self, group: &Group) -> Result<usize, SceneError> {
        match &group.material {
            Some(name) => match mapped(self.file, name) {
                Some(to) => find_material(self.source, to, self.materials),
                None => self.by_same_name(name),
            },
            None => match &self.entry.material {
                Some(name) => find_material(self.source, name, self.materials),
                None => Err(self.nameless(group)),
            },
        }
    }

    fn by_same_name(&self, name: &Name) -> Result<usize, SceneError> {
        let error =
            |what: String, help| self.imported.source.error(ErrorKind::Name, name.span.clone(), what, help);
        if let Some(names) = self.libraries.filter(|names| !names.contains(&name.text)) {
            let what = format!("no material library of this file defines `{}`", name.text);
            return Err(error(what, among(&name.text, names.iter().map(String::as_str), "names")));
        }
        self.materials.iter().position(|material| material.name == name.text).ok_or_else(|| {
            let what = format!("the scene has no material `{}`", name.text);
            let known = among(&name.text, self.materials.iter().map(|m| m.name.as_str()), "materials");
            error(
                what,
                format!("write materials = {{ \"{}\" = \"…\" }} in the obj table; {known}", name.text),
            )
        })
    }

    fn nameless(&self, group: &Group) -> SceneError {
        let span = group.faces.first().map_or(0..0, |face| face.span.clone());
        let help = "give the surface a material, or put a usemtl line before the face";
        self.imported.source.error(ErrorKind::MissingKey, span, "this face has no material", help)
    }
}

/// NAME/object, with the material behind it where an object has several.
fn name(entry: &SurfaceEntry, group: &Group, groups: &[Group]) -> String {
    let several = groups.iter().filter(|other| other.object == group.object).count() > 1;
    let material = group.material.as_ref().filter(|_| several).map(|name| name.text.as_str());
    let parts = [Some(entry.name.as_str()), group.object.as_deref(), material];
    parts.into_iter().flatten().collect::<Vec<_>>().join("/")
}

/// Shapes of a group, each with its number of elements.
fn shapes(
    source: &Source,
    entry: &SurfaceEntry,
    mesh_file: &Source,
    group: &Group,
    placing: &Placing,
    cutting: &Cutting,
) -> Result<Vec<(Shape, u128)>, SceneError> {
    let mut shapes = vec![];
    for face in &group.faces {
        let error = |e| geometry(source, entry, &e, (mesh_file, face.span.clone()));
        placing.check(face, mesh_file)?;
        let corners: Vec<Vec3> = face.corners.iter().map(|&p| placing.apply(p)).collect();
        for shape in face_shapes(&corners) {
            let elements = shape.count(cutting).map_err(error)?;
            shapes.push((shape, elements));
        }
    }
    Ok(shapes)
}

/// A face as one shape. A convex polygon that is not flat, as rounded coordinates make it, is a fan of triangles.
pub(crate) fn face_shapes(corners: &[Vec3]) -> Vec<Shape> {
    match *corners {
        [a, b, c] => vec![Shape::Triangle { corners: [a, b, c] }],
        [a, b, c, d] => vec![Shape::Quad { corners: [a, b, c, d], skip: vec![] }],
        _ => {
            let polygon = Shape::Polygon { outline: corners.to_vec(), holes: vec![] };
            match polygon.count(&Cutting::default()) {
                Err(MeshError::NotPlanar { .. }) if is_convex(corners) => fan(corners),
                _ => vec![polygon],
            }
        }
    }
}

fn fan(corners: &[Vec3]) -> Vec<Shape> {
    let triangle = |side: &[Vec3]| Shape::Triangle { corners: [corners[0], side[0], side[1]] };
    corners[1..].windows(2).map(triangle).collect()
}

/// Whether every corner turns left, seen along the area vector.
fn is_convex(corners: &[Vec3]) -> bool {
    let n = corners.len();
    let side = |i: usize| corners[(i + 1) % n] - corners[i % n];
    let normal: Vec3 = (0..n).map(|i| (corners[i] - corners[0]).cross(side(i))).sum();
    (0..n).all(|i| side(i).cross(side(i + 1)).dot(normal) > 0.0)
}

/// Where a file's points come to stand.
struct Placing {
    scale: f64,
    axis: Vec3,
    cosine: f64,
    sine: f64,
    translate: Vec3,
}

impl Placing {
    fn new(source: &Source, file: &ObjEntry) -> Result<Self, SceneError> {
        let scale = file.scale.as_ref().map_or(Ok(1.0), |scale| source.positive(scale, "scale"))?;
        let translate = file.translate.as_ref();
        let translate = translate.map_or(Ok(Vec3::ZERO), |t| source.vector(t, "translate"))?;
        let (axis, angle) = file.turn.as_ref().map_or(Ok((Vec3::Z, 0.0)), |turn| self::turn(source, turn))?;
        let (sine, cosine) = angle.sin_cos();
        Ok(Self { scale, axis, cosine, sine, translate })
    }

    /// Refuses a face that comes to stand too far away.
    fn check(&self, face: &ImportedFace, mesh_file: &Source) -> Result<(), SceneError> {
        if face.corners.iter().all(|&p| self.apply(p).abs().max_element() <= FARTHEST) {
            return Ok(());
        }
        let what = format!("this face comes to stand farther away than {FARTHEST:e} m");
        Err(mesh_file.error(
            ErrorKind::Value,
            face.span.clone(),
            what,
            "lower scale or translate in the scene",
        ))
    }

    fn apply(&self, point: Vec3) -> Vec3 {
        let (p, k) = (point * self.scale, self.axis);
        let turned = p * self.cosine + k.cross(p) * self.sine + k * (k.dot(p) * (1.0 - self.cosine));
        turned + self.translate
    }
}

/// Unit axis and angle, radians.
fn turn(source: &Source, turn: &Turn) -> Result<(Vec3, f64), SceneError> {
    let axis = source.direction(&turn.axis, "axis")?.normalize();
    Ok((axis, source.finite(&turn.degrees, "degrees")?.to_radians()))
}
