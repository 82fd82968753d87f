//! The elements that rows are of, in families of four parts, and sums over them.

use std::sync::Arc;

use fredholm_linop::MultiVector;
use fredholm_mesh::{Mesh, Patch};
use fredholm_montecarlo::rows::{Family, REPLICATES, Rows};
use fredholm_montecarlo::{Enclosure, Surfaces};
use fredholm_scene::Scene;
use fredholm_visibility::Occluders;

use super::estimate::{PAIRS, confidence};
use crate::error::Error;
use crate::stochastic::failure;

/// Share of its own variance that a family is expected to have; the rest is that of its surface.
const OWN_VARIANCE: f64 = 0.5;

/// Share of all area from which on a face is large.
pub(super) const LARGE_FACE: f64 = 1e-3;

/// Share of the mean irradiance below which a face is dim; and the one below which its own error may
/// be as large as if it had this.
const DIM: f64 = 0.2;
const DARKEST: f64 = 2e-3;

/// Parts of elements, and what they are made of.
pub(super) struct Ground<'m> {
    pub(super) mesh: &'m Mesh,
    pub(super) bands: usize,
    pub(super) lit: Enclosure,
    pub(super) families: Vec<Family>,
    reflectance: Vec<f64>,
    areas: Vec<f64>,
    face_of: Vec<usize>,
}

impl<'m> Ground<'m> {
    /// Takes a mesh whose leaves are the parts.
    pub(super) fn new(scene: &Scene, mesh: &'m Mesh, occluders: &Arc<Occluders>) -> Result<Self, Error> {
        let patches: Vec<Patch> = mesh.patches().copied().collect();
        let areas = patches.iter().map(Patch::area).collect();
        let (bands, reflectance) = (scene.bands().len(), scene.reflectance(mesh));
        let surfaces = Surfaces::blocked_by(Arc::clone(occluders), patches);
        let lit =
            Enclosure::of(surfaces, bands, reflectance.clone(), scene.exitance(mesh)).map_err(failure)?;
        let face_of = (0..mesh.len()).map(|part| mesh.face_of(part)).collect();
        Ok(Self { mesh, bands, lit, families: families(mesh), reflectance, areas, face_of })
    }

    /// ρ/w: what is sent for each irradiance, which is a mean over what is not exposed too.
    pub(super) fn factor(&self, exposed: &[f64]) -> MultiVector<f64> {
        MultiVector::from_fn(self.areas.len(), self.bands, |part, band| match exposed[part] {
            share if share > 0.0 => self.reflectance[part * self.bands + band] / share,
            _ => 0.0,
        })
    }

    /// Σ w A (1 − ρ) of every band, m²: what absorbs.
    pub(super) fn absorbing(&self, exposed: &[f64]) -> Vec<f64> {
        let part = |part: usize, band: usize| {
            exposed[part] * self.areas[part] * (1.0 - self.reflectance[part * self.bands + band])
        };
        (0..self.bands).map(|band| (0..self.areas.len()).map(|k| part(k, band)).sum()).collect()
    }

    /// Means over the faces, W/m², and evenly what is reflected of them.
    pub(super) fn of_faces(&self, values: &MultiVector<f64>, absorbing: &[f64]) -> MultiVector<f64> {
        let mut faces = self.means(values);
        let reflected = self.reflected(values, absorbing);
        for face in faces.as_mut_slice().chunks_mut(self.bands) {
            face.iter_mut().zip(&reflected).for_each(|(value, reflected)| *value += reflected);
        }
        faces
    }

    /// What is reflected of values, spread evenly over what absorbs it, W/m².
    pub(super) fn reflected(&self, values: &MultiVector<f64>, absorbing: &[f64]) -> Vec<f64> {
        let of = |(band, absorbing): (usize, &f64)| {
            let rho = |part: usize| self.reflectance[part * self.bands + band];
            let part = |part: usize| self.areas[part] * rho(part) * values.row(part)[band];
            (0..self.areas.len()).map(part).sum::<f64>() / absorbing
        };
        absorbing.iter().enumerate().map(of).collect()
    }

    /// Means over the faces.
    pub(super) fn means(&self, values: &MultiVector<f64>) -> MultiVector<f64> {
        let mut faces = MultiVector::zeros(self.mesh.faces().len(), self.bands);
        for ((&face, area), row) in self.face_of.iter().zip(&self.areas).zip(values.rows()) {
            let share = area / self.mesh.faces()[face].area;
            faces.row_mut(face).iter_mut().zip(row).for_each(|(sum, value)| *sum += share * value);
        }
        faces
    }

    /// Σ A E² over the faces, of every band.
    pub(super) fn norms(&self, irradiance: &MultiVector<f64>) -> Vec<f64> {
        let means = self.means(irradiance);
        let of = |band: usize| self.by_area(|face| means.row(face)[band].powi(2)).sum();
        (0..self.bands).map(of).collect()
    }

    /// The terms A f of the faces.
    fn by_area(&self, of: impl Fn(usize) -> f64) -> impl Iterator<Item = f64> {
        self.mesh.faces().iter().enumerate().map(move |(face, it)| it.area * of(face))
    }

