//! Lambert's kernel cosθ cosθ' V / (π r²) between flat elements behind occluders, with what a point
//! sees of an element cut out exactly.
//!
//! From p, the visible part of element j is a few convex polygons ([`VisibleParts`]). On each, a
//! rule is chosen by the distance: symmetric rules of rising degree, and within about a size of the
//! polygon the nearly singular rule. Its weights are then multiplied so that their sum is the exact
//! form factor of the polygon (Lambert's sum over edges): constants are integrated exactly, so that
//! in a closed scene the weights of all elements sum to 1 at every p, and only the moments of
//! higher degree carry the error of the rule. For degree 0 one point with the exact factor
//! suffices.

use super::{Exchanges, Sink, Transfer};
use crate::inverse::Inverse;
use crate::surface::Rules;
use crate::{DiscretisationError, FlatChart, Site, Surface};
use fredholm_coupling::form_factor::{PairIntegrator, VisibleParts, point_to_polygon};
use fredholm_coupling::kernel::lambert;
use fredholm_coupling::{Assembled, assemble, exposed_shares, extents};
use fredholm_linop::{Quiet, Steps, Watch};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::{PlanePoint, near_triangle, symmetric_triangle};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::Bodies;

/// Distance over radius of a triangle above which a rule of the degree does, with the largest
/// first.
const RULES: [(f64, usize); 4] = [(12.0, 4), (6.0, 6), (3.5, 10), (2.0, 16)];
/// Points a direction of the nearly singular rule.
const NEARLY_SINGULAR_POINTS: usize = 8;
/// Centre distance over the sum of radii above which a pair is regular.
const REGULAR_DISTANCE: f64 = 3.0;
/// Points a direction for receivers, beyond the degree.
pub(crate) const RECEIVER_POINTS_BEYOND_DEGREE: usize = 3;

/// Diffuse light between the leaves of a mesh.
#[derive(Debug)]
pub struct FlatLambert<'a> {
    surface: Surface,
    patches: Vec<Patch>,
    inverses: Vec<Inverse>,
    occluders: &'a Occluders,
    bodies: Bodies,
    tolerance: f64,
    rules: Vec<(f64, Vec<PlanePoint>)>,
    steps: Option<Steps<'a>>,
}

impl<'a> FlatLambert<'a> {
    /// Takes flat elements with their faces; `occluders` are what may stand between them.
    /// `tolerance` is that of the form factors of degree 0, relative as in [`PairIntegrator`].
    ///
    /// # Errors
    /// [`DiscretisationError::Dimension`] where there is not one face for each patch.
    pub fn new(
        patches: Vec<Patch>,
        faces: Vec<usize>,
        occluders: &'a Occluders,
        tolerance: f64,
    ) -> Result<Self, DiscretisationError> {
        let charts = patches.iter().map(|&patch| Box::new(FlatChart(patch)) as _).collect();
        let surface = Surface::new(charts, faces)?;
        let rule = |(ratio, degree)| Ok((ratio, symmetric_triangle(degree)?));
        let rules = RULES.into_iter().map(rule).collect::<Result<_, DiscretisationError>>()?;
        let bodies = Bodies::new(occluders, &patches.iter().collect::<Vec<_>>(), &[]);
        let inverses = patches.iter().map(Inverse::of).collect();
        Ok(Self { surface, patches, inverses, occluders, bodies, tolerance, rules, steps: None })
    }

    /// Tells `watch` of the progress of an assembly.
    #[must_use]
    pub fn watched(mut self, watch: &'a dyn Watch) -> Self {
        self.steps = Some(Steps::new(watch, self.patches.len() as u64, "elements"));
        self
    }

    /// Weighted points for the parts of element j that p sees, `factor` being the exact form factor
    /// of all.
    fn points(&self, p: &Site, j: usize, view: &VisibleParts, points: &mut Vec<PlanePoint>) {
        points.clear();
        for part in view.parts() {
            let start = points.len();
            for k in 2..part.len() {
                self.triangle(p, j, [part[0], part[k - 1], part[k]], points);
            }
            let exact = point_to_polygon(p.normal, part.iter().copied());
            normalise(&mut points[start..], exact);
        }
    }

