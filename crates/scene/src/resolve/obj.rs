//! Surfaces from a mesh file: placed in the scene, their materials found by name.
//!
//! A point p of the file comes to stand at t + R (s p): scaled by s, turned by R (Rodrigues'
//! rotation formula), moved by t.

use std::collections::BTreeSet;
use std::path::Path;

use fredholm_mesh::{Cutting, MeshError, Shape, Vec3};

use super::faces::Mended;
use super::library::{self, Library};
use super::number::LARGEST_COORDINATE;
use super::surface::{find_material, geometry, part};
use super::{Context, Reading};
use crate::check::Warning;
use crate::error::{ErrorKind, SceneError};
use crate::format::{At, MeshFileEntry, SurfaceEntry, Turn};
use crate::import::{Group, Imported, ImportedFace, Name, endings, import};
use crate::part::Part;
use crate::source::Source;
use crate::suggest::among;

/// The surfaces of a file, and which of them it says to have two sides.
pub(super) fn parts(
    context: &mut Context,
    entry: &SurfaceEntry,
    file: &MeshFileEntry,
    cutting: &Cutting,
) -> Result<(Vec<Part>, Vec<bool>), SceneError> {
    let source = context.reading.source;
    let imported = load(&mut context.reading, file)?;
    let placing = Placing::new(source, file)?;
    let libraries = libraries(context, file, &imported)?;
    unused_names(source, file, &imported)?;
    let mended = mended(&mut context.reading, &imported, &placing)?;
    let mut shapes = mended.shapes.into_iter();
    let (mut parts, mut two_sided) = (vec![], vec![]);
    for group in &imported.groups {
        let lookup = Lookup { entry, file, imported: &imported, libraries: libraries.as_deref() };
        let material = lookup.of(context, group)?;
        let counted = group.faces.iter().zip(shapes.by_ref());
        let shapes = counted.map(|(face, shapes)| {
            counted_shapes(shapes, cutting, |e| {
                geometry(source, entry, e, (&imported.source, face.span.clone()))
            })
        });
        let shapes: Vec<(Shape, u128)> =
            shapes.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        let elements = shapes.iter().map(|(_, elements)| elements).sum();
        let shapes: Vec<Shape> = shapes.into_iter().map(|(shape, _)| shape).collect();
        if !shapes.is_empty() {
            two_sided.push(group.two_sided);
            parts.push(part(
                entry,
                &group_name(&entry.name, group, &imported.groups),
                material,
                shapes,
                cutting,
                elements,
            ));
        }
    }
    if parts.is_empty() {
        let what = format!("no face of `{}` encloses an area", *file.file);
        return Err(source.error(
            ErrorKind::Geometry,
            file.file.span(),
            what,
            "export the mesh anew, with more digits",
        ));
    }
    Ok((parts, two_sided))
}

/// The faces of all groups where they come to stand, fit to be meshed; what was done to them is
/// noted.
pub(crate) fn mended(
    reading: &mut Reading,
    imported: &Imported,
    placing: &Placing,
) -> Result<Mended, SceneError> {
    let mut faces = vec![];
    for face in imported.groups.iter().flat_map(|group| &group.faces) {
        placing.check(face, &imported.source)?;
        faces.push(face.corners.iter().map(|&p| placing.apply(p)).collect());
    }
    let mended = Mended::of(faces);
    let first = mended.without_area.first();
    let span = first.and_then(|&k| imported.groups.iter().flat_map(|group| &group.faces).nth(k));
    let span = span.map_or(0..0, |face| face.span.clone());
    if let Some(what) = mended.left_out() {
        let (file, place) = (imported.source.path.clone(), imported.source.place(span));
        let help = "nothing is to be done; an export with more digits avoids it".to_owned();
        reading.notes.push(Warning { file, place, what, help });
    }
    reading.findings.extend(mended.findings());
    Ok(mended)
}

/// Shapes with their numbers of elements.
fn counted_shapes(
    shapes: Vec<Shape>,
    cutting: &Cutting,
    error: impl Fn(&MeshError) -> SceneError,
) -> Result<Vec<(Shape, u128)>, SceneError> {
    let counted = |shape: Shape| shape.count(cutting).map(|count| (shape, count)).map_err(|e| error(&e));
    shapes.into_iter().map(counted).collect()
}

/// The faces of a mesh file, at least one.
pub(crate) fn load(reading: &mut Reading, file: &MeshFileEntry) -> Result<Imported, SceneError> {
    let name = Path::new(file.file.as_str());
    let bytes = reading.files.load(name).map_err(|error| {
        let what = format!("cannot read `{}`: {error}", *file.file);
        let help = "correct the name; it is taken relative to the folder of the scene file";
        reading.source.error(ErrorKind::Io, file.file.span(), what, help).caused_by(error)
    })?;
    let imported = import(name, bytes, reading.files).unwrap_or_else(|| {
        let what = format!("`{}` is of no known mesh format", *file.file);
        let help = format!("give a file whose name ends in {}", endings());
        Err(reading.source.error(ErrorKind::Format, file.file.span(), what, help))
    })?;
    for note in &imported.notes {
        let (file, place) = (imported.source.path.clone(), imported.source.place(note.span.clone()));
        reading.notes.push(Warning { file, place, what: note.what.clone(), help: note.help.clone() });
    }
    if imported.groups.is_empty() {
        let what = format!("`{}` holds no face", *file.file);
        let help = "give a file with faces (lines that begin with f in an OBJ)";
        return Err(reading.source.error(ErrorKind::Empty, file.file.span(), what, help));
    }
    Ok(imported)
}

