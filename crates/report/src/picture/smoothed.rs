//! Light that a few segments a pixel have told, smoothed: the weighted mean of a window
//!
//! ```text
//! c_p ← Σ_q w_q c_q / Σ_q w_q,   w_q = exp(−(l_q − l_p)²/(2 k s)²)
//! ```
//!
//! over the pixels q that show the same surface, about the same plane of it and a like normal (the
//! bilateral filter of C. Tomasi and R. Manduchi, ICCV 1998, doi:10.1109/ICCV.1998.710815). l is
//! the luminance and s the root of the mean square of its standard errors in the window: borders of
//! shadows that differ by more than the noise stay where they are.

use std::ops::Range;

use fredholm_mesh::{Mesh, Vec3};

use super::lit::Middle;
use crate::Eye;
use crate::colour::Rgb;
use crate::tone::luminance;

/// Pixels to either side.
const REACH: usize = 3;
/// Cosine of the normals from which on they are alike.
const ALIKE_COSINE: f64 = 0.95;
/// Height of a point over the plane of another one, over their distance, up to which they are on
/// about one plane.
const MOST_SLOPE: f64 = 0.2;
/// k.
const WIDTH: f64 = 2.0;

/// What a pixel shows.
#[derive(Clone, Copy)]
struct Shown {
    surface: usize,
    point: Vec3,
    normal: Vec3,
    colour: Rgb,
    luminance: f64,
    variance: f64,
}

impl Shown {
    fn is_alike(&self, other: &Self) -> bool {
        let off = other.point - self.point;
        self.surface == other.surface
            && self.normal.dot(other.normal) > ALIKE_COSINE
            && off.dot(self.normal).abs() <= MOST_SLOPE * off.length()
    }
}

/// The colours of the pixels of a part of the picture, row by row, from those of all pixels, rows
/// of `width`.
pub(super) fn smoothed(
    (eye, mesh): (&Eye, &Mesh),
    (middles, width): (&[Middle], usize),
    (xs, ys): (&Range<usize>, &Range<usize>),
) -> Vec<Middle> {
    let height = middles.len() / width;
    let wide =
        |range: &Range<usize>, end: usize| range.start.saturating_sub(REACH)..(range.end + REACH).min(end);
    let (columns, rows) = (wide(xs, width), wide(ys, height));
    let shown = |(x, y): (usize, usize)| {
        let middle = &middles[y * width + x];
        let leaf = middle.leaf()?;
        let (patch, colour) = (mesh.patch(leaf), middle.colour.map(f64::from));
        Some(Shown {
            surface: mesh.surface_of(leaf),
            point: eye.on_plane(patch, x as f64 + 0.5, y as f64 + 0.5),
            normal: patch.normal(),
            colour,
            luminance: luminance(colour),
            variance: f64::from(middle.error).powi(2),
        })
    };
    let around: Vec<Option<Shown>> =
        rows.clone().flat_map(|y| columns.clone().map(move |x| (x, y))).map(shown).collect();
    let mut near: Vec<&Shown> = Vec::new();
    let mut found = Vec::with_capacity(xs.len() * ys.len());
    for (x, y) in ys.clone().flat_map(|y| xs.clone().map(move |x| (x, y))) {
        let middle = middles[y * width + x];
        let at = |x: usize, y: usize| &around[(y - rows.start) * columns.len() + x - columns.start];
        let Some(own) = at(x, y) else {
            found.push(middle);
            continue;
        };
        near.clear();
        for v in y.saturating_sub(REACH)..(y + REACH + 1).min(height) {
            for u in x.saturating_sub(REACH)..(x + REACH + 1).min(width) {
                near.extend(at(u, v).as_ref().filter(|other| own.is_alike(other)));
            }
        }
        let variance = near.iter().map(|shown| shown.variance).sum::<f64>() / near.len() as f64;
        let noise = (2.0 * WIDTH).powi(2) * variance;
        let (mut all, mut sum) = (0.0, [0.0; 3]);
        for Shown { colour, luminance, .. } in &near {
            let off = (luminance - own.luminance).powi(2);
            let weight = if off > 0.0 { (-off / noise).exp() } else { 1.0 };
            all += weight;
            sum = [0, 1, 2].map(|i| sum[i] + weight * colour[i]);
        }
        found.push(Middle { colour: sum.map(|c| (c / all) as f32), ..middle });
    }
    found
}
