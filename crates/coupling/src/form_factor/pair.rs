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

use super::hidden::{HiddenWork, Occluded, hidden_exchange};
use super::sampled::sampled;
use super::{PatchPoints, area_gauss, contour_integral};
use crate::occlusion::{Clusters, Sight};
use crate::polygon::{HalfSpace, clip};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Body, Face, Room, Shadow};
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
    front: [Vec<Vec3>; 2],
    room: Room,
    hidden: HiddenWork,
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
    bodies: Bodies,
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
        let bodies = Bodies::new(occluders, &patches, &[]);
        Self { patches, points, occluders, bodies, tolerance }
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
        let bodies = self.between(a.patch, b.patch);
        let nothing = self.bodies.tolerance();
        if bodies.iter().any(|body| blocks(body, a.patch, b.patch, nothing, &mut work.room)) {
            return Exchange::NONE;
        }
        let open = unoccluded(a, b, flat, tolerance, work);
        self.behind_bodies([a, b], outer, &bodies, open, work)
    }

    /// Groups of patches, for the assembly.
    pub(crate) fn clusters(&self) -> Clusters {
        Clusters::new(&self.patches, self.bodies.tolerance())
    }

    /// What decides about the visibility of groups.
    pub(crate) fn sight<'b>(&'b self, clusters: &'b Clusters) -> Sight<'b> {
        Sight { clusters, occluders: self.occluders, bodies: &self.bodies }
    }

    /// The exchanges of patch i with patches that nothing hides.
    pub(crate) fn open_row(&self, i: usize, columns: &[u32], work: &mut Workspace, row: &mut Vec<Exchange>) {
        row.clear();
        row.extend(columns.iter().map(|&j| self.open(i, j as usize, work)));
    }

    fn open(&self, i: usize, j: usize, work: &mut Workspace) -> Exchange {
        let (a, b) = (self.side(i), self.side(j));
        let flat = FLAT * extent(a.patch, b.patch);
        if !rises(b.patch, a.plane, flat) || !rises(a.patch, b.plane, flat) {
            return Exchange::NONE;
        }
        unoccluded(a, b, flat, self.tolerance * facing_exchange(a.patch, b.patch), work)
    }

    /// What is left of an exchange behind bodies given by their numbers.
    pub(crate) fn behind(&self, [i, j]: [usize; 2], bodies: &[u32], open: Exchange, work: &mut Workspace) -> Exchange {
        if open.method == Method::Hidden {
            return open;
        }
        let bodies: Vec<&Body> = bodies.iter().map(|&k| &self.bodies.as_slice()[k as usize]).collect();
        self.behind_bodies([self.side(i), self.side(j)], Outer::Clearer, &bodies, open, work)
    }

    fn behind_bodies(&self, sides: [Side; 2], outer: Outer, bodies: &[&Body], open: Exchange, work: &mut Workspace) -> Exchange {
        let [a, b] = sides;
        let tolerance = self.tolerance * facing_exchange(a.patch, b.patch);
        match bodies.len() {
            0 => open,
            1..=FEW => {
                let keep = outer == Outer::First || clearance(a, bodies) >= clearance(b, bodies);
                let sides = if keep { [a, b] } else { [b, a] };
                self.behind_few(sides, bodies, open, tolerance, work)
            }
            _ => self.behind_many(a, b, open, tolerance),
        }
    }

    fn side(&self, i: usize) -> Side<'_> {
        let patch = self.patches[i];
        let plane = HalfSpace::through(patch.centroid(), patch.normal());
        Side { patch, points: &self.points[i], plane }
    }

    /// The bodies that may come between two patches.
    fn between(&self, a: &Patch, b: &Patch) -> Vec<&Body> {
        let Some(shaft) = self.occluders.shaft_between(a, b) else { return Vec::new() };
        self.bodies.as_slice().iter().filter(|body| self.occluders.reaches(body, &shaft)).collect()
    }

    fn behind_many(&self, a: Side, b: Side, open: Exchange, tolerance: f64) -> Exchange {
        let open = Estimate { value: open.value, error: open.error };
        let sees = |p, q| self.occluders.unoccluded(p, q);
        Exchange::new(Method::Sampled, sampled(a.patch, b.patch, open, tolerance, sees))
    }

    /// What is left of the open exchange: the hidden part goes over the points of `a`.
    fn behind_few(&self, [a, b]: [Side; 2], bodies: &[&Body], open: Exchange, goal: f64, work: &mut Workspace) -> Exchange {
        let flat = FLAT * extent(a.patch, b.patch);
        let [front_a, front_b] = &mut work.front;
        front(a.patch, b.plane, flat, front_a);
        front(b.patch, a.plane, flat, front_b);
        let tolerance = self.bodies.tolerance();
        let cut: Vec<Option<Body>> = bodies.iter().map(|body| between(body, a, b, tolerance)).collect();
        let bodies: Vec<&Body> = cut.iter().zip(bodies).map(|(cut, whole)| cut.as_ref().unwrap_or(whole)).collect();
        let scene = Occluded { source: front_a, normal: a.patch.normal(), target: front_b, bodies: &bodies, tolerance };
        let hidden = hidden_exchange(&scene, goal, &mut work.hidden);
        let left = Estimate { value: open.value - hidden.value, error: open.error + hidden.error };
        Exchange::new(Method::Clipped, left)
    }
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

/// The part of a body in front of both patches, or `None` where that is the whole body.
fn between(body: &Body, a: Side, b: Side, tolerance: f64) -> Option<Body> {
    let [first, second] = [a, b].map(|side| Face { normal: side.plane.normal, offset: side.plane.offset });
    let part = body.in_front(&first, tolerance);
    part.as_ref().unwrap_or(body).in_front(&second, tolerance).or(part)
}

/// Whether a body blocks every segment between two patches. The points that a body hides from a point make a convex set, on either side: what holds for
/// the corners holds for all.
pub(crate) fn blocks(body: &Body, a: &Patch, b: &Patch, tolerance: f64, room: &mut Room) -> bool {
    a.corners().iter().all(|&x| match body.shadow(x, tolerance, room) {
        Shadow::Nothing => false,
        Shadow::Room => b.corners().iter().all(|&y| room.holds(&[y - x])),
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

/// Smallest height of the bodies over a patch, in its diameters.
fn clearance(side: Side, bodies: &[&Body]) -> f64 {
    let heights = bodies.iter().flat_map(|body| body.corners()).map(|&x| side.plane.height(x));
    heights.fold(f64::INFINITY, f64::min) / side.patch.diameter()
}
