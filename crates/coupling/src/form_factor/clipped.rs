//! A_i F_ij behind a few occluders: ∫_i f(p) dA with f(p) the exact form factor from p to what it sees of j.
//!
//! The inner integral is closed ([`shadow`](super::shadow)); the outer one is adaptive, because f has kinks where an edge of an occluder lines up with one of the
//! target. In m². A cell is accepted when its 2 × 2 and 3 × 3 Gauss values agree within its share of the tolerance.

use super::area_gauss::place;
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
    let (coarse, mut value) = (gauss(cell, 1, scene, shadow), gauss(cell, 2, scene, shadow));
    let mut error = (value - coarse).abs();
    if error > EARLY * tolerance {
        let finest = gauss(cell, 3, scene, shadow);
        // Two values may agree by accident; the difference before bounds how well they credibly do.
        error = (finest - value).abs().max(CREDIBLE * error);
        value = finest;
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

fn gauss(cell: &Patch, order: usize, scene: &Occluded, shadow: &mut Shadow) -> f64 {
    let mut sum = 0.0;
    for (p, weight) in place(cell, order) {
        sum += weight * shadow.visible_factor(p, cell.normal(), scene.target, scene.occluders);
    }
    sum
}
