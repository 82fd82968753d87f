//! Receivers of a scene: points, or directions of the far field.

use std::collections::BTreeSet;
use std::ops::Range;

use fredholm_mesh::Vec3;
use toml::Spanned;

use super::format::{AnglesEntry, CircleEntry, FarEntry, GridEntry, LineEntry, ReceiverEntry};
use super::located::SceneText;
use super::sources::{direction, vector};
use crate::error::Error;

/// Most points of all receivers together.
const MOST: usize = 20_000_000;

/// What is done with the fields of a receiver.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Layout {
    /// Rows of the table only.
    Points,
    /// A polar plot too: degrees from the start.
    Circle(Vec<f64>),
    /// Pictures too: points in a row.
    Grid(usize),
}

/// Where fields are asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Places {
    /// Points, m.
    Near { points: Vec<Vec3>, layout: Layout },
    /// θ and φ, degrees.
    Far(Vec<[f64; 2]>),
    /// θ and φ of the directions that plane waves come from and go back to, degrees.
    Monostatic(Vec<[f64; 2]>),
}

impl Places {
    fn len(&self) -> usize {
        match self {
            Self::Near { points, .. } => points.len(),
            Self::Far(angles) | Self::Monostatic(angles) => angles.len(),
        }
    }
}

/// A receiver.
#[derive(Clone, Debug)]
pub(crate) struct Receiver {
    pub(crate) name: String,
    pub(crate) places: Places,
    pub(crate) span: Range<usize>,
}

impl Receiver {
    /// Directions of the far field.
    pub(crate) fn directions(angles: &[[f64; 2]]) -> Vec<Vec3> {
        angles.iter().map(|&[theta, phi]| direction(theta, phi)).collect()
    }
}

/// The receivers of a scene, at least one.
pub(super) fn receivers(
    scene: &SceneText,
    entries: &[Spanned<ReceiverEntry>],
) -> Result<Vec<Receiver>, Error> {
    if entries.is_empty() {
        let help = "add a [[receiver]] with a name and points, line, circle, grid, far or monostatic";
        return Err(scene.fault(scene.end(), "the scene has no receiver", help));
    }
    let (mut names, mut total, mut all) = (BTreeSet::new(), 0, Vec::new());
    for entry in entries {
        let found = receiver(scene, entry, &mut names)?;
        total += found.places.len();
        if total == 0 || total > MOST {
            let what = format!("there are {total} receiver points");
            return Err(scene.fault(entry.span(), what, format!("ask for 1 to {MOST}")));
        }
        all.push(found);
    }
    Ok(all)
}

fn receiver(
    scene: &SceneText,
    entry: &Spanned<ReceiverEntry>,
    names: &mut BTreeSet<String>,
) -> Result<Receiver, Error> {
    let name = entry.get_ref().name.get_ref();
    if !fit_for_a_file(name) || !names.insert(name.clone()) {
        let what = format!("`{name}` is no name for a receiver, or is given twice");
        let help = "give every receiver its own name of letters, digits, - and _";
        return Err(scene.fault(entry.get_ref().name.span(), what, help));
    }
    Ok(Receiver { name: name.clone(), places: places(scene, entry)?, span: entry.span() })
}

/// Names of receivers become names of files.
fn fit_for_a_file(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !name.is_empty() && name.len() <= 60 && name.chars().all(plain)
}

