//! Receivers of a scene: points, or directions of the far field.

use std::collections::BTreeSet;
use std::ops::Range;

use fredholm_mesh::Vec3;

use super::choices::{AnglesEntry, RangeEntry};
use super::format::{CircleEntry, FarEntry, GridEntry, LineEntry, ReceiverEntry};
use super::sources::vector;
use crate::error::{ErrorKind, SceneError};
use crate::format::At;
use crate::source::Source;

/// Most points and directions of all receivers together.
const MOST_PLACES: u128 = 20_000_000;

/// What is done with the fields of a receiver.
#[derive(Clone, Debug, PartialEq)]
pub enum Layout {
    /// Rows of the table only.
    Points,
    /// A polar plot too: degrees from the start.
    Circle(Vec<f64>),
    /// Pictures too: points in a row.
    Grid(usize),
}

/// Where fields are asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Places {
    /// Points, m.
    Near {
        /// The points, m.
        points: Vec<Vec3>,
        /// How they lie.
        layout: Layout,
    },
    /// θ and φ, degrees.
    Far(Vec<[f64; 2]>),
    /// θ and φ of the directions that plane waves come from and go back to, degrees.
    Monostatic(Vec<[f64; 2]>),
}

/// A receiver, as it is described: its places are not made before they are asked for.
#[derive(Clone, Debug)]
pub struct Receiver {
    /// Its name, fit for a file.
    pub name: String,
    shape: Shape,
    pub(super) span: Range<usize>,
}

#[derive(Clone, Debug)]
enum Shape {
    Points(Vec<Vec3>),
    Line(LineEntry),
    Circle(Circle),
    Grid(GridEntry),
    Far(FarEntry),
    Monostatic(FarEntry),
}

/// A circle with unit vectors along its first point and a quarter further.
#[derive(Clone, Debug)]
struct Circle {
    centre: Vec3,
    radius: f64,
    first: Vec3,
    second: Vec3,
    points: u32,
}

impl Receiver {
    /// Number of its points or directions, known without making them.
    #[must_use]
    pub fn count(&self) -> u128 {
        match &self.shape {
            Shape::Points(points) => points.len() as u128,
            Shape::Line(line) => line.points.into(),
            Shape::Circle(circle) => circle.points.into(),
            Shape::Grid(grid) => u128::from(grid.columns) * u128::from(grid.rows),
            Shape::Far(far) | Shape::Monostatic(far) => far.theta_degrees.count() * far.phi_degrees.count(),
        }
    }

    /// Whether its waves come back to where they come from.
    #[must_use]
    pub fn is_monostatic(&self) -> bool {
        matches!(self.shape, Shape::Monostatic(_))
    }

    /// Whether it is at points, not in directions of the far field.
    #[must_use]
    pub fn is_near(&self) -> bool {
        !matches!(self.shape, Shape::Far(_) | Shape::Monostatic(_))
    }

    /// Its points or directions.
    #[must_use]
    pub fn places(&self) -> Places {
        let near = |points, layout| Places::Near { points, layout };
        match &self.shape {
            Shape::Points(points) => near(points.clone(), Layout::Points),
            Shape::Line(line) => near(on_line(line), Layout::Points),
            Shape::Circle(circle) => circle.places(),
            Shape::Grid(grid) => near(on_grid(grid), Layout::Grid(grid.columns as usize)),
            Shape::Far(far) => Places::Far(far.directions()),
            Shape::Monostatic(far) => Places::Monostatic(far.directions()),
        }
    }
}

