//! A_i F_ij of any pair of patches: the cheapest method whose error estimate meets the tolerance.
//!
//! | the pair | method |
//! |---|---|
//! | one behind the other, or one occluder across all segments | 0, exactly |
//! | nothing between, apart | double area Gauss, order raised until two agree |
//! | nothing between, close, touching or crossing each other's plane | contour integral on the parts that face each other |
//! | a few occluders between | exact shadow inside, adaptive Gauss outside |
//! | many occluders between | sampled share of the unoccluded value |
//!
//! The tolerance T is relative to the exchange the two patches would have squarely facing each other,
//! A_i A_j / (π d²), or the smaller area where that is less: stated errors of a row of F then add up to about 2 T.

use super::clipped::{Occluded, clipped};
use super::sampled::sampled;
use super::shadow::{PolygonList, Shadow};
use super::{PatchPoints, area_gauss, contour_integral};
use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;
use std::f64::consts::FRAC_1_PI;

/// Heights below this part of the pair's extent count as 0.
const FLAT: f64 = 1e-12;
/// Occluders up to which the exact shadow is cheaper than sampling.
const FEW: usize = 128;
/// Centre distance, in sums of radii, below which the contour integral is used at once.
const CLOSE: f64 = 1.2;

/// How an exchange was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// One patch is behind the other, or one occluder hides it wholly.
    Hidden,
    /// Gauss points on both patches.
    AreaGauss,
    /// Contour integral.
    Contour,
    /// Exact shadow inside, adaptive Gauss outside.
    Clipped,
    /// Sampled visibility.
    Sampled,
}

/// A_i F_ij (m²), its estimated absolute error (m²) and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// A_i F_ij, m².
    pub value: f64,
    /// Estimated absolute error, m².
    pub error: f64,
    /// Method.
    pub method: Method,
}

impl Exchange {
    const NONE: Self = Self { value: 0.0, error: 0.0, method: Method::Hidden };

    /// A factor is not negative: rounding below 0 becomes 0 and is added to the error.
    fn new(method: Method, estimate: Estimate) -> Self {
        let below = (-estimate.value).max(0.0);
        Self { value: estimate.value.max(0.0), error: estimate.error + below, method }
    }
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    candidates: Vec<u32>,
    once: Vec<Vec3>,
    occluders: PolygonList,
    front: [Vec<Vec3>; 2],
    shadow: Shadow,
}

/// Which patch the outer integral goes over.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outer {
    /// The one that the occluders stand farther from. One that stands on a patch makes the outer integrand jump there, but not the
    /// inner integral.
    Clearer,
    /// The first.
    First,
}

/// A patch with what is needed of it.
#[derive(Clone, Copy)]
struct Side<'a> {
    patch: &'a Patch,
    points: &'a PatchPoints,
    plane: HalfSpace,
}

/// Computes exchanges between patches of one scene.
#[derive(Debug)]
pub struct PairIntegrator<'a> {
    patches: Vec<&'a Patch>,
    points: Vec<PatchPoints>,
    occluders: &'a Occluders,
    tolerance: f64,
}

impl<'a> PairIntegrator<'a> {
    /// Prepares the patches; `occluders` are what may stand between them, `tolerance` is T of the module's text.
    pub fn new(
        patches: impl IntoIterator<Item = &'a Patch>,
        occluders: &'a Occluders,
        tolerance: f64,
    ) -> Self {
        let patches: Vec<_> = patches.into_iter().collect();
        let points = patches.iter().map(|p| PatchPoints::new(p)).collect();
        Self { patches, points, occluders, tolerance }
    }

    /// Number of patches.
    #[must_use]
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there are no patches.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// The smaller of two areas, m².
    #[must_use]
    pub fn smaller_area(&self, i: usize, j: usize) -> f64 {
        self.patches[i].area().min(self.patches[j].area())
    }

    /// A_i F_ij of patches i and j.
    pub fn exchange(&self, i: usize, j: usize, work: &mut Workspace) -> Exchange {
        self.compute(i, j, Outer::Clearer, work)
    }

    /// A_i F_ij with the outer integral, where there is one, over patch i: against the same of (j, i) it tests reciprocity.
    pub fn exchange_from(&self, i: usize, j: usize, work: &mut Workspace) -> Exchange {
        self.compute(i, j, Outer::First, work)
    }

    fn compute(&self, i: usize, j: usize, outer: Outer, work: &mut Workspace) -> Exchange {
        if i == j {
            return Exchange::NONE;
        }
        let (a, b) = (self.side(i), self.side(j));
        let flat = FLAT * extent(a.patch, b.patch);
        if !rises(b.patch, a.plane, flat) || !rises(a.patch, b.plane, flat) {
            return Exchange::NONE;
        }
        let tolerance = self.tolerance * facing_exchange(a.patch, b.patch);
        self.occluders.shaft(a.patch, b.patch, &mut work.candidates);
        self.between(a, b, flat, work);
        if work.occluders.len() == 0 {
            return unoccluded(a, b, flat, tolerance, work);
        }
        if hides(a.patch, b.patch, &work.occluders) {
            return Exchange { method: Method::Hidden, ..Exchange::NONE };
        }
        if work.occluders.len() <= FEW {
            let keep = outer == Outer::First || clearance(a, work) >= clearance(b, work);
            let (a, b) = if keep { (a, b) } else { (b, a) };
            return behind_few(a, b, flat, tolerance, work);
        }
        self.behind_many(a, b, flat, tolerance, work)
    }