fn places(scene: &SceneText, entry: &Spanned<ReceiverEntry>) -> Result<Places, Error> {
    let ReceiverEntry { points, line, circle, grid, far, monostatic, .. } = entry.get_ref();
    let near = |points, layout| Ok(Places::Near { points, layout });
    let found = match (points, line, circle, grid, far, monostatic) {
        (Some(points), None, None, None, None, None) => {
            near(points.iter().map(vector).collect(), Layout::Points)
        }
        (None, Some(line), None, None, None, None) => near(on_line(line), Layout::Points),
        (None, None, Some(circle), None, None, None) => on_circle(scene, entry, circle),
        (None, None, None, Some(grid), None, None) => on_grid(scene, entry, grid),
        (None, None, None, None, Some(far), None) => far_away(scene, entry, far).map(Places::Far),
        (None, None, None, None, None, Some(back)) => far_away(scene, entry, back).map(Places::Monostatic),
        _ => {
            let what = format!("the receiver `{}` needs exactly one shape", entry.get_ref().name.get_ref());
            Err(scene.fault(entry.span(), what, "give one of points, line, circle, grid, far, monostatic"))
        }
    }?;
    let finite = match &found {
        Places::Near { points, .. } => points.iter().all(|p| p.is_finite()),
        Places::Far(angles) | Places::Monostatic(angles) => {
            angles.iter().flatten().all(|angle| angle.is_finite())
        }
    };
    if finite {
        return Ok(found);
    }
    Err(scene.fault(entry.span(), "a coordinate or an angle is not finite", "write finite numbers"))
}

fn on_line(LineEntry { from, to, points }: &LineEntry) -> Vec<Vec3> {
    let (from, to) = (vector(from), vector(to));
    (0..*points).map(|i| from.lerp(to, share(i, *points))).collect()
}

/// i of n even steps that include both ends.
fn share(i: u32, n: u32) -> f64 {
    if n > 1 { f64::from(i) / f64::from(n - 1) } else { 0.0 }
}

fn on_circle(
    scene: &SceneText,
    entry: &Spanned<ReceiverEntry>,
    circle: &CircleEntry,
) -> Result<Places, Error> {
    let CircleEntry { centre, radius, normal, start, points } = circle;
    let axis = vector(normal).normalize_or_zero();
    let across = vector(start) - axis * axis.dot(vector(start));
    let first = across.normalize_or_zero();
    if axis == Vec3::ZERO || first == Vec3::ZERO || radius.is_nan() || *radius <= 0.0 {
        let what = "the circle has no radius above 0, no normal, or a start along its normal";
        return Err(scene.fault(entry.span(), what, "give a radius, and a start across the normal"));
    }
    let degrees: Vec<f64> = (0..*points).map(|i| 360.0 * f64::from(i) / f64::from(*points)).collect();
    let second = axis.cross(first);
    let point = |degrees: &f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        vector(centre) + (first * cos + second * sin) * *radius
    };
    Ok(Places::Near { points: degrees.iter().map(point).collect(), layout: Layout::Circle(degrees) })
}

fn on_grid(scene: &SceneText, entry: &Spanned<ReceiverEntry>, grid: &GridEntry) -> Result<Places, Error> {
    let GridEntry { corner, u, v, columns, rows } = grid;
    if u64::from(*columns) * u64::from(*rows) > MOST as u64 {
        let what = format!("the grid has {columns} × {rows} points");
        return Err(scene.fault(entry.span(), what, format!("ask for at most {MOST}")));
    }
    let point =
        |i: u32, j: u32| vector(corner) + vector(u) * share(i, *columns) + vector(v) * share(j, *rows);
    let points = (0..*rows).flat_map(|j| (0..*columns).map(move |i| point(i, j))).collect();
    Ok(Places::Near { points, layout: Layout::Grid(*columns as usize) })
}

fn far_away(
    scene: &SceneText,
    entry: &Spanned<ReceiverEntry>,
    far: &FarEntry,
) -> Result<Vec<[f64; 2]>, Error> {
    let (thetas, phis) = (angles(&far.theta_degrees), angles(&far.phi_degrees));
    if thetas.len().saturating_mul(phis.len()) > MOST {
        let what = format!("{} × {} directions", thetas.len(), phis.len());
        return Err(scene.fault(entry.span(), what, format!("ask for at most {MOST}")));
    }
    let pair = |&theta: &f64| phis.iter().map(move |&phi| [theta, phi]);
    Ok(thetas.iter().flat_map(pair).collect())
}

fn angles(entry: &AnglesEntry) -> Vec<f64> {
    match entry {
        AnglesEntry::One(angle) => vec![*angle],
        AnglesEntry::List(angles) => angles.clone(),
        AnglesEntry::Range { from, to, points } => {
            let count = (*points).min(MOST as u32);
            (0..count).map(|i| from + (to - from) * share(i, count)).collect()
        }
    }
}
