//! The edges of the elements, drawn over the field: a sample nearer than half a line to an edge of
//! its element takes the colour of the line.
//!
//! The distance is taken in the picture, to the point of the edge that is nearest in space. Pixels.

use fredholm_mesh::{Mesh, Patch, Vec3};

use super::{Brush, Painter, Sample, Viewer, mean};
use crate::colour::Rgb;

/// Half the width of a line, pixels.
const HALF_LINE_WIDTH: f64 = 0.55;
/// Linear display colour of lines, and its share: seen on light and on dark.
const LINE_COLOUR: Rgb = [0.01, 0.09, 0.30];
const LINE_SHARE: f64 = 0.75;

pub(super) struct Elements<'a> {
    pub mesh: &'a Mesh,
}

impl Painter for Elements<'_> {
    fn brush(&self) -> Brush<'_> {
        Box::new(|view, _, samples| {
            mean(samples, |sample| {
                let colour = sample.shown;
                let near = on_edge(view, self.mesh.patch(sample.leaf), sample, HALF_LINE_WIDTH);
                if near { blend(colour, LINE_COLOUR, LINE_SHARE) } else { colour }
            })
        })
    }
}

/// Whether a sample is within `half` pixels of an edge of a patch.
pub(super) fn on_edge(view: &Viewer<'_>, patch: &Patch, sample: &Sample, half: f64) -> bool {
    (0..patch.sides()).any(|k| {
        let near = nearest(patch.corner(k), patch.corner(k + 1), sample.point);
        let (x, y) = sample.at;
        view.project(near).is_some_and(|(u, v)| (u - x).powi(2) + (v - y).powi(2) < half * half)
    })
}

/// The point of a segment nearest to `p`.
fn nearest(a: Vec3, b: Vec3, p: Vec3) -> Vec3 {
    let along = b - a;
    a + along * ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
}

/// `share` of the second colour over the first.
pub(super) fn blend(under: Rgb, over: Rgb, share: f64) -> Rgb {
    [0, 1, 2].map(|i| under[i] + share * (over[i] - under[i]))
}
