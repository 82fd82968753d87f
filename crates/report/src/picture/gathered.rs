//! The radiosity of every pixel, gathered from all that it sees: B(x) = M + ρ E(x).
//!
//! The samples of a pixel that lie on one plane of one surface have one colour: it is gathered at
//! the one nearest to their mean. So borders are drawn as finely as in the interpolated picture,
//! and light is gathered little more than once a pixel. W/m².

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use fredholm_mesh::Vec3;

use super::{BACKGROUND, Brush, Painter, SAMPLES, Sample, mean};
use crate::Field;
use crate::colour::{Colouring, Rgb};

/// Cosine, less than 1 by this, up to which two elements have one normal.
const COSINE_TOLERANCE: f64 = 1e-9;

/// Gathers the radiosity of points.
pub trait Gathering: Sync {
    /// A gatherer for one thread: the radiosity of a point of an element, of each band, W/m².
    fn gatherer(&self) -> Box<dyn FnMut(usize, Vec3) -> Vec<f64> + '_>;

    /// Whether the picture is still wanted; asked for every pixel.
    fn go_on(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

pub(super) struct GatherPainter<'a> {
    field: Field<'a>,
    gathering: &'a dyn Gathering,
    colouring: Colouring,
    /// Whether a pixel was left out because the picture was not wanted any more.
    stopped: AtomicBool,
}

impl<'a> GatherPainter<'a> {
    pub fn new(field: Field<'a>, gathering: &'a dyn Gathering) -> Self {
        Self { field, gathering, colouring: Colouring::new(field.bands()), stopped: AtomicBool::new(false) }
    }

    /// Whether two samples lie on one plane of one surface.
    fn alike(&self, a: &Sample, b: &Sample) -> bool {
        let mesh = self.field.mesh();
        let [p, q] = [a, b].map(|sample| mesh.patch(sample.leaf));
        let apart = (b.point - a.point).dot(p.normal()).abs();
        mesh.surface_of(a.leaf) == mesh.surface_of(b.leaf)
            && p.normal().dot(q.normal()) > 1.0 - COSINE_TOLERANCE
            && apart <= COSINE_TOLERANCE * p.diameter()
    }

    /// The sample of a group nearest to the mean of their points.
    fn middle<'s>(&self, first: &Sample, samples: &'s [Option<Sample>; SAMPLES]) -> Option<&'s Sample> {
        let group = || samples.iter().flatten().filter(|sample| self.alike(first, sample));
        let (sum, count) = group().fold((Vec3::ZERO, 0.0), |(sum, count), s| (sum + s.point, count + 1.0));
        group().min_by(|a, b| {
            let [a, b] = [a, b].map(|sample| sample.point.distance_squared(sum / count));
            a.total_cmp(&b)
        })
    }
}

impl Painter for GatherPainter<'_> {
    fn brush(&self) -> Brush<'_> {
        let mut gather = self.gathering.gatherer();
        Box::new(move |_, tone, samples| {
            if self.stopped.load(Ordering::Relaxed) || self.gathering.go_on().is_break() {
                self.stopped.store(true, Ordering::Relaxed);
                return [BACKGROUND; 3];
            }
            let mut known: Vec<(Sample, Rgb)> = Vec::new();
            mean(samples, |sample| {
                if let Some((_, colour)) = known.iter().find(|(other, _)| self.alike(other, sample)) {
                    return *colour;
                }
                let middle = self.middle(sample, samples).unwrap_or(sample);
                let colour = tone.display(self.colouring.colour(&gather(middle.leaf, middle.point)));
                known.push((*sample, colour));
                colour
            })
        })
    }

    fn shows_field(&self) -> bool {
        false
    }

    fn is_whole(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }
}
