//! What bodies hide of an exchange: ∫_i h(x) dA with h(x) the exact form factor from x to the hidden part of j, in m².
//!
//! h is smooth between the critical lines ([`critical`](super::critical)), so the source is cut along them and each piece gets symmetric rules of rising degree. The
//! piece with the largest error estimate is improved next: by degree while that pays, else by halving its sides. What several bodies do together is smooth on no
//! cut that lines make; there the halving takes over. The unoccluded exchange is computed apart, which keeps the singularity of touching patches out of this integral.

use super::critical::{Plane, critical_planes};
use super::shadow::{Cutter, Hiding, PolygonList};
use fredholm_mesh::Vec3;
use fredholm_quadrature::{Estimate, PlanePoint, symmetric_triangle};
use fredholm_visibility::body::Body;
use std::sync::LazyLock;

/// Degrees that are tried on a piece.
const DEGREES: [usize; 7] = [1, 2, 4, 7, 10, 14, 20];
/// Ratio of two differences below which a higher degree is expected to pay.
const PAYS: f64 = 0.3;
/// Smallest credible ratio of two differences.
const CREDIBLE: f64 = 0.05;
/// Points after which an integral ends with the error that it has.
const POINTS: usize = 100_000;
/// Critical lines beyond which the source is not cut along them.
const LINES: usize = 40;

static RULES: LazyLock<Vec<Vec<PlanePoint>>> =
    LazyLock::new(|| DEGREES.iter().filter_map(|&degree| symmetric_triangle(degree).ok()).collect());

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

/// A triangle of the source, its integral and how that converged.
#[derive(Clone, Copy, Debug)]
struct Piece {
    corners: [Vec3; 3],
    /// Place in [`DEGREES`].
    degree: usize,
    value: f64,
    /// Difference to the degree before.
    step: f64,
    error: f64,
    pays: bool,
}

/// The hidden part of the exchange (m²), to an absolute `goal` (m²).
pub(crate) fn hidden_exchange(scene: &Occluded, goal: f64, work: &mut HiddenWork) -> Estimate {
    cut(scene, work);
    let mut integral = Integral { scene, hiding: &mut work.hiding, points: 0 };
    work.pieces.clear();
    for cell in work.cells.iter() {
        let fan = (2..cell.len()).map(|k| [cell[0], cell[k - 1], cell[k]]);
        work.pieces.extend(fan.map(|corners| integral.start(corners)));
    }
    integral.improve(&mut work.pieces, goal);
    let sum = |part: fn(&Piece) -> f64| work.pieces.iter().map(part).sum();
    Estimate { value: sum(|p| p.value), error: sum(|p| p.error) }
}

/// Cuts the source along its critical lines.
fn cut(scene: &Occluded, work: &mut HiddenWork) {
    let flat = scene.tolerance;
    critical_planes(scene.source, scene.target, scene.bodies, flat, &mut work.planes);
    work.cells.clear();
    work.cells.push_with(|corners| corners.extend_from_slice(scene.source));
    if work.planes.len() <= LINES {
        for &(n, c) in &work.planes {
            work.cells.cut(n, c, flat, &mut work.cutter, &mut work.spare);
        }
    }
}

struct Integral<'a> {
    scene: &'a Occluded<'a>,
    hiding: &'a mut Hiding,
    points: usize,
}

impl Integral<'_> {
    fn start(&mut self, corners: [Vec3; 3]) -> Piece {
        let [first, value] = [0, 1].map(|degree| self.integrate(&corners, degree));
        let step = (value - first).abs();
        Piece { corners, degree: 1, value, step, error: step, pays: true }
    }

    /// ∫ h dA over a triangle.
    fn integrate(&mut self, corners: &[Vec3; 3], degree: usize) -> f64 {
        let [a, b, c] = *corners;
        let (u, v) = (b - a, c - a);
        let Occluded { normal, target, bodies, tolerance, .. } = *self.scene;
        let rule = &RULES[degree];
        self.points += rule.len();
        let mut at = |p: &PlanePoint| {
            let x = a + u * p.u + v * p.v;
            p.weight * self.hiding.hidden_factor(x, normal, target, bodies, tolerance)
        };
        let sum: f64 = rule.iter().map(&mut at).sum();
        sum * u.cross(v).length()
    }

    fn improve(&mut self, pieces: &mut Vec<Piece>, goal: f64) {
        while self.points < POINTS {
            let total: f64 = pieces.iter().map(|p| p.error).sum();
            let worst = (0..pieces.len()).max_by(|&i, &j| pieces[i].error.total_cmp(&pieces[j].error));
            let Some(worst) = worst.filter(|_| total > goal) else { return };
            if pieces[worst].pays {
                pieces[worst] = self.raise(pieces[worst]);
            } else {
                let parts = quarters(&pieces[worst].corners).map(|corners| self.start(corners));
                pieces[worst] = parts[0];
                pieces.extend_from_slice(&parts[1..]);
            }
        }
    }

    fn raise(&mut self, piece: Piece) -> Piece {
        let degree = piece.degree + 1;
        let value = self.integrate(&piece.corners, degree);
        let step = (value - piece.value).abs();
        let ratio = if piece.step > 0.0 { step / piece.step } else { 1.0 };
        let error = step * ratio.clamp(CREDIBLE, 1.0);
        let pays = ratio < PAYS && degree + 1 < DEGREES.len();
        Piece { degree, value, step, error, pays, ..piece }
    }
}

/// A triangle cut at the middles of its sides.
fn quarters(&[a, b, c]: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(p, q)| 0.5 * (p + q));
    [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
}