    /// Area of all faces, m².
    pub(super) fn area(&self) -> f64 {
        self.mesh.faces().iter().map(|face| face.area).sum()
    }

    /// Mean over the faces, of their means.
    fn mean(&self, means: &MultiVector<f64>, band: usize) -> f64 {
        self.by_area(|face| means.row(face)[band]).sum::<f64>() / self.area()
    }

    /// Irradiance below which a face counts as if it had this, W/m², from the means of the faces.
    fn darkest(&self, means: &MultiVector<f64>, band: usize) -> f64 {
        DARKEST * self.mean(means, band)
    }

    /// Relative error of a band by chance, with its confidence.
    pub(super) fn noise(&self, variances: &MultiVector<f64>, norms: &[f64], band: usize) -> f64 {
        let squares = || self.by_area(|face| variances.row(face)[band]);
        let (sum, fourths) = (squares().sum::<f64>(), squares().map(|x| x * x).sum::<f64>());
        if sum > 0.0 { (sum / norms[band]).sqrt() * confidence(sum * sum / fourths) } else { 0.0 }
    }

    /// Square of the relative error of a band, from two estimates of it, and its standard deviation.
    pub(super) fn left_out(&self, halves: &[MultiVector<f64>; 2], norms: &[f64], band: usize) -> [f64; 2] {
        let products = || self.by_area(|face| halves[0].row(face)[band] * halves[1].row(face)[band]);
        let norm = norms[band].max(f64::MIN_POSITIVE);
        [products().sum::<f64>() / norm, products().map(|x| x * x).sum::<f64>().sqrt() / norm]
    }

    /// What the parts of every family send beside their mean.
    pub(super) fn apart(&self, sent: &MultiVector<f64>, exposed: &[f64]) -> MultiVector<f64> {
        let mut apart = sent.clone();
        for family in &self.families {
            let weight = |part: usize| exposed[part] * self.areas[part];
            let whole: f64 = family.parts.clone().map(weight).sum();
            for band in (0..self.bands).filter(|_| whole > 0.0) {
                let parts = family.parts.clone();
                let mean = parts.map(|part| weight(part) * sent.row(part)[band]).sum::<f64>() / whole;
                family.parts.clone().for_each(|part| apart.row_mut(part)[band] -= mean);
            }
        }
        apart
    }

    /// Irradiances of which all that is not direct is spread evenly over the exposed part of every
    /// family: it varies little over one, and has half the noise. Means of faces stay.
    pub(super) fn evened(
        &self,
        irradiance: &MultiVector<f64>,
        direct: &MultiVector<f64>,
        exposed: &[f64],
    ) -> MultiVector<f64> {
        let mut out = irradiance.clone();
        for family in &self.families {
            let whole: f64 = family.parts.clone().map(|part| exposed[part] * self.areas[part]).sum();
            for band in (0..self.bands).filter(|_| whole > 0.0) {
                let part =
                    |part: usize| self.areas[part] * (irradiance.row(part)[band] - direct.row(part)[band]);
                let mean = family.parts.clone().map(part).sum::<f64>() / whole;
                for part in family.parts.clone() {
                    out.row_mut(part)[band] = direct.row(part)[band] + exposed[part] * mean;
                }
            }
        }
        out
    }

    /// Σ A d_A d_B over the parts of every family and the bands, relative to the norms.
    pub(super) fn products(&self, apart: &[MultiVector<f64>; 2], norms: &[f64]) -> Vec<f64> {
        let part = |part: usize| {
            let rows = apart[0].row(part).iter().zip(apart[1].row(part)).zip(norms);
            self.areas[part] * rows.map(|((a, b), norm)| a * b / norm.max(f64::MIN_POSITIVE)).sum::<f64>()
        };
        let of = |family: &Family| family.parts.clone().map(part).sum::<f64>().max(0.0);
        self.families.iter().map(of).collect()
    }

    /// Variance of the mean of every family over one ray of each part and replicate, relative to the
    /// norm of a band: of four replicates it is known badly, so that half of it is that of the
    /// surface, in proportion to the irradiance as where few rays find all of it. 1/m².
    pub(super) fn variance_of_a_ray(
        &self,
        irradiance: &MultiVector<f64>,
        deviations: &[MultiVector<f64>],
        rows: &Rows,
        (band, norm): (usize, f64),
    ) -> Vec<f64> {
        let own = |family: &Family| {
            let whole = family.whole.area();
            let mean = |values: &MultiVector<f64>| {
                let part = |part: usize| self.areas[part] * values.row(part)[band];
                family.parts.clone().map(part).sum::<f64>() / whole
            };
            let squares = deviations.iter().map(|values| mean(values).powi(2)).sum::<f64>();
            f64::from(rows.count(family.parts.start)) * squares / (PAIRS * norm.max(f64::MIN_POSITIVE))
        };
        let own: Vec<f64> = self.families.iter().map(own).collect();
        let means = self.means(irradiance);
        let level = |family: &Family| means.row(self.face_of[family.parts.start])[band];
        let mut surfaces = vec![[0.0; 2]; self.mesh.surfaces().len()];
        let surface = |family: &Family| self.mesh.faces()[self.face_of[family.parts.start]].surface;
        for (family, own) in self.families.iter().zip(&own) {
            let [sum, light] = &mut surfaces[surface(family)];
            *sum += family.whole.area() * own;
            *light += family.whole.area() * level(family);
        }
        let pooled = |(family, own): (&Family, &f64)| {
            let [sum, light] = surfaces[surface(family)];
            let of_surface = if light > 0.0 { level(family) * sum / light } else { 0.0 };
            OWN_VARIANCE * own + (1.0 - OWN_VARIANCE) * of_surface
        };
        self.families.iter().zip(&own).map(pooled).collect()
    }

