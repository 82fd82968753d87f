//! Photon maps: particles are kept where they arrive, and read where gathering rays end.
//!
//! E(p) is direct light plus E[ρ Ê(y)] over rays of density cosθ/π, Ê(y) = Σ φ/N(y) over the
//! photons within r of y on the same flat piece, N(y) the area of that piece within r: constant
//! irradiance is read without bias up to its edges, and up to what stands on it
//! ([`super::buried`]). A ray shorter than [`SHORT_RAY_RADII`] radii is reflected where it ends, as a path: a
//! corner sees every gradient beside it, what is far away only its mean. H. W. Jensen, Eurographics
//! workshop on rendering 1996, doi:10.1007/978-3-7091-7484-5_3. The bias of Ê falls with r², which
//! shrinks from batch to batch, r²_{b+1} = r²_b (b + α)/(b + 1), so that the mean of the batches
//! tends to the true value (C. Knaus, M. Zwicker, ACM Trans. Graph. 30 (2011) 25,
//! doi:10.1145/1966394.1966404).

use super::buried::{ExposedPart, partly_buried};
use super::disc::shared;
use super::kd_tree::KdTree;
use super::particles::ParticleTracing;
use super::path::{PathTracing, Step};
use super::{Batch, Estimator, PointEstimator, Switches, Work, gather};
use crate::points::Draw;
use crate::{Enclosure, Site};
use fredholm_mesh::{Patch, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// α of the shrinking radius.
const ALPHA: f64 = 2.0 / 3.0;
/// Photons that a disc of the first radius holds, were they spread evenly.
const PHOTONS_OF_A_DISC: f64 = 8.0;
/// Rays up to so many radii long are reflected where they end.
const SHORT_RAY_RADII: f64 = 3.0;
/// Cosine between normals, and distance from the plane over the size of the scene, up to which
/// patches are one flat piece.
const SAME_PLANE_COSINE: f64 = 1.0 - 1e-9;
const SAME_PLANE_DISTANCE: f64 = 1e-7;
/// Streams of photons lie beyond those of patches.
const PHOTON_STREAMS: u32 = 1 << 30;

/// The photon map with final gathering.
pub struct PhotonMap {
    switches: Switches,
    photons: u32,
    /// Neighbours of each patch on its flat piece, within the first radius.
    near: Vec<Vec<u32>>,
    outlines: Vec<Outline>,
    parts: BTreeMap<usize, ExposedPart>,
    radius: f64,
}

/// What decides whether a patch lies wholly inside or outside a disc.
#[derive(Clone, Copy)]
struct Outline {
    centre: Vec3,
    reach: f64,
    /// Area that is not buried, m².
    exposed: f64,
}

impl Outline {
    fn new(patch: &Patch) -> Self {
        let centre = patch.centroid();
        let reach = patch.corners().iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
        Self { centre, reach, exposed: patch.area() }
    }
}

impl PhotonMap {
    /// A map of so many photons a batch.
    #[must_use]
    pub fn new(scene: &Enclosure, switches: Switches, photons: u32) -> Self {
        let area: f64 = scene.patches().iter().map(Patch::area).sum();
        let radius = (PHOTONS_OF_A_DISC * area / (PI * f64::from(photons.max(1)))).sqrt();
        let mut outlines: Vec<Outline> = scene.patches().iter().map(Outline::new).collect();
        let near = neighbours(scene, &outlines, radius);
        let parts = partly_buried(scene);
        for (&patch, part) in &parts {
            outlines[patch].exposed = part.area();
        }
        Self { switches, photons: photons.max(1), near, outlines, parts, radius }
    }

    /// Radius of a batch, m.
    #[must_use]
    pub fn radius(&self, batch: u32) -> f64 {
        let square = (1..=batch).fold(1.0, |square, b| square * (f64::from(b) - 1.0 + ALPHA) / f64::from(b));
        self.radius * f64::sqrt(square)
    }

    fn map(&self, scene: &Enclosure, batch: &Batch) -> (Map<'_>, Work) {
        let tracing = ParticleTracing::continuous(self.switches);
        let (mut sites, mut powers, mut rays) = (Vec::new(), Vec::new(), 0);
        let mut power = vec![0.0; scene.bands()];
        let mut samples = batch.samples_of(PHOTON_STREAMS, self.photons);
        for photon in 0..self.photons {
            power.fill(1.0 / f64::from(self.photons));
            let mut keep = |at: Site, power: &[f64]| {
                sites.push(at);
                powers.extend_from_slice(power);
            };
            rays += tracing.fly(scene, &mut samples.draw(photon), &mut power, &mut keep);
        }
        let tree = KdTree::new(sites.iter().map(|site| site.point));
        let work = Work { paths: u64::from(self.photons), rays };
        (Map { of: self, radius: self.radius(batch.number), sites, powers, tree }, work)
    }
}

/// Patches whose nearest points may lie within the radius, on the same plane and the same side.
fn neighbours(scene: &Enclosure, outlines: &[Outline], radius: f64) -> Vec<Vec<u32>> {
    let patches = scene.patches();
    let size = patches.iter().flat_map(Patch::corners).map(|p| p.length()).fold(0.0, f64::max);
    let near = |i: usize, j: usize| {
        let (a, b) = (&patches[i], &patches[j]);
        let between = outlines[j].centre - outlines[i].centre;
        a.normal().dot(b.normal()) > SAME_PLANE_COSINE
            && between.dot(a.normal()).abs() < SAME_PLANE_DISTANCE * size
            && between.length() < radius + outlines[i].reach + outlines[j].reach
    };
    let row = |i: usize| (0..patches.len()).filter(|&j| near(i, j)).map(|j| j as u32).collect();
    (0..patches.len()).map(row).collect()
}

/// The photons of a batch.
struct Map<'a> {
    of: &'a PhotonMap,
    radius: f64,
    sites: Vec<Site>,
    powers: Vec<f64>,
    tree: KdTree,
}

