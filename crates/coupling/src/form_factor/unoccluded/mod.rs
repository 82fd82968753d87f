//! A_i F_ij = ∫_i ∫_j cosθ cosθ' / (π r²) (m²) of many pairs of patches with nothing between them.
//!
//! All of them by the contour integral (1/2π) ∮∮ ln r dx·dx' (E. M. Sparrow 1963,
//! doi:10.1115/1.3686055), which needs n² points where the double area integral needs n⁴. Pairs are
//! sorted by the number of points that the tolerance asks for, and computed in blocks, one pair a
//! lane:
//!
//! | the pair | method |
//! |---|---|
//! | one behind the other, or in its plane | 0, exactly |
//! | two parallelograms, apart | Gauss along the sides, opposite ones together |
//! | others, apart | Gauss along the edges |
//! | touching, nearly touching, or crossing each other's plane | contour integral of the parts that face each other |
//!
//! The number of points is known beforehand from the distance, so nothing is computed twice; see
//! `survey` for the bound. The tolerance T is relative to the exchange the two patches would have
//! squarely facing each other, A_i A_j / (π d²), or the smaller area where that is less.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]
#![allow(clippy::needless_range_loop, reason = "loops over lanes read many arrays at the same place")]

mod buckets;
mod close;
mod logarithm;
mod parallelogram;
mod patches;
mod polygons;
mod rules;
mod survey;

use super::lanes::{LANES, Lanes, Places};
use super::{Exchange, Method};
use buckets::{Buckets, Way};
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use parallelogram::parallelograms;
use patches::{Outline, Patches};
use polygons::polygons;
use pulp::{Arch, NullaryFnOnce};
use survey::{Survey, survey};

/// Rounding of a sum of points, in units of the last place of the value.
const ROUNDING: f64 = 16.0;

/// Rounding of the logarithms at the edges of other shapes, over the product of the circumferences:
/// four nodes share one logarithm, which is small.
const EDGE_ROUNDING: f64 = 1.0 / 64.0;

/// Computes exchanges between patches of one scene that see each other wholly.
#[derive(Debug)]
pub struct Unoccluded<'a> {
    source: Vec<&'a Patch>,
    patches: Patches,
    tolerance: f64,
    arch: Arch,
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub struct Work {
    ways: Vec<Way>,
    errors: Vec<f64>,
    facing: Vec<f64>,
    buckets: Buckets,
    front: [Vec<Vec3>; 2],
}

impl<'a> Unoccluded<'a> {
    /// Prepares the patches; `tolerance` is T of the module's text.
    #[must_use]
    pub fn new(patches: &[&'a Patch], tolerance: f64) -> Self {
        Self {
            source: patches.to_vec(),
            patches: Patches::new(patches),
            tolerance: tolerance.max(0.0),
            arch: Arch::new(),
        }
    }

    /// Writes A_i F_ij (m²) of patch `i` and each of `js` to `out`, as far as both lists reach. A
    /// pair has the same bits in either order and beside any others. Nothing may stand between the
    /// patches; that one lies behind the other, crosses its plane or touches it is seen here.
    ///
    /// # Panics
    /// An index beyond the patches.
    pub fn row(&self, i: usize, js: &[u32], work: &mut Work, out: &mut [Exchange]) {
        let count = js.len().min(out.len());
        let row = Row { all: self, i: i as u32, js: &js[..count] };
        self.arch.dispatch(Look { row: &row, work });
        work.buckets.sort(&work.ways);
        out[..count].fill(Exchange::NONE);
        for (way, places) in work.buckets.runs() {
            if way == Way::CLOSE {
                for &place in places {
                    let tolerance = self.tolerance * work.facing[place as usize];
                    out[place as usize] = row.close(place, tolerance, &mut work.front);
                }
            } else {
                self.arch.dispatch(Gauss { row: &row, way, places, errors: &work.errors, out });
            }
        }
    }
}

/// Looking at the pairs of a row, compiled for each width of vectors: a closure would be compiled
/// once, for the narrowest.
struct Look<'a> {
    row: &'a Row<'a>,
    work: &'a mut Work,
}

impl NullaryFnOnce for Look<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.row.look(self.work);
    }
}

/// Gauss for the pairs of a row that go one way.
struct Gauss<'a> {
    row: &'a Row<'a>,
    way: Way,
    places: &'a [u32],
    errors: &'a [f64],
    out: &'a mut [Exchange],
}

impl NullaryFnOnce for Gauss<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.row.gauss(self.way, self.places, self.errors, self.out);
    }
}

/// The pairs of one patch with others.
struct Row<'a> {
    all: &'a Unoccluded<'a>,
    i: u32,
    js: &'a [u32],
}

