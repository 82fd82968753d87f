//! Kernels that are smooth on the surface, by Gauss points; or peaked where p and q meet, by points
//! graded towards p.
//!
//! n × n Gauss points an element converge as h^{2n} for a smooth kernel. A kernel that is bounded
//! but has no limit at p = q, as Lambert's on a curved surface, is integrated by graded points on
//! elements nearer than a ratio of their size.

use super::{Sink, Transfer, near::graded};
use crate::surface::Rules;
use crate::{Site, Surface};
use fredholm_mesh::Vec3;
use fredholm_quadrature::PlanePoint;

/// A kernel k(p, n_p, q, n_q) of two points and their unit normals, 1/m². Any such function is one.
pub trait Kernel: Sync {
    /// k(p, q).
    fn value(&self, p: Vec3, np: Vec3, q: Vec3, nq: Vec3) -> f64;
}

impl<F: Fn(Vec3, Vec3, Vec3, Vec3) -> f64 + Sync> Kernel for F {
    fn value(&self, p: Vec3, np: Vec3, q: Vec3, nq: Vec3) -> f64 {
        self(p, np, q, nq)
    }
}

/// A kernel on any surface, without occlusion.
pub struct SmoothTransfer<'a> {
    surface: &'a Surface,
    kernel: &'a dyn Kernel,
    order: usize,
    near: f64,
    placed: Vec<Vec<(Site, f64)>>,
    balls: Vec<(Vec3, f64)>,
}

impl<'a> SmoothTransfer<'a> {
    /// Integrates with n × n points an element, n = `order`.
    #[must_use]
    pub fn new(surface: &'a Surface, kernel: &'a dyn Kernel, order: usize) -> Self {
        let rules = Rules::gauss(order);
        let place = |i| surface.place(i, rules.of(surface.chart(i).sides()));
        let placed: Vec<_> = (0..surface.len()).map(place).collect();
        let balls = placed.iter().map(|points| ball(points)).collect();
        Self { surface, kernel, order, near: -1.0, placed, balls }
    }

    /// Grades the points between elements whose centres are nearer than `ratio` times the sum of
    /// their radii: for a kernel with a peak at p = q.
    #[must_use]
    pub fn with_peak(mut self, ratio: f64) -> Self {
        self.near = ratio;
        self
    }

    fn weigh(&self, p: &Site, q: &Site, area: f64) -> PlanePoint {
        PlanePoint { u: q.u, v: q.v, weight: area * self.kernel(p, q) }
    }
}

/// Mean and largest distance from it of the points of an element.
fn ball(points: &[(Site, f64)]) -> (Vec3, f64) {
    let centre = points.iter().map(|(s, _)| s.position).sum::<Vec3>() / points.len().max(1) as f64;
    (centre, points.iter().map(|(s, _)| s.position.distance(centre)).fold(0.0, f64::max))
}

impl Transfer for SmoothTransfer<'_> {
    fn surface(&self) -> &Surface {
        self.surface
    }

    fn kernel(&self, p: &Site, q: &Site) -> f64 {
        self.kernel.value(p.position, p.normal, q.position, q.normal)
    }

    fn is_regular(&self, i: usize, j: usize) -> bool {
        let ((a, ra), (b, rb)) = (self.balls[i], self.balls[j]);
        a.distance(b) > self.near * (ra + rb)
    }

    fn send(&self, sites: &[Site], j: usize, _: usize, each: &mut Sink) {
        let regular = sites.first().is_some_and(|p| self.is_regular(p.element, j));
        let mut points = Vec::new();
        for (at, p) in sites.iter().enumerate() {
            points.clear();
            if regular {
                points.extend(self.placed[j].iter().map(|(q, area)| self.weigh(p, q, *area)));
            } else {
                let rule = graded(self.surface.chart(j), j, p, self.order);
                let placed = self.surface.place(j, &rule);
                points.extend(placed.iter().map(|(q, area)| self.weigh(p, q, *area)));
            }
            each(at, &points);
        }
    }

    fn outer(&self, _: usize) -> Rules {
        Rules::gauss(self.order)
    }
}
