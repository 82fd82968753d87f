//! What bodies hide of an exchange: ∫_i h(x) dA with h(x) the exact form factor from x to the hidden part of j, in m².
//!
//! h is smooth between the critical lines ([`critical`](super::critical)), so the source is cut along them. A loose goal is met by the centroids of the
//! cells; else each cell is cut into triangles that get symmetric rules of rising degree ([`Pieces`]). The unoccluded exchange is computed apart, which
//! keeps the singularity of touching patches out of this integral.

use super::critical::{ODD, Plane, critical_planes};
use super::pieces::{Piece, Pieces};
use super::shadow::{Cutter, Hiding, PolygonList};
use fredholm_mesh::Vec3;
use fredholm_quadrature::Estimate;
use fredholm_visibility::body::Body;
use std::f64::consts::FRAC_1_PI;

/// Error of a cell by its centroid over the bend of the hidden part.
const BEND: f64 = 0.04;
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
    /// Normal of the target.
    pub facing: Vec3,
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
    let steep = Steep::of(scene);
    let scale = Scale::of(scene, &steep);
    let rough = work.cells.iter().map(|cell| scale.error(cell)).sum();
    if rough <= goal {
        let by_centroid = |cell: &[Vec3]| {
            let (area, centre) = centroid(cell);
            area * scene.hidden(centre, &mut work.hiding)
        };
        return Estimate { value: work.cells.iter().map(by_centroid).sum(), error: rough };
    }
    let mut pieces =
        Pieces::new(|x| scene.hidden(x, &mut work.hiding), |x| steep.distance(x), &mut work.pieces);
    for cell in work.cells.iter() {
        let (after, before) = cell.split_at(apex(cell));
        let round: Vec<Vec3> = before.iter().chain(after).copied().collect();
        (2..round.len()).for_each(|k| pieces.add([round[0], round[k - 1], round[k]], SMALL * goal));
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

/// How fast the hidden part changes over the source: the border of a shadow moves over the target by at most m times the way of the point, with m the distance of the
/// target's farthest point over that of the nearest body, and the kernel is at most 1/(π D²) with the least distance D of the target.
struct Scale {
    /// (m² + A/D²)/(π D²) with the target area A, m⁻².
    bend: f64,
    /// Largest exchange per area of source.
    most: f64,
}

impl Scale {
    fn of(scene: &Occluded, steep: &Steep) -> Self {
        let ((_, from), (target, to)) = (centroid(scene.source), centroid(scene.target));
        let radius =
            |corners: &[Vec3], centre: Vec3| corners.iter().map(|x| x.distance(centre)).fold(0.0, f64::max);
        let [own, other] = [radius(scene.source, from), radius(scene.target, to)];
        let far = from.distance(to);
        let near = (far - own - other).max((from - to).dot(scene.facing).abs() - own).max(0.0);
        let body = (steep.distance(from) - own).max(0.0);
        let kernel = FRAC_1_PI / (near * near);
        let magnified = (far + other) / body;
        Self {
            bend: (magnified * magnified + target / (near * near)) * kernel,
            most: (target * kernel).min(1.0),
        }
    }

    /// Error of a cell by its centroid: on a cell the hidden part is nearly a quadratic function, so that is its bend times the squared radius of gyration.
    fn error(&self, cell: &[Vec3]) -> f64 {
        let (area, centre) = centroid(cell);
        let gyration = cell.iter().map(|x| x.distance_squared(centre)).sum::<f64>() / (3 * cell.len()) as f64;
        area * (BEND * self.bend * gyration).min(self.most)
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

/// The corner from which a cell is cut into triangles, farthest in [`ODD`]: the order of the corners has no say.
fn apex(cell: &[Vec3]) -> usize {
    let place = |k: &usize| (cell[*k] - cell[0]).dot(ODD);
    (0..cell.len()).max_by(|a, b| place(a).total_cmp(&place(b))).unwrap_or(0)
}