impl Row<'_> {
    /// The patches of the places in a block; the last stands in for those that are missing.
    #[inline(always)]
    fn others(&self, places: impl Fn(usize) -> usize) -> [u32; LANES] {
        std::array::from_fn(|m| self.js[places(m)])
    }

    /// Looks at all pairs.
    #[inline(always)]
    fn look(&self, work: &mut Work) {
        let patches = &self.all.patches;
        let own = Places::Same(self.i as usize);
        work.ways.clear();
        work.errors.clear();
        work.facing.clear();
        for start in (0..self.js.len()).step_by(LANES) {
            let count = LANES.min(self.js.len() - start);
            let js = self.others(|m| start + m.min(count - 1));
            let seen = survey(patches, [&own, &Places::new(js)], self.all.tolerance);
            work.ways.extend((0..count).map(|m| self.way(&seen, m, js[m])));
            work.errors.extend_from_slice(&seen.error[..count]);
            work.facing.extend_from_slice(&seen.facing[..count]);
        }
    }

    /// How to compute the pair in lane `m`, lower index first.
    #[inline(always)]
    fn way(&self, seen: &Survey, m: usize, j: u32) -> Way {
        if seen.behind[m] != 0.0 || j == self.i {
            return Way::BEHIND;
        }
        if seen.crosses[m] != 0.0 {
            return Way::CLOSE;
        }
        let outline = [self.i, j].map(|k| self.all.patches.outline[k as usize]);
        let points = [seen.points[0][m] as usize, seen.points[1][m] as usize];
        if self.i < j {
            Way::gauss(outline, points)
        } else {
            Way::gauss([outline[1], outline[0]], [points[1], points[0]])
        }
    }

    /// Computes the pairs at `places` in blocks.
    #[inline(always)]
    fn gauss(&self, way: Way, places: &[u32], errors: &[f64], out: &mut [Exchange]) {
        let square = self.all.patches.unit * self.all.patches.unit;
        for block in places.chunks(LANES) {
            let js = self.others(|m| block[m.min(block.len() - 1)] as usize);
            let values = self.values(way, js);
            for (&place, value) in block.iter().zip(values) {
                let error = (errors[place as usize] + self.rounding(self.js[place as usize], value)) * square;
                out[place as usize] = Exchange::new(Method::Gauss, Estimate { value: value * square, error });
            }
        }
    }

    /// Rounding of the sum over points: relative for parallelograms, of which opposite sides are
    /// taken together, else that of the edges.
    fn rounding(&self, j: u32, value: f64) -> f64 {
        let patches = &self.all.patches;
        let circumference = |k: u32| patches.slenderness[k as usize] * patches.area[k as usize];
        f64::EPSILON * (ROUNDING * value.abs() + EDGE_ROUNDING * circumference(self.i) * circumference(j))
    }

    /// A_i F_ij of a block in squared units, lower index first.
    #[inline(always)]
    fn values(&self, way: Way, js: [u32; LANES]) -> Lanes {
        let lower = Places::new(js.map(|j| j.min(self.i)));
        let higher = Places::new(js.map(|j| j.max(self.i)));
        let (pair, outlines) = ([&lower, &higher], way.outlines());
        if outlines == [Outline::Parallelogram; 2] {
            parallelograms(&self.all.patches, pair, way.points())
        } else {
            let corners = outlines.map(|o| if o == Outline::Triangle { 3 } else { 4 });
            polygons(&self.all.patches, pair, corners, way.points())
        }
    }

    fn close(&self, place: u32, tolerance: f64, front: &mut [Vec<Vec3>; 2]) -> Exchange {
        let j = self.js[place as usize];
        let [a, b] = [self.i, j].map(|k| self.all.source[k as usize]);
        let estimate = close::close(a, b, tolerance * self.all.patches.unit * self.all.patches.unit, front);
        Exchange::new(Method::Contour, estimate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares and triangles on a bent strip, turned to each other.
    fn strip() -> Vec<Patch> {
        let place = |k: u32| {
            let (angle, height) = (f64::from(k) * 0.37, f64::from(k % 7) * 0.9);
            let out = Vec3::new(angle.cos(), angle.sin(), 0.0);
            (out * 5.0 + Vec3::Z * height, Vec3::Z.cross(out) * 0.6, Vec3::new(0.1, 0.0, 0.7))
        };
        let patch = |k: u32| {
            let (p, u, v) = place(k);
            let corners = [p, p + v, p + u + v, p + u];
            if k.is_multiple_of(3) {
                Patch::triangle([corners[0], corners[1], corners[2]]).unwrap()
            } else {
                Patch::quad(corners).unwrap().unwrap()
            }
        };
        (0..60).map(patch).collect()
    }

    #[test]
    fn the_width_of_vectors_changes_no_bit() {
        let patches = strip();
        let list: Vec<&Patch> = patches.iter().collect();
        let js: Vec<u32> = (0..60).collect();
        let wide = Unoccluded::new(&list, 1e-9);
        let narrow = Unoccluded { arch: Arch::Scalar, ..Unoccluded::new(&list, 1e-9) };
        let (mut work, mut out) = (Work::default(), [vec![Exchange::NONE; 60], vec![Exchange::NONE; 60]]);
        let mut gauss = 0;
        for i in 0..60 {
            wide.row(i, &js, &mut work, &mut out[0]);
            narrow.row(i, &js, &mut work, &mut out[1]);
            assert_eq!(out[0], out[1]);
            gauss += out[0].iter().filter(|exchange| exchange.method == Method::Gauss).count();
        }
        assert!(gauss > 1000, "{gauss}");
    }
}
