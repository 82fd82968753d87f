//! The edges of the elements, drawn over the picture: a sample nearer than half a line to an edge of
//! its element takes the colour of the line.
//!
//! The distance is taken in the picture, to the point of the edge that is nearest in space. Pixels.

use fredholm_mesh::{Mesh, Patch, Vec3};

use super::{Overlay, Sample, Viewer};
use crate::colour::Rgb;

/// Half the width of a line, pixels.
const HALF_LINE_WIDTH: f64 = 0.55;
/// Linear display colour of lines, and its share: seen on light and on dark.
const LINE_COLOUR: Rgb = [0.01, 0.09, 0.30];
const LINE_SHARE: f64 = 0.75;

pub(super) struct Elements<'a> {
    pub mesh: &'a Mesh,
}

impl Overlay for Elements<'_> {
    fn colour(&self, view: &Viewer<'_>, sample: &Sample, under: Rgb) -> Rgb {
        let cover = cover(view, self.mesh.patch(sample.leaf), sample, HALF_LINE_WIDTH);
        blend(under, LINE_COLOUR, LINE_SHARE * cover)
    }
}

/// The share of a sample that lines along the edges of a patch cover, `half` pixels to either side:
/// all or nothing of a point, and of a whole pixel as much as of a strip of its width.
pub(super) fn cover(view: &Viewer<'_>, patch: &Patch, sample: &Sample, half: f64) -> f64 {
    let distance = |k: usize| {
        let near = nearest(patch.corner(k), patch.corner(k + 1), sample.point);
        let (x, y) = sample.at;
        view.project(near).map_or(f64::INFINITY, |(u, v)| (u - x).hypot(v - y))
    };
    let distance = (0..patch.sides()).map(distance).fold(f64::INFINITY, f64::min);
    if sample.is_pixel {
        (half + 0.5 - distance).clamp(0.0, 1.0)
    } else {
        f64::from(u8::from(distance < half))
    }
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
