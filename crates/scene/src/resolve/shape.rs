//! Shapes of a surface entry: exactly one, with finite numbers in their ranges.

use std::ops::Range;

use fredholm_mesh::{Shape, Vec3};

use crate::error::{ErrorKind, SceneError};
use crate::format::{At, BoxEntry, CylinderEntry, DiscEntry, PolygonEntry, Shapes, SphereEntry, Triple};
use crate::source::Source;

/// Edges around a sphere, where the scene does not say.
const AROUND_SPHERE: usize = 20;
/// Edges around a disc or a cylinder, where the scene does not say.
const AROUND_DISC: usize = 32;

/// Place of the one shape of a surface.
pub(crate) fn only_shape(source: &Source, entry: &Shapes) -> Result<Range<usize>, SceneError> {
    let shapes = present(entry);
    let help = "give exactly one of quad, triangle, polygon, box, sphere, disc, cylinder, mesh, obj";
    match &shapes[..] {
        [(_, span)] => Ok(span.clone()),
        [] => {
            let what = format!("the surface `{}` has no shape", **entry.name);
            Err(source.error(ErrorKind::MissingKey, entry.name.span(), what, help))
        }
        [(first, _), (second, span), ..] => {
            let what = format!("the surface `{}` has two shapes, {first} and {second}", **entry.name);
            Err(source.error(ErrorKind::Value, span.clone(), what, format!("{help}; make two surfaces")))
        }
    }
}

/// The shapes of an entry in the order of the file.
fn present(entry: &Shapes) -> Vec<(&'static str, Range<usize>)> {
    let all = [
        ("quad", entry.quad.map(At::span)),
        ("triangle", entry.triangle.map(At::span)),
        ("polygon", entry.polygon.map(At::span)),
        ("box", entry.cuboid.map(At::span)),
        ("sphere", entry.sphere.map(At::span)),
        ("disc", entry.disc.map(At::span)),
        ("cylinder", entry.cylinder.map(At::span)),
        ("mesh", entry.mesh.map(At::span)),
        ("obj", entry.obj.map(At::span)),
    ];
    let mut present: Vec<_> = all.into_iter().filter_map(|(key, span)| Some((key, span?))).collect();
    present.sort_by_key(|(_, span)| span.start);
    present
}

/// The shape of an entry, or `None` where it comes from a file.
pub(crate) fn shape(source: &Source, entry: &Shapes) -> Result<Option<Shape>, SceneError> {
    let flat = match (entry.quad, entry.triangle, entry.polygon) {
        (Some(corners), _, _) => Some(Shape::Quad { corners: points(source, corners)?, skip: vec![] }),
        (_, Some(corners), _) => Some(Shape::Triangle { corners: points(source, corners)? }),
        (_, _, Some(polygon)) => Some(self::polygon(source, polygon)?),
        _ => None,
    };
    let solid = match (entry.cuboid, entry.sphere, entry.disc, entry.cylinder) {
        (Some(cuboid), _, _, _) => Some(self::cuboid(source, cuboid)?),
        (_, Some(sphere), _, _) => Some(self::sphere(source, sphere)?),
        (_, _, Some(disc), _) => Some(self::disc(source, disc)?),
        (_, _, _, Some(cylinder)) => Some(self::cylinder(source, cylinder)?),
        _ => None,
    };
    Ok(flat.or(solid))
}

fn polygon(source: &Source, entry: &PolygonEntry) -> Result<Shape, SceneError> {
    let ring = |ring: &Vec<Triple>| ring.iter().map(|p| source.vector(p, "the coordinate")).collect();
    let holes = entry.holes.iter().map(ring).collect::<Result<_, SceneError>>()?;
    Ok(Shape::Polygon { outline: ring(&entry.outline)?, holes })
}

fn cuboid(source: &Source, entry: &BoxEntry) -> Result<Shape, SceneError> {
    let min = source.vector(&entry.min, "min")?;
    let max = source.vector(&entry.max, "max")?;
    Ok(Shape::Box { min, max, inward: entry.inward })
}

fn sphere(source: &Source, entry: &SphereEntry) -> Result<Shape, SceneError> {
    Ok(Shape::Sphere {
        centre: source.vector(&entry.centre, "centre")?,
        radius: source.length(&entry.radius, "radius")?,
        inward: entry.inward,
        segments: segments(entry.segments.as_ref(), AROUND_SPHERE),
    })
}

fn disc(source: &Source, entry: &DiscEntry) -> Result<Shape, SceneError> {
    Ok(Shape::Disc {
        centre: source.vector(&entry.centre, "centre")?,
        normal: source.direction(&entry.normal, "normal")?,
        radius: source.length(&entry.radius, "radius")?,
        segments: segments(entry.segments.as_ref(), AROUND_DISC),
    })
}

fn cylinder(source: &Source, entry: &CylinderEntry) -> Result<Shape, SceneError> {
    Ok(Shape::Cylinder {
        base: source.vector(&entry.base, "base")?,
        axis: source.direction(&entry.axis, "axis")?,
        radius: source.length(&entry.radius, "radius")?,
        caps: entry.caps.unwrap_or(true),
        inward: entry.inward,
        segments: segments(entry.segments.as_ref(), AROUND_DISC),
    })
}

fn segments(given: Option<&At<u32>>, otherwise: usize) -> usize {
    given.map_or(otherwise, |segments| **segments as usize)
}

fn points<const N: usize>(source: &Source, corners: &[Triple; N]) -> Result<[Vec3; N], SceneError> {
    let mut points = [Vec3::ZERO; N];
    for (point, corner) in points.iter_mut().zip(corners) {
        *point = source.vector(corner, "the coordinate")?;
    }
    Ok(points)
}
