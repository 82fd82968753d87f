//! A_i F_ij behind a few occluders: ∫_i f(p) dA with f(p) the exact form factor from p to what it sees of j.
//!
//! The inner integral is closed ([`shadow`](super::shadow)); the outer one is adaptive, because f has kinks where an edge of an occluder lines up with one of the
//! target. In m². A cell is accepted when its 2 × 2 and 3 × 3 Gauss values agree within its share of the tolerance.

use super::area_gauss::place;
use super::point_to_polygon;
use super::shadow::{PolygonList, Shadow};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;

/// Splits of a cell into four.
const DEPTH: u32 = 7;
/// Stated error over the root of the summed squares of the differences: the error of a kinked integrand scatters like the differences do.
const SAFETY: f64 = 2.0;
/// Part of the tolerance at which the difference of the two cheapest values is trusted.
const EARLY: f64 = 0.5;
/// Smallest credible ratio of two differences.
const CREDIBLE: f64 = 0.1;

/// Part of the way from a corner to the centre at which the corner is looked at.
const INSET: f64 = 1e-3;
/// Share of a cell that lies between its corners and the outermost points, and that a shadow may cover unseen.
const BORDER: f64 = 0.1;

/// The target, and what stands between it and the source patch.
pub(crate) struct Occluded<'a> {
    /// Corners of the target.
    pub target: &'a [Vec3],
    /// Convex occluders, clipped to the space between the two patches.
    pub occluders: &'a PolygonList,
}

/// ∫ f dA over the `cells` (flat pieces of the source patch), to an absolute `tolerance` in m².
pub(crate) fn clipped(cells: &[Patch], scene: &Occluded, tolerance: f64, shadow: &mut Shadow) -> Estimate {
    let area: f64 = cells.iter().map(Patch::area).sum();
    let mut sum = Sum::default();
    for cell in cells {
        let share = tolerance * (cell.area() / area).sqrt();
        refine(cell, scene, share, DEPTH, shadow, &mut sum);
    }
    Estimate { value: sum.value, error: SAFETY * sum.squares.sqrt() }
}

/// Value, and squared differences: the errors of cells are of either sign and add up like their root mean square.
#[derive(Default)]
struct Sum {
    value: f64,
    squares: f64,
}

fn refine(cell: &Patch, scene: &Occluded, tolerance: f64, depth: u32, shadow: &mut Shadow, sum: &mut Sum) {
    let mut sight = Sight { hidden: true, open: true };
    let coarse = gauss(cell, 1, scene, shadow, &mut sight);
    let mut value = gauss(cell, 2, scene, shadow, &mut sight);
    let mut error = (value - coarse).abs();
    if error > EARLY * tolerance {
        let finest = gauss(cell, 3, scene, shadow, &mut sight);
        // Two values may agree by accident; the difference before bounds how well they credibly do.
        error = (finest - value).abs().max(CREDIBLE * error);
        value = finest;
    }
    if error <= tolerance {
        error = error.max(unseen(cell, scene, shadow, sight));
    }
    let met = error <= tolerance || depth == 0;
    if let Some(children) = (!met).then(|| cell.split().ok()).flatten() {
        for child in children {
            refine(&child, scene, 0.5 * tolerance, depth - 1, shadow, sum);
        }
    } else {
        sum.value += value;
        sum.squares += error * error;
    }
}

/// What the points of a cell have in common: all see nothing of the target, or all see the whole of it.
#[derive(Clone, Copy)]
struct Sight {
    hidden: bool,
    open: bool,
}

fn gauss(cell: &Patch, order: usize, scene: &Occluded, shadow: &mut Shadow, sight: &mut Sight) -> f64 {
    let mut sum = 0.0;
    for (p, weight) in place(cell, order) {
        let factor = shadow.visible_factor(p, cell.normal(), scene.target, scene.occluders);
        sight.hidden &= factor == 0.0;
        sight.open &= shadow.is_whole();
        sum += weight * factor;
    }
    sum
}

/// What points that all see nothing, or all see everything, may have missed: the corners of the cell tell, since the border of a shadow that
/// enters a cell nearly always cuts a corner off.
fn unseen(cell: &Patch, scene: &Occluded, shadow: &mut Shadow, sight: Sight) -> f64 {
    if !sight.hidden && !sight.open {
        return 0.0;
    }
    let centre = cell.centroid();
    let mut surprise = |corner: &Vec3| {
        // A little inside: a corner may lie on the target.
        let p = *corner + (centre - *corner) * INSET;
        let seen = shadow.visible_factor(p, cell.normal(), scene.target, scene.occluders);
        if sight.hidden {
            return seen;
        }
        if shadow.is_whole() {
            return 0.0;
        }
        point_to_polygon(cell.normal(), scene.target.iter().map(|&x| x - p)) - seen
    };
    let worst = cell.corners().iter().map(&mut surprise).fold(0.0, f64::max);
    BORDER * cell.area() * worst
}
