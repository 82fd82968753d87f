//! What bodies hide of an exchange: ∫_i h(x) dA with h(x) the exact form factor from x to the hidden part of j, in m².
//!
//! h is smooth between the critical lines ([`critical`](super::critical)), so the source is cut along them. A loose goal is met by the centroids of the
//! cells; else each cell is cut into triangles that get symmetric rules of rising degree ([`Pieces`]). The unoccluded exchange is computed apart, which
//! keeps the singularity of touching patches out of this integral.

use super::critical::{Plane, critical_planes};
use super::pieces::{Piece, Pieces};
use super::shadow::{Cutter, Hiding, PolygonList};
use fredholm_mesh::Vec3;
use fredholm_quadrature::Estimate;
use fredholm_visibility::body::Body;
use std::f64::consts::FRAC_1_PI;

/// Error of a cell by its centroid over the bend of the hidden part.
const BEND: f64 = 0.15;
/// Area over the goal below which a part of the source is not cut further for being close to a body.
const SMALL: f64 = 0.05;
/// Critical lines along which the source is cut at most: the cells grow with their square.
const LINES: usize = 40;

/// The source polygon with its normal, the target, and what stands between.
#[derive(Clone, Copy)]
pub(crate) struct Occluded<'a> {
    pub source: &'a [Vec3],
    pub normal: Vec3,
    pub target: &'a [Vec3],
    pub bodies: &'a [&'a Body],
    /// Heights up to which a point lies on a face, m.
    pub tolerance: f64,
}

impl Occluded<'_> {
    /// The form factor h(x).
    fn hidden(&self, x: Vec3, hiding: &mut Hiding) -> f64 {
        hiding.hidden_factor(x, self.normal, self.target, self.bodies, self.tolerance)
    }
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct HiddenWork {
    hiding: Hiding,
    planes: Vec<Plane>,
    cells: PolygonList,
    spare: PolygonList,
    cutter: Cutter,
    pieces: Vec<Piece>,
}

/// The hidden part of the exchange (m²), to an absolute `goal` (m²).
pub(crate) fn hidden_exchange(scene: &Occluded, goal: f64, work: &mut HiddenWork) -> Estimate {
    cut(scene, work);
    let scale = Scale::of(scene);
    let rough = work.cells.iter().map(|cell| scale.error(cell)).sum();
    if rough <= goal {
        let by_centroid = |cell: &[Vec3]| {
            let (area, centre) = centroid(cell);
            area * scene.hidden(centre, &mut work.hiding)
        };
        return Estimate { value: work.cells.iter().map(by_centroid).sum(), error: rough };
    }
    let steep = Steep::of(scene);
    let mut pieces =
        Pieces::new(|x| scene.hidden(x, &mut work.hiding), |x| steep.distance(x), &mut work.pieces);
    for cell in work.cells.iter() {
        (2..cell.len()).for_each(|k| pieces.add([cell[0], cell[k - 1], cell[k]], SMALL * goal));
    }
    pieces.integrate(goal)
}

/// What makes the hidden part steep where it is close: corners of bodies, and edges that do not lie on the source.
struct Steep {
    edges: Vec<[Vec3; 2]>,
}

impl Steep {
    fn of(scene: &Occluded) -> Self {
        let height = |x: Vec3| (x - scene.source[0]).dot(scene.normal);
        let lies = |x: Vec3| height(x).abs() <= scene.tolerance;
        let on_source =
            |[a, b]: [Vec3; 2]| if lies(a) && lies(b) { vec![[a, a], [b, b]] } else { vec![[a, b]] };
        let edges = scene.bodies.iter().flat_map(|body| body.edges().iter().map(|edge| body.ends(edge)));
        Self { edges: edges.flat_map(on_source).collect() }
    }

    /// Distance of a point from the nearest of them, m.
    fn distance(&self, x: Vec3) -> f64 {
        let to = |&[a, b]: &[Vec3; 2]| {
            let along = b - a;
            let t = ((x - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            x.distance(a + along * t)
        };
        self.edges.iter().map(to).fold(f64::INFINITY, f64::min)
    }
}

/// Cuts the source along its critical lines.
fn cut(scene: &Occluded, work: &mut HiddenWork) {
    let flat = scene.tolerance;
    critical_planes(scene.source, scene.target, scene.bodies, flat, &mut work.planes);
    work.cells.clear();
    work.cells.push_with(|corners| corners.extend_from_slice(scene.source));
    for &(n, c) in work.planes.iter().take(LINES) {
        work.cells.cut(n, c, flat, &mut work.cutter, &mut work.spare);
    }
}

/// How fast the hidden part changes over the source: the border of a shadow moves over the target by m times the way of the point, m = (D − d) / d with the
/// distances D of the target and d of the bodies.
struct Scale {
    /// Squared m / target area + 1 / D², m⁻².
    bend: f64,
    /// Largest exchange per area of source.
    most: f64,
}

impl Scale {
    fn of(scene: &Occluded) -> Self {
        let centre = |polygon: &[Vec3]| polygon.iter().sum::<Vec3>() / polygon.len() as f64;
        let (from, to) = (centre(scene.source), centre(scene.target));
        let way = to - from;
        let along = |x: Vec3| (x - from).dot(way) / way.length_squared();
        let near = scene.bodies.iter().flat_map(|body| body.corners()).map(|&x| along(x)).fold(1.0, f64::min);
        let magnified = if near > 0.0 { (1.0 - near) / near } else { f64::INFINITY };
        let (d2, target) = (way.length_squared(), centroid(scene.target).0);
        Self { bend: magnified * magnified / target + 1.0 / d2, most: (FRAC_1_PI * target / d2).min(1.0) }
    }

    /// Error of a cell by its centroid: on a cell the hidden part is nearly a quadratic function, so that is its bend times the squared radius of gyration.
    fn error(&self, cell: &[Vec3]) -> f64 {
        let (area, centre) = centroid(cell);
        let gyration = cell.iter().map(|x| x.distance_squared(centre)).sum::<f64>() / (3 * cell.len()) as f64;
        area * self.most * (BEND * self.bend * gyration).min(1.0)
    }
}

/// Area (m²) and centroid of a flat polygon.
fn centroid(corners: &[Vec3]) -> (f64, Vec3) {
    let origin = corners[0];
    let fan = || corners.windows(2).map(|e| (e[0] - origin, e[1] - origin)).map(|(a, b)| (a.cross(b), a + b));
    let whole: Vec3 = fan().map(|(doubled, _)| doubled).sum();
    let doubled = whole.length();
    let moment: Vec3 = fan().map(|(part, thrice)| thrice * part.dot(whole)).sum();
    (0.5 * doubled, origin + moment / (3.0 * doubled * doubled))
}
