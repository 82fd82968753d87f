//! How a surface entry is cut into faces and elements.

use std::ops::Range;

use fredholm_mesh::{Cutting, Lines, MeshError};

use crate::error::{ErrorKind, SceneError};
use crate::format::{At, SceneEntry, SurfaceEntry};
use crate::source::Source;

pub(super) fn cutting(
    source: &Source,
    scene: &SceneEntry,
    entry: &SurfaceEntry,
) -> Result<Cutting, SceneError> {
    let per_face = entry.elements_per_face.as_ref().or(scene.elements_per_face.as_ref());
    let elements_per_side = per_face.map_or(Ok(1), |number| square_root(source, number))?;
    Ok(Cutting { lines: lines(source, entry)?, elements_per_side, flipped: false })
}

/// The part of the entry that a complaint of the mesh is about, where it is not the shape.
pub(super) fn culprit(entry: &SurfaceEntry, error: &MeshError) -> Option<Range<usize>> {
    match error {
        MeshError::BadLines { direction, index } => {
            let lines = if *direction == "u" { &entry.u_lines } else { &entry.v_lines };
            lines.as_ref().map(|list| list.get(*index).map_or(list.span(), At::span))
        }
        MeshError::NoSuchCell { i, j, .. } => {
            entry.skip.as_ref()?.iter().find(|cell| ***cell == [*i, *j]).map(At::span)
        }
        MeshError::NothingLeft => entry.skip.as_ref().map(At::span),
        MeshError::NoPieces { .. }
        | MeshError::UnequalCounts { .. }
        | MeshError::LinesOnTriangles
        | MeshError::TooLarge { .. } => Some(density(entry)),
        _ => None,
    }
}

/// The part of an entry that decides on the number of elements.
pub(super) fn density(entry: &SurfaceEntry) -> Range<usize> {
    let way = ways(entry).first().map(|(_, span)| span.clone());
    way.or(entry.elements_per_face.as_ref().map(At::span)).unwrap_or(entry.name.span())
}

fn lines(source: &Source, entry: &SurfaceEntry) -> Result<Lines, SceneError> {
    only_way(source, entry)?;
    if let Some(divide) = &entry.divide {
        return Ok(Lines::Counts { u: count(source, &divide[0])?, v: count(source, &divide[1])? });
    }
    if let Some(edge) = &entry.largest_edge {
        return Ok(Lines::LargestEdge(source.positive(edge, "largest_edge")?));
    }
    if entry.u_lines.is_none() && entry.v_lines.is_none() {
        return Ok(Lines::Whole);
    }
    let parameters = |list: &Option<At<Vec<At<f64>>>>| match list {
        Some(list) => list.iter().map(|line| source.finite(line, "the line")).collect(),
        None => Ok(vec![0.0, 1.0]),
    };
    Ok(Lines::Explicit { u: parameters(&entry.u_lines)?, v: parameters(&entry.v_lines)? })
}

fn only_way(source: &Source, entry: &SurfaceEntry) -> Result<(), SceneError> {
    let ways = ways(entry);
    let Some((second, span)) = ways.get(1) else { return Ok(()) };
    let what = format!("the surface `{}` is cut by {} and by {second}", *entry.name, ways[0].0);
    let help = "keep one of divide, u_lines with v_lines, largest_edge";
    Err(source.error(ErrorKind::Value, span.clone(), what, help))
}

fn ways(entry: &SurfaceEntry) -> Vec<(&'static str, Range<usize>)> {
    let lines = entry.u_lines.as_ref().or(entry.v_lines.as_ref());
    let all = [
        ("divide", entry.divide.as_ref().map(At::span)),
        ("lines", lines.map(At::span)),
        ("largest_edge", entry.largest_edge.as_ref().map(At::span)),
    ];
    all.into_iter().filter_map(|(key, span)| Some((key, span?))).collect()
}

fn count(source: &Source, number: &At<u64>) -> Result<usize, SceneError> {
    if **number > 0 {
        return Ok(**number as usize);
    }
    Err(source.value_error(number, "a surface cannot be cut into 0 pieces".to_owned(), "write at least 1"))
}

fn square_root(source: &Source, number: &At<u64>) -> Result<usize, SceneError> {
    let root = number.isqrt();
    if root > 0 && root * root == **number {
        return Ok(root as usize);
    }
    let what = format!("elements_per_face is {}, not a square number", **number);
    let help = if root == 0 {
        "write 1, 4, 9 or 16, say, for 1 × 1 to 4 × 4 elements".to_owned()
    } else {
        format!("write {} or {}, for n × n elements", root * root, (root + 1) * (root + 1))
    };
    Err(source.value_error(number, what, &help))
}
