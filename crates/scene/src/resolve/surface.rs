//! Surfaces: name, material, shape, cutting and back.

use std::ops::Range;
use std::sync::Arc;

use fredholm_mesh::{Cutting, MeshError, Shape};

use super::{Context, Material, cutting, obj, shape, turned};
use crate::error::{ErrorKind, SceneError};
use crate::format::{At, SurfaceEntry};
use crate::part::{Origin, Part};
use crate::source::Source;
use crate::suggest::among;

/// The surfaces that an entry stands for: one, several from a file, and the backs of those that
/// have two sides.
pub(super) fn parts(context: &mut Context, entry: &SurfaceEntry) -> Result<Vec<Part>, SceneError> {
    let span = shape::only_shape(context.reading.source, &entry.shapes())?;
    let cutting = cutting::cutting(context.reading.source, context.scene, entry)?;
    let mut said = vec![];
    let mut parts = match (own_shape(context.reading.source, entry)?, entry.mesh_file()) {
        (None, Some(file)) => {
            let (parts, two_sided) = obj::parts(context, entry, file, &cutting)?;
            said = two_sided;
            parts
        }
        (Some(shape), _) => vec![own(context, entry, shape, &cutting, span)?],
        (None, None) => vec![],
    };
    let sides = two_sided(context, entry, &parts, &said)?;
    add_backs(context, entry, &mut parts, &sides)?;
    Ok(parts)
}

/// The shape of an entry with the cells that are left out, or `None` where it comes from a file.
fn own_shape(source: &Source, entry: &SurfaceEntry) -> Result<Option<Shape>, SceneError> {
    let shape = shape::shape(source, &entry.shapes())?;
    let Some(cells) = &entry.skip else { return Ok(shape) };
    if let Some(Shape::Quad { corners, .. }) = shape {
        return Ok(Some(Shape::Quad { corners, skip: cells.iter().map(|cell| **cell).collect() }));
    }
    let what = "only a quad has cells to skip".to_owned();
    Err(source.value_error(cells, what, "remove skip, or make the surface a quad"))
}

/// Which parts have two sides: as the entry says, else those that the file `said` have, and the
/// objects of a file whose faces are turned inconsistently.
fn two_sided(
    context: &mut Context,
    entry: &SurfaceEntry,
    parts: &[Part],
    said: &[bool],
) -> Result<Vec<bool>, SceneError> {
    match (entry.two_sided, entry.mesh_file()) {
        (Some(given), _) => Ok(vec![given; parts.len()]),
        (None, None) => Ok(vec![false; parts.len()]),
        (None, Some(_)) => turned::two_sided(context, entry, parts, said),
    }
}

fn own(
    context: &Context,
    entry: &SurfaceEntry,
    shape: Shape,
    cutting: &Cutting,
    span: Range<usize>,
) -> Result<Part, SceneError> {
    let source = context.reading.source;
    let Some(name) = &entry.material else {
        let what = format!("the surface `{}` has no material", *entry.name);
        let help = "add a line material = \"…\" with the name of a material";
        return Err(source.error(ErrorKind::MissingKey, entry.name.span(), what, help));
    };
    let material = find_material(source, name, context.own())?;
    let elements = shape.count(cutting).map_err(|e| geometry(source, entry, &e, (source, span)))?;
    Ok(part(entry, &entry.name, material, vec![shape], cutting, elements))
}

/// A surface that `entry` stands for.
pub(super) fn part(
    entry: &SurfaceEntry,
    name: &str,
    material: usize,
    shapes: Vec<Shape>,
    cutting: &Cutting,
    elements: u128,
) -> Part {
    let (name, cutting, span) = (name.to_owned(), cutting.clone(), entry.name.span());
    let origin = if entry.mesh_file().is_some() { Origin::MeshFile } else { Origin::Scene };
    Part { name, material, shapes: Arc::from(shapes), cutting, elements, origin, span }
}

fn add_backs(
    context: &Context,
    entry: &SurfaceEntry,
    parts: &mut Vec<Part>,
    sides: &[bool],
) -> Result<(), SceneError> {
    let material = entry.back_material.as_ref();
    let material =
        material.map(|name| find_material(context.reading.source, name, context.own())).transpose()?;
    if let (Some(name), false) = (&entry.back_material, sides.contains(&true)) {
        let what = "a surface with one side has no back to give a material".to_owned();
        return Err(context.reading.source.value_error(
            name,
            what,
            "add two_sided = true, or remove back_material",
        ));
    }
    let backs: Vec<Part> =
        parts.iter().zip(sides).filter(|(_, two)| **two).map(|(front, _)| back(front, material)).collect();
    parts.extend(backs);
    Ok(())
}

fn back(front: &Part, material: Option<usize>) -> Part {
    let cutting = Cutting { flipped: true, ..front.cutting.clone() };
    let name = format!("{}/back", front.name);
    Part { name, material: material.unwrap_or(front.material), cutting, ..front.clone() }
}

/// Index of the material of this name.
pub(super) fn find_material(
    source: &Source,
    name: &At<String>,
    materials: &[Material],
) -> Result<usize, SceneError> {
    materials.iter().position(|material| material.name == **name).ok_or_else(|| {
        let help = among(name, materials.iter().map(|m| m.name.as_str()), "materials");
        source.error(ErrorKind::Name, name.span(), format!("there is no material `{}`", **name), help)
    })
}

/// What the mesh says about a shape at `origin`, or about how the entry has it cut.
pub(super) fn geometry(
    source: &Source,
    entry: &SurfaceEntry,
    error: &MeshError,
    origin: (&Source, Range<usize>),
) -> SceneError {
    let (what, help) = (format!("surface `{}`: {error}", *entry.name), error.help());
    let kind = match error {
        MeshError::TooLarge { .. } => ErrorKind::TooLarge,
        _ => ErrorKind::Geometry,
    };
    match cutting::culprit(entry, error) {
        Some(span) => source.error(kind, span, what, help),
        None => origin.0.error(kind, origin.1, what, help),
    }
}