    fn side(&self, i: usize) -> Side<'_> {
        let patch = self.patches[i];
        let plane = HalfSpace::through(patch.centroid(), patch.normal());
        Side { patch, points: &self.points[i], plane }
    }

    /// Clips the candidates to the space in front of both patches.
    fn between(&self, a: Side, b: Side, flat: f64, work: &mut Workspace) {
        work.occluders.clear();
        for &candidate in &work.candidates {
            work.once.clear();
            clip(self.occluders.patches()[candidate as usize].corners(), a.plane, flat, &mut work.once);
            work.occluders.push_with(|corners| clip(&work.once, b.plane, flat, corners));
        }
    }

    fn behind_many(&self, a: Side, b: Side, flat: f64, tolerance: f64, work: &mut Workspace) -> Exchange {
        let open = unoccluded(a, b, flat, tolerance, work);
        let open = Estimate { value: open.value, error: open.error };
        let sees = |p, q| self.occluders.unoccluded(p, q);
        Exchange::new(Method::Sampled, sampled(a.patch, b.patch, open, tolerance, sees))
    }
}

/// Integrates over `a` what its points see of `b`.
fn behind_few(a: Side, b: Side, flat: f64, tolerance: f64, work: &mut Workspace) -> Exchange {
    let cells = front_cells(a.patch, b.plane, flat, work);
    front(b.patch, a.plane, flat, &mut work.front[1]);
    let scene = Occluded { target: &work.front[1], occluders: &work.occluders };
    Exchange::new(Method::Clipped, clipped(&cells, &scene, tolerance, &mut work.shadow))
}

fn unoccluded(a: Side, b: Side, flat: f64, tolerance: f64, work: &mut Workspace) -> Exchange {
    let whole = clears(a.patch, b.plane, flat) && clears(b.patch, a.plane, flat);
    if whole
        && apart(a.patch, b.patch)
        && let Some(estimate) = area_gauss((a.patch, a.points), (b.patch, b.points), tolerance)
    {
        return Exchange::new(Method::AreaGauss, estimate);
    }
    let [front_a, front_b] = &mut work.front;
    front(a.patch, b.plane, flat, front_a);
    front(b.patch, a.plane, flat, front_b);
    Exchange::new(Method::Contour, contour_integral(front_a, front_b, 0.1 * tolerance))
}

/// Whether one of the occluders blocks every segment between two patches. Where a plane is crossed by the segments between all
/// corners inside a convex polygon, it is so by those between all points: the crossings are convex combinations.
fn hides(a: &Patch, b: &Patch, occluders: &PolygonList) -> bool {
    occluders.iter().any(|o| {
        let edges = || o.iter().zip(o.iter().cycle().skip(1));
        let blocks = |p: Vec3, q: Vec3| {
            let turn = |(&e, &f): (&Vec3, &Vec3)| (e - p).cross(f - p).dot(q - p);
            edges().all(|e| turn(e) > 0.0) || edges().all(|e| turn(e) < 0.0)
        };
        blocks(a.centroid(), b.centroid())
            && a.corners().iter().all(|&p| b.corners().iter().all(|&q| blocks(p, q)))
    })
}

/// Largest distance that matters to a pair.
fn extent(a: &Patch, b: &Patch) -> f64 {
    let rounding = a.corner(0).abs().max_element() * 1e-3;
    a.centroid().distance(b.centroid()) + a.diameter() + b.diameter() + rounding
}

/// A_i A_j / (π d²), at most the smaller area.
fn facing_exchange(a: &Patch, b: &Patch) -> f64 {
    let d2 = a.centroid().distance_squared(b.centroid());
    (FRAC_1_PI * a.area() * b.area() / d2).min(a.area().min(b.area()))
}

fn rises(patch: &Patch, plane: HalfSpace, flat: f64) -> bool {
    patch.corners().iter().any(|&x| plane.height(x) > flat)
}

fn clears(patch: &Patch, plane: HalfSpace, flat: f64) -> bool {
    patch.corners().iter().all(|&x| plane.height(x) > -flat)
}

fn apart(a: &Patch, b: &Patch) -> bool {
    a.centroid().distance(b.centroid()) > CLOSE * 0.5 * (a.diameter() + b.diameter())
}

/// The part of a patch in front of a plane.
fn front(patch: &Patch, plane: HalfSpace, flat: f64, corners: &mut Vec<Vec3>) {
    corners.clear();
    clip(patch.corners(), plane, flat, corners);
}

/// The part of a patch in front of a plane, as patches: itself, or a fan of triangles.
fn front_cells(patch: &Patch, plane: HalfSpace, flat: f64, work: &mut Workspace) -> Vec<Patch> {
    if clears(patch, plane, flat) {
        return vec![*patch];
    }
    let corners = &mut work.front[0];
    front(patch, plane, flat, corners);
    // A sliver that is no patch has no area to add.
    let fan = (2..corners.len()).map(|k| Patch::triangle([corners[0], corners[k - 1], corners[k]]));
    fan.filter_map(Result::ok).collect()
}

/// Smallest height of the occluders over a patch, in its diameters.
fn clearance(side: Side, work: &Workspace) -> f64 {
    let heights = work.occluders.iter().flatten().map(|&x| side.plane.height(x));
    heights.fold(f64::INFINITY, f64::min) / side.patch.diameter()
}