impl Map<'_> {
    /// Exposed area of a patch within the radius of a point of its plane, m²: what is buried
    /// receives no photons.
    fn piece(&self, scene: &Enclosure, patch: usize, point: Vec3) -> f64 {
        let outline = self.of.outlines[patch];
        let square = outline.centre.distance_squared(point);
        if square >= (self.radius + outline.reach).powi(2) {
            0.0
        } else if self.radius > outline.reach && square <= (self.radius - outline.reach).powi(2) {
            outline.exposed
        } else {
            match self.of.parts.get(&patch) {
                Some(part) => part.within(point, self.radius),
                None => shared(&scene.patches()[patch], point, self.radius),
            }
        }
    }

    /// Adds weight × Ê(y) to `out`.
    fn read(&self, scene: &Enclosure, at: Site, weight: &[f64], out: &mut [f64]) {
        let near = &self.of.near[at.patch];
        let piece: f64 = near.iter().map(|&i| self.piece(scene, i as usize, at.point)).sum();
        if piece <= 0.0 {
            return;
        }
        let bands = scene.bands();
        self.tree.within(at.point, self.radius, &mut |photon| {
            let photon = photon as usize;
            // The list is in order.
            if near.binary_search(&(self.sites[photon].patch as u32)).is_ok() {
                let power = &self.powers[photon * bands..(photon + 1) * bands];
                super::add(out, weight, power, 1.0 / piece);
            }
        });
    }
}

impl PointEstimator for Map<'_> {
    fn irradiance(&self, scene: &Enclosure, at: Site, draw: &mut Draw<'_>, out: &mut [f64]) -> u64 {
        let path = PathTracing::continuous(self.of.switches);
        let mut weight = vec![1.0; scene.bands()];
        let mut step = Step { at, done: 0, rays: 0, weight: &mut weight };
        while let Some(next) = path.step(scene, &mut step, draw, out) {
            if next.point.distance(step.at.point) > SHORT_RAY_RADII * self.radius {
                self.read(scene, next, step.weight, out);
                break;
            }
            step.at = next;
            step.done += 1;
        }
        step.rays
    }
}

impl Estimator for PhotonMap {
    fn name(&self) -> &'static str {
        "photon"
    }

    fn gathers(&self) -> bool {
        true
    }

    fn batch(&self, scene: &Enclosure, batch: &Batch, out: &mut [f64]) -> Work {
        let (map, mut work) = self.map(scene, batch);
        work += gather(scene, batch, &map, out);
        work
    }
}