/// The unit vector with the angles θ from +z and φ from +x about z, degrees.
#[must_use]
pub fn direction(theta_degrees: f64, phi_degrees: f64) -> Vec3 {
    let (sin_theta, cos_theta) = theta_degrees.to_radians().sin_cos();
    let (sin_phi, cos_phi) = phi_degrees.to_radians().sin_cos();
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// The receivers of a scene, at least one.
pub(super) fn receivers(source: &Source, entries: &[At<ReceiverEntry>]) -> Result<Vec<Receiver>, SceneError> {
    if entries.is_empty() {
        let help = "add a [[receiver]] with a name and points, line, circle, grid, far or monostatic";
        let end = source.text.len();
        return Err(source.error(ErrorKind::Empty, end..end, "the scene has no receiver", help));
    }
    let (mut names, mut total, mut all) = (BTreeSet::new(), 0_u128, Vec::new());
    for entry in entries {
        let found = receiver(source, entry, &mut names)?;
        total = total.saturating_add(found.count());
        if found.count() == 0 {
            let what = format!("the receiver `{}` has 0 receiver points", found.name);
            return Err(source.error(ErrorKind::Empty, entry.span(), what, "ask for at least 1"));
        }
        if total > MOST_PLACES {
            let what = format!("with `{}` there are {total} receiver points", found.name);
            let help = format!("ask for at most {MOST_PLACES} points and directions in all");
            return Err(source.error(ErrorKind::TooLarge, entry.span(), what, help));
        }
        all.push(found);
    }
    Ok(all)
}

fn receiver(
    source: &Source,
    entry: &At<ReceiverEntry>,
    names: &mut BTreeSet<String>,
) -> Result<Receiver, SceneError> {
    let name = &entry.name;
    if !fit_for_a_file(name) || !names.insert(String::clone(name)) {
        let what = format!("`{}` is no name for a receiver, or is given twice", **name);
        let help = "give every receiver its own name of letters, digits, - and _";
        return Err(source.error(ErrorKind::Name, name.span(), what, help));
    }
    Ok(Receiver { name: String::clone(name), shape: shape(source, entry)?, span: entry.span() })
}

/// Names of receivers become names of files.
fn fit_for_a_file(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !name.is_empty() && name.len() <= 60 && name.chars().all(plain)
}

fn shape(source: &Source, entry: &At<ReceiverEntry>) -> Result<Shape, SceneError> {
    let ReceiverEntry { points, line, circle, grid, far, monostatic, .. } = &**entry;
    let found = match (points, line, circle, grid, far, monostatic) {
        (Some(points), None, None, None, None, None) => Shape::Points(points.iter().map(vector).collect()),
        (None, Some(line), None, None, None, None) => Shape::Line(LineEntry::clone(line)),
        (None, None, Some(circle), None, None, None) => Shape::Circle(self::circle(source, entry, circle)?),
        (None, None, None, Some(grid), None, None) => Shape::Grid(GridEntry::clone(grid)),
        (None, None, None, None, Some(far), None) => Shape::Far(FarEntry::clone(far)),
        (None, None, None, None, None, Some(back)) => Shape::Monostatic(FarEntry::clone(back)),
        _ => {
            let what = format!("the receiver `{}` needs exactly one shape", *entry.name);
            let help = "give one of points, line, circle, grid, far, monostatic";
            return Err(source.error(ErrorKind::Value, entry.span(), what, help));
        }
    };
    if found.is_collapsed() {
        let what = format!("all points of the receiver `{}` fall together, or onto a line", *entry.name);
        let help = "give the line a length, and the grid two directions";
        return Err(source.error(ErrorKind::Value, entry.span(), what, help));
    }
    if found.is_finite() {
        return Ok(found);
    }
    let what = "a coordinate or an angle is not finite";
    Err(source.error(ErrorKind::Value, entry.span(), what, "write finite numbers"))
}

impl Shape {
    /// Whether a line has no length, or a grid no area, though it is to have several points there.
    fn is_collapsed(&self) -> bool {
        match self {
            Self::Line(line) => line.points > 1 && vector(&line.from) == vector(&line.to),
            Self::Grid(grid) => {
                let (u, v) = (vector(&grid.u), vector(&grid.v));
                let (across, up) = (grid.columns > 1, grid.rows > 1);
                across && u == Vec3::ZERO || up && v == Vec3::ZERO || across && up && u.cross(v) == Vec3::ZERO
            }
            _ => false,
        }
    }

    /// Whether all numbers that it is described by are finite.
    fn is_finite(&self) -> bool {
        let finite = |vectors: &[[f64; 3]]| vectors.iter().flatten().all(|x| x.is_finite());
        match self {
            Self::Points(points) => points.iter().all(|p| p.is_finite()),
            Self::Line(line) => finite(&[line.from, line.to]),
            Self::Circle(circle) => circle.centre.is_finite() && circle.radius.is_finite(),
            Self::Grid(grid) => finite(&[grid.corner, grid.u, grid.v]),
            Self::Far(far) | Self::Monostatic(far) => {
                far.theta_degrees.is_finite() && far.phi_degrees.is_finite()
            }
        }
    }
}

impl AnglesEntry {
    fn count(&self) -> u128 {
        match self {
            Self::One(_) => 1,
            Self::List(angles) => angles.len() as u128,
            Self::Range(range) => range.points.into(),
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::One(angle) => angle.is_finite(),
            Self::List(angles) => angles.iter().all(|angle| angle.is_finite()),
            Self::Range(range) => range.from.is_finite() && range.to.is_finite(),
        }
    }

    fn angles(&self) -> Vec<f64> {
        match self {
            Self::One(angle) => vec![*angle],
            Self::List(angles) => angles.clone(),
            Self::Range(RangeEntry { from, to, points }) => {
                (0..*points).map(|i| from + (to - from) * share(i, *points)).collect()
            }
        }
    }
}

impl FarEntry {
    /// Every θ with every φ.
    fn directions(&self) -> Vec<[f64; 2]> {
        let (thetas, phis) = (self.theta_degrees.angles(), self.phi_degrees.angles());
        let pair = |&theta: &f64| phis.iter().map(move |&phi| [theta, phi]);
        thetas.iter().flat_map(pair).collect()
    }
}

fn on_line(LineEntry { from, to, points }: &LineEntry) -> Vec<Vec3> {
    let (from, to) = (vector(from), vector(to));
    (0..*points).map(|i| from.lerp(to, share(i, *points))).collect()
}

/// i of n even steps that include both ends.
pub(super) fn share(i: u32, n: u32) -> f64 {
    if n > 1 { f64::from(i) / f64::from(n - 1) } else { 0.0 }
}

fn circle(source: &Source, entry: &At<ReceiverEntry>, circle: &CircleEntry) -> Result<Circle, SceneError> {
    let CircleEntry { centre, radius, normal, start, points } = circle;
    let axis = vector(normal).normalize_or_zero();
    let across = vector(start) - axis * axis.dot(vector(start));
    let first = across.normalize_or_zero();
    if axis == Vec3::ZERO || first == Vec3::ZERO || radius.is_nan() || *radius <= 0.0 {
        let what = "the circle has no radius above 0, no normal, or a start along its normal";
        let help = "give a radius, and a start across the normal";
        return Err(source.error(ErrorKind::Value, entry.span(), what, help));
    }
    let second = axis.cross(first);
    Ok(Circle { centre: vector(centre), radius: *radius, first, second, points: *points })
}

impl Circle {
    fn places(&self) -> Places {
        let count = self.points;
        let degrees: Vec<f64> = (0..count).map(|i| 360.0 * f64::from(i) / f64::from(count)).collect();
        let point = |degrees: &f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            self.centre + (self.first * cos + self.second * sin) * self.radius
        };
        Places::Near { points: degrees.iter().map(point).collect(), layout: Layout::Circle(degrees) }
    }
}

fn on_grid(GridEntry { corner, u, v, columns, rows }: &GridEntry) -> Vec<Vec3> {
    let point =
        |i: u32, j: u32| vector(corner) + vector(u) * share(i, *columns) + vector(v) * share(j, *rows);
    (0..*rows).flat_map(|j| (0..*columns).map(move |i| point(i, j))).collect()
}