/// The material libraries, or `None` where there is none or where none is needed, since the scene
/// has a material for every name.
fn libraries(
    context: &mut Context,
    file: &MeshFileEntry,
    imported: &Imported,
) -> Result<Option<Vec<Library>>, SceneError> {
    let mut used = imported.groups.iter().filter_map(|group| group.material.as_ref());
    if (imported.libraries.is_empty() && imported.materials.is_empty())
        || used.all(|name| mapped(file, name).is_some())
    {
        return Ok(None);
    }
    library::read(context, file, imported).map(Some)
}

/// The material of the scene that the entry names for a material of the file.
pub(crate) fn mapped<'a>(file: &'a MeshFileEntry, name: &Name) -> Option<&'a At<String>> {
    file.materials.iter().find(|(from, _)| ***from == name.text).map(|(_, to)| to)
}

/// Refuses names in the entry's table of materials that the file does not use.
pub(crate) fn unused_names(
    source: &Source,
    file: &MeshFileEntry,
    imported: &Imported,
) -> Result<(), SceneError> {
    let name = |group: &Group| group.material.as_ref().map(|name| name.text.clone()).or(group.object.clone());
    let used: BTreeSet<String> = imported.groups.iter().filter_map(name).collect();
    let Some(name) = file.materials.keys().find(|name| !used.contains(name.as_str())) else { return Ok(()) };
    let what = format!("`{}` uses no material `{}`", *file.file, **name);
    Err(source.error(
        ErrorKind::Name,
        name.span(),
        what,
        among(name, used.iter().map(String::as_str), "materials of the file"),
    ))
}

/// Where the material of a group is looked for.
struct Lookup<'a> {
    entry: &'a SurfaceEntry,
    file: &'a MeshFileEntry,
    imported: &'a Imported,
    libraries: Option<&'a [Library]>,
}

impl Lookup<'_> {
    fn of(&self, context: &mut Context, group: &Group) -> Result<usize, SceneError> {
        match &group.material {
            Some(name) => match mapped(self.file, name) {
                Some(to) => find_material(context.reading.source, to, context.own()),
                None => self.by_same_name(context, name),
            },
            None => match self.of_object(group).or(self.entry.material.as_ref()) {
                Some(name) => find_material(context.reading.source, name, context.own()),
                None => Err(self.nameless(group)),
            },
        }
    }

    /// What the entry names for the object of faces without a material.
    fn of_object(&self, group: &Group) -> Option<&At<String>> {
        let object = group.object.as_ref()?;
        self.file.materials.iter().find(|(from, _)| ***from == *object).map(|(_, to)| to)
    }

    /// The material of the scene that has the name, else that of a library.
    fn by_same_name(&self, context: &mut Context, name: &Name) -> Result<usize, SceneError> {
        let error =
            |what: String, help| self.imported.source.error(ErrorKind::Name, name.span.clone(), what, help);
        let libraries = self.libraries.unwrap_or_default();
        let defined = || libraries.iter().flat_map(|library| &library.materials).map(|m| m.name.as_str());
        let undefined = self.libraries.is_some() && !defined().any(|known| known == name.text);
        if undefined && context.fallback.is_none() {
            let what = format!("neither this file nor a material library of it defines `{}`", name.text);
            return Err(error(what, among(&name.text, defined(), "names")));
        }
        if let Some(own) = context.own().iter().position(|material| material.name == name.text) {
            return Ok(own);
        }
        if let Some(found) = library::find(context, libraries, &name.text)?.or(context.fallback) {
            return Ok(found);
        }
        let what = format!("the scene has no material `{}`", name.text);
        let known = among(&name.text, context.own().iter().map(|m| m.name.as_str()), "materials");
        Err(error(
            what,
            format!("write materials = {{ \"{}\" = \"…\" }} in the table of the mesh; {known}", name.text),
        ))
    }

    fn nameless(&self, group: &Group) -> SceneError {
        let span = group.faces.first().map_or(0..0, |face| face.span.clone());
        let help = "give the surface a material, or the face in its file (a usemtl line in an OBJ)";
        self.imported.source.error(ErrorKind::MissingKey, span, "this face has no material", help)
    }
}

/// NAME/object, with the material behind it where an object has several.
pub(crate) fn group_name(surface: &str, group: &Group, groups: &[Group]) -> String {
    let several = groups.iter().filter(|other| other.object == group.object).count() > 1;
    let material = group.material.as_ref().filter(|_| several).map(|name| name.text.as_str());
    let parts = [Some(surface), group.object.as_deref(), material];
    parts.into_iter().flatten().collect::<Vec<_>>().join("/")
}

/// Where a file's points come to stand.
pub(crate) struct Placing {
    scale: f64,
    axis: Vec3,
    cosine: f64,
    sine: f64,
    translate: Vec3,
}

impl Placing {
    pub fn new(source: &Source, file: &MeshFileEntry) -> Result<Self, SceneError> {
        let scale = file.scale.as_ref().map_or(Ok(1.0), |scale| source.positive(scale, "scale"))?;
        let translate = file.translate.as_ref();
        let translate = translate.map_or(Ok(Vec3::ZERO), |t| source.vector(t, "translate"))?;
        let (axis, angle) = file.turn.as_ref().map_or(Ok((Vec3::Z, 0.0)), |turn| self::turn(source, turn))?;
        let (sine, cosine) = angle.sin_cos();
        Ok(Self { scale, axis, cosine, sine, translate })
    }

    /// Refuses a face that comes to stand too far away.
    fn check(&self, face: &ImportedFace, mesh_file: &Source) -> Result<(), SceneError> {
        if face.corners.iter().all(|&p| self.apply(p).abs().max_element() <= LARGEST_COORDINATE) {
            return Ok(());
        }
        let what = format!("this face comes to stand farther away than {LARGEST_COORDINATE:e} m");
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
