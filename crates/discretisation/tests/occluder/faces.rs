//! Means of a solution over the faces of the reference, and how far they are from it.

use crate::reference::Class;
use crate::scene;
use fredholm_discretisation::{Lit, Site};
use fredholm_linop::MultiVector;
use fredholm_mesh::Mesh;
use fredholm_quadrature::{PlanePoint, tensor_quad};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Differences from the reference over all classes of faces.
pub struct Comparison {
    /// √(Σ A (E − E')²/Σ A E'²) of the polynomials.
    pub polynomial: f64,
    /// Root of the mean square over faces, and largest, of (E − E')/E' for H B_h.
    pub root: f64,
    pub largest: f64,
    /// Largest excess of |E − E'| over three standard errors of E', over E'.
    pub beyond_noise: f64,
}

/// The polynomials and H B_h against the classes, each by one of its faces.
pub fn compare(mesh: &Mesh, lit: &Lit, classes: &[Class]) -> Comparison {
    let (faces, coefficients, rule) = (scene::faces(), lit.irradiance(), rule());
    let mean = |class: &Class| {
        let face = scene::place(&faces, &class.surface, class.centre).0;
        let at = |p: &PlanePoint| {
            let (leaf, u, v) = scene::place(mesh, &class.surface, faces.patch(face).point(p.u, p.v));
            (lit.system().space().surface().site(leaf, u, v), p.weight)
        };
        means(lit, &coefficients, rule.iter().map(at))
    };
    summary(classes, &classes.par_iter().map(mean).collect::<Vec<_>>())
}

/// 2 × 2 Gauss points on each quarter of a face, since the edges of shadows run through faces.
fn rule() -> Vec<PlanePoint> {
    let quarter = |(i, j): (u8, u8)| {
        tensor_quad(2).into_iter().map(move |p| PlanePoint {
            u: 0.5 * (p.u + f64::from(i)),
            v: 0.5 * (p.v + f64::from(j)),
            weight: 0.25 * p.weight,
        })
    };
    [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().flat_map(quarter).collect()
}

/// Weighted sums over sites: the irradiance as a polynomial, and H B_h.
fn means(lit: &Lit, coefficients: &MultiVector<f64>, sites: impl Iterator<Item = (Site, f64)>) -> [f64; 2] {
    let mut groups: BTreeMap<usize, Vec<(Site, f64)>> = BTreeMap::new();
    sites.for_each(|(site, weight)| groups.entry(site.element).or_default().push((site, weight)));
    let mut sums = [0.0; 2];
    for (leaf, group) in groups {
        let through = lit.irradiance_at(&group.iter().map(|(site, _)| *site).collect::<Vec<_>>());
        for (at, (site, weight)) in group.iter().enumerate() {
            sums[0] += weight * lit.system().space().value(coefficients, 0, leaf, site.u, site.v);
            sums[1] += weight * through.row(at)[0];
        }
    }
    sums
}

fn summary(classes: &[Class], means: &[[f64; 2]]) -> Comparison {
    let pairs = || classes.iter().zip(means);
    let square = |(class, mean): (&Class, &[f64; 2])| class.area * (mean[0] - class.irradiance).powi(2);
    let norm: f64 = classes.iter().map(|class| class.area * class.irradiance.powi(2)).sum();
    let relative = |(class, mean): (&Class, &[f64; 2])| (mean[1] / class.irradiance - 1.0).abs();
    let beyond = |(class, mean)| relative((class, mean)) - 3.0 * class.error / class.irradiance;
    let faces: f64 = classes.iter().map(|class| class.faces).sum();
    let squares: f64 = pairs().map(|(class, mean)| class.faces * relative((class, mean)).powi(2)).sum();
    Comparison {
        polynomial: (pairs().map(square).sum::<f64>() / norm).sqrt(),
        root: (squares / faces).sqrt(),
        largest: pairs().map(relative).fold(0.0, f64::max),
        beyond_noise: pairs().map(beyond).fold(0.0, f64::max),
    }
}