    /// The rule for a triangle with corners relative to p.
    fn triangle(&self, p: &Site, j: usize, corners: [Vec3; 3], points: &mut Vec<PlanePoint>) {
        let [a, b, c] = corners;
        let twice = (b - a).cross(c - a).length();
        let centre = (a + b + c) / 3.0;
        let radius = corners.iter().map(|x| x.distance(centre)).fold(0.0, f64::max);
        let far = self.rules.iter().find(|(ratio, _)| centre.length() > ratio * radius);
        let near: Vec<PlanePoint>;
        let rule = if let Some((_, rule)) = far {
            rule
        } else {
            near = near_triangle(corners.map(|x| x.to_array()), [0.0; 3], NEARLY_SINGULAR_POINTS);
            &near
        };
        for s in rule {
            let q = a + (b - a) * s.u + (c - a) * s.v;
            let k = lambert(Vec3::ZERO, p.normal, q, self.patches[j].normal());
            let (u, v) = self.inverses[j].at(p.position + q);
            points.push(PlanePoint { u, v, weight: s.weight * twice * k });
        }
    }
}

/// Scales weights to the sum `exact`.
fn normalise(points: &mut [PlanePoint], exact: f64) {
    let sum: f64 = points.iter().map(|p| p.weight).sum();
    // Where rounding leaves no weight there is nothing to see.
    let scale = if sum > 0.0 { exact / sum } else { 0.0 };
    for point in points {
        point.weight *= scale;
    }
}

/// Mean of the corners and largest distance from it.
fn ball(patch: &Patch) -> (Vec3, f64) {
    let centre = patch.corners().iter().sum::<Vec3>() / patch.sides() as f64;
    (centre, patch.corners().iter().map(|x| x.distance(centre)).fold(0.0, f64::max))
}

/// Whether all of `b` is in front of `a`.
fn clears(a: &Patch, b: &Patch) -> bool {
    b.corners().iter().all(|x| (*x - a.corner(0)).dot(a.normal()) >= 0.0)
}

impl Transfer for FlatLambert<'_> {
    fn surface(&self) -> &Surface {
        &self.surface
    }

    fn kernel(&self, p: &Site, q: &Site) -> f64 {
        let open = lambert(p.position, p.normal, q.position, q.normal);
        if open > 0.0 && self.occluders.unoccluded(p.position, q.position) { open } else { 0.0 }
    }

    fn is_regular(&self, i: usize, j: usize) -> bool {
        let (a, b) = (&self.patches[i], &self.patches[j]);
        let ((ca, ra), (cb, rb)) = (ball(a), ball(b));
        let apart = ca.distance(cb) > REGULAR_DISTANCE * (ra + rb);
        let open = || {
            let mut view = VisibleParts::new(self.occluders, &self.bodies);
            view.prepare(a, b) && view.is_open()
        };
        apart && clears(a, b) && clears(b, a) && open()
    }

    fn send(&self, sites: &[Site], j: usize, degree: usize, each: &mut Sink) {
        let Some(first) = sites.first() else { return };
        let mut view = VisibleParts::new(self.occluders, &self.bodies);
        if first.element == j || !view.prepare(&self.patches[first.element], &self.patches[j]) {
            return;
        }
        let middle = if self.patches[j].sides() == 3 { 1.0 / 3.0 } else { 0.5 };
        let mut points = Vec::new();
        for (at, p) in sites.iter().enumerate() {
            let factor = view.factor(p.position);
            if factor <= 0.0 {
                continue;
            }
            if degree == 0 {
                each(at, &[PlanePoint { u: middle, v: middle, weight: factor }]);
            } else {
                self.points(p, j, &view, &mut points);
                each(at, &points);
            }
        }
    }

    fn advance(&self) {
        if let Some(steps) = &self.steps {
            // An assembly that is no longer wanted ends with its process: it has nothing to save.
            let _ = steps.begin();
        }
    }

    fn outer(&self, degree: usize) -> Rules {
        Rules::gauss(degree + RECEIVER_POINTS_BEYOND_DEGREE)
    }

    fn exchanges(&self) -> Option<Result<Exchanges, DiscretisationError>> {
        Some(self.integrate_pairs())
    }
}

impl FlatLambert<'_> {
    /// The form factors of the radiosity system, with the exposed areas of elements that are partly
    /// buried.
    fn integrate_pairs(&self) -> Result<Exchanges, DiscretisationError> {
        let integrator = PairIntegrator::new(&self.patches, self.occluders, self.tolerance);
        let assembled: Assembled<f64> = assemble(&integrator, &Quiet)?;
        let patches: Vec<&Patch> = self.patches.iter().collect();
        let shares = exposed_shares(&patches, &Occluders::new(&self.patches)?);
        let sizes = extents(&patches, &shares, &assembled.matrix.row_sums());
        Ok(Exchanges { matrix: assembled.matrix, sizes })
    }
}