    /// E² A/‖E‖² of every family, E the mean over its face, or that of the darkest: what it has of
    /// the square of the norm of a band. Infinite for faces that are not large.
    pub(super) fn large(&self, irradiance: &MultiVector<f64>, (band, norm): (usize, f64)) -> Vec<f64> {
        let faces = self.mesh.faces();
        let means = self.means(irradiance);
        let least = self.darkest(&means, band);
        let large = self.area_of_a_large_face();
        let of = |family: &Family| {
            let face = self.face_of[family.parts.start];
            let square = means.row(face)[band].max(least).powi(2);
            let share = square * family.whole.area() / norm.max(f64::MIN_POSITIVE);
            if faces[face].area > large { share } else { f64::INFINITY }
        };
        self.families.iter().map(of).collect()
    }

    /// Standard errors of the large faces of families, relative to their irradiance or that of the
    /// darkest, over `most`, in the worst band; 0 for others.
    pub(super) fn uncertainties(
        &self,
        irradiance: &MultiVector<f64>,
        variances: &MultiVector<f64>,
        most: f64,
    ) -> Vec<f64> {
        let means = self.means(irradiance);
        let least: Vec<f64> = (0..self.bands).map(|band| self.darkest(&means, band)).collect();
        let large = self.area_of_a_large_face();
        let of = |family: &Family| {
            let face = self.face_of[family.parts.start];
            let bands = means.row(face).iter().zip(&least).zip(variances.row(face));
            let ratio = |((e, least), variance): ((&f64, &f64), &f64)| {
                variance.sqrt() / (most * e.max(*least)).max(f64::MIN_POSITIVE)
            };
            if self.mesh.faces()[face].area > large { bands.map(ratio).fold(0.0, f64::max) } else { 0.0 }
        };
        self.families.iter().map(of).collect()
    }

    /// Area from which on a face is large, m².
    fn area_of_a_large_face(&self) -> f64 {
        LARGE_FACE * self.area()
    }

    /// Rays of a part and replicate for each family: these, and more where a large face would have
    /// less than `least` in all.
    pub(super) fn at_least(&self, least: u32, counts: &[u32]) -> Vec<u32> {
        self.raised(counts, |_| least)
    }

    /// The same for the dim ones among them, by what is known of the irradiance.
    pub(super) fn at_least_of_dim(
        &self,
        least: u32,
        irradiance: &MultiVector<f64>,
        counts: &[u32],
    ) -> Vec<u32> {
        let means = self.means(irradiance);
        let dim: Vec<f64> = (0..self.bands).map(|band| DIM * self.mean(&means, band)).collect();
        let is_dim = |face: usize| means.row(face).iter().zip(&dim).any(|(e, dim)| e < dim);
        self.raised(counts, |face| if is_dim(face) { least } else { 0 })
    }

    /// Rays that give each large face so many in all, or these where they are more.
    fn raised(&self, counts: &[u32], least: impl Fn(usize) -> u32) -> Vec<u32> {
        let faces = self.mesh.faces();
        let large = self.area_of_a_large_face();
        let mut parts = vec![0_u32; faces.len()];
        self.face_of.iter().for_each(|&face| parts[face] += 1);
        let of = |(family, &count): (&Family, &u32)| {
            let face = self.face_of[family.parts.start];
            let own = least(face).div_ceil(parts[face] * REPLICATES as u32);
            if faces[face].area > large { count.max(own.next_power_of_two()) } else { count }
        };
        self.families.iter().zip(counts).map(of).collect()
    }

    /// A²/A_face of a family: what the variance of its mean counts in the square of the error, m².
    pub(super) fn weight(&self, family: &Family) -> f64 {
        family.whole.area().powi(2) / self.mesh.faces()[self.face_of[family.parts.start]].area
    }
}

/// The leaves of a mesh, those of the same parent together.
fn families(mesh: &Mesh) -> Vec<Family> {
    let leaves = mesh.leaves();
    let (mut families, mut at) = (Vec::new(), 0);
    while at < leaves.len() {
        let parent = mesh.elements()[leaves[at]].parent;
        let are_all = |parent: &usize| {
            let children = mesh.children(*parent);
            leaves[at..].iter().take(children.len()).copied().eq(children)
        };
        let (element, count) = parent.filter(are_all).map_or((leaves[at], 1), |parent| (parent, 4));
        let whole = mesh.elements()[element].patch;
        families.push(Family { whole, parts: at..at + count, stream: element as u32 });
        at += count;
    }
    families
}
