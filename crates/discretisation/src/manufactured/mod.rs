//! Manufactured solutions: a smooth x is chosen, b = x − ρ H x is computed by other means, and a
//! method must give x back.
//!
//! P. J. Roache, J. Fluids Eng. 124 (2002) 4, doi:10.1115/1.1436090. The scenes are smooth, flat
//! and curved, with exact charts, so that nothing limits the order of a method but the method. H x
//! is integrated by a rule of one or two large charts that is far finer than any mesh, or is known
//! in closed form. Lengths in metres.

mod cylinder;
mod facing;
mod measure;
mod sphere;

pub use cylinder::{inside_of_a_cylinder, two_cylinders};
pub use facing::{facing_squares, facing_triangles};
pub use measure::{Errors, measure, orders};
pub use sphere::{inside_of_a_sphere, smooth_kernel_on_a_sphere};

use crate::surface::Rules;
use crate::{Chart, DiscretisationError, Kernel, SmoothTransfer, Surface};
use fredholm_mesh::Vec3;

type Field = Box<dyn Fn(Vec3) -> f64 + Sync>;

/// A problem with a known solution, on meshes of any fineness.
pub struct Manufactured {
    /// What it is, in a few words.
    pub name: &'static str,
    /// Whether the surface is curved.
    pub curved: bool,
    /// ρ.
    pub reflectance: f64,
    kernel: Box<dyn Kernel>,
    /// Smooth pieces, each with as many elements.
    pieces: usize,
    charts: fn(usize) -> Vec<Box<dyn Chart>>,
    exact: fn(Vec3) -> f64,
    /// H x as a function of place; the normal follows from the place.
    irradiance: Field,
    peak: Option<f64>,
}

impl Manufactured {
    /// The surface cut into n parts along each side. Each smooth piece is a face.
    ///
    /// # Errors
    /// None: lists made here fit each other.
    pub fn surface(&self, n: usize) -> Result<Surface, DiscretisationError> {
        let charts = (self.charts)(n);
        let each = (charts.len() / self.pieces).max(1);
        let faces = (0..charts.len()).map(|i| i / each).collect();
        Surface::new(charts, faces)
    }

    /// H on a mesh, with `order` Gauss points along each side of an element.
    #[must_use]
    pub fn transfer<'a>(&'a self, surface: &'a Surface, order: usize) -> SmoothTransfer<'a> {
        let transfer = SmoothTransfer::new(surface, &*self.kernel, order);
        if let Some(ratio) = self.peak { transfer.with_peak(ratio) } else { transfer }
    }

    /// x(p).
    #[must_use]
    pub fn exact(&self, p: Vec3) -> f64 {
        (self.exact)(p)
    }

    /// b(p) = x(p) − ρ (H x)(p).
    #[must_use]
    pub fn source(&self, p: Vec3) -> f64 {
        self.exact(p) - self.reflectance * (self.irradiance)(p)
    }
}

/// All scenes.
#[must_use]
pub fn manufactured() -> Vec<Manufactured> {
    vec![
        facing_squares(),
        facing_triangles(),
        smooth_kernel_on_a_sphere(),
        inside_of_a_sphere(),
        two_cylinders(),
        inside_of_a_cylinder(),
    ]
}

/// H x by n × n Gauss points on charts, `normal` being the unit normal at p.
fn resolved<K: Kernel>(
    charts: &[Box<dyn Chart>],
    n: usize,
    kernel: K,
    exact: fn(Vec3) -> f64,
    normal: fn(Vec3) -> Vec3,
) -> impl Fn(Vec3) -> f64 + use<K> {
    let rules = Rules::gauss(n);
    let mut points = Vec::new();
    for chart in charts {
        for s in rules.of(chart.sides()) {
            let q = chart.position(s.u, s.v);
            points.push((q, chart.normal(s.u, s.v), s.weight * chart.jacobian(s.u, s.v) * exact(q)));
        }
    }
    move |p| points.iter().map(|(q, nq, weight)| weight * kernel.value(p, normal(p), *q, *nq)).sum()
}
