//! How good a mesh is to compute on.
//!
//! Aspect ratio of a patch with longest side L, perimeter P and area A: L P / (4 A) for a quad, L P
//! / (4 √3 A) for a triangle; 1 for a square and for an equilateral triangle, larger otherwise. C.
//! J. Stimpson et al., The Verdict Geometric Quality Library, SAND2007-1751, 2007. Metres and
//! degrees.

use crate::{Bounds, Mesh, Patch, Vec3};

/// Figures of a mesh, over all its leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Number of surfaces.
    pub surfaces: usize,
    /// Number of faces.
    pub faces: usize,
    /// Number of leaves, that is of unknowns.
    pub leaves: usize,
    /// Number of occluders.
    pub occluders: usize,
    /// Sum of the areas, m².
    pub total_area: f64,
    /// Area of the smallest leaf, m².
    pub smallest_area: f64,
    /// Mean area of the leaves, m².
    pub mean_area: f64,
    /// Area of the largest leaf, m².
    pub largest_area: f64,
    /// Aspect ratio of the worst leaf; 1 at best.
    pub worst_aspect_ratio: f64,
    /// Smallest angle between two sides of a leaf, degrees.
    pub smallest_angle_degrees: f64,
    /// Shortest side of a leaf, m.
    pub shortest_edge: f64,
    /// Box around leaves and occluders.
    pub bounds: Bounds,
}

impl Quality {
    /// Figures of a mesh; none for an empty one.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let bounds = mesh.bounds()?;
        let total_area = mesh.patches().map(Patch::area).sum();
        let least = |figure: fn(&Patch) -> f64| mesh.patches().map(figure).fold(f64::INFINITY, f64::min);
        let largest = |figure: fn(&Patch) -> f64| mesh.patches().map(figure).fold(0.0, f64::max);
        (!mesh.is_empty()).then(|| Self {
            surfaces: mesh.surfaces().len(),
            faces: mesh.faces().len(),
            leaves: mesh.len(),
            occluders: mesh.occluders().len(),
            total_area,
            smallest_area: least(Patch::area),
            mean_area: total_area / mesh.len() as f64,
            largest_area: largest(Patch::area),
            worst_aspect_ratio: largest(aspect_ratio),
            smallest_angle_degrees: least(smallest_angle).to_degrees(),
            shortest_edge: least(|patch| sides(patch).map(Vec3::length).fold(f64::INFINITY, f64::min)),
            bounds,
        })
    }
}

fn sides(patch: &Patch) -> impl Iterator<Item = Vec3> {
    (0..patch.sides()).map(|i| patch.corner(i + 1) - patch.corner(i))
}

fn aspect_ratio(patch: &Patch) -> f64 {
    let longest = sides(patch).map(Vec3::length).fold(0.0, f64::max);
    let perimeter: f64 = sides(patch).map(Vec3::length).sum();
    let best = if patch.sides() == 3 { 3.0_f64.sqrt() } else { 1.0 };
    longest * perimeter / (4.0 * best * patch.area())
}

fn smallest_angle(patch: &Patch) -> f64 {
    let angle = |i: usize| {
        let (before, after) =
            (patch.corner(i) - patch.corner(i + 1), patch.corner(i + 2) - patch.corner(i + 1));
        before.cross(after).length().atan2(before.dot(after))
    };
    (0..patch.sides()).map(angle).fold(f64::INFINITY, f64::min)
}
